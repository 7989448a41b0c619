// SPDX-License-Identifier: Apache-2.0
// A turned pot with a brushed side, its lid with a knob, a knife and a bowl on a linen cloth: CSG,
// each part with its own grain. A window lights it; there is no light source.
//
//   build/povray/povray +Iexamples/povray/kitchen/kitchen.pov +Obuild/kitchen.png +W960 +H540 +A0.2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
global_settings {
  assumed_gamma 1 max_trace_level 6
  radiosity { pretrace_start .08 pretrace_end .01 count 150 nearest_count 10 error_bound .35 recursion_limit 2 }
}

camera { location <.5, 3.6, -7.2> right 16/9*x up y angle 52 look_at <.35, .55, -.1> }
sky_sphere { pigment { gradient y color_map { [0 rgb .35] [1 rgb <.55, .58, .64>] } } }
#declare Panel = finish { ambient 0 diffuse 0 emission 1 }
union { // a window with bars
  #for (I, 0, 2) box { <-9, .6 + 2.2*I, -1.5>, <-8.9, 2.6 + 2.2*I, .9> } #end
  #for (I, 0, 2) box { <-9, .6 + 2.2*I, 1.1>, <-8.9, 2.6 + 2.2*I, 3.5> } #end
  pigment { rgb <8, 7.5, 6.8> } finish { Panel }
}
box { <7, 2, -4>, <7.1, 5, 2> pigment { rgb <1.1, 1.3, 1.6> } finish { Panel } }
box { <-3, 7.5, -4>, <4, 7.6, 1> pigment { rgb 1.1 } finish { Panel } }

// Fine rings on what was faced on the lathe; on the side the belt ran round it.
#declare Faced = finish { MDF_F_Turned_Steel mdf { scratches { mm_per_unit 90 } reflection { samples 20 clamp 8 } } }
#declare Belted = finish { MDF_F_Brushed_Steel mdf { tangent radial y scratches off reflection { samples 20 clamp 8 } } }

union { // the pot
  difference {
    cylinder { 0, 1.3*y, 1.25 }
    cylinder { .08*y, 2*y, 1.19 }
    texture { pigment { rgb 0 } finish { Belted } }
  }
  cylinder { 1.3*y, 1.36*y, 1.3 texture { pigment { rgb 0 } finish { Faced } } }
  sphere { 0, 1.28 scale <1, .16, 1> translate 1.36*y texture { pigment { rgb 0 } finish { Faced } } }
  sphere { 0, .22 scale <1, .8, 1> translate 1.78*y texture { pigment { rgb 0 } finish { MDF_F_Turned_Brass } } }
  cylinder { 1.5*y, 1.7*y, .09 texture { pigment { rgb 0 } finish { MDF_F_Turned_Brass } } }
  #for (Side, -1, 1, 2)
    torus { .3, .06 translate <1.42*Side, 1, 0> texture { pigment { rgb 0 } finish { MDF_F_Brushed_Steel mdf { scratches off tangent uv } } } }
  #end
  rotate 35*y translate <-1.35, 0, .5>
}

// The knife: its blade was ground across, from back to edge.
#declare Ground = finish { MDF_F_Brushed_Steel mdf { tangent z scratches { mm_per_unit 260 } reflection { samples 20 clamp 8 } } }
union {
  intersection {
    box { <-1.7, 0, -.16>, <.9, .05, .3> }
    plane { <-.45, 0, .6>, .55 }
    plane { <0, 1, -.13>, .035 }
    texture { pigment { rgb 0 } finish { Ground } }
  }
  box { <.9, -.02, -.16>, <2.1, .1, .1> texture { pigment { rgb 0 } finish { ambient 0 diffuse 0 mdf { specular .04 fresnel schlick ggx .25, .12 tangent x diffuse lambert rgb <.055, .03, .02> reflection { samples 8 } } } } }
  #for (I, 0, 2) cylinder { <1.15 + .35*I, .09, -.03>, <1.15 + .35*I, .106, -.03>, .045 texture { pigment { rgb 0 } finish { MDF_F_Turned_Brass } translate (1.15 + .35*I)*x } } #end
  rotate -24*y translate <1.3, .04, -1.75>
}

lathe { // a spun bowl of copper, its strokes round it
  cubic_spline 8, <0, .03>, <.05, .02>, <.6, .06>, <1.0, .42>, <1.12, .78>, <1.08, .78>, <.95, .45>, <.5, .1>
  texture { pigment { rgb 0 } finish { MDF_F_Turned_Copper mdf { scratches { mm_per_unit 400 } reflection { samples 20 clamp 8 } } } }
  translate <2.05, 0, .55>
}

// The cloth on a table: yarns of the pigment's colours, with a border.
plane {
  y, 0
  texture {
    pigment {
      gradient x
      color_map { [.06 rgb <.62, .58, .50>] [.06 rgb <.09, .14, .30>] [.12 rgb <.09, .14, .30>] [.12 rgb <.62, .58, .50>] }
      scale 1.9 translate .42*x
    }
    finish { ambient 0 diffuse 0 mdf { preset "linen" fabric { mm_per_unit 60 yarns { diffuse pigment } backing rgb .1 } } }
    rotate 12*y
  }
}
