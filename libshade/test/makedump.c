/* SPDX-License-Identifier: Apache-2.0 */
/*
 * makedump FILE.exr WIDTH HEIGHT SEED [plain|sharp|varied|cloth]: a dump as a back end would write
 * it, for test_check.py. Frames, directions and lights are random, but near the lobes, so that S is
 * well above zero; S comes from shade_bsdf_eval_batchf, its inputs from the world's vectors in
 * float, as in a renderer. `plain`: without Color. `sharp`: with exponents 30 times as large, to
 * 6000. `varied`: all kinds of materials, and every number that may vary from hit to hit does.
 * `cloth`: cloths, each hit by a tier of its own, in double.
 */
#include "dump/dump.h"
#include "shade/presets.h"
#include "shade/shade.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIGHTS = 2 };

/* ---- random numbers and vectors ----------------------------------------------- */

static uint64_t random_state;

/* Uniform in (0, 1): the upper bits of a 64-bit linear congruential generator. */
static double uniform(void) {
  random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return ((double)(random_state >> 12) + 0.5) / 4503599627370496.0;
}

typedef struct vec {
  double x, y, z;
} vec;

static vec scale(vec a, double s) {
  return (vec){a.x * s, a.y * s, a.z * s};
}
static vec add(vec a, vec b) {
  return (vec){a.x + b.x, a.y + b.y, a.z + b.z};
}
static double dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static vec unit(vec a) {
  return scale(a, 1 / sqrt(dot(a, a)));
}

/* A unit vector at an angle in [0, most], uniform in it, from unit `axis`. */
static vec around(vec axis, double most) {
  const double pi = 3.14159265358979323846;
  const double theta = most * uniform(), phi = 2 * pi * uniform();
  const vec x = unit(cross(axis, fabs(axis.x) < 0.6 ? (vec){1, 0, 0} : (vec){0, 1, 0}));
  const vec y = cross(axis, x);
  return add(scale(axis, cos(theta)),
             add(scale(x, sin(theta) * cos(phi)), scale(y, sin(theta) * sin(phi))));
}

/* ---- materials ------------------------------------------------------------------ */

enum { MATERIALS = 14 };

static void make_materials(shade_params materials[MATERIALS], double sharper) {
  static const struct {
    shade_detail detail;
    shade_groove groove;
    shade_fresnel fresnel;
    double ex, ey;
    shade_horizon horizon;
  } rows[MATERIALS] = {
      {SHADE_DETAIL_NONE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 200, 10, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_PERTURB, SHADE_GROOVE_AUTO, SHADE_FRESNEL_NONE, 120, 40, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_GRAM_SCHMIDT, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 200, 10,
       SHADE_HORIZON_HARD},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 200, 10, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_NONE, 8, 300, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, SHADE_FRESNEL_SCHLICK, 10, 200, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_Y, SHADE_FRESNEL_SCHLICK, 200, 10, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 50, 50, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 1000, 30, SHADE_HORIZON_HARD},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 40, 10,
       SHADE_HORIZON_VALID_REFLECTION},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 40, 10,
       SHADE_HORIZON_ESTEVEZ},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 40, 10, SHADE_HORIZON_CHIANG},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 40, 10,
       SHADE_HORIZON_SCHUESSLER},
      {SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, SHADE_FRESNEL_SCHLICK, 40, 10,
       SHADE_HORIZON_VALID_ESTEVEZ},
  };
  for (int i = 0; i < MATERIALS; i++) {
    shade_params *p = &materials[i];
    shade_params_init(p);
    p->detail = rows[i].detail;
    p->groove = rows[i].groove;
    p->fresnel = rows[i].fresnel;
    p->horizon = rows[i].horizon;
    shade_params_set_exponents(p, fmin(sharper * rows[i].ex, sharper > 1 ? 6000 : 1e6),
                               fmin(sharper * rows[i].ey, sharper > 1 ? 6000 : 1e6));
    p->f0[0] = 0.9;
    p->f0[1] = 0.08 * i;
    p->f0[2] = 0.5;
  }
}

