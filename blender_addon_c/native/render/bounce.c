/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/bounce.h"

#include "closure/common.h"
#include "light/light.h"
#include "light/pattern.h"
#include "render/closures.h"
#include "render/environment.h"
#include "render/hits.h"
#include "render/light_passes.h"
#include "render/motion.h"
#include "render/occlusion.h"
#include "render/panorama.h"
#include "render/through.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What points are taken for. */
enum {
  PURPOSE_DRAW,
  PURPOSE_ROULETTE,
  PURPOSE_LENS,
  PURPOSE_CHOICE,
  PURPOSE_LIGHT,
  PURPOSE_CLOTH,
  PURPOSE_SHADOW_ROULETTE, /* and as many more as there are lamps */
  PURPOSE_TIME = 64
};

bool worker_init(worker *w) {
  w->end = malloc((w->scene->choices + 1) * sizeof *w->end);
  if (!w->end || !batch_init(w) || !light_passes_init(w) || !environment_init(w))
    return false;
  if (w->scene->cloths && !w->observer) {
    if (!cloth_room_init(&w->cloth))
      return false;
    w->batch->input.cloth = &w->cloth;
  }
  if ((!w->scene->features.transparency && !w->scene->features.shadow_linking) ||
      w->observer) /* a dump's shadows are those of opaque surfaces */
    return true;
  return (w->through = through_create(w)) != NULL;
}

void worker_free(worker *w) {
  batch_free(w);
  free(w->end);
  cloth_room_free(&w->cloth);
  through_free(w->through);
  environment_free(w);
  free(w->light);
}

/* Which points a bounce's light or draw takes; no two of one path may take the same. */
static shuffle points_of(const worker *w, size_t phase, int bounce, size_t purpose) {
  const sampling *p = w->sampling;
  uint32_t salt = (uint32_t)(bounce + 1) * 0x85ebca6bu + ((uint32_t)purpose + 1) * 0x9e3779b9u;
  return (shuffle){
      .index = p->point[0] + phase, .reverse = p->reverse, .mask = p->mask, .salt = salt};
}

/* Which term of its footprint each hit on cloth is. */
static void draw_terms(worker *w, int bounce, size_t phase) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  inputs *in = &b->input;
  if (!in->cloth)
    return;
  in->cloth->runs = in->cloth->used = 0;
  shuffle points = points_of(w, phase, bounce, PURPOSE_CLOTH);
  s->shuffled(b->queue.hits, &points, b->queue.lane, b->state, &b->path, in->term,
              b->closures.albedo);
}

/*
 * Each sample's term, if cloth of the batch before lay between the near model and the far one: a
 * term chooses which, and hits in its order are of one model, or nearly, block by block. NULL: any
 * order will do.
 */
static const float *terms_of_samples(worker *w, size_t count, size_t phase) {
  batch *b = w->batch;
  cloth_room *cloth = b->input.cloth;
  if (!cloth || !cloth->mixed)
    return NULL;
  memcpy(b->state->sample, b->queue.identity, count * sizeof(uint32_t));
  shuffle points = points_of(w, phase, 0, PURPOSE_CLOTH);
  w->scene->stages->shuffled(count, &points, b->queue.identity, b->state, &b->path, b->input.term,
                             b->closures.albedo);
  return b->input.term;
}

/* Where on their lights the hits' samples lie; those of another light, by its number, elsewhere. */
static void draw_points(worker *w, size_t number, int bounce, size_t phase) {
  const sampling *p = w->sampling;
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  if (bounce == 0) {
    points points = {.x = p->point[2] + phase,
                     .y = p->point[3] + phase,
                     .salt = ((uint32_t)number + 1) * 0x9e3779b9u,
                     .scramble = p->scramble};
    s->pair(b->queue.hits, &points, b->queue.lane, &b->path, &b->light);
  } else {
    shuffle points = points_of(w, phase, bounce, PURPOSE_LIGHT);
    s->shuffled(b->queue.hits, &points, b->queue.lane, b->state, &b->path, b->light.x, b->light.y);
  }
}

/* Fewer shadow rays: those of light samples that bring little are cast now and then. */
static void roulette_shadows(worker *w, size_t number, int bounce, size_t phase, bool shared,
                             const float *color) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  shuffle points = points_of(w, phase, bounce, PURPOSE_SHADOW_ROULETTE + number);
  s->shuffled(b->queue.hits, &points, b->queue.lane, b->state, &b->path, b->draw.roulette,
              b->draw.choice);
  closures_eval(w, shared);
  s->shadow_roulette(b->queue.hits, w->scene->light_threshold, color, shared, b->draw.roulette,
                     &b->reflection, &b->light);
}

/* What the camera sees is worth a shadow ray for each of a few lamps: to choose one among three
 * makes the only noise of a picture that otherwise has none. */
static bool takes_all_lamps(const scene *s, int bounce) {
  enum { FEW = 4 };
  return s->choices == s->lights && s->lights <= (bounce == 0 ? FEW : 1);
}

