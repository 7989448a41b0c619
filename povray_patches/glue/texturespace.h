// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a hit lies in the space of its texture and in the (u, v) plane of what is laid out there:
// cloth, bump images, scratches. What these do to its normal.
#ifndef POVRAY_BACKEND_MDF_TEXTURESPACE_H
#define POVRAY_BACKEND_MDF_TEXTURESPACE_H

#include <vector>

#include "backend/frame.h"
#include "backend/mdf/material.h"

namespace pov {
namespace glue {

// The space of a layer's texture at an intersection. warps: the patterns around it, the outermost
// first; point: the intersection in the layer's space.
class TextureSpace {
public:
  TextureSpace(const FINISH *f, const Intersection &i, const std::vector<const TEXTURE *> &w,
               const Vector3d &p)
      : finish(f), isect(i), warps(w), place(p) {}

  // The direction of TANGENT_AXIS or TANGENT_RADIAL, world space, of any length. axis: the
  // material's, or what takes its place.
  Vector3d tangent(const Vector3d &axis) const;
  // The (u, v) plane of scratches round the axis of `tangent radial`.
  bool radial_plane(const Vector3d &normal, UV_VECT uv, Vector3d &du, Vector3d &dv) const;

private:
  const FINISH *const finish;
  const Intersection &isect;
  const std::vector<const TEXTURE *> &warps;
  const Vector3d &place;

  bool mapped_by_uv() const;
  Vector3d to_world(const Vector3d &direction) const;
  Vector3d from_centre() const;
};

// A (u, v) plane for cloth and scratches on objects that have none of their own, or one to
// another scale: round and along a cone, by two of the object's axes else, of which the surface
// faces the third most. A unit of u or v is one of the object's space; round a cone, once round.
bool planar_plane(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &normal,
                  UV_VECT uv, Vector3d &du, Vector3d &dv);

// What a texture's own transformations do to the (u, v) plane: the images of u and v, and of 0.
struct PlaneTransform {
  PlaneTransform(); // nothing
  explicit PlaneTransform(const MATRIX matrix);
  double m[2][2], offset[2], det;
};

// Where on the cloth a ray of a width meets it, in the plane that the texture's own
// transformations move. v counts so that the cloth shows its face, whichever way the object's v
// runs: T, N x T the other way (ShadedPoint) and N stand as u, v and the eye. mirrored: the other
// way round, N x T as it is.
mdf::ClothPlace cloth_place(const mdf::Cloth &cloth, const PlaneTransform &plane, const UV_VECT uv,
                            const Vector3d &du, const Vector3d &dv, const Vector3d &N,
                            const Vector3d &T, const Vector3d &eye, double width, bool mirrored);

// The footprint in the (u, v) plane of a ray of a width: two steps across it go along the
// ray until they meet the surface again; no further than a thousand widths.
void uv_footprint(const Vector3d &du, const Vector3d &dv, const Vector3d &eye, double width,
                  double footprint[4]);

// The frame of a normal map: dP/du upright on the normal, and the perpendicular of both on the side
// of dP/dv: what handedness · N x T is in a right-handed space. Seen from behind, a bump is a dent:
// both turn round.
bool map_frame(const Vector3d &raw_normal, bool front, const Vector3d &du, const Vector3d &dv,
               Vector3d &tangent, Vector3d &bitangent);

// A normal of the bump image over a footprint in the (u, v) plane, world space. Adds what slopes
// do about it to a covariance in the map's frame.
Vector3d image_normal(const mdf::Material &material, const UV_VECT uv, const double footprint[4],
                      const Vector3d &map_x, const Vector3d &map_y, const Vector3d &up,
                      double covariance[3]);

// Slopes in the (u, v) plane: of a share of what is seen.
struct Slopes {
  Slopes() : share(0.0), mean(), covariance() {}
  double share, mean[2], covariance[3];
};

// The slopes of scratches, which transformations turn and scale in the plane, on the part of a
// footprint that they cover. share 0: none.
Slopes scratch_slopes(const mdf::Material &material, const PlaneTransform &plane, const UV_VECT uv,
                      const double footprint[4]);

// The normal of two bumps on one surface: their slopes -n.xy/n.z add, as heights would.
Vector3d add_slopes(const Vector3d &a, const Vector3d &b, const Vector3d &up);

} // namespace glue
} // namespace pov

#endif
