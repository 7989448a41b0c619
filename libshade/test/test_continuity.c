/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 5.7 */
/*
 * Continuity. D' and f cos, sampled along paths of directions that cross the places where a
 * formula degenerates: between neighbours the largest difference must fall as the step does.
 * A jump keeps its size. What is known to jump (docs/theory/conventions.md, Continuity) is held to
 * do so.
 *
 * Each path is sampled at 1025 points in windows of several widths about the crossing. Half
 * the step leaves half of the difference where the slope is bounded, 0.71 of it at a root; a jump
 * J leaves more than 0.8 once it is over twice the fine difference around it.
 */
#include <string.h>

#include "support.h"

#ifdef SANITIZED
enum { DRAWS = 1, NARROWER = 3 }; /* every third window of a path: they are slow */
#else
enum { DRAWS = 2, NARROWER = 1 };
#endif

enum { STEPS = 1024, POINTS = STEPS + 1 };
static const double widths[] = {0.3, 0.03, 3e-3, 3e-4, 3e-5};
enum { WIDTHS = sizeof widths / sizeof widths[0] };

typedef enum form { DOUBLE, FLOAT, FORMS } form;
static const char *const form_names[FORMS] = {"double", "float"};
/* relative to the largest value in the window: roundings, of the inputs too */
static const double noise[FORMS] = {1e-11, 1e-4};

/* What the path crosses. */
typedef enum event {
  H_IS_N,
  N_IS_Z,
  H_IS_Z,
  N_IS_Z_IS_H, /* n moves, h stays at z */
  H_CROSSES_X, /* h.x = 0 */
  H_CROSSES_Y,
  N_CROSSES_X,
  N_CROSSES_Y,
  WI_IS_WO,
  WI_IS_N,
  WO_IS_N,
  WI_IS_Z,
  WO_IS_Z,
  WI_ACROSS,  /* wi at right angles to the fibre */
  WI_UPRIGHT, /* wi in the plane of fibre and n */
  WO_ACROSS,
  WO_UPRIGHT,
  EVENTS
} event;
static const char *const event_names[EVENTS] = {
    "h = n",   "n = z",    "h = z",    "n = z = h", "h.x = 0", "h.y = 0",
    "n.x = 0", "n.y = 0",  "wi = wo",  "wi = n",    "wo = n",  "wi = z",
    "wo = z",  "wi.t = 0", "wi.b = 0", "wo.t = 0",  "wo.b = 0"};

typedef struct path {
  event what;
  double n[3], wi[3], wo[3]; /* at the crossing */
  double across[3];          /* unit, at right angles to what moves there */
} path;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void unit(double v[3]) {
  double length = sqrt(dot(v, v));
  for (int c = 0; c < 3; c++)
    v[c] /= length;
}

static void mirror(const double m[3], const double from[3], double to[3]) {
  double d = 2 * dot(m, from);
  for (int c = 0; c < 3; c++)
    to[c] = d * m[c] - from[c];
}

static void within(uint64_t *seed, double least, double most, double v[3]) {
  spherical(least + (most - least) * uniform(seed), 2 * PI * uniform(seed), v);
}

/* Any unit vector at right angles to v. */
static void any_across(uint64_t *seed, const double v[3], double a[3]) {
  do {
    within(seed, 0, PI, a);
    double d = dot(a, v);
    for (int c = 0; c < 3; c++)
      a[c] -= d * v[c];
  } while (dot(a, a) < 0.1);
  unit(a);
}

static void turn(const double start[3], const double to[3], double s, double v[3]) {
  double from[3];
  memcpy(from, start, sizeof from);
  for (int c = 0; c < 3; c++)
    v[c] = cos(s) * from[c] + sin(s) * to[c];
}

