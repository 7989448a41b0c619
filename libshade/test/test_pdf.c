/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 18 */
/*
 * The density of draws against the reference, the albedo from draws against quadrature, narrow
 * lobes and visible normals against their own distribution functions, and draws from input that
 * makes no sense.
 */
#include <fenv.h>
#include <float.h>
#include <string.h>

#include "support.h"

#ifdef SANITIZED
enum { SLOWED = 10 };
#else
enum { SLOWED = 1 };
#endif

enum { BATCH = 1024 };

typedef struct lanes {
  double in[8][BATCH], out[8][BATCH];
  float inf[8][BATCH], outf[8][BATCH];
} lanes;

static unsigned draw(const shade_isa_table *isa, const shade_bsdf *b, lanes *m, size_t count) {
  const shade_sample_lanes in = {.size = sizeof in,
                                 .nx = m->in[0],
                                 .ny = m->in[1],
                                 .nz = m->in[2],
                                 .wox = m->in[3],
                                 .woy = m->in[4],
                                 .woz = m->in[5],
                                 .u1 = m->in[6],
                                 .u2 = m->in[7]};
  const shade_sample_result out = {sizeof out, m->out[0], m->out[1], m->out[2], m->out[3],
                                   m->out[4],  m->out[5], m->out[6], m->out[7]};
  return isa->entries->sample_batch(b, count, &in, &out);
}

static unsigned drawf(const shade_isa_table *isa, const shade_bsdf *b, lanes *m, size_t count) {
  for (int k = 0; k < 8; k++)
    for (size_t i = 0; i < count; i++) {
      double x = m->in[k][i];
      m->inf[k][i] = fabs(x) > (double)FLT_MAX && isfinite(x)
                         ? copysignf(FLT_MAX, (float)(x < 0 ? -1 : 1))
                         : (float)x;
    }
  const shade_sample_lanesf in = {.size = sizeof in,
                                  .nx = m->inf[0],
                                  .ny = m->inf[1],
                                  .nz = m->inf[2],
                                  .wox = m->inf[3],
                                  .woy = m->inf[4],
                                  .woz = m->inf[5],
                                  .u1 = m->inf[6],
                                  .u2 = m->inf[7]};
  const shade_sample_resultf out = {sizeof out, m->outf[0], m->outf[1], m->outf[2], m->outf[3],
                                    m->outf[4], m->outf[5], m->outf[6], m->outf[7]};
  return isa->entriesf->sample_batch(b, count, &in, &out);
}

static shade_params random_params(uint64_t *seed, double widest) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, pow(10, widest * uniform(seed)), pow(10, widest * uniform(seed)));
  if (uniform(seed) < 0.1)
    shade_params_set_exponents(&p, p.ex, p.ex);
  random_choices(seed, &p);
  p.horizon = (shade_horizon)(uniform(seed) * SHADE_HORIZON_COUNT);
  int matt = uniform(seed) < 0.3;
  for (int c = 0; c < 3; c++) {
    p.f0[c] = uniform(seed);
    p.kd[c] = matt ? uniform(seed) : 0;
  }
  return p;
}

static void random_directions(uint64_t *seed, double n[3], double a[3], double b[3]) {
  spherical(1.2 * uniform(seed), 2 * PI * uniform(seed), n);
  spherical(1.5 * uniform(seed), 2 * PI * uniform(seed), a);
  spherical(1.5 * uniform(seed), 2 * PI * uniform(seed), b);
}

/* -1: hard's horizons leave no doubt that there is nothing; 1: digits to compare; else 0. */
static int clear_case(const shade_params *p, const double n[3], const double wi[3],
                      const double wo[3]) {
  double cosi = wi[2], coso = wo[2], h[3], m[3], length = 0;
  if (p->detail != SHADE_DETAIL_NONE) {
    cosi = fmin(cosi, n[0] * wi[0] + n[1] * wi[1] + n[2] * wi[2]);
    coso = fmin(coso, n[0] * wo[0] + n[1] * wo[1] + n[2] * wo[2]);
  }
  if (fmin(cosi, coso) < -1e-6)
    return -1;
  if (fmin(cosi, coso) < 0.01)
    return 0;
  for (int c = 0; c < 3; c++)
    length += (wi[c] + wo[c]) * (wi[c] + wo[c]);
  for (int c = 0; c < 3; c++)
    h[c] = (wi[c] + wo[c]) / sqrt(length);
  shade_ref_carried(p, n, h, m);
  return m[2] >= (is_warp(p->detail) ? 0.5 : 0.05);
}

/* w mirrored at the upright facet; returns how much of it faces that facet. */
static double upright(const double n[3], const double w[3], double out[3]) {
  double side = hypot(n[0], n[1]), along = (n[0] * w[0] + n[1] * w[1]) / side;
  for (int c = 0; c < 2; c++)
    out[c] = w[c] - 2 * along * n[c] / side;
  out[2] = w[2];
  return -along;
}

