// SPDX-License-Identifier: Apache-2.0
// A normal map on brushed metal, near and far: the strokes follow the bumps, and what is smaller
// than a pixel becomes roughness. The map is that of a basket weave:
//
//   build/shade weave --name basket --cells 16 --curve .35 --ridge 0 --map normal --bits 16 -o build/basket.png
//   build/povray/povray +Iexamples/povray/embossed/embossed.pov +Lbuild +Obuild/embossed.png \
//     +W960 +H540 +A0.2
#version 3.7;
#declare mdf_Defaults = 1;
#ifndef (mdf_Version) #error "This scene needs POV-Ray with libshade." #end
global_settings { assumed_gamma 1 }

camera { location <0, 2.3, -5.4> right 16/9*x up y angle 52 look_at <0, .75, 0> }
light_source { <-5, 6, -4>, rgb .6 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .08] [.5 rgb <.22, .24, .28>] [1 rgb <.75, .8, .9>] } scale 2 translate -y } }
#declare Panel = finish { ambient 0 diffuse 0 emission 1 }
box { <-6, 2.9, 5>, <-2.5, 6, 5.1> pigment { rgb 2.4 } finish { Panel } }
box { <6, .8, -1>, <6.1, 4, 3> pigment { rgb <1.3, 1.6, 2> } finish { Panel } }

#macro Embossed(Colour, Repeats, Strength)
  texture {
    pigment { rgb 0 }
    finish {
      ambient 0 diffuse 0
      mdf {
        ggx .07, .25 specular Colour fresnel schlick
        bump_image { png "basket.png" strength Strength scale 1/Repeats }
        reflection { samples 16 clamp 6 }
      }
    }
  }
#end

sphere { 0, .85 Embossed(rgb <.93, .62, .48>, <6, 3>, 1) rotate <-15, 30, 0> translate <-1.9, .85, .3> }
torus { .62, .3 Embossed(rgb <.95, .79, .45>, <6, 3>, 1) rotate <-60, 0, 10> translate <.15, .78, 0> }
lathe { // a tumbler
  cubic_spline 7, <0, -.2>, <.05, 0>, <.55, .02>, <.62, .5>, <.72, 1.5>, <.70, 1.52>, <.5, 1.3>
  Embossed(rgb <.62, .61, .60>, <4, 2.5>, 1) translate <2.05, 0, .2>
}
// the floor goes on to the horizon; one map a unit
bicubic_patch {
  type 1 flatness .01 u_steps 4 v_steps 4
  uv_vectors <0, 0> <40, 0> <40, 40> <0, 40>
  #for (J, 0, 3) #for (I, 0, 3) <-20 + 40*I/3, 0, -6 + 40*J/3> #end #end
  Embossed(rgb <.50, .50, .51>, <1, 1>, .6)
}
