// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/surface.h"

#include <cmath>
#include <new>

#include "shade/mesh.h"
#include "backend/colour/colour.h"
#include "backend/math/matrices.h"
#include "backend/math/vector.h"
#include "backend/scene/scene.h"
#include "backend/scene/threaddata.h"
#include "backend/shape/boxes.h"
#include "backend/shape/lathe.h"
#include "backend/shape/mesh.h"
#include "backend/shape/ovus.h"
#include "backend/shape/sor.h"
#include "backend/shape/spheres.h"
#include "backend/shape/torus.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

namespace {

Vector3d axis_vector(int axis) {
  return Vector3d(axis == X, axis == Y, axis == Z);
}

// v without its part along the unit vector n, normalised. False if nothing is left.
bool orthogonalise(Vector3d &v, const Vector3d &n) {
  const double before = v.length();
  v -= n * dot(v, n);
  const double after = v.length();

  if (!(after > 1e-9 * before) || !std::isfinite(after))
    return false;
  v /= after;
  v -= n * dot(v, n); // once more: v may have been almost along n
  v.normalize();
  return true;
}

Vector3d to_world(const ObjectBase *object, const Vector3d &direction) {
  Vector3d world(direction);

  if (object->UV_Trans != NULL)
    MTransDirection(*world, *direction, object->UV_Trans);
  return world;
}

// A unit tangent along an axis of the object; along z where that axis is normal to the surface.
Vector3d axis_tangent(const ObjectBase *object, const Vector3d &axis, const Vector3d &normal) {
  Vector3d tangent = to_world(object, axis);

  if (orthogonalise(tangent, normal))
    return tangent;
  for (int i = Z; i >= X; i--) {
    tangent = axis_vector(i);
    if (orthogonalise(tangent, normal))
      break;
  }
  return tangent;
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

// dP/du at a point of a mesh and a vector on the side of dP/dv, world space.
bool mesh_directions(const Mesh *mesh, const mdf::MeshTangents &tangents, const Intersection &isect,
                     const Vector3d &outside, Vector3d &du, Vector3d &dv) {
  const MESH_TRIANGLE *t = reinterpret_cast<const MESH_TRIANGLE *>(isect.Pointer);
  const float *corner = &tangents[(size_t)(12 * (t - mesh->Data->Triangles))];
  Vector3d p(isect.IPoint);
  double weight[3], handedness = corner[3];

  if (mesh->Trans != NULL)
    MInvTransPoint(*p, isect.IPoint, mesh->Trans);
  weights_at(mesh->Data, t, p, weight);
  du = Vector3d(0.0);
  for (int k = 0; k < 3; k++)
    du += weight[k] * Vector3d(corner[4 * k], corner[4 * k + 1], corner[4 * k + 2]);
  if (mesh->Trans != NULL) {
    const Vector3d object_du(du);
    MTransDirection(*du, *object_du, mesh->Trans);
    if (determinant(mesh->Trans->matrix) < 0.0) // mirrored: so is the side of the cross product
      handedness = -handedness;
  }
  dv = handedness * cross(outside, du);
  return dot(du, du) > 0.0;
}

// ---- other objects ----

// The same from differences of UVCoord() along the surface.
bool difference_directions(const Intersection &isect, const Vector3d &raw_normal,
                           TraceThreadData *thread, Vector3d &du, Vector3d &dv) {
  const BBOX_VECT &size = isect.Object->BBox.Lengths;
  const double largest = max(max(size[X], size[Y]), size[Z]),
               smallest = min(min(size[X], size[Y]), size[Z]);
  // Small against the object, large against the rounding of its UV coordinates.
  const double step = 1e-5 * min(max(max(smallest, 1e-4 * largest), 1e-6), 1e6);
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

  const Vector3d gradient_u = slope[0][U] * side[0] + slope[1][U] * side[1];
  const double det = slope[0][U] * slope[1][V] - slope[1][U] * slope[0][V];
  const double scale = fabs(slope[0][U] * slope[1][V]) + fabs(slope[1][U] * slope[0][V]);

  if (fabs(det) > 1e-9 * scale) {
    const double sign = (det > 0.0) ? 1.0 : -1.0;
    du = sign * (slope[1][V] * side[0] - slope[0][V] * side[1]);
    dv = sign * (slope[0][U] * side[1] - slope[1][U] * side[0]);
  } else {
    // A lathe keeps v with the intersection, not with the point. There u runs
    // around the axis, across v.
    du = gradient_u;
    dv = cross(raw_normal, du);
  }
  return std::isfinite(dot(du, du)) && dot(du, du) > 0.0;
}

bool uv_directions(const Intersection &isect, const Vector3d &raw_normal, const Vector3d &outside,
                   TraceThreadData *thread, const mdf::Scene &scene, Vector3d &du, Vector3d &dv) {
  const Mesh *mesh = dynamic_cast<const Mesh *>(isect.Object);

  if (mdf_uv(isect.Object, scene) == MDF_UV_NONE)
    return false;
  if (mesh != NULL)
    return mesh_directions(mesh, scene.meshes.find(mesh->Data)->second, isect, outside, du, dv);
  return difference_directions(isect, raw_normal, thread, du, dv);
}

// Where a normal map of the object points, world space, on the eye's side.
// du and dv as above. The bitangent is the perpendicular of normal and tangent
// on the side of dP/dv: what handedness · N x T is in a right-handed space.
Vector3d mapped_normal(const mdf::Material &material, const double uv[2],
                       const Vector3d &raw_normal, bool front, const Vector3d &du,
                       const Vector3d &dv) {
  double n[3];
  Vector3d tangent(du);

  if (!orthogonalise(tangent, raw_normal))
    return raw_normal;

  Vector3d bitangent = cross(raw_normal, tangent);
  if (dot(bitangent, dv) < 0.0)
    bitangent = -bitangent;
  material.bump->normal(uv[U], uv[V], material.strength, n);
  // Seen from behind, a bump is a dent: the normal turns round as a whole.
  const double side = front ? 1.0 : -1.0;
  return side * n[X] * tangent + side * n[Y] * bitangent + n[Z] * raw_normal;
}

// Two bumps on one surface: their slopes -n.xy/n.z add, as heights would.
Vector3d add_slopes(const Vector3d &a, const Vector3d &b, const Vector3d &up) {
  const double az = dot(a, up), bz = dot(b, up);
  return ((a - az * up) * bz + (b - bz * up) * az + (az * bz) * up).normalized();
}

} // namespace

MdfUv mdf_uv(const ObjectBase *object, const mdf::Scene &scene) {
  if (const Mesh *mesh = dynamic_cast<const Mesh *>(object)) {
    const std::map<const void *, mdf::MeshTangents>::const_iterator found =
        scene.meshes.find(mesh->Data);
    return (found != scene.meshes.end() && !found->second.empty()) ? MDF_UV_FULL : MDF_UV_NONE;
  }
  if (dynamic_cast<const Lathe *>(object) != NULL)
    return MDF_UV_DIRECTION;
  if (dynamic_cast<const Sphere *>(object) != NULL || dynamic_cast<const Box *>(object) != NULL ||
      dynamic_cast<const Torus *>(object) != NULL || dynamic_cast<const Sor *>(object) != NULL ||
      dynamic_cast<const Ovus *>(object) != NULL)
    return MDF_UV_FULL;
  return MDF_UV_NONE;
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

  mdf::MeshTangents &kept = scene.meshes[data];
  kept.clear();
  if (without < (long)corners) {
    kept.resize(4 * corners);
    for (size_t t = 0; t < triangles; t++) {
      const Corners c = corners_of(data, &data->Triangles[t]);
      for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < 4; i++)
          kept[4 * (3 * t + (size_t)c.order[k]) + i] = tangents[4 * (3 * t + k) + i];
    }
  }
  return without;
}

