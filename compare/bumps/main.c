/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build/bumps: how bright a field of metal bumps is on the mean, really displaced and with all its
 * reflections, and by its normals alone with each choice of horizon. compare/steep_bumps.py runs
 * it.
 *
 * The truth is traced: the eye's ray finds the displaced surface, a direction is drawn from the
 * facet's own lobe, and so on until the ray leaves. Skies are what it meets then; suns are looked
 * for at every point of the path. A way draws from its own lobe over the flat map, or sums suns.
 */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "field.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dump/whole.h"
#include "shade/shade.h"

enum { SKIES = 5, ELEVATIONS = 4, TURNS = 3, SUNS = ELEVATIONS * TURNS, LIGHTS = SKIES + SUNS };
enum { EYES = 5, COLORS = 2, WAYS = SHADE_HORIZON_COUNT + 1, BOUNCES = 32, HALVES = 2 };

static const char *const sky_words[SKIES] = {"even", "zenith", "horizon", "patch_before",
                                             "patch_behind"};
static const double sun_elevation[ELEVATIONS] = {5, 15, 30, 60};
static const double eye_elevation[EYES] = {15, 30, 45, 60, 75};
static const double color[COLORS] = {0.6, 1}; /* reflectance at every angle */

typedef struct view {
  vec wo, ahead; /* to the eye, and along the ground to it */
  vec sun[SUNS];
} view;

typedef struct sums {
  double of[COLORS][LIGHTS];
} sums;

static vec toward(double elevation, double azimuth) {
  return (vec){cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation)};
}

static view view_of(double elevation, double azimuth) {
  view v = {.wo = toward(elevation * PI / 180, azimuth), .ahead = toward(0, azimuth)};
  for (int s = 0; s < SUNS; s++) /* on the eye's side, beside it, behind the surface */
    v.sun[s] = toward(sun_elevation[s / TURNS] * PI / 180, azimuth + s % TURNS * PI / 2);
  return v;
}

/* Radiance of each sky. The patches fill elevations of 12 to 53 degrees on one side. */
static void add_skies(const view *v, vec d, const double weight[COLORS], sums *to) {
  if (d.z <= 0)
    return;
  const double side = dot(d, v->ahead);
  const int patch = d.z > 0.2 && d.z < 0.8;
  const double sky[SKIES] = {1, 0.2 + 1.6 * d.z, 1.8 - 1.6 * d.z,
                             0.2 + (patch && side < 0 ? 3.2 : 0),
                             0.2 + (patch && side > 0 ? 3.2 : 0)};
  for (int c = 0; c < COLORS; c++)
    for (int k = 0; k < SKIES; k++)
      to->of[c][k] += weight[c] * sky[k];
}

/* f cos of the lobe; a sun's irradiance, facing it, is 1. */
static double shaded(const shade_bsdf *b, const shade_bsdf_hit *hit, vec wi) {
  double f[3], cosine;
  shade_bsdf_hit_eval(b, hit, (const double[3]){wi.x, wi.y, wi.z}, f, &cosine);
  return f[0] * cosine;
}

static void prepare(const shade_bsdf *b, vec n, vec wo, shade_bsdf_hit *hit) {
  shade_bsdf_prepare(b, (const double[3]){n.x, n.y, n.z}, (const double[3]){wo.x, wo.y, wo.z}, hit);
}

/* A direction drawn from it, and its weight, or 0. */
static double drawn(const shade_bsdf *b, const shade_bsdf_hit *hit, uint64_t *random, vec *wi) {
  double u[2], w[3], f[3], pdf, cosine;
  u[0] = uniform(random);
  u[1] = uniform(random);
  shade_bsdf_hit_sample(b, hit, u, w, f, &pdf, &cosine);
  *wi = (vec){w[0], w[1], w[2]};
  return pdf > 0 ? f[0] * cosine / pdf : 0;
}

/* One path of the displaced surface. `facet` is white, and ignores normals: it is given in its own
 * frame. */
