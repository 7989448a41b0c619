/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/dump_scene.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "closure/closure.h"
#include "light/light.h"
#include "system/library.h"
#include "system/threads.h"

#define OPENEXR_SYSTEM "libOpenEXRCore-3_1.so.30"

static pthread_once_t exr_once = PTHREAD_ONCE_INIT;
static const struct shade_exr_api *exr;
static char exr_error[MESSAGE_SIZE];

static void exr_load(void) {
  void *library = library_open("openexrcore", OPENEXR_SYSTEM, exr_error, sizeof exr_error);
  if (library)
    exr = shade_exr_api_load(library_symbol, library, exr_error, sizeof exr_error);
}

bool dump_scene_write(const shade_dump *d, const char *path, message_log *log) {
  char error[MESSAGE_SIZE];
  pthread_once(&exr_once, exr_load);
  if (!exr)
    return message_error(log, "the dump cannot be written: %s", exr_error);
  if (shade_dump_write(exr, path, d, error, sizeof error) < 0)
    return message_error(log, "the dump cannot be written: %s", error);
  return true;
}

static bool is_whole(const closure *c) {
  bool whole = true;
  for (int k = 0; k < 3; k++)
    whole = whole && c->weight[k].at < 0 && c->weight[k].number == 1.0f;
  return whole;
}

/* One metal and nothing else, under no film: what a dump has words for, */
static bool is_metal(const material *m) {
  return m->closures == 1 && m->closure[0].type == CLOSURE_METAL && is_whole(&m->closure[0]) &&
         !m->closure[0].of.metal.film.there;
}

/* or one cloth of colours that are the same everywhere, through whose gaps what is behind is seen.
 */
static bool is_cloth(const material *m) {
  const closure_fabric *c = &m->closure[0].of.fabric;
  if (m->closure[0].type != CLOSURE_FABRIC || !is_whole(&m->closure[0]))
    return false;
  for (int k = 0; k < 3; k++)
    if (c->use.warp[k].at >= 0 || c->use.weft[k].at >= 0 || c->use.glossed || c->use.napped)
      return false;
  for (size_t k = 1; k < m->closures; k++)
    if (!(m->closure[k].traits & CLOSURE_PASSES))
      return false;
  return true;
}

/* NULL when out of memory; the caller frees. */
static char *cloth_json(const material *m, size_t id) {
  const cloth *c = m->closure[0].of.fabric.use.cloth;
  const shade_preset *p = &c->preset;
  const char *weave = c->draft ? NULL : p->weave;
  int length = shade_fabric_json((int)id, m->name, c->draft, weave, &p->yarns, &p->fabric, NULL, 0);
  char *text = length < 0 ? NULL : malloc((size_t)length + 1);
  if (text)
    shade_fabric_json((int)id, m->name, c->draft, weave, &p->yarns, &p->fabric, text,
                      (size_t)length + 1);
  return text;
}

/* What the dump's header says of the scene; the caller frees. */
static char *header(const scene *s) {
  shade_dump_material *materials = calloc(s->materials + 1, sizeof *materials);
  char **cloths = calloc(s->materials + 1, sizeof *cloths), *text = NULL;
  shade_params other;
  shade_params_init(&other);
  bool good = materials && cloths;
  for (size_t m = 0; good && m < s->materials; m++) {
    const material *from = &s->material[m];
    materials[m] = (shade_dump_material){
        from->name, is_metal(from) ? &from->closure[0].of.metal.params : &other, NULL};
    if (is_cloth(from))
      good = (materials[m].json = cloths[m] = cloth_json(from, m)) != NULL;
  }
  if (good)
    text = shade_dump_header(s->renderer, materials, s->materials);
  for (size_t m = 0; cloths && m < s->materials; m++)
    free(cloths[m]);
  free(cloths);
  free(materials);
  return text;
}

/* What a dump has a plane for and nodes may give, by hit: as operands and as a parameter. */
typedef struct varied {
  enum shade_dump_optional plane;
  size_t operand, parameter; /* their places in closure_metal and shade_params */
  int count;
  double low, high;
} varied;
static const varied varied_all[] = {
    {SHADE_DUMP_KD, offsetof(closure_metal, kd), offsetof(shade_params, kd), 3, 0, 1},
    {SHADE_DUMP_F82, offsetof(closure_metal, f82), offsetof(shade_params, f82), 3, 0, 1},
    {SHADE_DUMP_ALPHA, offsetof(closure_metal, ax), offsetof(shade_params, ax), 2, 1e-4, 10}};
enum { VARIED = sizeof varied_all / sizeof *varied_all };
_Static_assert(offsetof(closure_metal, ay) == offsetof(closure_metal, ax) + sizeof(operand) &&
                   offsetof(shade_params, ay) == offsetof(shade_params, ax) + sizeof(double),
               "ax and ay are one row of varied_all");

static const operand *operand_of(const closure_metal *c, const varied *v, int k) {
  return (const operand *)((const char *)c + v->operand) + k;
}

