/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/closures.h"
#include "closure/closure.h"

#include <string.h>

/* One closure as it is needs no list: most materials, and all of a dump. */
static bool is_plain(const material *m) {
  const operand *w = m->closure[0].weight;
  return m->closures == 1 && w[0].at < 0 && w[1].at < 0 && w[2].at < 0 && w[0].number == 1.0f &&
         w[1].number == 1.0f && w[2].number == 1.0f;
}

static void zero_run(float *lane, lane_run run) {
  memset(lane + run.begin, 0, (run.end - run.begin) * sizeof *lane);
}

static bounce_kind kind_of(const closure *c) {
  return c->traits & CLOSURE_PASSES ? BOUNCE_TRANSPARENT
         : c->traits & CLOSURE_MATT ? BOUNCE_DIFFUSE
                                    : BOUNCE_GLOSSY;
}

static bool is_sharp(const closure *c) {
  return c->traits & CLOSURE_SHARP && kind_of(c) == BOUNCE_GLOSSY;
}

/* What scenes without caustics leave out of a closure at surfaces that matt ones see: in `cosine`,
 * that of directions with these heights over the surface. */
static void forbid(const worker *w, const closure *c, lane_run run, const float *z, float *cosine) {
  const scene *s = w->scene;
  bool shines = w->later && kind_of(c) == BOUNCE_GLOSSY;
  const bool above = !s->features.reflective_caustics, below = !s->features.refractive_caustics;
  if (shines && (above || below))
    s->stages->forbid(run, above, below, w->batch->queue.lane, w->batch->state, z, cosine);
}

static void weigh(worker *w, const segment *g) {
  const stage_table *s = w->scene->stages;
  const material *m = g->material;
  batch *b = w->batch;
  choices *choice = &b->closures;
  zero_run(choice->sum, g->run);
  for (size_t k = 0; k < m->closures; k++) {
    const closure *c = &m->closure[k];
    s->albedo[c->type](c, g->run, &b->surface, &b->input, choice->albedo);
    if (!(c->traits & CLOSURE_CLEAR) ||
        (!w->scene->features.reflective_caustics && !w->scene->features.refractive_caustics))
      forbid(w, c, g->run, b->surface.wo.z, choice->albedo);
    s->chance(c, g->run, &b->input, choice->albedo, choice->chance[k], choice->sum);
  }
  for (size_t k = 0; k < m->closures; k++)
    s->share(g->run, choice->sum, choice->chance[k]);
}

bool closures_weigh(worker *w, bool first) {
  batch *b = w->batch;
  bool shone = false;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    const material *m = g->material;
    if (!is_plain(m))
      weigh(w, g);
    if (!first && m->shines && w->scene->emitters.count)
      continue; /* its ray has met this light already, and shared it */
    for (size_t k = 0; k < m->closures; k++)
      if (m->closure[k].traits & CLOSURE_EMITS) {
        w->scene->stages->emit(&m->closure[k], g->run, &b->input, &b->sum);
        shone = true;
      }
  }
  return shone;
}

void closures_hold(worker *w, const camera_view *view) {
  const bool transparent = w->scene->features.transparent_film;
  batch *b = w->batch;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    if (!(g->material->traits & CLOSURE_HOLDS))
      continue;
    for (size_t i = g->run.begin; i < g->run.end; i++)
      b->emitted.r[i] = b->emitted.g[i] = b->emitted.b[i] = 0.0f;
    for (size_t k = 0; k < g->material->closures; k++)
      if (g->material->closure[k].traits & CLOSURE_HOLDS)
        w->scene->stages->emit(&g->material->closure[k], g->run, &b->input, &b->emitted);
    for (size_t i = g->run.begin; i < g->run.end; i++) {
      size_t ray = b->queue.lane[i], sample = b->state->sample[ray];
      const path_states *state = b->state;
      float held =
          (b->emitted.r[i] * state->throughput.r[ray] + b->emitted.g[i] * state->throughput.g[ray] +
           b->emitted.b[i] * state->throughput.b[ray]) *
          (1.0f / 3.0f);
      float *alpha = &b->path.alpha[sample];
      held = held > 0.0f ? held : 0.0f; /* NaN holds nothing */
      if (w->scene->features.transparent_glass ? !state->clear[ray] : state->ray[ray] != RAY_CAMERA)
        continue;
      if (transparent)
        *alpha = *alpha > held ? *alpha - held : 0.0f;
      else if (w->numbers) /* black, before the background */
        w->numbers[(size_t)w->planes->channels * ((view->first + sample) / view->samples) +
                   (size_t)w->planes->at[PLANE_HELD]] += held;
    }
  }
}

