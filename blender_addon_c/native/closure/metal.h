/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libshade's metal, with the words of its own table. Its reflectance is the colour, if a node gives
 * one. */
#ifndef LIBSHADE_CLOSURE_METAL_H
#define LIBSHADE_CLOSURE_METAL_H

#include "batch/lanes.h"
#include "scene/reader.h"
#include "shade/shade.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a node's colour stands for. */
enum { METAL_COLOR_F0, METAL_COLOR_KD };

typedef struct closure_metal {
  shade_params params;
  shade_bsdf bsdf;
  int color_is;
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

/* *status: what had to be clamped. */
static inline bool closure_metal_read(reader *r, closure_metal *c, unsigned *status) {
  static const char *const colors[] = {"F0", "KD", NULL};
  shade_params_init(&c->params);
  c->color_is = METAL_COLOR_F0;
  if (reader_has(r, "color_is") && !reader_word(r, "color_is", colors, &c->color_is))
    return false;
  if (!closure_metal_choices(r, &c->params) || !closure_metal_numbers(r, &c->params, status))
    return false;
  *status |= shade_bsdf_setup(&c->bsdf, &c->params);
  return true;
}

static inline double closure_metal_exponent(const closure_metal *c) {
  return fmax(c->params.ex, c->params.ey);
}

/* Members that all lanes of the library have in common. */
#define METAL_GIVEN                                                                                \
  .nx = given->normal.x + i, .ny = given->normal.y + i, .nz = given->normal.z + i,                 \
  .wox = at->wo.x + i, .woy = at->wo.y + i, .woz = at->wo.z + i,                                   \
  .f0r = f0 ? given->color.r + i : NULL, .f0g = f0 ? given->color.g + i : NULL,                    \
  .f0b = f0 ? given->color.b + i : NULL, .kdr = kd ? given->color.r + i : NULL,                    \
  .kdg = kd ? given->color.g + i : NULL, .kdb = kd ? given->color.b + i : NULL

static inline unsigned closure_metal_eval(const closure_metal *c, lane_run run,
                                          const surfaces *restrict at, const inputs *restrict given,
                                          const light_samples *restrict light, bool density,
                                          reflections *restrict out) {
  size_t i = run.begin;
  bool colored = run.outputs & OUTPUT_COLOR, kd = colored && c->color_is == METAL_COLOR_KD;
  bool f0 = colored && !kd;
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
  bool colored = run.outputs & OUTPUT_COLOR, kd = colored && c->color_is == METAL_COLOR_KD;
  bool f0 = colored && !kd;
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