/* pdf against the reference, away from horizons, where both lose their digits. */
static void against_reference(void **state) {
  (void)state;
  uint64_t seed = 5;
  double worst = 0, worst_warp = 0, worstf = 0, worst_facets = 0, worst_facetsf = 0;
  int compared = 0, zeros = 0, by_mirror = 0;
  for (int k = 0; k < 60000 / SLOWED; k++) {
    shade_params p = random_params(&seed, 3);
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    double n[3], wi[3], wo[3], at[3];
    random_directions(&seed, n, wi, wo);
    unsigned status = SHADE_OK;
    double got = shade_bsdf_pdf(&b, n, wi, wo, &status), want = shade_ref_pdf(&p, n, wi, wo);
    assert_int_equal(status, SHADE_OK);
    shade_ref_normal(&p, n, wo, at);
    const int facets = p.horizon == SHADE_HORIZON_SCHUESSLER && p.detail != SHADE_DETAIL_NONE;
    int plain = clear_case(&p, at, wi, wo), clear = plain;
    if (facets) {
      double ti[3], to[3];
      double faces_i = upright(n, wi, ti), faces_o = upright(n, wo, to);
      int light = faces_i < 0 ? -1 : clear_case(&p, n, ti, wo);
      int eye = faces_o < 0 ? -1 : clear_case(&p, n, wi, to);
      clear = plain && light && eye && fabs(faces_i) > 1e-6 && fabs(faces_o) > 1e-6;
      if (clear)
        clear = plain < 0 && light < 0 && eye < 0 ? -1 : 1;
      by_mirror += plain < 0 && clear > 0;
    }
    if (clear < 0) {
      zeros++;
      assert_true(got == 0 && want == 0);
    }
    if (clear <= 0 || want < 1e-9)
      continue;
    compared++;
    double *tally = is_warp(p.detail) ? &worst_warp : facets ? &worst_facets : &worst;
    *tally = fmax(*tally, fabs(got / want - 1));
    float fv[9];
    for (int c = 0; c < 3; c++) {
      n[c] = (double)(fv[c] = (float)n[c]);
      wi[c] = (double)(fv[3 + c] = (float)wi[c]);
      wo[c] = (double)(fv[6 + c] = (float)wo[c]);
    }
    double gotf = (double)shade_bsdf_pdff(&b, fv, fv + 3, fv + 6, NULL);
    want = shade_ref_pdf(&p, n, wi, wo);
    tally = facets ? &worst_facetsf : &worstf;
    if (!is_warp(p.detail) && (facets || p.horizon == SHADE_HORIZON_HARD))
      *tally = fmax(*tally, fabs(gotf / want - 1));
  }
  print_message(
      "pdf: %d compared, %d below, %d by mirrors alone; worst relative error %.1e double, "
      "%.1e float, facets %.1e and %.1e, %.1e double through warps\n",
      compared, zeros, by_mirror, worst, worstf, worst_facets, worst_facetsf, worst_warp);
  assert_true(compared > 4000 / SLOWED && zeros > 4000 / SLOWED && by_mirror > 200 / SLOWED);
  assert_true(worst <= 2e-12);
  assert_true(worst_facets <= 2e-12);
  assert_true(worst_warp <= 2e-12);
  assert_true(worstf <= 4e-5);
  assert_true(worst_facetsf <= 4e-5);
}

/* Light, eye and normal in one: the half vector has no azimuth, of which the density of a ward_half
 * that is not round depends at its pole too. It is that of the mean of both axes. */
static void on_the_pole(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_WARD_HALF;
  p.detail = SHADE_DETAIL_NONE;
  for (int k = 0; k < 3; k++) {
    const double up[3] = {0, 0, 1};
    p.ax = (const double[]){0.5, 1, 3}[k];
    p.ay = (const double[]){2, 0.7, 3}[k];
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    const double mean = (1 / (p.ax * p.ax) + 1 / (p.ay * p.ay)) / 2;
    const double wanted = 1 / (PI * p.ax * p.ay * (1 - exp(-2 * mean))) / 4;
    assert_true(fabs(shade_bsdf_pdf(&b, up, up, up, NULL) / wanted - 1) < 1e-12);
    assert_true(fabs(shade_ref_pdf(&p, up, up, up) / wanted - 1) < 1e-12);
  }
}

/* f cos / pdf of many draws; m holds n and wo. */
typedef struct average {
  double mean, deviation, largest;
  long draws;
} average;

static average from_draws(const shade_isa_table *isa, const shade_bsdf *b, lanes *m,
                          uint64_t *seed) {
  average a = {0, 0, 0, 200 * BATCH / SLOWED};
  double square = 0;
  for (long done = 0; done < a.draws; done += BATCH) {
    for (int i = 0; i < BATCH; i++) {
      m->in[6][i] = uniform(seed);
      m->in[7][i] = uniform(seed);
    }
    draw(isa, b, m, BATCH);
    for (int i = 0; i < BATCH && done + i < a.draws; i++) {
      double w = m->out[6][i] > 0 ? m->out[3][i] * m->out[7][i] / m->out[6][i] : 0;
      a.mean += w;
      square += w * w;
      a.largest = fmax(a.largest, w);
    }
  }
  a.mean /= (double)a.draws;
  a.deviation = sqrt(fmax(square / (double)a.draws - a.mean * a.mean, 0));
  return a;
}