void closures_exclude(const worker *w, const closure *c, lane_run run, reflections *out) {
  uint32_t above = 2u << kind_of(c);
  uint32_t below = c->traits & CLOSURE_MATT ? (uint32_t)RAY_DIFFUSE : (uint32_t)RAY_TRANSMISSION;
  if (w->scene->features.light_visibility && !w->observer) /* a dump's lights are seen by all */
    w->scene->stages->exclude(run, above, below, &w->batch->light, out);
}

/* A path may aim draws where it goes on as from one matt surface. */
static bool is_aiming(const worker *w, const material *m) {
  unsigned kinds = CLOSURE_SCATTERS | CLOSURE_MATT | CLOSURE_THROUGH;
  return w->aims && is_plain(m) &&
         (m->closure[0].traits & kinds) == (CLOSURE_SCATTERS | CLOSURE_MATT);
}

void closures_aim(worker *w) {
  batch *b = w->batch;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++)
    if (is_aiming(w, g->material))
      w->scene->stages->aim(g->run, &w->scene->aims, &b->surface, &b->cones);
}

static void draw_aimed(worker *w, const segment *g) {
  const stage_table *s = w->scene->stages;
  const closure *c = &g->material->closure[0];
  batch *b = w->batch;
  s->aim_pick(g->run, w->aims, &b->cones, &b->draw);
  w->status |= s->draw[c->type](c, g->run, &b->surface, &b->input, &b->draw);
  s->aim_turn(g->run, w->aims, &b->cones, &b->draw);
  w->status |= s->closure[c->type](c, g->run, &b->surface, &b->input, &b->draw.wi, true, &b->part);
  s->aim_take(g->run, &b->part, &b->draw);
  s->aim_mix(g->run, w->aims, &b->cones, &b->draw.wi, b->draw.pdf);
  s->kind(g->run, kind_of(c), is_sharp(c), &b->draw);
}

static void eval_list(worker *w, const segment *g, bool density) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  reflections *out = &b->reflection;
  float *sums[] = {out->f.r, out->f.g, out->f.b, out->pdf};
  for (size_t k = 0; k < sizeof sums / sizeof *sums; k++)
    zero_run(sums[k], g->run);
  for (size_t i = g->run.begin; i < g->run.end; i++)
    out->cosine[i] = 1.0f;
  if (!density)
    zero_run(b->part.pdf, g->run);
  for (size_t k = 0; k < g->material->closures; k++) {
    const closure *c = &g->material->closure[k];
    if (!(c->traits & CLOSURE_SCATTERS))
      continue;
    w->status |=
        s->closure[c->type](c, g->run, &b->surface, &b->input, &b->light.wi, density, &b->part);
    closures_exclude(w, c, g->run, &b->part);
    forbid(w, c, g->run, b->light.wi.z, b->part.cosine);
    s->join_all(c, g->run, &b->input, b->closures.chance[k], &b->part, out);
  }
}

void closures_eval(worker *w, bool density) {
  batch *b = w->batch;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    const closure *c = &g->material->closure[0];
    if (is_plain(g->material)) {
      w->status |= w->scene->stages->closure[c->type](c, g->run, &b->surface, &b->input,
                                                      &b->light.wi, density, &b->reflection);
      if (density && is_aiming(w, g->material))
        w->scene->stages->aim_mix(g->run, w->aims, &b->cones, &b->light.wi, b->reflection.pdf);
      closures_exclude(w, c, g->run, &b->reflection);
      forbid(w, c, g->run, b->light.wi.z, b->reflection.cosine);
    } else {
      eval_list(w, g, density);
    }
    clock_tick(&w->clocks, CLOCK_CLOSURE + c->type);
  }
}

