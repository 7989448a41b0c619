// SPDX-License-Identifier: Apache-2.0
// Metals by name, with the grain that made them: brushed steel, brushed brass, scratched copper on a
// used sheet of aluminium, under a sky.
//
//   build/povray/povray +Iexamples/povray/scratches/scratches.pov +Obuild/scratches.png \
//     +W640 +H360 +A0.2
#version 3.7;
#declare mdf_Defaults = 1;
global_settings { assumed_gamma 1 }

camera { location <0, 2.1, -5.6> right 16/9*x up y angle 58 look_at <0, .5, 0> }
light_source { <-6, 8, -6>, rgb .7 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere {
  pigment {
    gradient y
    color_map { [0 rgb .05] [.45 rgb <.3, .33, .38>] [.5 rgb .8] [1 rgb <.4, .5, .7>] }
    scale 2 translate -y
  }
}

// One unit of the object's UV coordinates spans MmPerUnit mm of metal.
#macro Metal(Name, MmPerUnit)
  texture {
    pigment { rgb 0 }
    finish {
      ambient 0 diffuse 0
      mdf { preset Name scratches { mm_per_unit MmPerUnit } reflection { samples 8 clamp 8 } }
    }
  }
#end

sphere { <-2.1, .8, 0>, .8 Metal("brushed_steel", 300) }
box { <-.65, 0, -.5>, <.65, 1.1, .5> Metal("brushed_brass", 400) rotate 25*y }
cylinder { <2.1, 0, 0>, <2.1, 1.2, 0>, .65 Metal("scratched_copper", 300) }
plane { y, 0 Metal("scratched_aluminium", 60) }
