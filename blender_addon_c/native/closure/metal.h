/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libshade's metal, with the words of its own table. What nodes say of it instead, point by point:
 * `f0_from`, `kd_from`, `f82_from`, `eta_from`, `k_from`, three operands each, of which those that
 * are no registers leave the parameter as it is; `ax_from` and `ay_from`, one each; `groove_from`,
 * two, the tangent about the normal; `normal`, three registers; `spread_from`, two, how far bumps
 * that are not seen one by one widen a lobe of Gaussian slopes along the frame's x and y, as nodes
 * write it; `slopes`, of horizon `mutual`, five numbers: the mean slope along x and y of all bumps
 * and their second moment, xx, xy, yy, about it; else they are found (render/relief.h); and
 * `moment_from`, three operands, that of a RELIEF node, which counts where bumps are uneven, and
 * `mean_from`, two, the mean of one whose long waves are the surface's shape.
 * `apart`: Smith's shadowing of each direction by itself, as Cycles' GGX and Beckmann had it
 * until 3.6, not of both together. `film_thickness` and, with it, what else node/interference.h
 * reads: what it reflects is by that, too; of the metal f0 counts, no Fresnel.
 */
#ifndef LIBSHADE_CLOSURE_METAL_H
#define LIBSHADE_CLOSURE_METAL_H

#include "batch/lanes.h"
#include "closure/common.h"
#include "closure/glass.h"
#include "node/albedo.h"
#include "node/common.h"
#include "node/interference.h"
#include "shade/shade.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define METAL_PI 3.14159265f

