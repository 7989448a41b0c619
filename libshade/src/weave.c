/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns, and look-ups in both precisions. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../batch/isa.h"
#include "names.h"
#include "../model/weave_private.h"

#define YARN_ROW(word, unit, low, high, initial, help)                                             \
  {#word,                                                                                          \
   unit,                                                                                           \
   help,                                                                                           \
   1,                                                                                              \
   low,                                                                                            \
   high,                                                                                           \
   initial,                                                                                        \
   SHADE_LIST_COUNT,                                                                               \
   0,                                                                                              \
   0,                                                                                              \
   offsetof(shade_yarn_params, word)},
static const shade_param_info rows[] = {SHADE_TABLE_YARN(YARN_ROW)};
enum { YARN_COUNT = sizeof rows / sizeof rows[0] };

#define OCCLUSION_ROW(NAME, word, value, label, help) {value, #word, label, help},
static const struct {
  int value;
  const char *word, *label, *help;
} occlusions[] = {SHADE_TABLE_OCCLUSION(OCCLUSION_ROW)};

int shade_yarn_param_row(int row, shade_param_info *info) {
  if (row < 0 || row >= YARN_COUNT)
    return 0;
  *info = rows[row];
  return 1;
}

static double *number_of(shade_yarn_params *yarn, int row) {
  return (double *)(void *)((char *)yarn + rows[row].offset);
}

double *shade_yarn_param(shade_yarn_params *yarn, const char *word) {
  for (int row = 0; word && row < YARN_COUNT; row++)
    if (same_word(word, rows[row].word))
      return number_of(yarn, row);
  return NULL;
}

int shade_occlusion_row(int row, int *value, const char **word, const char **label,
                        const char **help) {
  if (row < 0 || row >= SHADE_OCCLUSION_COUNT)
    return 0;
  if (value)
    *value = occlusions[row].value;
  if (word)
    *word = occlusions[row].word;
  if (label)
    *label = occlusions[row].label;
  if (help)
    *help = occlusions[row].help;
  return 1;
}

void shade_weave_params_init(shade_weave_params *p) {
  memset(p, 0, sizeof *p);
  p->size = sizeof *p;
  for (int row = 0; row < YARN_COUNT; row++)
    *number_of(&p->warp, row) = *number_of(&p->weft, row) = rows[row].initial;
  p->occlusion = SHADE_OCCLUSION_TILT;
}

static double clamp(double x, double low, double high, double initial, unsigned *status) {
  double y = isnan(x) ? initial : fmin(fmax(x, low), high);
  if (!(x == y))
    *status |= SHADE_CLAMPED_PARAMETER;
  return y;
}

static unsigned clamp_yarn(shade_yarn_params *yarn) {
  unsigned status = SHADE_OK;
  for (int row = 0; row < YARN_COUNT; row++) {
    double *x = number_of(yarn, row);
    *x = clamp(*x, rows[row].minimum, rows[row].maximum, rows[row].initial, &status);
  }
  return status;
}

unsigned shade_weave_params_set_twist(shade_weave_params *p, shade_top yarns, int hand,
                                      double angle, double strands, int plied) {
  const int warp = yarns == SHADE_TOP_WARP;
  shade_yarn_params *yarn = warp ? &p->warp : &p->weft, *other = warp ? &p->weft : &p->warp;
  if (p->size < sizeof p->size)
    return SHADE_BAD_INPUT;
  unsigned status = clamp_yarn(yarn) | clamp_yarn(other);
  int sign = hand == 'S' || hand == 's' ? 1 : hand == 'Z' || hand == 'z' ? -1 : 0;
  if (!sign) {
    yarn->segments = yarn->slant = yarn->fibre = 0;
    return hand ? status | SHADE_BAD_CHOICE : status;
  }
  angle = clamp(angle, .01, 1.5707963267948966, .5, &status);
  yarn->segments = clamp(strands, 0, 1000, 1, &status);
  yarn->fibre = plied ? 0 : sign * angle;
  /* Slant > 0 leans towards +sigma. Warp is weft with u and v exchanged, a reflection: what is
   * S on the weft is Z on the warp. */
  const double crossing = other->width + other->gap;
  yarn->slant = clamp((warp ? -sign : sign) * yarn->width / (2 * crossing * tan(angle)), -100, 100,
                      0, &status);
  return status;
}

