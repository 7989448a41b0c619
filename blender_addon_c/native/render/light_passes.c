/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/light_passes.h"

#include <stdlib.h>
#include <string.h>

#include "batch/leaf.h"
#include "closure/closure.h"
#include "render/closures.h"
#include "render/environment.h"
#include "system/memory.h"

enum { LIGHT_KINDS = BOUNCE_TRANSPARENT };          /* the first of bounce_kind */
enum { KIND_BY_SIDE = LIGHT_KINDS, KINDS_SEVERAL }; /* glossy or through; not the same for all */

typedef struct light_passes {
  size_t first, samples; /* of the batch, as in camera_view */
  bool seen;             /* the camera sees some hits: else GLOSSY stands for all kinds */
  /* by hit */
  lane_c shone, reflected[LIGHT_KINDS];
  /* by sample: how much of what comes along its first drawn ray counts as each kind */
  lane_c share[LIGHT_KINDS];
  lane_c sum[LIGHT_PLANES];
  /* at work: of a run's closures, by kind */
  lane_c part[LIGHT_KINDS];
  reflections one;
} light_passes;

bool light_passes_init(worker *w) {
  if (!w->mattes && !(w->planes && w->planes->wanted & PLANES_LIGHT_MASK))
    return true;
  w->light = memory_aligned(64, sizeof *w->light);
  return w->light != NULL;
}

static lane_c *plane_of(light_passes *p, bounce_kind kind, light_part part) {
  return &p->sum[LIGHT_PARTS * (int)kind + (int)part];
}

static lane_c *emission_of(light_passes *p) {
  return &p->sum[PLANE_EMISSION - PLANE_LIGHT];
}

static lane_c *environment_of(light_passes *p) {
  return &p->sum[PLANE_ENVIRONMENT - PLANE_LIGHT];
}

static void zero_run(lane_c *color, lane_run run) {
  size_t bytes = (run.end - run.begin) * sizeof(float);
  memset(color->r + run.begin, 0, bytes);
  memset(color->g + run.begin, 0, bytes);
  memset(color->b + run.begin, 0, bytes);
}

/* ---- kinds of closures */

static uint32_t kind_of(const closure *c) {
  return c->traits & CLOSURE_CLEAR  ? (uint32_t)KIND_BY_SIDE
         : c->traits & CLOSURE_MATT ? (uint32_t)BOUNCE_DIFFUSE
                                    : (uint32_t)BOUNCE_GLOSSY;
}

/* Of a direction with this cosine. */
LEAF uint32_t kind_at(uint32_t kind, float z) {
  uint32_t by_side = z < 0.0f ? (uint32_t)BOUNCE_TRANSMISSION : (uint32_t)BOUNCE_GLOSSY;
  return kind == KIND_BY_SIDE ? by_side : kind;
}

/* That of all closures, or KINDS_SEVERAL. */
static uint32_t kind_of_all(const material *m) {
  uint32_t all = KINDS_SEVERAL;
  for (size_t k = 0; k < m->closures; k++) {
    if (!(m->closure[k].traits & CLOSURE_SCATTERS))
      continue;
    uint32_t kind = kind_of(&m->closure[k]);
    if (all != KINDS_SEVERAL && all != kind)
      return KINDS_SEVERAL;
    all = kind;
  }
  return all == KINDS_SEVERAL ? (uint32_t)BOUNCE_GLOSSY : all; /* of none there is no light */
}

LEAF void add(lane_c *to, size_t i, float r, float g, float b) {
  to->r[i] += r;
  to->g[i] += g;
  to->b[i] += b;
}

/* What the closures of each kind make of light from `wi`, into p->part; but for the closure of the
 * number `without`, where there is one. */