typedef struct closure_metal {
  shade_params params;
  shade_bsdf bsdf;
  operand f0[3], kd[3], f82[3], eta[3], k[3], ax, ay, groove[2], spread[2], moment[3], mean[2];
  bool grooved, apart, spreads, facets; /* facets: the BRDF is microfacet */
  const float *albedo;                  /* of a lobe that loses light as it spreads, or NULL */
  thin_film film;
  bool told; /* the scene says the slopes of its bumps */
  bool matt; /* an even matt body and no more, without bumps: most floors and walls */
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

/* Its slopes are those of its parameters, at every point. */
static inline void closure_metal_even(closure_metal *c) {
  for (int k = 0; k < 3; k++)
    c->moment[k].at = OPERAND_NUMBER;
  for (int k = 0; k < 2; k++)
    c->mean[k].at = OPERAND_NUMBER;
}

/* What is known of it before its nodes have run. A matt body alone counts as diffuse; of a mirror
 * the colour head-on says how much light it may gather. */
static inline void closure_metal_tell(const closure_metal *c, graph *g) {
  const shade_params *q = &c->params;
  bool mirror = q->fresnel != SHADE_FRESNEL_NONE;
  double head_on = 0;
  for (int k = 0; k < 3; k++) {
    mirror = mirror || c->f0[k].at >= 0 || q->f0[k] > 0;
    head_on += (c->f0[k].at >= 0 ? 1 : q->f0[k]) / 3;
  }
  bool uneven = q->ax != q->ay || c->ax.at != c->ay.at || c->spreads;
  bool fibres =
      q->diffuse != SHADE_DIFFUSE_LAMBERT && q->diffuse != SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY;
  bool sharp = q->ax <= CLOSURE_LEAST_ALPHA && q->ay <= CLOSURE_LEAST_ALPHA;
  g->exponent = fmax(q->ex, q->ey);
  g->focus = !mirror ? 0 : q->fresnel == SHADE_FRESNEL_CONDUCTOR ? 1 : head_on;
  g->traits |= (mirror ? 0u : CLOSURE_MATT) | (sharp ? CLOSURE_SHARP : 0u) |
               (fibres || (mirror && uneven) ? CLOSURE_GROOVED : 0u);
}

static inline bool closure_metal_read(reader *r, closure_metal *c, graph *g) {
  shade_params_init(&c->params);
  c->grooved = reader_has(r, "groove_from");
  c->apart = false;
  c->spreads = reader_has(r, "spread_from");
  c->albedo = NULL;
  c->film.there = false;
  if (reader_has(r, "film_thickness") && !thin_film_read(r, &c->film, g))
    return false;
  if (!reader_may_flag(r, "apart", &c->apart) || !closure_metal_from(r, g, "f0_from", 3, c->f0) ||
      !closure_metal_from(r, g, "kd_from", 3, c->kd) ||
      !closure_metal_from(r, g, "f82_from", 3, c->f82) ||
      !closure_metal_from(r, g, "eta_from", 3, c->eta) ||
      !closure_metal_from(r, g, "k_from", 3, c->k) ||
      !closure_metal_from(r, g, "groove_from", 2, c->groove) ||
      !closure_metal_from(r, g, "spread_from", 2, c->spread) ||
      !closure_metal_from(r, g, "moment_from", 3, c->moment) ||
      !closure_metal_from(r, g, "mean_from", 2, c->mean) ||
      !closure_metal_from(r, g, "ax_from", 1, &c->ax) ||
      !closure_metal_from(r, g, "ay_from", 1, &c->ay) || !graph_normal(r, g, c->normal))
    return false;
  if (!closure_metal_choices(r, &c->params) || !closure_metal_numbers(r, &c->params, &g->status))
    return false;
  double slopes[5];
  c->told = reader_has(r, "slopes");
  if (c->told) {
    if (!reader_numbers(r, "slopes", 5, slopes))
      return false;
    g->status |= shade_params_set_slopes(&c->params, slopes);
    closure_metal_even(c);
  }
  c->facets = shade_params_brdf(&c->params) == SHADE_BRDF_MICROFACET;
  c->apart = c->apart && !g->dump && c->facets &&
             (c->params.mdf == SHADE_MDF_GGX || c->params.mdf == SHADE_MDF_BECKMANN);
  if (c->spreads && c->params.mdf == SHADE_MDF_BECKMANN && c->facets &&
      c->params.multiscatter == SHADE_MULTISCATTER_OFF &&
      !albedo_table_make(ALBEDO_BECKMANN, &c->albedo))
    return reader_out_of_memory(r);
  g->status |= shade_bsdf_setup(&c->bsdf, &c->params);
  c->matt = c->params.fresnel == SHADE_FRESNEL_NONE && c->params.diffuse == SHADE_DIFFUSE_LAMBERT;
  for (int k = 0; k < 3; k++)
    c->matt =
        c->matt && c->f0[k].at < 0 && !(c->params.f0[k] > 0) && c->normal[k] == REGISTER_NORMAL + k;
  closure_metal_tell(c, g);
  return true;
}

/* Head-on and of its body. */
static inline float closure_metal_color(const closure_metal *c, const inputs *in, int k, size_t i) {
  if (c->film.there) { /* as without it: its f0 is what the film's colours multiply */
    operand eta = c->film.eta[k], loss = c->film.k[k];
    float index = eta.at < 0 ? eta.number : in->at[eta.at][i];
    float absorbed = loss.at < 0 ? loss.number : in->at[loss.at][i];
    float less = (index - 1.0f) * (index - 1.0f) + absorbed * absorbed;
    return clampf(less / (less + 4.0f * index), 0.0f, 1.0f);
  }
  double n = c->params.eta[k], x = c->params.k[k];
  double head_on = ((n - 1) * (n - 1) + x * x) / ((n + 1) * (n + 1) + x * x);
  operand number = {.at = OPERAND_NUMBER};
  bool exact = c->params.fresnel == SHADE_FRESNEL_CONDUCTOR;
  float mirror = exact ? closure_color_of(in, number, c->eta[k].at < 0 ? head_on : 0.04, i)
                       : closure_color_of(in, c->f0[k], c->params.f0[k], i);
  return mirror + closure_color_of(in, c->kd[k], c->params.kd[k], i);
}

/* Schlick's Fresnel of f0, and the matt part; of a conductor that varies, as if it were dark. */
LEAF void closure_metal_albedo(const closure_metal *c, lane_run run, const surfaces *restrict at,
                               inputs *given, float *out) {
  const float *f0[3], *kd[3];
  const bool exact = c->params.fresnel == SHADE_FRESNEL_CONDUCTOR;
  const float white = c->params.fresnel == SHADE_FRESNEL_NONE ? 0.0f : 1.0f;
  for (int k = 0; k < 3; k++) {
    double n = c->params.eta[k], x = c->params.k[k];
    double own =
        exact ? ((n - 1) * (n - 1) + x * x) / ((n + 1) * (n + 1) + x * x) : c->params.f0[k];
    operand head_on = exact ? (operand){.at = OPERAND_NUMBER} : c->f0[k], matt = c->kd[k];
    head_on.number = exact && c->eta[k].at >= 0 ? 0.05f : (float)own;
    matt.number = (float)c->params.kd[k];
    f0[k] = lane_of(given, head_on, k, run);
    kd[k] = lane_of(given, matt, 3 + k, run);
  }
  const float *f0r = f0[0], *f0g = f0[1], *f0b = f0[2], *kdr = kd[0], *kdg = kd[1], *kdb = kd[2];
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float dark = 1.0f - clampf(dot(normal_at(given, c->normal, i), load(&at->wo, i)), 0.0f, 1.0f);
    float mean = clampf((f0r[i] + f0g[i] + f0b[i]) * (1.0f / 3.0f), 0.0f, 1.0f);
    float edge = white * (1.0f - mean) * dark * dark * dark * dark * dark;
    out[i] = mean + edge + clampf((kdr[i] + kdg[i] + kdb[i]) * (1.0f / 3.0f), 0.0f, 1.0f);
  }
}

