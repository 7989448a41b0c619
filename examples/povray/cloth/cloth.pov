// SPDX-License-Identifier: Apache-2.0
// Cloth, by name and by hand: a silk ball and one of denim on a table cloth of checked linen, a tweed
// cushion, and a net that the light passes.
//
//   build/povray/povray +Iexamples/povray/cloth/cloth.pov +Obuild/cloth.png +W960 +H540 +A0.1
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_fabrics.inc"
global_settings { assumed_gamma 1 }

camera { location <0, 2.6, -6.4> right 16/9*x up y angle 50 look_at <0, .8, 0> }
light_source { <-5, 8, -5>, rgb 1.15 area_light 1.5*x, 1.5*z, 4, 4 adaptive 1 jitter }
light_source { <7, 4, -4>, rgb <.28, .33, .42> shadowless }
background { rgb <.10, .11, .13> }

// A plane has no UV coordinates: a unit of it is a unit of the scene.
plane {
  y, 0
  texture {
    // the yarns take the pigment's colour
    pigment { checker rgb <.50, .12, .08>, rgb <.62, .58, .48> scale .45 }
    finish {
      ambient .1 diffuse 0
      mdf { fabric { preset "linen" mm_per_unit 180 yarns { diffuse pigment } backing rgb .05 } }
    }
    rotate 30*y
  }
}

sphere { 0, .8 texture { MDF_T_Silk_Charmeuse } rotate <0, 40, -20> translate <-2.1, .8, .2> }

sphere {
  0, .8
  texture { MDF_T_Denim finish { MDF_F_Denim mdf { fabric { mm_per_unit 300 } } } }
  rotate 20*x translate <.1, .8, -.5>
}

superellipsoid {
  <.8, .45>
  texture {
    pigment { rgb 0 }
    normal { bumps .25 scale .7 }
    finish { MDF_F_Herringbone_Tweed mdf { fabric { mm_per_unit 70 } } }
  }
  scale <.8, .8, .5> rotate <-22, -25, 0> translate <2.1, .78, .4>
}

// A net: threads without a backing, and what is behind them between.
box {
  <-1, 0, -.002>, <1, 1.7, .002>
  texture {
    pigment { rgb 0 }
    finish {
      ambient .1 diffuse 0
      mdf {
        fabric {
          weave "plain" crossings <23, 29>
          yarns { width .3 gap .7 curve .7 along 60 across 12 diffuse fibre rgb <.75, .7, .6> transmit rgb .15 }
          backing rgb 0
        }
      }
    }
  }
  rotate 8*y translate <-.7, 0, 2.2>
}