/* Other distributions, BRDFs, Fresnel terms and diffuse parts. */
static void vary_materials(shade_params materials[MATERIALS]) {
  for (int i = 0; i < MATERIALS; i++) {
    shade_params *p = &materials[i];
    p->mdf = (shade_mdf)(i % SHADE_MDF_COUNT);
    p->brdf = (shade_brdf)(i / 2 % SHADE_BRDF_COUNT);
    p->fresnel = (shade_fresnel)(i % SHADE_FRESNEL_COUNT);
    p->diffuse = (shade_diffuse)(i % SHADE_DIFFUSE_POULIN_FOURNIER);
    p->multiscatter = (shade_multiscatter)(i > 7); /* 8 and 9 can have it */
    shade_params_set_exponents(p, 100, 15);
    for (int c = 0; c < 3; c++)
      p->kd[c] = 0.2;
  }
  materials[MATERIALS - 1].horizon = SHADE_HORIZON_MUTUAL;
}

static char *header_json(const shade_params materials[MATERIALS]) {
  enum { SIZE = 1024 * (MATERIALS + 1) };
  char *text = malloc(SIZE);
  if (!text)
    return NULL;
  int length =
      snprintf(text, SIZE,
               "{\"version\": \"" SHADE_VERSION "\", \"renderer\": \"makedump\", \"materials\": [");
  for (int i = 0; i < MATERIALS; i++) {
    char name[32];
    snprintf(name, sizeof name, "material \"%d\"", i);
    length += snprintf(text + length, (size_t)(SIZE - length), "%s", i ? ", " : "");
    length += shade_params_json(&materials[i], i, name, text + length, (size_t)(SIZE - length));
  }
  snprintf(text + length, (size_t)(SIZE - length), "]}");
  return text;
}

/* ---- the dump ------------------------------------------------------------------- */

static void put(float *plane, size_t pixels, size_t pixel, vec v) {
  plane[pixel] = (float)v.x;
  plane[pixels + pixel] = (float)v.y;
  plane[2 * pixels + pixel] = (float)v.z;
}

/* h near the normal that carries the lobe, L the mirror image of V about h. */
static void fill_pixel(const shade_dump *d, size_t pixel, int material, const shade_params *p) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  const double degree = 3.14159265358979323846 / 180;
  const vec n = around((vec){0, 0, 1}, 180 * degree);
  const vec t = unit(cross(n, around(n, 90 * degree)));
  const vec ns = around(n, 60 * degree);
  /* about N, V sees bumps from behind, which is what choices of horizon are for */
  const vec v = around(p->horizon == SHADE_HORIZON_HARD ? ns : n, 50 * degree);
  put(shade_dump_plane(d, SHADE_DUMP_P), pixels, pixel, (vec){uniform(), uniform(), uniform()});
  put(shade_dump_plane(d, SHADE_DUMP_N), pixels, pixel, n);
  put(shade_dump_plane(d, SHADE_DUMP_T), pixels, pixel, t);
  put(shade_dump_plane(d, SHADE_DUMP_NS), pixels, pixel, ns);
  put(shade_dump_plane(d, SHADE_DUMP_V), pixels, pixel, v);
  shade_dump_plane(d, SHADE_DUMP_UV)[pixel] = (float)uniform();
  shade_dump_plane(d, SHADE_DUMP_UV + 1)[pixel] = (float)uniform();
  shade_dump_plane(d, SHADE_DUMP_MATERIAL)[pixel] = (float)material;
  put(shade_dump_plane(d, SHADE_DUMP_COLOR), pixels, pixel, (vec){uniform(), uniform(), uniform()});
  const vec pole = p->detail == SHADE_DETAIL_NONE ? n : ns;
  for (int light = 0; light < LIGHTS; light++) {
    const vec h = around(pole, 30 * degree);
    const vec l = unit(add(scale(h, 2 * dot(h, v)), scale(v, -1)));
    put(shade_dump_light_plane(d, light, SHADE_DUMP_L), pixels, pixel, l);
    put(shade_dump_light_plane(d, light, SHADE_DUMP_E), pixels, pixel,
        (vec){0.5 + uniform(), 0.5 + uniform(), 0.5 + uniform()});
  }
}

static float number(const shade_dump *d, int plane, size_t pixel) {
  return shade_dump_plane(d, plane)[pixel];
}