static void split(worker *w, const segment *g, const lane_v *restrict wi,
                  const uint32_t *restrict without) {
  const stage_table *s = w->scene->stages;
  const lane_run run = g->run;
  batch *b = w->batch;
  light_passes *p = w->light;
  for (int kind = 0; kind < LIGHT_KINDS; kind++)
    zero_run(&p->part[kind], run);
  memset(b->part.pdf + run.begin, 0, (run.end - run.begin) * sizeof(float));
  memset(p->one.pdf + run.begin, 0, (run.end - run.begin) * sizeof(float));
  for (uint32_t k = 0; k < g->material->closures; k++) {
    const closure *c = &g->material->closure[k];
    const uint32_t kind = kind_of(c);
    if (!(c->traits & CLOSURE_SCATTERS))
      continue;
    zero_run(&p->one.f, run);
    /* without a complaint: they were asked before, and for draws there may be no direction */
    s->closure[c->type](c, run, &b->surface, &b->input, wi, false, &b->part);
    if (!without)
      closures_exclude(w, c, run, &b->part);
    s->join_all(c, run, &b->input, b->closures.chance[k], &b->part, &p->one);
    for (uint32_t to = 0; to < LIGHT_KINDS; to++) {
      lane_c *restrict part = &p->part[to];
      const lane_c *restrict f = &p->one.f;
#pragma omp simd
      for (size_t i = run.begin; i < run.end; i++) {
        bool left_out = without ? without[i] == k : false;
        bool counts = (kind_at(kind, wi->z[i]) == to) & !left_out;
        add(part, i, counts ? f->r[i] : 0.0f, counts ? f->g[i] : 0.0f, counts ? f->b[i] : 0.0f);
      }
    }
  }
}

LEAF float share_of(float part, float all) {
  return all > 0.0f ? part / all : 0.0f;
}

/* ---- at hits */

/* How many bounces lie behind a ray; what it passed is none. */
static uint32_t bounces_of(const path_states *state, size_t ray) {
  return state->bounces[BOUNCE_DIFFUSE][ray] + state->bounces[BOUNCE_GLOSSY][ray] +
         state->bounces[BOUNCE_TRANSMISSION][ray];
}

void light_passes_shone(worker *w) {
  light_passes *p = w->light;
  lane_run all = {0, w->batch->queue.hits};
  size_t bytes = all.end * sizeof(float);
  memcpy(p->shone.r, w->batch->sum.r, bytes);
  memcpy(p->shone.g, w->batch->sum.g, bytes);
  memcpy(p->shone.b, w->batch->sum.b, bytes);
  for (int kind = 0; kind < LIGHT_KINDS; kind++)
    zero_run(&p->reflected[kind], all);
  p->seen = false;
  for (size_t i = 0; i < all.end && !p->seen; i++)
    p->seen = !bounces_of(w->batch->state, w->batch->queue.lane[i]);
}

void light_passes_reflected(worker *w) {
  batch *b = w->batch;
  light_passes *p = w->light;
  const lane_c *restrict f = &b->reflection.f;
  const lane_v *restrict wi = &b->light.wi;
  if (!p->seen) {
    lane_c *restrict out = &p->reflected[BOUNCE_GLOSSY];
#pragma omp simd
    for (size_t i = 0; i < b->queue.hits; i++)
      add(out, i, f->r[i], f->g[i], f->b[i]);
    return;
  }
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    const uint32_t all = kind_of_all(g->material);
    if (all == KINDS_SEVERAL)
      split(w, g, wi, NULL);
    for (uint32_t kind = 0; kind < LIGHT_KINDS; kind++) {
      lane_c *restrict out = &p->reflected[kind];
      const lane_c *part = p->part;
      if (all != KINDS_SEVERAL) {
#pragma omp simd
        for (size_t i = g->run.begin; i < g->run.end; i++) {
          float one = kind_at(all, wi->z[i]) == kind ? 1.0f : 0.0f;
          add(out, i, one * f->r[i], one * f->g[i], one * f->b[i]);
        }
        continue;
      }
#pragma omp simd
      for (size_t i = g->run.begin; i < g->run.end; i++) {
        float red = part[0].r[i] + part[1].r[i] + part[2].r[i];
        float green = part[0].g[i] + part[1].g[i] + part[2].g[i];
        float blue = part[0].b[i] + part[1].b[i] + part[2].b[i];
        add(out, i, share_of(part[kind].r[i], red) * f->r[i],
            share_of(part[kind].g[i], green) * f->g[i], share_of(part[kind].b[i], blue) * f->b[i]);
      }
    }
  }
}

/* ---- where paths go on */