static void draw_list(worker *w, const segment *g) {
  const stage_table *s = w->scene->stages;
  const material *m = g->material;
  const lane_run run = g->run;
  batch *b = w->batch;
  draws *out = &b->draw, *part = &b->part_draw;
  size_t bytes = (run.end - run.begin) * sizeof(float);
  zero_run(out->pdf, run);
  for (size_t i = run.begin; i < run.end; i++) {
    b->closures.drawn[i] = CLOSURES_MOST;
    out->wi.x[i] = out->wi.y[i] = out->wi.z[i] = 0.0f;
    out->kind[i] = BOUNCE_GLOSSY;
  }
  for (uint32_t k = 0; k < m->closures; k++)
    s->pick(run, k, b->closures.chance[k], b->closures.drawn, out->choice);
  memcpy(part->x + run.begin, out->x + run.begin, bytes);
  memcpy(part->y + run.begin, out->y + run.begin, bytes);
  memcpy(part->choice + run.begin, out->choice + run.begin, bytes);
  for (uint32_t k = 0; k < m->closures; k++) {
    const closure *c = &m->closure[k];
    if (c->traits & CLOSURE_EMITS)
      continue;
    w->status |= s->draw[c->type](c, run, &b->surface, &b->input, part);
    s->kind(run, kind_of(c), is_sharp(c), part);
    forbid(w, c, run, part->wi.z, part->cosine);
    s->take(c, run, k, &b->input, &b->closures, part, out);
  }
  for (uint32_t k = 0; k < m->closures; k++) {
    const closure *c = &m->closure[k];
    if (m->closures == 1 || !(c->traits & CLOSURE_SCATTERS))
      continue;
    /* where nothing was drawn there is no direction, and nothing to complain of */
    s->closure[c->type](c, run, &b->surface, &b->input, &out->wi, true, &b->part);
    forbid(w, c, run, out->wi.z, b->part.cosine);
    s->join(c, run, k, &b->input, &b->closures, &b->part, out);
  }
}

void closures_draw(worker *w) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    const closure *c = &g->material->closure[0];
    if (is_aiming(w, g->material)) {
      draw_aimed(w, g);
      continue;
    }
    if (is_plain(g->material)) {
      w->status |= s->draw[c->type](c, g->run, &b->surface, &b->input, &b->draw);
      s->kind(g->run, kind_of(c), is_sharp(c), &b->draw);
      forbid(w, c, g->run, b->draw.wi.z, b->draw.cosine);
    } else {
      draw_list(w, g);
    }
    memcpy(b->draw.own + g->run.begin, b->draw.pdf + g->run.begin,
           (g->run.end - g->run.begin) * sizeof(float));
  }
}

/* The closure that has drawn a hit's direction, or NULL. */
static const closure *drawn_by(const batch *b, const material *m, size_t i) {
  uint32_t number = is_plain(m) ? 0 : b->closures.drawn[i];
  return number < m->closures ? &m->closure[number] : NULL;
}

void closures_clear(worker *w) {
  batch *b = w->batch;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++)
    for (size_t i = g->run.begin; i < g->run.end; i++) {
      const closure *c = drawn_by(b, g->material, i);
      if (!c || !(c->traits & CLOSURE_CLEAR) || !(b->draw.wi.z[i] < 0.0f))
        continue;
      operand alpha = c->of.glass.alpha;
      float own = alpha.at < 0 ? alpha.number : b->input.at[alpha.at][i];
      own = b->input.blurs && own < b->input.blur[i] ? b->input.blur[i] : own;
      b->draw.kind[i] |= own <= w->scene->clear_alpha ? BOUNCE_CLEAR : 0;
    }
}
