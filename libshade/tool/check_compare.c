/* SPDX-License-Identifier: Apache-2.0 */
/* shade check: the values of a dump beside those of the reference. */
#include "tool/check.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reference/reference.h"

/* Values below this part of the largest say nothing about relative error. */
#define SIGNIFICANT 1e-4
/* float32 directions are off by up to 6e-8 a component: rounding alone decides the
 * side of the horizon within this cosine. */
#define HORIZON 1e-6
/* Choices that fade light out towards wi.z = 0 make S proportional to wi.z there, which that
 * rounding changes by more than 5e-5 of itself below this cosine. */
#define FADED 2e-3
/* Half of float32's step at 1. A direction's components, none above 1, are off by half of that at
 * most, the direction by sqrt(3) as much: it is turned by less than this, in radians. */
#define ROUNDING 0x1p-24
/* Points of the footprint for what is over the limit of cloth from afar. */
#define FAR_AGAIN 4096
/* And for those that make the sum of few hits doubtful. */
#define FAR_SURE 16384

static int on_horizon_of(const shade_params *p, const double of[3], const double wi[3],
                         const double wo[3]) {
  double n[3]; /* of the lobe */
  shade_ref_normal(p, of, wo, n);
  return fabs(wi[2]) < HORIZON || fabs(wo[2]) < HORIZON || fabs(of[2]) < HORIZON ||
         fabs(check_dot(n, wi)) < HORIZON || fabs(check_dot(n, wo)) < HORIZON;
}

static int on_horizon(const check_hit *h, const double wi[3]) {
  int on = on_horizon_of(&h->params, h->n, wi, h->wo);
  for (int k = 0; k < h->lobes; k++) {
    double i[3], o[3];
    shade_ref_turned(h->lobe[k].angle, wi, i);
    shade_ref_turned(h->lobe[k].angle, h->wo, o);
    on |= on_horizon_of(&h->params, h->lobe[k].n, i, o);
  }
  return on;
}

static int faded(const check_hit *h, const double wi[3]) {
  return h->params.horizon >= SHADE_HORIZON_ESTEVEZ && wi[2] > 0 && wi[2] < FADED;
}

/* What a hit sends on of the light from wi: f cos. */
static void shaded(const check_hit *h, int far_points, const double uv[2], const double n[3],
                   const double wi[3], const double wo[3], double s[3], double doubt[3]) {
  double cosine;
  doubt[0] = doubt[1] = doubt[2] = 0;
  if (h->cloth) {
    check_cloth_s(h, far_points, uv, n, wi, wo, s, doubt);
    return;
  }
  double rest = 1;
  for (int k = 0; k < h->lobes; k++)
    rest -= h->lobe[k].share;
  shade_ref_f(&h->params, n, wi, wo, s, &cosine);
  for (int i = 0; i < 3; i++)
    s[i] *= fmax(rest, 0) * cosine;
  for (int k = 0; k < h->lobes; k++) {
    const check_lobe *l = &h->lobe[k];
    shade_params p = h->params;
    double f[3], in[3], out[3];
    check_set_alphas(&p, l->alpha);
    shade_ref_turned_slopes(l->angle, p.slopes, p.slopes);
    shade_ref_turned(l->angle, wi, in);
    shade_ref_turned(l->angle, wo, out);
    shade_ref_f(&p, l->n, in, out, f, &cosine);
    for (int i = 0; i < 3; i++)
      s[i] += l->share * f[i] * cosine;
  }
}

/*
 * Reference values of one pixel under one light; NaN marks values not to compare:
 * a fault, or the horizon, where rounding may have taken S, or the reference, to 0 or, where
 * light fades out, to too few digits.
 */