void light_passes_drawn(worker *w) {
  batch *b = w->batch;
  light_passes *p = w->light;
  const draws *draw = &b->draw;
  if (!p->seen)
    return;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    const uint32_t all = kind_of_all(g->material);
    if (all == KINDS_SEVERAL)
      split(w, g, &draw->wi, b->closures.drawn);
    for (size_t i = g->run.begin; i < g->run.end; i++) {
      size_t ray = b->queue.lane[i], sample = b->state->sample[ray];
      if (bounces_of(b->state, ray) || draw->kind[i] == BOUNCE_TRANSPARENT)
        continue;
      uint32_t own = all;
      if (all == KINDS_SEVERAL) {
        uint32_t drawn = b->closures.drawn[i];
        own =
            drawn < CLOSURES_MOST ? kind_of(&g->material->closure[drawn]) : (uint32_t)BOUNCE_GLOSSY;
      }
      own = kind_at(own, draw->wi.z[i]);
      lane_c *share = p->share;
      share[own].r[sample] = share[own].g[sample] = share[own].b[sample] = 1.0f;
      for (uint32_t kind = 0; kind < LIGHT_KINDS; kind++) {
        if (kind == own)
          continue;
        bool several = all == KINDS_SEVERAL;
        float r = several ? share_of(p->part[kind].r[i], draw->f.r[i]) : 0.0f;
        float green = several ? share_of(p->part[kind].g[i], draw->f.g[i]) : 0.0f;
        float blue = several ? share_of(p->part[kind].b[i], draw->f.b[i]) : 0.0f;
        share[kind].r[sample] = r;
        share[kind].g[sample] = green;
        share[kind].b[sample] = blue;
        add(&share[own], sample, -r, -green, -blue);
      }
    }
  }
}

/* ---- to the samples */

typedef struct color3 {
  float r, g, b;
} color3;

/* As of a path of this weight; infinite light is very bright. */
static color3 weighed(const path_states *state, size_t ray, const lane_c *light, size_t i,
                      float dim) {
  return (color3){dim * clampf(state->throughput.r[ray] * light->r[i], 0.0f, 1e30f),
                  dim * clampf(state->throughput.g[ray] * light->g[i], 0.0f, 1e30f),
                  dim * clampf(state->throughput.b[ray] * light->b[i], 0.0f, 1e30f)};
}

/* The factor by which the stage `gain` dims. */
static float dimming(const path_states *state, size_t ray, const lane_c *light, size_t i,
                     float most) {
  color3 c = weighed(state, ray, light, i, 1.0f);
  float mean = (c.r + c.g + c.b) * (1.0f / 3.0f);
  return mean > most ? most / mean : 1.0f;
}

/* Light of the sample's first drawn ray, by its kinds. */
static void add_shared(light_passes *p, light_part part, size_t sample, color3 c) {
  for (int kind = 0; kind < LIGHT_KINDS; kind++) {
    const lane_c *share = &p->share[kind];
    add(plane_of(p, (bounce_kind)kind, part), sample, c.r * share->r[sample],
        c.g * share->g[sample], c.b * share->b[sample]);
  }
}

static float operand_at(const inputs *in, operand o, size_t i) {
  return clampf(o.at < 0 ? o.number : in->at[o.at][i], 0.0f, 1e30f);
}

/* What glass reflects towards the eye were it smooth, as Cycles has it. */
static float glass_reflects(const batch *b, const closure_glass *c, size_t i) {
  vec3 n = normal_at(&b->input, c->normal, i);
  float cosine = clampf(dot(n, load(&b->surface.wo, i)), 0.0f, 1.0f), t;
  float ior = operand_at(&b->input, c->ior, i);
  float fresnel = dielectric_fresnel(cosine, dielectric_eta(ior, b->surface.side[i]), &t);
  return c->reflects && c->refracts ? fresnel : c->reflects ? 1.0f : 0.0f;
}

/* A hit's colours, by kind. */
static void colors_of(const batch *b, const material *m, size_t i, float out[LIGHT_KINDS][3]) {
  const inputs *in = &b->input;
  memset(out, 0, LIGHT_KINDS * sizeof *out);
  for (const closure *c = m->closure; c < m->closure + m->closures; c++) {
    if (!(c->traits & CLOSURE_SCATTERS))
      continue;
    float mirror = c->traits & CLOSURE_CLEAR ? glass_reflects(b, &c->of.glass, i) : 0.0f;
    for (int k = 0; k < 3; k++) {
      float weight = operand_at(in, c->weight[k], i);
      float color = c->colored ? operand_at(in, c->color[k], i) : plane_closure_color(in, c, k, i);
      if (c->traits & CLOSURE_CLEAR) {
        weight *= c->colored ? color : 1.0f;
        out[BOUNCE_GLOSSY][k] += weight * mirror;
        out[BOUNCE_TRANSMISSION][k] +=
            weight * (1.0f - mirror) * operand_at(in, c->of.glass.tint[k], i);
      } else {
        out[kind_of(c)][k] += weight * color;
      }
    }
  }
}

