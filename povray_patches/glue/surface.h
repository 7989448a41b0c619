// SPDX-License-Identifier: AGPL-3.0-or-later
// From POV-Ray's intersection to the plain vectors that libshade shades.
#ifndef POVRAY_BACKEND_MDF_SURFACE_H
#define POVRAY_BACKEND_MDF_SURFACE_H

#include <vector>

#include "backend/frame.h"
#include "backend/mdf/dump.h"
#include "backend/mdf/material.h"

namespace pov {

// How much wider a ray gets, for each unit on, where it is reflected by a curved surface: 2 · width
// · mean curvature; less than 0 where it is hollow. For scenes with a block that uses footprints.
double Mdf_Mirror_Spread(const Intersection &isect, const Vector3d &raw_normal, double width,
                         TraceThreadData *thread);

// Remembers what a lamp looks like: reflections leave it out, whose light is a highlight already.
void Mark_Mdf_Lamp(ObjectBase *object);

// Whether rays may pass between the yarns of a finish's cloth.
bool Mdf_Is_Open(const FINISH *finish);

// Moves the space of a finish's tangent by a texture's transformation.
// with_object: the object goes the same way, and with it what `tangent uv` takes from it.
void Transform_Mdf(FINISH *finish, const TRANSFORM *transform, bool with_object);

// One texture layer at one intersection. Does nothing where the layer's finish
// has no mdf block, or one that gives nothing to such a ray.
class MdfHit {
public:
  // Of a finish without a block: all that finishes of POV-Ray's own pay for.
  MdfHit() : gaps(0.0) {}

  // For one that has a block. raw_normal and layer_normal: before and after `normal { }`, facing
  // the eye. warps: the patterns around the layer's texture, the outermost first; point:
  // isect.IPoint in the layer's space. opacity: of the layer's pigment, for the
  // diffuse part. pixel: of the dump, or -1. roughness: the alpha that rough surfaces before this
  // one spread the ray by; width: how wide it is here. pigment: the layer's colour.
  void Prepare(const FINISH *finish, const Intersection &isect, const Ray &ray,
               const Vector3d &raw_normal, const Vector3d &layer_normal,
               const std::vector<const TEXTURE *> &warps, const Vector3d &point, double opacity,
               TraceThreadData *thread, mdf::Dump *dump = NULL, int pixel = -1,
               double roughness = 0.0, double width = 0.0,
               const RGBColour &pigment = RGBColour(1.0));

  // What share of a ray passes between the yarns of a cloth without a backing. Of the layer's own
  // transparency what it leaves is added.
  double Gaps() const { return gaps; }
  static RGBColour Through(const RGBColour &transparency, double gaps) {
    return gaps == 0.0 ? transparency : Between(transparency, gaps);
  }
  // The same for a shadow ray.
  static double ShadowGaps(const FINISH *finish, const Intersection &isect, const Ray &ray,
                           const Vector3d &raw_normal, TraceThreadData *thread, double width);

  bool HasBlock() const { return shaded.has_material(); }
  // Adds the slopes of its bumps.
  void Look(double share, mdf::Bumps &to) const { shaded.look(place, share, to); }

  // Can light from this direction give anything?
  bool Faces(const VECTOR direction) const { return HasBlock() && Meets(direction); }

  // Adds what the layer reflects of light of this colour from this unit
  // direction: its highlight, its diffuse part, or both. POV-Ray's diffuse term is
  // albedo · cos · colour, without 1/pi: its colour stands for an irradiance of
  // pi · colour. Light of no single source (photons, parts of an area light) is NULL: not dumped.
  void AddLight(const VECTOR direction, const RGBColour &light_colour, bool highlight, bool diffuse,
                const LightSource *light, RGBColour &colour) const;

  // What share of even light the diffuse part reflects, and the rest: of a cloth, all of it.
  RGBColour DiffuseAlbedo() const;
  RGBColour SpecularAlbedo() const;
  // What conserve_energy takes from the layers below.
  RGBColour ConservedAlbedo() const;

  // `reflection { }`: at most how many rays, and the least roughness of the lobes behind.
  bool Reflects() const { return HasBlock() && shaded.of().reflects; }
  unsigned int Rays() const { return (unsigned int)shaded.of().rays; }
  double Roughness() const { return shaded.of().roughness; }
  // Where ray number `index` of them goes, and the share of its light that is reflected. False:
  // there is none. The same for the same hit, whoever asks. seed: of Seed().
  bool Sample(unsigned int index, const unsigned int seed[2], Vector3d &direction,
              RGBColour &throughput) const;
  static void Seed(const VECTOR point, const VECTOR direction, int layer, unsigned int seed[2]);
  // The same for the only one of a hit.
  bool SampleAlone(const unsigned int seed[2], Vector3d &direction, RGBColour &throughput) const;
  // The same for all Rays() of a hit that no reflection came before, which know of each other, and
  // of those of the pixels beside theirs: of PixelSeed().
  bool SampleLattice(unsigned int index, unsigned int pixel, const unsigned int seed[2],
                     Vector3d &direction, RGBColour &throughput) const;
  // For what a pixel of the picture meets: the number of the pixel, its bits by turns of x and y.
  // Samples of anti-aliasing at one place within their pixels make a picture of their own.
  static unsigned int PixelSeed(double x, double y, unsigned int seed[2]);
  // What a hit on a path from there draws by. level: how deep it is.
  static void PathSeed(const unsigned int pixel[2], unsigned int level, const Ray &ray, int layer,
                       unsigned int seed[2]);
  // By what the shares of textures averaged there are moved along a hit's rays, in [0, rays): each
  // ray is any texture's. index: which path comes there.
  static double Chance(const unsigned int seed[2], unsigned int index, unsigned int rays);
  // What came along a ray, no brighter than the block allows.
  void Clamp(RGBColour &colour) const;

private:
  static RGBColour Between(const RGBColour &transparency, double gaps);
  mdf::ShadedPoint shaded;
  UV_VECT place; // of the bump image; 0 where there is none
  double gaps;
  // where there is a block
  mdf::Dump *dump;
  int pixel;
  int global_lights;
  double opacity;
  bool both_sides; // double_illuminate
  bool simple;     // both parts may be lit by one call
  int level;       // of Material::regularized, or -1

  bool Meets(const VECTOR direction) const;
  bool SampleBy(const double u[3], Vector3d &direction, RGBColour &throughput) const;
  void Record(const LightSource *light, const VECTOR direction, const double E[3],
              const double S[3]) const;
  void RecordParts(const LightSource *light, const VECTOR direction, const double E[3]) const;
};

} // namespace pov

#endif