static void refer(check *c, int light, size_t pixel, int far_points, double reference[3]) {
  double s[3], e[3], l[3], wi[3], f[3], *doubt = c->doubt + 3 * pixel;
  check_hit h;
  reference[0] = reference[1] = reference[2] = NAN;
  doubt[0] = doubt[1] = doubt[2] = 0;
  check_read_three(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_S), pixel, s);
  check_read_three(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_E), pixel, e);
  if (!check_finite_three(s)) {
    check_note_fault(c, FAULT_S, pixel);
    return;
  }
  if (!check_finite_three(e) || e[0] < 0 || e[1] < 0 || e[2] < 0) {
    check_note_fault(c, FAULT_E, pixel);
    return;
  }
  if (e[0] == 0 && e[1] == 0 && e[2] == 0) { /* in shadow L may be anything */
    reference[0] = reference[1] = reference[2] = 0;
    return;
  }
  if (!check_read_unit(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_L), pixel, l)) {
    check_note_fault(c, FAULT_UNIT_L, pixel);
    return;
  }
  check_read_hit(c, pixel, &h);
  check_to_local(&h.frame, l, wi);
  shaded(&h, far_points, h.uv, h.n, wi, h.wo, f, doubt);
  const int horizon = on_horizon(&h, wi);
  for (int i = 0; i < 3; i++) {
    const double value = f[i] * e[i];
    doubt[i] *= e[i];
    if (!isfinite(value))
      check_note_fault(c, FAULT_REFERENCE, pixel);
    else if (faded(&h, wi) || (horizon && (s[i] == 0) != (value == 0)))
      c->horizon++;
    else
      reference[i] = value;
  }
}

/* v turned about an axis by a small angle. */
static void turned(const double axis[3], double angle, double v[3]) {
  const double along = check_dot(axis, v), u[3] = {v[0], v[1], v[2]};
  const double across[3] = {axis[1] * u[2] - axis[2] * u[1], axis[2] * u[0] - axis[0] * u[2],
                            axis[0] * u[1] - axis[1] * u[0]};
  for (int i = 0; i < 3; i++)
    v[i] = u[i] * cos(angle) + across[i] * sin(angle) + axis[i] * along * (1 - cos(angle));
}

/*
 * How far the rounding of directions may move a value, as a relative error: normal, light and
 * eye are turned one by one about each axis of the frame, then all together, as a turned frame
 * does, and the changes are added up.
 */
static double rounding_at(check *c, int light, size_t pixel, int channel) {
  enum { TURNS = 4 * 3, SHIFTS = 4 };
  double e[3], l[3], f[3], doubt[3], wi[3], base = 0, sum = 0;
  check_hit h;
  if (!check_read_unit(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_L), pixel, l))
    return 0;
  check_read_three(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_E), pixel, e);
  check_read_hit(c, pixel, &h);
  check_to_local(&h.frame, l, wi);
  const check_hit as_read = h;
  for (int k = -1; k < TURNS + (h.cloth ? SHIFTS : 0); k++) {
    double v[3][3], uv[2] = {h.uv[0], h.uv[1]};
    memcpy(v[0], h.n, sizeof v[0]);
    memcpy(v[1], wi, sizeof v[1]);
    memcpy(v[2], h.wo, sizeof v[2]);
    for (int which = 0; which < 3 && k >= 0; which++)
      if (k < TURNS && (k / 3 == which || k / 3 == 3)) {
        const double axis[3] = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
        turned(axis, ROUNDING, v[which]);
        for (int lobe = 0; lobe < h.lobes && which == 0; lobe++)
          turned(axis, ROUNDING, h.lobe[lobe].n);
      }
    if (k >= TURNS) /* where a yarn or a ridge ends is as sharp as uv */
      uv[k % 2] += (k % 4 < 2 ? 1 : -1) * ROUNDING * fmax(1, fabs(uv[k % 2]));
    shaded(&h, c->far_points, uv, v[0], v[1], v[2], f, doubt);
    const double value = f[channel] * e[channel];
    h = as_read;
    if (k < 0)
      base = value;
    else
      sum += fabs(value - base);
  }
  return base > 0 && isfinite(sum) ? sum / base : 0;
}

check_cell *check_cell_at(const check *c, int material_index, int light) {
  return &c->cells[material_index * c->dump->lights + light];
}

/* The error of what is no value of one point, and what it is relative to; 0: none. */
static double apart_error(const check_cell *in, double s, double reference, double *larger) {
  *larger = fmax(fmax(fabs(s), fabs(reference)), 0.1 * in->maximum);
  return isnan(reference) || !(*larger > 0) ? 0 : fabs(s - reference) / *larger;
}

