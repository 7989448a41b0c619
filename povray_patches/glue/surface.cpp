// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/mdf/surface.h"
#include "backend/frame.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <new>

#include "backend/colour/colour.h"
#include "backend/math/matrices.h"
#include "backend/math/vector.h"
#include "backend/pattern/pattern.h"
#include "backend/pattern/warps.h"
#include "backend/scene/scene.h"
#include "backend/scene/threaddata.h"
#include "backend/shape/bezier.h"
#include "backend/shape/boxes.h"
#include "backend/shape/cones.h"
#include "backend/shape/discs.h"
#include "backend/shape/fpmetric.h"
#include "backend/shape/lathe.h"
#include "backend/shape/mesh.h"
#include "backend/shape/ovus.h"
#include "backend/shape/planes.h"
#include "backend/shape/sor.h"
#include "backend/shape/spheres.h"
#include "backend/shape/torus.h"
#include "backend/vm/fnpovfpu.h"
#include "backend/mdf/dither.h"
#include "shade/mesh.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

namespace {

Vector3d axis_vector(int axis) {
  return Vector3d(axis == X, axis == Y, axis == Z);
}

// A vector of unit length, which what POV-Ray hands over mostly has already. Further off than a few
// roundings libshade would mend what is seen of it, for each light anew.
Vector3d unit(const Vector3d &v) {
  const double square = v.lengthSqr();
  return fabs(square - 1.0) < 4e-15 ? v : v * (1.0 / std::sqrt(square));
}

bool same(const Vector3d &a, const Vector3d &b) {
  return a[X] == b[X] && a[Y] == b[Y] && a[Z] == b[Z];
}

// v without its part along the unit vector n, normalised. False if nothing is
// left.
bool orthogonalise(Vector3d &v, const Vector3d &n) {
  const double before = v.lengthSqr();
  v -= n * dot(v, n);
  const double after = v.lengthSqr();

  if (!(after > 1e-18 * before) || !std::isfinite(after))
    return false;
  v *= 1.0 / std::sqrt(after);
  if (after < 1e-2 * before) { // v was almost along n: what rounding left of it counts
    v -= n * dot(v, n);
    v.normalize();
  }
  return true;
}

Vector3d moved(const Vector3d &direction, const TRANSFORM *transform) {
  Vector3d result(direction);

  if (transform != NULL)
    MTransDirection(*result, *direction, transform);
  return result;
}

Vector3d moved(const Vector3d &direction, const MATRIX m) {
  Vector3d result(0.0);

  for (int i = X; i <= Z; i++)
    result += direction[i] * Vector3d(m[i][X], m[i][Y], m[i][Z]);
  return result;
}

// The point that a matrix moves to p.
Vector3d moved_back(const Vector3d &p, const MATRIX m) {
  const Vector3d rows[4] = {Vector3d(m[0]), Vector3d(m[1]), Vector3d(m[2]), Vector3d(m[3])};
  const Vector3d offset = p - rows[3], yz = cross(rows[1], rows[2]);

  return Vector3d(dot(offset, yz), dot(offset, cross(rows[2], rows[0])),
                  dot(offset, cross(rows[0], rows[1]))) /
         dot(rows[0], yz);
}

// Any unit vector orthogonal to a normal: z where that can be.
Vector3d any_tangent(const Vector3d &normal) {
  Vector3d tangent;

  for (int i = Z; i >= X; i--) {
    tangent = axis_vector(i);
    if (orthogonalise(tangent, normal))
      break;
  }
  return tangent;
}

// ---- tangents of a texture's space ----

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
        direction = moved(direction, &reinterpret_cast<const TRANS *>(warp)->Trans);
  }
  return direction;
}

// Where a texture is laid out by UV coordinates it has no place in space; its
// axes are the object's.
bool mapped_by_uv(const ObjectBase *object, const std::vector<const TEXTURE *> &warps) {
  for (size_t i = 0; i < warps.size(); i++)
    if (warps[i]->Type == UV_MAP_PATTERN)
      return true;
  return Test_Flag(object, UV_FLAG) != 0;
}

// The direction of TANGENT_AXIS or TANGENT_RADIAL, world space, of any length. axis: the
// material's, or what takes its place.
Vector3d texture_direction(const mdf::Material &material, const Vector3d &axis,
                           const FINISH *finish, const Intersection &isect,
                           const std::vector<const TEXTURE *> &warps, const Vector3d &point) {
  const bool by_uv = mapped_by_uv(isect.Object, warps);
  Vector3d direction(axis);

  if (material.tangent == mdf::Material::TANGENT_RADIAL) {
    Vector3d p(point);
    if (by_uv) {
      p = Vector3d(isect.IPoint);
      if (isect.Object->UV_Trans != NULL)
        MInvTransPoint(*p, isect.IPoint, isect.Object->UV_Trans);
    }
    direction = cross(direction, moved_back(p, finish->Mdf_Space) - Vector3d(material.centre));
  }
  direction = moved(direction, finish->Mdf_Space);
  return by_uv ? moved(direction, isect.Object->UV_Trans) : out_of(warps, direction);
}

// ---- meshes ----

struct Corners {
  const MESH_TRIANGLE *triangle;
  long position[3], normal[3], uv[3];
  int order[3]; // libshade's corner k is ours order[k]
};

Vector3d vertex(const MESH_DATA *data, long index) {
  return Vector3d(data->Vertices[index][X], data->Vertices[index][Y], data->Vertices[index][Z]);
}

Vector3d normal(const MESH_DATA *data, long index) {
  return Vector3d(data->Normals[index][X], data->Normals[index][Y], data->Normals[index][Z]);
}

// MikkTSpace takes a triangle's winding for its outside. A POV-Ray mesh may be
// wound either way (its parser swaps corners too), so the normals decide.
Corners corners_of(const MESH_DATA *data, const MESH_TRIANGLE *t) {
  Corners c = {
      t, {t->P1, t->P2, t->P3}, {t->N1, t->N2, t->N3}, {t->UV1, t->UV2, t->UV3}, {0, 1, 2}};

  if (!t->Smooth)
    c.normal[0] = c.normal[1] = c.normal[2] = t->Normal_Ind;

  const Vector3d first = vertex(data, c.position[0]);
  const Vector3d winding =
      cross(vertex(data, c.position[1]) - first, vertex(data, c.position[2]) - first);
  const Vector3d outside =
      normal(data, c.normal[0]) + normal(data, c.normal[1]) + normal(data, c.normal[2]);

  if (dot(winding, outside) < 0.0)
    std::swap(c.order[1], c.order[2]);
  return c;
}

// Barycentric weights of a point (in the mesh's space) for corners 0, 1, 2.
void weights_at(const MESH_DATA *data, const MESH_TRIANGLE *t, const Vector3d &p,
                double weight[3]) {
  const Vector3d first = vertex(data, t->P1);
  const Vector3d a = vertex(data, t->P2) - first, b = vertex(data, t->P3) - first, d = p - first;
  const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), da = dot(d, a), db = dot(d, b);
  const double area = aa * bb - ab * ab;

  weight[1] = (area > 0.0) ? (da * bb - db * ab) / area : 0.0;
  weight[2] = (area > 0.0) ? (db * aa - da * ab) / area : 0.0;
  weight[0] = 1.0 - weight[1] - weight[2];
}

double determinant(const MATRIX m) {
  double sum = 0.0;

  for (int i = 0; i < 3; i++)
    sum +=
        m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]);
  return sum;
}

