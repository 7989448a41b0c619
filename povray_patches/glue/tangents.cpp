// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/tangents.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

#include "backend/mdf/vectors.h"
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
#include "shade/mesh.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

using namespace glue;

namespace {

bool is_direction(const Vector3d &v) {
  return is_finite(v) && dot(v, v) > 0.0;
}

// ---- meshes ----

struct Corners {
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
  Corners c = {{t->P1, t->P2, t->P3}, {t->N1, t->N2, t->N3}, {t->UV1, t->UV2, t->UV3}, {0, 1, 2}};

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

// Barycentric coordinates of a point (in the mesh's space) for corners 0, 1, 2.
void barycentric(const MESH_DATA *data, const MESH_TRIANGLE *t, const Vector3d &p,
                 double weight[3]) {
  const Vector3d first = vertex(data, t->P1);
  const Vector3d a = vertex(data, t->P2) - first, b = vertex(data, t->P3) - first, d = p - first;
  const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), da = dot(d, a), db = dot(d, b);
  const double area = aa * bb - ab * ab;

  weight[1] = (area > 0.0) ? (da * bb - db * ab) / area : 0.0;
  weight[2] = (area > 0.0) ? (db * aa - da * ab) / area : 0.0;
  weight[0] = 1.0 - weight[1] - weight[2];
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

// Gives orthonormal directions the lengths and the slant that they have in the flat triangle.
void stretch_as_flat(const Mesh *mesh, const MESH_TRIANGLE *t, Vector3d &du, Vector3d &dv) {
  Vector3d flat_du, flat_dv;

  if (!triangle_directions(mesh->Data, t, flat_du, flat_dv))
    return;
  flat_du = transformed(flat_du, mesh->Trans);
  flat_dv = transformed(flat_dv, mesh->Trans);
  const double uu = dot(flat_du, flat_du);
  const double along = dot(flat_du, flat_dv) / uu;
  const double across = cross(flat_du, flat_dv).length() / uu;
  if (std::isfinite(along) && std::isfinite(across) && across > 0.0) {
    dv = std::sqrt(uu) * (across * dv + along * du);
    du *= std::sqrt(uu);
  }
}

bool mesh_directions(const mdf::MeshTangents &tangents, const Intersection &isect,
                     const Vector3d &outside, bool with_dv, Vector3d &du, Vector3d &dv) {
  const Mesh *mesh = static_cast<const Mesh *>(isect.Object);
  const MESH_TRIANGLE *t = reinterpret_cast<const MESH_TRIANGLE *>(isect.Pointer);
  const float *corner = &tangents[(size_t)(12 * (t - mesh->Data->Triangles))];
  double weight[3];

  barycentric(mesh->Data, t, inverse_point(Vector3d(isect.IPoint), mesh->Trans), weight);
  du = Vector3d(0.0);
  for (int k = 0; k < 3; k++)
    du += weight[k] * Vector3d(corner[4 * k], corner[4 * k + 1], corner[4 * k + 2]);
  du = transformed(du, mesh->Trans);
  if (!(dot(du, du) > 0.0))
    return false;
  if (!with_dv)
    return true;
  // mirrored: so is the side of the cross product
  const bool mirrored = mesh->Trans != NULL && determinant(mesh->Trans->matrix) < 0.0;
  du.normalize();
  dv = (mirrored ? -corner[3] : corner[3]) * cross(outside, du);
  stretch_as_flat(mesh, t, du, dv);
  return true;
}

// ---- objects whose UV coordinates are a function of the point ----

// dP/du and dP/dv from differences of UVCoord() along the surface.
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