/* Whether shadow rays side by side go alike: from what the camera sees to a lamp without a size. */
static bool is_coherent(const scene *s, size_t number, int bounce) {
  return bounce == 0 && takes_all_lamps(s, bounce) && !s->light[number].common.soft;
}

/* What the hits reflect of their light samples: b->sum grows by it. number: of the light, where all
 * have the same. */
static void reflect(worker *w, size_t number, int bounce, size_t phase, bool shadow, bool shared,
                    const float *color, clock_number clock) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  size_t hits = b->queue.hits;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++)
    s->lit(g->run, g->material->traits & CLOSURE_THROUGH, hits_lifted(w), &b->surface, &b->light);
  clock_tick(&w->clocks, clock);
  bool roulette = shadow && w->scene->light_threshold > 0.0f && !w->observer;
  if (roulette)
    roulette_shadows(w, number, bounce, phase, shared, color);
  if (shadow && w->through)
    color = through_shadows(w, color) ? NULL : color;
  else if (shadow)
    accel_occluded(w->scene->accel, hits, is_coherent(w->scene, number, bounce), &b->light.ray);
  size_t lit = s->shadow(hits, &b->light);
  clock_tick(&w->clocks, CLOCK_SHADOW);
  if (!lit && !w->observer)
    return;
  if (!roulette)
    closures_eval(w, shared);
  s->reflect(hits, color, shared, &b->light, &b->reflection, &b->sum);
  if (w->light)
    light_passes_reflected(w);
  clock_tick(&w->clocks, CLOCK_REFLECT);
}

/* Some lights are for some instances alone: what they give to others is none. */
static void unlink(const worker *w, uint32_t link, float *restrict gives) {
  const scene *s = w->scene;
  const batch *b = w->batch;
  for (size_t i = 0; link && i < b->queue.hits; i++)
    gives[i] = (uint32_t)instance_at(s, b, i)->unlit & link ? 0.0f : gives[i];
}

/* The same of the instances that shine, for the light samples from place begin to end. What some
 * alone shade is found by these alone, as lamps are: drawn rays would ask for no shadow. */
static void unlink_emitters(worker *w, size_t begin, size_t end) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t k = begin; k < end; k++) {
    const instance *of = &s->instance[s->emitters.instance[b->drawn.triangle[k]]];
    if ((uint32_t)instance_at(s, b, b->choice.lane[k])->unlit & of->link)
      b->drawn.e[k] = 0.0f;
    if (of->shade)
      b->drawn.pdf[k] = 0.0f;
  }
}

/* Does an instance not shine for what has cast this ray? lit: light samples find its light, too. */
static bool is_dark(const instance *of, const path_states *state, size_t ray, bool lit) {
  bool seen = (state->ray[ray] & RAY_CAMERA) != 0;
  return (of->link & state->unlit[ray]) || (of->shade && lit && !seen);
}

/* What hits shine with, where it is not for the surface before. */
static void hide_emission(worker *w) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t i = 0; i < b->queue.hits; i++)
    if (is_dark(instance_at(s, b, i), b->state, b->queue.lane[i], false))
      b->sum.r[i] = b->sum.g[i] = b->sum.b[i] = 0.0f;
}

/* What lights the surfaces from which paths go on. */
static void carry_unlit(worker *w, size_t rays) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t k = 0; k < rays; k++) {
    uint32_t i = b->chosen[k];
    bool straight = (b->draw.kind[i] & BOUNCE_MASK) == BOUNCE_TRANSPARENT;
    b->next->unlit[k] =
        straight ? b->state->unlit[b->queue.lane[i]] : (uint32_t)instance_at(s, b, i)->unlit;
  }
}

/* Whether the film may be seen through all that is before rays. */
static void carry_clear(worker *w, size_t rays) {
  batch *b = w->batch;
  for (size_t k = 0; k < rays; k++) {
    uint32_t i = b->chosen[k], kind = b->draw.kind[i];
    bool on = (kind & BOUNCE_MASK) == BOUNCE_TRANSPARENT || kind & BOUNCE_CLEAR;
    b->next->clear[k] = on ? b->state->clear[b->queue.lane[i]] : 0;
  }
}

/* Rays that surfaces have drawn end at some distance, however often they go straight on. */
static void shorten(worker *w, size_t count) {
  batch *b = w->batch;
  rays *ray = &b->sample_ray;
  for (size_t k = 0; k < count; k++) {
    vec3 o = load(&ray->o, k), from = load(&b->next->from, k);
    vec3 way = {o.x - from.x, o.y - from.y, o.z - from.z};
    if (b->next->ray[k] != RAY_CAMERA)
      ray->tfar[k] = w->scene->reach - sqrtf(dot(way, way));
  }
}

/* The colours of a lamp that shines by direction, as each hit sees it. */
static void paint(const light *l, size_t hits, const surfaces *at, light_samples *light) {
  for (size_t i = 0; i < hits; i++) {
    float part[3];
    light_pattern_seen(l->common.pattern, load(&at->p, i), load(&light->ray.d, i), part);
    light->color.r[i] = part[0] * l->common.color[0];
    light->color.g[i] = part[1] * l->common.color[1];
    light->color.b[i] = part[2] * l->common.color[2];
  }
}

