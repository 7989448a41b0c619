/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/*
 * Parameters of each sample that are no numbers, or out of their range: the nearest value, or the
 * material's own, and a status that tells; in both precisions and every instruction set.
 */
#include <string.h>

#include "support.h"

/* A parameter of a lane, its range, and what reads it. */
typedef struct parameter {
  size_t lane, lanef, member; /* places in shade_lanes, shade_lanesf, shade_params */
  double low, high;
  shade_mdf mdf;
  shade_fresnel fresnel;
} parameter;
#define PARAMETER(name, member, low, high, mdf, fresnel)                                           \
  {                                                                                                \
    offsetof(shade_lanes, name), offsetof(shade_lanesf, name), offsetof(shade_params, member),     \
        low, high, mdf, fresnel                                                                    \
  }
#define COLOUR(name, low, high, fresnel)                                                           \
  PARAMETER(name##r, name[0], low, high, SHADE_MDF_GGX, fresnel),                                  \
      PARAMETER(name##g, name[1], low, high, SHADE_MDF_WARD, fresnel),                             \
      PARAMETER(name##b, name[2], low, high, SHADE_MDF_BECKMANN, fresnel)
static const parameter parameters_of_lanes[] = {
    PARAMETER(ax, ax, 1e-4, 10, SHADE_MDF_GGX, SHADE_FRESNEL_SCHLICK),
    PARAMETER(ay, ay, 1e-4, 10, SHADE_MDF_BECKMANN, SHADE_FRESNEL_NONE),
    PARAMETER(ex, ex, 0, 1e6, SHADE_MDF_ASHIKHMIN_SHIRLEY, SHADE_FRESNEL_SCHLICK),
    PARAMETER(ey, ey, 0, 1e6, SHADE_MDF_ASHIKHMIN_SHIRLEY, SHADE_FRESNEL_F82),
    COLOUR(f0, 0, 1, SHADE_FRESNEL_SCHLICK),
    COLOUR(f82, 0, 1, SHADE_FRESNEL_F82),
    COLOUR(eta, 1e-3, 100, SHADE_FRESNEL_CONDUCTOR),
    COLOUR(k, 0, 100, SHADE_FRESNEL_CONDUCTOR),
    COLOUR(kd, 0, 1, SHADE_FRESNEL_SCHLICK)};
enum { PARAMETERS = sizeof parameters_of_lanes / sizeof parameters_of_lanes[0] };

static const double odd_numbers[] = {-1,        0,    -0.0, 1e-310, 1e-40, 1e-5,    0.5, 1,
                                     1.0000001, 50,   2e6,  1e30,   1e300, -1e300,  NAN, INFINITY,
                                     -INFINITY, 1e-3, 10,   100,    1e6,   0x1p-140};
enum { ODD = sizeof odd_numbers / sizeof odd_numbers[0] };

/* One sample that all lanes shade. */
static const double sample[9] = {0.1, 0.2, 0.974679434480896, 0.28, 0, 0.96, 0, 0.6, 0.8};

typedef struct odd_lanes {
  double v[9][ODD], given[2][ODD], rgb[4][ODD], pdf[ODD];
  float vf[9][ODD], givenf[2][ODD], rgbf[4][ODD], pdff[ODD];
} odd_lanes;

static float as_float(double x) { /* without an overflow where it is finite */
  return (float)(isfinite(x) ? fmin(fmax(x, -3e38), 3e38) : x);
}

#define ODD_CALL(real, f)                                                                          \
  static unsigned shade_odd##f(const shade_isa_table *isa, const shade_bsdf *b, size_t count,      \
                               size_t first, size_t where, size_t other, odd_lanes *o) {           \
    shade_lanes##f in = {.size = sizeof in, SHADE_DIRECTIONS(o->v##f)};                            \
    const real *const one = o->given##f[0] + first, *const two = o->given##f[1] + first;           \
    memcpy((char *)&in + where, &one, sizeof one);                                                 \
    if (other)                                                                                     \
      memcpy((char *)&in + other, &two, sizeof two);                                               \
    const shade_result##f out = {sizeof out, o->rgb##f[0] + first, o->rgb##f[1] + first,           \
                                 o->rgb##f[2] + first, o->rgb##f[3] + first};                      \
    const unsigned status = isa->entries##f->pdf_batch(b, count, &in, o->pdf##f + first);          \
    assert_int_equal(isa->entries##f->bsdf_batch(b, count, &in, &out), status);                    \
    return status;                                                                                 \
  }
ODD_CALL(double, )
ODD_CALL(float, f)

/* f and density of lane i, of either precision. */
static void odd_result(const odd_lanes *o, int single, int i, double to[4]) {
  for (int c = 0; c < 3; c++)
    to[c] = single ? (double)o->rgbf[c][i] : o->rgb[c][i];
  to[3] = single ? (double)o->pdff[i] : o->pdf[i];
}

static void material_result(const shade_params *p, double to[4]) {
  shade_bsdf b;
  shade_bsdf_setup(&b, p);
  shade_bsdf_eval(&b, sample, sample + 3, sample + 6, to, NULL);
  to[3] = shade_bsdf_pdf(&b, sample, sample + 3, sample + 6, NULL);
}

/* Array by array: of the other order GCC 12 leaves out the stores at -O1. */
static void fill_odd(odd_lanes *o) {
  for (int c = 0; c < 9; c++)
    for (int i = 0; i < ODD; i++)
      o->vf[c][i] = (float)(o->v[c][i] = sample[c]);
}

/* Lanes one by one, for their status, then all at once. */
static void odd_lanes_are(const shade_isa_table *isa, const shade_bsdf *b, int single, size_t where,
                          size_t other, odd_lanes *o, const double want[ODD][4],
                          const unsigned status[ODD]) {
  /* floats: the sample itself is rounded, and a lobe of alpha 1e-4 would see it */
  const double bound = single ? 2e-4 : 1e-12;
  unsigned all = SHADE_OK;
  for (int pass = 0; pass < 2; pass++) {
    memset(o->rgb, 0xff, sizeof o->rgb);
    memset(o->rgbf, 0xff, sizeof o->rgbf);
    for (size_t i = 0; i < (pass ? 1 : ODD); i++) {
      const unsigned got =
          (single ? shade_oddf : shade_odd)(isa, b, pass ? ODD : 1, i, where, other, o);
      if (got != (pass ? all : status[i]))
        fail_msg("%s: status %u for %g", isa->name, got, o->given[0][i]);
      all |= got;
    }
    for (int i = 0; i < ODD; i++) {
      double got[4];
      odd_result(o, single, i, got);
      for (int c = 0; c < 4; c++)
        if (!(fabs(got[c] - want[i][c]) <= bound * (want[i][c] + 1)))
          fail_msg("%s, %s, %g: %g for %g", isa->name, single ? "float" : "double", o->given[0][i],
                   got[c], want[i][c]);
    }
  }
}

/* Out of range is clamped, NaN the material's own, and the status tells, lane by lane. */
static void out_of_range(void **state) {
  (void)state;
  static odd_lanes o;
  fill_odd(&o);
  const shade_isa_table *isa;
  for (int k = 0; k < PARAMETERS; k++) {
    const parameter *const is = &parameters_of_lanes[k];
    shade_params p;
    shade_bsdf b;
    shade_params_init(&p);
    p.mdf = is->mdf;
    p.fresnel = is->fresnel;
    shade_params_set_alphas(&p, 0.3, 0.2);
    p.groove = SHADE_GROOVE_X;
    p.kd[0] = 0.25;
    assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
    for (int single = 0; single < 2; single++) {
      double want[ODD][4];
      unsigned status[ODD];
      for (int i = 0; i < ODD; i++) {
        o.givenf[0][i] = as_float(odd_numbers[i]);
        o.given[0][i] = single ? (double)o.givenf[0][i] : odd_numbers[i];
        const double x = o.given[0][i];
        shade_params q = p;
        double *const member = (double *)(void *)((char *)&q + is->member);
        *member = isnan(x) ? *member : fmin(fmax(x, is->low), is->high);
        const double nearest = single ? (double)(float)*member : *member;
        status[i] = nearest == x ? SHADE_OK : SHADE_CLAMPED_PARAMETER;
        material_result(&q, want[i]);
      }
      for (int row = 0; (isa = shade_isa_pick(row)); row++)
        odd_lanes_are(isa, &b, single, single ? is->lanef : is->lane, 0, &o, want, status);
    }
  }
}

/*
 * Both alphas given, which are read where they are unless one has to be mended: by the fused loop
 * and the density of visible normals, and by neither. Also at the ends of what one look at their
 * bits tells.
 */
static void odd_alphas(void **state) {
  (void)state;
  static odd_lanes o;
  fill_odd(&o);
  static const double alphas[ODD] = {
      1e-4, 9.9e-5, 0x1.fffffep-14, 0x1p-13,   1.3e-4, 0.3,  7.99999, 8,  8.00001, 9.9, 10, 10.1, 0,
      -0.3, NAN,    INFINITY,       -INFINITY, 1e-40,  1e30, 0.5,     -8, 1e-300};
  static const double others[] = {0.2, 1.1e-4, 9, NAN, -1};
  static const shade_mdf mdfs[] = {SHADE_MDF_GGX, SHADE_MDF_BECKMANN, SHADE_MDF_WARD};
  static const shade_detail details[] = {SHADE_DETAIL_NONE, SHADE_DETAIL_ROTATE,
                                         SHADE_DETAIL_PERTURB};
  const shade_isa_table *isa;
  for (size_t m = 0; m < 3; m++)
    for (size_t d = 0; d < 3; d++)
      for (size_t k = 0; k < sizeof others / sizeof others[0]; k++) {
        shade_params p;
        shade_bsdf b;
        shade_params_init(&p);
        p.mdf = mdfs[m];
        p.brdf = m == 2 ? SHADE_BRDF_WARD_BOUNDED : SHADE_BRDF_MICROFACET;
        p.detail = details[d];
        shade_params_set_alphas(&p, 0.3, 0.2);
        p.groove = SHADE_GROOVE_X;
        assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
        for (int single = 0; single < 2; single++) {
          double want[ODD][4];
          unsigned status[ODD];
          for (int i = 0; i < ODD; i++) {
            shade_params q = p;
            double *const members[2] = {&q.ax, &q.ay};
            const double given[2] = {alphas[i], others[k]};
            status[i] = SHADE_OK;
            for (int c = 0; c < 2; c++) {
              o.givenf[c][i] = as_float(given[c]);
              o.given[c][i] = single ? (double)o.givenf[c][i] : given[c];
              const double x = o.given[c][i], low = single ? (double)1e-4f : 1e-4;
              *members[c] = isnan(x) ? *members[c] : fmin(fmax(x, low), 10);
              if (!(x >= low && x <= 10))
                status[i] = SHADE_CLAMPED_PARAMETER;
            }
            material_result(&q, want[i]);
          }
          for (int row = 0; (isa = shade_isa_pick(row)); row++)
            odd_lanes_are(
                isa, &b, single, single ? offsetof(shade_lanesf, ax) : offsetof(shade_lanes, ax),
                single ? offsetof(shade_lanesf, ay) : offsetof(shade_lanes, ay), &o, want, status);
        }
      }
}

/* A groove of any length but 0 counts; what is not a direction is the material's own. */
static void odd_grooves(void **state) {
  (void)state;
  static odd_lanes o;
  fill_odd(&o);
  static const double across[] = {1, 0, 1e-5, 1e300, -3, 1e-300};
  shade_params p;
  shade_bsdf b;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_GGX;
  shade_params_set_alphas(&p, 0.3, 0.2);
  p.groove = SHADE_GROOVE_X;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  const shade_isa_table *isa;
  for (int single = 0; single < 2; single++)
    for (size_t k = 0; k < sizeof across / sizeof across[0]; k++) {
      double want[ODD][4];
      unsigned status[ODD];
      const double least = single ? 0x1p-126 : 0x1p-1022;
      for (int i = 0; i < ODD; i++) {
        o.givenf[0][i] = as_float(odd_numbers[i]);
        o.givenf[1][i] = as_float(across[k]);
        o.given[0][i] = single ? (double)o.givenf[0][i] : odd_numbers[i];
        o.given[1][i] = single ? (double)o.givenf[1][i] : across[k];
        double x = o.given[0][i], y = o.given[1][i];
        status[i] =
            isfinite(x) && fmax(fabs(x), fabs(y)) >= least ? SHADE_OK : SHADE_CLAMPED_PARAMETER;
        if (status[i])
          x = 1, y = 0;
        double v[9];
        for (int d = 0; d < 9; d += 3)
          shade_ref_turned(atan2(y, x), sample + d, v + d);
        shade_bsdf_eval(&b, v, v + 3, v + 6, want[i], NULL);
        want[i][3] = shade_bsdf_pdf(&b, v, v + 3, v + 6, NULL);
      }
      for (int row = 0; (isa = shade_isa_pick(row)); row++)
        odd_lanes_are(isa, &b, single,
                      single ? offsetof(shade_lanesf, groove_x) : offsetof(shade_lanes, groove_x),
                      single ? offsetof(shade_lanesf, groove_y) : offsetof(shade_lanes, groove_y),
                      &o, want, status);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(out_of_range), cmocka_unit_test(odd_alphas),
                                     cmocka_unit_test(odd_grooves)};
  return cmocka_run_group_tests_name("varied_range", tests, NULL, NULL);
}