/* f cos by midpoints over the hemisphere; *missed counts those where it is not 0 but the pdf is. */
static double by_midpoints(const shade_isa_table *isa, const shade_bsdf *b, lanes *m,
                           long *missed) {
  static double r[BATCH], g[BATCH], bl[BATCH], cosine[BATCH], pdf[BATCH];
  const int grid = 1024 / SLOWED;
  double sum = 0;
  for (int ring = 0; ring < grid; ring++) {
    double z = (ring + 0.5) / grid, s = sqrt((1 - z) * (1 + z));
    for (int i = 0; i < grid; i++) {
      double phi = 2 * PI * (i + 0.5) / grid;
      m->out[0][i] = s * cos(phi);
      m->out[1][i] = s * sin(phi);
      m->out[2][i] = z;
    }
    const shade_lanes in = {.size = sizeof in,
                            .nx = m->in[0],
                            .ny = m->in[1],
                            .nz = m->in[2],
                            .wix = m->out[0],
                            .wiy = m->out[1],
                            .wiz = m->out[2],
                            .wox = m->in[3],
                            .woy = m->in[4],
                            .woz = m->in[5]};
    const shade_result out = {sizeof out, r, g, bl, cosine};
    isa->entries->bsdf_batch(b, (size_t)grid, &in, &out);
    isa->entries->pdf_batch(b, (size_t)grid, &in, pdf);
    for (int i = 0; i < grid; i++) {
      sum += r[i] * cosine[i];
      *missed += r[i] * cosine[i] > 1e-9 && !(pdf[i] > 0);
    }
  }
  return sum * 2 * PI / ((double)grid * grid);
}

static void set_eye(lanes *m, const double n[3], const double wo[3]) {
  for (int c = 0; c < 3; c++)
    for (int i = 0; i < BATCH; i++) {
      m->in[c][i] = n[c];
      m->in[3 + c][i] = wo[c];
    }
}

/*
 * The average of f cos / pdf against f cos by midpoints over the hemisphere: `hard` before an
 * eye that n faces, the library's default before one below the horizon of n.
 */
static void albedo(void **state) {
  (void)state;
  static lanes m;
  uint64_t seed = 6;
  const shade_isa_table *isa = shade_isa_pick(0);
  print_message("largest f cos / pdf and relative deviation, alpha .2 and .5:\n");
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int detail = 0; detail < SHADE_DETAIL_COUNT; detail++)
      for (int k = 0; k < 3; k++) {
        const int visible = k < 2 ? k : (mdf + detail) & 1;
        const int brdf = visible ? SHADE_BRDF_MICROFACET : SHADE_BRDF_ASHIKHMIN_SHIRLEY;
        if (detail == SHADE_DETAIL_AUTO)
          continue;
        shade_params p;
        shade_params_init(&p);
        if (k < 2)
          p.horizon = SHADE_HORIZON_HARD;
        shade_params_set_alphas(&p, 0.2, 0.5);
        p.fresnel = SHADE_FRESNEL_NONE;
        p.mdf = (shade_mdf)mdf;
        p.detail = (shade_detail)detail;
        p.brdf = (shade_brdf)brdf;
        p.kd[0] = p.kd[1] = p.kd[2] = (detail + mdf) % 4 == 1 ? 0.4 : 0;
        p.diffuse = (shade_diffuse)(detail % SHADE_DIFFUSE_COUNT);
        shade_bsdf b;
        shade_bsdf_setup(&b, &p);
        double n[3], wo[3];
        spherical(0.6, 0.4, n);
        spherical(k < 2 ? 0.5 : 1.3, k < 2 ? 2.2 : 3.3, wo);
        set_eye(&m, n, wo);
        average a = from_draws(isa, &b, &m, &seed);
        long missed = 0;
        double want = by_midpoints(isa, &b, &m, &missed);
        print_message(
            "  %-18s %-25s %-18s %-14s %6.2f %5.2f\n", shade_list_word(SHADE_LIST_MDF, mdf),
            shade_list_word(SHADE_LIST_DETAIL, detail), shade_list_word(SHADE_LIST_BRDF, brdf),
            shade_list_word(SHADE_LIST_HORIZON, (int)bsdf_of(&b)->horizon), a.largest,
            a.deviation / a.mean);
        assert_int_equal(missed, 0);
        assert_true(want > 0.01);
        if (fabs(a.mean - want) > 5 * a.deviation / sqrt((double)a.draws) + 1e-3 * SLOWED * want)
          fail_msg("%s %s: %g from draws, %g by quadrature", shade_list_word(SHADE_LIST_MDF, mdf),
                   shade_list_word(SHADE_LIST_DETAIL, detail), a.mean, want);
      }
}

