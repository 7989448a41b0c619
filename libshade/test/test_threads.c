/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.4 */
/*
 * Several threads share one material and its inputs, and all of them get what one thread gets,
 * bit by bit. `make check-libshade` builds this with ThreadSanitizer too.
 */
#include <pthread.h>
#include <string.h>

#include "support.h"

enum { THREADS = 4, LANES = 300, ROUNDS = 8 };

static shade_bsdf metal;
static double in[9][LANES];
static float inf[9][LANES];

typedef struct results {
  pthread_t thread;
  double d[LANES], f[4][LANES], pdf[LANES], drawn[8][LANES], one[8];
  float df[LANES], ff[4][LANES], pdff[LANES], drawnf[8][LANES], onef[8];
  unsigned status;
} results;

#define EVALUATE(real, f_)                                                                         \
  static void evaluate##f_(results *r, size_t i) {                                                 \
    real v[9];                                                                                     \
    const real u[2] = {(real).25, (real).75};                                                      \
    for (int c = 0; c < 9; c++)                                                                    \
      v[c] = in##f_[c][i];                                                                         \
    const shade_lanes##f_ lanes = {.size = sizeof lanes, SHADE_DIRECTIONS(in##f_)};                \
    const shade_result##f_ result = {sizeof result, r->f##f_[0], r->f##f_[1], r->f##f_[2],         \
                                     r->f##f_[3]};                                                 \
    const shade_sample_lanes##f_ draw = {.size = sizeof draw,                                      \
                                         .nx = in##f_[0],                                          \
                                         .ny = in##f_[1],                                          \
                                         .nz = in##f_[2],                                          \
                                         .wox = in##f_[6],                                         \
                                         .woy = in##f_[7],                                         \
                                         .woz = in##f_[8],                                         \
                                         .u1 = in##f_[2],                                          \
                                         .u2 = in##f_[8]};                                         \
    const shade_sample_result##f_ drawn = {sizeof drawn,    r->drawn##f_[0], r->drawn##f_[1],      \
                                           r->drawn##f_[2], r->drawn##f_[3], r->drawn##f_[4],      \
                                           r->drawn##f_[5], r->drawn##f_[6], r->drawn##f_[7]};     \
    r->status |= shade_mdf_eval_batch##f_(&metal, LANES, in##f_[0], in##f_[1], in##f_[2],          \
                                          in##f_[3], in##f_[4], in##f_[5], r->d##f_);              \
    r->status |= shade_bsdf_eval_batch##f_(&metal, LANES, &lanes, &result);                        \
    r->status |= shade_bsdf_pdf_batch##f_(&metal, LANES, &lanes, r->pdf##f_);                      \
    r->status |= shade_bsdf_sample_batch##f_(&metal, LANES, &draw, &drawn);                        \
    real *one = r->one##f_, f[3], pdf;                                                             \
    one[0] += shade_mdf_eval##f_(&metal, v, v + 3, &r->status);                                    \
    one[1] += shade_diffuse_eval##f_(bsdf_of(&metal)->diffuse, v + 3, v + 6);                      \
    one[2] += shade_bsdf_pdf##f_(&metal, v, v + 3, v + 6, &r->status);                             \
    r->status |= shade_bsdf_eval##f_(&metal, v, v + 3, v + 6, f, &pdf);                            \
    one[3] += f[0] + pdf;                                                                          \
    r->status |= shade_bsdf_sample##f_(&metal, v, v + 6, u, v + 3, f, &pdf, NULL);                 \
    one[4] += f[0] + pdf + v[3];                                                                   \
  }
EVALUATE(double, )
EVALUATE(float, f)

static void *work(void *context) {
  results *r = context;
  for (size_t k = 0; k < ROUNDS; k++) {
    evaluate(r, k);
    evaluatef(r, k);
  }
  return NULL;
}

static void threads_share_a_material(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (size_t i = 0; i < LANES; i++)
    for (int v = 0; v < 9; v += 3) {
      double w[3];
      spherical(1.3 * uniform(&seed), 2 * PI * uniform(&seed), w);
      for (int c = 0; c < 3; c++)
        inf[v + c][i] = (float)(in[v + c][i] = w[c]);
    }
  inf[2][7] = -inf[2][7]; /* the mending path too */
  in[2][7] = -in[2][7];
  results alone, *team = calloc(THREADS, sizeof *team);
  assert_non_null(team);
  for (int k = 0; k < SHADE_MDF_COUNT * SHADE_DETAIL_COUNT; k++) {
    shade_params p;
    shade_params_init(&p);
    p.mdf = (shade_mdf)(k % SHADE_MDF_COUNT);
    p.detail = (shade_detail)(k % SHADE_DETAIL_COUNT);
    p.brdf = (shade_brdf)(k % SHADE_BRDF_COUNT);
    p.diffuse = (shade_diffuse)(k % SHADE_DIFFUSE_COUNT);
    p.horizon = (shade_horizon)(k % SHADE_HORIZON_COUNT);
    p.kd[0] = p.kd[1] = p.kd[2] = k & 1 ? .5 : 0;
    assert_int_equal(shade_bsdf_setup(&metal, &p), SHADE_OK);
    memset(&alone, 0, sizeof alone);
    work(&alone);
    assert_int_equal(alone.status & (SHADE_CLAMPED_NORMAL | SHADE_BAD_INPUT), SHADE_CLAMPED_NORMAL);
    memset(team, 0, THREADS * sizeof *team);
    for (int t = 0; t < THREADS; t++)
      assert_int_equal(pthread_create(&team[t].thread, NULL, work, &team[t]), 0);
    for (int t = 0; t < THREADS; t++) {
      assert_int_equal(pthread_join(team[t].thread, NULL), 0);
      team[t].thread = alone.thread;
      assert_memory_equal(&team[t], &alone, sizeof alone);
    }
  }
  free(team);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(threads_share_a_material)};
  return cmocka_run_group_tests_name("threads", tests, NULL, NULL);
}