/* A register from lane i on; NULL, the material's own, of a number. */
static inline const float *metal_lane(const inputs *given, operand o, size_t i) {
  return o.at < 0 ? NULL : given->at[o.at] + i;
}

/* What shapes the lobe, from lane 0 on; NULL: alphas that are the material's own, bumps that add
 * nothing. */
typedef struct metal_lobe {
  const float *alpha[2]; /* along the tangent and across it */
  const float *share[2]; /* which part of its squared slopes bumps are */
  const float *kept;     /* what it reflects of the light that it did without them */
} metal_lobe;

/* How far bumps widen the lobe along the tangent and across it: where that turns, both alike. False
 * where they do not. */
static bool metal_spread(const closure_metal *c, lane_run run, inputs *given, float *along,
                         float *across) {
  const float *x = lane_of(given, c->spread[0], 8, run), *y = lane_of(given, c->spread[1], 9, run);
  const float turned = c->grooved ? 0.5f : 0.0f;
  uint32_t any = 0;
#pragma omp simd reduction(| : any)
  for (size_t i = run.begin; i < run.end; i++) {
    float a = lerp(x[i], y[i], turned), b = lerp(y[i], x[i], turned);
    along[i] = a;
    across[i] = b;
    any |= ((a > 0.0f) | (b > 0.0f)) ? 1u : 0u;
  }
  return any != 0;
}

/*
 * An alpha and bumps' spread become the alpha of both and the bumps' share. About its middle a
 * power e of the cosine, scaled to 1, is a Gaussian of slopes of the variance 1 / (e + 1); alpha
 * squared is 2 / (e + 2). narrow: how Beckmann's lobe narrows bumps, by its own square
 * (shade/maps.h says why).
 */
LEAF void metal_widen(bool cosines, float narrow, lane_run run, const float *alpha, float *wide,
                      float *spread) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float square = alpha[i] * alpha[i], more = spread[i], less = 1.0f + narrow * square;
    float own = square / (2.0f - (square < 1.0f ? square : 1.0f)), both = own + 0.5f * more;
    both = both > 1e-12f ? both : 1e-12f;
    wide[i] = sqrtf(cosines ? 2.0f * both / (both + 1.0f) : square + more / (less * less));
    spread[i] = 1.0f - own / both;
  }
}