MdfHit::MdfHit(const mdf::Material *material, const Intersection &isect, const Ray &ray,
               const Vector3d &raw_normal, const Vector3d &layer_normal, TraceThreadData *thread,
               mdf::Dump *d, int p)
    : dump(NULL), pixel(-1), global_lights(0) {
  if (material == NULL)
    return;

  const mdf::Scene &scene = thread->GetSceneData()->mdfScene;
  const ObjectBase *object = isect.Object;
  const Vector3d N = raw_normal.normalized(), V = -Vector3d(ray.Direction).normalized();
  Vector3d outside, du, dv, T, Ns = layer_normal.normalized();
  UV_VECT uv = {0.0, 0.0};
  bool has_uv = false;

  if (mdf_uv(object, scene) != MDF_UV_NONE) {
    Intersection copy(isect); // Normal() wants to write to it
    object->Normal(*outside, &copy, thread);
    object->UVCoord(uv, &isect, thread);
    has_uv = uv_directions(isect, N, outside, thread, scene, du, dv);
  }

  if (material->bump && has_uv && mdf_uv(object, scene) == MDF_UV_FULL) {
    const bool front = (dot(outside, N) > 0.0) != (Test_Flag(object, INVERTED_FLAG) != 0);
    Ns = add_slopes(Ns, mapped_normal(*material, uv, N, front, du, dv), N);
  }

  T = du;
  if (material->tangent == mdf::Material::TANGENT_AXIS)
    T = axis_tangent(object, Vector3d(material->axis), N);
  else if (!has_uv || !orthogonalise(T, N))
    T = axis_tangent(object, axis_vector(X), N);

  point = mdf::ShadedPoint(material, *N, *T, *Ns, *V);
  if (p >= 0 && d->hit(p, material, isect.IPoint, uv, *N, *T, *Ns, *V)) {
    dump = d;
    pixel = p;
    global_lights = (int)thread->GetSceneData()->lightSources.size();
  }
}

void MdfHit::AddLight(const VECTOR direction, const RGBColour &light_colour,
                      const LightSource *light, RGBColour &colour) const {
  if (!point.has_material())
    return;

  const double E[3] = {M_PI * light_colour.red(), M_PI * light_colour.green(),
                       M_PI * light_colour.blue()};
  double S[3];

  point.light(direction, E, S);
  colour += RGBColour((COLC)S[0], (COLC)S[1], (COLC)S[2]);
  if (dump != NULL && light != NULL)
    dump->light(pixel, (int)light->index + (light->lightGroupLight ? global_lights : 0), direction,
                E, S);
}

} // namespace pov