/*
 * Facets and upright mirrors: draws find all that f has, the eye above n's horizon and below it,
 * and f cos / pdf stays within 1 + cot(tilt) (2 at least) of F where visible normals are drawn.
 * Where n = z the draws are those of `hard` to the last bit.
 */
static void facets(void **state) {
  (void)state;
  static lanes m, hard;
  uint64_t seed = 10;
  const shade_isa_table *isa = shade_isa_pick(0);
  const double tilts[] = {0, 5, 20, 45, 70, 85}, views[][2] = {{0.5, 1}, {0.9, 2.6}, {1.4, -2.9}};
  print_message("facets: alpha .2 and .5; tilt, eye; albedo; largest f cos / pdf, deviation\n");
  for (int mdf = SHADE_MDF_BECKMANN; mdf <= SHADE_MDF_GGX; mdf++)
    for (int k = 0; k < 6; k++)
      for (int view = 0; view < 3; view++) {
        double tilt = tilts[k] * PI / 180, n[3], wo[3];
        const int matt = view == 1 && mdf == SHADE_MDF_GGX;
        shade_params p;
        shade_params_init(&p);
        shade_params_set_alphas(&p, 0.2, 0.5);
        p.fresnel = SHADE_FRESNEL_NONE;
        p.mdf = (shade_mdf)mdf;
        p.brdf = SHADE_BRDF_MICROFACET;
        p.detail = k & 1 ? SHADE_DETAIL_GRAM_SCHMIDT : SHADE_DETAIL_ROTATE;
        for (int c = 0; c < 3; c++) {
          p.f0[c] = matt ? 0.4 : 1;
          p.kd[c] = matt ? 0.5 : 0;
        }
        p.horizon = SHADE_HORIZON_SCHUESSLER;
        shade_bsdf b;
        shade_bsdf_setup(&b, &p);
        spherical(tilt, 0.7, n);
        spherical(views[view][0], 0.7 + views[view][1], wo);
        set_eye(&m, n, wo);
        average a = from_draws(isa, &b, &m, &seed);
        if (k == 0) {
          p.horizon = SHADE_HORIZON_HARD;
          memcpy(&hard, &m, sizeof hard);
          shade_bsdf plain;
          shade_bsdf_setup(&plain, &p);
          draw(isa, &plain, &hard, BATCH);
          draw(isa, &b, &m, BATCH);
          assert_memory_equal(m.out, hard.out, sizeof m.out);
        }
        long missed = 0;
        double want = by_midpoints(isa, &b, &m, &missed);
        print_message("  %-8s %2.0f %2.0f  %.4f  %6.2f %5.2f\n",
                      shade_list_word(SHADE_LIST_MDF, mdf), tilts[k], views[view][0] * 180 / PI,
                      want, a.largest, a.deviation / a.mean);
        assert_int_equal(missed, 0);
        assert_true(want > 1e-3);
        assert_true(matt || k == 0 || a.largest <= fmax(2, 1 + 1 / tan(tilt)) * (1 + 1e-9));
        if (fabs(a.mean - want) > 5 * a.deviation / sqrt((double)a.draws) + 1e-3 * SLOWED * want)
          fail_msg("%g from draws, %g by quadrature", a.mean, want);
      }
}

/*
 * Narrow and wide lobes, float and double: the half vector's angles, put through the
 * distribution functions of the lobe, are uniform. wo = n, so that nothing is lost but what
 * is more than 45 degrees from n; lobes that lose more are judged by test_sample.c.
 */
