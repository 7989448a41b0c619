// SPDX-License-Identifier: Apache-2.0
// One cloth in ten colours: `diffuse pigment` gives its yarns the colour of the pigment, whatever draws that.
//
//   build/povray/povray +Iexamples/povray/cookbook/ten_colours.pov +Obuild/ten_colours.png +W640 +H360 +A0.1
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_fabrics.inc"
global_settings { assumed_gamma 1 }

camera { location <0, 3.4, -7> right 16/9*x up y angle 49 look_at <0, .3, .3> }
light_source { <-5, 8, -5>, rgb 1.5 area_light 2*x, 2*z, 3, 3 adaptive 1 }
light_source { <6, 4, -4>, rgb <.22, .26, .33> shadowless }
sky_sphere { pigment { rgb .2 } }

#declare Cloth = finish { MDF_F_Gabardine mdf { fabric { yarns { diffuse pigment } mm_per_unit 45 } } }
#declare Colours = array[10] {
  rgb <.45, .04, .04>, rgb <.55, .22, .03>, rgb <.55, .42, .05>, rgb <.20, .33, .06>, rgb <.03, .22, .12>,
  rgb <.03, .24, .28>, rgb <.03, .09, .32>, rgb <.16, .06, .26>, rgb <.45, .12, .22>, rgb <.16, .15, .14>
}

#for (I, 0, 9)
  sphere { // a ball has UV coordinates, which a cloth lies along
    0, 1
    texture { pigment { Colours[I] } finish { Cloth } }
    rotate <-50, 20, 0> scale <.55, .42, .55> translate <1.25*(mod(I, 5) - 2), .42, 1.5*int(I/5) - .45>
  }
#end

plane { y, 0 texture { pigment { rgb <.42, .40, .36> } finish { MDF_F_Linen mdf { fabric { yarns { diffuse pigment } backing rgb .05 mm_per_unit 100 } } } } }
