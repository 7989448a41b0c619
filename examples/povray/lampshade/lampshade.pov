// SPDX-License-Identifier: Apache-2.0
// Light through cloth: a shade of linen about a bulb, on a turned brass foot, before a curtain of
// shot taffeta that hangs in folds.
//
//   build/povray/povray +Iexamples/povray/lampshade/lampshade.pov +Obuild/lampshade.png \
//     +W960 +H540 +A0.2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
#include "mdf_fabrics.inc"
global_settings { assumed_gamma 1 }

camera { location <0, 1.9, -7.5> right 16/9*x up y angle 40 look_at <0, 1.75, 0> }
background { rgb <.03, .03, .04> }
#declare Bulb = <-.8, 2.25, 0>;
light_source { Bulb, rgb <1, .78, .5>*4 area_light .24*x, .24*y, 5, 5 circular orient adaptive 1 jitter fade_distance 1.6 fade_power 2 }
light_source { <5, 5, -6>, rgb <.5, .58, .75> area_light 3*y, 3*z, 4, 4 adaptive 1 jitter }

// The yarns let a part of the light through; the gaps between them all of it.
cone {
  <0, 1.6, 0>, 1.05, <0, 2.9, 0>, .62 open
  texture {
    pigment { rgb 0 }
    finish {
      ambient .02 diffuse 0
      mdf { preset "linen" fabric { crossings <300, 60> yarns { diffuse fibre rgb <.62, .52, .36> transmit rgb <.22, .17, .10> } backing rgb .02 } }
    }
  }
  translate -.8*x
}
#declare Foot = texture { pigment { rgb 0 } finish { MDF_F_Turned_Brass ambient .1 } }
lathe {
  cubic_spline 11, <.7, -.1>, <.68, 0>, <.62, .09>, <.3, .16>, <.09, .35>, <.07, .7>, <.16, .85>, <.07, 1>, <.06, 1.5>, <.05, 1.9>, <.04, 2.1>
  texture { Foot } translate -.8*x
}
sphere { 0, .11 translate Bulb pigment { rgb <1, .85, .6> } finish { ambient 0 diffuse 0 emission 3 } no_shadow }

// The curtain: a sheet of points on a wave, u across its cloth and v down it.
#macro Fold(U) <4.6*(U - .5), 0, 1.55 + .16*sin(44*U + 1.5*sin(9*U)) + .05*sin(101*U)> #end
#declare Across = 240;
mesh2 {
  vertex_vectors { 2*(Across + 1) #for (I, 0, Across) , Fold(I/Across) + 4*y, Fold(I/Across) - .3*y #end }
  normal_vectors {
    2*(Across + 1)
    #for (I, 0, Across)
      #local N = vnormalize(vcross(y, Fold(I/Across + 1e-3) - Fold(I/Across - 1e-3)));
      , N, N
    #end
  }
  uv_vectors { 2*(Across + 1) #for (I, 0, Across) , <2*I/Across, 1>, <2*I/Across, 0> #end }
  face_indices { 2*Across #for (I, 0, Across - 1) , <2*I, 2*I + 1, 2*I + 2>, <2*I + 1, 2*I + 3, 2*I + 2> #end }
  texture { pigment { rgb 0 } finish { MDF_F_Shot_Taffeta ambient .25 mdf { fabric { mm_per_unit 1200 } } } }
  scale <2.6, 1, 1>
}

plane { y, 0 texture { pigment { rgb 0 } finish { ambient 0 diffuse 0 mdf { ggx .12, .04 tangent x specular .05 fresnel schlick diffuse lambert rgb <.13, .07, .035> reflection { samples 8 } } } } }