// dP/du and dP/dv of a triangle, in the mesh's space. False where its UVs have
// no area.
bool triangle_directions(const MESH_DATA *data, const MESH_TRIANGLE *t, Vector3d &du,
                         Vector3d &dv) {
  const Vector3d first = vertex(data, t->P1);
  const Vector3d a = vertex(data, t->P2) - first, b = vertex(data, t->P3) - first;
  const UV_VECT *const uv = data->UVCoords;
  const double au = uv[t->UV2][U] - uv[t->UV1][U], av = uv[t->UV2][V] - uv[t->UV1][V];
  const double bu = uv[t->UV3][U] - uv[t->UV1][U], bv = uv[t->UV3][V] - uv[t->UV1][V];
  const double det = au * bv - bu * av;

  if (det == 0.0)
    return false;
  du = (bv / det) * a - (av / det) * b;
  dv = (au / det) * b - (bu / det) * a;
  return true;
}

// dP/du at a point of a mesh and dP/dv, as long and as slanted against each other as in the flat
// triangle; world space.
bool mesh_directions(const mdf::MeshTangents &tangents, const Intersection &isect,
                     const Vector3d &outside, bool with_dv, Vector3d &du, Vector3d &dv) {
  const Mesh *mesh = static_cast<const Mesh *>(isect.Object);
  const MESH_TRIANGLE *t = reinterpret_cast<const MESH_TRIANGLE *>(isect.Pointer);
  const float *corner = &tangents[(size_t)(12 * (t - mesh->Data->Triangles))];
  Vector3d p(isect.IPoint);
  double weight[3];

  if (mesh->Trans != NULL)
    MInvTransPoint(*p, isect.IPoint, mesh->Trans);
  weights_at(mesh->Data, t, p, weight);
  du = Vector3d(0.0);
  for (int k = 0; k < 3; k++)
    du += weight[k] * Vector3d(corner[4 * k], corner[4 * k + 1], corner[4 * k + 2]);
  if (mesh->Trans != NULL)
    du = moved(du, mesh->Trans);
  if (!(dot(du, du) > 0.0))
    return false;
  if (!with_dv)
    return true;
  // mirrored: so is the side of the cross product
  const bool mirrored = mesh->Trans != NULL && determinant(mesh->Trans->matrix) < 0.0;
  du.normalize();
  dv = (mirrored ? -corner[3] : corner[3]) * cross(outside, du);

  Vector3d flat_du, flat_dv;
  if (triangle_directions(mesh->Data, t, flat_du, flat_dv)) {
    flat_du = moved(flat_du, mesh->Trans);
    flat_dv = moved(flat_dv, mesh->Trans);
    const double uu = dot(flat_du, flat_du);
    const double along = dot(flat_du, flat_dv) / uu;
    const double across = cross(flat_du, flat_dv).length() / uu;
    if (std::isfinite(along) && std::isfinite(across) && across > 0.0) {
      dv = std::sqrt(uu) * (across * dv + along * du);
      du *= std::sqrt(uu);
    }
  }
  return true;
}

// ---- other objects ----

// Small against the object, large against the rounding of its UV coordinates and normals.
double difference_step(const ObjectBase *object) {
  const BBOX_VECT &size = object->BBox.Lengths;
  const double largest = max(max(size[X], size[Y]), size[Z]),
               smallest = min(min(size[X], size[Y]), size[Z]);
  return 1e-5 * min(max(max(smallest, 1e-4 * largest), 1e-6), 1e6);
}

// The same from differences of UVCoord() along the surface.
bool difference_directions(const Intersection &isect, const Vector3d &raw_normal,
                           TraceThreadData *thread, Vector3d &du, Vector3d &dv) {
  const double step = difference_step(isect.Object);
  Vector3d side[2] = {axis_vector(fabs(raw_normal[X]) < 0.7 ? X : Y), Vector3d()};
  double slope[2][2]; // [side][u or v]

  orthogonalise(side[0], raw_normal);
  side[1] = cross(raw_normal, side[0]);
  for (int i = 0; i < 2; i++) {
    UV_VECT uv[2] = {{0.0, 0.0}, {0.0, 0.0}};
    for (int end = 0; end < 2; end++) {
      Intersection probe(isect);
      Assign_Vector(probe.IPoint, *(Vector3d(isect.IPoint) + (end ? step : -step) * side[i]));
      isect.Object->UVCoord(uv[end], &probe, thread);
    }
    for (int k = 0; k < 2; k++) {
      slope[i][k] = uv[1][k] - uv[0][k];
      slope[i][k] -= floor(slope[i][k] + 0.5); // across a seam
    }
  }

  const double det = slope[0][U] * slope[1][V] - slope[1][U] * slope[0][V];
  const double scale = fabs(slope[0][U] * slope[1][V]) + fabs(slope[1][U] * slope[0][V]);

  if (fabs(det) > 1e-9 * scale) {
    const double length = 2.0 * step / det;
    du = length * (slope[1][V] * side[0] - slope[0][V] * side[1]);
    dv = length * (slope[0][U] * side[1] - slope[1][U] * side[0]);
    return std::isfinite(dot(du, du)) && dot(du, du) > 0.0;
  }
  return false;
}

// A point of the object in the space where its UV coordinates are what uv_gradients says, from the
// middle of a sphere. Returns what leads from there to the world; NULL: nothing.
const TRANSFORM *uv_space(mdf::Shape::Kind kind, const Intersection &isect, Vector3d &p) {
  const ObjectBase *object = isect.Object;
  const TRANSFORM *space = (kind == mdf::Shape::SPHERE) ? object->UV_Trans : object->Trans;

  p = Vector3d(isect.IPoint);
  if (kind == mdf::Shape::SPHERE) {
    Vector3d centre(static_cast<const Sphere *>(object)->Center);
    if (object->Trans != NULL)
      MTransPoint(*centre, *centre, object->Trans);
    p -= centre;
    if (space != NULL)
      MInvTransDirection(*p, *p, space);
  } else if (space != NULL)
    MInvTransPoint(*p, *p, space);
  return space;
}

// dP/du alone, where u is an angle about an axis. False on the axis.
bool round_direction(mdf::Shape::Kind kind, const Intersection &isect, Vector3d &du) {
  Vector3d p;
  const TRANSFORM *space = uv_space(kind, isect, p);

  if (!(p[X] * p[X] + p[Z] * p[Z] > EPSILON * dot(p, p)))
    return false;
  du = moved(Vector3d(-p[Z], 0.0, p[X]), space);
  if (kind == mdf::Shape::TORUS)
    du = -du;
  return true;
}

// How u and v change over space, in that of uv_space. False where they are not told by a formula,
// or at a pole. A box: by the drawing in boxes.cpp.
bool uv_gradients(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &p,
                  Vector3d &grad_u, Vector3d &grad_v) {
  if (kind == mdf::Shape::BOX) {
    const Box *box = static_cast<const Box *>(isect.Object);
    const int axis = (isect.i1 - 1) / 2; // boxes.cpp counts its sides so
    const bool high = isect.i1 % 2 == 0;
    const int along = axis == X ? Z : X, up = axis == Y ? Z : Y;
    grad_u = axis_vector(along) / (4.0 * (box->bounds[1][along] - box->bounds[0][along]));
    grad_v = axis_vector(up) / (3.0 * (box->bounds[1][up] - box->bounds[0][up]));
    if ((axis == X && high) || (axis == Z && !high))
      grad_u = -grad_u;
    if (axis == Y && high)
      grad_v = -grad_v;
    return true;
  }

  const double all = dot(p, p), across = p[X] * p[X] + p[Z] * p[Z], r = std::sqrt(across);
  if (!(across > EPSILON * all) || kind == mdf::Shape::ROUND)
    return false;
  grad_u = Vector3d(-p[Z], 0.0, p[X]) / (2.0 * M_PI * across);
  if (kind == mdf::Shape::SPHERE) // v = 1/2 + asin(y / |p|) / pi
    grad_v = (axis_vector(Y) - p * (p[Y] / all)) / (M_PI * r);
  else { // a torus: v is the angle about its ring
    const double out = r - static_cast<const Torus *>(isect.Object)->MajorRadius;
    grad_u = -grad_u;
    grad_v = Vector3d(-p[Y] * p[X] / r, out, -p[Y] * p[Z] / r) /
             (2.0 * M_PI * (out * out + p[Y] * p[Y]));
  }
  return true;
}

