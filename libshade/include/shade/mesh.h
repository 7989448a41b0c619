/* SPDX-License-Identifier: Apache-2.0 */
/* Tangents of a UV-mapped triangle mesh, by the rules of MikkTSpace. */
#ifndef SHADE_MESH_H
#define SHADE_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Tangents for every corner of a triangle mesh: dP/du of the UV map, averaged by
 * angle over the corners that share position, normal, UV and handedness, orthogonal to the corner's
 * normal.
 *
 * triangles      number of triangles; corner c of triangle t is number 3t + c
 * position       3 floats per position
 * corner_position  per corner, an index into position
 * corner_normal  3 floats per corner, unit
 * corner_uv      2 floats per corner
 * corner_tangent out: 4 floats per corner: unit tangent x y z, and the handedness
 *                +1 or -1: bitangent = handedness * cross(normal, tangent)
 *
 * A corner whose triangles have no UV area gets a unit vector orthogonal to its
 * normal and handedness +1. Non-finite input counts as 0.
 * Corners are matched by value, so indexed and unindexed meshes give the same
 * result. Allocates scratch memory of about 40 bytes per corner. Returns the
 * number of corners without a UV direction, or -1 when out of memory (then
 * corner_tangent is untouched). Thread-safe. [Mikkelsen 2008]
 */
SHADE_API long shade_mesh_tangents(size_t triangles, const float *position,
                                   const uint32_t *corner_position, const float *corner_normal,
                                   const float *corner_uv, float *corner_tangent);

#ifdef __cplusplus
}
#endif
#endif