/* A wide lobe loses light between its facets, bumps do not: what is `kept`, by both tables. */
static void metal_keep(const closure_metal *c, lane_run run, const surfaces *restrict at,
                       const inputs *given, const float *const own[2], const float *const wide[2],
                       float *kept) {
  const float *x = own[0], *y = own[1], *wide_x = wide[0], *wide_y = wide[1], *table = c->albedo;
  const int normal[3] = {c->normal[0], c->normal[1], c->normal[2]};
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float cosine = dot(normal_at(given, normal, i), load(&at->wo, i));
    float before = sqrtf(0.5f * (x[i] * x[i] + y[i] * y[i]));
    float after = sqrtf(0.5f * (wide_x[i] * wide_x[i] + wide_y[i] * wide_y[i]));
    kept[i] = albedo_look(table, albedo_find(before, cosine)) /
              albedo_look(table, albedo_find(after, cosine));
  }
}

static __attribute__((noinline)) metal_lobe
metal_lobe_of(const closure_metal *c, lane_run run, const surfaces *restrict at, inputs *given) {
  const operand from[2] = {c->ax, c->ay};
  const double number[2] = {c->params.ax, c->params.ay};
  const bool cosines = c->params.mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY;
  const float narrow = c->params.mdf != SHADE_MDF_BECKMANN ? 0.0f : c->facets ? 1.0f : 0.5f;
  float *share[2] = {given->constant[8], given->constant[9]};
  const bool wide = c->spreads && metal_spread(c, run, given, share[0], share[1]);
  metal_lobe lobe = {.kept = NULL};
  const float *own[2] = {NULL, NULL};
  for (int axis = 0; axis < 2; axis++) {
    operand alpha = from[axis];
    if (alpha.at < 0 && !wide && !given->blurs && !c->apart)
      continue;
    alpha.number = (float)number[axis];
    own[axis] = lobe.alpha[axis] = lane_of(given, alpha, 4 + axis, run);
    if (wide) {
      lobe.alpha[axis] = given->blurred[axis];
      lobe.share[axis] = cosines && !c->facets ? share[axis] : NULL;
      if (cosines)
        metal_widen(true, narrow, run, own[axis], given->blurred[axis], share[axis]);
      else
        metal_widen(false, narrow, run, own[axis], given->blurred[axis], share[axis]);
    }
  }
  if (wide && c->albedo)
    metal_keep(c, run, at, given, own, lobe.alpha, given->constant[10]);
  lobe.kept = wide && c->albedo ? given->constant[10] : NULL;
  for (int axis = 0; axis < 2 && given->blurs; axis++)
    lobe.alpha[axis] = blurred_lane(given, lobe.alpha[axis], axis, run);
  return lobe;
}

typedef struct metal_tangent {
  const float *x, *y;
} metal_tangent;

static inline metal_tangent metal_tangent_of(const closure_metal *c, lane_run run, inputs *given) {
  operand x = {.at = OPERAND_NUMBER, .number = 1.0f}, y = {.at = OPERAND_NUMBER, .number = 0.0f};
  return (metal_tangent){.x = lane_of(given, c->grooved ? c->groove[0] : x, 6, run),
                         .y = lane_of(given, c->grooved ? c->groove[1] : y, 7, run)};
}

LEAF float metal_lambda(bool beckmann, vec3 n, vec3 t, vec3 w, float ax, float ay) {
  float z = dot(n, w), x = dot(t, w), z2 = clampf(z * z, 1e-12f, 1.0f);
  float y2 = clampf(1.0f - z2 - x * x, 0.0f, 1.0f), sine2 = x * x + y2;
  float a2 = (ax * ax * x * x + ay * ay * y2) / (sine2 > 1e-12f ? sine2 : 1e-12f);
  float alpha = sqrtf(a2 > 1e-12f ? a2 : 1e-12f), cosine = sqrtf(z2);
  return beckmann ? glass_beckmann_lambda(cosine, alpha) : glass_lambda(cosine, alpha);
}