/* Those of light samples, from place begin to end. */
static void paint_chosen(const light *l, size_t begin, size_t end, const light_choices *choice,
                         const surfaces *at, light_draws *drawn) {
  for (size_t k = begin; k < end; k++) {
    float part[3];
    light_pattern_seen(l->common.pattern, load(&at->p, choice->lane[k]), load(&drawn->d, k), part);
    drawn->color.r[k] *= part[0];
    drawn->color.g[k] *= part[1];
    drawn->color.b[k] *= part[2];
  }
}

/* What rays meet of it. */
static void paint_hit(const light *l, size_t rays, const path_states *state, const lane_v *way,
                      const lane_c *restrict own, lane_c *restrict emitted) {
  for (size_t k = 0; k < rays; k++) {
    float part[3];
    if (own->r[k] == 0.0f && own->g[k] == 0.0f && own->b[k] == 0.0f)
      continue;
    light_pattern_seen(l->common.pattern, load(&state->from, k), load(way, k), part);
    emitted->r[k] += part[0] * own->r[k];
    emitted->g[k] += part[1] * own->g[k];
    emitted->b[k] += part[2] * own->b[k];
  }
}

/* One light on all hits. */
static void illuminate(worker *w, size_t number, int bounce, size_t phase) {
  const light *l = &w->scene->light[number];
  const light_common *c = &l->common;
  bool spread = c->soft && w->sampling->scramble; /* a dump takes lights at their middles */
  if (spread)
    draw_points(w, number, bounce, phase);
  for (size_t i = 0; w->scene->features.light_visibility && i < w->batch->queue.hits; i++)
    w->batch->light.hidden[i] = c->hidden;
  for (size_t i = 0; w->scene->features.shadow_linking && i < w->batch->queue.hits; i++)
    w->batch->light.shade[i] = c->shade;
  w->scene->stages->light[l->type](w->batch->queue.hits, l, spread, &w->batch->surface,
                                   &w->batch->light);
  unlink(w, w->observer ? 0 : c->link, w->batch->light.e);
  if (c->pattern)
    paint(l, w->batch->queue.hits, &w->batch->surface, &w->batch->light);
  reflect(w, number, bounce, phase, c->shadow, spread && c->mis, c->pattern ? NULL : c->color,
          CLOCK_LIGHT + (clock_number)l->type);
}

/* After the lamps come the sky and the emitters, as far as there are any. */
static bool is_sky(const scene *s, size_t number) {
  return number == s->lights && s->sky.power > 0.0f;
}

/* What one light may give to these points. */
static void weigh(worker *w, size_t number, size_t count, const lane_v *p, float *one) {
  const scene *s = w->scene;
  const light_pattern *pattern = number < s->lights ? s->light[number].common.pattern : NULL;
  if (number < s->lights)
    s->stages->weigh[s->light[number].type](count, &s->light[number], p, one);
  for (size_t i = 0; pattern && i < count; i++)
    one[i] = clampf(one[i] * light_pattern_weight(pattern, load(p, i)), 0.0f, 1e30f);
  if (number < s->lights)
    return;
  if (is_sky(s, number))
    for (size_t i = 0; i < count; i++)
      one[i] = s->sky.power;
  else
    s->stages->weigh_emitters(count, &s->emitters, p, one);
}

/* A light for each hit, by what it may give there; b->weight.total: what all may give. */
static void choose_lights(worker *w, int bounce, size_t phase) {
  const scene *s = w->scene;
  batch *b = w->batch;
  light_weights *weight = &b->weight;
  size_t hits = b->queue.hits;
  shuffle points = points_of(w, phase, bounce, PURPOSE_CHOICE);
  s->stages->shuffled(hits, &points, b->queue.lane, b->state, &b->path, b->choice.random,
                      b->choice.chance);
  memset(weight->total, 0, hits * sizeof(float));
  memset(weight->sum, 0, hits * sizeof(float));
  memset(b->choice.number, 0xff, hits * sizeof(uint32_t)); /* LIGHT_NONE */
  for (size_t k = 0; k < s->choices; k++) {
    float *one = weight->one[k % LIGHT_WEIGHTS];
    weigh(w, k, hits, &b->surface.p, one);
    unlink(w, k < s->lights ? s->light[k].common.link : 0, one);
    s->stages->add(hits, one, weight->total);
  }
  for (size_t k = 0; k < s->choices; k++) {
    float *one = weight->one[k % LIGHT_WEIGHTS];
    if (s->choices > LIGHT_WEIGHTS) {
      weigh(w, k, hits, &b->surface.p, one);
      unlink(w, k < s->lights ? s->light[k].common.link : 0, one);
    }
    s->stages->choose(hits, (uint32_t)k, one, weight, &b->choice);
  }
}

/* The hits by their lights, each light's one after the other up to place w->end. Those that have
 * none share a place beyond, that is dark. */