/* Mean of what the threads state, 0 if none does; *stated: how many do. */
static double mean_length(const shade_thread *threads, int count, int spacing, int *stated) {
  double sum = 0;
  *stated = 0;
  for (int i = 0; i < count; i++) {
    const double x = spacing ? threads[i].spacing : threads[i].thickness;
    if (x > 0 && x <= 1e9) {
      sum += x;
      ++*stated;
    }
  }
  return *stated ? sum / *stated : 0;
}

int shade_weave_params_from_draft(shade_weave_params *p, const shade_draft *draft) {
  if (p->size < sizeof p->size)
    return 0;
  double thickness[2], spacing[2];
  int stated;
  for (int k = 0; k < 2; k++) {
    const shade_thread *threads = k ? draft->warp : draft->weft;
    const int count = k ? draft->ends : draft->picks;
    thickness[k] = mean_length(threads, count, 0, &stated);
    spacing[k] = mean_length(threads, count, 1, &stated);
  }
  const double thicker = fmax(thickness[0], thickness[1]);
  if (!(spacing[0] > 0 || spacing[1] > 0)) /* square crossings */
    spacing[0] = spacing[1] = thicker;
  const int whole[2] = {thickness[0] > 0 && spacing[0] > 0, thickness[1] > 0 && spacing[1] > 0};
  if (!whole[0] && !whole[1])
    return 0;
  for (int k = 0; k < 2; k++) {
    const int from = whole[k] ? k : !k;
    shade_yarn_params *yarn = k ? &p->warp : &p->weft;
    yarn->width = fmin(thickness[from], spacing[from]);
    yarn->gap = spacing[from] - yarn->width;
  }
  return 1;
}

shade_sett shade_draft_sett(const shade_draft *draft, double per_cm[2]) {
  int stated;
  const double apart[2] = {mean_length(draft->warp, draft->ends, 1, &stated),
                           mean_length(draft->weft, draft->picks, 1, &stated)};
  const double thicker = fmax(mean_length(draft->warp, draft->ends, 0, &stated),
                              mean_length(draft->weft, draft->picks, 0, &stated));
  if (apart[0] > 0 || apart[1] > 0) {
    for (int k = 0; k < 2; k++)
      per_cm[k] = 1 / (apart[k] > 0 ? apart[k] : apart[!k]);
    return SHADE_SETT_SPACING;
  }
  const double before = per_cm[0] * per_cm[1];
  per_cm[0] = per_cm[1] = thicker > 0                       ? 1 / thicker
                          : before > 0 && before < INFINITY ? sqrt(before)
                                                            : 1;
  return thicker > 0 ? SHADE_SETT_THICKNESS : SHADE_SETT_EVEN;
}

/* Shares of the crossings that the yarns of one direction fill, and their linear colours. */
static void make_threads(const shade_thread *threads, size_t count, const shade_yarn_params *y,
                         weave_thread *made) {
  int stated;
  const double mean[2] = {mean_length(threads, (int)count, 0, &stated),
                          mean_length(threads, (int)count, 1, &stated)};
  for (size_t i = 0; i < count; i++) {
    const double number[2] = {threads[i].thickness, threads[i].spacing};
    double ratio[2] = {1, 1};
    for (int k = 0; k < 2; k++)
      if (number[k] > 0 && number[k] <= 1e9)
        ratio[k] = number[k] / mean[k];
    double share = y->width / (y->width + y->gap) * ratio[0] / ratio[1];
    made[i].share = fmin(fmax(share, 1e-6), 1);
    made[i].sharef = (float)made[i].share;
    for (int c = 0; c < 3; c++) {
      double x = threads[i].color[c];
      x = x > 0 ? fmin(x, 1) : 0;
      made[i].rgb[c] = x <= .04045 ? x / 12.92 : pow((x + .055) / 1.055, 2.4);
      made[i].rgbf[c] = (float)made[i].rgb[c];
    }
  }
}