/* What the mean that is a value's reference may be off by: 4 standard errors. */
static double doubt_of(const check *c, size_t at) {
  return 4 * c->doubt[at];
}

/* What is no value of one point: beside a limit of its own. */
static void compare_apart(check *c, check_tier tier, check_cell *in, double s, double reference,
                          size_t pixel, int channel) {
  check_apart *a = &in->apart[tier];
  double larger;
  const double error = apart_error(in, s, reference, &larger);
  if (isnan(reference) || !(larger > 0))
    return;
  const double doubt = doubt_of(c, 3 * pixel + (size_t)channel) / larger;
  a->s += s;
  a->reference += reference;
  a->over += error - doubt > check_limit(tier);
  a->beyond = fmax(a->beyond, error - doubt);
  if (a->checked++ && error <= a->largest)
    return;
  a->largest = error;
  a->worst_pixel = pixel;
}

static check_tier tier_at(check *c, size_t pixel) {
  check_hit h;
  return c->materials[c->index[pixel]].cloth && check_read_hit(c, pixel, &h) ? check_tier_of(&h)
                                                                             : CHECK_NEAR;
}

/*
 * Whether a value is compared, and the error of it. Below FLT_MIN float32 steps by 2^-149, or by
 * FLT_MIN where it is flushed, as in our engine: 0 is as good an answer there as any.
 */
static int has_error(const check_cell *in, double s, double reference, double *error) {
  const double larger = fmax(fabs(s), fabs(reference));
  if (isnan(reference) || larger < FLT_MIN || !(larger > SIGNIFICANT * in->maximum))
    return 0;
  *error = fabs(s - reference) / larger;
  return 1;
}

static void compare_value(check *c, int light, double s, double reference, size_t pixel,
                          int channel) {
  check_cell *in = check_cell_at(c, c->index[pixel], light);
  double error;
  if (!has_error(in, s, reference, &error))
    return;
  in->checked++;
  in->sum += error;
  const double rounding = error > in->asked ? c->rounding[3 * pixel + (size_t)channel] : 0;
  in->beyond_sum += fmax(0, error - rounding);
  if (error > c->options->tolerance) {
    if (rounding > 0 && error - rounding <= c->options->tolerance)
      in->excused++;
    in->beyond = fmax(in->beyond, error - rounding);
  }
  if (in->checked > 1 && error <= in->largest)
    return;
  in->worst_rounding = rounding;
  in->largest = error;
  in->worst_pixel = pixel;
  in->worst_channel = channel;
  in->worst_s = s;
  in->worst_reference = reference;
}

/* ---- by several threads ----------------------------------------------------------------- */

enum { PIXELS_A_STEP = 256 };

/* What the threads share, and what each finds wrong. */
typedef struct compare_work {
  check *whole;
  check *of; /* one a thread: the whole's arrays, faults of its own */
  int light;
} compare_work;

/* The reference's values of some pixels. */
static void refer_step(void *context, int thread, size_t step) {
  const compare_work *w = context;
  check *c = &w->of[thread];
  const size_t first = step * PIXELS_A_STEP;
  for (size_t pixel = first; pixel < first + PIXELS_A_STEP && pixel < c->pixels; pixel++)
    if (c->index[pixel] >= 0)
      refer(c, w->light, pixel, c->far_points, c->reference + 3 * pixel);
}

/*
 * Cloth from afar that is off by more than its limit and the doubt of the mean is compared with the
 * mean of more points: of few, in a large dump, the doubt itself is uncertain.
 */
