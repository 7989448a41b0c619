// SPDX-License-Identifier: Apache-2.0
// What a block costs: one ball over one floor, with the block that Block names. Time it: +WT1 -P Declare=Block=3.
// 0 POV-Ray's own highlight, 1 a lobe, 2 with a reflection, 3 with scratches as well, 4 cloth, 5 averaged normals.
//
//   build/povray/povray +Iexamples/povray/cookbook/costs.pov +Obuild/costs.png +W640 +H360 +A0.3 +AM2 Declare=Block=2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
#include "mdf_fabrics.inc"
#ifndef (Block) #declare Block = 2; #end
global_settings { assumed_gamma 1 }

camera { location <0, 1.8, -6> right 16/9*x up y angle 42 look_at <0, .9, 0> }
light_source { <-5, 7, -4>, rgb .8 }
light_source { <6, 4, -3>, rgb <.3, .35, .45> }
sky_sphere { pigment { gradient y color_map { [0 rgb .1] [.5 rgb <.3, .33, .38>] [1 rgb <.7, .75, .85>] } scale 2 translate -y } }

#declare Lobe = finish { ambient .1 diffuse 0 mdf { ggx .05, .16 specular rgb <.9, .7, .4> fresnel schlick } }
sphere {
  0, 1
  #switch (Block)
    #case (0) pigment { rgb <.9, .7, .4> } finish { ambient .1 diffuse .3 specular .7 roughness .03 metallic } #break
    #case (1) pigment { rgb 0 } finish { Lobe } #break
    #case (2) pigment { rgb 0 } finish { Lobe mdf { reflection { samples 12 clamp 10 } } } #break
    #case (3) pigment { rgb 0 } finish { MDF_F_Brushed_Brass mdf { reflection { samples 12 clamp 10 } } } #break
    #case (4) pigment { rgb 0 } finish { MDF_F_Denim } #break
    #else
      texture {
        average
        texture_map {
          #for (I, 1, 12)
            [1 pigment { rgb <.9, .7, .4> } normal { bumps .45 scale <.6, .03, .03> translate 7*I } finish { ambient 0 diffuse 0 reflection { .9 metallic } }]
          #end
        }
      }
  #end
  translate y
}
plane { y, 0 pigment { checker rgb <.45, .12, .08>, rgb .5 scale .5 } finish { ambient .1 diffuse .7 } }