/* n, wi, wo and h of the path at s. */
static void walk(const path *p, double s, double n[3], double wi[3], double wo[3], double h[3]) {
  memcpy(n, p->n, sizeof p->n);
  memcpy(wi, p->wi, sizeof p->wi);
  memcpy(wo, p->wo, sizeof p->wo);
  for (int c = 0; c < 3; c++)
    h[c] = wi[c] + wo[c];
  unit(h);
  switch (p->what) {
  case H_IS_N:
  case H_IS_Z:
  case H_CROSSES_X:
  case H_CROSSES_Y:
    if (p->what == H_IS_N)
      memcpy(h, n, sizeof p->n);
    if (p->what == H_IS_Z)
      spherical(0, 0, h);
    turn(h, p->across, s, h);
    mirror(h, wo, wi);
    return;
  case WI_IS_WO:
    turn(wo, p->across, s, wi);
    break;
  case WI_IS_N:
    turn(n, p->across, s, wi);
    break;
  case WO_IS_N:
    turn(n, p->across, s, wo);
    break;
  case WI_IS_Z:
  case WI_ACROSS:
  case WI_UPRIGHT:
    turn(wi, p->across, s, wi);
    break;
  case WO_IS_Z:
  case WO_ACROSS:
  case WO_UPRIGHT:
    turn(wo, p->across, s, wo);
    break;
  default:
    turn(n, p->across, s, n);
    return;
  }
  for (int c = 0; c < 3; c++)
    h[c] = wi[c] + wo[c];
  unit(h);
}

/* The fibre's direction under n, grooves along x or y, and b at right angles to it and n. */
static void fibre_frame(const double n[3], int along_y, double t[3], double b[3]) {
  t[0] = along_y ? 0 : n[2];
  t[1] = along_y ? n[2] : 0;
  t[2] = along_y ? -n[1] : -n[0];
  unit(t);
  for (int c = 0; c < 3; c++)
    b[c] = n[(c + 1) % 3] * t[(c + 2) % 3] - n[(c + 2) % 3] * t[(c + 1) % 3];
}

/* A path whose whole widest window is above every horizon. */
static path choose(uint64_t *seed, event what) {
  const double z[3] = {0, 0, 1}, least = 0.04, clear = 0.99;
  for (;;) {
    path p = {.what = what};
    double h[3];
    within(seed, 0.15, 0.7, p.n);
    within(seed, 0, 1.3, p.wo);
    within(seed, 0.05, 0.5, h);
    if (what == N_IS_Z || what == N_IS_Z_IS_H)
      memcpy(p.n, z, sizeof z);
    p.n[0] = what == N_CROSSES_X ? 0 : p.n[0];
    p.n[1] = what == N_CROSSES_Y ? 0 : p.n[1];
    unit(p.n);
    if (what == H_IS_Z || what == N_IS_Z_IS_H)
      memcpy(h, z, sizeof z);
    if (what == H_IS_N)
      memcpy(h, p.n, sizeof h);
    h[0] = what == H_CROSSES_X ? 0 : h[0];
    h[1] = what == H_CROSSES_Y ? 0 : h[1];
    unit(h);
    if (what == WO_IS_N)
      memcpy(p.wo, p.n, sizeof p.wo);
    if (what == WO_IS_Z)
      memcpy(p.wo, z, sizeof p.wo);
    mirror(h, p.wo, p.wi);
    if (what == WI_IS_WO)
      memcpy(p.wi, p.wo, sizeof p.wi);
    if (what == WI_IS_Z)
      memcpy(p.wi, z, sizeof p.wi);
    if (what < WI_ACROSS) {
      const double *const moves[] = {h, p.n, h, p.n, h, h, p.n, p.n, p.wo, p.n, p.n, p.wi, p.wo};
      any_across(seed, moves[what], p.across);
    } else {
      double t[3], b[3], *w = what < WO_ACROSS ? p.wi : p.wo;
      fibre_frame(p.n, uniform(seed) < 0.5, t, b);
      memcpy(p.across, what == WI_ACROSS || what == WO_ACROSS ? t : b, sizeof p.across);
      double off = dot(w, p.across);
      for (int c = 0; c < 3; c++)
        w[c] -= off * p.across[c];
      unit(w);
    }
    int fits = 1;
    for (int k = -6; k <= 6; k++) {
      double n[3], wi[3], wo[3];
      walk(&p, widths[0] * k / 6, n, wi, wo, h);
      fits &= wi[2] > least && wo[2] > least && dot(n, wi) > least && dot(n, wo) > least;
      fits &= dot(n, h) > 0.5 && h[2] > 0.5;
      /* one crossing at a time */
      fits &= h[2] < clear || what == H_IS_Z || what == N_IS_Z_IS_H;
      fits &= wi[2] < clear || what == WI_IS_Z;
      fits &= wo[2] < clear || what == WO_IS_Z;
      fits &= n[2] < clear || what == N_IS_Z || what == N_IS_Z_IS_H;
      fits &= dot(n, h) < clear || what == H_IS_N || what == N_IS_Z_IS_H;
    }
    if (fits)
      return p;
  }
}