static void narrow_lobes(void **state) {
  (void)state;
  enum { SIDE = 16 };
  static lanes m;
  static long counts[SIDE * SIDE];
  const double exponents[][2] = {{1e6, 1e6}, {1e6, 1e2}, {1e5, 1e4}, {50, 1e3}};
  const shade_isa_table *isa = shade_isa_pick(0);
  uint64_t seed = 7;
  double worst = 0;
  for (int e = 0; e < 4; e++)
    for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
      for (int single = 0; single < 2; single++) {
        shade_params p;
        shade_params_init(&p);
        shade_params_set_exponents(&p, exponents[e][0], exponents[e][1]);
        if (mdf != SHADE_MDF_ASHIKHMIN_SHIRLEY && e == 0)
          shade_params_set_alphas(&p, 1e-4, 3e-4);
        p.mdf = (shade_mdf)mdf;
        p.horizon = SHADE_HORIZON_HARD;
        shade_bsdf b;
        shade_bsdf_setup(&b, &p);
        double n[3];
        float nf[3];
        spherical(0.7, 0.9, n);
        for (int c = 0; c < 3; c++)
          n[c] = (double)(nf[c] = (float)n[c]);
        memset(counts, 0, sizeof counts);
        long total = 0;
        for (int round = 0; round < 200 / SLOWED; round++) {
          for (int i = 0; i < BATCH; i++)
            for (int c = 0; c < 3; c++) {
              m.in[c][i] = m.in[3 + c][i] = n[c];
              m.in[6 + c % 2][i] = uniform(&seed);
            }
          (single ? drawf : draw)(isa, &b, &m, BATCH);
          for (int i = 0; i < BATCH; i++) {
            double h[3], v[3], pdf = single ? (double)m.outf[6][i] : m.out[6][i];
            if (pdf == 0)
              continue;
            for (int c = 0; c < 3; c++)
              h[c] = n[c] + (single ? (double)m.outf[c][i] : m.out[c][i]);
            shade_ref_carried(&p, n, h, v);
            /* the stretch that makes the lobe round, then its angle's distribution function */
            int phong = mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY || mdf == SHADE_MDF_WARD;
            double kx = mdf == SHADE_MDF_WARD ? 2 / (p.ax * p.ax) : p.ex + 1;
            double ky = mdf == SHADE_MDF_WARD ? 2 / (p.ay * p.ay) : p.ey + 1;
            if (mdf == SHADE_MDF_WARD)
              kx++, ky++;
            if (!phong) {
              kx = 1 / (p.ax * p.ax);
              ky = 1 / (p.ay * p.ay);
            }
            double x = v[0] * sqrt(kx), y = v[1] * sqrt(ky);
            double sin2 = v[0] * v[0] + v[1] * v[1], tan2 = sin2 / (v[2] * v[2]);
            double k = sin2 > 0 ? (x * x + y * y) / sin2 : kx, below;
            if (phong)
              below = -expm1(-0.5 * k * log1p(tan2));
            else if (mdf == SHADE_MDF_WARD_HALF)
              below = expm1(-2 * k * sin2 / (1 + v[2])) / expm1(-2 * k);
            else if (mdf == SHADE_MDF_BECKMANN)
              below = -expm1(-k * tan2);
            else
              below = k * tan2 / (1 + k * tan2);
            int row = (int)fmin(below * SIDE, SIDE - 1);
            int column = (int)((atan2(y, x) / (2 * PI) + 0.5) * SIDE);
            counts[row * SIDE + (column < SIDE ? column : SIDE - 1)]++;
            total++;
          }
        }
        /* GGX's and the widest lobes' last ring is short of what was lost */
        int rings = total < 199 * BATCH / SLOWED ? SIDE / 2 : SIDE;
        double x = 0, each = (double)(200 / SLOWED * BATCH) / (SIDE * SIDE);
        for (int i = 0; i < rings * SIDE; i++)
          x += ((double)counts[i] - each) * ((double)counts[i] - each) / each;
        /* Wilson and Hilferty's normal variable */
        double dof = rings * SIDE - 1.0, t = 2 / (9 * dof);
        double z = (cbrt(x / dof) - (1 - t)) / sqrt(t);
        worst = fmax(worst, z);
        if (z > 3.9) /* 5e-5 one-sided; 40 cases */
          fail_msg("%s, case %d, %s: chi-square %.0f of %.0f (z %.1f)",
                   shade_list_word(SHADE_LIST_MDF, mdf), e, single ? "float" : "double", x, dof, z);
      }
  print_message("narrow lobes: largest z %.1f\n", worst);
}

/*
 * Visible normals as slopes per alpha, t towards the eye's azimuth and s across it: their density
 * is that of the slopes times rise + lean t (cosine and sine of the stretched eye), where that is
 * above 0. The distribution function of t, and that of s at a given t. [Heitz2014]
 */
typedef struct visible {
  int ggx;
  double rise, lean, c, s; /* c, s: the stretched eye's azimuth */
} visible;

static double up_to(const visible *v, double t) { /* from minus infinity, not normalised */
  if (v->ggx)
    return 0.5 * (v->rise * (1 + t / hypot(1, t)) - v->lean / hypot(1, t));
  return 0.5 * v->rise * erfc(-t) - 0.5 * v->lean * exp(-t * t) / sqrt(PI);
}

static double along_below(const visible *v, double t) {
  double least = v->lean > 0 ? -v->rise / v->lean : -1e300;
  double none = up_to(v, fmax(least, -1e8)), all = v->rise;
  return fmax(up_to(v, t) - none, 0) / (all - none);
}

static double across_below(const visible *v, double t, double s) {
  double r = s / hypot(1, t);
  return v->ggx ? 0.5 + (atan(r) + r / (1 + r * r)) / PI : 0.5 * erfc(-s);
}

/* The t or (at that t) s with `share` below it, by bisection. */
static double quantile(const visible *v, const double *t, double share) {
  double low = -1e5, high = 1e5;
  for (int k = 0; k < 70; k++) {
    double x = 0.5 * (low + high);
    *((t ? across_below(v, *t, x) : along_below(v, x)) < share ? &low : &high) = x;
  }
  return 0.5 * (low + high);
}

/* Where in the frame of n (o: the eye, up: z) the light of slopes (t, s) comes from: the lesser
 * of its heights above both horizons. */