// dP/du and dP/dv from there: upright on the normal, and what moves one coordinate leaves the
// other.
bool gradient_directions(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &normal,
                         Vector3d &du, Vector3d &dv) {
  Vector3d p, grad_u, grad_v;
  const TRANSFORM *space = uv_space(kind, isect, p);

  if (!uv_gradients(kind, isect, p, grad_u, grad_v))
    return false;
  if (space != NULL) {
    MTransNormal(*grad_u, *grad_u, space);
    MTransNormal(*grad_v, *grad_v, space);
  }
  du = cross(grad_v, normal);
  dv = cross(normal, grad_u);
  const double det = dot(grad_u, du); // dot(grad_v, dv) as well
  du /= det;
  dv /= det;
  return std::isfinite(dot(du, du)) && std::isfinite(dot(dv, dv)) && dot(du, du) > 0.0;
}

// A lathe keeps v with the intersection, not with the point: v is the place on
// its spline.
bool lathe_directions(const Intersection &isect, Vector3d &du, Vector3d &dv) {
  const Lathe *lathe = static_cast<const Lathe *>(isect.Object);
  const LATHE_SPLINE_ENTRY &e = lathe->Spline->Entry[isect.i1];
  const double t = isect.d1;
  double slope[2];
  VECTOR p;

  MInvTransPoint(p, isect.IPoint, lathe->Trans);
  const double r = std::sqrt(p[X] * p[X] + p[Z] * p[Z]);
  if (!(r > EPSILON))
    return false;
  for (int i = 0; i < 2; i++)
    slope[i] = lathe->Number * ((3.0 * e.A[i] * t + 2.0 * e.B[i]) * t + e.C[i]);
  du = moved(2.0 * M_PI * Vector3d(-p[Z], 0.0, p[X]), lathe->Trans);
  dv = moved(Vector3d(slope[0] * p[X] / r, slope[1], slope[0] * p[Z] / r), lathe->Trans);
  return true;
}

// Bernstein's polynomials of degree 3 and their derivatives.
void bernstein(double t, double value[4], double slope[4]) {
  const double s = 1.0 - t;

  value[0] = s * s * s;
  value[1] = 3.0 * s * s * t;
  value[2] = 3.0 * s * t * t;
  value[3] = t * t * t;
  slope[0] = -3.0 * s * s;
  slope[1] = 3.0 * s * (s - 2.0 * t);
  slope[2] = 3.0 * t * (2.0 * s - t);
  slope[3] = 3.0 * t * t;
}

// The patch's own parameters are lost behind uv_vectors, which are bilinear in
// them: Newton's steps bring them back. The first counts along rows of control
// points, the second the rows.
bool patch_directions(const Intersection &isect, Vector3d &du, Vector3d &dv) {
  const BicubicPatch *patch = static_cast<const BicubicPatch *>(isect.Object);
  double p[2] = {0.5, 0.5}, jacobian[2][2] = {{0.0, 0.0}, {0.0, 0.0}},
         det = 0.0; // d uv[k]/d p[i]

  for (int step = 0; step < 20; step++) {
    double miss[2];
    for (int k = 0; k < 2; k++) {
      const double a = patch->ST[0][k], b = patch->ST[1][k], c = patch->ST[2][k],
                   d = patch->ST[3][k];
      jacobian[0][k] = (1.0 - p[1]) * (b - a) + p[1] * (c - d);
      jacobian[1][k] = (1.0 - p[0]) * (d - a) + p[0] * (c - b);
      miss[k] = isect.Iuv[k] - ((1.0 - p[1]) * ((1.0 - p[0]) * a + p[0] * b) +
                                p[1] * ((1.0 - p[0]) * d + p[0] * c));
    }
    det = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
    if (det == 0.0 || !std::isfinite(det))
      return false;
    const double move[2] = {(miss[0] * jacobian[1][1] - miss[1] * jacobian[1][0]) / det,
                            (miss[1] * jacobian[0][0] - miss[0] * jacobian[0][1]) / det};
    p[0] += move[0];
    p[1] += move[1];
    if (fabs(move[0]) + fabs(move[1]) < 1e-12)
      break;
  }

  double value[2][4], slope[2][4];
  Vector3d along[2] = {Vector3d(0.0), Vector3d(0.0)}; // dP/dp
  bernstein(p[0], value[0], slope[0]);
  bernstein(p[1], value[1], slope[1]);
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) {
      const Vector3d control(patch->Control_Points[i][j]);
      along[0] += value[1][i] * slope[0][j] * control;
      along[1] += slope[1][i] * value[0][j] * control;
    }
  du = (jacobian[1][1] / det) * along[0] - (jacobian[0][1] / det) * along[1];
  dv = (jacobian[0][0] / det) * along[1] - (jacobian[1][0] / det) * along[0];
  return std::isfinite(dot(du, du)) && dot(du, du) > 0.0;
}

// The point of a parametric at (u, v), in its own space.
Vector3d parametric_point(const Parametric *object, double u, double v, TraceThreadData *thread) {
  FPUContext *const context = thread->functionContext;
  double p[3];

  for (int i = X; i <= Z; i++) {
    context->SetLocal(U, u);
    context->SetLocal(V, v);
    p[i] = POVFPU_Run(context, *object->Function[i]);
  }
  return Vector3d(p);
}

bool parametric_directions(const Intersection &isect, TraceThreadData *thread, Vector3d &du,
                           Vector3d &dv) {
  const Parametric *object = static_cast<const Parametric *>(isect.Object);
  const double u = isect.Iuv[U], v = isect.Iuv[V];
  const double step_u = 1e-6 * (object->umax - object->umin),
               step_v = 1e-6 * (object->vmax - object->vmin);

  du = (0.5 / step_u) * (parametric_point(object, u + step_u, v, thread) -
                         parametric_point(object, u - step_u, v, thread));
  dv = (0.5 / step_v) * (parametric_point(object, u, v + step_v, thread) -
                         parametric_point(object, u, v - step_v, thread));
  du = moved(du, object->Trans);
  dv = moved(dv, object->Trans);
  return std::isfinite(dot(du, du)) && dot(du, du) > 0.0 && std::isfinite(dot(dv, dv));
}

// For what has no UV coordinates: a direction along which strokes would run,
// and one across.
bool fallback_directions(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &normal,
                         Vector3d &du, Vector3d &dv) {
  const ObjectBase *object = isect.Object;

  if (kind == mdf::Shape::CONE) { // in its own space it stands on z
    VECTOR p;
    MInvTransPoint(p, isect.IPoint, object->Trans);
    du = moved(Vector3d(-p[Y], p[X], 0.0), object->Trans);
  } else {
    du = moved(axis_vector(X), object->UV_Trans);
    if (kind == mdf::Shape::PLANE && fabs(dot(du, normal)) > 0.9999 * du.length())
      du = moved(axis_vector(Z), object->UV_Trans);
  }
  if (!orthogonalise(du, normal))
    return false;
  dv = cross(normal, du);
  return true;
}

