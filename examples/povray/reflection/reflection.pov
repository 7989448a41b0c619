// SPDX-License-Identifier: Apache-2.0
// Brushed metal shows what stands on it, and no lamp is needed.
//   povray +Ireflection.pov +W800 +H400 +A0.1
#version 3.7;
#declare mdf_Defaults = 1;
#ifndef (mdf_Version) #error "This scene needs POV-Ray with libshade." #end
#include "libshade_metals.inc"

global_settings { assumed_gamma 1 max_trace_level 6 }
camera { location <0, 2.6, -7> look_at <0, 0.75, 0> right 2*x up y angle 44 }

// a studio: dim walls, two soft boxes
sky_sphere { pigment { gradient y color_map { [0 rgb 0.10] [1 rgb <0.22, 0.25, 0.3>] } } }
#declare Panel = finish { ambient 0 diffuse 0 emission 1 }
box { <-6, 0.5, 3.9>, <-3.2, 5, 4> pigment { rgb <2.6, 2.4, 2.1> } finish { Panel } }
box { <3.4, 0.5, 3.9>, <5.6, 4.5, 4> pigment { rgb <1.5, 1.8, 2.3> } finish { Panel } }
box { <-4, 6, -5>, <4, 6.1, -1> pigment { rgb 2.2 } finish { Panel } }

// long strokes across the sight: what stands behind is drawn out towards the eye
box {
  <-7, -0.2, -3>, <7, 0, 4>
  pigment { rgb 0 }
  finish {
    ambient 0 diffuse 0
    mdf {
      ggx 0.03, 0.25 tangent x specular rgb <0.56, 0.55, 0.53> fresnel schlick
      reflection { samples 24 clamp 8 }
    }
  }
}

#declare Turned = finish {
  ambient 0 diffuse 0
  mdf {
    ggx 0.06, 0.3 tangent radial y specular rgb <0.95, 0.79, 0.48> fresnel schlick
    reflection { samples 24 clamp 8 }
  }
}
#declare Matt = finish { ambient 0 diffuse 0 emission 0.02 mdf { specular 0 diffuse lambert rgb <0.7, 0.1, 0.07> } }

cylinder { 0, 1.5*y, 0.7 pigment { rgb 0 } finish { Turned } translate <-1.9, 0, 0.2> }
sphere {
  <0, 0.85, 0>, 0.85
  pigment { rgb 0 }
  finish { ambient 0 diffuse 0 mdf { ggx 0.05, 0.3 tangent uv specular rgb <0.93, 0.6, 0.47> fresnel schlick reflection { samples 24 clamp 8 } } }
}
box { <-0.6, 0, -0.6>, <0.6, 1.2, 0.6> rotate 35*y translate <1.95, 0, 0.3> pigment { checker rgb <0.75, 0.12, 0.08> rgb 0.7 scale 0.3 } finish { ambient 0 diffuse 0 emission 0.8 } }