static double height(const visible *v, const shade_params *p, double t, double s, const double o[3],
                     const double up[3]) {
  double h[3] = {p->ax * (t * v->c - s * v->s), p->ay * (t * v->s + s * v->c), 1}, wi[3];
  double size2 = h[0] * h[0] + h[1] * h[1] + 1, along = h[0] * o[0] + h[1] * o[1] + o[2];
  for (int c = 0; c < 3; c++)
    wi[c] = 2 * along / size2 * h[c] - o[c];
  return fmin(wi[2], wi[0] * up[0] + wi[1] * up[1] + wi[2] * up[2]);
}

/*
 * Narrow visible lobes under a tilted normal, carried by rotate, and an eye that grazes the
 * microfacets: both distribution functions of what was drawn are uniform, in those of their
 * squares from which no light is lost below a horizon.
 */
static void visible_lobes(void **state) {
  (void)state;
  enum { SIDE = 16, EDGES = 3 };
  static lanes m;
  static long counts[SIDE * SIDE];
  static char inside[SIDE * SIDE];
  const struct {
    double ax, ay, tilt, eye, turn; /* the eye from n, turned from the horizontal; radians */
    int floats;
  } cases[] = {{1e-3, 1e-3, PI / 4, 1, 0, 1},
               {1e-3, 0.3, PI / 4, 1.05, 0.3, 1},
               {0.5, 1e-3, PI / 4, 0.9, -0.4, 1},
               {1e-3, 2e-2, PI / 4, 1.5, 0, 1},
               /* h loses digits of float to this eye: the test would, too */
               {1e-3, 3e-3, 0, PI / 2 - 2e-3, 0.2, 0}};
  const shade_isa_table *isa = shade_isa_pick(0);
  uint64_t seed = 11;
  double worst = 0;
  for (int k = 0; k < 5; k++)
    for (int ggx = 0; ggx < 2; ggx++)
      for (int single = 0; single <= cases[k].floats; single++) {
        shade_params p;
        shade_params_init(&p);
        shade_params_set_alphas(&p, cases[k].ax, cases[k].ay);
        p.mdf = ggx ? SHADE_MDF_GGX : SHADE_MDF_BECKMANN;
        p.brdf = SHADE_BRDF_MICROFACET;
        p.detail = SHADE_DETAIL_ROTATE;
        p.horizon = SHADE_HORIZON_HARD;
        shade_bsdf b;
        shade_bsdf_setup(&b, &p);
        double n[3], wo[3], o[3], up[3];
        const double z[3] = {0, 0, 1}, azimuth = 0.9;
        const double e[3] = {-sin(azimuth), cos(azimuth), 0}; /* horizontal, normal to n */
        spherical(cases[k].tilt, azimuth, n);
        const double f[3] = {n[1] * e[2] - n[2] * e[1], n[2] * e[0] - n[0] * e[2],
                             n[0] * e[1] - n[1] * e[0]};
        for (int c = 0; c < 3; c++) {
          double side = e[c] * cos(cases[k].turn) + f[c] * sin(cases[k].turn);
          wo[c] = n[c] * cos(cases[k].eye) + side * sin(cases[k].eye);
        }
        for (int c = 0; c < 3; c++) {
          n[c] = single ? (double)(float)n[c] : n[c];
          wo[c] = single ? (double)(float)wo[c] : wo[c];
        }
        shade_ref_carried(&p, n, wo, o);
        shade_ref_carried(&p, n, z, up);
        double x = p.ax * o[0], y = p.ay * o[1], lean = hypot(x, y), size = hypot(lean, o[2]);
        const visible v = {ggx, o[2] / size, lean / size, x / lean, y / lean};
        int squares = 0;
        for (int i = 0; i < SIDE * SIDE; i++) {
          inside[i] = 1;
          for (int j = 0; j < EDGES * EDGES; j++) {
            double ft = (i / SIDE + (j / EDGES) / (EDGES - 1.0)) / SIDE;
            double fs = (i % SIDE + (j % EDGES) / (EDGES - 1.0)) / SIDE;
            double t = quantile(&v, NULL, fmin(fmax(ft, 1e-6), 1 - 1e-6));
            double s = quantile(&v, &t, fmin(fmax(fs, 1e-6), 1 - 1e-6));
            inside[i] = inside[i] && height(&v, &p, t, s, o, up) > 0;
          }
          squares += inside[i];
        }
        memset(counts, 0, sizeof counts);
        const int rounds = 400 / SLOWED;
        set_eye(&m, n, wo);
        for (int round = 0; round < rounds; round++) {
          for (int i = 0; i < BATCH; i++) {
            m.in[6][i] = uniform(&seed);
            m.in[7][i] = uniform(&seed);
          }
          (single ? drawf : draw)(isa, &b, &m, BATCH);
          for (int i = 0; i < BATCH; i++) {
            double h[3], q[3];
            if ((single ? (double)m.outf[6][i] : m.out[6][i]) == 0)
              continue;
            for (int c = 0; c < 3; c++)
              h[c] = wo[c] + (single ? (double)m.outf[c][i] : m.out[c][i]);
            shade_ref_carried(&p, n, h, q);
            double sx = q[0] / q[2] / p.ax, sy = q[1] / q[2] / p.ay;
            double t = sx * v.c + sy * v.s, s = sy * v.c - sx * v.s;
            int row = (int)fmin(along_below(&v, t) * SIDE, SIDE - 1);
            counts[row * SIDE + (int)fmin(across_below(&v, t, s) * SIDE, SIDE - 1)]++;
          }
        }
        double chi2 = 0, each = (double)rounds * BATCH / (SIDE * SIDE);
        for (int i = 0; i < SIDE * SIDE; i++)
          chi2 += inside[i] ? ((double)counts[i] - each) * ((double)counts[i] - each) / each : 0;
        double dof = squares * (1 - 1.0 / (SIDE * SIDE)), w = 2 / (9 * dof);
        double normal = (cbrt(chi2 / dof) - (1 - w)) / sqrt(w);
        worst = fmax(worst, normal);
        assert_true(squares >= SIDE * SIDE / 2);
        if (normal > 3.7) /* 1e-4 one-sided; 18 cases */
          fail_msg("%s, case %d, %s: chi-square %.0f of %.0f (z %.1f)", ggx ? "ggx" : "beckmann", k,
                   single ? "float" : "double", chi2, dof, normal);
      }
  print_message("visible lobes: largest z %.1f\n", worst);
}

