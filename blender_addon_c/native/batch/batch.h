/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The path of a sample, in the order of the stages:
 *
 *   camera   sample positions to rays                              by lane
 *   (trace)  accel_intersect
 *   locate   hits to triangle records
 *   gather   hits only, one material after the other               by hit from here on
 *   corner   the triangle's corners, interpolated: one row of 8 floats a hit
 *   surface  position, frame, direction to the eye, uv
 *   bilinear, bump, tint                                          textures
 *   disc, light, lit                                              each light: direction, shadow ray
 *   (trace)  accel_occluded
 *   shadow
 *   (shade)  shade_bsdf_eval_batchf for each material
 *   reflect  f cos E, added up over the lights
 *   film     averages over the samples of each pixel               by lane again
 *
 * Every stage is a loop over arrays which are its own restrict parameters: neither gcc nor
 * clang vectorises loops over a structure of arrays. The stages are compiled once for
 * each instruction set; a stage_table holds the functions of one.
 */
#ifndef LIBSHADE_BATCH_H
#define LIBSHADE_BATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"
#include "scene/texture.h"

enum { BATCH = 1024 };

/*
 * One array of a batch: whole cache lines, and one more, so that the same lane of different
 * arrays does not fall into the same set of the cache.
 */
typedef __attribute__((aligned(64))) float lanes[BATCH + 16];
typedef __attribute__((aligned(64))) uint32_t lanes_u[BATCH + 16];

typedef struct batch_rays {
  lanes ox, oy, oz, tnear;
  lanes dx, dy, dz, tfar;
} batch_rays;
typedef struct batch_hits {
  lanes gx, gy, gz; /* geometric normal; after `surface` the shadow ray's offset */
  lanes u, v;
  lanes_u record;
} batch_hits;

/* A run of hits of one material. */
typedef struct segment {
  const material *material;
  size_t begin, count;
} segment;

/* All arrays of one thread. */
typedef struct batch {
  /* by lane */
  batch_rays lane_ray;
  batch_hits lane_hit;
  lanes_u hash, primitive, geometry;
  lanes alpha, red, green, blue;
  lanes zero;
  lanes_u identity;
  /* by hit; where all lanes hit one material, ray, hit and lane are the lanes' own */
  batch_rays moved_ray;
  batch_hits moved_hit;
  lanes_u moved_lane;
  size_t hits, segments;
  segment segment[BATCH];
  batch_rays *ray;
  batch_hits *hit;
  const uint32_t *lane;
  __attribute__((aligned(64))) float row[8 * BATCH];
  lanes handed, reach, side;
  lanes px, py, pz;    /* position, world */
  lanes nx, ny, nz;    /* shading frame, world: normal, */
  lanes tx, ty, tz;    /* tangent, */
  lanes bx, by, bz;    /* cross(normal, tangent) */
  lanes wox, woy, woz; /* to the eye, in the shading frame */
  lanes u, v;
  lanes bump_x, bump_y, bump_z; /* perturbed normal, in the shading frame */
  lanes f0_r, f0_g, f0_b, spare;
  lanes sum_r, sum_g, sum_b; /* reflected light of all lights */
  /* by hit, for the light at hand */
  batch_rays shadow_ray; /* dx dy dz: to the light, unit, world */
  lanes disc_a, disc_b, e;
  lanes wix, wiy, wiz; /* to the light, in the shading frame */
  lanes r, g, b, cosine;
} batch;

/* The samples of a tile in one row: lane j is sample j % samples of pixel j / samples (Z order). */
typedef struct camera_view {
  const camera *camera;
  int x, y;         /* the tile's lower left pixel */
  int region[4];    /* no rays for pixels outside: x0 y0 x1 y1 */
  uint32_t first;   /* lane 0 of this batch is lane `first` of the tile */
  float per_sample; /* 1 / samples */
  float step[2];    /* a pixel's size on the view plane */
  uint32_t seed, scramble;
} camera_view;