static void sort_by_light(worker *w) {
  batch *b = w->batch;
  light_choices *c = &b->choice;
  size_t hits = b->queue.hits, choices = w->scene->choices;
  memset(w->end, 0, choices * sizeof *w->end);
  for (size_t i = 0; i < hits; i++)
    if (c->number[i] != LIGHT_NONE)
      w->end[c->number[i]]++;
  for (size_t k = 0, begin = 0; k < choices; k++) {
    size_t lanes = w->end[k];
    w->end[k] = begin;
    begin += lanes;
  }
  for (size_t i = 0; i < hits; i++) {
    c->place[i] = BATCH;
    if (c->number[i] != LIGHT_NONE) {
      c->place[i] = (uint32_t)w->end[c->number[i]]++;
      c->lane[c->place[i]] = (uint32_t)i;
    }
  }
}

static void illuminate_by_sky(worker *w, size_t begin, size_t end) {
  const scene *s = w->scene;
  batch *b = w->batch;
  s->stages->sky_draw(end - begin, &s->sky, b->choice.lane + begin, &b->light, &b->toward,
                      b->sky_pdf);
  environment_eval(w, &s->sky, end - begin, &b->toward, &b->sky);
  s->stages->lit_by_sky(begin, end, &b->choice, &b->toward, b->sky_pdf, &b->sky, &b->drawn);
}

/* From whom the lights that points have chosen are hidden. */
static void find_hidden(worker *w) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t i = 0; i < b->queue.hits; i++) {
    uint32_t k = b->choice.number[i];
    b->light.hidden[i] = k == LIGHT_NONE ? 0
                         : k < s->lights ? s->light[k].common.hidden
                         : is_sky(s, k)  ? s->sky_hidden
                                         : 0;
  }
}

/* Which instances do not shade them. */
static void find_shades(worker *w) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t i = 0; i < b->queue.hits; i++) {
    uint32_t k = b->choice.number[i];
    bool shines = k != LIGHT_NONE && k >= s->lights && !is_sky(s, k);
    b->light.shade[i] =
        k < s->lights ? s->light[k].common.shade
        : shines ? s->instance[s->emitters.instance[b->drawn.triangle[b->choice.place[i]]]].shade
                 : 0;
  }
}

/* One light, or the sky, on each hit. */
static void illuminate_by_choice(worker *w, int bounce, size_t phase) {
  const scene *s = w->scene;
  batch *b = w->batch;
  choose_lights(w, bounce, phase);
  sort_by_light(w);
  draw_points(w, 0, bounce, phase);
  clock_tick(&w->clocks, CLOCK_CHOICE);
  for (size_t k = 0, begin = 0; k < s->choices; begin = w->end[k++]) {
    if (w->end[k] > begin && k < s->lights) {
      s->stages->chosen[s->light[k].type](begin, w->end[k], &b->choice, &s->light[k], &b->surface,
                                          &b->light, &b->drawn);
      if (s->light[k].common.pattern)
        paint_chosen(&s->light[k], begin, w->end[k], &b->choice, &b->surface, &b->drawn);
      clock_tick(&w->clocks, CLOCK_LIGHT + (clock_number)s->light[k].type);
    } else if (w->end[k] > begin && is_sky(s, k)) {
      illuminate_by_sky(w, begin, w->end[k]);
      clock_tick(&w->clocks, CLOCK_SKY);
    } else if (w->end[k] > begin) {
      s->stages->lit_by_emitters(begin, w->end[k], &b->choice, hits_lifted(w), &s->emitters,
                                 &b->surface, &b->light, &b->drawn);
      if (s->features.emitter_linking)
        unlink_emitters(w, begin, w->end[k]);
      clock_tick(&w->clocks, CLOCK_EMITTERS);
    }
  }
  s->stages->place_samples(b->queue.hits, &b->choice, &b->drawn, &b->light);
  if (s->features.light_visibility)
    find_hidden(w);
  if (s->features.shadow_linking)
    find_shades(w);
  clock_tick(&w->clocks, CLOCK_CHOICE);
  reflect(w, 0, bounce, phase, true, s->features.hit_lights, NULL, CLOCK_SHADOW);
}

static void zero(lane_c *color, size_t count) {
  memset(color->r, 0, count * sizeof(float));
  memset(color->g, 0, count * sizeof(float));
  memset(color->b, 0, count * sizeof(float));
}

/* How bright direct light of a sample may be, and indirect. */
typedef struct clamps {
  float most[2];
} clamps;
static clamps clamps_of(const scene *s) {
  return (clamps){{s->clamp_direct > 0.0f ? s->clamp_direct : INFINITY,
                   s->clamp_indirect > 0.0f ? s->clamp_indirect : INFINITY}};
}

/* What hits shine with is light of the surface before, and is clamped as such. */
static void gain_shone(worker *w) {
  batch *b = w->batch;
  const stage_table *s = w->scene->stages;
  const clamps bright = clamps_of(w->scene);
  if (w->scene->features.transparency)
    s->mute(b->queue.hits, b->queue.lane, b->state, &b->sum);
  s->gain(b->queue.hits, bright.most, 1, b->queue.lane, b->state, &b->sum, &b->sample_color);
  zero(&b->sum, b->queue.hits);
}