/* The directions of a window, of either precision. */
typedef struct window {
  double v[12][POINTS];
  float vf[12][POINTS]; /* n, wi, wo, h */
} window;

static void fill(window *w, const path *p, double width) {
  for (int i = 0; i < POINTS; i++) {
    double v[12];
    walk(p, width * (2 * i - STEPS) / STEPS, v, v + 3, v + 6, v + 9);
    for (int c = 0; c < 12; c++) {
      w->v[c][i] = v[c];
      w->vf[c][i] = (float)v[c];
    }
  }
}

/* D' in the window. */
static void carry(const shade_bsdf *b, const window *w, form form, int single, double d[POINTS]) {
  static float df[POINTS];
  unsigned status = SHADE_OK;
  if (form == DOUBLE && !single)
    status =
        shade_mdf_eval_batch(b, POINTS, w->v[0], w->v[1], w->v[2], w->v[9], w->v[10], w->v[11], d);
  else if (!single)
    status = shade_mdf_eval_batchf(b, POINTS, w->vf[0], w->vf[1], w->vf[2], w->vf[9], w->vf[10],
                                   w->vf[11], df);
  for (int i = 0; i < POINTS; i++) {
    if (single && form == DOUBLE) {
      const double n[3] = {w->v[0][i], w->v[1][i], w->v[2][i]};
      const double h[3] = {w->v[9][i], w->v[10][i], w->v[11][i]};
      d[i] = shade_mdf_eval(b, n, h, &status);
    } else if (single) {
      const float n[3] = {w->vf[0][i], w->vf[1][i], w->vf[2][i]};
      const float h[3] = {w->vf[9][i], w->vf[10][i], w->vf[11][i]};
      df[i] = shade_mdf_evalf(b, n, h, &status);
    }
    if (form != DOUBLE)
      d[i] = (double)df[i];
  }
  assert_int_equal(status, SHADE_OK);
}

/* f cos, green, in the window. */
static void shade(const shade_bsdf *b, const window *w, form form, int single, double s[POINTS]) {
  static double r[3][POINTS], cosine[POINTS];
  static float rf[3][POINTS], cosinef[POINTS];
  unsigned status = SHADE_OK;
  if (form == DOUBLE && !single) {
    const shade_lanes in = {.size = sizeof in, SHADE_DIRECTIONS(w->v)};
    const shade_result out = {sizeof out, r[0], r[1], r[2], cosine};
    status = shade_bsdf_eval_batch(b, POINTS, &in, &out);
  } else if (!single) {
    const shade_lanesf in = {.size = sizeof in, SHADE_DIRECTIONS(w->vf)};
    const shade_resultf out = {sizeof out, rf[0], rf[1], rf[2], cosinef};
    status = shade_bsdf_eval_batchf(b, POINTS, &in, &out);
  }
  for (int i = 0; i < POINTS; i++) {
    if (single && form == DOUBLE) {
      double v[9], f[3];
      for (int c = 0; c < 9; c++)
        v[c] = w->v[c][i];
      status |= shade_bsdf_eval(b, v, v + 3, v + 6, f, &cosine[i]);
      r[1][i] = f[1];
    } else if (single) {
      float v[9], f[3];
      for (int c = 0; c < 9; c++)
        v[c] = w->vf[c][i];
      status |= shade_bsdf_evalf(b, v, v + 3, v + 6, f, &cosinef[i]);
      rf[1][i] = f[1];
    }
    s[i] = form == DOUBLE ? r[1][i] * cosine[i] : (double)rf[1][i] * (double)cosinef[i];
  }
  assert_int_equal(status, SHADE_OK);
}

