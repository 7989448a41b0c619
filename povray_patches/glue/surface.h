// SPDX-License-Identifier: AGPL-3.0-or-later
// From POV-Ray's intersection to the plain vectors that libshade shades.
#ifndef POVRAY_BACKEND_MDF_SURFACE_H
#define POVRAY_BACKEND_MDF_SURFACE_H

#include <vector>

#include "backend/frame.h"
#include "backend/mdf/dump.h"
#include "backend/mdf/material.h"

namespace pov {

class Mesh;

// How the tangents of an object are found. Meshes: mdf_add_mesh.
mdf::Shape::Kind mdf_kind(const ObjectBase *object);

// Computes the tangents of a mesh (once per MESH_DATA) for the render threads.
// Returns how many of its corners have no UV direction. Throws std::bad_alloc.
long mdf_add_mesh(const Mesh *mesh, mdf::Scene &scene);

// Remembers what a lamp looks like: reflections leave it out, whose light is a highlight already.
void Mark_Mdf_Lamp(ObjectBase *object);

// Moves the space of a finish's tangent by a texture's transformation.
// with_object: the object goes the same way, and with it what `tangent uv` takes from it.
void Transform_Mdf(FINISH *finish, const TRANSFORM *transform, bool with_object);

// One texture layer at one intersection. Does nothing where the layer's finish
// has no mdf block, or one that gives nothing to such a ray.
class MdfHit {
public:
  // raw_normal and layer_normal: before and after `normal { }`, facing the
  // eye. warps: the patterns around the layer's texture, the outermost first; point:
  // isect.IPoint in the layer's space. opacity: of the layer's pigment, for the
  // diffuse part. pixel: of the dump, or -1. width: the alpha that rough surfaces before this one
  // spread the ray by.
  MdfHit(const FINISH *finish, const Intersection &isect, const Ray &ray,
         const Vector3d &raw_normal, const Vector3d &layer_normal,
         const std::vector<const TEXTURE *> &warps, const Vector3d &point, double opacity,
         TraceThreadData *thread, mdf::Dump *dump = NULL, int pixel = -1, double width = 0.0)
      : dump(NULL), pixel(-1), global_lights(0), opacity(opacity), both_sides(false),
        level(mdf::Material::level_of(width)) {
    if (finish->Mdf != NULL)
      Prepare(finish, isect, ray, raw_normal, layer_normal, warps, point, thread, dump, pixel);
  }

  bool HasBlock() const { return shaded.has_material(); }

  // Can light from this direction give anything?
  bool Faces(const VECTOR direction) const { return HasBlock() && shaded.faces(direction); }

  // Adds what the layer reflects of light of this colour from this unit
  // direction: its highlight, its diffuse part, or both. POV-Ray's diffuse term is
  // albedo · cos · colour, without 1/pi: its colour stands for an irradiance of
  // pi · colour. Light of no single source (photons, parts of an area light) is NULL: not dumped.
  void AddLight(const VECTOR direction, const RGBColour &light_colour, bool highlight, bool diffuse,
                const LightSource *light, RGBColour &colour) const;

  // What share of even light the diffuse part reflects.
  RGBColour DiffuseAlbedo() const;
  RGBColour SpecularAlbedo() const;

  // `reflection { }`: at most how many rays, and what the lobes behind are widened to.
  bool Reflects() const { return HasBlock() && shaded.of().reflects; }
  unsigned int Rays() const { return (unsigned int)shaded.of().rays; }
  double Width() const { return shaded.of().width; }
  // Where ray number `index` of them goes, and the share of its light that is reflected. False:
  // there is none. The same for the same hit, whoever asks. seed: of Seed().
  bool Draw(unsigned int index, const unsigned int seed[2], Vector3d &direction,
            RGBColour &reflectance) const;
  static void Seed(const VECTOR point, const VECTOR direction, int layer, unsigned int seed[2]);
  // What came along a ray, no brighter than the block allows.
  void Clamp(RGBColour &colour) const;

private:
  mdf::ShadedPoint shaded;
  mdf::Dump *dump;
  int pixel;
  int global_lights;
  double opacity;
  bool both_sides; // double_illuminate
  int level;       // of the widened lobes, or -1

  const shade_bsdf &Specular() const {
    return level < 0 ? shaded.of().specular : shaded.of().widened[level];
  }

  void Prepare(const FINISH *finish, const Intersection &isect, const Ray &ray,
               const Vector3d &raw_normal, const Vector3d &layer_normal,
               const std::vector<const TEXTURE *> &warps, const Vector3d &point,
               TraceThreadData *thread, mdf::Dump *dump, int pixel);
};

} // namespace pov

#endif