/* Surfaces, nodes and lights of the hits of one bounce. */
static void shade(worker *w, const camera_view *view, int bounce, size_t phase) {
  enum { MANY = 12 }; /* samples, by whose mean what cloth interpolates is a pixel's own */
  const scene *s = w->scene;
  batch *b = w->batch;
  if (s->features.ray_cones)
    s->stages->width(b->queue.hits, b->queue.lane, b->state, b->ray, &b->surface);
  hits_surface(w);
  if (s->features.pixel_size)
    s->stages->footprint(b->queue.hits, b->queue.lane, b->state, b->ray, &b->surface);
  if (s->features.light_path)
    s->stages->route_hit(b->queue.hits, b->queue.lane, b->state, b->ray, &b->surface);
  for (size_t i = 0; s->features.light_path && s->features.transparent_glass && i < b->queue.hits;
       i++)
    b->surface.ray[i] |= b->state->clear[b->queue.lane[i]] ? RAY_FILM : 0;
  if (s->features.object_motion)
    motion_shadows(w);
  draw_terms(w, bounce, phase);
  b->input.beside = bounce == 0 && !w->observer && w->sampling->whole >= MANY;
  hits_nodes(w);
  zero(&b->sum, b->queue.hits);
  w->later = bounce > 0;
  b->input.blurs = w->later && s->blur_glossy > 0.0f;
  if (b->input.blurs)
    s->stages->blur(b->queue.hits, 1.0f / s->blur_glossy, b->queue.lane, b->state, b->input.blur);
  const bool shone = closures_weigh(w, bounce == 0);
  if (s->features.emitter_linking && w->later)
    hide_emission(w);
  if (s->features.holdout && !w->observer)
    closures_hold(w, view);
  w->aims = w->observer || bounce >= s->max_bounces ? 0 : s->aims.count;
  closures_aim(w);
  if (w->light)
    light_passes_shone(w);
  w->apart = shone && w->later && (s->clamp_direct > 0.0f || s->clamp_indirect > 0.0f);
  if (w->apart)
    gain_shone(w);
  if (w->observer)
    w->observer->hits(w->observer->context, b, view);
  if (w->observer) {
    for (size_t k = 0; k < s->lights; k++) {
      illuminate(w, k, bounce, phase);
      w->observer->light(w->observer->context, b, view, k, &s->light[k]);
    }
  } else if (takes_all_lamps(s, bounce)) {
    for (size_t k = 0; k < s->lights; k++)
      illuminate(w, k, bounce, phase);
    memset(b->weight.total, 0, b->queue.hits * sizeof(float)); /* no choice was made */
  } else if (s->choices) {
    illuminate_by_choice(w, bounce, phase);
  }
  clock_start(&w->clocks); /* an observer's time is no stage's */
}

/* Draws where the paths go on; returns how many do. */
static size_t go_on(worker *w, int bounce, size_t phase) {
  enum { FIRST_ROULETTE = 3 }; /* before, paths are too few to lose */
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  const queue *q = &b->queue;
  shuffle points = points_of(w, phase, bounce, PURPOSE_DRAW);
  s->shuffled(q->hits, &points, q->lane, b->state, &b->path, b->draw.x, b->draw.y);
  points = points_of(w, phase, bounce, PURPOSE_ROULETTE);
  s->shuffled(q->hits, &points, q->lane, b->state, &b->path, b->draw.roulette, b->draw.choice);
  closures_draw(w);
  if (w->scene->features.transparent_glass)
    closures_clear(w);
  if (w->light)
    light_passes_drawn(w);
  size_t rays =
      s->next_paths(q->hits, bounce >= FIRST_ROULETTE, &w->scene->limits,
                    w->scene->features.hit_lights, q->lane, &b->surface, b->state, b->weight.total,
                    &b->draw, &b->moved_ray, b->chosen, b->next, &b->sample_ray);
  if (w->scene->features.ray_cones)
    s->spread(rays, b->chosen, q->lane, &b->surface, &b->draw, b->state, b->next);
  if (w->scene->features.pixel_size)
    s->carry(rays, b->chosen, q->lane, &b->surface, b->state, b->next);
  if (w->scene->features.light_path)
    s->route_next(rays, b->chosen, &b->surface, &b->draw, b->next);
  if (w->scene->features.emitter_linking)
    carry_unlit(w, rays);
  if (w->scene->features.transparent_glass)
    carry_clear(w, rays);
  if (w->scene->reach > 0.0f)
    shorten(w, rays);
  clock_tick(&w->clocks, CLOCK_DRAW);
  return rays;
}

/* Rays that meet nothing, in b->missed, and where they go; not those through which the film is
 * seen. Returns their number. */
