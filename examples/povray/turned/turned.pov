// SPDX-License-Identifier: Apache-2.0
// Where strokes run: round an axis, along an axis of the texture, along u of the object.
//
//   build/povray/povray +Iexamples/povray/turned/turned.pov +Obuild/turned.png \
//     +W800 +H400 +A0.1
#version 3.7;
#declare mdf_Defaults = 1;
#ifndef (mdf_Version)
  #error "This scene needs POV-Ray with libshade.\n"
#end
global_settings { assumed_gamma 1 }

camera {
  location <0, 4.4, -9>
  right 2*x up y
  angle 44
  look_at <0, 0.75, 0>
}
light_source { <-6, 8, -6> rgb 0.6 }
light_source { <6, 7, -5> rgb <0.35, 0.40, 0.50> }
light_source { <1, 9, 7> rgb 0.6 }
background { rgb <0.012, 0.014, 0.018> }

#declare Steel = texture {
  pigment { rgb 0 }
  finish {
    ambient 0.08 diffuse 0
    mdf {
      roughness 1/250, 1/4 // along and across the strokes
      fresnel schlick
      specular rgb <0.56, 0.55, 0.53>
      diffuse lambert 0.03
      tangent x
    }
  }
}

// A lid from the lathe: strokes round its axis, on top and on the side. The axis lies in the
// texture's space and moves with the object.
cylinder {
  0, 0.5*y, 1.25
  texture { Steel finish { mdf { tangent radial y } } }
  rotate <-14, 0, -8>
  translate <-2.75, 0.45, 0.2>
}

// One texture over a union: one grain, turned with it.
union {
  sphere { <-0.5, 0.8, 0>, 0.8 }
  sphere { <0.6, 0.55, -0.35>, 0.55 }
  cylinder { <-0.5, 0.8, 0>, <0.6, 0.55, -0.35>, 0.3 }
  texture { Steel rotate 90*z }
}

// Each object its own grain: round a ring along u, and along v when the texture is turned.
#declare Gold = texture { Steel finish { mdf { tangent uv specular rgb <1.00, 0.78, 0.34> } } }
torus { 0.8, 0.28 texture { Gold } rotate -24*x translate <2.7, 0.6, 0.5> }
torus { 0.38, 0.17 texture { Gold rotate 90*z } rotate -24*x translate <2.7, 0.75, 0.35> }

// A diffuse floor by the block: what `diffuse 0.2` with this pigment would be.
plane {
  y, 0
  pigment { rgb 1 }
  finish { ambient 0 diffuse 0 mdf { specular 0 diffuse lambert rgb <0.18, 0.19, 0.21> } }
}