/* The largest difference of neighbours, `step` points apart. */
static double largest_step(const double *value, int step) {
  double most = 0;
  for (int i = 0; i + step < POINTS; i += step)
    most = fmax(most, fabs(value[i + step] - value[i]));
  return most;
}

static double largest(const double *value) {
  double most = 0;
  for (int i = 0; i < POINTS; i++)
    most = fmax(most, fabs(value[i]));
  return most;
}

/*
 * The size of a jump as a share of the largest value (and of 1e-10 of D's peak), 0 where there is
 * none: a difference that half the step does not lessen, and that is no rounding.
 */
static double jump(const double *value, double roundings, double peak) {
  double most = fmax(largest(value), 1e-10 * peak);
  double fine = largest_step(value, 1), coarse = largest_step(value, 2);
  return fine <= roundings * most || fine <= 0.8 * coarse ? 0 : fine / most;
}

/*
 * Whether it jumps there: docs/theory/conventions.md, Continuity. D' jumps at h, Smith's Lambda at
 * wi and wo, where they have no azimuth; the conserving warps at h = n.
 */
static int jumps(const shade_bsdf *b, event what, int shaded) {
  int azimuth = bsdf_of(b)->numbers.kx != bsdf_of(b)->numbers.ky;
  if (what == H_IS_Z && (bsdf_of(b)->carry.map == SHADE_MAP_PERTURB ||
                         bsdf_of(b)->carry.map == SHADE_MAP_PERTURB_RATIO))
    return azimuth;
  if ((what == WI_IS_Z || what == WO_IS_Z) && shaded && bsdf_of(b)->brdf == SHADE_BRDF_MICROFACET)
    return azimuth && bsdf_of(b)->carry.shadow == SHADE_MAP_PERTURB;
  /* two facets: with h = z the half vector by way of the mirror stays in n's plane and meets n */
  int by_mirror = what == N_IS_Z_IS_H && shaded && bsdf_of(b)->horizon == SHADE_HORIZON_SCHUESSLER;
  return (what == H_IS_N || by_mirror) && bsdf_of(b)->conserve;
}

static const double exponents[][2] = {{200, 10}, {10, 200}, {20, 20}, {1000, 3}, {2, 8}};
enum { LOBES = sizeof exponents / sizeof exponents[0] };

static shade_bsdf made(int mdf, int detail, int brdf, int horizon, int lobe) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, exponents[lobe][0], exponents[lobe][1]);
  p.mdf = (shade_mdf)mdf;
  p.detail = (shade_detail)detail;
  p.brdf = (shade_brdf)brdf;
  p.horizon = (shade_horizon)horizon;
  p.f0[0] = p.f0[1] = p.f0[2] = 0.3;
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  return b;
}