static void far_again(void *context, int thread, size_t step) {
  const compare_work *w = context;
  check *c = &w->of[thread];
  const float *s = shade_dump_light_plane(c->dump, w->light, SHADE_DUMP_S);
  const size_t first = step * PIXELS_A_STEP;
  for (size_t pixel = first; pixel < first + PIXELS_A_STEP && pixel < c->pixels; pixel++) {
    if (c->index[pixel] < 0 || tier_at(c, pixel) != CHECK_FAR)
      continue;
    const check_cell *in = check_cell_at(c, c->index[pixel], w->light);
    double worst = 0, larger;
    for (size_t i = 0; i < 3; i++) {
      const size_t at = 3 * pixel + i;
      const double error =
          apart_error(in, (double)s[i * c->pixels + pixel], c->reference[at], &larger);
      worst = fmax(worst, error - (error > 0 ? doubt_of(c, at) / larger : 0));
    }
    if (worst > check_limit(CHECK_FAR)) {
      const size_t left_out = c->horizon; /* counted the first time */
      refer(c, w->light, pixel, FAR_AGAIN, c->reference + 3 * pixel);
      c->horizon = left_out;
    }
  }
}

/* The doubt of a hit's three values together: the points are the same. */
static double doubt_of_hit(const check *c, size_t pixel) {
  const double *d = c->doubt + 3 * pixel;
  return d[0] + d[1] + d[2];
}

/*
 * Where the sum of cloth from afar is over its limit, that may be the doubt of the reference: of
 * few hits in a large dump, whose lobes are narrow, it was 1.5 % of 422 hits' sum. Then those hits
 * are asked again which, had all their doubt, would make that of the sum more than an eighth of
 * the limit.
 */
static void find_doubted(check *c, int light) {
  const float *s = shade_dump_light_plane(c->dump, light, SHADE_DUMP_S);
  for (int m = 0; m < c->material_count; m++) {
    double given = 0, sum = 0, hits = 0;
    for (size_t pixel = 0; pixel < c->pixels; pixel++) {
      const double *reference = c->reference + 3 * pixel;
      if (c->index[pixel] != m || isnan(reference[0]) || tier_at(c, pixel) != CHECK_FAR)
        continue;
      for (size_t i = 0; i < 3; i++) {
        given += (double)s[i * c->pixels + pixel];
        sum += reference[i];
      }
      hits++;
    }
    const double most = check_sum_limit(CHECK_FAR) * sum;
    check_cell_at(c, m, light)->doubted =
        fabs(given - sum) > most ? most / (8 * sqrt(hits)) : INFINITY;
  }
}

static void doubted_again(void *context, int thread, size_t step) {
  const compare_work *w = context;
  check *c = &w->of[thread];
  const size_t first = step * PIXELS_A_STEP;
  for (size_t pixel = first; pixel < first + PIXELS_A_STEP && pixel < c->pixels; pixel++) {
    if (c->index[pixel] < 0 || tier_at(c, pixel) != CHECK_FAR ||
        !(doubt_of_hit(c, pixel) > check_cell_at(c, c->index[pixel], w->light)->doubted))
      continue;
    const size_t left_out = c->horizon; /* counted the first time */
    refer(c, w->light, pixel, FAR_SURE, c->reference + 3 * pixel);
    c->horizon = left_out;
  }
}

/* What rounding may do to those that are over the limit; the cells know their maxima. */
static void rounding_step(void *context, int thread, size_t step) {
  const compare_work *w = context;
  check *c = &w->of[thread];
  const float *s = shade_dump_light_plane(c->dump, w->light, SHADE_DUMP_S);
  const size_t first = step * PIXELS_A_STEP;
  for (size_t pixel = first; pixel < first + PIXELS_A_STEP && pixel < c->pixels; pixel++) {
    if (c->index[pixel] < 0 || tier_at(c, pixel) != CHECK_NEAR)
      continue;
    const check_cell *in = check_cell_at(c, c->index[pixel], w->light);
    for (size_t i = 0; i < 3; i++) {
      double error;
      if (has_error(in, (double)s[i * c->pixels + pixel], c->reference[3 * pixel + i], &error) &&
          error > in->asked)
        c->rounding[3 * pixel + i] = rounding_at(c, w->light, pixel, (int)i);
    }
  }
}