/* Of hit i: what a node says, within the range that the library brings it into, or the material. */
static float number_of(const inputs *in, operand o, double own, double low, double high, size_t i) {
  float x = o.at < 0 ? (float)own : in->at[o.at][i];
  return x != x ? (float)own : x < (float)low ? (float)low : x > (float)high ? (float)high : x;
}

static bool varies(const scene *s, const varied *v) {
  for (size_t m = 0; m < s->materials; m++)
    for (int k = 0; k < v->count; k++)
      if (is_metal(&s->material[m]) &&
          operand_of(&s->material[m].closure[0].of.metal, v, k)->at >= 0)
        return true;
  return false;
}

static bool is_uneven(const scene *s) {
  for (size_t m = 0; m < s->materials; m++)
    if (is_metal(&s->material[m]) && s->material[m].closure[0].of.metal.moment[0].at >= 0)
      return true;
  return false;
}

static bool is_turned(const scene *s) {
  for (size_t m = 0; m < s->materials; m++)
    if (is_metal(&s->material[m]) && s->material[m].closure[0].of.metal.grooved)
      return true;
  return false;
}

shade_dump *dump_scene_create(const scene *s, message_log *log) {
  for (size_t m = 0; m < s->materials; m++)
    if (!is_metal(&s->material[m]) && !is_cloth(&s->material[m]))
      message_warn(
          log,
          "material %s: more than one metal or cloth, or a thin film, so the dump leaves it out",
          s->material[m].name);

  char *json = header(s);
  shade_dump *d = json ? shade_dump_create(s->width, s->height, (int)s->lights) : NULL;
  if (d && shade_dump_set_json(d, json) < 0) {
    shade_dump_free(d);
    d = NULL;
  }
  free(json);
  for (int v = 0; d && v < VARIED; v++)
    if (varies(s, &varied_all[v]) && !shade_dump_add(d, varied_all[v].plane)) {
      shade_dump_free(d);
      d = NULL;
    }
  if (d && ((is_turned(s) && !shade_dump_add(d, SHADE_DUMP_GROOVE)) ||
            (is_uneven(s) && !shade_dump_add(d, SHADE_DUMP_SLOPES)))) {
    shade_dump_free(d);
    d = NULL;
  }
  for (size_t m = 0; d && m < s->materials; m++)
    if (is_cloth(&s->material[m]) &&
        !(shade_dump_add(d, SHADE_DUMP_FOOT) && shade_dump_add(d, SHADE_DUMP_COVERAGE) &&
          shade_dump_add(d, SHADE_DUMP_TIER))) {
      shade_dump_free(d);
      d = NULL;
    }
  return d;
}

/* Where hit i belongs: with one sample a pixel its lane is its pixel. Rows from the top. */
static size_t place(const shade_dump *d, const batch *b, const camera_view *view, size_t i) {
  int x, y;
  pixel_place(view, view->first + b->queue.lane[i], &x, &y);
  return (size_t)(d->height - 1 - y) * (size_t)d->width + (size_t)x;
}

static void put(float *const plane[3], size_t at, float x, float y, float z) {
  plane[0][at] = x;
  plane[1][at] = y;
  plane[2][at] = z;
}

static void put_lane(float *const plane[3], size_t at, const lane_v *v, size_t i) {
  put(plane, at, v->x[i], v->y[i], v->z[i]);
}

static void put_varied(shade_dump *d, size_t at, const closure_metal *c, const inputs *in,
                       size_t i) {
  for (const varied *v = varied_all; v < varied_all + VARIED; v++)
    if (shade_dump_has(d, v->plane))
      for (int k = 0; k < v->count; k++) {
        const double *own = (const double *)((const char *)&c->params + v->parameter) + k;
        shade_dump_plane(d, (int)v->plane + k)[at] =
            number_of(in, *operand_of(c, v, k), *own, v->low, v->high, i);
      }
}

/* Of hit i: where the grooves run, from the tangent; 0 where the library takes the tangent itself.
 */
static float angle_of(const closure_metal *c, const inputs *in, size_t i) {
  float x[2];
  for (int k = 0; k < 2; k++)
    x[k] = c->groove[k].at < 0 ? c->groove[k].number : in->at[c->groove[k].at][i];
  float size = fmaxf(fabsf(x[0]), fabsf(x[1]));
  bool good = c->grooved && isfinite(x[0]) && isfinite(x[1]) && size >= FLT_MIN;
  return good ? atan2f(x[1], x[0]) : 0.0f;
}

static void put_slopes(shade_dump *d, size_t at, const closure_metal *c, const inputs *in,
                       size_t i) {
  double own[5];
  shade_params_get_slopes(&c->params, own);
  for (int k = 0; k < 5; k++) {
    const int of = k < 2 ? c->mean[k].at : c->moment[k - 2].at;
    shade_dump_plane(d, SHADE_DUMP_SLOPES + k)[at] = of < 0 ? (float)own[k] : in->at[of][i];
  }
}

