// SPDX-License-Identifier: Apache-2.0
// Radiosity: no lamp, a window lights the room. Metal shows it by rays of its own, cloth takes its share of
// what is gathered.
//
//   build/povray/povray +Iexamples/povray/cookbook/radiosity.pov +Obuild/radiosity.png +W640 +H360 +A0.3 +AM2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
#include "mdf_fabrics.inc"
global_settings {
  assumed_gamma 1 max_trace_level 6
  radiosity { pretrace_start .08 pretrace_end .01 count 200 nearest_count 12 error_bound .3 recursion_limit 2 }
}

camera { location <0, 1.6, -5> right 16/9*x up y angle 50 look_at <0, .95, 0> }
sky_sphere { pigment { rgb <.35, .42, .52> } }
box { <-4.1, .6, -3>, <-4, 2.6, .5> pigment { rgb <7, 6.6, 6> } finish { ambient 0 diffuse 0 emission 1 } } // the window

// Without ambient: radiosity brings what ambient stands for.
sphere { <-1.3, .7, .2>, .7 texture { pigment { rgb 0 } finish { MDF_F_Brushed_Copper mdf { reflection { samples 16 clamp 6 } } } } }
cylinder { <1.5, 0, .6>, <1.5, 1.5, .6>, .5 texture { pigment { rgb 0 } finish { MDF_F_Shot_Taffeta ambient 0 } } }
sphere { <.3, .4, -.7>, .4 texture { pigment { rgb 0 } finish { MDF_F_Wool_Flannel ambient 0 } } }

box { <-3.5, 0, 1.6>, <3.5, 3, 1.7> pigment { rgb <.6, .56, .5> } finish { ambient 0 diffuse .8 } }
plane { y, 0 pigment { rgb .45 } finish { ambient 0 diffuse .8 } }