/* Let the threads do their steps; what they find wrong is the whole's then, in any order found. */
static void share(compare_work *w, tool_step *step, double begin, double end) {
  check *c = w->whole;
  const int threads = c->options->threads;
  for (int t = 0; t < threads; t++) {
    w->of[t] = *c;
    memset(w->of[t].faults, 0, sizeof c->faults);
    w->of[t].horizon = 0;
  }
  tool_share(threads, (c->pixels + PIXELS_A_STEP - 1) / PIXELS_A_STEP, step, w, &c->progress,
             w->light + begin, w->light + end);
  for (int t = 0; t < threads; t++) {
    const check *mine = &w->of[t];
    c->horizon += mine->horizon;
    for (int i = 0; i < FAULT_COUNT; i++) {
      if (mine->faults[i] && (!c->faults[i] || mine->first_fault[i] < c->first_fault[i]))
        c->first_fault[i] = mine->first_fault[i];
      c->faults[i] += mine->faults[i];
    }
  }
}

static void find_maxima(check *c, int light) {
  const float *s = shade_dump_light_plane(c->dump, light, SHADE_DUMP_S);
  for (size_t pixel = 0; pixel < c->pixels; pixel++) {
    if (c->index[pixel] < 0)
      continue;
    const double *reference = c->reference + 3 * pixel;
    check_cell *in = check_cell_at(c, c->index[pixel], light);
    for (size_t i = 0; i < 3; i++)
      if (!isnan(reference[i]))
        in->maximum =
            fmax(in->maximum, fmax(fabs((double)s[i * c->pixels + pixel]), fabs(reference[i])));
  }
}

/* Rounding is asked about values over their limit, and about all where the mean is over its own. */
static void find_asked(check *c, int light) {
  const float *s = shade_dump_light_plane(c->dump, light, SHADE_DUMP_S);
  for (int m = 0; m < c->material_count; m++)
    check_cell_at(c, m, light)->asked = 0;
  /* what all are over the limit of the mean together */
  for (size_t pixel = 0; pixel < c->pixels; pixel++) {
    if (c->index[pixel] < 0 || tier_at(c, pixel) != CHECK_NEAR)
      continue;
    check_cell *in = check_cell_at(c, c->index[pixel], light);
    double error;
    for (size_t i = 0; i < 3; i++)
      if (has_error(in, (double)s[i * c->pixels + pixel], c->reference[3 * pixel + i], &error))
        in->asked += error - c->options->mean_tolerance;
  }
  for (int m = 0; m < c->material_count; m++) {
    check_cell *in = check_cell_at(c, m, light);
    in->asked = in->asked > 0 ? 0 : c->options->tolerance;
  }
}

int check_compare_light(check *c, int light) {
  check *of = malloc((size_t)c->options->threads * sizeof *of);
  if (!of)
    return -1;
  compare_work w = {.whole = c, .of = of, .light = light};
  share(&w, refer_step, 0, 0.7);
  find_maxima(c, light);
  if (c->far_points < FAR_AGAIN)
    share(&w, far_again, 0.7, 0.8);
  if (c->far_points < FAR_SURE) {
    find_doubted(c, light);
    share(&w, doubted_again, 0.8, 0.9);
  }
  find_asked(c, light);
  share(&w, rounding_step, 0.9, 1);
  free(of);
  const float *s = shade_dump_light_plane(c->dump, light, SHADE_DUMP_S);
  const float *id = shade_dump_plane(c->dump, SHADE_DUMP_MATERIAL);
  for (size_t pixel = 0; pixel < c->pixels; pixel++) {
    const check_tier tier = c->index[pixel] >= 0 ? tier_at(c, pixel) : CHECK_NEAR;
    for (int i = 0; i < 3; i++) {
      const double value = (double)s[(size_t)i * c->pixels + pixel];
      if (tier != CHECK_NEAR)
        compare_apart(c, tier, check_cell_at(c, c->index[pixel], light), value,
                      c->reference[3 * pixel + (size_t)i], pixel, i);
      else if (c->index[pixel] >= 0)
        compare_value(c, light, value, c->reference[3 * pixel + (size_t)i], pixel, i);
      else if (id[pixel] == -1 && value != 0)
        check_note_fault(c, FAULT_MISS, pixel);
    }
  }
  return 0;
}