static void make_yarn(const shade_yarn_params *y, weave_yarn *d, weave_yarnf *f) {
  *d = (weave_yarn){
      .curve = y->curve,
      .ridge = y->ridge,
      .slant = y->slant,
      .segments = y->ridge > 0 ? y->segments : 0,
      .crimp = y->crimp,
      .per_crimp_length = 1 / y->crimp_length,
      .along_frequency = 1 / y->along_length,
      .slub = y->slub,
      .vary_brightness = y->vary_brightness,
      .vary_tilt = y->vary_tilt,
      .along_brightness = y->along_brightness,
      .along_tilt = y->along_tilt,
      .fibre_cos = cos(y->fibre),
      .fibre_sin = sin(y->fibre),
  };
  *f = (weave_yarnf){
      .curve = (float)d->curve,
      .ridge = (float)d->ridge,
      .slant = (float)d->slant,
      .segments = (float)d->segments,
      .crimp = (float)d->crimp,
      .per_crimp_length = (float)d->per_crimp_length,
      .along_frequency = (float)d->along_frequency,
      .slub = (float)d->slub,
      .vary_brightness = (float)d->vary_brightness,
      .vary_tilt = (float)d->vary_tilt,
      .along_brightness = (float)d->along_brightness,
      .along_tilt = (float)d->along_tilt,
      .fibre_cos = (float)d->fibre_cos,
      .fibre_sin = (float)d->fibre_sin,
  };
}

/*
 * Along one yarn of `count` cells, `step` apart: how far each cell's state goes on before and
 * after it, from bit `shift` on. Two turns round the repeat; a yarn that never changes sides stays
 * WEAVE_FAR.
 */
static void measure_floats(uint32_t *cells, size_t step, int count, int shift) {
  for (int back = 0; back < 2; back++) {
    uint32_t run = WEAVE_FAR;
    for (int k = 1; k < 2 * count; k++) {
      const int here = (back ? 2 * count - 1 - k : k) % count;
      const int last = (here + (back ? 1 : count - 1)) % count;
      uint32_t *cell = &cells[(size_t)here * step];
      if ((*cell ^ cells[(size_t)last * step]) & 1)
        run = 0;
      else if (run < WEAVE_FAR)
        run++;
      const int at = shift + 7 * back;
      *cell = (*cell & ~((uint32_t)WEAVE_FAR << at)) | run << at;
    }
  }
}

static int is_uniform(const weave_thread *threads, size_t count) {
  for (size_t i = 1; i < count; i++)
    if (threads[i].share < threads->share || threads[i].share > threads->share)
      return 0;
  return 1;
}

static int is_noisy(const weave_yarn *y) {
  return y->slub > 0 || y->vary_brightness > 0 || y->vary_tilt > 0 || y->along_brightness > 0 ||
         y->along_tilt > 0;
}