/* What this hit has of its own. */
static void vary_pixel(shade_dump *d, size_t pixel, const shade_params *p) {
  const double pi = 3.14159265358979323846;
  const double near[] = {p->ax, p->ay};
  for (int i = 0; i < 2; i++)
    shade_dump_plane(d, SHADE_DUMP_ALPHA + i)[pixel] = (float)(near[i] * (0.6 + uniform()));
  shade_dump_plane(d, SHADE_DUMP_GROOVE)[pixel] = (float)(pi * (2 * uniform() - 1));
  for (int i = 0; i < 3; i++) {
    shade_dump_plane(d, SHADE_DUMP_F82 + i)[pixel] = (float)uniform();
    shade_dump_plane(d, SHADE_DUMP_ETA + i)[pixel] = (float)(0.2 + uniform());
    shade_dump_plane(d, SHADE_DUMP_K + i)[pixel] = (float)(2 + 2 * uniform());
    shade_dump_plane(d, SHADE_DUMP_KD + i)[pixel] = (float)(0.4 * uniform());
  }
  const double slopes[5] = {0.3 * uniform(), 0.3 * uniform(), 0.1 + 0.3 * uniform(),
                            0.1 * uniform() - 0.05, 0.1 + 0.3 * uniform()};
  for (int i = 0; i < 5; i++)
    shade_dump_plane(d, SHADE_DUMP_SLOPES + i)[pixel] = (float)slopes[i];
}

/* Two more lobes, about normals of their own; at a third of the hits there is no third lobe. */
static void add_lobes(const shade_dump *d, size_t pixel, const shade_params *p) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  const double degree = 3.14159265358979323846 / 180;
  const float *n = shade_dump_plane(d, SHADE_DUMP_N) + pixel;
  const vec up = {(double)n[0], (double)n[pixels], (double)n[2 * pixels]};
  for (int lobe = SHADE_DUMP_LOBE2; lobe <= SHADE_DUMP_LOBE3; lobe += SHADE_DUMP_PER_LOBE) {
    const double share = 0.5 * uniform();
    const int none = lobe == SHADE_DUMP_LOBE3 && uniform() < 0.33;
    shade_dump_plane(d, lobe)[pixel] = none ? 0 : (float)share;
    put(shade_dump_plane(d, lobe + SHADE_DUMP_LOBE_NS), pixels, pixel, around(up, 30 * degree));
    shade_dump_plane(d, lobe + SHADE_DUMP_LOBE_ALPHA)[pixel] = (float)(p->ax * (0.6 + uniform()));
    shade_dump_plane(d, lobe + SHADE_DUMP_LOBE_ALPHA + 1)[pixel] =
        (float)(p->ay * (0.6 + uniform()));
    shade_dump_plane(d, lobe + SHADE_DUMP_LOBE_GROOVE)[pixel] =
        (float)(180 * degree * (2 * uniform() - 1));
  }
}

/* The material of one hit. */
static shade_params params_of(const shade_dump *d, size_t pixel, const shade_params *p) {
  shade_params q = *p;
  shade_params_set_alphas(&q, (double)number(d, SHADE_DUMP_ALPHA, pixel),
                          (double)number(d, SHADE_DUMP_ALPHA + 1, pixel));
  for (int i = 0; i < 3; i++) {
    q.f0[i] = (double)number(d, SHADE_DUMP_COLOR + i, pixel);
    q.f82[i] = (double)number(d, SHADE_DUMP_F82 + i, pixel);
    q.eta[i] = (double)number(d, SHADE_DUMP_ETA + i, pixel);
    q.k[i] = (double)number(d, SHADE_DUMP_K + i, pixel);
    q.kd[i] = (double)number(d, SHADE_DUMP_KD + i, pixel);
  }
  for (int i = 0; i < 5; i++)
    q.slopes[i] = (double)number(d, SHADE_DUMP_SLOPES + i, pixel);
  return q;
}

/* Component along a frame's axis, in float. */
static float along(const float *axis, const float *v, size_t pixels, size_t pixel) {
  return axis[pixel] * v[pixel] + axis[pixels + pixel] * v[pixels + pixel] +
         axis[2 * pixels + pixel] * v[2 * pixels + pixel];
}

enum lane { NX, NY, NZ, IX, IY, IZ, OX, OY, OZ, CR, CG, CB, FR, FG, FB, COS, LANES };