/* f, by the shadowing of both directions together, to f by that of each. */
LEAF void metal_shadow_apart(bool beckmann, const closure_metal *c, lane_run run,
                             const surfaces *restrict at, inputs *given, const metal_lobe *lobe,
                             const lane_v *restrict wi, lane_c *restrict f) {
  const closure_metal own = *c;
  const metal_tangent from = metal_tangent_of(c, run, given);
  const float *ax = lobe->alpha[0], *ay = lobe->alpha[1];
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, own.normal, i), t = {from.x[i], from.y[i], 0.0f};
    float along = dot(t, n);
    t = (vec3){t.x - along * n.x, t.y - along * n.y, -along * n.z};
    float length2 = dot(t, t);
    t = scaled(t, 1.0f / sqrtf(length2 > 1e-30f ? length2 : 1e-30f));
    float lo = metal_lambda(beckmann, n, t, load(&at->wo, i), ax[i], ay[i]);
    float li = metal_lambda(beckmann, n, t, load(wi, i), ax[i], ay[i]);
    float by = (1.0f + lo + li) / ((1.0f + lo) * (1.0f + li));
    f->r[i] *= by;
    f->g[i] *= by;
    f->b[i] *= by;
  }
}

/*
 * Bumps that are a part of the lobe: of them those shine whose normals are near h, and it is these
 * whose cosines count, not those of the mean normal (a fifth less where the eye looks straight and
 * the light stands at 37 degrees). Of two Gaussians of slopes the normal is where h is, by the
 * bumps' share of the way from the mean. Low light, which other bumps would shade, gains four times
 * at most.
 */
LEAF void metal_bumps(const closure_metal *c, lane_run run, const surfaces *restrict at,
                      inputs *given, const metal_lobe *lobe, const lane_v *restrict wi,
                      lane_c *restrict f) {
  const closure_metal own = *c;
  const metal_tangent from = metal_tangent_of(c, run, given);
  const float *along = lobe->share[0], *across = lobe->share[1];
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, own.normal, i), o = load(&at->wo, i), l = load(wi, i);
    float up = o.z + l.z, by_h = 1.0f / (up > 1e-3f ? up : 1e-3f);
    float by_n = 1.0f / (n.z > 1e-3f ? n.z : 1e-3f), x = n.x * by_n, y = n.y * by_n;
    float dx = (o.x + l.x) * by_h - x, dy = (o.y + l.y) * by_h - y, tx = from.x[i], ty = from.y[i];
    float a = along[i] * (dx * tx + dy * ty), b = across[i] * (dy * tx - dx * ty);
    vec3 m = {x + a * tx - b * ty, y + a * ty + b * tx, 1.0f};
    float mi = dot(m, l), mo = dot(m, o), ni = dot(n, l), no = dot(n, o);
    float more = mi > mo ? mi : mo, most = ni > no ? ni : no;
    float by = mi * most / (more * ni);
    bool counts = (ni > 0.0f) & (mi > 0.0f);
    by = counts ? (by < 4.0f ? by : 4.0f) : 1.0f; /* NaN stays out */
    f->r[i] *= by;
    f->g[i] *= by;
    f->b[i] *= by;
  }
}

/* What its film reflects, at the facets between both directions. */
static __attribute__((noinline)) void metal_film(const closure_metal *c, lane_run run,
                                                 const surfaces *restrict at, inputs *given,
                                                 const lane_v *restrict wi, lane_c *restrict f) {
  const thin_film_lanes from = thin_film_lanes_of(&c->film, given, run);
  float *const to[3] = {f->r, f->g, f->b};
  float cosine[FILM_ROOM], part[FILM_ROOM];
  for (size_t begin = run.begin; begin < run.end; begin += FILM_ROOM) {
    size_t left = run.end - begin, count = left < FILM_ROOM ? left : FILM_ROOM;
#pragma omp simd
    for (size_t i = 0; i < count; i++) { /* of a unit angle's half */
      float both = dot(load(&at->wo, begin + i), load(wi, begin + i));
      cosine[i] = sqrtf(clampf(0.5f + 0.5f * both, 0.0f, 1.0f));
    }
    for (int k = 0; k < 3; k++) {
      if (c->film.tinted)
        thin_film_reflects(true, &from, k, begin, count, cosine, part);
      else
        thin_film_reflects(false, &from, k, begin, count, cosine, part);
      float *restrict color = to[k] + begin;
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        color[i] *= part[i];
    }
  }
}

