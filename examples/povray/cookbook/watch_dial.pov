// SPDX-License-Identifier: Apache-2.0
// A watch dial: strokes that run away from the middle, as on a sunburst, within a ring that was turned.
//
//   build/povray/povray +Iexamples/povray/cookbook/watch_dial.pov +Obuild/watch_dial.png +W640 +H360 +A0.3 +AM2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
global_settings { assumed_gamma 1 }

camera { location <.6, 5.2, -3.6> right 16/9*x up y angle 40 look_at <0, 0, -.05> }
light_source { <-4, 7, 3>, rgb .7 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .06] [.5 rgb <.22, .24, .28>] [1 rgb <.5, .55, .65>] } scale 2 translate -y } }
box { <-4, 5.5, 3>, <-1, 5.6, 6> pigment { rgb 2.6 } finish { ambient 0 diffuse 0 emission 1 } }
box { <1.5, 4, 4>, <4, 6, 4.1> pigment { rgb <1.2, 1.5, 2> } finish { ambient 0 diffuse 0 emission 1 } }

// Round the axis the strokes would run as from a lathe. With the two widths in the other order the lobe is narrow away
// from it: a sunburst.
#declare Sunburst = finish { ambient 0 diffuse 0 mdf { ggx .35, .06 tangent radial y specular rgb <.03, .09, .28> fresnel schlick reflection { samples 24 clamp 8 } } }
#declare Turned = finish { MDF_F_Turned_Steel mdf { scratches { mm_per_unit 20 } reflection { samples 16 clamp 8 } } }
#declare Gold = finish { MDF_F_Brushed_Gold mdf { tangent z scratches off reflection { samples 12 clamp 8 } } }

cylinder { -.1*y, 0, 1.3 texture { pigment { rgb 0 } finish { Sunburst } } }
difference {
  cylinder { -.15*y, .12*y, 1.55 }
  cone { -.01*y, 1.3, .13*y, 1.42 }
  texture { pigment { rgb 0 } finish { Turned } }
}

#macro Stick(From, To, Width, Angle)
  box { <-Width/2, .01, From>, <Width/2, .035, To> texture { pigment { rgb 0 } finish { Gold } } rotate Angle*y }
#end
#for (Hour, 0, 11) Stick(.98, 1.2, .05, 30*Hour) #end
Stick(-.2, .7, .07, -55)
object { Stick(-.2, 1.05, .05, 60) translate .03*y }
cylinder { 0, .09*y, .07 texture { pigment { rgb 0 } finish { Turned } } }

plane { y, -.15 pigment { rgb <.10, .07, .05> } finish { ambient .1 diffuse .6 } }
