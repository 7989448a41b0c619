/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.7 */
/*
 * Parameters of each sample: a lane is worth what a material set up with its parameters gives,
 * for f, density and draws, in the frame of its groove; in both precisions and every instruction
 * set; and so is a sample whose material shade_bsdf_vary made. Numbers out of their range:
 * test_varied_range.c; draws as a whole, energy and reciprocity: test_varied_draws.c.
 */
#include <string.h>

#include "support.h"

enum { COUNT = 300, ARRAYS = 28, OUTPUTS = 5 };
/* Where the arrays of a direction or colour begin, and the numbers. */
enum { N = 0, WI = 3, WO = 6, U = 9, F0 = 11, F82 = 14, ETA = 17, K = 20, KD = 23, AX = 26, AY };
enum { F = 0, COSINE = 3, PDF };

/* Both precisions hold the same numbers: `in` those of the floats where floats are asked for. */
typedef struct arrays {
  double in[ARRAYS][COUNT], groove[2][COUNT], wi[3][COUNT], out[OUTPUTS][COUNT];
  float inf[ARRAYS][COUNT], groovef[2][COUNT], wif[3][COUNT], outf[OUTPUTS][COUNT];
} arrays;

static double between(uint64_t *seed, double low, double high) {
  return low * pow(high / low, uniform(seed));
}

static void fill(uint64_t *seed, int single, arrays *a) {
  for (int i = 0; i < COUNT; i++) {
    double v[3];
    for (int k = 0; k < 3; k++) {
      spherical((k ? 1.3 : 0.9) * uniform(seed), 2 * PI * uniform(seed), v);
      for (int c = 0; c < 3; c++)
        a->in[3 * k + c][i] = v[c];
    }
    for (int k = U; k < ARRAYS; k++)
      a->in[k][i] = uniform(seed);
    a->in[AX][i] = between(seed, 0.05, 1);
    a->in[AY][i] = between(seed, 0.05, 1);
    for (int c = 0; c < 3; c++) {
      a->in[ETA + c][i] = between(seed, 0.1, 5);
      a->in[K + c][i] *= 5;
      a->in[KD + c][i] *= i % 7 != 0;
    }
    const double angle = 2 * PI * uniform(seed), size = between(seed, 1e-3, 1e3);
    a->groove[0][i] = size * cos(angle);
    a->groove[1][i] = size * sin(angle);
    for (int k = 0; k < ARRAYS; k++) {
      a->inf[k][i] = (float)a->in[k][i];
      a->in[k][i] = single ? (double)a->inf[k][i] : a->in[k][i];
    }
    for (int k = 0; k < 2; k++) {
      a->groovef[k][i] = (float)a->groove[k][i];
      a->groove[k][i] = single ? (double)a->groovef[k][i] : a->groove[k][i];
    }
  }
}