static size_t find_missed(worker *w, size_t rays) {
  const scene *s = w->scene;
  batch *b = w->batch;
  size_t missed =
      s->stages->missed(rays, b->sample_hit.record, &b->sample_ray, b->missed, &b->toward);
  if (!s->features.transparent_glass)
    return missed;
  size_t left = 0;
  for (size_t k = 0; k < missed; k++) {
    b->missed[left] = b->missed[k];
    store(&b->toward, left, load(&b->toward, k));
    left += !b->state->clear[b->missed[k]];
  }
  return left;
}

/* The sky where rays meet nothing. */
static void add_hit_sky(worker *w, size_t rays) {
  const scene *s = w->scene;
  batch *b = w->batch;
  size_t missed = find_missed(w, rays);
  environment_eval(w, &s->sky, missed, &b->toward, &b->sky);
  s->stages->sky_pdf(missed, &s->sky, &b->toward, b->sky_pdf);
  s->stages->hit_sky(missed, b->missed, b->sky_pdf, &b->sky, b->state, s->choices > 1, s->sky.power,
                     s->sky_hidden, &b->emitted);
}

/* The same where rays that come by some ways see something else than what light is drawn from. What
 * that brings depends on the shares of both, so these are Cycles' [VeachGuibas1995]: squares count.
 * Samples of light have had the shares that they have elsewhere; the rest is here. */
static void add_hit_looks(worker *w, size_t rays) {
  const scene *s = w->scene;
  batch *b = w->batch;
  const bool drawn = s->sky.power > 0.0f, chosen = s->choices > 1;
  size_t missed = find_missed(w, rays);
  if (drawn)
    s->stages->sky_pdf(missed, &s->sky, &b->toward, b->sky_pdf);
  for (size_t group = 0; group <= s->looks; group++) {
    const ray_look *look = group ? &s->look[group - 1] : NULL;
    const sky *image = look ? (look->sky.there ? &look->sky : NULL) : drawn ? &s->sky : NULL;
    const float *even = look ? look->even : s->background;
    if (image)
      environment_eval(w, image, missed, &b->toward, &b->sky);
    const uint32_t hidden = s->sky_hidden | (image == &s->sky ? 0 : (uint32_t)RAY_CAMERA);
    for (size_t k = 0; k < missed; k++) {
      size_t i = b->missed[k];
      size_t own = s->look_of[ray_way(b->state->ray[i])];
      if ((own != group && group) || (b->state->ray[i] & hidden))
        continue;
      float chance = chosen ? s->sky.power / b->state->lights[i] : 1.0f;
      float other = drawn ? b->sky_pdf[k] * chance / fmaxf(b->state->pdf[i], 1e-30f) : 0.0f;
      float part = 1.0f / (1.0f + other), square = 1.0f / (1.0f + other * other);
      float share = group ? square : own ? part - square : part;
      b->emitted.r[i] += share * (image ? b->sky.r[k] : even[0]);
      b->emitted.g[i] += share * (image ? b->sky.g[k] : even[1]);
      b->emitted.b[i] += share * (image ? b->sky.b[k] : even[2]);
    }
  }
}

/* That of the camera alone, where its rays meet nothing behind what they pass. */
static void add_seen_sky(worker *w, size_t rays) {
  const scene *s = w->scene;
  batch *b = w->batch;
  size_t missed =
      s->stages->missed(rays, b->sample_hit.record, &b->sample_ray, b->missed, &b->toward);
  environment_eval(w, &s->behind, missed, &b->toward, &b->sky);
  for (size_t k = 0; k < missed; k++) {
    size_t ray = b->missed[k];
    if (!(b->state->ray[ray] & RAY_CAMERA))
      continue;
    b->emitted.r[ray] += b->sky.r[k];
    b->emitted.g[ray] += b->sky.g[k];
    b->emitted.b[ray] += b->sky.b[k];
  }
}

/* What drawn rays meet of lights, each with the share that is left to them. */
static void add_hit_lights(worker *w, size_t rays, const float most[2]) {
  const scene *s = w->scene;
  batch *b = w->batch;
  float *weight = s->choices > 1 ? b->weight.one[0] : NULL;
  static const float none[3];
  s->stages->escape(rays, b->sample_hit.record, b->state, s->sky_hidden,
                    s->looks ? none : s->background, s->backdrop, &b->emitted);
  for (size_t k = 0; s->features.transparent_glass && k < rays; k++)
    if (b->state->clear[k])
      b->emitted.r[k] = b->emitted.g[k] = b->emitted.b[k] = 0.0f;
  for (size_t k = 0; k < s->lights; k++)
    if (s->light[k].common.mis) {
      if (weight)
        weigh(w, k, rays, &b->state->from, weight);
      lane_c *emitted = &b->emitted;
      if (s->light[k].common.pattern)
        zero(emitted = &b->sky, rays);
      s->stages->hit_light[s->light[k].type](rays, &s->light[k], b->state, &b->sample_ray, weight,
                                             emitted);
      if (s->light[k].common.pattern)
        paint_hit(&s->light[k], rays, b->state, &b->sample_ray.d, emitted, &b->emitted);
    }
  if (s->looks)
    add_hit_looks(w, rays);
  else if (s->sky.power > 0.0f)
    add_hit_sky(w, rays);
  if (s->behind.there && s->features.transparency && !s->features.transparent_film)
    add_seen_sky(w, rays);
  if (s->emitters.count) {
    if (weight)
      s->stages->weigh_emitters(rays, &s->emitters, &b->state->from, weight);
    for (size_t k = 0; s->features.emitter_linking && k < rays; k++)
      b->missed[k] = b->sample_hit.record[k] != RECORD_MISS &&
                     is_dark(hit_instance(s, b, &b->sample_hit, k), b->state, k, true);
    s->stages->hit_emitters(rays, &s->emitters, s->triangle, b->placed, &b->sample_hit,
                            &b->sample_ray, b->state, weight,
                            s->features.emitter_linking ? b->missed : NULL, &b->emitted);
  }
  s->stages->gain(rays, most, 1, b->queue.identity, b->state, &b->emitted, &b->sample_color);
  if (w->light)
    light_passes_hit(w, rays, most);
}

