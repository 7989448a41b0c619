// SPDX-License-Identifier: Apache-2.0
// Averaged normals, and one word in their place: on the left twelve textures with bumps of their own are
// averaged, as one blurred a mirror before; on the right one block does it, with strokes.
//
//   build/povray/povray +Iexamples/povray/cookbook/averaged_normals.pov +Obuild/averaged_normals.png +W640 +H360 +A0.3 +AM2
#version 3.7;
#declare mdf_Defaults = 1;
#ifndef (mdf_Version) #error "This scene needs POV-Ray with libshade." #end
global_settings { assumed_gamma 1 }

camera { location <0, 2.2, -6> right 16/9*x up y angle 45 look_at <0, .75, 0> }
light_source { <-5, 7, -4>, rgb .5 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .1] [.5 rgb <.3, .33, .38>] [1 rgb <.7, .75, .85>] } scale 2 translate -y } }
box { <-5, 1, 5>, <-2, 5, 5.1> pigment { rgb 2.4 } finish { ambient 0 diffuse 0 emission 1 } }
box { <2.4, .5, 4>, <5, 4, 4.1> pigment { rgb <1.3, 1.6, 2> } finish { ambient 0 diffuse 0 emission 1 } }
plane { y, 0 pigment { checker rgb <.45, .12, .08>, rgb .5 scale .5 } finish { ambient .1 diffuse .7 } }

// before: many mirrors, each bumped in another way
#declare Averaged = texture {
  average
  texture_map {
    #for (I, 1, 12)
      [1 pigment { rgb <.9, .7, .4> } normal { bumps .45 scale <.6, .03, .03> translate 7*I } finish { ambient 0 diffuse 0 metallic reflection { .9 metallic } specular .05 roughness .02 }]
    #end
  }
}

// after: rays are sent where a brushed metal sends light
#declare Block = texture {
  pigment { rgb 0 }
  finish { ambient 0 diffuse 0 mdf { ggx .06, .3 specular rgb <.9, .7, .4> fresnel schlick reflection { samples 12 clamp 10 } } }
}

sphere { 0, 1 texture { Averaged } translate <-1.25, 1, 0> }
sphere { 0, 1 texture { Block } translate <1.25, 1, 0> }