static void judge(const shade_bsdf *b, const path *p, double width, form form, int shaded,
                  const double *value) {
  double seen = jump(value, noise[form], bsdf_of(b)->numbers.peak);
  if (seen > 0)
    fail_msg("%s: %s %s, %s %s %s: jumps by %g of the largest value, window %g, %s\n"
             "n %.17g %.17g %.17g wi %.17g %.17g %.17g wo %.17g %.17g %.17g, k %g %g",
             event_names[p->what], shade_list_word(SHADE_LIST_MDF, (int)bsdf_of(b)->mdf),
             shade_list_word(SHADE_LIST_DETAIL, (int)bsdf_of(b)->detail),
             shaded ? shade_list_word(SHADE_LIST_BRDF, (int)bsdf_of(b)->brdf) : "D",
             shaded ? shade_list_word(SHADE_LIST_HORIZON, (int)bsdf_of(b)->horizon) : "",
             bsdf_of(b)->has_diffuse ? shade_list_word(SHADE_LIST_DIFFUSE, (int)bsdf_of(b)->diffuse)
                                     : "",
             seen, width, form_names[form], p->n[0], p->n[1], p->n[2], p->wi[0], p->wi[1], p->wi[2],
             p->wo[0], p->wo[1], p->wo[2], bsdf_of(b)->numbers.kx, bsdf_of(b)->numbers.ky);
}

static void distributions_and_brdfs(void **state) {
  (void)state;
  static window w;
  static double value[POINTS];
  uint64_t seed = 71;
  int turn = 0;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int detail = 0; detail < SHADE_DETAIL_COUNT; detail++)
      for (int e = 0; e < WI_ACROSS; e++)
        for (int draw = 0; draw < DRAWS; draw++, turn++) {
          path p = choose(&seed, (event)e);
          for (int k = turn % NARROWER; k < WIDTHS; k += NARROWER) {
            fill(&w, &p, widths[k]);
            for (form form = DOUBLE; form < FORMS; form++) {
              int lobe = turn % LOBES, single = (turn + k) % 8 == 0;
              shade_bsdf b = made(mdf, detail, 0, 0, lobe);
              if (!jumps(&b, (event)e, 0)) {
                carry(&b, &w, form, single, value);
                judge(&b, &p, widths[k], form, 0, value);
              }
              for (int brdf = 0; brdf < SHADE_BRDF_AUTO; brdf++)
                for (int h = 0; h < 2; h++) {
                  int other = 1 + (turn + brdf) % (SHADE_HORIZON_COUNT - 1);
                  b = made(mdf, detail, brdf, h ? other : SHADE_HORIZON_HARD, lobe);
                  if (jumps(&b, (event)e, 1))
                    continue;
                  shade(&b, &w, form, single, value);
                  judge(&b, &p, widths[k], form, 1, value);
                }
            }
          }
        }
}

/* The diffuse part alone: black where Fresnel is concerned. */
static void diffuse_models(void **state) {
  (void)state;
  const shade_detail details[] = {SHADE_DETAIL_NONE, SHADE_DETAIL_PERTURB, SHADE_DETAIL_ROTATE};
  static window w;
  static double value[POINTS];
  uint64_t seed = 72;
  for (int e = 0; e < EVENTS; e++)
    for (int draw = 0; draw < 2 * DRAWS; draw++) {
      path p = choose(&seed, (event)e);
      for (int k = draw % NARROWER; k < WIDTHS; k += NARROWER) {
        fill(&w, &p, widths[k]);
        for (int model = 0; model < SHADE_DIFFUSE_COUNT; model++)
          for (int horizon = 0; horizon < SHADE_HORIZON_COUNT; horizon++)
            for (int d = 0; d < 3; d++)
              for (form form = DOUBLE; form < FORMS; form++) {
                shade_params params;
                shade_params_init(&params);
                params.detail = details[d];
                params.groove = draw & 1 ? SHADE_GROOVE_X : SHADE_GROOVE_Y;
                params.horizon = (shade_horizon)horizon;
                params.diffuse = (shade_diffuse)model;
                params.fresnel = SHADE_FRESNEL_NONE;
                for (int c = 0; c < 3; c++)
                  params.f0[c] = 0, params.kd[c] = 0.8;
                shade_bsdf b;
                assert_int_equal(shade_bsdf_setup(&b, &params), SHADE_OK);
                bsdf_in(&b)->numbers.peak = 0; /* nothing of D here: the largest value is Phi's */
                shade(&b, &w, form, (draw + k) % 8 == 0, value);
                judge(&b, &p, widths[k], form, 1, value);
              }
      }
    }
}