/* Take the pixels of one material to the local frame, shade them in one batch, put S back. */
static void shade(const shade_dump *d, const shade_params *p, int material, int light,
                  float *const lanes[LANES], float *bitangent) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  const float *id = shade_dump_plane(d, SHADE_DUMP_MATERIAL);
  const float *axes[3] = {shade_dump_plane(d, SHADE_DUMP_T), bitangent,
                          shade_dump_plane(d, SHADE_DUMP_N)};
  const float *vectors[3] = {shade_dump_plane(d, SHADE_DUMP_NS),
                             shade_dump_light_plane(d, light, SHADE_DUMP_L),
                             shade_dump_plane(d, SHADE_DUMP_V)};
  const float *color = shade_dump_plane(d, SHADE_DUMP_COLOR);
  size_t count = 0;
  for (size_t pixel = 0; pixel < pixels; pixel++) {
    if (id[pixel] != (float)material)
      continue;
    for (int v = 0; v < 3; v++)
      for (int a = 0; a < 3; a++)
        lanes[NX + 3 * v + a][count] = along(axes[a], vectors[v], pixels, pixel);
    for (size_t i = 0; i < 3; i++)
      lanes[CR + i][count] = color[i * pixels + pixel];
    count++;
  }
  shade_bsdf bsdf;
  shade_bsdf_setup(&bsdf, p);
  const int textured = d->has_color;
  const shade_lanesf in = {.size = sizeof in,
                           .nx = lanes[NX],
                           .ny = lanes[NY],
                           .nz = lanes[NZ],
                           .wix = lanes[IX],
                           .wiy = lanes[IY],
                           .wiz = lanes[IZ],
                           .wox = lanes[OX],
                           .woy = lanes[OY],
                           .woz = lanes[OZ],
                           .f0r = textured ? lanes[CR] : NULL,
                           .f0g = textured ? lanes[CG] : NULL,
                           .f0b = textured ? lanes[CB] : NULL};
  const shade_resultf out = {sizeof out, lanes[FR], lanes[FG], lanes[FB], lanes[COS]};
  shade_bsdf_eval_batchf(&bsdf, count, &in, &out);
  const float *e = shade_dump_light_plane(d, light, SHADE_DUMP_E);
  float *s = shade_dump_light_plane(d, light, SHADE_DUMP_S);
  count = 0;
  for (size_t pixel = 0; pixel < pixels; pixel++) {
    if (id[pixel] != (float)material)
      continue;
    for (size_t i = 0; i < 3; i++)
      s[i * pixels + pixel] = lanes[FR + i][count] * lanes[COS][count] * e[i * pixels + pixel];
    count++;
  }
}

/* Slopes as the frame has them whose x' is (c, s). */
static void turn_slopes(double c, double s, double v[5]) {
  const double x = v[0], y = v[1], xx = v[2], xy = v[3], yy = v[4];
  v[0] = c * x + s * y;
  v[1] = c * y - s * x;
  v[2] = c * c * xx + 2 * c * s * xy + s * s * yy;
  v[3] = c * s * (yy - xx) + (c * c - s * s) * xy;
  v[4] = s * s * xx - 2 * c * s * xy + c * c * yy;
}

/* One lobe of a hit, for its share: q's, about the normal and in the frame that the planes say. */
static void add_lobe(const shade_dump *d, size_t pixel, const shade_params *q, int normal,
                     int groove, float share, int light, const float *bitangent) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  const float *axes[3] = {shade_dump_plane(d, SHADE_DUMP_T), bitangent,
                          shade_dump_plane(d, SHADE_DUMP_N)};
  const float *vectors[3] = {shade_dump_plane(d, normal),
                             shade_dump_light_plane(d, light, SHADE_DUMP_L),
                             shade_dump_plane(d, SHADE_DUMP_V)};
  const float angle = number(d, groove, pixel), c = cosf(angle), s = sinf(angle);
  float v[3][3], f[3], cosine;
  for (int k = 0; k < 3; k++) {
    const float x = along(axes[0], vectors[k], pixels, pixel);
    const float y = along(axes[1], vectors[k], pixels, pixel);
    v[k][0] = c * x + s * y;
    v[k][1] = c * y - s * x;
    v[k][2] = along(axes[2], vectors[k], pixels, pixel);
  }
  shade_bsdf bsdf;
  shade_params turned = *q;
  turn_slopes((double)c, (double)s, turned.slopes);
  shade_bsdf_setup(&bsdf, &turned);
  shade_bsdf_evalf(&bsdf, v[0], v[1], v[2], f, &cosine);
  const float *e = shade_dump_light_plane(d, light, SHADE_DUMP_E);
  float *out = shade_dump_light_plane(d, light, SHADE_DUMP_S);
  for (size_t i = 0; i < 3; i++)
    out[i * pixels + pixel] += share * f[i] * cosine * e[i * pixels + pixel];
}

