/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/*
 * Structures of arrays from callers built against another header: older ones end earlier, newer
 * ones later, and where something required is missing nothing is written. Every instruction set.
 */
#include <stdint.h>
#include <string.h>

#include "support.h"

enum { COUNT = 5, INPUTS = 9, OUTPUTS = 8 };

static shade_bsdf make_material(void) {
  shade_params p;
  shade_bsdf b;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_GGX;
  p.brdf = SHADE_BRDF_MICROFACET;
  p.f0[0] = p.f0[1] = p.f0[2] = 0.25;
  shade_params_set_alphas(&p, 0.3, 0.5);
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  return b;
}

/* A caller's structure may have any length; `tail` is what a newer header would have added. */
#define STRUCTURES(real, f)                                                                        \
  typedef struct arrays##f {                                                                       \
    real in[INPUTS][COUNT], u[2][COUNT], f0[COUNT], out[OUTPUTS][COUNT];                           \
  } arrays##f;                                                                                     \
  typedef struct newer_lanes##f {                                                                  \
    shade_lanes##f known;                                                                          \
    const real *tail;                                                                              \
  } newer_lanes##f;                                                                                \
  typedef struct newer_draws##f {                                                                  \
    shade_sample_lanes##f known;                                                                   \
    const real *tail;                                                                              \
  } newer_draws##f;                                                                                \
                                                                                                   \
  static void fill##f(arrays##f *a) {                                                              \
    const double v[3][3] = {{0, 0, 1}, {0.6, 0, 0.8}, {-0.28, 0, 0.96}};                           \
    for (int i = 0; i < COUNT; i++) {                                                              \
      for (int k = 0; k < INPUTS; k++)                                                             \
        a->in[k][i] = (real)v[k / 3][k % 3];                                                       \
      a->u[0][i] = (real)0.3, a->u[1][i] = (real)0.7;                                              \
      a->f0[i] = (real)0.5;                                                                        \
      for (int k = 0; k < OUTPUTS; k++)                                                            \
        a->out[k][i] = -1;                                                                         \
    }                                                                                              \
  }                                                                                                \
  static int untouched##f(const arrays##f *a) {                                                    \
    for (int k = 0; k < OUTPUTS; k++)                                                              \
      for (int i = 0; i < COUNT; i++)                                                              \
        if (a->out[k][i] != -1)                                                                    \
          return 0;                                                                                \
    return 1;                                                                                      \
  }                                                                                                \
  static newer_lanes##f lanes_of##f(const arrays##f *a) {                                          \
    newer_lanes##f l = {.known = {.size = sizeof l.known,                                          \
                                  SHADE_DIRECTIONS(a->in),                                         \
                                  .f0r = a->f0,                                                    \
                                  .f0g = a->f0,                                                    \
                                  .f0b = a->f0},                                                   \
                        .tail = (const real *)(intptr_t)1};                                        \
    return l;                                                                                      \
  }                                                                                                \
  static newer_draws##f draws_of##f(const arrays##f *a) {                                          \
    newer_draws##f l = {.known = {.size = sizeof l.known,                                          \
                                  .nx = a->in[0],                                                  \
                                  .ny = a->in[1],                                                  \
                                  .nz = a->in[2],                                                  \
                                  .wox = a->in[6],                                                 \
                                  .woy = a->in[7],                                                 \
                                  .woz = a->in[8],                                                 \
                                  .u1 = a->u[0],                                                   \
                                  .u2 = a->u[1],                                                   \
                                  .f0r = a->f0,                                                    \
                                  .f0g = a->f0,                                                    \
                                  .f0b = a->f0},                                                   \
                        .tail = (const real *)(intptr_t)1};                                        \
    return l;                                                                                      \
  }                                                                                                \
  static shade_result##f result_of##f(arrays##f *a) {                                              \
    shade_result##f r = {sizeof(shade_result##f), a->out[0], a->out[1], a->out[2], a->out[3]};     \
    return r;                                                                                      \
  }                                                                                                \
  static shade_sample_result##f drawn_of##f(arrays##f *a) {                                        \
    shade_sample_result##f r = {sizeof(shade_sample_result##f),                                    \
                                a->out[0],                                                         \
                                a->out[1],                                                         \
                                a->out[2],                                                         \
                                a->out[3],                                                         \
                                a->out[4],                                                         \
                                a->out[5],                                                         \
                                a->out[6],                                                         \
                                a->out[7]};                                                        \
    return r;                                                                                      \
  }                                                                                                \
                                                                                                   \
  /* f0 is read as far as the size says: at .25 and .5 colours differ by Schlick's formula */      \
  static void inputs_end##f(const shade_isa_table *isa) {                                          \
    const shade_bsdf b = make_material();                                                          \
    arrays##f a, own;                                                                              \
    fill##f(&own);                                                                                 \
    newer_lanes##f l = lanes_of##f(&own);                                                          \
    newer_draws##f d = draws_of##f(&own);                                                          \
    shade_result##f r = result_of##f(&own);                                                        \
    shade_sample_result##f s = drawn_of##f(&own);                                                  \
    l.known.f0r = l.known.f0g = l.known.f0b = NULL;                                                \
    assert_int_equal(isa->entries##f->bsdf_batch(&b, COUNT, &l.known, &r), SHADE_OK);              \
    const real plain = own.out[0][0];                                                              \
    assert_true(plain > 0 && own.out[0][COUNT - 1] == plain && own.out[2][0] == plain);            \
    const char *start = (const char *)&l.known;                                                    \
    const size_t first = (size_t)((const char *)&l.known.f0r - start);                             \
    /* an older header: nothing beyond wo. Half a pointer is none */                               \
    for (size_t cut = 0; cut < sizeof(void *); cut++) {                                            \
      fill##f(&a);                                                                                 \
      l = lanes_of##f(&a);                                                                         \
      r = result_of##f(&a);                                                                        \
      l.known.f0r = l.known.f0g = l.known.f0b = (const real *)(intptr_t)1;                         \
      l.known.size = first + cut;                                                                  \
      assert_int_equal(isa->entries##f->bsdf_batch(&b, COUNT, &l.known, &r), SHADE_OK);            \
      assert_true(a.out[0][2] == plain && a.out[1][2] == plain && a.out[2][2] == plain);           \
      assert_int_equal(isa->entries##f->pdf_batch(&b, COUNT, &l.known, a.out[4]), SHADE_OK);       \
      assert_true(a.out[4][COUNT - 1] > 0);                                                        \
    }                                                                                              \
    /* red alone is within the size; then all, and more that this release does not know */         \
    for (int more = 0; more < 2; more++) {                                                         \
      fill##f(&a);                                                                                 \
      l = lanes_of##f(&a);                                                                         \
      r = result_of##f(&a);                                                                        \
      l.known.size = more ? sizeof l : first + sizeof(void *);                                     \
      assert_int_equal(isa->entries##f->bsdf_batch(&b, COUNT, &l.known, &r), SHADE_OK);            \
      assert_true(a.out[0][0] > plain * (real)1.2 && (a.out[2][0] == plain) == !more);             \
    }                                                                                              \
    /* draws: the colour of f alone depends on f0 */                                               \
    d.known.f0r = d.known.f0g = d.known.f0b = NULL;                                                \
    assert_int_equal(isa->entries##f->sample_batch(&b, COUNT, &d.known, &s), SHADE_OK);            \
    const real drawn = own.out[3][0];                                                              \
    assert_true(drawn > 0 && own.out[6][0] > 0 && own.out[2][0] > 0);                              \
    const size_t end = (size_t)((const char *)&d.known.f0r - (const char *)&d.known);              \
    for (int more = 0; more < 2; more++) {                                                         \
      fill##f(&a);                                                                                 \
      d = draws_of##f(&a);                                                                         \
      s = drawn_of##f(&a);                                                                         \
      d.known.size = more ? sizeof d : end;                                                        \
      assert_int_equal(isa->entries##f->sample_batch(&b, COUNT, &d.known, &s), SHADE_OK);          \
      assert_true(a.out[2][0] == own.out[2][0] && a.out[6][0] == own.out[6][0]);                   \
      assert_true((a.out[3][0] == drawn) == !more && (a.out[5][0] == drawn) == !more);             \
    }                                                                                              \
  }                                                                                                \
                                                                                                   \
  /* every size that leaves out something required, and every such array that is NULL */           \
  static void required##f(const shade_isa_table *isa) {                                            \
    const shade_bsdf b = make_material();                                                          \
    arrays##f a;                                                                                   \
    fill##f(&a);                                                                                   \
    for (size_t lost = 0; lost <= INPUTS; lost++) {                                                \
      newer_lanes##f l = lanes_of##f(&a);                                                          \
      newer_draws##f d = draws_of##f(&a);                                                          \
      shade_result##f r = result_of##f(&a);                                                        \
      shade_sample_result##f s = drawn_of##f(&a);                                                  \
      const size_t size = lost * sizeof(void *) + sizeof(size_t) - 1;                              \
      l.known.size = size;                                                                         \
      assert_int_equal(isa->entries##f->bsdf_batch(&b, COUNT, &l.known, &r), SHADE_BAD_INPUT);     \
      assert_int_equal(isa->entries##f->pdf_batch(&b, COUNT, &l.known, a.out[0]),                  \
                       SHADE_BAD_INPUT);                                                           \
      l = lanes_of##f(&a);                                                                         \
      if (lost <= OUTPUTS) {                                                                       \
        d.known.size = size;                                                                       \
        assert_int_equal(isa->entries##f->sample_batch(&b, COUNT, &d.known, &s), SHADE_BAD_INPUT); \
        d = draws_of##f(&a);                                                                       \
        s.size = size;                                                                             \
        assert_int_equal(isa->entries##f->sample_batch(&b, COUNT, &d.known, &s), SHADE_BAD_INPUT); \
        s = drawn_of##f(&a);                                                                       \
      }                                                                                            \
      if (lost <= 4) {                                                                             \
        r.size = size;                                                                             \
        assert_int_equal(isa->entries##f->bsdf_batch(&b, COUNT, &l.known, &r), SHADE_BAD_INPUT);   \
        r = result_of##f(&a);                                                                      \
      }                                                                                            \
      if (!lost)                                                                                   \
        continue;                                                                                  \
      const void *null = NULL;                                                                     \
      const size_t at = sizeof(size_t) + (lost - 1) * sizeof null;                                 \
      memcpy((char *)&l + at, &null, sizeof null);                                                 \
      assert_int_equal(isa->entries##f->bsdf_batch(&b, COUNT, &l.known, &r), SHADE_BAD_INPUT);     \
      assert_int_equal(isa->entries##f->pdf_batch(&b, COUNT, &l.known, a.out[0]),                  \
                       SHADE_BAD_INPUT);                                                           \
      l = lanes_of##f(&a);                                                                         \
      if (lost <= OUTPUTS) {                                                                       \
        memcpy((char *)&d + at, &null, sizeof null);                                               \
        assert_int_equal(isa->entries##f->sample_batch(&b, COUNT, &d.known, &s), SHADE_BAD_INPUT); \
        d = draws_of##f(&a);                                                                       \
        memcpy((char *)&s + at, &null, sizeof null);                                               \
        assert_int_equal(isa->entries##f->sample_batch(&b, COUNT, &d.known, &s), SHADE_BAD_INPUT); \
      }                                                                                            \
      if (lost <= 4) {                                                                             \
        memcpy((char *)&r + at, &null, sizeof null);                                               \
        assert_int_equal(isa->entries##f->bsdf_batch(&b, COUNT, &l.known, &r), SHADE_BAD_INPUT);   \
      }                                                                                            \
    }                                                                                              \
    const newer_lanes##f l = lanes_of##f(&a);                                                      \
    assert_int_equal(isa->entries##f->pdf_batch(&b, COUNT, &l.known, NULL), SHADE_BAD_INPUT);      \
    assert_true(untouched##f(&a));                                                                 \
    /* no samples: no array need be there */                                                       \
    const shade_lanes##f none = {.size = sizeof none};                                             \
    const shade_result##f nowhere = {.size = sizeof nowhere};                                      \
    const shade_sample_lanes##f no_draws = {.size = sizeof no_draws};                              \
    const shade_sample_result##f not_drawn = {.size = sizeof not_drawn};                           \
    assert_int_equal(isa->entries##f->bsdf_batch(&b, 0, &none, &nowhere), SHADE_OK);               \
    assert_int_equal(isa->entries##f->pdf_batch(&b, 0, &none, NULL), SHADE_OK);                    \
    assert_int_equal(isa->entries##f->sample_batch(&b, 0, &no_draws, &not_drawn), SHADE_OK);       \
  }
STRUCTURES(double, )
STRUCTURES(float, f)

static void sizes_of_inputs(void **state) {
  (void)state;
  for (int row = 0; shade_isa_pick(row); row++) {
    inputs_end(shade_isa_pick(row));
    inputs_endf(shade_isa_pick(row));
  }
}

static void required_arrays(void **state) {
  (void)state;
  for (int row = 0; shade_isa_pick(row); row++) {
    required(shade_isa_pick(row));
    requiredf(shade_isa_pick(row));
  }
}

/* The structures as they were first released: what may never shrink or move. */
static void first_sizes(void **state) {
  (void)state;
  const size_t pointer = sizeof(void *);
  assert_true(sizeof(shade_bsdf) == 1024);
  assert_true(offsetof(shade_lanes, size) == 0 && offsetof(shade_lanesf, size) == 0);
  assert_true(offsetof(shade_lanes, f0b) == 12 * pointer);
  assert_true(offsetof(shade_lanesf, f0b) == 12 * pointer);
  assert_true(offsetof(shade_sample_lanes, f0b) == 11 * pointer);
  assert_true(offsetof(shade_sample_lanesf, f0b) == 11 * pointer);
  assert_true(offsetof(shade_result, cosine) == 4 * pointer);
  assert_true(offsetof(shade_resultf, cosine) == 4 * pointer);
  assert_true(offsetof(shade_sample_result, cosine) == 8 * pointer);
  assert_true(offsetof(shade_sample_resultf, cosine) == 8 * pointer);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sizes_of_inputs),
                                     cmocka_unit_test(required_arrays),
                                     cmocka_unit_test(first_sizes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
