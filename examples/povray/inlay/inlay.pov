// SPDX-License-Identifier: Apache-2.0
// The pigment's colours on metal: `specular pigment` gives a lobe to what any pigment draws. Inlaid
// steel, damascene waves, a coin with rings, and oxide colours that heat leaves.
//
//   build/povray/povray +Iexamples/povray/inlay/inlay.pov +Obuild/inlay.png +W960 +H540 +A0.2
#version 3.7;
#declare mdf_Defaults = 1;
global_settings { assumed_gamma 1 }
#ifndef (mdf_Version) #error "This scene needs POV-Ray with libshade." #end

camera { location <0, 3.9, -6.4> right 16/9*x up y angle 55 look_at <.05, .5, 0> }
light_source { <-5, 7, -3>, rgb .5 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .06] [.5 rgb <.3, .33, .38>] [1 rgb <.75, .8, .9>] } scale 2 translate -y } }
#declare Panel = finish { ambient 0 diffuse 0 emission 1 }
box { <-5, 2.6, 4>, <-2, 6, 4.1> pigment { rgb 2.2 } finish { Panel } }
box { <1.5, 2, 5>, <5, 5, 5.1> pigment { rgb <1.2, 1.5, 1.9> } finish { Panel } }


// inlaid: brass in steel, one grain over both
superellipsoid {
  <.12, .12>
  texture {
    pigment {
      hexagon rgb <.56, .55, .53>, rgb <.89, .70, .34>, rgb <.42, .42, .43>
      scale .17
    }
    finish { ambient 0 diffuse 0 mdf { ggx .06, .25 tangent x specular pigment fresnel schlick reflection { samples 32 clamp 8 } } }
  }
  scale <1.05, .3, 1.05> rotate 28*y translate <-2.35, .3, .2>
}

// damascene: two steels, folded
sphere {
  0, .95
  texture {
    pigment {
      wood turbulence .32 octaves 4
      color_map { [0 rgb .62] [.35 rgb .58] [.5 rgb .17] [.62 rgb .22] [.8 rgb .6] [1 rgb .62] }
      scale .14 rotate <70, 20, 0>
    }
    finish { ambient 0 diffuse 0 mdf { ggx .05, .22 tangent uv specular pigment fresnel schlick reflection { samples 32 clamp 8 } } }
  }
  translate <.05, .95, .3>
}

// a coin of two metals, turned
union {
  cylinder { 0, .16*y, 1.1 }
  torus { 1.06, .09 translate .13*y }
  texture {
    pigment { cylindrical color_map { [.02 rgb <.56, .55, .53>] [.40 rgb <.56, .55, .53>] [.40 rgb <.95, .56, .42>] [1 rgb <.95, .60, .46>] } scale 1.25 }
    finish { ambient 0 diffuse 0 mdf { ggx .05, .28 tangent radial y specular pigment fresnel schlick reflection { samples 32 clamp 8 } } }
  }
  rotate <-24, 0, -10> translate <2.4, .55, .3>
}

// heat colours on a brushed sheet: straw, brown, purple, blue
plane {
  y, 0
  texture {
    pigment {
      gradient x turbulence .05
      color_map {
        [0 rgb <.52, .51, .50>] [.28 rgb <.56, .52, .42>] [.42 rgb <.58, .44, .20>] [.52 rgb <.42, .20, .14>]
        [.6 rgb <.26, .14, .30>] [.7 rgb <.12, .18, .42>] [.85 rgb <.28, .38, .48>] [1 rgb <.5, .51, .52>]
      }
      scale 9 translate -4.6*x
    }
    finish { ambient 0 diffuse 0 mdf { ggx .09, .3 tangent z specular pigment fresnel schlick reflection { samples 32 clamp 8 } } }
  }
}
