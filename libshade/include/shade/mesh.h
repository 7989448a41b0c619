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
 * angle over the corners that share position, normal, UV and handedness and hang
 * together by edges, orthogonal to the corner's normal.
 *
 * triangles      number of triangles; corner c of triangle t is number 3t + c
 * position       3 floats per position
 * corner_position  per corner, an index into position
 * corner_normal  3 floats per corner, unit
 * corner_uv      2 floats per corner
 * corner_tangent out: 4 floats per corner: unit tangent x y z, and the handedness
 *                +1 or -1: bitangent = handedness * cross(normal, tangent)
 *
 * The handedness is that of the UVs in the order of the corners, so these must run
 * counter-clockwise as seen from the normal's side. Quads must be split first.
 * A triangle without area in UV or in space adds nothing; its corners take the
 * tangents of their neighbours. A corner that has none gets a unit vector
 * orthogonal to its normal and handedness +1. Non-finite input counts as 0.
 *
 * Corners are matched by value, so indexed and unindexed meshes give the same
 * result. Time and scratch memory (25 bytes, and 9 a position) are linear in the
 * corners.
 * Returns the number of corners without a UV direction, or -1 when out of memory or
 * beyond 715 million triangles (then corner_tangent is untouched). Thread-safe.
 * [Mikkelsen2008]
 */
SHADE_API long shade_mesh_tangents(size_t triangles, const float *position,
                                   const uint32_t *corner_position, const float *corner_normal,
                                   const float *corner_uv, float *corner_tangent);

/*
 * Calls work(context, i) for each i below count, in any order, by as many threads as
 * it likes, and returns once all are done. pool is the caller's own.
 */
typedef void shade_each(void *pool, size_t count, void (*work)(void *context, size_t i),
                        void *context);

/* The same by the caller's threads, and the same bytes. each NULL: by none but this one. */
SHADE_API long shade_mesh_tangents_by(size_t triangles, const float *position,
                                      const uint32_t *corner_position, const float *corner_normal,
                                      const float *corner_uv, float *corner_tangent,
                                      shade_each *each, void *pool);

#ifdef __cplusplus
}
#endif
#endif
