/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a thin film on a body reflects: all that goes back and forth in it, summed by Airy, over
 * the colours that the eye takes for red, green and blue.
 *
 * Let a and z be what the film's outer and inner side reflect of an amplitude, and p the phase of a
 * way through it and back. The body reflects
 *   |(a + z e^ip) / (1 + a z e^ip)|^2 = 1 - (1 - a^2)(1 - |z|^2) / |1 + a z e^ip|^2,
 * and 1 / |1 + a z e^ip|^2 is the sum of 1 and of 2 Re (-a z e^ip)^m, m = 1, 2, ..., by
 * 1 - a^2 |z|^2. p is 2 pi D / wavelength. What is left of each term is what the eye's curve has
 * at m D, by Fourier's transform [Belcour2017]. Sixteen terms and a fit of the curves are near
 * enough to a sum over wavelengths.
 *
 * Of a metal of a tint at 82 degrees (`film_tint`) Cycles 5.0 takes phases alone from the index.
 * How much of either swing the film's inner side reflects is Schlick's of its reflectance head-on
 * there, less the dip that the tint makes at 82 degrees within the film. A lattice of Cycles'
 * pictures shows that. The index alone does not give these pictures.
 */
#ifndef LIBSHADE_NODE_INTERFERENCE_H
#define LIBSHADE_NODE_INTERFERENCE_H

#include "node/common.h"

/* The transform at ways of FILM_STEP nm, red's two parts, green's and blue's; beyond it, nothing
 * is left. */
enum { FILM_WAYS = 4096, FILM_TERMS = 16 };
#define FILM_STEP 5.0f

/* In the working space that a dictionary's `film_rgb` is the matrix of; NULL after a failure. Kept
 * until the process ends. */
const float *thin_film_table(reader *r);

/* Of a body: operands. No film where `there` is false. */
typedef struct thin_film {
  bool there, tinted;
  operand thickness, ior, eta[3], k[3]; /* nm; the film's index; the body's index and extinction */
  operand tint[3];
  const float *table;
} thin_film;

static inline bool thin_film_read(reader *r, thin_film *f, graph *g) {
  f->there = true;
  f->table = thin_film_table(r);
  f->tinted = reader_has(r, "film_tint");
  if (!f->table)
    return false;
  if (f->tinted && !graph_operands(r, g, "film_tint", 3, f->tint))
    return false;
  return graph_operands(r, g, "film_thickness", 1, &f->thickness) &&
         graph_operands(r, g, "film_ior", 1, &f->ior) &&
         graph_operands(r, g, "film_eta", 3, f->eta) && graph_operands(r, g, "film_k", 3, f->k);
}

typedef struct thin_film_lanes {
  const float *thickness, *ior, *eta[3], *k[3], *tint[3], *table;
} thin_film_lanes;

/* In eleven places of those for numbers. */
static inline thin_film_lanes thin_film_lanes_of(const thin_film *f, inputs *given, lane_run run) {
  thin_film_lanes lanes = {.thickness = lane_of(given, f->thickness, 0, run),
                           .ior = lane_of(given, f->ior, 1, run),
                           .table = f->table};
  for (int c = 0; c < 3; c++) {
    lanes.eta[c] = lane_of(given, f->eta[c], 2 + c, run);
    lanes.k[c] = lane_of(given, f->k[c], 5 + c, run);
    if (f->tinted)
      lanes.tint[c] = lane_of(given, f->tint[c], 8 + c, run);
  }
  return lanes;
}

typedef struct thin_film_wave {
  float re, im;
} thin_film_wave;

LEAF thin_film_wave thin_film_over(thin_film_wave a, thin_film_wave b) {
  float by = 1.0f / (b.re * b.re + b.im * b.im + 1e-30f);
  return (thin_film_wave){by * (a.re * b.re + a.im * b.im), by * (a.im * b.re - a.re * b.im)};
}

/* A metal's reflectance within the film, its colour and tint at 82 degrees by Schlick's: `head_on`
 * of that, the cosine there. */
LEAF float thin_film_tinted(float head_on, float tint, float cosine) {
  const float low = 0.46266437f, dip = 17.651385f; /* (6/7)^5; 7 (7/6)^6 */
  float x = 1.0f - cosine, x5 = x * x * x * x * x, rest = 1.0f - head_on;
  float lost = (head_on + rest * low) * (1.0f - clampf(tint, 0.0f, 1.0f));
  return clampf(head_on + rest * x5 - dip * lost * cosine * x5 * x, 0.0f, 1.0f);
}

/* The same phase, another size. */
LEAF thin_film_wave thin_film_sized(thin_film_wave z, float square) {
  float by = sqrtf(square / (z.re * z.re + z.im * z.im + 1e-30f));
  return (thin_film_wave){by * z.re, by * z.im};
}