// The same for cloth, with a place: round and along a cone, by two of the object's axes else, of
// which the surface faces the third most. A unit of u or v is one of the object's space; round a
// cone, once round.
bool planar_place(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &normal,
                  UV_VECT uv, Vector3d &du, Vector3d &dv) {
  const ObjectBase *object = isect.Object;
  const TRANSFORM *space = kind == mdf::Shape::CONE ? object->Trans : object->UV_Trans;
  Vector3d p(isect.IPoint), n(normal), across[3];

  if (space != NULL) {
    MInvTransPoint(*p, *p, space);
    MInvTransNormal(*n, *n, space);
  }
  int up = fabs(n[X]) > fabs(n[Y]) ? X : Y;
  if (fabs(n[Z]) > fabs(n[up]))
    up = Z;
  if (kind == mdf::Shape::CONE && fabs(p[X] * n[X] + p[Y] * n[Y]) > 1e-6 * n.length()) {
    const double r = std::sqrt(p[X] * p[X] + p[Y] * p[Y]); // its side; it stands on z
    uv[U] = atan2(p[Y], p[X]) / (2.0 * M_PI);
    uv[V] = p[Z];
    across[0] = 2.0 * M_PI * Vector3d(-p[Y], p[X], 0.0);
    across[1] = axis_vector(Z);
    across[2] = Vector3d(p[X] / r, p[Y] / r, 0.0);
  } else {
    const int first = up == X ? Z : X, second = up == Y ? Z : Y;
    uv[U] = p[first];
    uv[V] = p[second];
    across[0] = axis_vector(first);
    across[1] = axis_vector(second);
    across[2] = axis_vector(up);
  }
  for (int i = 0; i < 3; i++)
    across[i] = moved(across[i], space);
  const double upright = dot(across[2], normal);
  du = across[0] - across[2] * (dot(across[0], normal) / upright);
  dv = across[1] - across[2] * (dot(across[1], normal) / upright);
  return std::isfinite(dot(du, du)) && std::isfinite(dot(dv, dv));
}

// What a texture's own transformations do to the (u, v) plane: the images of u and v. Where they
// turn it out of the plane (for the axis of a lathe, say) it stays there: by their lengths, and
// where its u goes.
void texture_plane(const MATRIX m, double plane[2][2]) {
  const double along = Vector3d(m[X]).length(), up = Vector3d(m[Y]).length();

  for (int i = X; i <= Y; i++)
    for (int j = X; j <= Y; j++)
      plane[i][j] = m[i][j];
  if (fabs(m[X][Z]) <= 1e-9 * along && fabs(m[Y][Z]) <= 1e-9 * up)
    return;
  const double flat = std::sqrt(m[X][X] * m[X][X] + m[X][Y] * m[X][Y]);
  const bool upright = !(flat > 1e-9 * along);
  const double c = upright ? 1.0 : m[X][X] / flat, s = upright ? 0.0 : m[X][Y] / flat;
  const double hand = m[X][X] * m[Y][Y] - m[X][Y] * m[Y][X] < -1e-9 * along * up ? -up : up;
  plane[X][X] = along * c;
  plane[X][Y] = along * s;
  plane[Y][X] = -hand * s;
  plane[Y][Y] = hand * c;
}

// Where on the cloth a ray of the width `size` meets it. The texture's own transformations move
// it in the (u, v) plane, as they do what is laid out by `uv_mapping`. v counts so that the cloth
// shows its face, whichever way the object's v runs: T, N x T the other way (ShadedPoint) and N
// stand as u, v and the eye.
mdf::ClothPlace cloth_place(const FINISH *finish, const UV_VECT uv, const Vector3d &du,
                            const Vector3d &dv, const Vector3d &N, const Vector3d &T,
                            const Vector3d &eye, bool has_directions, double size) {
  const mdf::Cloth &cloth = *finish->Mdf->cloth;
  double m[2][2];
  texture_plane(finish->Mdf_Plane, m);
  const double det = m[X][X] * m[Y][Y] - m[X][Y] * m[Y][X];
  const double u = uv[U] - finish->Mdf_Plane[3][X], v = uv[V] - finish->Mdf_Plane[3][Y];
  mdf::ClothPlace place = {{0.0, 0.0}, {0.0, 0.0}, false};

  if (!has_directions || det == 0.0 || !std::isfinite(det))
    return place;
  const Vector3d along = m[X][X] * du + m[X][Y] * dv, up = m[Y][X] * du + m[Y][Y] * dv;
  const double hand = dot(cross(T, N), up) < 0.0 ? -1.0 : 1.0;
  place.uv[0] = (u * m[Y][Y] - v * m[Y][X]) / det;
  place.uv[1] = hand * (v * m[X][X] - u * m[X][Y]) / det;
  // A step q across the ray goes along the ray until it meets the surface again; of the steps as
  // long as the ray is wide the largest says the extent. A thousand widths are enough.
  const Vector3d across_v = cross(up, eye), across_u = cross(eye, along);
  const double least = 1e-3 * across_v.length() * along.length();
  const double area = max(fabs(dot(along, across_v)), least);
  const double scale = area > 0.0 ? size / area : 0.0;
  place.foot[0] = scale * across_v.length();
  place.foot[1] = scale * across_u.length();
  for (int axis = 0; axis < 2; axis++) {
    // yarns have edges: what a dump can say is what is looked up
    place.uv[axis] = (float)clip(place.uv[axis] * cloth.per_unit(axis), -1e8, 1e8);
    place.foot[axis] = (float)clip(place.foot[axis] * cloth.per_unit(axis), 0.0, 1e8);
  }
  // less than a quarter of a yarn: one point of it says as much as sixteen
  if (max(place.foot[0], place.foot[1]) < 0.25)
    place.foot[0] = place.foot[1] = 0.0;
  return place;
}

// The same round the axis of `tangent radial`, for scratches that turning left: u along circles, v
// outward, or along the axis where the surface faces away from it. Lengths are those of the
// texture's space. Circles are taken by rings: in each a whole number of tiles goes round.
bool radial_place(const mdf::Material &material, const FINISH *finish, const Intersection &isect,
                  const std::vector<const TEXTURE *> &warps, const Vector3d &point,
                  const Vector3d &normal, UV_VECT uv, Vector3d &du, Vector3d &dv) {
  const double RINGS = 4.0; // as wide as a quarter of a tile: by then their scale is off
  const bool by_uv = mapped_by_uv(isect.Object, warps);
  const Vector3d axis = Vector3d(material.axis).normalized(), first = any_tangent(axis);
  const double tile = 1.0 / material.scratches->per_unit();
  Vector3d p(point);

  if (by_uv) {
    p = Vector3d(isect.IPoint);
    if (isect.Object->UV_Trans != NULL)
      MInvTransPoint(*p, isect.IPoint, isect.Object->UV_Trans);
  }
  p = moved_back(p, finish->Mdf_Space) - Vector3d(material.centre);
  const double height = dot(p, axis);
  const Vector3d arm = p - height * axis;
  const double radius = arm.length();
  if (!(radius > 0.0) || !std::isfinite(radius))
    return false;

  const double ring = (std::floor(RINGS * radius / tile) + 0.5) * tile / RINGS;
  const double round = max(std::floor(2.0 * M_PI * ring / tile + 0.5), 1.0) * tile / (2.0 * M_PI);
  Vector3d turned[3] = {cross(axis, arm) / round, arm / radius, axis};
  for (int i = 0; i < 3; i++) {
    turned[i] = moved(turned[i], finish->Mdf_Space);
    turned[i] = by_uv ? moved(turned[i], isect.Object->UV_Trans) : out_of(warps, turned[i]);
  }
  const bool face = fabs(dot(turned[2], normal)) * turned[1].length() >
                    fabs(dot(turned[1], normal)) * turned[2].length();
  const Vector3d outward = turned[face ? 1 : 2], upright = turned[face ? 2 : 1];
  uv[U] = round * atan2(dot(arm, cross(axis, first)), dot(arm, first));
  uv[V] = face ? radius : height;
  du = turned[0] - upright * (dot(turned[0], normal) / dot(upright, normal));
  dv = outward - upright * (dot(outward, normal) / dot(upright, normal));
  return std::isfinite(dot(du, du)) && std::isfinite(dot(dv, dv));
}

