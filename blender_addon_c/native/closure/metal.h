/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libshade's metal, with the words of its own table. What nodes say of it instead, point by point:
 * `f0_from`, `kd_from`, `f82_from`, three operands each, of which those that are no registers leave
 * the parameter as it is; `ax_from` and `ay_from`, one each; `normal`, three registers. */
#ifndef LIBSHADE_CLOSURE_METAL_H
#define LIBSHADE_CLOSURE_METAL_H

#include "batch/lanes.h"
#include "scene/graph.h"
#include "shade/shade.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct closure_metal {
  shade_params params;
  shade_bsdf bsdf;
  operand f0[3], kd[3], f82[3], ax, ay;
  int normal[3];
} closure_metal;

static inline bool closure_metal_choice(reader *r, shade_list list, int *out) {
  const char *key = shade_list_name(list);
  char *value, words[512] = "";
  const char *row_word;
  if (!reader_text(r, key, NULL, &value))
    return false;
  *out = shade_list_find(list, value);
  free(value);
  if (*out >= 0)
    return true;
  for (int row = 0; shade_list_row(list, row, NULL, &row_word, NULL, NULL); row++)
    snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", row ? ", " : "",
             row_word);
  return reader_fail(r, "%s must be one of %s", key, words);
}

/* The choices of the table. What came later than the first dumps may be
 * missing, and means what it does there. */
static inline bool closure_metal_choices(reader *r, shade_params *q) {
  shade_list_info info;
  for (int list = 0; shade_list_about((shade_list)list, &info); list++) {
    int value = info.older;
    if ((info.in_every_dump || reader_has(r, info.word)) &&
        !closure_metal_choice(r, (shade_list)list, &value))
      return false;
    shade_params_set_choice(q, (shade_list)list, value);
  }
  return true;
}

/* The numbers of the table, brought into their ranges: the dump shall say what is shaded. Of
 * exponents and alphas those count that the distribution reads; they set the others. */
static inline bool closure_metal_numbers(reader *r, shade_params *q, unsigned *status) {
  const unsigned mdf = (unsigned)q->mdf;
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++) {
    double v[3] = {0, 0, 0};
    if (!info.in_every_dump && !reader_has(r, info.word))
      continue;
    if (!(info.components == 1 ? reader_number(r, info.word, v)
                               : reader_numbers(r, info.word, info.components, v)))
      return false;
    if (info.list != SHADE_LIST_MDF || info.choices >> mdf & 1)
      *status |= shade_params_set(q, row, v);
  }
  return true;
}

static inline bool closure_metal_from(reader *r, const graph *g, const char *key, int count,
                                      operand *out) {
  for (int k = 0; k < count; k++)
    out[k] = (operand){.at = OPERAND_NUMBER};
  return !reader_has(r, key) || graph_operands(r, g, key, count, out);
}

/* *status: what had to be clamped. */
static inline bool closure_metal_read(reader *r, closure_metal *c, const graph *g,
                                      unsigned *status) {
  shade_params_init(&c->params);
  if (!closure_metal_from(r, g, "f0_from", 3, c->f0) ||
      !closure_metal_from(r, g, "kd_from", 3, c->kd) ||
      !closure_metal_from(r, g, "f82_from", 3, c->f82) ||
      !closure_metal_from(r, g, "ax_from", 1, &c->ax) ||
      !closure_metal_from(r, g, "ay_from", 1, &c->ay) || !graph_normal(r, g, c->normal))
    return false;
  if (!closure_metal_choices(r, &c->params) || !closure_metal_numbers(r, &c->params, status))
    return false;
  *status |= shade_bsdf_setup(&c->bsdf, &c->params);
  return true;
}

static inline double closure_metal_exponent(const closure_metal *c) {
  return fmax(c->params.ex, c->params.ey);
}

static inline bool closure_metal_varies(const operand *o) {
  return o[0].at >= 0 || o[1].at >= 0 || o[2].at >= 0;
}

/* A register from lane i on; NULL, the material's own, of a number. */
static inline const float *metal_lane(const inputs *given, operand o, size_t i) {
  return o.at < 0 ? NULL : given->at[o.at] + i;
}

/* Members that all lanes of the library have in common. */
#define METAL_GIVEN                                                                                \
  .nx = given->at[c->normal[0]] + i, .ny = given->at[c->normal[1]] + i,                            \
  .nz = given->at[c->normal[2]] + i, .wox = at->wo.x + i, .woy = at->wo.y + i,                     \
  .woz = at->wo.z + i, .f0r = metal_lane(given, c->f0[0], i),                                      \
  .f0g = metal_lane(given, c->f0[1], i), .f0b = metal_lane(given, c->f0[2], i),                    \
  .kdr = metal_lane(given, c->kd[0], i), .kdg = metal_lane(given, c->kd[1], i),                    \
  .kdb = metal_lane(given, c->kd[2], i), .f82r = metal_lane(given, c->f82[0], i),                  \
  .f82g = metal_lane(given, c->f82[1], i), .f82b = metal_lane(given, c->f82[2], i),                \
  .ax = metal_lane(given, c->ax, i), .ay = metal_lane(given, c->ay, i)

static inline unsigned closure_metal_eval(const closure_metal *c, lane_run run,
                                          const surfaces *restrict at, const inputs *restrict given,
                                          const light_samples *restrict light, bool density,
                                          reflections *restrict out) {
  size_t i = run.begin;
  shade_lanesf in = {.size = sizeof in,
                     .wix = light->wi.x + i,
                     .wiy = light->wi.y + i,
                     .wiz = light->wi.z + i,
                     METAL_GIVEN};
  shade_resultf result = {.size = sizeof result,
                          .r = out->f.r + i,
                          .g = out->f.g + i,
                          .b = out->f.b + i,
                          .cosine = out->cosine + i};
  unsigned status = shade_bsdf_eval_batchf(&c->bsdf, run.end - run.begin, &in, &result);
  if (density)
    status |= shade_bsdf_pdf_batchf(&c->bsdf, run.end - run.begin, &in, out->pdf + i);
  return status;
}

/* Directions by f cos, roughly. */
static inline unsigned closure_metal_draw(const closure_metal *c, lane_run run,
                                          const surfaces *restrict at, const inputs *restrict given,
                                          draws *restrict out) {
  size_t i = run.begin;
  shade_sample_lanesf in = {.size = sizeof in, .u1 = out->x + i, .u2 = out->y + i, METAL_GIVEN};
  shade_sample_resultf result = {.size = sizeof result,
                                 .wix = out->wi.x + i,
                                 .wiy = out->wi.y + i,
                                 .wiz = out->wi.z + i,
                                 .r = out->f.r + i,
                                 .g = out->f.g + i,
                                 .b = out->f.b + i,
                                 .pdf = out->pdf + i,
                                 .cosine = out->cosine + i};
  return shade_bsdf_sample_batchf(&c->bsdf, run.end - run.begin, &in, &result) &
         ~(unsigned)SHADE_NO_SAMPLE;
}

#undef METAL_GIVEN

#endif