/* A draw's pdf and f are those of the calls; every instruction set draws the same. */
static void same_everywhere(void **state) {
  (void)state;
  static lanes m, other;
  uint64_t seed = 8;
  long lanes_seen = 0, apart = 0, apartf = 0;
  for (int k = 0; k < 400 / SLOWED; k++) {
    shade_params p = random_params(&seed, 4);
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    for (int i = 0; i < BATCH; i++) {
      double n[3], wo[3], unused[3];
      random_directions(&seed, n, wo, unused);
      for (int c = 0; c < 3; c++) {
        m.in[c][i] = n[c];
        m.in[3 + c][i] = wo[c];
      }
      m.in[6][i] = uniform(&seed);
      m.in[7][i] = uniform(&seed);
    }
    memcpy(other.in, m.in, sizeof m.in);
    draw(shade_isa_pick(0), &b, &m, BATCH);
    drawf(shade_isa_pick(0), &b, &m, BATCH);
    for (int i = 0; i < BATCH; i += 37) {
      double n[3], wo[3], u[2], wi[3], f[3], g[3], pdf, cosine, cosine2;
      for (int c = 0; c < 3; c++) {
        n[c] = m.in[c][i];
        wo[c] = m.in[3 + c][i];
      }
      u[0] = m.in[6][i];
      u[1] = m.in[7][i];
      unsigned status = shade_bsdf_sample(&b, n, wo, u, wi, f, &pdf, &cosine);
      if (pdf == 0) {
        assert_true(status & SHADE_NO_SAMPLE);
        continue;
      }
      assert_int_equal(status, SHADE_OK);
      assert_near(wi[0] * wi[0] + wi[1] * wi[1] + wi[2] * wi[2], 1, 1e-14);
      assert_near(pdf, shade_bsdf_pdf(&b, n, wi, wo, NULL), 1e-12 * pdf);
      shade_bsdf_eval(&b, n, wi, wo, g, &cosine2);
      for (int c = 0; c < 3; c++)
        assert_near(f[c], g[c], 1e-11 * g[c] + 1e-290);
      assert_near(cosine, cosine2, 1e-15);
      if (fabs(wi[0] - m.out[0][i]) > 1e-6)
        apart++;
    }
    const shade_isa_table *isa;
    for (int row = 1; (isa = shade_isa_pick(row)); row++) {
      draw(isa, &b, &other, BATCH);
      drawf(isa, &b, &other, BATCH);
      for (int i = 0; i < BATCH; i++) {
        lanes_seen++;
        double off = 0, offf = 0;
        for (int c = 0; c < 3; c++) {
          off = fmax(off, fabs(m.out[c][i] - other.out[c][i]));
          offf = fmax(offf, fabs((double)(m.outf[c][i] - other.outf[c][i])));
        }
        apart += off > 1e-7;
        apartf += offf > 2e-3;
      }
    }
  }
  print_message("%ld lanes, apart: %ld double, %ld float\n", lanes_seen, apart, apartf);
  /* a u, or a wi, within a rounding of a border may fall on its other side */
  assert_true((double)apart <= 1e-6 * (double)lanes_seen + 1);
  assert_true((double)apartf <= 1e-3 * (double)lanes_seen + 1);
}