// dP/du and, if wanted, dP/dv, world space. Where both are, their lengths are right.
bool uv_directions(const mdf::Shape &shape, const Intersection &isect, const Vector3d &raw_normal,
                   const Vector3d &outside, TraceThreadData *thread, bool with_dv, Vector3d &du,
                   Vector3d &dv) {
  switch (shape.kind) {
  case mdf::Shape::BOX:
  case mdf::Shape::SPHERE:
  case mdf::Shape::ROUND:
  case mdf::Shape::TORUS:
    return (!with_dv && shape.kind != mdf::Shape::BOX && round_direction(shape.kind, isect, du)) ||
           gradient_directions(shape.kind, isect, raw_normal, du, dv) ||
           difference_directions(isect, raw_normal, thread, du, dv);
  case mdf::Shape::LATHE:
    return lathe_directions(isect, du, dv);
  case mdf::Shape::PATCH:
    return patch_directions(isect, du, dv);
  case mdf::Shape::PARAMETRIC:
    return parametric_directions(isect, thread, du, dv);
  case mdf::Shape::MESH:
    return mesh_directions(shape.tangents, isect, outside, with_dv, du, dv);
  default:
    return fallback_directions(shape.kind, isect, raw_normal, du, dv);
  }
}

// What a ray of the width `size` covers of the (u, v) plane: two steps across it go along the ray
// until they meet the surface again; no further than a thousand widths.
void uv_footprint(const Vector3d &du, const Vector3d &dv, const Vector3d &eye, double size,
                  double foot[4]) {
  const Vector3d across_v = cross(dv, eye), across_u = cross(eye, du);
  const double least = 1e-3 * across_v.length() * du.length();
  double area = dot(du, across_v);

  if (fabs(area) < least)
    area = area < 0.0 ? -least : least;
  const Vector3d first = any_tangent(eye), second = cross(eye, first);
  const double scale = area != 0.0 ? size / area : 0.0;
  foot[0] = scale * dot(first, across_v);
  foot[1] = scale * dot(first, across_u);
  foot[2] = scale * dot(second, across_v);
  foot[3] = scale * dot(second, across_u);
}

// The frame of a normal map: dP/du upright on the normal, and the perpendicular of both on the side
// of dP/dv: what handedness · N x T is in a right-handed space. Seen from behind, a bump is a dent:
// both turn round.
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

// A normal of the bump image over a footprint in the (u, v) plane, world space. Adds what slopes
// do about it to a covariance in the map's frame.
Vector3d image_normal(const mdf::Material &material, const UV_VECT uv, const double foot[4],
                      const Vector3d &map_x, const Vector3d &map_y, const Vector3d &up,
                      double covariance[3]) {
  double at[2], over[4], n[3], spread[3];

  for (int axis = 0; axis < 2; axis++) {
    at[axis] = (uv[axis] - material.bump_move[axis]) / material.bump_scale[axis];
    over[axis] = material.filtered ? foot[axis] / material.bump_scale[axis] : 0.0;
    over[2 + axis] = material.filtered ? foot[2 + axis] / material.bump_scale[axis] : 0.0;
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

// Of what lies in the texture's space: no plane to move.
const MATRIX UNMOVED = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};

// Slopes in the (u, v) plane: of a share of what is seen.
struct Slopes {
  double share, mean[2], covariance[3];
};

// The slopes of scratches, which the texture's own transformations turn and scale in that plane, on
// the part of a footprint that they cover. share 0: none.
Slopes scratch_slopes(const mdf::Material &material, const MATRIX plane, const UV_VECT uv,
                      const double foot[4]) {
  double m[2][2];
  texture_plane(plane, m);
  const double det = m[X][X] * m[Y][Y] - m[X][Y] * m[Y][X];
  const double per_unit = material.scratches->per_unit();
  // from the plane to the texture's: the inverse of m there
  const double back[2][2] = {{per_unit * m[Y][Y] / det, -per_unit * m[Y][X] / det},
                             {-per_unit * m[X][Y] / det, per_unit * m[X][X] / det}};
  const double u = uv[U] - plane[3][X], v = uv[V] - plane[3][Y];
  Slopes result = {0.0, {0.0, 0.0}, {0.0, 0.0, 0.0}};
  double over[4];
  shade_slopes found;

  for (int side = 0; side < 2; side++)
    for (int axis = 0; axis < 2; axis++)
      over[2 * side + axis] = back[axis][0] * foot[2 * side] + back[axis][1] * foot[2 * side + 1];
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

// Two bumps on one surface: their slopes -n.xy/n.z add, as heights would.
Vector3d add_slopes(const Vector3d &a, const Vector3d &b, const Vector3d &up) {
  const double az = dot(a, up), bz = dot(b, up);
  return ((a - az * up) * bz + (b - bz * up) * az + (az * bz) * up).normalized();
}

} // namespace

mdf::Shape::Kind mdf_kind(const ObjectBase *object) {
  if (dynamic_cast<const Box *>(object) != NULL)
    return mdf::Shape::BOX;
  if (dynamic_cast<const Sphere *>(object) != NULL)
    return mdf::Shape::SPHERE;
  if (dynamic_cast<const Sor *>(object) != NULL || dynamic_cast<const Ovus *>(object) != NULL)
    return mdf::Shape::ROUND;
  if (dynamic_cast<const Torus *>(object) != NULL)
    return mdf::Shape::TORUS;
  if (dynamic_cast<const Lathe *>(object) != NULL)
    return mdf::Shape::LATHE;
  if (dynamic_cast<const BicubicPatch *>(object) != NULL)
    return mdf::Shape::PATCH;
  if (dynamic_cast<const Parametric *>(object) != NULL)
    return mdf::Shape::PARAMETRIC;
  if (dynamic_cast<const Plane *>(object) != NULL || dynamic_cast<const Disc *>(object) != NULL)
    return mdf::Shape::PLANE;
  if (dynamic_cast<const Cone *>(object) != NULL)
    return mdf::Shape::CONE;
  return mdf::Shape::OTHER; // also a mesh, until mdf_add_mesh finds more
}

void Transform_Mdf(FINISH *finish, const TRANSFORM *transform, bool with_object) {
  if (finish == NULL || finish->Mdf == NULL)
    return;
  MTimesA(finish->Mdf_Space, transform->matrix);
  if (!with_object)
    MTimesA(finish->Mdf_Plane, transform->matrix);
}

long mdf_add_mesh(const Mesh *mesh, mdf::Scene &scene) {
  const MESH_DATA *data = mesh->Data;
  const size_t triangles = (size_t)data->Number_Of_Triangles, corners = 3 * triangles;
  std::vector<uint32_t> position(corners);
  std::vector<float> normals(3 * corners), uvs(2 * corners), tangents(4 * corners);

  for (size_t t = 0; t < triangles; t++) {
    const Corners c = corners_of(data, &data->Triangles[t]);
    for (size_t k = 0; k < 3; k++) {
      const size_t out = 3 * t + k;
      const int in = c.order[k];
      const Vector3d n = normal(data, c.normal[in]).normalized();
      position[out] = (uint32_t)c.position[in];
      for (int i = 0; i < 3; i++)
        normals[3 * out + (size_t)i] = (float)n[i];
      uvs[2 * out] = (float)data->UVCoords[c.uv[in]][U];
      uvs[2 * out + 1] = (float)data->UVCoords[c.uv[in]][V];
    }
  }

  const long without = shade_mesh_tangents(triangles, data->Vertices[0], &position[0], &normals[0],
                                           &uvs[0], &tangents[0]);
  if (without < 0)
    throw std::bad_alloc();

  const bool has_uv = without < (long)corners;
  const std::shared_ptr<mdf::Shape> shape(
      new mdf::Shape(has_uv ? mdf::Shape::MESH : mdf::Shape::OTHER));
  mdf::MeshTangents &kept = shape->tangents;
  if (has_uv) {
    kept.resize(4 * corners);
    for (size_t t = 0; t < triangles; t++) {
      const Corners c = corners_of(data, &data->Triangles[t]);
      for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < 4; i++)
          kept[4 * (3 * t + (size_t)c.order[k]) + i] = tangents[4 * (3 * t + k) + i];
    }
  }
  scene.meshes[data] = shape;
  return without;
}

