/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The path of a sample, in the order of the stages:
 *
 *   camera   sample positions to rays                              by sample
 *   lens     where it is not a pinhole
 *   (trace)  accel_intersect
 *   locate   hits to triangle records
 *   gather   hits only, one material after the other               by hit from here on
 *   corner   the triangle's corners, interpolated: one row of 8 floats a hit
 *   place    into the world, where the scene has instances
 *   surface  position, frame, direction to the eye, uv
 *   lift     shadow rays start above the facets of smooth surfaces
 *   stretch  position by u and v, where materials ask for it
 *   identify which triangle and object, where they ask
 *   (pixel, footprint, carry)                                     how wide a pixel is there
 *   (route_begin, route_hit, route_next)                          by which way they are seen
 *   (pixel_cone, width, spread)                                   how much a ray stands for, of
 * cloth flat, node                                                    what the material's nodes say
 *   pair, light, lit                                              each light: direction, shadow ray
 *   (or weigh, choose, chosen, lit                                one light for each hit)
 *   (trace)  accel_occluded
 *   stopped, sift, pass, tint                                      through transparent surfaces
 *   shadow
 *   closure  f and cosine, for each material
 *   reflect  f cos E, added up over the lights
 *   shuffled, (draw), next_paths                                  the next ray, then from trace on
 *   missed, sky, hit_light, gain                                  lights that it meets
 *   film     averages over the samples of each pixel               by sample again
 *
 * Each is one loop over structures of batch/lanes.h. The stages are compiled once for each
 * instruction set, family by family (isa/); a stage_table holds the functions of one.
 */
#ifndef LIBSHADE_STAGE_H
#define LIBSHADE_STAGE_H

#include "batch/lanes.h"
#include "closure/table.h"
#include "light/table.h"
#include "node/table.h"
#include "scene/queue.h"
#include "scene/scene.h"

/* The samples of a tile in one row: lane j is sample j % samples of pixel j / samples (Z order). */
typedef struct camera_view {
  const camera *camera;
  int x, y;         /* the tile's lower left pixel */
  int region[4];    /* no rays for pixels outside: x0 y0 x1 y1 */
  uint32_t first;   /* lane 0 of this batch is lane `first` of the tile */
  uint32_t samples; /* a pixel */
  float per_sample; /* 1 / samples */
  float step[2];    /* a pixel's size on the view plane */
  uint32_t seed, scramble;
  const uint32_t *point[2]; /* in the pixel, by lane */
  const float *warp;        /* of the pixel filter, or NULL */
} camera_view;

/* Two dimensions of the samples' points, by sample. */
typedef struct points {
  const uint32_t *x, *y;
  uint32_t salt, scramble;
} points;

/* Two dimensions of an Owen-scrambled sequence in an order of its own for each pixel and salt. */
typedef struct shuffle {
  const uint32_t *index;   /* bits reversed: number of each sample in its pixel */
  const uint32_t *reverse; /* sampling.reverse */
  uint32_t mask;           /* its length - 1 */
  uint32_t salt;
} shuffle;