/* Shade the hits of one material one by one, each with numbers and a frame of its own. */
static void shade_varied(const shade_dump *d, const shade_params *p, int material, int light,
                         const float *bitangent) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  for (size_t pixel = 0; pixel < pixels; pixel++) {
    if (!(number(d, SHADE_DUMP_MATERIAL, pixel) == (float)material))
      continue;
    shade_params q = params_of(d, pixel, p);
    const float others = number(d, SHADE_DUMP_LOBE2, pixel) + number(d, SHADE_DUMP_LOBE3, pixel);
    add_lobe(d, pixel, &q, SHADE_DUMP_NS, SHADE_DUMP_GROOVE, 1 - others, light, bitangent);
    for (int lobe = SHADE_DUMP_LOBE2; lobe <= SHADE_DUMP_LOBE3; lobe += SHADE_DUMP_PER_LOBE) {
      const float share = number(d, lobe, pixel);
      const int alpha = lobe + SHADE_DUMP_LOBE_ALPHA;
      if (share == 0)
        continue;
      shade_params_set_alphas(&q, (double)number(d, alpha, pixel),
                              (double)number(d, alpha + 1, pixel));
      add_lobe(d, pixel, &q, lobe + SHADE_DUMP_LOBE_NS, lobe + SHADE_DUMP_LOBE_GROOVE, share, light,
               bitangent);
    }
  }
}

/* ---- cloth ---------------------------------------------------------------------------- */

typedef struct cloth {
  shade_preset preset;
  shade_draft *draft;
  shade_weave *weave;
  shade_fabric *fabric;
} cloth;
enum { CLOTHS = 4 };

static int make_cloths(cloth cloths[CLOTHS]) {
  static const char *const words[CLOTHS] = {"denim", "silk_charmeuse", "linen", "wool_flannel"};
  for (int i = 0; i < CLOTHS; i++) {
    cloth *c = &cloths[i];
    if (!shade_preset_find(words[i], &c->preset))
      return 0;
    c->preset.fabric.draft_colors = i == 1;
    c->preset.fabric.horizon = (shade_horizon)i;
    if (i == 2) /* linen: its gaps show nothing */
      memset(c->preset.fabric.backing, 0, sizeof c->preset.fabric.backing);
    c->draft = shade_draft_named(c->preset.weave);
    for (int k = 0; c->draft && k < c->draft->ends; k++)
      c->draft->warp[k].color[0] = k % 2 ? 0.6 : 1;
    c->weave = shade_weave_create(c->draft, &c->preset.yarns, NULL);
    c->fabric = shade_fabric_create(c->weave, &c->preset.fabric, NULL);
    if (!c->fabric)
      return 0;
  }
  return 1;
}

static void free_cloths(cloth cloths[CLOTHS]) {
  for (int i = 0; i < CLOTHS; i++) {
    shade_fabric_free(cloths[i].fabric);
    shade_weave_free(cloths[i].weave);
    shade_draft_free(cloths[i].draft);
  }
}

/* The first by the name of its weave, the others by their draft. */
static char *cloths_json(const cloth cloths[CLOTHS]) {
  enum { SIZE = 16384 * CLOTHS };
  char *text = malloc(SIZE);
  if (!text)
    return NULL;
  int length =
      snprintf(text, SIZE,
               "{\"version\": \"" SHADE_VERSION "\", \"renderer\": \"makedump\", \"materials\": [");
  for (int i = 0; i < CLOTHS; i++) {
    const cloth *c = &cloths[i];
    length += snprintf(text + length, (size_t)(SIZE - length), "%s", i ? ", " : "");
    length += shade_fabric_json(i, c->preset.word, c->draft, i == 0 ? c->preset.weave : NULL,
                                &c->preset.yarns, &c->preset.fabric, text + length,
                                (size_t)(SIZE - length));
  }
  snprintf(text + length, (size_t)(SIZE - length), "]}");
  return text;
}