typedef struct stage_table {
  const char *name;

  void (*camera)(size_t count, const camera_view *view, const uint32_t *restrict point_x,
                 const uint32_t *restrict point_y, const float *restrict warp,
                 uint32_t *restrict hash, float *restrict ox, float *restrict oy,
                 float *restrict oz, float *restrict tnear, float *restrict dx, float *restrict dy,
                 float *restrict dz, float *restrict tfar);

  /* geometry, primitive, u, v of the second half of a quad become those of its own triangle.
     Returns the number of hits. */
  size_t (*locate)(size_t count, uint32_t triangle_base, const uint32_t *restrict geometry,
                   const uint32_t *restrict primitive, float *restrict u, float *restrict v,
                   uint32_t *restrict record, float *restrict alpha);
  void (*gather)(size_t count, const uint32_t *restrict lane, const float *restrict in,
                 float *restrict out);

  void (*corner)(size_t count, const triangle *restrict triangles, const uint32_t *restrict record,
                 const float *restrict u, const float *restrict v, float *restrict row,
                 float *restrict handed, float *restrict reach);
  void (*surface)(size_t count, const float *restrict row, const float *restrict reach,
                  const float *restrict ox, const float *restrict oy, const float *restrict oz,
                  const float *restrict dx, const float *restrict dy, const float *restrict dz,
                  const float *restrict t, float *restrict gx, float *restrict gy,
                  float *restrict gz, float *restrict px, float *restrict py, float *restrict pz,
                  float *restrict nx, float *restrict ny, float *restrict nz, float *restrict tx,
                  float *restrict ty, float *restrict tz, float *restrict bx, float *restrict by,
                  float *restrict bz, float *restrict wox, float *restrict woy, float *restrict woz,
                  float *restrict uv_u, float *restrict uv_v, float *restrict side);

  void (*bilinear)(size_t count, const texture *texture, const float *restrict u,
                   const float *restrict v, float *restrict a, float *restrict b);
  void (*bump)(size_t count, const float *restrict handed, const float *restrict side,
               float *restrict x, float *restrict y, float *restrict z);
  void (*tint)(size_t count, float *restrict c);

  void (*disc)(size_t count, const uint32_t *restrict lane, const uint32_t *restrict hash,
               const uint32_t *restrict point_x, const uint32_t *restrict point_y, uint32_t salt,
               uint32_t scramble, float *restrict a, float *restrict b);
  /* By light_type. a, b: points of the unit disc; p: the hits. */
  void (*light[LIGHT_TYPES])(size_t count, const light *light, const float *restrict a,
                             const float *restrict b, const float *restrict px,
                             const float *restrict py, const float *restrict pz, float *restrict lx,
                             float *restrict ly, float *restrict lz, float *restrict e,
                             float *restrict tfar);
  void (*lit)(size_t count, const float *restrict lx, const float *restrict ly,
              const float *restrict lz, const float *restrict px, const float *restrict py,
              const float *restrict pz, const float *restrict gx, const float *restrict gy,
              const float *restrict gz, const float *restrict nx, const float *restrict ny,
              const float *restrict nz, const float *restrict tx, const float *restrict ty,
              const float *restrict tz, const float *restrict bx, const float *restrict by,
              const float *restrict bz, float *restrict wix, float *restrict wiy,
              float *restrict wiz, float *restrict ox, float *restrict oy, float *restrict oz,
              float *restrict tfar);
  /* Returns how many hits get light. */
  size_t (*shadow)(size_t count, const float *restrict tfar, float *restrict e);
  void (*reflect)(size_t count, const float color[3], const float *restrict e,
                  const float *restrict cosine, float *restrict r, float *restrict g,
                  float *restrict b, float *restrict sum_r, float *restrict sum_g,
                  float *restrict sum_b);

  void (*scatter)(size_t count, const uint32_t *restrict lane, const float *restrict in,
                  float *restrict out);
  /* Adds lanes to pixels of 4 floats; the first lane is lane `first` of the tile. */
  void (*film)(size_t count, size_t first, size_t samples, const float *restrict r,
               const float *restrict g, const float *restrict b, const float *restrict alpha,
               float *restrict pixels);
} stage_table;

/* Pixel p of a tile: Z order, so that neighbours in a batch are neighbours in the picture. */
static inline void pixel_place(const camera_view *view, uint32_t p, int *x, int *y) {
  *x = view->x;
  *y = view->y;
  for (unsigned bit = 0; bit < 5; bit++) {
    *x += (int)((p >> (2 * bit) & 1u) << bit);
    *y += (int)((p >> (2 * bit + 1) & 1u) << bit);
  }
}

extern const stage_table stages_scalar, stages_sse2, stages_avx2, stages_avx512;

/* Those of the instruction set that libshade chooses: shade_isa. */
const stage_table *stages_choose(void);

#endif
