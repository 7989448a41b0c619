// SPDX-License-Identifier: Apache-2.0
// Recolouring presets. What follows `preset` changes it: a metal's colour, a cloth's yarns.
//
//   build/povray/povray +Iexamples/povray/cookbook/recolour.pov +Obuild/recolour.png +W640 +H360 +A0.3 +AM2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
#include "mdf_fabrics.inc"
global_settings { assumed_gamma 1 }

camera { location <0, 2.6, -8> right 16/9*x up y angle 46 look_at <0, 1.45, 0> }
light_source { <-5, 8, -6>, rgb .8 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .12] [.5 rgb <.32, .34, .38>] [1 rgb <.7, .75, .85>] } scale 2 translate -y } }
box { <-5, 1.5, -7.1>, <-2, 6, -7> pigment { rgb 2.4 } finish { ambient 0 diffuse 0 emission 1 } }

#macro Ball(Column, Row, Finish)
  sphere { 0, .68 texture { pigment { rgb 0 } finish { Finish } } rotate <-30, 20, 0> translate <1.6*(Column - 1.5), .7 + 1.5*Row, .5*Row> }
#end

// A metal's preset tells its colour by an index of refraction: `specular` after it takes its place.
Ball(0, 1, finish { MDF_F_Brushed_Aluminium })
Ball(1, 1, finish { MDF_F_Brushed_Aluminium mdf { specular rgb <.55, .03, .03> } }) // anodised
Ball(2, 1, finish { MDF_F_Brushed_Aluminium mdf { specular rgb <.02, .09, .40> } })
Ball(3, 1, finish { MDF_F_Brushed_Aluminium mdf { fresnel conductor <2.923, 2.92, 2.547>, <3.077, 2.937, 2.75> } }) // iron

Ball(0, 0, finish { MDF_F_Denim })
Ball(1, 0, finish { MDF_F_Denim mdf { fabric { warp { diffuse rgb <.25, .02, .02> } } } }) // the warp is what one dyes
Ball(2, 0, finish { MDF_F_Silk_Charmeuse mdf { fabric { yarns { diffuse rgb <.02, .25, .12> specular rgb <.05, .16, .10> } } } })
Ball(3, 0, finish { MDF_F_Herringbone_Tweed mdf { fabric { weft { diffuse rgb <.5, .3, .04> } } } })

plane { y, 0 pigment { rgb .3 } finish { ambient .1 diffuse .6 } }
plane { z, 1.6 pigment { rgb <.34, .31, .28> } finish { ambient .1 diffuse .6 } }
