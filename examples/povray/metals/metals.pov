// SPDX-License-Identifier: Apache-2.0
// Brushed metal on POV-Ray's own shapes: what to write, and where the strokes run.
//
//   build/povray/povray +Iexamples/povray/metals/metals.pov +Obuild/metals.png \
//     +W800 +H400 +A0.1
#version 3.7;
#declare mdf_Defaults = 1;
global_settings { assumed_gamma 1 }

camera {
  location <0, 3.2, -9>
  right 2*x up y
  angle 52
  look_at <0, 0.85, 0>
}
light_source { <-6, 8, -6> rgb 0.60 }
light_source { <7, 5, -4> rgb <0.35, 0.40, 0.50> }
light_source { <2, 9, 6> rgb 0.55 }
background { rgb <0.012, 0.014, 0.018> }

// Ashikhmin-Shirley's exponents: the larger one lies along the strokes.
#macro Brushed(Colour, Along, Across)
  ambient 0.08 diffuse 0 // what is not lit shows the room's even light
  mdf {
    ashikhmin_shirley Along, Across
    detail rotate
    fresnel schlick
    specular Colour
  }
#end

// Turned on a lathe: u of a sphere runs around its axis, and so do the strokes.
sphere {
  0, 1
  texture {
    pigment { rgb 0 }
    normal { wrinkles 0.08 scale <0.9, 0.04, 0.9> }
    finish { Brushed(rgb <0.95, 0.64, 0.54>, 120, 3) }
  }
  rotate -15*z
  translate <-2.7, 1, 0>
}

// Hammered: POV-Ray's normal bends the surface, the strokes follow it.
torus {
  0.85, 0.38
  texture {
    pigment { rgb 0 }
    normal { bumps 0.18 scale 0.16 }
    finish { Brushed(rgb <1.00, 0.78, 0.34>, 200, 4) }
  }
  rotate -60*x
  translate <0, 1.15, 0>
}

// Strokes along an axis of the object, wherever its faces look.
box {
  -0.8, 0.8
  texture {
    pigment { rgb 0 }
    normal { wrinkles 0.06 scale <0.9, 0.04, 0.9> } // a grain along x
    finish {
      ambient 0.08 diffuse 0
      mdf {
        ashikhmin_shirley 300, 3
        detail rotate
        fresnel schlick
        specular rgb <0.46, 0.45, 0.44>
        tangent x
      }
    }
  }
  rotate 46*y
  translate <2.7, 0.8, 0>
}

// An ordinary floor: mdf lives beside POV-Ray's own finishes.
plane {
  y, 0
  pigment { rgb 0.18 }
  finish { ambient 0 diffuse 0.6 }
}
