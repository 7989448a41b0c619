// SPDX-License-Identifier: Apache-2.0
// Metal under glass. Light that comes back from it has passed glass four times: five levels, POV-Ray's own
// number, end in black. Try it: +K Declare=Levels=5.
//
//   build/povray/povray +Iexamples/povray/cookbook/under_glass.pov +Obuild/under_glass.png +W640 +H360 +A0.3 +AM2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
#ifndef (Levels) #declare Levels = 12; #end
global_settings { assumed_gamma 1 max_trace_level Levels }

camera { location <0, 2.5, -4.6> right 16/9*x up y angle 45 look_at <0, .45, 0> }
light_source { <-5, 7, -4>, rgb .5 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .1] [.5 rgb <.3, .33, .38>] [1 rgb <.7, .75, .85>] } scale 2 translate -y } }
box { <-5, 2, 4>, <-1.5, 5, 4.1> pigment { rgb 2.4 } finish { ambient 0 diffuse 0 emission 1 } }

#declare Glass = material {
  texture { pigment { rgbt 1 } finish { ambient 0 diffuse 0 specular .6 roughness .002 reflection { .02, 1 fresnel } conserve_energy } }
  interior { ior 1.5 }
}

union { // a foot, and what stands on it
  cylinder { 0, .12*y, 1.15 }
  cylinder { .12*y, .3*y, .5 }
  texture { pigment { rgb 0 } finish { MDF_F_Turned_Brass mdf { scratches { mm_per_unit 100 } reflection { samples 12 clamp 8 } } } }
}
sphere { <0, .7, 0>, .4 texture { pigment { rgb 0 } finish { MDF_F_Brushed_Copper mdf { reflection { samples 12 clamp 8 } } } } }

difference { // the dome: a wall of glass
  union { cylinder { .125*y, .6*y, 1 } sphere { .6*y, 1 } }
  union { cylinder { 0, .6*y, .95 } sphere { .6*y, .95 } }
  material { Glass }
}

plane { y, 0 pigment { checker rgb <.1, .16, .2>, rgb .5 scale .4 } finish { ambient .1 diffuse .6 } }