void MdfHit::Prepare(const FINISH *finish, const Intersection &isect, const Ray &ray,
                     const Vector3d &raw_normal, const Vector3d &layer_normal,
                     const std::vector<const TEXTURE *> &warps, const Vector3d &ipoint,
                     double opaque, TraceThreadData *thread, mdf::Dump *d, int p, double width,
                     double size, const RGBColour &pigment) {
  dump = NULL;
  pixel = -1;
  global_lights = 0;
  opacity = opaque;
  both_sides = simple = false;
  level = mdf::Material::level_of(width);

  const mdf::Material &material = *finish->Mdf;
  const bool cloth = material.cloth != NULL;

  if (cloth && !material.woven) // no object that shows it was announced
    return;

  const ObjectBase *object = isect.Object;
  const double rgb[3] = {pigment.red(), pigment.green(), pigment.blue()};
  both_sides = Test_Flag(object, DOUBLE_ILLUMINATE_FLAG) != 0;
  // nothing tells one part from the other
  const bool whole =
      !material.has_pigment() && (!material.has_diffuse || (opacity == 1.0 && !both_sides));
  if (material.lambert && p < 0 && same(raw_normal, layer_normal)) {
    shaded.set_lambert(&material, *unit(raw_normal));
    if (material.has_pigment())
      shaded.set_pigment(rgb);
    simple = whole;
    return;
  }

  static const mdf::Shape unknown(mdf::Shape::OTHER);
  const mdf::Shape &shape = (object->Mdf_Shape != NULL) ? *object->Mdf_Shape : unknown;
  const Vector3d N = unit(raw_normal), V = -unit(Vector3d(ray.Direction));
  const bool dumped = p >= 0, by_axis = !cloth && material.by_axis();
  const bool bumped = material.bump && shape.has_uv(), scratched = material.field != NULL;
  // what Lambert's law shines is the same for every tangent
  const bool any = !cloth && !dumped && material.matt &&
                   material.params.diffuse == SHADE_DIFFUSE_LAMBERT && !bumped && !scratched;
  Vector3d outside, du, dv, T, Ns = unit(layer_normal);
  UV_VECT uv = {0.0, 0.0};
  bool has_directions = false, upright = false, turning = false;

  if (shape.has_uv() && (bumped || dumped || cloth || scratched))
    object->UVCoord(uv, &isect, thread);
  if ((!by_axis && !any) || bumped || scratched) {
    // a texture that is not turned by itself needs no dP/dv
    const bool turned = finish->Mdf_Plane[X][Y] != 0.0 || !(finish->Mdf_Plane[X][X] > 0.0);
    const bool both = bumped || turned || cloth || scratched;
    if (bumped || (both && shape.kind == mdf::Shape::MESH)) {
      Intersection copy(isect); // Normal() wants to write to it
      object->Normal(*outside, &copy, thread);
    }
    upright = !both && !shape.has_uv();
    // a box's UV coordinates unfold it, each side to its own scale: cloth keeps that of the scene
    const bool by_side = shape.kind == mdf::Shape::BOX && !bumped;
    const bool laid = (cloth || scratched) && (!shape.has_uv() || by_side);
    turning = laid && !cloth && material.tangent == mdf::Material::TANGENT_RADIAL;
    has_directions = turning ? radial_place(material, finish, isect, warps, ipoint, N, uv, du, dv)
                     : laid  ? planar_place(shape.kind, isect, N, uv, du, dv)
                             : uv_directions(shape, isect, N, outside, thread, both, du, dv);
  }

  Vector3d map_x, map_y;
  double covariance[3] = {0.0, 0.0, 0.0};
  Slopes scratches = {0.0, {0.0, 0.0}, {0.0, 0.0, 0.0}};
  Vector3d smooth = Ns, in_scratches = Ns; // beside scratches, and in them
  if ((bumped || scratched) && has_directions) {
    const bool front =
        !bumped || (dot(outside, N) > 0.0) != (Test_Flag(object, INVERTED_FLAG) != 0);
    double foot[4];
    uv_footprint(du, dv, V, size, foot);
    if (map_frame(N, front, du, dv, map_x, map_y)) {
      if (bumped)
        Ns = add_slopes(Ns, image_normal(material, uv, foot, map_x, map_y, N, covariance), N);
      smooth = in_scratches = Ns;
      if (scratched)
        scratches = scratch_slopes(material, turning ? UNMOVED : finish->Mdf_Plane, uv, foot);
      if (scratches.share > 0.0) {
        const Vector3d down = scratches.mean[0] * map_x + scratches.mean[1] * map_y;
        in_scratches = add_slopes(smooth, (N - down).normalized(), N);
        Ns = add_slopes(smooth, (N - scratches.share * down).normalized(), N);
      }
    }
  }

  if (any)
    T = fabs(N[X]) < 0.7 ? axis_vector(X) : axis_vector(Z);
  else if (by_axis)
    T = texture_direction(material, Vector3d(material.axis), finish, isect, warps, ipoint);
  else if (has_directions)
    T = upright ? du : finish->Mdf_Plane[X][X] * du + finish->Mdf_Plane[X][Y] * dv;
  if (!(upright && has_directions) && !orthogonalise(T, N)) {
    if (material.tangent == mdf::Material::TANGENT_AXIS && by_axis) { // it stands upright here
      const Vector3d other = any_tangent(Vector3d(material.axis).normalized());
      T = texture_direction(material, other, finish, isect, warps, ipoint);
    } else
      T = du; // the texture's x axis stands upright on the UV plane
    if ((!by_axis && !has_directions) || !orthogonalise(T, N))
      T = any_tangent(N);
  }

  shaded.set(&material, *N, *T, *Ns, *V);
  if (material.has_pigment())
    shaded.set_pigment(rgb);
  mdf::ClothPlace place = {{0.0, 0.0}, {0.0, 0.0}, false};
  if (!cloth && has_directions && (bumped || scratched)) {
    const Vector3d B = cross(N, T); // the frame's y axis, as ShadedPoint has it
    const double a = dot(T, map_x), b = dot(T, map_y), c = dot(B, map_x), d = dot(B, map_y);
    // Slopes of a plate with scratches are 0, or theirs: one lobe for all of them would be wrong.
    for (int scratch = 0; scratch < 2; scratch++) {
      const double share = scratch ? scratches.share : 1.0 - scratches.share;
      if (!(share > 0.0))
        continue;
      for (int i = 0; i < 3; i++)
        covariance[i] += scratch ? scratches.covariance[i] : 0.0;
      const double local[3] = {
          a * a * covariance[0] + 2.0 * a * b * covariance[1] + b * b * covariance[2],
          a * c * covariance[0] + (a * d + b * c) * covariance[1] + b * d * covariance[2],
          c * c * covariance[0] + 2.0 * c * d * covariance[1] + d * d * covariance[2]};
      shaded.roughen(share, scratch ? *in_scratches : *smooth, local, scratch ? 2 : 1, level);
    }
  }
  if (cloth) {
    place = cloth_place(finish, uv, du, dv, N, T, V, has_directions, size);
    place.far = level >= 0 || ray.IsRadiosityRay();
    gaps = 1.0 - shaded.lay(place);
  }
  simple = whole && !cloth && level < 0 && !shaded.is_rough();
  if (!dumped)
    return;
  mdf::LobeSeen lobes[mdf::ShadedPoint::MOST_LOBES];
  const int count = shaded.lobes(lobes);
  bool turned = false;
  for (int i = 0; i < count; i++)
    turned = turned || lobes[i].angle != 0.0;
  // a dump has no room for the colours of yarns, nor for fibres that run elsewhere than the grooves
  if (!(cloth && material.has_pigment()) &&
      !(turned && material.has_diffuse && material.params.diffuse != SHADE_DIFFUSE_LAMBERT) &&
      d->hit(p, &material, isect.IPoint, uv, *N, *T, *V, rgb, cloth ? &place : NULL, gaps, lobes,
             count)) {
    dump = d;
    pixel = p;
    global_lights = (int)thread->GetSceneData()->lightSources.size();
  }
}