  if (!(fabs(det) > 1e-9 * scale))
    return false;
  const double length = 2.0 * step / det;
  du = length * (slope[1][V] * side[0] - slope[0][V] * side[1]);
  dv = length * (slope[0][U] * side[1] - slope[1][U] * side[0]);
  return is_direction(du);
}

// A point of the object in the space where its UV coordinates are what uv_gradients says, from the
// middle of a sphere. Returns what leads from there to the world; NULL: nothing.
const TRANSFORM *uv_space(mdf::Shape::Kind kind, const Intersection &isect, Vector3d &p) {
  const ObjectBase *object = isect.Object;
  const TRANSFORM *space = (kind == mdf::Shape::SPHERE) ? object->UV_Trans : object->Trans;

  if (kind != mdf::Shape::SPHERE) {
    p = inverse_point(Vector3d(isect.IPoint), space);
    return space;
  }
  Vector3d centre(static_cast<const Sphere *>(object)->Center);
  if (object->Trans != NULL)
    MTransPoint(*centre, *centre, object->Trans);
  p = Vector3d(isect.IPoint) - centre;
  if (space != NULL)
    MInvTransDirection(*p, *p, space);
  return space;
}

// dP/du alone, where u is an angle about an axis. False on the axis.
bool round_direction(mdf::Shape::Kind kind, const Intersection &isect, Vector3d &du) {
  Vector3d p;
  const TRANSFORM *space = uv_space(kind, isect, p);

  if (!(p[X] * p[X] + p[Z] * p[Z] > EPSILON * dot(p, p)))
    return false;
  du = transformed(Vector3d(-p[Z], 0.0, p[X]), space);
  if (kind == mdf::Shape::TORUS)
    du = -du;
  return true;
}

// By the drawing in boxes.cpp.
void box_gradients(const Intersection &isect, Vector3d &grad_u, Vector3d &grad_v) {
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
}

// The gradients of u and v, in the space of uv_space. False where they are not told by a formula,
// or at a pole.
bool uv_gradients(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &p,
                  Vector3d &grad_u, Vector3d &grad_v) {
  if (kind == mdf::Shape::BOX) {
    box_gradients(isect, grad_u, grad_v);
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
  return is_direction(du) && is_finite(dv);
}

// ---- objects that keep UV coordinates with the intersection ----

// v is the place on a lathe's spline.
bool lathe_directions(const Intersection &isect, Vector3d &du, Vector3d &dv) {
  const Lathe *lathe = static_cast<const Lathe *>(isect.Object);
  const LATHE_SPLINE_ENTRY &e = lathe->Spline->Entry[isect.i1];
  const double t = isect.d1;
  const Vector3d p = inverse_point(Vector3d(isect.IPoint), lathe->Trans);
  const double r = std::sqrt(p[X] * p[X] + p[Z] * p[Z]);
  double slope[2];

  if (!(r > EPSILON))
    return false;
  for (int i = 0; i < 2; i++)
    slope[i] = lathe->Number * ((3.0 * e.A[i] * t + 2.0 * e.B[i]) * t + e.C[i]);
  du = transformed(2.0 * M_PI * Vector3d(-p[Z], 0.0, p[X]), lathe->Trans);
  dv = transformed(Vector3d(slope[0] * p[X] / r, slope[1], slope[0] * p[Z] / r), lathe->Trans);
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

// A patch's own parameters are lost behind uv_vectors, which are bilinear in
// them: Newton's steps bring them back. jacobian: d uv[k] / d p[i]. False where it is singular.
bool patch_parameters(const BicubicPatch *patch, const UV_VECT uv, double p[2],
                      double jacobian[2][2], double &det) {
  p[0] = p[1] = 0.5;
  for (int step = 0; step < 20; step++) {
    double miss[2];
    for (int k = 0; k < 2; k++) {
      const double a = patch->ST[0][k], b = patch->ST[1][k], c = patch->ST[2][k],
                   d = patch->ST[3][k];
      jacobian[0][k] = (1.0 - p[1]) * (b - a) + p[1] * (c - d);
      jacobian[1][k] = (1.0 - p[0]) * (d - a) + p[0] * (c - b);
      miss[k] = uv[k] - ((1.0 - p[1]) * ((1.0 - p[0]) * a + p[0] * b) +
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
  return true;
}

// Its parameters: the first counts along rows of control points, the second the rows.
bool patch_directions(const Intersection &isect, Vector3d &du, Vector3d &dv) {
  const BicubicPatch *patch = static_cast<const BicubicPatch *>(isect.Object);
  double p[2], jacobian[2][2], det, value[2][4], slope[2][4];
  Vector3d along[2] = {Vector3d(0.0), Vector3d(0.0)}; // dP/dp

  if (!patch_parameters(patch, isect.Iuv, p, jacobian, det))
    return false;
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
  return is_direction(du);
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
  du = transformed(du, object->Trans);
  dv = transformed(dv, object->Trans);
  return is_direction(du) && is_finite(dv);
}

// ---- objects without UV coordinates ----

// A direction along which strokes would run, and one across.
bool fallback_directions(mdf::Shape::Kind kind, const Intersection &isect, const Vector3d &normal,
                         Vector3d &du, Vector3d &dv) {
  const ObjectBase *object = isect.Object;

  if (kind == mdf::Shape::CONE) { // in its own space it stands on z
    const Vector3d p = inverse_point(Vector3d(isect.IPoint), object->Trans);
    du = transformed(Vector3d(-p[Y], p[X], 0.0), object->Trans);
  } else {
    du = transformed(axis_vector(X), object->UV_Trans);
    if (kind == mdf::Shape::PLANE && fabs(dot(du, normal)) > 0.9999 * du.length())
      du = transformed(axis_vector(Z), object->UV_Trans);
  }
  if (!orthogonalise(du, normal))
    return false;
  dv = cross(normal, du);
  return true;
}

// ---- what shade_mesh_tangents takes and gives ----

struct MeshCorners {
  explicit MeshCorners(const MESH_DATA *data);

  std::vector<uint32_t> position;
  std::vector<float> normals, uvs;
};

MeshCorners::MeshCorners(const MESH_DATA *data) {
  const size_t triangles = (size_t)data->Number_Of_Triangles, corners = 3 * triangles;

  position.resize(corners);
  normals.resize(3 * corners);
  uvs.resize(2 * corners);
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
}

// The tangents in the order of POV-Ray's corners.
void reorder(const MESH_DATA *data, const std::vector<float> &tangents, mdf::MeshTangents &kept) {
  kept.resize(tangents.size());
  for (size_t t = 0; t < (size_t)data->Number_Of_Triangles; t++) {
    const Corners c = corners_of(data, &data->Triangles[t]);
    for (size_t k = 0; k < 3; k++)
      for (size_t i = 0; i < 4; i++)
        kept[4 * (3 * t + (size_t)c.order[k]) + i] = tangents[4 * (3 * t + k) + i];
  }
}

} // namespace

namespace glue {

// Small against the object, large against the rounding of its UV coordinates and normals.
double difference_step(const ObjectBase *object) {
  const BBOX_VECT &size = object->BBox.Lengths;
  const double largest = max(max(size[X], size[Y]), size[Z]),
               smallest = min(min(size[X], size[Y]), size[Z]);
  return 1e-5 * min(max(max(smallest, 1e-4 * largest), 1e-6), 1e6);
}

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

} // namespace glue

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

long mdf_add_mesh(const Mesh *mesh, mdf::Scene &scene) {
  const MESH_DATA *data = mesh->Data;
  const size_t triangles = (size_t)data->Number_Of_Triangles;
  const MeshCorners corners(data);
  std::vector<float> tangents(12 * triangles);

  const long without = shade_mesh_tangents(triangles, data->Vertices[0], &corners.position[0],
                                           &corners.normals[0], &corners.uvs[0], &tangents[0]);
  if (without < 0)
    throw std::bad_alloc();

  const bool has_uv = without < (long)(3 * triangles);
  const std::shared_ptr<mdf::Shape> shape(
      new mdf::Shape(has_uv ? mdf::Shape::MESH : mdf::Shape::OTHER));
  if (has_uv)
    reorder(data, tangents, shape->tangents);
  scene.meshes[data] = shape;
  return without;
}

} // namespace pov