/* Where rays meet nothing behind glass that is clear to the film, that is seen; not their sky, but
 * lamps that they meet are. */
static void clear_film(worker *w, size_t rays) {
  batch *b = w->batch;
  const path_states *state = b->state;
  for (size_t k = 0; k < rays; k++)
    if (b->sample_hit.record[k] == RECORD_MISS && state->clear[k] && state->ray[k] != RAY_CAMERA)
      b->path.alpha[state->sample[k]] -=
          (state->throughput.r[k] + state->throughput.g[k] + state->throughput.b[k]) *
          (1.0f / 3.0f);
}

/* The bounces after the first: sample_color grows by what they bring. Of a path's last only what
 * its ray meets of lights, which is light of the surface before. */
static void follow(worker *w, const camera_view *view, size_t phase) {
  const scene *s = w->scene;
  batch *b = w->batch;
  const clamps bright = clamps_of(s);
  const float *most = bright.most;
  int passing = s->features.transparency ? (int)s->limits.kind[BOUNCE_TRANSPARENT] + 1 : 0;
  int bounces = s->max_bounces + passing + (s->features.hit_lights ? 1 : 0);
  for (int bounce = 0; bounce < bounces && b->queue.hits; bounce++) {
    if (atomic_load_explicit(w->cancel, memory_order_relaxed))
      return;
    size_t rays = go_on(w, bounce, phase);
    if (!rays)
      return;
    path_states *now = b->next;
    b->next = b->state;
    b->state = now;
    if (s->features.object_motion)
      motion_paths(w, rays);
    hits_trace(w, (ray_kind)0, rays);
    if (w->light && s->features.transparent_film &&
        (s->features.transparency || s->features.transparent_glass))
      light_passes_environment(w, b->state, rays);
    if (s->features.transparency && s->features.transparent_film)
      s->stages->uncover(rays, b->sample_hit.record, b->state, &b->path);
    if (s->features.transparent_glass)
      clear_film(w, rays);
    if (s->features.hit_lights)
      add_hit_lights(w, rays, most);
    b->queue.hits =
        s->stages->end(rays, b->state, s->triangle, s->features.transparency ? s->material : NULL,
                       b->sample_hit.record);
    if (b->queue.hits)
      hits_sort(w, rays, NULL);
    clock_tick(&w->clocks, CLOCK_TRACE);
    if (!b->queue.hits)
      return;
    shade(w, view, bounce + 1, phase);
    if (s->features.transparency)
      s->stages->mute(b->queue.hits, b->queue.lane, b->state, &b->sum);
    s->stages->gain(b->queue.hits, most, 0, b->queue.lane, b->state, &b->sum, &b->sample_color);
    if (w->light)
      light_passes_gain(w, most);
  }
}

/* Every sample a path of weight 1. */
static void begin_paths(worker *w, size_t count) {
  batch *b = w->batch;
  memcpy(b->state->sample, b->queue.identity, count * sizeof(uint32_t));
  for (size_t i = 0; i < count; i++)
    b->state->throughput.r[i] = b->state->throughput.g[i] = b->state->throughput.b[i] = 1.0f;
  if (w->scene->features.transparency)
    for (size_t i = 0; i < count; i++) { /* where they go straight on: no light has had a sample */
      b->state->from.x[i] = b->state->from.y[i] = b->state->from.z[i] = 0.0f;
      b->state->pdf[i] = CLOSURE_CERTAIN;
      b->state->lights[i] = 1e30f;
    }
  for (size_t i = 0; w->scene->features.transparent_glass && i < count; i++)
    b->state->clear[i] = 1;
  for (size_t i = 0; i < count; i++) {
    b->state->ray[i] = RAY_CAMERA;
    b->state->least[i] = INFINITY;
  }
  memset(b->state->ends, 0, count * sizeof(uint32_t));
  memset(b->state->unlit, 0, count * sizeof(uint32_t));
  for (int kind = 0; kind < BOUNCE_KINDS; kind++)
    memset(b->state->bounces[kind], 0, count * sizeof(uint32_t));
}