bool Mdf_Is_Open(const FINISH *finish) {
  return finish != NULL && finish->Mdf != NULL && finish->Mdf->cloth && finish->Mdf->cloth->open();
}

double MdfHit::ShadowGaps(const FINISH *finish, const Intersection &isect, const Ray &ray,
                          const Vector3d &raw_normal, TraceThreadData *thread, double size) {
  if (!Mdf_Is_Open(finish))
    return 0.0;
  const Vector3d facing = dot(raw_normal, Vector3d(ray.Direction)) > 0.0 ? -raw_normal : raw_normal;
  MdfHit hit;
  hit.Prepare(finish, isect, ray, facing, facing, std::vector<const TEXTURE *>(),
              Vector3d(isect.IPoint), 1.0, thread, NULL, -1, 0.0, size);
  return hit.Gaps();
}

void MdfHit::AddLight(const VECTOR direction, const RGBColour &light_colour, bool highlight,
                      bool diffuse, const LightSource *light, RGBColour &colour) const {
  const mdf::Material &material = shaded.of();
  const double E[3] = {M_PI * light_colour.red(), M_PI * light_colour.green(),
                       M_PI * light_colour.blue()};
  const bool recorded = dump != NULL && light != NULL && highlight;
  double S[3];

  if (simple && highlight && (diffuse || !material.has_diffuse)) {
    shaded.light_smooth(direction, E, S);
    colour += RGBColour((COLC)S[0], (COLC)S[1], (COLC)S[2]);
    if (recorded)
      Record(light, direction, E, S);
    return;
  }

  const bool behind = !shaded.above(direction), cloth = material.cloth != NULL;
  // what double_illuminate lets through shines as from the other side
  const Vector3d through = -Vector3d(direction);
  const bool turned = behind && both_sides && !(cloth && material.cloth->transmits());

  if (cloth) { // all of it goes where what is diffuse goes
    if (!highlight && !diffuse)
      return;
    shaded.light(mdf::ShadedPoint::ALL, -1, turned ? *through : direction, E, S);
    colour += RGBColour((COLC)S[0], (COLC)S[1], (COLC)S[2]) * opacity;
    if (recorded && !turned)
      Record(light, direction, E, S);
    return;
  }

  if (recorded) {
    double part[3];
    shaded.light(mdf::ShadedPoint::SPECULAR, -1, direction, E, S);
    if (material.has_diffuse) {
      shaded.light(mdf::ShadedPoint::DIFFUSE, -1, direction, E, part);
      for (int c = 0; c < 3; c++)
        S[c] += part[c];
    }
    Record(light, direction, E, S);
  }
  if (highlight) {
    shaded.light(mdf::ShadedPoint::SPECULAR, level, direction, E, S);
    colour += RGBColour((COLC)S[0], (COLC)S[1], (COLC)S[2]);
  }
  if (diffuse && material.has_diffuse) {
    shaded.light(mdf::ShadedPoint::DIFFUSE, -1, turned ? *through : direction, E, S);
    colour += RGBColour((COLC)S[0], (COLC)S[1], (COLC)S[2]) * opacity;
  }
}

void MdfHit::Record(const LightSource *light, const VECTOR direction, const double E[3],
                    const double S[3]) const {
  dump->light(pixel, (int)light->index + (light->lightGroupLight ? global_lights : 0), direction, E,
              S, shaded.of().cloth != NULL);
}

bool MdfHit::Meets(const VECTOR direction) const {
  return shaded.faces(direction);
}

RGBColour MdfHit::Between(const RGBColour &transparency, double gaps) {
  return transparency + (RGBColour(1.0) - transparency) * gaps;
}

RGBColour MdfHit::DiffuseAlbedo() const {
  double albedo[3] = {0.0, 0.0, 0.0};

  if (HasBlock())
    shaded.diffuse_albedo(albedo);
  return RGBColour((COLC)albedo[0], (COLC)albedo[1], (COLC)albedo[2]);
}

RGBColour MdfHit::SpecularAlbedo() const {
  double albedo[3] = {0.0, 0.0, 0.0};

  if (HasBlock())
    shaded.specular_albedo(albedo);
  return RGBColour((COLC)albedo[0], (COLC)albedo[1], (COLC)albedo[2]);
}

RGBColour MdfHit::ConservedAlbedo() const {
  return HasBlock() && shaded.of().cloth ? RGBColour(0.0) : SpecularAlbedo();
}

