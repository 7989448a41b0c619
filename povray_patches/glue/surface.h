// SPDX-License-Identifier: AGPL-3.0-or-later
// From POV-Ray's intersection to the plain vectors that libshade shades.
#ifndef POVRAY_BACKEND_MDF_SURFACE_H
#define POVRAY_BACKEND_MDF_SURFACE_H

#include "backend/frame.h"
#include "backend/mdf/dump.h"
#include "backend/mdf/material.h"

namespace pov {

class Mesh;

// What an object's UV coordinates are good for.
enum MdfUv {
  MDF_UV_NONE,      // none, or none whose direction on the surface can be found
  MDF_UV_DIRECTION, // dP/du only: tangents, but no normal map
  MDF_UV_FULL
};

// For a mesh, mdf_add_mesh must have been called.
MdfUv mdf_uv(const ObjectBase *object, const mdf::Scene &scene);

// Computes the tangents of a mesh (once per MESH_DATA) for the render threads.
// Returns how many of its corners have no UV direction. Throws std::bad_alloc.
long mdf_add_mesh(const Mesh *mesh, mdf::Scene &scene);

// One texture layer at one intersection. Does nothing where the layer's finish
// has no mdf block.
class MdfHit {
public:
  // raw_normal and layer_normal: before and after `normal { }`, facing the
  // eye. pixel: of the dump, or -1.
  MdfHit(const mdf::Material *material, const Intersection &isect, const Ray &ray,
         const Vector3d &raw_normal, const Vector3d &layer_normal, TraceThreadData *thread,
         mdf::Dump *dump = NULL, int pixel = -1);

  // Adds what the layer reflects of light of this colour from this unit
  // direction. POV-Ray's diffuse term is albedo · cos · colour, without
  // 1/pi: its colour stands for an irradiance of pi · colour. Light of no
  // single source (photons, parts of an area light) is NULL: not dumped.
  void AddLight(const VECTOR direction, const RGBColour &light_colour, const LightSource *light,
                RGBColour &colour) const;

private:
  mdf::ShadedPoint point;
  mdf::Dump *dump;
  int pixel;
  int global_lights;
};

} // namespace pov

#endif