/* uv in crossings, a tier, a footprint. */
static void place_on_cloth(shade_dump *d, size_t pixel) {
  const double pick = uniform(), span = 20 * pow(4, uniform());
  const shade_fabric_tier tier = pick < 0.3    ? SHADE_TIER_NEAR
                                 : pick < 0.87 ? SHADE_TIER_AUTO
                                 : pick < 0.88 ? SHADE_TIER_FAR
                                               : SHADE_TIER_SINGLE;
  const double foot = pick < 0.6 ? 0 : pick < 0.86 ? 0.7 * uniform() : span;
  shade_dump_plane(d, SHADE_DUMP_UV)[pixel] = (float)(80 * uniform() - 40);
  shade_dump_plane(d, SHADE_DUMP_UV + 1)[pixel] = (float)(80 * uniform() - 40);
  shade_dump_plane(d, SHADE_DUMP_FOOT)[pixel] = (float)foot;
  shade_dump_plane(d, SHADE_DUMP_FOOT + 1)[pixel] = (float)(foot * (0.5 + uniform()));
  shade_dump_plane(d, SHADE_DUMP_TIER)[pixel] = (float)tier;
}

static void unit_of(const float *plane, size_t pixels, size_t pixel, double v[3]) {
  double size = 0;
  for (size_t i = 0; i < 3; i++) {
    v[i] = (double)plane[i * pixels + pixel];
    size += v[i] * v[i];
  }
  for (int i = 0; i < 3; i++)
    v[i] /= sqrt(size);
}

/* In double, from the directions that the file has. */
static void shade_cloth(const shade_dump *d, const cloth *c, size_t pixel, int light) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  double axis[3][3], world[3][3], v[3][3], s[3];
  unit_of(shade_dump_plane(d, SHADE_DUMP_T), pixels, pixel, axis[0]);
  unit_of(shade_dump_plane(d, SHADE_DUMP_N), pixels, pixel, axis[2]);
  for (int i = 0; i < 3; i++)
    axis[1][i] =
        axis[2][(i + 1) % 3] * axis[0][(i + 2) % 3] - axis[2][(i + 2) % 3] * axis[0][(i + 1) % 3];
  unit_of(shade_dump_plane(d, SHADE_DUMP_NS), pixels, pixel, world[0]);
  unit_of(shade_dump_light_plane(d, light, SHADE_DUMP_L), pixels, pixel, world[1]);
  unit_of(shade_dump_plane(d, SHADE_DUMP_V), pixels, pixel, world[2]);
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      v[k][a] = axis[a][0] * world[k][0] + axis[a][1] * world[k][1] + axis[a][2] * world[k][2];
  const double uv[] = {(double)number(d, SHADE_DUMP_UV, pixel),
                       (double)number(d, SHADE_DUMP_UV + 1, pixel)};
  const double foot[] = {(double)number(d, SHADE_DUMP_FOOT, pixel),
                         (double)number(d, SHADE_DUMP_FOOT + 1, pixel)};
  shade_fabric_eval(c->fabric, uv, foot, v[0], v[1], v[2],
                    (shade_fabric_tier)(int)number(d, SHADE_DUMP_TIER, pixel), s);
  shade_fabric_point point;
  shade_fabric_hit hit;
  double coverage;
  shade_fabric_point_init(c->fabric, &point);
  for (int i = 0; i < 2; i++) {
    point.uv[i] = uv[i];
    point.footprint[i] = foot[i];
  }
  for (int i = 0; i < 3; i++)
    point.n[i] = v[0][i];
  shade_fabric_prepare(c->fabric, &point, v[2],
                       (shade_fabric_tier)(int)number(d, SHADE_DUMP_TIER, pixel), &hit, &coverage);
  shade_dump_plane(d, SHADE_DUMP_COVERAGE)[pixel] = (float)coverage;
  const float *e = shade_dump_light_plane(d, light, SHADE_DUMP_E);
  for (size_t i = 0; i < 3; i++)
    shade_dump_light_plane(d, light, SHADE_DUMP_S)[i * pixels + pixel] =
        (float)(s[i] * (double)e[i * pixels + pixel]);
}