/* The sky behind all, for rays of the camera that meet nothing. */
static void show_sky(worker *w, size_t count) {
  const scene *s = w->scene;
  batch *b = w->batch;
  size_t missed =
      s->stages->missed(count, b->sample_hit.record, &b->sample_ray, b->missed, &b->toward);
  environment_eval(w, scene_seen_sky(s), missed, &b->toward, &b->sky);
  if (s->clamp_direct > 0.0f)
    s->stages->gain(missed, (const float[2]){s->clamp_direct, INFINITY}, 0, b->missed, b->state,
                    &b->sky, &b->sample_color);
  else
    s->stages->scatter(missed, b->missed, &b->sky, &b->sample_color);
}

/* Light of the camera's rays, by sample: what surfaces reflect, and the sky behind them. `paths`:
 * light by more ways than from one lamp. */
static const lane_c *shade_batch(worker *w, const camera_view *view, bool paths, bool sky,
                                 size_t count, size_t phase) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  const queue *q = &b->queue;
  if (q->hits) {
    if (b->input.cloth)
      b->input.cloth->between = false;
    shade(w, view, 0, phase);
    if (b->input.cloth) /* what the next bounces meet is in no order */
      b->input.cloth->mixed = b->input.cloth->between;
    if (w->numbers) {
      plane_add(w->planes, w->scene, b, view, w->first_pass, w->numbers);
      clock_tick(&w->clocks, CLOCK_FILM);
    }
  }
  if (q->hits && !paths && !sky && q->lane == q->identity)
    return &b->sum;
  zero(&b->sample_color, count);
  if (sky)
    show_sky(w, count);
  if (!q->hits)
    return &b->sample_color;
  const bool clamped = paths && w->scene->clamp_direct > 0.0f;
  const float most[2] = {clamped ? w->scene->clamp_direct : INFINITY, INFINITY};
  if (clamped)
    s->gain(q->hits, most, 0, q->lane, b->state, &b->sum, &b->sample_color);
  else
    s->scatter(q->hits, q->lane, &b->sum, &b->sample_color);
  if (w->light)
    light_passes_gain(w, most);
  if (paths)
    follow(w, view, phase);
  return &b->sample_color;
}

void bounce_batch(worker *w, camera_view *view, size_t count, float *pixels) {
  const sampling *p = w->sampling;
  const scene *scene = w->scene;
  const stage_table *s = scene->stages;
  batch *b = w->batch;
  size_t phase = view->first % p->period;
  bool paths =
      !w->observer && (scene->max_bounces > 0 || scene->features.transparency ||
                       scene->features.hit_lights || scene->choices > 1 ||
                       scene->clamp_direct > 0.0f || w->light || scene->light_threshold > 0.0f);
  view->point[0] = p->point[0] + phase;
  view->point[1] = p->point[1] + phase;
  clock_start(&w->clocks);
  const shuffle aperture = points_of(w, phase, 0, PURPOSE_LENS);
  const bool lens = view->camera->lens[0] + view->camera->lens[1] > 0.0f && !w->observer;
  if (view->camera->panorama)
    panorama_rays(w, view, lens ? &aperture : NULL, count);
  else
    s->camera(count, view, &b->path, &b->sample_ray);
  if (scene->features.motion) {
    shuffle points = points_of(w, phase, 0, PURPOSE_TIME);
    motion_times(w, view, w->observer ? NULL : &points, count);
    if (!w->observer)
      motion_zoom(w, count);
  }
  if (lens && !view->camera->panorama)
    s->lens(count, view->camera, &aperture, &b->path, &b->sample_ray);
  if (scene->features.motion && !w->observer)
    motion_camera(w, count);
  clock_tick(&w->clocks, CLOCK_CAMERA);
  hits_trace(w, RAY_CAMERA, count);
  s->cover(count, &b->sample_hit, &b->path);
  if (view->camera->panorama)
    panorama_cover(w, count);
  bool sky = scene_seen_sky(scene) && !scene->features.transparent_film && !w->observer &&
             b->queue.hits < count;
  if (b->queue.hits)
    hits_sort(w, count, terms_of_samples(w, count, phase));
  clock_tick(&w->clocks, CLOCK_HIT);
  if (!b->queue.hits && !sky && !w->light && !view->camera->panorama)
    return;
  if (paths || scene->features.light_path || scene->features.holdout || b->input.cloth ||
      w->through)
    begin_paths(w, count);
  if (scene->features.pixel_size)
    s->pixel(count, view, &b->sample_ray, b->state);
  if (scene->features.light_path)
    s->route_begin(count, &b->sample_ray, b->state);
  if (scene->features.ray_cones)
    s->pixel_cone(count, view, &b->sample_ray, b->state);
  if (view->camera->panorama && (scene->features.ray_cones || scene->features.pixel_size))
    panorama_cones(w, view, count);
  if (w->light)
    light_passes_begin(w, view, count);
  const lane_c *color = shade_batch(w, view, paths, sky, count, phase);
  s->film(count, view, color, &b->path, pixels, w->half);
  if (w->light)
    light_passes_film(w, count);
  clock_tick(&w->clocks, CLOCK_FILM);
}
