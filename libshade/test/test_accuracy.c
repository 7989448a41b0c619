/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Every distribution and instruction set against the reference, at the bounds that a row's traits
 * (kernel/mdf.h) and kernel/leaf_detail.h state: D > 1e-12 of the peak, z >= 0.05, tilts to 89.9
 * degrees; for the warps |p|^2 <= 0.75 and tilts to 75 degrees. Float is compared on the same
 * float inputs.
 */
#include <string.h>

#include "support.h"
#include "kernel/mdf.h"

enum { COUNT = 1024, CASES = 20 };

typedef struct lanes {
  double nx[COUNT], ny[COUNT], nz[COUNT], hx[COUNT], hy[COUNT], hz[COUNT], d[COUNT];
  float fnx[COUNT], fny[COUNT], fnz[COUNT], fhx[COUNT], fhy[COUNT], fhz[COUNT], fd[COUNT];
} lanes;
static lanes l;

/* Half vectors at angles where the lobe is between its peak and 1e-12 of it. */
static void fill(uint64_t *seed, shade_mdf mdf, double tilt, double ex, double ey) {
  for (int i = 0; i < COUNT; i++) {
    double n[3], axis[3], h[3];
    spherical(tilt * PI / 180 * uniform(seed), 2 * PI * uniform(seed), n);
    double e =
        exp(log(fmin(ex, ey) + 1) + uniform(seed) * log((fmax(ex, ey) + 1) / (fmin(ex, ey) + 1)));
    double reach = sqrt(2 * 27.6 / (e + 2)) * uniform(seed);
    if (shade_mdf_is(mdf).tails) /* they have no such end */
      reach /= 1e-3 + uniform(seed);
    spherical(acos(2 * uniform(seed) - 1), 2 * PI * uniform(seed), axis);
    double length = 0;
    for (int c = 0; c < 3; c++) {
      h[c] = n[c] + reach * axis[c];
      length += h[c] * h[c];
    }
    for (int c = 0; c < 3; c++)
      h[c] /= sqrt(length);
    l.nx[i] = n[0], l.ny[i] = n[1], l.nz[i] = n[2];
    l.hx[i] = h[0], l.hy[i] = h[1], l.hz[i] = h[2];
    l.fnx[i] = (float)n[0], l.fny[i] = (float)n[1], l.fnz[i] = (float)n[2];
    l.fhx[i] = (float)h[0], l.fhy[i] = (float)h[1], l.fhz[i] = (float)h[2];
  }
}

typedef enum form { DOUBLE, FLOAT, FAST } form;

static double worst_error(const shade_isa_table *isa, shade_mdf mdf, shade_detail detail, double ex,
                          double ey, form form, uint64_t *seed) {
  const int single = form != DOUBLE;
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, ex, ey);
  p.mdf = mdf;
  p.fast = form == FAST;
  p.detail = detail;
  p.groove = (shade_groove)(uniform(seed) * 3);
  shade_bsdf b;
  shade_bsdf_setup(&b, &p);
  fill(seed, mdf, is_warp(detail) ? 75 : 89.9, ex, ey);
  if (single)
    isa->mdf_batchf(&b, COUNT, l.fnx, l.fny, l.fnz, l.fhx, l.fhy, l.fhz, l.fd);
  else
    isa->mdf_batch(&b, COUNT, l.nx, l.ny, l.nz, l.hx, l.hy, l.hz, l.d);
  double worst = 0;
  int used = 0;
  for (int i = 0; i < COUNT; i++) {
    double n[3] = {l.nx[i], l.ny[i], l.nz[i]}, h[3] = {l.hx[i], l.hy[i], l.hz[i]};
    if (single) {
      n[0] = (double)l.fnx[i], n[1] = (double)l.fny[i], n[2] = (double)l.fnz[i];
      h[0] = (double)l.fhx[i], h[1] = (double)l.fhy[i], h[2] = (double)l.fhz[i];
    }
    double want = shade_ref_mdf(&p, n, h), got = single ? (double)l.fd[i] : l.d[i];
    double m[3];
    shade_ref_carried(&p, n, h, m);
    if (want <= 1e-12 * bsdf_of(&b)->peak || m[2] < (is_warp(detail) ? 0.5 : 0.05))
      continue;
    used++;
    worst = fmax(worst, fabs(got / want - 1));
  }
  /* the unmoved lobe is seldom where h is; the others nearly always */
  assert_true(used > (detail == SHADE_DETAIL_NONE ? 10 : COUNT / 4));
  return worst;
}

static void bounds(void **state) {
  (void)state;
  static const struct {
    const char *what;
    form form;
    double largest;
    size_t own;   /* the trait that holds the bound; with 0, `bound` does */
    double bound; /* of the warps, or of both */
  } ranges[] = {
      {"double, exponents to 1e4", DOUBLE, 1e4, offsetof(shade_mdf_traits, double_1e4), 1e-12},
      {"float, exponents to 1e3", FLOAT, 1e3, offsetof(shade_mdf_traits, float_1e3), 1e-4},
      {"float, exponents to 1e5", FLOAT, 1e5, offsetof(shade_mdf_traits, float_1e5), 3e-4},
      /* fast: Ashikhmin-Shirley alone differs from float */
      {"fast, exponents to 1e3", FAST, 1e3, 0, 2e-4},
      {"fast, exponents to 1e5", FAST, 1e5, 0, 2e-2}};
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (size_t r = 0; r < sizeof ranges / sizeof ranges[0]; r++) {
      print_message("%s, %s\n", isa->name, ranges[r].what);
      for (int d = 0; d < SHADE_DETAIL_COUNT; d++) {
        print_message("  %-18s", shade_list_word(SHADE_LIST_DETAIL, d));
        for (int m = 0; m < (ranges[r].form == FAST ? 1 : SHADE_MDF_COUNT); m++) {
          uint64_t seed = 7;
          double worst = 0, low = ranges[r].largest / 20;
          for (int k = 0; k < CASES; k++) {
            double e1 = ranges[r].largest * pow(10, -3 * uniform(&seed));
            double e2 = k % 3 ? e1 * pow(10, -3 * uniform(&seed)) : low * uniform(&seed);
            worst = fmax(worst, worst_error(isa, (shade_mdf)m, (shade_detail)d, k & 1 ? e1 : e2,
                                            k & 1 ? e2 : e1, ranges[r].form, &seed));
          }
          const shade_mdf_traits is = shade_mdf_is((shade_mdf)m);
          double bound = ranges[r].bound;
          if (ranges[r].own && !is_warp((shade_detail)d))
            memcpy(&bound, (const char *)&is + ranges[r].own, sizeof bound);
          print_message(" %s %.1e (%.0e)", shade_list_word(SHADE_LIST_MDF, m), worst, bound);
          assert_true(worst <= bound);
        }
        print_message("\n");
      }
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bounds)};
  return cmocka_run_group_tests_name("accuracy", tests, NULL, NULL);
}