/* Phi, of either precision, in the fibre's frame. */
static double phi_of(int model, const double l[3], const double v[3], form form) {
  const float lf[3] = {(float)l[0], (float)l[1], (float)l[2]};
  const float vf[3] = {(float)v[0], (float)v[1], (float)v[2]};
  return form == DOUBLE ? shade_diffuse_eval((shade_diffuse)model, l, v)
                        : (double)shade_diffuse_evalf((shade_diffuse)model, lf, vf);
}

/*
 * Phi along paths in the fibre's frame: l through the fibre's own direction, at the horizon,
 * where the step of n.l = 0 shrinks to nothing; across the plane at right angles to it; across
 * that of the normal; past v, where the lower one of the two changes.
 */
static void phi_paths(void **state) {
  (void)state;
  static double value[POINTS];
  uint64_t seed = 73;
  for (int kind = 0; kind < 5; kind++)
    for (int draw = 0; draw < 20 * DRAWS; draw++) {
      double a[3], v[3], up = 2 * uniform(&seed), side = 2 * uniform(&seed) - 1;
      within(&seed, 0.1, 1.2, a);
      within(&seed, 0.1, 1.2, v);
      for (int model = 0; model < SHADE_DIFFUSE_COUNT; model++)
        for (int k = 0; k < WIDTHS; k++)
          for (form form = DOUBLE; form < FORMS; form++) {
            for (int i = 0; i < POINTS; i++) {
              double s = widths[k] * (2 * i - STEPS) / STEPS;
              double l[3] = {a[0], a[1], a[2]}, eye[3] = {v[0], v[1], v[2]};
              if (kind == 0) /* l || t */
                l[0] = 1, l[1] = side * s, l[2] = up * s;
              else if (kind == 1) /* ... from both sides, above the horizon */
                l[0] = -1, l[1] = side * s, l[2] = up * fabs(s);
              else if (kind == 2) /* l _|_ t */
                l[0] = s;
              else if (kind == 3) /* l in the plane of t and n */
                l[1] = s;
              else /* as high as v, on the same side */
                l[1] = l[2] * v[1] / v[2] + s;
              unit(l);
              value[i] = phi_of(model, l, eye, form);
            }
            double seen = jump(value, noise[form], 1e10); /* of 1: Phi's own size */
            if (seen > 0)
              fail_msg("Phi of %s jumps by %g on path %d, window %g, %s",
                       shade_list_word(SHADE_LIST_DIFFUSE, model), seen, kind, widths[k],
                       form_names[form]);
          }
    }
}

/* ---- what does jump, and by how much ---- */

static double carried(shade_mdf mdf, shade_detail detail, shade_groove groove, double ex, double ey,
                      const double n_in[3], const double h_in[3]) {
  double n[3] = {n_in[0], n_in[1], n_in[2]}, h[3] = {h_in[0], h_in[1], h_in[2]};
  unit(n);
  unit(h);
  shade_bsdf b = make_lobe(mdf, detail, groove, ex, ey);
  unsigned status = SHADE_OK;
  double d = shade_mdf_eval(&b, n, h, &status);
  assert_int_equal(status, SHADE_OK);
  return d;
}

#define assert_ratio(a, b, want) assert_near((a) / (b), want, 1e-4 * (want))