/* A whole dump of cloths. */
static int fill_with_cloth(shade_dump *d) {
  cloth cloths[CLOTHS] = {0};
  shade_params plain;
  shade_params_init(&plain);
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  shade_dump_add(d, SHADE_DUMP_FOOT);
  shade_dump_add(d, SHADE_DUMP_COVERAGE);
  shade_dump_add(d, SHADE_DUMP_TIER);
  char *json = make_cloths(cloths) ? cloths_json(cloths) : NULL;
  const int good = json && shade_dump_set_json(d, json) == 0;
  for (size_t pixel = 0; good && pixel < pixels; pixel++) {
    const int material = (int)(uniform() * (CLOTHS + 1)) - 1;
    if (material < 0)
      continue;
    fill_pixel(d, pixel, material, &plain);
    place_on_cloth(d, pixel);
    for (int light = 0; light < LIGHTS; light++)
      shade_cloth(d, &cloths[material], pixel, light);
  }
  free(json);
  free_cloths(cloths);
  return good;
}

static void make_bitangents(const shade_dump *d, float *b) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  const float *n = shade_dump_plane(d, SHADE_DUMP_N), *t = shade_dump_plane(d, SHADE_DUMP_T);
  for (size_t x = 0; x < pixels; x++)
    for (size_t i = 0; i < 3; i++) {
      const size_t j = (i + 1) % 3 * pixels + x, k = (i + 2) % 3 * pixels + x;
      b[i * pixels + x] = n[j] * t[k] - n[k] * t[j];
    }
}

/* Writes the dump and frees it. */
static int save(shade_dump *d, const char *path) {
  char error[512];
  const int status = shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error);
  if (status != 0)
    fprintf(stderr, "makedump: %s\n", error);
  shade_dump_free(d);
  return status != 0;
}

int main(int argc, char **argv) {
  if (argc < 5)
    return 2;
  const int width = atoi(argv[2]), height = atoi(argv[3]);
  random_state = strtoull(argv[4], NULL, 10);
  shade_dump *d = shade_dump_create(width, height, LIGHTS);
  if (!d)
    return 1;
  const int sharp = argc == 6 && strcmp(argv[5], "sharp") == 0;
  const int varied = argc == 6 && strcmp(argv[5], "varied") == 0;
  d->has_color = argc == 5 || sharp || varied;
  for (int channel = SHADE_DUMP_ALPHA; varied && channel < SHADE_DUMP_FOOT; channel++)
    shade_dump_add(d, (enum shade_dump_optional)channel);
  for (int lobe = SHADE_DUMP_LOBE2; varied && lobe <= SHADE_DUMP_LOBE3; lobe += SHADE_DUMP_PER_LOBE)
    shade_dump_add(d, (enum shade_dump_optional)lobe);
  if (varied)
    shade_dump_add(d, SHADE_DUMP_SLOPES);
  if (argc == 6 && strcmp(argv[5], "cloth") == 0) {
    d->has_color = 0;
    if (!fill_with_cloth(d))
      return 1;
    return save(d, argv[1]);
  }
  const size_t pixels = (size_t)width * (size_t)height;
  shade_params materials[MATERIALS];
  make_materials(materials, sharp ? 30 : 1);
  if (varied)
    vary_materials(materials);
  for (size_t pixel = 0; pixel < pixels; pixel++) {
    const int material = (int)(uniform() * (MATERIALS + 1)) - 1; /* -1: a miss */
    if (material >= 0)
      fill_pixel(d, pixel, material, &materials[material]);
    if (material >= 0 && varied)
      vary_pixel(d, pixel, &materials[material]);
  }
  for (size_t pixel = 0; varied && pixel < pixels; pixel++) {
    const float id = number(d, SHADE_DUMP_MATERIAL, pixel);
    if (id >= 0)
      add_lobes(d, pixel, &materials[(int)id]);
  }
  float *bitangent = malloc(3 * pixels * sizeof *bitangent), *lanes[LANES];
  float *scratch = malloc(LANES * pixels * sizeof *scratch);
  char *json = header_json(materials);
  if (!bitangent || !scratch || !json || shade_dump_set_json(d, json) != 0)
    return 1;
  for (size_t i = 0; i < LANES; i++)
    lanes[i] = scratch + i * pixels;
  make_bitangents(d, bitangent);
  for (int material = 0; material < MATERIALS; material++)
    for (int light = 0; light < LIGHTS; light++)
      if (varied)
        shade_varied(d, &materials[material], material, light, bitangent);
      else
        shade(d, &materials[material], material, light, lanes, bitangent);
  free(json);
  free(scratch);
  free(bitangent);
  return save(d, argv[1]);
}