/* f, as the library has it, to that of all that is said here beside it. */
LEAF void metal_finish(const closure_metal *c, lane_run run, const surfaces *restrict at,
                       inputs *given, const metal_lobe *lobe, const lane_v *restrict wi,
                       lane_c *restrict f) {
  if (c->apart && c->params.mdf == SHADE_MDF_BECKMANN)
    metal_shadow_apart(true, c, run, at, given, lobe, wi, f);
  else if (c->apart)
    metal_shadow_apart(false, c, run, at, given, lobe, wi, f);
  if (lobe->share[0])
    metal_bumps(c, run, at, given, lobe, wi, f);
  for (size_t i = run.begin; lobe->kept && i < run.end; i++) {
    f->r[i] *= lobe->kept[i];
    f->g[i] *= lobe->kept[i];
    f->b[i] *= lobe->kept[i];
  }
  if (c->film.there)
    metal_film(c, run, at, given, wi, f);
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
  .etar = metal_lane(given, c->eta[0], i), .etag = metal_lane(given, c->eta[1], i),                \
  .etab = metal_lane(given, c->eta[2], i), .kr = metal_lane(given, c->k[0], i),                    \
  .kg = metal_lane(given, c->k[1], i), .kb = metal_lane(given, c->k[2], i),                        \
  .slope_x = metal_lane(given, c->mean[0], i), .slope_y = metal_lane(given, c->mean[1], i),        \
  .slope_xx = metal_lane(given, c->moment[0], i), .slope_xy = metal_lane(given, c->moment[1], i),  \
  .slope_yy = metal_lane(given, c->moment[2], i), .ax = lobe.alpha[0] ? lobe.alpha[0] + i : NULL,  \
  .ay = lobe.alpha[1] ? lobe.alpha[1] + i : NULL,                                                  \
  .groove_x = c->grooved ? lane_of(given, c->groove[0], 6, run) + i : NULL,                        \
  .groove_y = c->grooved ? lane_of(given, c->groove[1], 7, run) + i : NULL

/* The matt body by itself, where every horizon is the same: much less than the library would do. No
 * numbers are the material's own. */
typedef struct matt_lanes {
  const float *kd[3];
  float own[3];
} matt_lanes;

static inline matt_lanes matt_lanes_of(const closure_metal *c, inputs *given, lane_run run) {
  matt_lanes lanes;
  for (int k = 0; k < 3; k++) {
    operand kd = c->kd[k];
    kd.number = lanes.own[k] = (float)c->params.kd[k];
    lanes.kd[k] = lane_of(given, kd, k, run);
  }
  return lanes;
}

LEAF void matt_f(const matt_lanes *from, size_t i, float scale, lane_c *f) {
  float r = from->kd[0][i], g = from->kd[1][i], b = from->kd[2][i];
  scale *= 1.0f / METAL_PI;
  f->r[i] = scale * clampf(r == r ? r : from->own[0], 0.0f, 1.0f);
  f->g[i] = scale * clampf(g == g ? g : from->own[1], 0.0f, 1.0f);
  f->b[i] = scale * clampf(b == b ? b : from->own[2], 0.0f, 1.0f);
}

LEAF void matt_eval(const closure_metal *c, lane_run run, const surfaces *restrict at,
                    inputs *given, const lane_v *restrict wi, leaning leans, bool density,
                    reflections *restrict out) {
  const matt_lanes lanes = matt_lanes_of(c, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float z = wi->z[i], cosine = z, fade = 1.0f;
    if (leans == LEANS_AWAY)
      cosine = dot(load(&at->lean, i), load(wi, i));
    if (leans == LEANS_FADING)
      fade = matt_fade(load(&at->lean, i), (vec3){0.0f, 0.0f, 1.0f}, load(wi, i));
    bool lit = (cosine > 0.0f) & (z > 0.0f) & (at->wo.z[i] > 0.0f);
    matt_f(&lanes, i, lit ? fade : 0.0f, &out->f);
    out->cosine[i] = lit ? cosine : 0.0f;
    if (density)
      out->pdf[i] = lit ? cosine * (1.0f / METAL_PI) : 0.0f;
  }
}

LEAF void matt_draw(const closure_metal *c, lane_run run, const surfaces *restrict at,
                    inputs *given, leaning leans, draws *restrict out) {
  const matt_lanes lanes = matt_lanes_of(c, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float radius = sqrtf(out->x[i]), cosine = sqrtf(1.0f - out->x[i]), fade = 1.0f, s, k;
    turn(out->y[i], &s, &k);
    vec3 l = {radius * k, radius * s, cosine};
    if (leans == LEANS_AWAY)
      l = cosine_about(load(&at->lean, i), out->x[i], out->y[i], &cosine);
    if (leans == LEANS_FADING)
      fade = matt_fade(load(&at->lean, i), (vec3){0.0f, 0.0f, 1.0f}, l);
    bool lit = (cosine > 0.0f) & (l.z > 0.0f) & (at->wo.z[i] > 0.0f);
    store(&out->wi, i, l);
    matt_f(&lanes, i, lit ? fade : 0.0f, &out->f);
    out->cosine[i] = cosine;
    out->pdf[i] = lit ? cosine * (1.0f / METAL_PI) : 0.0f;
  }
}

LEAF unsigned closure_metal_eval(const closure_metal *c, lane_run run, const surfaces *restrict at,
                                 inputs *given, const lane_v *restrict wi, bool density,
                                 reflections *restrict out) {
  size_t i = run.begin;
  if (c->matt) {
    if (at->leans == LEANS_AWAY)
      matt_eval(c, run, at, given, wi, LEANS_AWAY, true, out);
    else if (at->leans == LEANS_FADING)
      matt_eval(c, run, at, given, wi, LEANS_FADING, true, out);
    else if (density)
      matt_eval(c, run, at, given, wi, LEANS_NOT, true, out);
    else
      matt_eval(c, run, at, given, wi, LEANS_NOT, false, out);
    return 0;
  }
  const metal_lobe lobe = metal_lobe_of(c, run, at, given);
  shade_lanesf in = {
      .size = sizeof in, .wix = wi->x + i, .wiy = wi->y + i, .wiz = wi->z + i, METAL_GIVEN};
  shade_resultf result = {.size = sizeof result,
                          .r = out->f.r + i,
                          .g = out->f.g + i,
                          .b = out->f.b + i,
                          .cosine = out->cosine + i};
  unsigned status = shade_bsdf_eval_batchf(&c->bsdf, run.end - run.begin, &in, &result);
  if (density)
    status |= shade_bsdf_pdf_batchf(&c->bsdf, run.end - run.begin, &in, out->pdf + i);
  metal_finish(c, run, at, given, &lobe, wi, &out->f);
  return status;
}

/* Directions by f cos, roughly. */
LEAF unsigned closure_metal_draw(const closure_metal *c, lane_run run, const surfaces *restrict at,
                                 inputs *given, draws *restrict out) {
  size_t i = run.begin;
  if (c->matt) {
    if (at->leans == LEANS_AWAY)
      matt_draw(c, run, at, given, LEANS_AWAY, out);
    else if (at->leans == LEANS_FADING)
      matt_draw(c, run, at, given, LEANS_FADING, out);
    else
      matt_draw(c, run, at, given, LEANS_NOT, out);
    return 0;
  }
  const metal_lobe lobe = metal_lobe_of(c, run, at, given);
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
  unsigned status = shade_bsdf_sample_batchf(&c->bsdf, run.end - run.begin, &in, &result);
  metal_finish(c, run, at, given, &lobe, &out->wi, &out->f);
  return status & ~(unsigned)SHADE_NO_SAMPLE;
}

#undef METAL_GIVEN

#endif