static void trace(const field *f, const shade_bsdf *facet, const view *v, double x, double y,
                  uint64_t *random, sums *to) {
  const double start = (f->high + 1e-3) / v->wo.z;
  const vec above = {0, 0, 1};
  vec p = plus((vec){x, y, 0}, start, v->wo), d = {-v->wo.x, -v->wo.y, -v->wo.z};
  double weight[COLORS] = {1, 1};
  for (int bounce = 0; bounce < BOUNCES; bounce++) {
    const double t = field_cast(f, p, d);
    if (t < 0) {
      add_skies(v, d, weight, to);
      return;
    }
    p = plus(p, t, d);
    const vec n = field_normal(f, p.x, p.y);
    /* the facet's grooves go along x, as seen from above */
    const double scale = 1 / sqrt(n.x * n.x + n.z * n.z);
    const vec tx = {n.z * scale, 0, -n.x * scale};
    const vec ty = {n.y * tx.z - n.z * tx.y, n.z * tx.x - n.x * tx.z, n.x * tx.y - n.y * tx.x};
    const vec wo = {-dot(tx, d), -dot(ty, d), -dot(n, d)};
    if (wo.z <= 0) /* between the points of the grid normals are not quite the surface's */
      return;
    p = plus(p, 1e-3, n);
    shade_bsdf_hit hit;
    prepare(facet, above, wo, &hit);
    for (int c = 0; c < COLORS; c++)
      weight[c] *= color[c];
    for (int s = 0; s < SUNS; s++) {
      const vec sun = v->sun[s], wi = {dot(tx, sun), dot(ty, sun), dot(n, sun)};
      const double value = wi.z > 0 ? shaded(facet, &hit, wi) : 0;
      if (value * weight[COLORS - 1] > 1e-6 && field_cast(f, p, sun) < 0)
        for (int c = 0; c < COLORS; c++)
          to->of[c][SKIES + s] += weight[c] * value;
    }
    vec wi;
    const double kept = drawn(facet, &hit, random, &wi);
    if (kept <= 0)
      return;
    for (int c = 0; c < COLORS; c++)
      weight[c] *= kept;
    d = plus(plus((vec){wi.x * tx.x, wi.x * tx.y, wi.x * tx.z}, wi.y, ty), wi.z, n);
  }
}

/* The same point by its normal. */
static void shade_map(const field *f, const shade_bsdf ways[COLORS], const view *v, double x,
                      double y, uint64_t *random, sums *to) {
  const vec n = field_normal(f, x, y);
  for (int c = 0; c < COLORS; c++) {
    vec wi;
    double weight[COLORS] = {0};
    shade_bsdf_hit hit;
    prepare(&ways[c], n, v->wo, &hit);
    weight[c] = drawn(&ways[c], &hit, random, &wi);
    if (weight[c] > 0)
      add_skies(v, wi, weight, to);
    for (int s = 0; s < SUNS; s++)
      to->of[c][SKIES + s] += shaded(&ways[c], &hit, v->sun[s]);
  }
}

/* ---- the order ------------------------------------------------------------------------------ */

static int usage(FILE *to) {
  fputs("usage: bumps OUT.csv SURFACE SLOPE MDF FIRST SECOND PATHS [SEED]\n\n"
        "The mean brightness of bumps of metal, displaced and by their normals with each choice of "
        "horizon,\n"
        "for eyes of 15 to 75 degrees, reflectances .6 and 1, five skies and twelve suns.\n\n"
        "  SURFACE        sine, noise, ridges_across or ridges_along (the eye's direction); "
        "fractal,\n"
        "                 long_and_fine, roofs, letter, pits, scratches or half\n"
        "  SLOPE          0.01 to 2\n"
        "  MDF            as for `shade eval`; its BRDF is the one that goes with it\n"
        "  FIRST SECOND   along x and y: exponents of ashikhmin_shirley, alphas of the others\n"
        "  PATHS          an eye, 64 to 1e7\n"
        "Each value is written twice, of either half of the paths: how far they are apart is the "
        "noise.\n"
        "Exit status: 0 done; 1 it could not be written; 2 bad usage.\n",
        to);
  return to == stdout ? 0 : 2;
}

typedef struct order {
  kind kind;
  double slope, first, second, paths, seed;
  shade_params params;
} order;

static int number(const char *text, double low, double high, double *value) {
  char *end;
  *value = strtod(text, &end);
  return end != text && !*end && *value >= low && *value <= high;
}

static int read_order(int argc, char **argv, order *o) {
  *o = (order){.seed = 1};
  while (o->kind < KINDS && strcmp(kind_words[o->kind], argv[2]) != 0)
    o->kind++;
  const int mdf = shade_list_find(SHADE_LIST_MDF, argv[4]);
  if (o->kind == KINDS || mdf < 0 || !number(argv[3], 0.01, 2, &o->slope) ||
      !number(argv[5], 0, 1e6, &o->first) || !number(argv[6], 0, 1e6, &o->second) ||
      !number(argv[7], 64, 1e7, &o->paths) || (argc > 8 && !number(argv[8], 0, 1e9, &o->seed)))
    return 0;
  shade_params *p = &o->params;
  shade_params_init(p);
  p->mdf = (shade_mdf)mdf;
  p->fresnel = SHADE_FRESNEL_NONE;
  return (mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY
              ? shade_params_set_exponents
              : shade_params_set_alphas)(p, o->first, o->second) == SHADE_OK;
}

static void set_color(shade_params *p, double to) {
  p->f0[0] = p->f0[1] = p->f0[2] = to;
}

static void set_mutual(shade_params *p, const double slopes[5], shade_bsdf to[COLORS]) {
  p->horizon = SHADE_HORIZON_MUTUAL;
  shade_params_set_slopes(p, slopes);
  for (int c = 0; c < COLORS; c++) {
    set_color(p, color[c]);
    shade_bsdf_setup(&to[c], p);
  }
}

