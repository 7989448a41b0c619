// SPDX-License-Identifier: Apache-2.0
// The hand of a twill. In the middle the cloth of the left again, on a mirrored object: its twill rises to the
// right as before, for mirrors do not weave. On the right a left-hand twill, by its three numbers.
//
//   build/povray/povray +Iexamples/povray/cookbook/twill_hand.pov +Obuild/twill_hand.png +W640 +H360 +A0.1
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_fabrics.inc"
global_settings { assumed_gamma 1 }

camera { location <0, 1.4, -6.7> right 16/9*x up y angle 44 look_at <0, 1.05, 0> }
light_source { <-5, 6, -6>, rgb 1.1 area_light 2*x, 2*z, 3, 3 adaptive 1 }
light_source { <6, 3, -4>, rgb .25 shadowless }
sky_sphere { pigment { rgb .15 } }

#macro Sleeve(Shift) // from pick to pick; denim has 3, which is one to the right
  box {
    <-.75, .1, 0>, <.75, 2.1, .2>
    texture { pigment { rgb 0 } finish { MDF_F_Denim mdf { fabric { weave 1, 3, Shift crossings 26 } } } }
  }
#end
object { Sleeve(3) translate -1.75*x }
object { Sleeve(3) scale <-1, 1, 1> }
object { Sleeve(1) translate 1.75*x }

plane { y, 0 pigment { rgb .35 } finish { ambient .1 diffuse .6 } }