/* perturb at h = z: the azimuth's exponent is ex on one way there, ey on the other. */
static void jump_of_perturb(void **state) {
  (void)state;
  const double n[3] = {0.48, 0, sqrt(1 - 0.48 * 0.48)}, step = 1e-7;
  const double x[3] = {0, step, 1}, y[3] = {step, 0, 1};
  const shade_detail perturb = SHADE_DETAIL_PERTURB;
  double by_y = carried(0, perturb, 0, 30, 10, n, x), by_x = carried(0, perturb, 0, 30, 10, n, y);
  assert_ratio(by_x, by_y, pow(n[2], 20));
  /* Ward: a = sqrt(2/(e + 2)), so that e/2 + 1 stands before tan^2 */
  by_y = carried(SHADE_MDF_WARD, perturb, 0, 30, 10, n, x);
  by_x = carried(SHADE_MDF_WARD, perturb, 0, 30, 10, n, y);
  assert_ratio(by_x, by_y, exp(-10 * (1 / (n[2] * n[2]) - 1)));
  /* Smith's Lambda with it, and with the warps, at wi = z */
  const shade_detail shadowed[] = {perturb, SHADE_DETAIL_DEFORM_LINEAR, SHADE_DETAIL_DEFORM_SMOOTH};
  for (int k = 0; k < 3; k++) {
    shade_bsdf b = make_lobe(SHADE_MDF_GGX, shadowed[k], 0, 30, 0.1);
    bsdf_in(&b)->brdf = SHADE_BRDF_MICROFACET;
    const double wo[3] = {0.6, 0, 0.8};
    double f[2][3];
    shade_bsdf_eval(&b, n, x, wo, f[0], NULL);
    shade_bsdf_eval(&b, n, y, wo, f[1], NULL);
    assert_true(fabs(f[0][0] / f[1][0] - 1) > 0.01);
  }
}

/* The conserving warps at h = n, from the rim's side and from the other. */
static void jump_of_conserving_warps(void **state) {
  (void)state;
  const double r = 0.6, n[3] = {r, 0, 0.8}, step = 1e-7;
  const double to_rim[3] = {r + step, 0, sqrt(1 - (r + step) * (r + step))};
  const double inside[3] = {r - step, 0, sqrt(1 - (r - step) * (r - step))};
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int smooth = 0; smooth < 2; smooth++) {
      shade_detail detail =
          smooth ? SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING : SHADE_DETAIL_DEFORM_LINEAR_CONSERVING;
      double a = carried((shade_mdf)mdf, detail, 0, 30, 10, n, to_rim);
      double b = carried((shade_mdf)mdf, detail, 0, 30, 10, n, inside);
      assert_ratio(a, b,
                   smooth ? (1 - r / 2) / (1 - r) * (1 + r) / (1 + r / 2) : (1 + r) / (1 - r));
    }
}

/* GGX and ward_half are not 0 at the carried horizon, and 0 beyond it; the others vanish. */
static void jump_at_the_carried_horizon(void **state) {
  (void)state;
  const double n[3] = {-0.6, 0, 0.8}, e = 6, alpha2 = 2 / (e + 2), step = 1e-6;
  const double above[3] = {0.8, step, 0.6 + step}, below[3] = {0.8, step, 0.6 - step};
  const double want[SHADE_MDF_COUNT] = {
      [SHADE_MDF_WARD_HALF] = exp(-2 / alpha2), [SHADE_MDF_GGX] = alpha2 * alpha2};
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++) {
    double peak = carried((shade_mdf)mdf, SHADE_DETAIL_ROTATE, 0, e, e, n, n);
    double d = carried((shade_mdf)mdf, SHADE_DETAIL_ROTATE, 0, e, e, n, above);
    assert_near(d / peak, want[mdf], 1e-4 * want[mdf] + 1e-12);
    assert_true(carried((shade_mdf)mdf, SHADE_DETAIL_ROTATE, 0, e, e, n, below) == 0);
  }
}