/* [half][0: displaced; then the horizons] of one eye. */
static void look(const field *f, const order *o, int eye, sums mean[HALVES][WAYS]) {
  shade_params p = o->params;
  enum { MUTUAL = SHADE_HORIZON_MUTUAL };
  shade_bsdf facet, ways[SHADE_HORIZON_COUNT][COLORS];
  p.detail = SHADE_DETAIL_NONE;
  set_color(&p, 1);
  shade_bsdf_setup(&facet, &p);
  p.detail = o->params.detail;
  for (int h = 0; h < SHADE_HORIZON_COUNT; h++)
    for (int c = 0; c < COLORS; c++) {
      p.horizon = (shade_horizon)h;
      set_color(&p, color[c]);
      shade_bsdf_setup(&ways[h][c], &p);
    }
  /* around the map for what is the same from everywhere; ridges from one side */
  const int turns = f->kind < RIDGES_ACROSS ? 8 : 1;
  const double from = f->kind == RIDGES_ALONG ? PI / 2 : turns > 1 ? PI / 16 : 0;
  const int side = (int)ceil(sqrt(o->paths / (HALVES * turns)));
  const double share = 1. / (side * side * turns);
  uint64_t random = (uint64_t)o->seed * 1000 + (uint64_t)eye;
  memset(mean, 0, HALVES * sizeof *mean);
  for (int half = 0; half < HALVES; half++)
    for (int turn = 0; turn < turns; turn++) {
      const view v = view_of(eye_elevation[eye], from + turn * PI / 4);
      for (int k = 0; k < side * side; k++) {
        const double x = (k % side + uniform(&random)) * PERIOD / side,
                     y = (k / side + uniform(&random)) * PERIOD / side;
        trace(f, &facet, &v, x, y, &random, &mean[half][0]);
        double moment[3];
        field_moment(f, x, y, moment);
        set_mutual(&p, (const double[5]){0, 0, moment[0], moment[1], moment[2]}, ways[MUTUAL]);
        for (int h = 0; h < SHADE_HORIZON_COUNT; h++)
          shade_map(f, ways[h], &v, x, y, &random, &mean[half][1 + h]);
      }
    }
  for (int half = 0; half < HALVES; half++)
    for (int way = 0; way < WAYS; way++)
      for (int c = 0; c < COLORS; c++)
        for (int k = 0; k < LIGHTS; k++)
          mean[half][way].of[c][k] *= share;
}

static const char *name_of(int way) {
  return way ? shade_list_word(SHADE_LIST_HORIZON, way - 1) : "displaced";
}

static void write_eye(FILE *to, const order *o, int eye, sums mean[HALVES][WAYS]) {
  for (int c = 0; c < COLORS; c++)
    for (int k = 0; k < LIGHTS; k++) {
      char light[32];
      const int s = k - SKIES;
      if (s < 0)
        snprintf(light, sizeof light, "%s", sky_words[k]);
      else
        snprintf(light, sizeof light, "sun_%g_%d", sun_elevation[s / TURNS], s % TURNS * 90);
      for (int way = 0; way < WAYS; way++)
        fprintf(to, "%s,%g,%s,%g,%g,%g,%g,%s,%s,%.7g,%.7g\n", kind_words[o->kind], o->slope,
                shade_list_word(SHADE_LIST_MDF, (int)o->params.mdf), o->first, o->second,
                eye_elevation[eye], color[c], light, name_of(way), mean[0][way].of[c][k],
                mean[1][way].of[c][k]);
    }
}

static int run(const order *o, const char *path) {
  field f;
  if (!field_make(&f, o->kind, o->slope)) {
    fputs("bumps: out of memory\n", stderr);
    return 1;
  }
  char *bytes = NULL;
  size_t length = 0;
  FILE *text = open_memstream(&bytes, &length);
  static sums mean[HALVES][WAYS];
  if (text) {
    fputs("surface,slope,mdf,first,second,eye,reflectance,light,way,value,again\n", text);
    for (int eye = 0; eye < EYES; eye++) {
      look(&f, o, eye, mean);
      write_eye(text, o, eye, mean);
    }
    fclose(text);
  }
  field_free(&f);
  char why[256] = "out of memory";
  const int status = bytes ? shade_whole_write(path, bytes, length, why, sizeof why) : -1;
  if (status != 0)
    fprintf(stderr, "bumps: %s: %s\n", path, why);
  free(bytes);
  return status != 0;
}

int main(int argc, char **argv) {
  order o;
  if (argc == 2 && strcmp(argv[1], "--help") == 0)
    return usage(stdout);
  if (argc != 8 && argc != 9)
    return usage(stderr);
  if (!read_order(argc, argv, &o)) {
    fputs("bumps: a word or a number is out of its range (see bumps --help)\n", stderr);
    return 2;
  }
  return run(&o, argv[1]);
}