/* Of one direction of swing: -a z, its powers, their sum, and by what of that light is lost. */
enum { FILM_ROOM = 64 };
typedef struct thin_film_swing {
  float re[FILM_ROOM], im[FILM_ROOM], power_re[FILM_ROOM], power_im[FILM_ROOM], sum[FILM_ROOM],
      by[FILM_ROOM];
} thin_film_swing;

LEAF void thin_film_begin(thin_film_swing *restrict w, size_t i, float a, thin_film_wave z) {
  float z2 = z.re * z.re + z.im * z.im, rest = 1.0f - a * a * z2;
  w->re[i] = w->power_re[i] = -a * z.re;
  w->im[i] = w->power_im[i] = -a * z.im;
  w->sum[i] = 1.0f;
  w->by[i] = (1.0f - a * a) * (1.0f - z2) / (rest > 1e-6f ? rest : 1e-6f);
}

/* One term more; re, im: what is left of it. */
LEAF void thin_film_add(thin_film_swing *restrict w, size_t i, float re, float im) {
  float x = w->power_re[i], y = w->power_im[i];
  w->sum[i] += 2.0f * (x * re - y * im);
  w->power_re[i] = x * w->re[i] - y * w->im[i];
  w->power_im[i] = x * w->im[i] + y * w->re[i];
}

/* One colour of FILM_ROOM rays at most, from `begin` on, at these angles. Films below 1 nm fade
 * away, as in Cycles. */
LEAF void thin_film_reflects(bool tinted, const thin_film_lanes *from, int color, size_t begin,
                             size_t count, const float *restrict cosines, float *restrict out) {
  const float *re = from->table + 2 * color * FILM_WAYS, *im = re + FILM_WAYS;
  const float *thick = from->thickness + begin, *index = from->ior + begin;
  const float *etas = from->eta[color] + begin, *ks = from->k[color] + begin;
  const float *tints = tinted ? from->tint[color] + begin : NULL;
  thin_film_swing s, p;
  float way[FILM_ROOM];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float eta = clampf(etas[i], 1e-4f, 1e4f), k = clampf(ks[i], 0.0f, 1e4f);
    float fade = clampf(thick[i], 0.0f, 1.0f), cosine = clampf(cosines[i], 1e-4f, 1.0f);
    fade = fade * fade * (3.0f - 2.0f * fade);
    float ior = lerp(1.0f, clampf(index[i], 1e-3f, 1e3f), fade);
    float sine2 = 1.0f - cosine * cosine, c2 = 1.0f - sine2 / (ior * ior);
    bool enters = c2 > 0.0f;
    c2 = sqrtf(enters ? c2 : 1.0f);
    float across = (cosine - ior * c2) / (cosine + ior * c2);
    float along = (ior * cosine - c2) / (ior * cosine + c2);
    /* the body's index squared, and that times the cosine within, which has both parts positive */
    thin_film_wave square = {eta * eta - k * k, 2.0f * eta * k};
    float x = square.re - sine2, size = sqrtf(x * x + square.im * square.im);
    thin_film_wave in = {sqrtf(0.5f * clampf(size + x, 0.0f, 1e30f)),
                         sqrtf(0.5f * clampf(size - x, 0.0f, 1e30f))};
    float own = ior * c2;
    thin_film_wave z =
        thin_film_over((thin_film_wave){own - in.re, -in.im}, (thin_film_wave){own + in.re, in.im});
    thin_film_wave y = thin_film_over(
        (thin_film_wave){square.re * c2 - ior * in.re, square.im * c2 - ior * in.im},
        (thin_film_wave){square.re * c2 + ior * in.re, square.im * c2 + ior * in.im});
    if (tinted) {
      float less = ior - eta, more = ior + eta;
      float head_on = (less * less + k * k) / (more * more + k * k);
      float left = thin_film_tinted(head_on, tints[i], c2);
      z = thin_film_sized(z, left);
      y = thin_film_sized(y, left);
    }
    thin_film_begin(&s, i, across, z);
    thin_film_begin(&p, i, along, y);
    s.by[i] = enters ? s.by[i] : 0.0f; /* all is reflected */
    p.by[i] = enters ? p.by[i] : 0.0f;
    way[i] = 2.0f * own * clampf(thick[i], 0.0f, 1e6f) * (1.0f / FILM_STEP);
  }
  for (int m = 1; m <= FILM_TERMS; m++) {
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      float x = clampf((float)m * way[i], 0.0f, FILM_WAYS - 1.001f);
      int at = (int)x;
      float t = x - (float)at, left_re = lerp(re[at], re[at + 1], t);
      float left_im = lerp(im[at], im[at + 1], t);
      thin_film_add(&s, i, left_re, left_im);
      thin_film_add(&p, i, left_re, left_im);
    }
  }
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = clampf(1.0f - 0.5f * (s.by[i] * s.sum[i] + p.by[i] * p.sum[i]), 0.0f, 1.0f);
}

#endif