typedef struct stage_table {
  const char *name;

  void (*camera)(size_t count, const camera_view *view, paths *path, rays *ray);
  /* Rays through a pinhole, where the camera has a lens, to rays through that. */
  void (*lens)(size_t count, const camera *camera, const shuffle *points, const paths *path,
               rays *ray);

  /* u and v of the second half of a quad become those of its own triangle. Returns the number of
     hits. */
  size_t (*locate)(size_t count, uint32_t triangle_base, const placed *table, hits *hit);
  void (*cover)(size_t count, const hits *hit, paths *path);
  void (*gather)(size_t count, const uint32_t *lane, const float *in, float *out);

  void (*corner)(size_t count, const triangle *triangles, const hits *hit, corners *corner);
  /* Hits of instances into the world. */
  void (*place)(size_t count, const placed *table, hits *hit, corners *corner);
  void (*surface)(size_t count, const rays *ray, const hits *hit, const corners *corner, bool valid,
                  surfaces *out);
  /* Where the scene has curved triangles. */
  void (*lift)(size_t count, const triangle *triangles, const placed *table, const hits *hit,
               surfaces *out);
  /* Where nodes ask how much of the UV map hits stand for, and for position by u and v. */
  void (*uv_width)(size_t count, const stretch *triangles, const placed *table, const hits *hit,
                   surfaces *out);
  void (*stretch)(size_t count, const stretch *stretches, const triangle *triangles,
                  const placed *table, const hits *hit, surfaces *out);
  /* Where the scene has cones: widths of the camera's rays, by sample, of hits, and of rays drawn.
   */
  void (*pixel_cone)(size_t count, const camera_view *view, const rays *ray, path_states *state);
  void (*width)(size_t count, const uint32_t *lane, const path_states *state, const rays *ray,
                surfaces *out);
  void (*spread)(size_t rays, const uint32_t *chosen, const uint32_t *lane, const surfaces *at,
                 const draws *draw, const path_states *state, path_states *next);
  /* Where heights are read: a pixel's width, of the camera's rays, of hits, of rays drawn. */
  void (*pixel)(size_t count, const camera_view *view, const rays *ray, path_states *state);
  void (*footprint)(size_t count, const uint32_t *lane, const path_states *state, const rays *ray,
                    surfaces *out);
  void (*carry)(size_t rays, const uint32_t *chosen, const uint32_t *lane, const surfaces *at,
                const path_states *state, path_states *next);
  /* Where nodes ask by which way points are seen: lengths of the camera's rays, by sample, ways of
     hits, lengths of rays drawn; ways of hits of shadow rays, whose senders are hits of paths. */
  void (*route_begin)(size_t count, const rays *ray, path_states *state);
  void (*route_hit)(size_t count, const uint32_t *lane, const path_states *state, const rays *ray,
                    surfaces *out);
  void (*route_next)(size_t rays, const uint32_t *chosen, const surfaces *at, const draws *draw,
                     path_states *next);
  void (*route_shadow)(size_t count, uint32_t left, const uint32_t *lane, const passages *way,
                       const uint32_t *sender, const path_states *state, const rays *ray,
                       surfaces *out);
  /* Where nodes ask for layers or objects. */
  void (*identify)(size_t count, const triangle *triangles, const placed *table, const hits *hit,
                   surfaces *out);
  void (*flat)(const segment *g, inputs *out);
  void (*node[NODE_TYPES])(const segment *g, const node *node, const corners *corner,
                           const surfaces *at, inputs *out);

  void (*pair)(size_t count, const points *points, const uint32_t *lane, const paths *path,
               light_samples *out);
  /* By light_type: ray.d, ray.tfar, e and pdf, of the point (x, y) or of the light's middle. */
  void (*light[LIGHT_TYPES])(size_t count, const light *light, bool spread, const surfaces *at,
                             light_samples *out);
  /* The same of places begin to end of a choice, of a light that these points have chosen; its
     colour too. */
  void (*chosen[LIGHT_TYPES])(size_t begin, size_t end, const light_choices *choice,
                              const light *light, const surfaces *at, const light_samples *from,
                              light_draws *out);
  void (*place_samples)(size_t count, const light_choices *choice, const light_draws *in,
                        light_samples *out);
  /* Weights of a light at points. */
  void (*weigh[LIGHT_TYPES])(size_t count, const light *light, const lane_v *p, float *one);
  void (*add)(size_t count, const float *one, float *sum);
  /* Adds a light's weights to weight->sum; those points take it whose random number the sum passes
   * with it.
   */
  void (*choose)(size_t count, uint32_t number, const float *one, light_weights *weight,
                 light_choices *out);
  /* What rays meet of a light on their way, into met. weight: where the light was one of a choice,
     its weights at path state->from. */
  void (*hit_light[LIGHT_TYPES])(size_t count, const light *light, const path_states *state,
                                 const rays *ray, const float *weight, lane_c *emitted);

  /* Triangles that shine (emitters.h). */
  void (*weigh_emitters)(size_t count, const emitters *e, const lane_v *p, float *one);
  void (*lit_by_emitters)(size_t begin, size_t end, const light_choices *choice, bool lifted,
                          const emitters *e, const surfaces *at, const light_samples *from,
                          light_draws *out);
  void (*hit_emitters)(size_t count, const emitters *e, const triangle *triangles,
                       const placed *placed, const hits *hit, const rays *ray,
                       const path_states *state, const float *weight, const uint32_t *dark,
                       lane_c *emitted);

  /* The image around everything (sky.h). */
  sky_look *sky;
  void (*sky_pdf)(size_t count, const sky *sky, const lane_v *d, float *pdf);
  void (*sky_draw)(size_t count, const sky *sky, const uint32_t *lane, const light_samples *from,
                   lane_v *d, float *pdf);
  size_t (*missed)(size_t count, const uint32_t *record, const rays *ray, uint32_t *missed,
                   lane_v *toward);
  /* Sky as the light of places begin to end of a choice; as what missed rays meet. */
  void (*lit_by_sky)(size_t begin, size_t end, const light_choices *choice, const lane_v *d,
                     const float *pdf, const lane_c *sky, light_draws *out);
  void (*hit_sky)(size_t count, const uint32_t *missed, const float *pdf, const lane_c *sky,
                  const path_states *state, bool chosen, float power, uint32_t hidden,
                  lane_c *emitted);
  /* lifted: `lift` has said where shadow rays start. */
  void (*lit)(lane_run run, bool through, bool lifted, const surfaces *at, light_samples *light);
  /* Shadow rays through transparent surfaces (through.h). */
  size_t (*stopped)(size_t count, uint32_t left, bool all, const uint32_t *lane,
                    const path_states *state, const light_samples *light, passages *way, rays *ray);
  size_t (*sift)(size_t count, const triangle *triangles, const material *materials, bool shades,
                 const passages *way, uint32_t *record, light_samples *light);
  size_t (*pass)(size_t count, const uint32_t *lane, const surfaces *at, const rays *came,
                 const lane_c *share, bool shades, passages *way, rays *ray, light_samples *light);
  void (*tint)(size_t count, const float color[3], const passages *way, light_samples *light);
  /* Returns how many hits get light. */
  size_t (*shadow)(size_t count, light_samples *light);
  /* density: out->pdf is wanted too. Returns status bits of libshade. */
  unsigned (*closure[CLOSURE_TYPES])(const closure *c, lane_run run, const surfaces *at,
                                     inputs *given, const lane_v *wi, bool density,
                                     reflections *out);
  /* Lists of closures, in the order of render/closures.c. */
  void (*albedo[CLOSURE_TYPES])(const closure *c, lane_run run, const surfaces *at, inputs *given,
                                float *out);
  void (*chance)(const closure *c, lane_run run, inputs *given, const float *albedo, float *chance,
                 float *sum);
  void (*share)(lane_run run, const float *sum, float *chance);
  void (*emit)(const closure *c, lane_run run, inputs *given, lane_c *sum);
  void (*join_all)(const closure *c, lane_run run, inputs *given, const float *chance,
                   const reflections *part, reflections *out);
  void (*pick)(lane_run run, uint32_t number, const float *chance, uint32_t *drawn, float *choice);
  void (*kind)(lane_run run, bounce_kind kind, bool sharp, draws *out);
  void (*forbid)(lane_run run, bool above, bool below, const uint32_t *lane,
                 const path_states *state, const float *z, float *cosine);
  void (*shadow_roulette)(size_t count, float threshold, const float color[3], bool shared,
                          const float *random, const reflections *reflection, light_samples *light);
  void (*exclude)(lane_run run, uint32_t above, uint32_t below, const light_samples *light,
                  reflections *out);
  void (*take)(const closure *c, lane_run run, uint32_t number, inputs *given,
               const choices *choice, const draws *part, draws *out);
  void (*join)(const closure *c, lane_run run, uint32_t number, inputs *given,
               const choices *choice, const reflections *part, draws *out);
  /* color NULL: each lane's own. shared: drawn rays meet these lights as well. */
  void (*reflect)(size_t count, const float color[3], bool shared, const light_samples *light,
                  reflections *reflection, lane_c *sum);

  /* Points of later bounces, by hit: x and y uniform in [0, 1). sample: by ray. */
  void (*shuffled)(size_t count, const shuffle *points, const uint32_t *lane,
                   const path_states *state, const paths *path, float *x, float *y);
  /* How blurred lobes are at hits; filter: 1 / blur_glossy. */
  void (*blur)(size_t count, float filter, const uint32_t *lane, const path_states *state,
               float *blur);
  /* Returns status bits of libshade. */
  unsigned (*draw[CLOSURE_TYPES])(const closure *c, lane_run run, const surfaces *at, inputs *given,
                                  draws *out);
  /* Draws that are aimed at balls (aim.h). */
  void (*aim)(lane_run run, const aims *aims, const surfaces *at, cones *out);
  void (*aim_pick)(lane_run run, size_t count, cones *cones, draws *out);
  void (*aim_turn)(lane_run run, size_t count, const cones *cones, draws *out);
  void (*aim_mix)(lane_run run, size_t count, const cones *cones, const lane_v *wi, float *pdf);
  void (*aim_take)(lane_run run, const reflections *part, draws *out);
  /* The rays that go on, and their path states: what was drawn and outlives roulette, if
     `roulette`. Returns their number; wide is of use within. */
  size_t (*next_paths)(size_t count, bool roulette, const bounce_limits *limits, bool hit_lights,
                       const uint32_t *lane, const surfaces *at, const path_states *state,
                       const float *lights, draws *draw, rays *wide, uint32_t *chosen,
                       path_states *next, rays *ray);
  /* Adds the light of hits or of rays, by lane, to the samples. What is brighter than most[0], in
     the mean of its three channels, is dimmed to it; most[1] counts after more bounces than `free`.
   */
  void (*gain)(size_t count, const float most[2], uint32_t free, const uint32_t *lane,
               const path_states *state, const lane_c *sum, lane_c *color);
  /* Of rays that only passed through surfaces and meet nothing: the picture shows nothing there. */
  void (*uncover)(size_t count, const uint32_t *record, path_states *state, paths *path);
  /* Hits of paths that end there count as none, but for those of transparent surfaces, behind which
     there may be light; materials NULL: there are none. The number of the others. */
  size_t (*end)(size_t count, const path_states *state, const triangle *triangles,
                const material *materials, uint32_t *record);
  /* Of paths that have ended, no surface's light counts. */
  void (*mute)(size_t count, const uint32_t *lane, const path_states *state, lane_c *sum);
  /* Of rays that meet nothing, an even background; but for rays that it is hidden from. Those of
     the camera see the backdrop. */
  void (*escape)(size_t count, const uint32_t *record, const path_states *state, uint32_t hidden,
                 const float background[3], const float backdrop[3], lane_c *emitted);

  void (*scatter)(size_t count, const uint32_t *lane, const lane_c *in, lane_c *out);
  /* Adds samples to pixels of 4 floats; those of the first half of a pixel's to `half`, 3 floats
     each, or NULL. */
  void (*film)(size_t count, const camera_view *view, const lane_c *color, const paths *path,
               float *pixels, float *half);
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

/* Those of an instruction set, scalar, sse2, avx2, avx512 or neon; of the one that libshade
 * chooses: shade_isa. */
const stage_table *stages_of(const char *isa);
const stage_table *stages_choose(void);

#endif