namespace {

uint64_t mix(uint64_t z) { // splitmix64's
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

// Points of Sobol's first three dimensions, nested-uniformly scrambled [Owen1995]. Any run of 2^k
// from a multiple of 2^k on meets each cell of every grid of 2^k equal cells of the first two once,
// and so does each of the wholes that four such runs make. Bits are kept in reverse: what a bit is
// flipped by must come from those below it then, as sums and products have it [LaineKarras2011].
uint32_t scrambled(uint32_t reversed, uint32_t seed) {
  reversed += seed;
  reversed ^= reversed * 0xb63c2d6cu; // an even factor: no bit moves by itself
  reversed *= (seed >> 15) | 1u;
  reversed ^= reversed * 0x2f0a9f52u;
  reversed += seed ^ 0x9e3779b9u;
  reversed *= 0x5c61ddb5u;
  reversed ^= reversed * 0xd1b54a32u;
  return reversed;
}

uint32_t reversed_bits(uint32_t x) {
  x = __builtin_bswap32(x);
  x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

// Spreads 16 bits to every other one, and back.
uint32_t apart(uint32_t x) {
  x &= 0xffffu;
  x = (x | x << 8) & 0x00ff00ffu;
  x = (x | x << 4) & 0x0f0f0f0fu;
  x = (x | x << 2) & 0x33333333u;
  return (x | x << 1) & 0x55555555u;
}

uint32_t together(uint32_t x) {
  x &= 0x55555555u;
  x = (x | x >> 1) & 0x33333333u;
  x = (x | x >> 2) & 0x0f0f0f0fu;
  x = (x | x >> 4) & 0x00ff00ffu;
  return (x | x >> 8) & 0xffffu;
}

// The numbers that pixels around have are far from those of this one [GeorgievFajardo2016].
const uint8_t *dither(uint32_t x, uint32_t y) {
  return DITHER[y % DITHER_SIDE * DITHER_SIDE + x % DITHER_SIDE];
}

double fraction(double x) {
  return x - std::floor(x);
}

// Sobol's second and third dimensions: what each byte of an index turns about in a point, bits in
// reverse. (The first dimension is the index itself.)
struct SobolBytes {
  uint32_t turned[2][4][256];

  SobolBytes() {
    // of the polynomials x + 1 and x^2 + x + 1, the latter of which goes back by two
    uint32_t direction[2] = {0x80000000u, 0x80000000u}, next = 0xc0000000u;

    for (int bit = 0; bit < 32; bit++) {
      for (int dimension = 0; dimension < 2; dimension++) {
        uint32_t *const byte = turned[dimension][bit / 8];
        const int from = 1 << bit % 8;
        byte[0] = 0;
        for (int i = 0; i < from; i++)
          byte[from + i] = byte[i] ^ reversed_bits(direction[dimension]);
      }
      const uint32_t after = next ^ direction[1] ^ direction[1] >> 2;
      direction[0] ^= direction[0] >> 1;
      direction[1] = next;
      next = after;
    }
  }

  uint32_t of(int dimension, uint32_t index) const {
    const uint32_t(*const byte)[256] = turned[dimension];

    return byte[0][index & 0xff] ^ byte[1][index >> 8 & 0xff] ^ byte[2][index >> 16 & 0xff] ^
           byte[3][index >> 24];
  }
};

const SobolBytes SOBOL;

void low_discrepancy(uint32_t index, const uint32_t seed[2], uint32_t point[3]) {
  // the order is another one for each seed: numbers of two seeds have nothing in common
  index = reversed_bits(scrambled(reversed_bits(index), seed[0] ^ seed[1]));
  point[0] = reversed_bits(scrambled(index, seed[0]));
  point[1] = reversed_bits(scrambled(SOBOL.of(0, index), seed[1]));
  point[2] = reversed_bits(scrambled(SOBOL.of(1, index), seed[0] + seed[1]));
}

} // namespace

void MdfHit::Seed(const VECTOR point, const VECTOR direction, int layer, unsigned int seed[2]) {
  uint64_t hash = mix((uint64_t)layer);

  for (int i = X; i <= Z; i++) {
    uint64_t bits[2];
    std::memcpy(&bits[0], &point[i], sizeof bits[0]);
    std::memcpy(&bits[1], &direction[i], sizeof bits[1]);
    hash = mix(mix(hash ^ bits[0]) ^ bits[1]);
  }
  seed[0] = (uint32_t)hash;
  seed[1] = (uint32_t)(hash >> 32);
}

unsigned int MdfHit::PixelSeed(double x, double y, unsigned int seed[2]) {
  const double left = std::floor(x), top = std::floor(y);
  const double within[3] = {x - left, y - top, 0.0};

  Seed(within, within, 0, seed);
  seed[0] |= 1u; // never none
  return apart((uint32_t)(int)left) | apart((uint32_t)(int)top) << 1;
}

void MdfHit::PathSeed(const unsigned int pixel[2], unsigned int level, const Ray &ray, int layer,
                      unsigned int seed[2]) {
  const uint64_t kind = (ray.IsReflectionRay() ? 1u : 0u) | (ray.IsRefractionRay() ? 2u : 0u);
  const uint64_t hash = mix(((uint64_t)pixel[1] << 32 | pixel[0]) ^
                            mix((uint64_t)level << 32 | (uint64_t)(uint32_t)layer << 2 | kind));

  seed[0] = (uint32_t)hash;
  seed[1] = (uint32_t)(hash >> 32);
}

bool MdfHit::Draw(unsigned int index, const unsigned int seed[2], Vector3d &direction,
                  RGBColour &reflectance) const {
  uint32_t point[3];
  double u[3];

  low_discrepancy(index, seed, point);
  for (int i = 0; i < 3; i++)
    u[i] = point[i] * 0x1p-32;
  return DrawBy(u, direction, reflectance);
}

bool MdfHit::DrawAlone(const unsigned int seed[2], Vector3d &direction,
                       RGBColour &reflectance) const {
  const double u[3] = {seed[0] * 0x1p-32, seed[1] * 0x1p-32, (seed[0] ^ seed[1]) * 0x1p-32};

  return DrawBy(u, direction, reflectance);
}

bool MdfHit::DrawOfAll(unsigned int index, unsigned int pixel, const unsigned int seed[2],
                       Vector3d &direction, RGBColour &reflectance) const {
  const mdf::Lattice &lattice = shaded.of().lattice;
  const uint32_t x = together(pixel) + seed[0] % DITHER_SIDE;
  const uint32_t y = together(pixel >> 1) + seed[1] % DITHER_SIDE;
  const uint8_t *const moved = dither(x, y);
  double part[2], u[3];

  for (int i = 0; i < 2; i++)
    part[i] = fraction((moved[i] + 0.5) / 256.0 + (seed[i] >> 16) / 65536.0);
  for (int i = 0; i < 2; i++)
    u[i] = fraction((double)(index * lattice.step[i] % lattice.count) / lattice.count +
                    lattice.side[0][i] * part[0] + lattice.side[1][i] * part[1]);
  // which yarn of a cloth, by multiples of the golden ratio. Which lobe is for the second number to
  // tell: by a third one the points of a lobe would lie unevenly
  u[2] = !shaded.of().cloth ? -1.0
                            : fraction(index * 0.61803398874989485 +
                                       (dither(x + DITHER_SIDE / 2, y)[0] + 0.5) / 256.0);
  return DrawBy(u, direction, reflectance);
}

bool MdfHit::DrawBy(const double u[3], Vector3d &direction, RGBColour &reflectance) const {
  double L[3], share[3];

  if (!shaded.draw(level, u, L, share))
    return false;
  direction = Vector3d(L);
  reflectance = RGBColour((COLC)share[0], (COLC)share[1], (COLC)share[2]);
  return true;
}

void MdfHit::Clamp(RGBColour &colour) const {
  const double most = shaded.of().clamp;
  const double brightest = max(max(colour.red(), colour.green()), colour.blue());

  if (most > 0.0 && brightest > most)
    colour *= most / brightest;
}

double Mdf_Bend(const Intersection &isect, const Vector3d &raw_normal, double size,
                TraceThreadData *thread) {
  // The mean curvature is half of how much normals around the point lean away from it. Objects
  // tell a normal beside a surface as well as on it; those without bounds have no size to go by.
  const double across =
      std::abs(isect.IPoint[X]) + std::abs(isect.IPoint[Y]) + std::abs(isect.IPoint[Z]);
  const double step = min(max(size, 1e-7 * across + 1e-9), 1e3 * difference_step(isect.Object));
  Vector3d side[2] = {any_tangent(raw_normal), Vector3d()};
  double lean = 0.0, facing = 0.0;

  side[1] = cross(raw_normal, side[0]);
  for (int i = 0; i < 4; i++) {
    const Vector3d way = i % 2 ? -side[i / 2] : side[i / 2];
    Intersection probe(isect);
    Vector3d beside;
    Assign_Vector(probe.IPoint, *(Vector3d(isect.IPoint) + step * way));
    probe.haveLocalIPoint = false;
    isect.Object->Normal(*beside, &probe, thread);
    lean += dot(beside, way);
    facing += dot(beside, raw_normal);
  }
  const double bend = 2.0 * size * lean / (4.0 * step); // a mirror turns twice as far as its normal
  return !std::isfinite(bend) ? 0.0 : facing < 0.0 ? -bend : bend;
}

void Mark_Mdf_Lamp(ObjectBase *object) {
  object->Mdf_Lamp = true;
  if (object->Type & IS_COMPOUND_OBJECT) {
    std::vector<ObjectPtr> &parts = static_cast<CompoundObject *>(object)->children;
    for (size_t i = 0; i < parts.size(); i++)
      Mark_Mdf_Lamp(parts[i]);
  }
}

} // namespace pov