/* L -> 0: the grooves turn with the way by which n comes to their cross direction. */
static void jump_where_transport_ends(void **state) {
  (void)state;
  const struct {
    shade_detail detail;
    shade_groove groove;
    int axis; /* what n comes to */
  } ends[] = {{SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, 1},
              {SHADE_DETAIL_ROTATE, SHADE_GROOVE_Y, 0},
              {SHADE_DETAIL_ROTATE_APPROXIMATE, SHADE_GROOVE_X, 1},
              {SHADE_DETAIL_GRAM_SCHMIDT, SHADE_GROOVE_X, 0}};
  for (int k = 0; k < 4; k++) {
    int end = ends[k].axis, free = !end;
    double side[3] = {0, 0, 1e-12}, up[3] = {0, 0, 1e-6}, h[3] = {0, 0, 0.3};
    side[free] = 1e-6;
    side[end] = up[end] = h[end] = 1;
    h[free] = 0.1;
    double from_side = carried(0, ends[k].detail, ends[k].groove, 40, 10, side, h);
    double from_above = carried(0, ends[k].detail, ends[k].groove, 40, 10, up, h);
    /* across the grooves' plane e is 40 or 10 for the larger of the two parts of h */
    double e = (40 * 0.01 + 10 * 0.09) / 0.1, turned = (40 * 0.09 + 10 * 0.01) / 0.1;
    double want = pow(sqrt(1.1), turned - e); /* cos = 1/sqrt(1.1) */
    if (ends[k].detail == SHADE_DETAIL_GRAM_SCHMIDT || ends[k].groove == SHADE_GROOVE_Y)
      want = 1 / want; /* there the narrow axis is the one that turns last */
    assert_true(from_side > 0 && from_above > 0);
    assert_ratio(from_above, from_side, want);
  }
}

/* The step of the fibre models at n.l = 0, and what fibre_view has at n.v = 0 and v || t. */
static void jumps_of_fibres(void **state) {
  (void)state;
  const double tiny = 1e-9, n[3] = {0, 0, 1}, l[3] = {0.6, 0.8, tiny};
  for (form form = DOUBLE; form < FORMS; form++) {
    assert_near(phi_of(SHADE_DIFFUSE_MAX_NORMAL, l, n, form), 0.8, 1e-6);
    assert_near(phi_of(SHADE_DIFFUSE_FIBRE, l, n, form), 0.8 / PI, 1e-6);
    assert_near(phi_of(SHADE_DIFFUSE_FIBRE_VIEW, l, n, form), 0.2, 1e-6);
    /* the others vanish there, and all beyond */
    assert_near(phi_of(SHADE_DIFFUSE_LAMBERT, l, n, form), 0, 1e-6);
    assert_near(phi_of(SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY, l, n, form), 0, 1e-6);
    const double under[3] = {0.6, 0.8, -tiny};
    for (int model = 0; model < SHADE_DIFFUSE_COUNT; model++)
      assert_true(phi_of(model, under, n, form) == 0);
    const double low[3] = {0, 1, tiny};
    assert_near(phi_of(SHADE_DIFFUSE_FIBRE_VIEW, n, low, form), 0.5, 1e-6);
    assert_near(phi_of(SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY, n, low, form), 0, 1e-6);
    const double light[3] = {0, 0.6, 0.8}, angle = asin(0.6);
    const double left[3] = {1, tiny, tiny * 1e-3}, right[3] = {1, -tiny, tiny * 1e-3};
    assert_near(phi_of(SHADE_DIFFUSE_FIBRE_VIEW, light, left, form), (PI / 2 * 0.6 + 0.8) / 2,
                1e-3);
    assert_near(phi_of(SHADE_DIFFUSE_FIBRE_VIEW, light, right, form),
                ((PI / 2 - angle) * -0.6 + 0.8) / 2, 1e-3);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distributions_and_brdfs),
      cmocka_unit_test(diffuse_models),
      cmocka_unit_test(phi_paths),
      cmocka_unit_test(jump_of_perturb),
      cmocka_unit_test(jump_of_conserving_warps),
      cmocka_unit_test(jump_at_the_carried_horizon),
      cmocka_unit_test(jump_where_transport_ends),
      cmocka_unit_test(jumps_of_fibres),
  };
  return cmocka_run_group_tests_name("continuity", tests, NULL, NULL);
}
