// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/texturespace.h"

#include <cmath>

#include "backend/mdf/vectors.h"
#include "backend/pattern/pattern.h"
#include "backend/pattern/warps.h"
#include "backend/scene/objects.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {
namespace glue {

namespace {

// A direction in the innermost of these textures, in the space around them all.
// As for normals, transformations count; warps that bend space or repeat it do
// not.
Vector3d out_of(const std::vector<const TEXTURE *> &warps, Vector3d direction) {
  for (size_t i = warps.size(); i-- > 0;) {
    const WARP *warp = warps[i]->Warps;
    while (warp != NULL && warp->Next_Warp != NULL)
      warp = warp->Next_Warp;
    for (; warp != NULL; warp = warp->Prev_Warp)
      if (warp->Warp_Type == TRANSFORM_WARP)
        direction = transformed(direction, &reinterpret_cast<const TRANS *>(warp)->Trans);
  }
  return direction;
}

// A tangent without its part along the normal, by a step along `upright`.
Vector3d projected(const Vector3d &tangent, const Vector3d &upright, const Vector3d &normal) {
  return tangent - upright * (dot(tangent, normal) / dot(upright, normal));
}

} // namespace

// Where a texture is laid out by UV coordinates it has no place in space; its
// axes are the object's.
bool TextureSpace::mapped_by_uv() const {
  for (size_t i = 0; i < warps.size(); i++)
    if (warps[i]->Type == UV_MAP_PATTERN)
      return true;
  return Test_Flag(isect.Object, UV_FLAG) != 0;
}

// A direction in the space of the block's tangent, in world space.
Vector3d TextureSpace::to_world(const Vector3d &direction) const {
  const Vector3d in_texture = transformed(direction, finish->Mdf_Space);
  return mapped_by_uv() ? transformed(in_texture, isect.Object->UV_Trans)
                        : out_of(warps, in_texture);
}

// From the centre of `tangent radial` to the intersection, in the space of the block's tangent.
Vector3d TextureSpace::from_centre() const {
  const Vector3d p =
      mapped_by_uv() ? inverse_point(Vector3d(isect.IPoint), isect.Object->UV_Trans) : place;
  return inverse_point(p, finish->Mdf_Space) - Vector3d(finish->Mdf->centre);
}

Vector3d TextureSpace::tangent(const Vector3d &axis) const {
  const bool radial = finish->Mdf->tangent == mdf::Material::TANGENT_RADIAL;
  return to_world(radial ? cross(axis, from_centre()) : axis);
}

// u along circles, v outward, or along the axis where the surface faces away from it. Lengths are
// those of the texture's space. Circles are taken by rings: in each a whole number of tiles goes
// round.
bool TextureSpace::radial_plane(const Vector3d &normal, UV_VECT uv, Vector3d &du,
                                Vector3d &dv) const {
  const double RINGS = 4.0; // as wide as a quarter of a tile: by then their scale is off
  const mdf::Material &material = *finish->Mdf;
  const Vector3d axis = Vector3d(material.axis).normalized(), first = any_tangent(axis);
  const double tile = 1.0 / material.scratches->per_unit();
  const Vector3d p = from_centre();
  const double height = dot(p, axis);
  const Vector3d arm = p - height * axis;
  const double radius = arm.length();
  if (!(radius > 0.0) || !std::isfinite(radius))
    return false;

  const double ring = (std::floor(RINGS * radius / tile) + 0.5) * tile / RINGS;
  const double round = max(std::floor(2.0 * M_PI * ring / tile + 0.5), 1.0) * tile / (2.0 * M_PI);
  const Vector3d along = to_world(cross(axis, arm) / round), out = to_world(arm / radius),
                 up = to_world(axis);
  const bool face = fabs(dot(up, normal)) * out.length() > fabs(dot(out, normal)) * up.length();
  const Vector3d outward = face ? out : up, upright = face ? up : out;
  uv[U] = round * atan2(dot(arm, cross(axis, first)), dot(arm, first));
  uv[V] = face ? radius : height;
  du = projected(along, upright, normal);
  dv = projected(outward, upright, normal);
  return is_finite(du) && is_finite(dv);
}

PlaneTransform::PlaneTransform() : m{{1.0, 0.0}, {0.0, 1.0}}, offset{0.0, 0.0}, det(1.0) {}

// Where transformations turn the plane out of itself (for the axis of a lathe, say) it stays: by
// their lengths, and where its u goes.
PlaneTransform::PlaneTransform(const MATRIX matrix) : offset{matrix[3][X], matrix[3][Y]} {
  const double along = Vector3d(matrix[X]).length(), up = Vector3d(matrix[Y]).length();

  for (int i = X; i <= Y; i++)
    for (int j = X; j <= Y; j++)
      m[i][j] = matrix[i][j];
  if (!(fabs(matrix[X][Z]) <= 1e-9 * along && fabs(matrix[Y][Z]) <= 1e-9 * up)) {
    const double flat = std::sqrt(m[X][X] * m[X][X] + m[X][Y] * m[X][Y]);
    const bool upright = !(flat > 1e-9 * along);
    const double c = upright ? 1.0 : m[X][X] / flat, s = upright ? 0.0 : m[X][Y] / flat;
    const double hand = m[X][X] * m[Y][Y] - m[X][Y] * m[Y][X] < -1e-9 * along * up ? -up : up;
    m[X][X] = along * c;
    m[X][Y] = along * s;
    m[Y][X] = -hand * s;
    m[Y][Y] = hand * c;
  }
  det = m[X][X] * m[Y][Y] - m[X][Y] * m[Y][X];
}

bool planar_plane(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &normal,
                  UV_VECT uv, Vector3d &du, Vector3d &dv) {
  const ObjectBase *object = isect.Object;
  const TRANSFORM *space = kind == mdf::Shape::CONE ? object->Trans : object->UV_Trans;
  const Vector3d p = inverse_point(Vector3d(isect.IPoint), space);
  Vector3d n(normal), along, across, upright;

  if (space != NULL)
    MInvTransNormal(*n, *n, space);
  int up = fabs(n[X]) > fabs(n[Y]) ? X : Y;
  if (fabs(n[Z]) > fabs(n[up]))
    up = Z;
  if (kind == mdf::Shape::CONE && fabs(p[X] * n[X] + p[Y] * n[Y]) > 1e-6 * n.length()) {
    const double r = std::sqrt(p[X] * p[X] + p[Y] * p[Y]); // its side; it stands on z
    uv[U] = atan2(p[Y], p[X]) / (2.0 * M_PI);
    uv[V] = p[Z];
    along = 2.0 * M_PI * Vector3d(-p[Y], p[X], 0.0);
    across = axis_vector(Z);
    upright = Vector3d(p[X] / r, p[Y] / r, 0.0);
  } else {
    const int first = up == X ? Z : X, second = up == Y ? Z : Y;
    uv[U] = p[first];
    uv[V] = p[second];
    along = axis_vector(first);
    across = axis_vector(second);
    upright = axis_vector(up);
  }
  upright = transformed(upright, space);
  du = projected(transformed(along, space), upright, normal);
  dv = projected(transformed(across, space), upright, normal);
  return is_finite(du) && is_finite(dv);
}

mdf::ClothPlace cloth_place(const mdf::Cloth &cloth, const PlaneTransform &plane, const UV_VECT uv,
                            const Vector3d &du, const Vector3d &dv, const Vector3d &N,
                            const Vector3d &T, const Vector3d &eye, double width, bool mirrored) {
  const double(*const m)[2] = plane.m, det = plane.det;
  const double u = uv[U] - plane.offset[U], v = uv[V] - plane.offset[V];
  mdf::ClothPlace place = {{0.0, 0.0}, {0.0, 0.0}, false};

  if (det == 0.0 || !std::isfinite(det))
    return place;
  const Vector3d along = m[X][X] * du + m[X][Y] * dv, up = m[Y][X] * du + m[Y][Y] * dv;
  const double hand = (dot(cross(T, N), up) < 0.0) != mirrored ? -1.0 : 1.0;
  place.uv[0] = (u * m[Y][Y] - v * m[Y][X]) / det;
  place.uv[1] = hand * (v * m[X][X] - u * m[X][Y]) / det;
  // A step q across the ray goes along the ray until it meets the surface again; of the steps as
  // long as the ray is wide the largest says the extent. A thousand widths are enough.
  const Vector3d across_v = cross(up, eye), across_u = cross(eye, along);
  const double least = 1e-3 * across_v.length() * along.length();
  const double area = max(fabs(dot(along, across_v)), least);
  const double scale = area > 0.0 ? width / area : 0.0;
  place.footprint[0] = scale * across_v.length();
  place.footprint[1] = scale * across_u.length();
  for (int axis = 0; axis < 2; axis++) {
    // yarns have edges: what a dump can say is what is looked up
    place.uv[axis] = (float)clip(place.uv[axis] * cloth.per_unit(axis), -1e8, 1e8);
    place.footprint[axis] = (float)clip(place.footprint[axis] * cloth.per_unit(axis), 0.0, 1e8);
  }
  // less than a quarter of a yarn: one point of it says as much as sixteen
  if (max(place.footprint[0], place.footprint[1]) < 0.25)
    place.footprint[0] = place.footprint[1] = 0.0;
  return place;
}

void uv_footprint(const Vector3d &du, const Vector3d &dv, const Vector3d &eye, double width,
                  double footprint[4]) {
  const Vector3d across_v = cross(dv, eye), across_u = cross(eye, du);
  const double least = 1e-3 * across_v.length() * du.length();
  double area = dot(du, across_v);

  if (fabs(area) < least)
    area = area < 0.0 ? -least : least;
  const Vector3d first = any_tangent(eye), second = cross(eye, first);
  const double scale = area != 0.0 ? width / area : 0.0;
  footprint[0] = scale * dot(first, across_v);
  footprint[1] = scale * dot(first, across_u);
  footprint[2] = scale * dot(second, across_v);
  footprint[3] = scale * dot(second, across_u);
}

bool map_frame(const Vector3d &raw_normal, bool front, const Vector3d &du, const Vector3d &dv,
               Vector3d &tangent, Vector3d &bitangent) {
  tangent = du;
  if (!orthogonalise(tangent, raw_normal))
    return false;
  bitangent = cross(raw_normal, tangent);
  if (dot(bitangent, dv) < 0.0)
    bitangent = -bitangent;
  if (!front) {
    tangent = -tangent;
    bitangent = -bitangent;
  }
  return true;
}

Vector3d image_normal(const mdf::Material &material, const UV_VECT uv, const double footprint[4],
                      const Vector3d &map_x, const Vector3d &map_y, const Vector3d &up,
                      double covariance[3]) {
  double at[2], over[4], n[3], spread[3];

  for (int axis = 0; axis < 2; axis++) {
    at[axis] = (uv[axis] - material.bump_move[axis]) / material.bump_scale[axis];
    over[axis] = material.filtered ? footprint[axis] / material.bump_scale[axis] : 0.0;
    over[2 + axis] = material.filtered ? footprint[2 + axis] / material.bump_scale[axis] : 0.0;
  }
  if (material.bump_once) { // its picture is half as wide as the one around it
    if (!material.bump->within(at))
      return up;
    for (int i = 0; i < 4; i++)
      over[i] *= 0.5;
  }
  material.bump->normal(at[0], at[1], material.strength, over, material.slopes.get(), n, spread);
  for (int i = 0; i < 3; i++)
    covariance[i] += spread[i];
  return n[X] * map_x + n[Y] * map_y + n[Z] * up;
}

Slopes scratch_slopes(const mdf::Material &material, const PlaneTransform &plane, const UV_VECT uv,
                      const double footprint[4]) {
  const double(*const m)[2] = plane.m, det = plane.det;
  const double per_unit = material.scratches->per_unit();
  // from the plane to the texture's: the inverse of m there
  const double back[2][2] = {{per_unit * m[Y][Y] / det, -per_unit * m[Y][X] / det},
                             {-per_unit * m[X][Y] / det, per_unit * m[X][X] / det}};
  const double u = uv[U] - plane.offset[U], v = uv[V] - plane.offset[V];
  Slopes result;
  double over[4];
  shade_slopes found;

  for (int side = 0; side < 2; side++)
    for (int axis = 0; axis < 2; axis++)
      over[2 * side + axis] =
          back[axis][0] * footprint[2 * side] + back[axis][1] * footprint[2 * side + 1];
  if (material.field->slopes(back[0][0] * u + back[0][1] * v, back[1][0] * u + back[1][1] * v, over,
                             &found) &
      SHADE_BAD_INPUT)
    return result;
  result.share = material.field->scratched(&found);
  // slopes back on the surface: along its own u and v, where the texture turned them
  const double length = std::sqrt(fabs(det));
  const double a = m[X][X] / length, b = m[X][Y] / length, c = m[Y][X] / length,
               d = m[Y][Y] / length;
  const double *const s = found.mean, *const k = found.covariance;
  result.mean[0] = a * s[0] + c * s[1];
  result.mean[1] = b * s[0] + d * s[1];
  result.covariance[0] = a * a * k[0] + 2.0 * a * c * k[1] + c * c * k[2];
  result.covariance[1] = a * b * k[0] + (a * d + b * c) * k[1] + c * d * k[2];
  result.covariance[2] = b * b * k[0] + 2.0 * b * d * k[1] + d * d * k[2];
  return result;
}

Vector3d add_slopes(const Vector3d &a, const Vector3d &b, const Vector3d &up) {
  const double az = dot(a, up), bz = dot(b, up);
  return ((a - az * up) * bz + (b - bz * up) * az + (az * bz) * up).normalized();
}

} // namespace glue
} // namespace pov
