/* SPDX-License-Identifier: Apache-2.0 */
/**
 * Tangents of a UV-mapped triangle mesh, by the rules of MikkTSpace.
 *
 * Threads. Every function here is reentrant and free of global state.
 */
#ifndef SHADE_MESH_H /* read once */
#define SHADE_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Tangents for every corner of a triangle mesh.
 *
 * A tangent is dP/du of the UV map, orthogonal to the corner's normal. It is averaged by angle over
 * the corners that share position, normal, UV and handedness and hang together by edges. The
 * bitangent is handedness * cross(normal, tangent). Corner c of triangle t is number 3t + c.
 *
 * The handedness is that of the UVs in the order of the corners. These must run counter-clockwise
 * as seen from the normal's side. Quads must be split first. A triangle without area in UV, but by
 * rounding, or in space adds nothing, and its corners take the tangents of their neighbours. A
 * corner that has none takes one at the same position, made orthogonal to its normal, with its
 * handedness. Where there is none either it takes the X axis, or the Y axis where the normal lies
 * along X, and handedness -1. Non-finite input counts as 0.
 *
 * Corners are matched by value, so that indexed and unindexed meshes give the same result. Time
 * and scratch memory are linear in the corners: 25 bytes a corner, and 9 a position.
 * [Mikkelsen2008]
 *
 * Threads: the call allocates what it needs, and frees it.
 *
 * @param triangles        number of triangles
 * @param position         3 floats per position
 * @param corner_position  per corner, an index into position
 * @param corner_normal    3 floats per corner, unit
 * @param corner_uv        2 floats per corner
 * @param corner_tangent   out: 4 floats per corner, the unit tangent x y z and the handedness +1 or
 *                         -1
 * @return the number of corners without a UV direction; -1, and corner_tangent is untouched, when
 *         out of memory or beyond 715 million triangles
 */
SHADE_API long shade_mesh_tangents(size_t triangles, const float *position,
                                   const uint32_t *corner_position, const float *corner_normal,
                                   const float *corner_uv, float *corner_tangent);

/**
 * Calls work(context, i) for each i below count, in any order, and returns once all are done.
 *
 * It may use as many threads as it likes. pool is the caller's own.
 */
typedef void shade_each(void *pool, size_t count, void (*work)(void *context, size_t i),
                        void *context);

/**
 * shade_mesh_tangents by the threads of the caller. It gives the same bytes.
 *
 * Threads: `each` says which threads do the work. The call returns once they are done.
 *
 * @param triangles        number of triangles
 * @param position         3 floats per position
 * @param corner_position  per corner, an index into position
 * @param corner_normal    3 floats per corner, unit
 * @param corner_uv        2 floats per corner
 * @param corner_tangent   out: 4 floats per corner
 * @param each             calls the work; NULL: this thread does all of it
 * @param pool             handed to each
 * @return as shade_mesh_tangents
 */
SHADE_API long shade_mesh_tangents_by(size_t triangles, const float *position,
                                      const uint32_t *corner_position, const float *corner_normal,
                                      const float *corner_uv, float *corner_tangent,
                                      shade_each *each, void *pool);

#ifdef __cplusplus
}
#endif
#endif
