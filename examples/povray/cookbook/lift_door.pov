// SPDX-License-Identifier: Apache-2.0
// A brushed lift door: strokes run upwards on the doors, along on the frame. One unit is a metre.
//
//   build/povray/povray +Iexamples/povray/cookbook/lift_door.pov +Obuild/lift_door.png +W640 +H360 +A0.3 +AM2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
global_settings { assumed_gamma 1 }

camera { location <-.75, 1.5, -4.2> right 16/9*x up y angle 60 look_at <.15, 1.2, 0> }
sky_sphere { pigment { gradient y color_map { [0 rgb .12] [.5 rgb .3] [1 rgb .45] } scale 2 translate -y } }
#declare Panel = finish { ambient 0 diffuse 0 emission 1 }
box { <-1.2, 3.2, -3.2>, <-.2, 3.22, -.6> pigment { rgb <5, 4.7, 4.2> } finish { Panel } } // lamps in the ceiling
box { <.6, 3.2, -3.2>, <1.6, 3.22, -.6> pigment { rgb <5, 4.7, 4.2> } finish { Panel } }
box { <-4, 1.6, -7.1>, <5, 2.7, -7> pigment { rgb <1.1, 1.3, 1.6> } finish { Panel } } // a window behind
light_source { <.2, 3.1, -2>, rgb .5 area_light 2*x, 2*z, 4, 4 adaptive 1 shadowless }

// A texture that is turned turns its strokes and its scratches: along u before, along v (upwards) after.
#declare Steel = finish { MDF_F_Brushed_Steel mdf { scratches { mm_per_unit 1000 } reflection { samples 32 clamp 8 } } }
#declare Upwards = texture { pigment { rgb 0 } finish { Steel } rotate 90*z }
#declare Along = texture { pigment { rgb 0 } finish { Steel } }

box { <-.55, .02, .06>, <-.004, 2.1, .1> texture { Upwards } }
box { <.004, .02, .06>, <.55, 2.1, .1> texture { Upwards } }
box { <-.7, 0, 0>, <-.55, 2.1, .1> texture { Upwards } }
box { <.55, 0, 0>, <.7, 2.1, .1> texture { Upwards } }
box { <-.7, 2.1, 0>, <.7, 2.28, .1> texture { Along } }

// the plate with its buttons, turned on a lathe
box { <.95, .95, -.01>, <1.1, 1.3, 0> texture { Upwards } }
#for (I, 0, 1)
  cylinder {
    <0, -.012, 0>, <0, 0, 0>, .032
    texture { pigment { rgb 0 } finish { MDF_F_Turned_Brass mdf { scratches { mm_per_unit 1000 } } } }
    rotate 90*x translate <1.025, 1.05 + .13*I, -.022>
  }
#end

box { <-5, 0, .1>, <5, 3.2, .2> pigment { rgb <.62, .58, .52> } finish { ambient .12 diffuse .6 } }
plane { y, 0 pigment { checker rgb .16, rgb .3 scale .5 } finish { ambient .12 diffuse .6 } }