/* f, cosine and density of the lanes' wi, by one instruction set; then draws, to wi and out. */
#define BATCHES(real, f)                                                                           \
  static void parameters##f(arrays *a, int colours, shade_lanes##f *in) {                          \
    real(*v)[COUNT] = a->in##f;                                                                    \
    *in = (shade_lanes##f){.size = sizeof *in,                                                     \
                           SHADE_DIRECTIONS(v),                                                    \
                           .ax = v[AX],                                                            \
                           .ay = v[AY],                                                            \
                           .groove_x = a->groove##f[0],                                            \
                           .groove_y = a->groove##f[1]};                                           \
    if (!colours)                                                                                  \
      return;                                                                                      \
    in->f0r = v[F0], in->f0g = v[F0 + 1], in->f0b = v[F0 + 2];                                     \
    in->f82r = v[F82], in->f82g = v[F82 + 1], in->f82b = v[F82 + 2];                               \
    in->etar = v[ETA], in->etag = v[ETA + 1], in->etab = v[ETA + 2];                               \
    in->kr = v[K], in->kg = v[K + 1], in->kb = v[K + 2];                                           \
    in->kdr = v[KD], in->kdg = v[KD + 1], in->kdb = v[KD + 2];                                     \
  }                                                                                                \
  static void evaluate##f(const shade_isa_table *isa, const shade_bsdf *b, arrays *a,              \
                          int colours) {                                                           \
    shade_lanes##f in;                                                                             \
    parameters##f(a, colours, &in);                                                                \
    real(*o)[COUNT] = a->out##f;                                                                   \
    const shade_result##f out = {sizeof out, o[0], o[1], o[2], o[COSINE]};                         \
    assert_int_equal(isa->entries##f->bsdf_batch(b, COUNT, &in, &out), SHADE_OK);                  \
    assert_int_equal(isa->entries##f->pdf_batch(b, COUNT, &in, o[PDF]), SHADE_OK);                 \
  }                                                                                                \
  static void draw##f(const shade_isa_table *isa, const shade_bsdf *b, arrays *a, int colours) {   \
    shade_lanes##f in;                                                                             \
    parameters##f(a, colours, &in);                                                                \
    shade_sample_lanes##f from = {.size = sizeof from,                                             \
                                  .nx = in.nx,                                                     \
                                  .ny = in.ny,                                                     \
                                  .nz = in.nz,                                                     \
                                  .wox = in.wox,                                                   \
                                  .woy = in.woy,                                                   \
                                  .woz = in.woz,                                                   \
                                  .u1 = a->in##f[U],                                               \
                                  .u2 = a->in##f[U + 1]};                                          \
    memcpy(&from.f0r, &in.f0r, sizeof in - offsetof(shade_lanes##f, f0r));                         \
    real(*o)[COUNT] = a->out##f;                                                                   \
    const shade_sample_result##f to = {sizeof to, a->wi##f[0], a->wi##f[1], a->wi##f[2], o[0],     \
                                       o[1],      o[2],        o[PDF],      o[COSINE]};            \
    isa->entries##f->sample_batch(b, COUNT, &from, &to);                                           \
  }
BATCHES(double, )
BATCHES(float, f)

/* Lane i as a material of its own, in single calls: farthest off what evaluate or draw left, of 1.
 */
#define SINGLE(real, f)                                                                            \
  static double farthest##f(const real *got, const real(*want)[COUNT], int count, int i) {         \
    double most = 0;                                                                               \
    for (int k = 0; k < count; k++)                                                                \
      most = fmax(most, (double)(fabs(got[k] - want[k][i]) / (fabs(want[k][i]) + 1)));             \
    return most;                                                                                   \
  }                                                                                                \
  static double evaluate_one##f(const shade_isa_table *isa, const shade_bsdf *b, arrays *a,        \
                                int colours, int i) {                                              \
    shade_lanes##f in;                                                                             \
    shade_bsdf one;                                                                                \
    real v[9], got[OUTPUTS];                                                                       \
    parameters##f(a, colours, &in);                                                                \
    assert_int_equal(isa->entries##f->vary(b, &in, (size_t)i, &one), SHADE_OK);                    \
    for (int k = 0; k < 9; k++)                                                                    \
      v[k] = a->in##f[k][i];                                                                       \
    isa->entries##f->bsdf(&one, v, v + 3, v + 6, got, &got[COSINE]);                               \
    isa->entries##f->pdf(&one, v, v + 3, v + 6, &got[PDF]);                                        \
    return farthest##f(got, a->out##f, OUTPUTS, i);                                                \
  }                                                                                                \
  static double draw_one##f(const shade_isa_table *isa, const shade_bsdf *b, arrays *a,            \
                            int colours, int i) {                                                  \
    shade_lanes##f in;                                                                             \
    shade_bsdf one = *b;                                                                           \
    real v[9], w[3], got[OUTPUTS];                                                                 \
    const real u[2] = {a->in##f[U][i], a->in##f[U + 1][i]};                                        \
    parameters##f(a, colours, &in);                                                                \
    isa->entries##f->vary(&one, &in, (size_t)i, &one);                                             \
    for (int k = 0; k < 9; k++)                                                                    \
      v[k] = a->in##f[k][i];                                                                       \
    isa->entries##f->sample(&one, v, v + 6, u, w, got, &got[PDF], &got[COSINE]);                   \
    return fmax(farthest##f(w, a->wi##f, 3, i), farthest##f(got, a->out##f, OUTPUTS, i));          \
  }
SINGLE(double, )
SINGLE(float, f)

/* Floats read as doubles. */
static void widen(arrays *a) {
  for (int i = 0; i < COUNT; i++) {
    for (int k = 0; k < OUTPUTS; k++)
      a->out[k][i] = (double)a->outf[k][i];
    for (int c = 0; c < 3; c++)
      a->wi[c][i] = (double)a->wif[c][i];
  }
}

/* The lane's own material. */
static shade_params own(const shade_params *base, const arrays *a, int i, int colours) {
  shade_params p = *base;
  shade_params_set_alphas(&p, a->in[AX][i], a->in[AY][i]);
  for (int c = 0; c < 3 && colours; c++) {
    p.f0[c] = a->in[F0 + c][i];
    p.f82[c] = a->in[F82 + c][i];
    p.eta[c] = a->in[ETA + c][i];
    p.k[c] = a->in[K + c][i];
    p.kd[c] = a->in[KD + c][i];
  }
  return p;
}

/* A direction in the frame whose x is the lane's groove. */
static void turned(const arrays *a, const double (*w)[COUNT], int i, double v[3]) {
  const double x = a->groove[0][i], y = a->groove[1][i], size = sqrt(x * x + y * y);
  v[0] = (x * w[0][i] + y * w[1][i]) / size;
  v[1] = (x * w[1][i] - y * w[0][i]) / size;
  v[2] = w[2][i];
}

static int same(double got, double want, double scale) {
  return fabs(got - want) <= 1e-12 * (fabs(want) + scale);
}

static shade_params some_params(uint64_t *seed, int mdf, int k) {
  shade_params p;
  shade_params_init(&p);
  p.mdf = (shade_mdf)mdf;
  p.brdf = (shade_brdf)(uniform(seed) * SHADE_BRDF_COUNT);
  p.detail = (shade_detail)(k % SHADE_DETAIL_COUNT);
  p.groove = (shade_groove)(uniform(seed) * SHADE_GROOVE_COUNT);
  p.fresnel = (shade_fresnel)(uniform(seed) * SHADE_FRESNEL_COUNT);
  p.diffuse = (shade_diffuse)(uniform(seed) * SHADE_DIFFUSE_COUNT);
  p.horizon = (shade_horizon)(uniform(seed) * SHADE_HORIZON_COUNT);
  p.multiscatter = (shade_multiscatter)(*seed >> 20 & 1);
  /* fibres of gram_schmidt keep the material's own axis */
  if (p.detail == SHADE_DETAIL_GRAM_SCHMIDT && p.groove == SHADE_GROOVE_AUTO)
    p.groove = SHADE_GROOVE_X;
  if (uniform(seed) < 0.3)
    shade_params_set_alphas(&p, 0.2, 0.2);
  return p;
}

/*
 * Off the lane's own material, in double, by at most `bound` of f + 1 and of the density + 1.
 * Floats near a horizon lose digits in proportion: not those.
 */
static int lane_agrees(const shade_params *base, const arrays *a, const double (*wi)[COUNT], int i,
                       int colours, int single, double bound, double *worst) {
  const shade_params p = own(base, a, i, colours);
  shade_bsdf b;
  double v[9], f[3], cosine;
  turned(a, a->in + N, i, v);
  turned(a, wi, i, v + 3);
  turned(a, a->in + WO, i, v + 6);
  if (single && !(least_cosine(&p, v) > 0.05))
    return 1;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
  const double want[OUTPUTS] = {f[0], f[1], f[2], cosine,
                                shade_bsdf_pdf(&b, v, v + 3, v + 6, NULL)};
  int right = 1;
  for (int k = 0; k < OUTPUTS; k++) {
    const double off = fabs(a->out[k][i] - want[k]) / (want[k] + 1);
    *worst = fmax(*worst, off);
    right &= off <= bound;
  }
  return right;
}

/* f, the density of wi, and draws: their f and density are those of the direction that came. */
static void lanes_are_materials(int single, int cases) {
  static arrays a;
  uint64_t seed = 11;
  double worst = 0, worst_draw = 0, worst_one = 0, worst_draw_one = 0;
  int drawn = 0;
  /* double: a rounding of h counts kx times in a narrow lobe (1e-12 of f at kx = 400, seen);
     that of the direction that was drawn once more */
  const double bound = single ? 1e-4 : 1e-12, bound_draw = single ? 1e-4 : 1e-9;
  const shade_isa_table *isa;
  for (int k = 0; k < cases; k++) {
    fill(&seed, single, &a);
    const shade_params p = some_params(&seed, k % SHADE_MDF_COUNT, k / SHADE_MDF_COUNT);
    const int colours = k % 3 != 0;
    shade_bsdf b;
    assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
    for (int row = 0; (isa = shade_isa_pick(row)); row++) {
      (single ? evaluatef : evaluate)(isa, &b, &a, colours);
      for (int i = row; i < COUNT; i += 3) {
        const double off = (single ? evaluate_onef : evaluate_one)(isa, &b, &a, colours, i);
        worst_one = fmax(worst_one, off);
      }
      if (single)
        widen(&a);
      for (int i = row; i < COUNT; i += row ? 5 : 1)
        if (!lane_agrees(&p, &a, a.in + WI, i, colours, single, bound, &worst))
          fail_msg("%s, case %d, lane %d", isa->name, k, i);
      (single ? drawf : draw)(isa, &b, &a, colours);
      for (int i = row; i < COUNT; i += 3) {
        const double off = (single ? draw_onef : draw_one)(isa, &b, &a, colours, i);
        worst_draw_one = fmax(worst_draw_one, off);
      }
      if (single)
        widen(&a);
      for (int i = row; i < COUNT; i += row ? 5 : 1)
        if (a.out[PDF][i] > 0) {
          drawn++;
          if (!lane_agrees(&p, &a, a.wi, i, colours, single, bound_draw, &worst_draw))
            fail_msg("%s, case %d, draw %d", isa->name, k, i);
        }
    }
  }
  print_message("%s: worst %.1e; %d draws, %.1e\n", single ? "float" : "double", worst, drawn,
                worst_draw);
  print_message("one at a time: %.1e, draws %.1e\n", worst_one, worst_draw_one);
  /* fused multiply-adds differ between loops and single calls */
  assert_true(worst_one <= (single ? 1e-6 : 1e-15));
  assert_true(worst_draw_one <= (single ? 1e-4 : 1e-13));
  assert_true(drawn > 120 * cases);
}

static void each_lane_is_a_material(void **state) {
  (void)state;
  lanes_are_materials(0, 330 / FEWER);
}

static void each_float_lane_is_a_material(void **state) {
  (void)state;
  lanes_are_materials(1, 330 / FEWER);
}

/* One part alone: the parts of f add up, and draws of each have its density. */
static void parts(void **state) {
  (void)state;
  static arrays a;
  uint64_t seed = 6;
  fill(&seed, 0, &a);
  shade_params p;
  shade_bsdf b, lobe;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_BECKMANN;
  p.brdf = SHADE_BRDF_MICROFACET;
  p.kd[0] = p.kd[1] = p.kd[2] = 0.5;
  shade_bsdf_setup(&b, &p);
  p.kd[0] = p.kd[1] = p.kd[2] = 0;
  shade_bsdf_setup(&lobe, &p);
  shade_lanes in = {.size = sizeof in, SHADE_DIRECTIONS(a.in)};
  double sum[COUNT] = {0}, whole[COUNT], pdf[COUNT];
  for (size_t part = 0; part <= SHADE_PART_DIFFUSE; part++) {
    in.parts = part;
    const shade_result out = {sizeof out, a.out[0], a.out[1], a.out[2], a.out[3]};
    assert_int_equal(shade_bsdf_eval_batch(&b, COUNT, &in, &out), SHADE_OK);
    assert_int_equal(shade_bsdf_pdf_batch(&b, COUNT, &in, pdf), SHADE_OK);
    for (int i = 0; i < COUNT; i++) {
      const double n[3] = {a.in[0][i], a.in[1][i], a.in[2][i]},
                   wi[3] = {a.in[3][i], a.in[4][i], a.in[5][i]},
                   wo[3] = {a.in[6][i], a.in[7][i], a.in[8][i]};
      if (part == 0)
        whole[i] = a.out[0][i];
      else
        sum[i] += a.out[0][i];
      if (part == SHADE_PART_SPECULAR)
        assert_true(same(pdf[i], shade_bsdf_pdf(&lobe, n, wi, wo, NULL), 1));
      shade_bsdf one;
      double f[3], cosine;
      assert_int_equal(shade_bsdf_vary(&b, &in, (size_t)i, &one), SHADE_OK);
      shade_bsdf_eval(&one, n, wi, wo, f, &cosine);
      assert_true(same(f[0], a.out[0][i], 1e-3) && same(cosine, a.out[COSINE][i], 1));
      assert_true(same(shade_bsdf_pdf(&one, n, wi, wo, NULL), pdf[i], 1e-3));
    }
  }
  for (int i = 0; i < COUNT; i++)
    assert_true(same(sum[i], whole[i], 1));
  in.parts = 4;
  const shade_result out = {sizeof out, a.out[0], a.out[1], a.out[2], a.out[3]};
  assert_int_equal(shade_bsdf_eval_batch(&b, COUNT, &in, &out), SHADE_BAD_CHOICE);
  assert_true(a.out[0][7] == whole[7]);
}

/* Numbers out of range, and none: the status of a batch of the one lane, its value too. What is
 * made for one sample is refused where there are many, and no ground for another. */
static void one_lane_mended(void **state) {
  (void)state;
  static arrays a;
  uint64_t seed = 12;
  fill(&seed, 0, &a);
  fill(&seed, 1, &a);
  const double odd[] = {0.3, NAN, -1, INFINITY, 1e9, 0};
  enum { ODD = sizeof odd / sizeof odd[0] };
  for (int k = 0; k < 40 * ODD; k++) {
    const shade_params p = some_params(&seed, k % SHADE_MDF_COUNT, k / SHADE_MDF_COUNT);
    shade_bsdf b, one, kept;
    shade_bsdf_setup(&b, &p);
    shade_lanes in;
    parameters(&a, k % 2, &in);
    const size_t at = (size_t)(k % COUNT);
    in.ay = NULL;
    in.ex = odd + k % ODD;
    in.ey = odd + k % ODD;
    in.ax = in.groove_x = in.groove_y = NULL;
    if (k % 3 == 0)
      in.groove_x = in.ex, in.groove_y = odd;
    const unsigned half = k % 3 == 1 ? SHADE_BAD_INPUT : SHADE_OK; /* which is none */
    if (half)
      *(k % 2 ? &in.groove_x : &in.groove_y) = odd;
    if (k % 5 == 0)
      in.kdg = in.etab = in.f0r = in.f82r = in.kr = in.ex;
    if (k % 7 == 0)
      in.parts = 8;
    double many[5];
    const double n[3] = {a.in[0][at], a.in[1][at], a.in[2][at]};
    const double wi[3] = {a.in[3][at], a.in[4][at], a.in[5][at]};
    const double wo[3] = {a.in[6][at], a.in[7][at], a.in[8][at]};
    /* arrays of one number, and those of many from that lane on */
    const double **const each = (const double **)&in.nx;
    const size_t arrays_of =
        (offsetof(shade_lanes, parts) - offsetof(shade_lanes, nx)) / sizeof *each;
    for (size_t m = 0; m < arrays_of; m++)
      if (each[m] && !(each[m] >= odd && each[m] < odd + ODD))
        each[m] += at;
    const shade_result out = {sizeof out, &many[0], &many[1], &many[2], &many[3]};
    const unsigned was = shade_bsdf_eval_batch(&b, 1, &in, &out);
    assert_int_equal(was & SHADE_BAD_INPUT, half);
    assert_int_equal(shade_bsdf_pdf_batch(&b, 1, &in, &many[4]), was);
    assert_int_equal(shade_bsdf_vary(&b, &in, 0, &one), was);
    double f[3], cosine;
    assert_int_equal(shade_bsdf_eval(&one, n, wi, wo, f, &cosine), SHADE_OK);
    for (int c = 0; c < 3; c++)
      assert_true(same(f[c], many[c], 1e-3));
    assert_true(same(cosine, many[3], 1));
    assert_true(same(shade_bsdf_pdf(&one, n, wi, wo, NULL), many[4], 1e-3));
    /* the other precision's calls know it, too */
    const bsdf *const in_both = bsdf_of(&one);
    assert_true(in_both->numbersf.kx == (float)in_both->numbers.kx);
    assert_true(in_both->numbersf.s == (float)in_both->numbers.s);
    kept = one;
    assert_int_equal(shade_bsdf_eval_batch(&one, 1, &in, &out), SHADE_BAD_INPUT);
    assert_int_equal(shade_bsdf_pdf_batch(&one, 1, &in, &many[4]), SHADE_BAD_INPUT);
    assert_int_equal(shade_mdf_eval_batch(&one, 1, n, n, n, n, n, n, many), SHADE_BAD_INPUT);
    assert_int_equal(shade_bsdf_vary(&one, &in, 0, &one), SHADE_BAD_INPUT);
    assert_memory_equal(&one, &kept, sizeof one);
    in.size = 0;
    assert_int_equal(shade_bsdf_vary(&b, &in, 0, &one), SHADE_BAD_INPUT);
    assert_memory_equal(&one, &b, sizeof one);
  }
}

/* Nothing specular: every draw is a diffuse one, and Lambert's weight is kd itself. */
static void no_specular_part(void **state) {
  (void)state;
  uint64_t seed = 8;
  shade_params p;
  shade_bsdf b;
  shade_params_init(&p);
  p.fresnel = SHADE_FRESNEL_NONE;
  p.f0[0] = p.f0[1] = p.f0[2] = 0;
  p.kd[0] = p.kd[1] = p.kd[2] = 0.5;
  shade_bsdf_setup(&b, &p);
  const double z[3] = {0, 0, 1}, wo[3] = {0.6, 0, 0.8};
  for (int i = 0; i < 2000; i++) {
    const double u[2] = {uniform(&seed), uniform(&seed)};
    double wi[3], f[3], pdf, cosine;
    assert_int_equal(shade_bsdf_sample(&b, z, wo, u, wi, f, &pdf, &cosine), SHADE_OK);
    assert_true(same(f[1] * cosine / pdf, 0.5, 0));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(each_lane_is_a_material),
                                     cmocka_unit_test(each_float_lane_is_a_material),
                                     cmocka_unit_test(parts), cmocka_unit_test(one_lane_mended),
                                     cmocka_unit_test(no_specular_part)};
  return cmocka_run_group_tests_name("varied", tests, NULL, NULL);
}
