// SPDX-License-Identifier: AGPL-3.0-or-later
// dP/du and dP/dv of POV-Ray's objects, where u and v are its UV coordinates.
#ifndef POVRAY_BACKEND_MDF_TANGENTS_H
#define POVRAY_BACKEND_MDF_TANGENTS_H

#include "backend/frame.h"
#include "backend/mdf/material.h"

namespace pov {

class Mesh;

// How the tangents of an object are found. Meshes: mdf_add_mesh.
mdf::Shape::Kind mdf_kind(const ObjectBase *object);

// Computes the tangents of a mesh (once per MESH_DATA) for the render threads.
// Returns how many of its corners have no UV direction. Throws std::bad_alloc.
long mdf_add_mesh(const Mesh *mesh, mdf::Scene &scene);

namespace glue {

// dP/du and, if wanted, dP/dv, world space. Where both are, their lengths are right. outside: the
// normal of a mesh, as the object has it. False where there are none.
bool uv_directions(const mdf::Shape &shape, const Intersection &isect, const Vector3d &raw_normal,
                   const Vector3d &outside, TraceThreadData *thread, bool with_dv, Vector3d &du,
                   Vector3d &dv);

// A step along a surface for finite differences.
double difference_step(const ObjectBase *object);

} // namespace glue
} // namespace pov

#endif