shade_weave *shade_weave_create(const shade_draft *draft, const shade_weave_params *p,
                                unsigned *status) {
  unsigned bits = SHADE_OK;
  shade_weave *w = draft ? calloc(1, sizeof *w) : NULL;
  if (!w)
    return NULL;
  atomic_init(&w->holders, 1);
  w->isa = shade_isa_chosen();
  shade_weave_params_init(&w->params);
  if (p && p->size < sizeof p->size)
    bits |= SHADE_BAD_INPUT;
  else if (p)
    memcpy(&w->params, p, p->size < sizeof *p ? p->size : sizeof *p);
  w->params.size = sizeof w->params;
  bits |= clamp_yarn(&w->params.warp) | clamp_yarn(&w->params.weft);
  if ((unsigned)w->params.occlusion >= SHADE_OCCLUSION_COUNT) {
    w->params.occlusion = SHADE_OCCLUSION_NONE;
    bits |= SHADE_BAD_CHOICE;
  }

  const size_t ends = (size_t)draft->ends, picks = (size_t)draft->picks;
  w->draft = shade_draft_create(draft->ends, draft->picks);
  w->cells = calloc(ends * picks, sizeof *w->cells);
  weave_thread *threads = calloc(picks + ends, sizeof *threads);
  w->thread[SHADE_TOP_WEFT] = threads;
  if (!w->draft || !w->cells || !threads) {
    shade_weave_free(w);
    return NULL;
  }
  w->thread[SHADE_TOP_WARP] = threads + picks;
  make_threads(draft->weft, picks, &w->params.weft, threads);
  make_threads(draft->warp, ends, &w->params.warp, threads + picks);
  memcpy(w->draft->warp, draft->warp, ends * sizeof *draft->warp);
  memcpy(w->draft->weft, draft->weft, picks * sizeof *draft->weft);
  for (size_t i = 0; i < ends * picks; i++)
    w->cells[i] = w->draft->warp_up[i] = draft->warp_up[i] != 0;
  for (size_t j = 0; j < picks; j++)
    measure_floats(w->cells + j * ends, 1, draft->ends, 1);
  for (size_t i = 0; i < ends; i++)
    measure_floats(w->cells + i, ends, draft->picks, 15);

  make_yarn(&w->params.weft, &w->yarn[SHADE_TOP_WEFT], &w->yarnf[SHADE_TOP_WEFT]);
  make_yarn(&w->params.warp, &w->yarn[SHADE_TOP_WARP], &w->yarnf[SHADE_TOP_WARP]);
  w->uniform[SHADE_TOP_WEFT] = is_uniform(w->thread[SHADE_TOP_WEFT], picks);
  w->uniform[SHADE_TOP_WARP] = is_uniform(w->thread[SHADE_TOP_WARP], ends);
  w->noisy = is_noisy(&w->yarn[0]) || is_noisy(&w->yarn[1]);
  w->fuzz = 1 - (1 - w->params.warp.fuzz) * (1 - w->params.weft.fuzz);
  if (status)
    *status |= bits;
  return w;
}

shade_weave *shade_weave_share(const shade_weave *weave) {
  shade_weave *shared = (shade_weave *)(uintptr_t)weave;
  atomic_fetch_add(&shared->holders, 1);
  return shared;
}

void shade_weave_free(shade_weave *weave) {
  if (!weave || atomic_fetch_sub(&weave->holders, 1) > 1)
    return;
  shade_draft_free(weave->draft);
  free(weave->cells);
  free(weave->thread[0]);
  free(weave);
}

const shade_draft *shade_weave_draft(const shade_weave *weave) {
  return weave->draft;
}

const shade_weave_params *shade_weave_get_params(const shade_weave *weave) {
  return &weave->params;
}

unsigned shade_weave_lookup(const shade_weave *weave, double u, double v, shade_crossing *out) {
  return shade_isa_entries[weave->isa]->weave(weave, u, v, out);
}

unsigned shade_weave_lookupf(const shade_weave *weave, float u, float v, shade_crossingf *out) {
  return shade_isa_entriesf[weave->isa]->weave(weave, u, v, out);
}

unsigned shade_weave_lookup_batch(const shade_weave *weave, size_t count, const double *u,
                                  const double *v, const shade_crossings *out) {
  return shade_isa_entries[weave->isa]->weave_batch(weave, count, u, v, out);
}

unsigned shade_weave_lookup_batchf(const shade_weave *weave, size_t count, const float *u,
                                   const float *v, const shade_crossingsf *out) {
  return shade_isa_entriesf[weave->isa]->weave_batch(weave, count, u, v, out);
}