static void put_metal(shade_dump *d, size_t at, const closure *of, const inputs *in, size_t i) {
  const closure_metal *c = &of->of.metal;
  for (int k = 0; k < 3; k++)
    shade_dump_plane(d, SHADE_DUMP_COLOR + k)[at] =
        number_of(in, c->f0[k], c->params.f0[k], 0, 1, i);
  put_varied(d, at, c, in, i);
  if (shade_dump_has(d, SHADE_DUMP_GROOVE))
    shade_dump_plane(d, SHADE_DUMP_GROOVE)[at] = angle_of(c, in, i);
  if (shade_dump_has(d, SHADE_DUMP_SLOPES))
    put_slopes(d, at, c, in, i);
}

/* Its place is that in the weave, and its tangent the cloth's x axis. */
static void put_cloth(shade_dump *d, size_t at, const closure *of, const surfaces *s,
                      const inputs *in, size_t i) {
  const closure_fabric *c = &of->of.fabric;
  static const int planes[] = {SHADE_DUMP_UV, SHADE_DUMP_UV + 1, SHADE_DUMP_FOOT,
                               SHADE_DUMP_FOOT + 1};
  for (int k = 0; k < 4; k++)
    shade_dump_plane(d, planes[k])[at] = in->at[c->use.place[k].at][i];
  shade_dump_plane(d, SHADE_DUMP_COVERAGE)[at] =
      c->coverage.at < 0 ? c->coverage.number : in->at[c->coverage.at][i];
  shade_dump_plane(d, SHADE_DUMP_TIER)[at] = (float)c->use.cloth->tier;
  if (!c->use.framed)
    return;
  /* its x axis stands for the tangent */
  float *t[3], x = in->at[c->use.frame[0]][i], y = in->at[c->use.frame[1]][i];
  for (int k = 0; k < 3; k++)
    t[k] = shade_dump_plane(d, SHADE_DUMP_T + k);
  put(t, at, x * s->t.x[i] + y * s->b.x[i], x * s->t.y[i] + y * s->b.y[i],
      x * s->t.z[i] + y * s->b.z[i]);
}

static void put_hits(void *context, const batch *b, const camera_view *view) {
  shade_dump *d = context;
  const surfaces *s = &b->surface;
  const lane_v *away = &b->ray->d;
  const inputs *in = &b->input;
  float *plane[SHADE_DUMP_BASE];
  for (int k = 0; k < SHADE_DUMP_BASE; k++)
    plane[k] = shade_dump_plane(d, k);
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    const material *m = g->material;
    const closure *c = &m->closure[0];
    const bool cloth = is_cloth(m);
    if (!is_metal(m) && !cloth) /* left out, as if nothing were there */
      continue;
    const int *normal = cloth ? c->of.fabric.use.normal : c->of.metal.normal;
    for (size_t i = g->run.begin; i < g->run.end; i++) {
      size_t at = place(d, b, view, i);
      float x = in->at[normal[0]][i], y = in->at[normal[1]][i], z = in->at[normal[2]][i];
      put_lane(plane + SHADE_DUMP_P, at, &s->p, i);
      put_lane(plane + SHADE_DUMP_N, at, &s->n, i);
      put_lane(plane + SHADE_DUMP_T, at, &s->t, i);
      put(plane + SHADE_DUMP_NS, at, x * s->t.x[i] + y * s->b.x[i] + z * s->n.x[i],
          x * s->t.y[i] + y * s->b.y[i] + z * s->n.y[i],
          x * s->t.z[i] + y * s->b.z[i] + z * s->n.z[i]);
      put(plane + SHADE_DUMP_V, at, -away->x[i], -away->y[i], -away->z[i]);
      plane[SHADE_DUMP_UV][at] = s->u[i];
      plane[SHADE_DUMP_UV + 1][at] = s->v[i];
      plane[SHADE_DUMP_MATERIAL][at] = (float)m->number;
      if (cloth)
        put_cloth(d, at, c, s, in, i);
      else
        put_metal(d, at, c, in, i);
    }
  }
}

static void put_light(void *context, const batch *b, const camera_view *view, size_t number,
                      const light *light) {
  shade_dump *d = context;
  const float *e = b->light.e;
  const lane_c *shaded = &b->reflection.f;
  float *plane[SHADE_DUMP_PER_LIGHT];
  for (int k = 0; k < SHADE_DUMP_PER_LIGHT; k++)
    plane[k] = shade_dump_light_plane(d, (int)number, k);
  for (size_t i = 0; i < b->queue.hits; i++) {
    size_t at = place(d, b, view, i);
    if (shade_dump_plane(d, SHADE_DUMP_MATERIAL)[at] < 0.0f) /* left out */
      continue;
    put_lane(plane + SHADE_DUMP_L, at, &b->light.ray.d, i);
    if (light->common.pattern)
      put(plane + SHADE_DUMP_E, at, e[i] * b->light.color.r[i], e[i] * b->light.color.g[i],
          e[i] * b->light.color.b[i]);
    else
      put(plane + SHADE_DUMP_E, at, e[i] * light->common.color[0], e[i] * light->common.color[1],
          e[i] * light->common.color[2]);
    put(plane + SHADE_DUMP_S, at, shaded->r[i], shaded->g[i], shaded->b[i]);
  }
}

observer dump_scene_observer(shade_dump *d) {
  return (observer){.context = d, .hits = put_hits, .light = put_light};
}
