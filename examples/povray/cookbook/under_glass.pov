// SPDX-License-Identifier: Apache-2.0
// Metal under glass. Light that comes back from it has passed glass four times: with POV-Ray's own five levels
// parts of it stay black. Try it: Declare=Levels=3.
//
//   build/povray/povray +Iexamples/povray/cookbook/under_glass.pov +Obuild/under_glass.png +W640 +H360 +A0.3 +AM2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
#ifndef (Levels) #declare Levels = 10; #end
global_settings { assumed_gamma 1 max_trace_level Levels adc_bailout .03 }

camera { location <0, 2.7, -4.6> right 16/9*x up y angle 38 look_at <0, .3, 0> }
light_source { <-5, 7, -4>, rgb .5 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .1] [.5 rgb <.3, .33, .38>] [1 rgb <.7, .75, .85>] } scale 2 translate -y } }
box { <-5, 2, 4>, <-1.5, 5, 4.1> pigment { rgb 2.4 } finish { ambient 0 diffuse 0 emission 1 } }

// The glass mirrors on its outer side alone: rays that split at every wall cost far more than they show.
#declare Outer = texture { pigment { rgbt 1 } finish { ambient 0 diffuse 0 specular .6 roughness .002 reflection { .02, 1 fresnel } conserve_energy } }
#declare Inner = texture { pigment { rgbt 1 } finish { ambient 0 diffuse 0 } }

difference {
  box { <-1.1, 0, -.8>, <1.1, .9, .8> texture { Outer } }
  box { <-1, -1, -.7>, <1, .8, .7> texture { Inner } }
  interior { ior 1.5 }
}

cylinder { 0, .06*y, .62 texture { pigment { rgb 0 } finish { MDF_F_Turned_Brass mdf { scratches { mm_per_unit 100 } reflection { samples 4 clamp 8 } } } } }
sphere { <0, .42, 0>, .35 texture { pigment { rgb 0 } finish { MDF_F_Brushed_Copper mdf { reflection { samples 4 clamp 8 } } } } }

plane { y, 0 pigment { checker rgb <.1, .16, .2>, rgb .5 scale .4 } finish { ambient .1 diffuse .6 } }