/* Anything at all in, nothing but numbers out; and what is drawn has a pdf. */
static void any_input(void **state) {
  (void)state;
  static lanes m;
  const double odd[] = {NAN,  INFINITY, -INFINITY, 0,     -0.0,   1,   -1, DBL_MAX, -DBL_MAX,
                        1e-3, 1e30,     1e-30,     1e-40, 5e-324, 0.5, 2,  -2,      1e-8};
  const double sizes[] = {0, 1, 1e6, 1e-4, 10, 100};
  uint64_t seed = 9;
  long drawn = 0;
  int rows = 0;
  while (shade_isa_pick(rows))
    rows++;
  for (int k = 0; k < 2000 / SLOWED; k++) {
    shade_params p = random_params(&seed, 6);
    if (uniform(&seed) < 0.3)
      shade_params_set_exponents(&p, sizes[(int)(uniform(&seed) * 6)],
                                 sizes[(int)(uniform(&seed) * 6)]);
    else if (uniform(&seed) < 0.5)
      shade_params_set_alphas(&p, sizes[(int)(uniform(&seed) * 6)],
                              sizes[(int)(uniform(&seed) * 6)]);
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    const int finite = k & 1;
    for (int i = 0; i < BATCH; i++) {
      double n[3], wo[3], unused[3];
      random_directions(&seed, n, wo, unused);
      if (uniform(&seed) < 0.1) { /* n near y, x or z */
        for (int c = 0; c < 3; c++)
          n[c] = pow(10, -40 * uniform(&seed));
        n[(int)(3 * uniform(&seed))] = 1;
      }
      for (int c = 0; c < 3; c++) {
        m.in[c][i] = n[c];
        m.in[3 + c][i] = wo[c];
      }
      m.in[6][i] = uniform(&seed) < 0.1 ? uniform(&seed) < 0.5 : uniform(&seed);
      m.in[7][i] = uniform(&seed) < 0.1 ? uniform(&seed) < 0.5 : uniform(&seed);
      if (!finite && uniform(&seed) < 0.5)
        m.in[(int)(8 * uniform(&seed))][i] = odd[(int)(uniform(&seed) * 18)];
    }
    const shade_isa_table *isa = shade_isa_pick(k / 2 % rows);
    feclearexcept(FE_ALL_EXCEPT);
    draw(isa, &b, &m, BATCH);
    drawf(isa, &b, &m, BATCH);
    if (finite && fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO))
      fail_msg("floating-point exception %x: %s, %s %s %s, ex %g ey %g ax %g ay %g",
               fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), isa->name,
               shade_list_word(SHADE_LIST_MDF, (int)bsdf_of(&b)->mdf),
               shade_list_word(SHADE_LIST_BRDF, (int)bsdf_of(&b)->brdf),
               shade_list_word(SHADE_LIST_DETAIL, (int)bsdf_of(&b)->detail), p.ex, p.ey, p.ax,
               p.ay);
    for (int i = 0; i < BATCH; i++) {
      for (int c = 0; c < 8; c++) {
        assert_true(isfinite(m.out[c][i]) && isfinite(m.outf[c][i]));
        assert_true(c < 3 || (m.out[c][i] >= 0 && m.outf[c][i] >= 0));
      }
      drawn += m.out[6][i] > 0;
      int found = m.out[0][i] != 0 || m.out[1][i] != 0 || m.out[2][i] != 0;
      assert_true(found == (m.out[6][i] > 0));
      found = m.outf[0][i] != 0 || m.outf[1][i] != 0 || m.outf[2][i] != 0;
      assert_true(found == (m.outf[6][i] > 0));
    }
  }
  assert_true(drawn > 400000 / SLOWED);
  /* the statuses that the header names */
  shade_bsdf b = make_lobe(SHADE_MDF_GGX, SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, 10, 20);
  const double z[3] = {0, 0, 1}, below[3] = {0.6, 0, -0.8}, u[2] = {0.5, 0.5}, bad[2] = {NAN, 0};
  double wi[3], f[3], pdf;
  assert_int_equal(shade_bsdf_sample(&b, z, z, u, wi, f, &pdf, NULL), SHADE_OK);
  assert_int_equal(shade_bsdf_sample(&b, z, z, bad, wi, f, &pdf, NULL),
                   SHADE_BAD_INPUT | SHADE_NO_SAMPLE);
  assert_true(pdf == 0 && wi[2] == 0);
  assert_int_equal(shade_bsdf_sample(&b, z, below, u, wi, f, &pdf, NULL), SHADE_NO_SAMPLE);
  assert_int_equal(shade_bsdf_sample(&b, below, z, u, wi, f, &pdf, NULL) & SHADE_CLAMPED_NORMAL,
                   SHADE_CLAMPED_NORMAL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(against_reference),
      cmocka_unit_test(on_the_pole),
      cmocka_unit_test(albedo),
      cmocka_unit_test(facets),
      cmocka_unit_test(narrow_lobes),
      cmocka_unit_test(visible_lobes),
      cmocka_unit_test(same_everywhere),
      cmocka_unit_test(any_input),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