/* How much of a hit lets nothing pass, of what its path weighs. */
static float opacity_of(const batch *b, const material *m, size_t i) {
  size_t ray = b->queue.lane[i];
  const float weight[3] = {b->state->throughput.r[ray], b->state->throughput.g[ray],
                           b->state->throughput.b[ray]};
  float mean = 0.0f;
  for (int k = 0; k < 3; k++) {
    float passes = 0.0f;
    for (const closure *c = m->closure; c < m->closure + m->closures; c++)
      passes += c->traits & (CLOSURE_PASSES | CLOSURE_HOLDS)
                    ? operand_at(&b->input, c->weight[k], i)
                    : 0.0f;
    mean += weight[k] * clampf(1.0f - passes, 0.0f, 1.0f) * (1.0f / 3.0f);
  }
  return mean;
}

/* What mist leaves of a hit; 1 less that is the mist, where there is nothing as well. */
static float clear_of(const scene *s, const batch *b, size_t i) {
  const camera *eye = &s->camera;
  vec3 p = load(&b->surface.p, i);
  vec3 d = {p.x - eye->origin[0], p.y - eye->origin[1], p.z - eye->origin[2]};
  float away = eye->perspective
                   ? sqrtf(dot(d, d))
                   : fabsf(d.x * eye->axis[2][0] + d.y * eye->axis[2][1] + d.z * eye->axis[2][2]);
  float mist = clampf((away - s->mist.start) * s->mist.rise, 0.0f, 1.0f);
  mist = s->mist.falloff == MIST_QUADRATIC           ? mist * mist
         : s->mist.falloff == MIST_INVERSE_QUADRATIC ? sqrtf(mist)
                                                     : mist;
  return 1.0f - mist;
}

/* A hit's names to the slots of its pixel. */
static void add_mattes(worker *w, const material *m, size_t i, size_t sample, float coverage) {
  const matte_layout *layout = w->mattes;
  const instance *object = instance_at(w->scene, w->batch, i);
  const float name[MATTE_KINDS] = {object->matte[0], m->matte, object->matte[1]};
  size_t pixel = (w->light->first + sample) / w->light->samples;
  for (int kind = 0; kind < MATTE_KINDS; kind++)
    if (layout->wanted >> kind & 1u)
      matte_add(w->matte + layout->all * pixel + layout->at[kind], layout->slots, name[kind],
                coverage);
}

/* What is told of surfaces that the camera sees, itself or through others. */
static void gain_told(worker *w, const material *m, size_t i) {
  batch *b = w->batch;
  light_passes *p = w->light;
  size_t ray = b->queue.lane[i], sample = b->state->sample[ray];
  float color[LIGHT_KINDS][3];
  float opacity = opacity_of(b, m, i);
  p->sum[PLANE_MIST - PLANE_LIGHT].r[sample] += opacity * clear_of(w->scene, b, i);
  if (w->mattes)
    add_mattes(w, m, i, sample, opacity);
  colors_of(b, m, i, color);
  for (int kind = 0; kind < LIGHT_KINDS; kind++)
    add(plane_of(p, (bounce_kind)kind, LIGHT_COLOR), sample,
        b->state->throughput.r[ray] * color[kind][0], b->state->throughput.g[ray] * color[kind][1],
        b->state->throughput.b[ray] * color[kind][2]);
}

/* Their light. */
static void gain_seen(worker *w, size_t i, float shone, float dim) {
  batch *b = w->batch;
  light_passes *p = w->light;
  size_t ray = b->queue.lane[i], sample = b->state->sample[ray];
  color3 c = weighed(b->state, ray, &p->shone, i, shone);
  add(emission_of(p), sample, c.r, c.g, c.b);
  for (int kind = 0; kind < LIGHT_KINDS; kind++) {
    c = weighed(b->state, ray, &p->reflected[kind], i, dim);
    add(plane_of(p, (bounce_kind)kind, LIGHT_DIRECT), sample, c.r, c.g, c.b);
  }
}

