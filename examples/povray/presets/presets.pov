// SPDX-License-Identifier: Apache-2.0
// Every cloth and metal that has a name, on a shelf, under a window and a dim sky: no light source.
//
//   build/povray/povray +Iexamples/povray/presets/presets.pov +Obuild/presets.png \
//     +W960 +H540 +A0.2
#version 3.7;
#declare mdf_Defaults = 1;
#include "mdf_metals.inc"
#include "mdf_fabrics.inc"
global_settings {
  assumed_gamma 1
  radiosity { pretrace_start .08 pretrace_end .01 count 200 nearest_count 10 error_bound .4 recursion_limit 2 }
}

camera { location <0, 3.6, -17> right 16/9*x up y angle 45 look_at <0, 2.62, 0> }
sky_sphere { pigment { gradient y color_map { [0 rgb .10] [.5 rgb <.26, .28, .32>] [1 rgb <.5, .56, .66>] } } }
#declare Panel = finish { ambient 0 diffuse 0 emission 1 }
box { <-9, 3, -9.1>, <-4.5, 10, -9> pigment { rgb <9, 8.4, 7.6> } finish { Panel } }
box { <5, 2, -9.1>, <7, 8, -9> pigment { rgb <4, 5, 6.4> } finish { Panel } }

// Balls stand in rows of nine; one is about 6 cm across, so a unit of u is 19 cm.
#macro Ball(Column, Row, Finish)
  sphere {
    0, .62
    texture { pigment { rgb 0 } finish { Finish } }
    rotate <-70, 20, 0>
    translate <1.5*(Column - 4), .62 + 2.05*Row, .6*Row>
  }
#end

#local Cloths = array[9] {
  MDF_F_Silk_Charmeuse, MDF_F_Silk_Shantung, MDF_F_Denim, MDF_F_Gabardine, MDF_F_Linen,
  MDF_F_Wool_Flannel, MDF_F_Polyester_Lining, MDF_F_Shot_Taffeta, MDF_F_Herringbone_Tweed
}
#local Metals = array[18] {
  MDF_F_Brushed_Steel, MDF_F_Brushed_Aluminium, MDF_F_Brushed_Titanium, MDF_F_Brushed_Brass,
  MDF_F_Brushed_Copper, MDF_F_Brushed_Gold, MDF_F_Turned_Steel, MDF_F_Turned_Aluminium,
  MDF_F_Turned_Titanium, MDF_F_Turned_Brass, MDF_F_Turned_Copper, MDF_F_Turned_Gold,
  MDF_F_Scratched_Steel, MDF_F_Scratched_Aluminium, MDF_F_Scratched_Titanium,
  MDF_F_Scratched_Brass, MDF_F_Scratched_Copper, MDF_F_Scratched_Gold
}
#for (I, 0, 8)
  Ball(I, 0, finish { Cloths[I] ambient 0 })
  Ball(I, 1, finish { Metals[I] mdf { reflection { samples 12 } } })
  Ball(I, 2, finish { Metals[I + 9] mdf { reflection { samples 12 } } })
#end

#for (Row, 0, 2)
  box {
    <-7.2, 2.05*Row - .12, .6*Row - .8>, <7.2, 2.05*Row, .6*Row + .8>
    pigment { rgb .35 } finish { ambient 0 diffuse .7 }
  }
#end
box { <-12, -.12, -12>, <12, -.1, 3> pigment { rgb .35 } finish { ambient 0 diffuse .7 } }
box { <-12, -1, 2.6>, <12, 9, 2.7> pigment { rgb <.30, .27, .24> } finish { ambient 0 diffuse .7 } }
