// SPDX-License-Identifier: Apache-2.0
// The monkey of examples/blender/suzanne with a scene author's own metals.
//
// Camera, lights and meshes come from the Blender file; `make demo` leaves them in
// build/demo/povray. From the root of the repository:
//
//   build/povray/povray +Iexamples/povray/suzanne/suzanne.pov +Lbuild/demo/povray \
//     +Obuild/suzanne.png +W960 +H720 +A0.1
#version 3.7;
#declare mdf_Defaults = 1;
global_settings { assumed_gamma 1 }

#include "camera.inc"
#include "lights.inc"
background { rgb <0.012, 0.014, 0.018> }

// meshes.inc wears the names of the Blender materials: say here what they are.
#declare Metal_Brushed_steel = texture {
  pigment { rgb 1 }
  normal { bumps 0.12 scale 0.1 } // POV-Ray's own bumps: the grooves follow them
  finish {
    ambient 0 diffuse 0
    mdf {
      ashikhmin_shirley 120, 3  // narrow along the brush strokes, wide across them
      detail rotate
      fresnel schlick
      specular rgb <0.91, 0.72, 0.36>
      tangent uv                // strokes run along u of the mesh
    }
  }
}
#declare Metal_Turned_steel = texture {
  pigment { rgb 1 }
  finish {
    ambient 0 diffuse 0
    mdf {
      ashikhmin_shirley 70, 4
      detail rotate
      fresnel schlick
      specular rgb <0.62, 0.62, 0.65>
      tangent uv
      bump_image { png "../textures/turned.png" filter off }
    }
  }
}

#include "meshes.inc"
object { Mesh_Turntable }
object { Mesh_Suzanne rotate 14*x rotate -24*y translate 0.945*y }