void light_passes_gain(worker *w, const float most[2]) {
  batch *b = w->batch;
  light_passes *p = w->light;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++)
    for (size_t i = g->run.begin; i < g->run.end; i++) {
      size_t ray = b->queue.lane[i], sample = b->state->sample[ray];
      uint32_t bounces = bounces_of(b->state, ray);
      if (b->state->ends[ray]) /* it passes on, and shows nothing */
        continue;
      float dim = dimming(b->state, ray, &b->sum, i, most[bounces > 0]);
      float shone = w->apart ? dimming(b->state, ray, &p->shone, i, most[bounces > 1]) : dim;
      if (!bounces || (w->scene->features.transparent_glass && b->state->clear[ray]))
        gain_told(w, g->material, i);
      if (!bounces) {
        gain_seen(w, i, shone, dim);
        continue;
      }
      add_shared(p, bounces == 1 ? LIGHT_DIRECT : LIGHT_INDIRECT, sample,
                 weighed(b->state, ray, &p->shone, i, shone));
      for (int kind = p->seen ? 0 : BOUNCE_GLOSSY;
           kind < (p->seen ? LIGHT_KINDS : BOUNCE_GLOSSY + 1); kind++)
        add_shared(p, LIGHT_INDIRECT, sample, weighed(b->state, ray, &p->reflected[kind], i, dim));
    }
}

void light_passes_hit(worker *w, size_t rays, const float most[2]) {
  batch *b = w->batch;
  light_passes *p = w->light;
  for (size_t ray = 0; ray < rays; ray++) {
    uint32_t bounces = bounces_of(b->state, ray);
    size_t sample = b->state->sample[ray];
    float dim = dimming(b->state, ray, &b->emitted, ray, most[bounces > 1]);
    color3 c = weighed(b->state, ray, &b->emitted, ray, dim);
    bool missed = b->sample_hit.record[ray] == RECORD_MISS;
    if (bounces)
      add_shared(p, bounces == 1 ? LIGHT_DIRECT : LIGHT_INDIRECT, sample, c);
    else
      add(missed ? environment_of(p) : emission_of(p), sample, c.r, c.g, c.b);
  }
}

void light_passes_environment(worker *w, const path_states *state, size_t rays) {
  const scene *s = w->scene;
  batch *b = w->batch;
  lane_c *out = environment_of(w->light);
  const sky *image = scene_seen_sky(s);
  size_t missed =
      s->stages->missed(rays, b->sample_hit.record, &b->sample_ray, b->missed, &b->toward);
  if (image)
    environment_eval(w, image, missed, &b->toward, &b->sky);
  for (size_t k = 0; !image && k < missed; k++) {
    b->sky.r[k] = s->backdrop[0];
    b->sky.g[k] = s->backdrop[1];
    b->sky.b[k] = s->backdrop[2];
  }
  const float most = s->clamp_direct > 0.0f ? s->clamp_direct : INFINITY;
  for (size_t k = 0; k < missed; k++) {
    size_t ray = b->missed[k];
    if (bounces_of(state, ray) && !(s->features.transparent_glass && state->clear[ray]))
      continue;
    color3 c = weighed(state, ray, &b->sky, k, dimming(state, ray, &b->sky, k, most));
    add(out, state->sample[ray], c.r, c.g, c.b);
  }
}

void light_passes_begin(worker *w, const camera_view *view, size_t count) {
  w->light->first = view->first;
  w->light->samples = view->samples;
  for (int k = 0; k < LIGHT_PLANES; k++)
    zero_run(&w->light->sum[k], (lane_run){0, count});
  light_passes_environment(w, w->batch->state, count);
}

void light_passes_film(worker *w, size_t count) {
  const size_t first = w->light->first, samples = w->light->samples;
  const size_t stride = (size_t)w->planes->channels;
  for (int k = 0; k < LIGHT_PLANES; k++) {
    if (!(w->planes->wanted >> (PLANE_LIGHT + k) & 1u))
      continue;
    const lane_c *from = &w->light->sum[k];
    float *to = w->numbers + w->planes->at[PLANE_LIGHT + k];
    for (size_t i = 0, pixel = first / samples; i < count; pixel++) {
      size_t end = (pixel + 1) * samples - first, stop = end < count ? end : count;
      float sum[3] = {0, 0, 0};
      for (; i < stop; i++) {
        sum[0] += from->r[i];
        sum[1] += from->g[i];
        sum[2] += from->b[i];
      }
      for (int c = 0; c < plane_channels((plane_type)(PLANE_LIGHT + k)); c++)
        to[stride * pixel + (size_t)c] += sum[c];
    }
  }
}
