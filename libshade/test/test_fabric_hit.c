/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 4.3 */
/*
 * Prepared hits of cloth, and what a lane may bring: the random number, colours, gloss, nap; bad
 * input, structures that are too short.
 */
#include <fenv.h>

#include "cloth.h"

/* ---- one, many, prepared ----------------------------------------------------- */

enum { N = 700 };
#ifdef __SANITIZE_ADDRESS__
enum { CLOTHS_EVERY = 4 }; /* they differ in numbers */
#else
enum { CLOTHS_EVERY = 1 };
#endif
typedef struct arrays {
  double in[22][N], wi[3][N], rgb[3][N], pdf[N], coverage[N];
  float inf[22][N], wif[3][N], rgbf[3][N], pdff[N], coveragef[N];
} arrays;

static void fill(arrays *m, uint64_t *seed) {
  for (int i = 0; i < N; i++) {
    double wi[3], wo[3];
    any_direction(seed, -0.2, wi);
    any_direction(seed, 0, wo);
    const double of[22] = {16 * uniform(seed),
                           16 * uniform(seed),
                           3 * uniform(seed),
                           3 * uniform(seed),
                           FOLD[0],
                           FOLD[1],
                           FOLD[2],
                           wi[0],
                           wi[1],
                           wi[2],
                           wo[0],
                           wo[1],
                           wo[2],
                           uniform(seed),
                           uniform(seed),
                           0.3,
                           0.7,
                           i % 3 ? 1 : 0.4,
                           i % 5 ? 1 : 0.2,
                           uniform(seed),
                           uniform(seed),
                           uniform(seed)};
    for (int k = 0; k < 22; k++) {
      m->inf[k][i] = (float)of[k];
      m->in[k][i] = (double)m->inf[k][i];
    }
  }
}

#define LANES_OF(in)                                                                               \
  {                                                                                                \
    .u = in[0], .v = in[1], .du = in[2], .dv = in[3], .nx = in[4], .ny = in[5], .nz = in[6],       \
    .wix = in[7], .wiy = in[8], .wiz = in[9], .wox = in[10], .woy = in[11], .woz = in[12],         \
    .random = in[13], .warp_r = in[14], .warp_g = in[15], .warp_b = in[16], .warp_gloss = in[17],  \
    .weft_gloss = in[18], .u1 = in[19], .u2 = in[20], .u3 = in[21]                                 \
  }

/* The point of lane i. */
static shade_fabric_point point_of(const cloth *c, const arrays *m, int i) {
  shade_fabric_point p;
  shade_fabric_point_init(c->fabric, &p);
  for (int a = 0; a < 2; a++) {
    p.uv[a] = m->in[a][i];
    p.footprint[a] = m->in[2 + a][i];
  }
  for (int a = 0; a < 3; a++) {
    p.n[a] = m->in[4 + a][i];
    p.warp_kd[a] = m->in[14 + a][i];
  }
  p.random = m->in[13][i];
  p.warp_gloss = m->in[17][i];
  p.weft_gloss = m->in[18][i];
  return p;
}

static void one_is_many_is_prepared(void **state) {
  (void)state;
  static arrays m, again;
  uint64_t seed = 4;
  cloth c = open_cloth("denim", transmits);
  for (int tier = 0; tier < 4; tier++) {
    fill(&m, &seed);
    shade_fabric_lanes in = LANES_OF(m.in);
    in.size = sizeof in;
    shade_fabric_lanesf inf = LANES_OF(m.inf);
    inf.size = sizeof inf;
    const shade_fabric_result out = {.size = sizeof out,
                                     .r = m.rgb[0],
                                     .g = m.rgb[1],
                                     .b = m.rgb[2],
                                     .pdf = m.pdf,
                                     .coverage = m.coverage};
    const shade_fabric_resultf outf = {.size = sizeof outf,
                                       .r = m.rgbf[0],
                                       .g = m.rgbf[1],
                                       .b = m.rgbf[2],
                                       .pdf = m.pdff,
                                       .coverage = m.coveragef};
    const shade_fabric_result to = {.size = sizeof to,
                                    .r = again.rgb[0],
                                    .g = again.rgb[1],
                                    .b = again.rgb[2],
                                    .pdf = again.pdf,
                                    .coverage = again.coverage,
                                    .wix = again.wi[0],
                                    .wiy = again.wi[1],
                                    .wiz = again.wi[2]};
    assert_int_equal(shade_fabric_eval_batch(c.fabric, N, &in, (shade_fabric_tier)tier, &out), 0);
    shade_fabric_eval_batchf(c.fabric, N, &inf, (shade_fabric_tier)tier, &outf);

    void *hits = malloc(shade_fabric_hits_size(N));
    assert_int_equal(
        shade_fabric_prepare_batch(c.fabric, N, &in, (shade_fabric_tier)tier, hits, &to), 0);
    assert_memory_equal(again.coverage, m.coverage, sizeof m.coverage);
    memset(again.coverage, 0, sizeof again.coverage);
    shade_fabric_lanes lights = {
        .size = sizeof lights, .wix = in.wix, .wiy = in.wiy, .wiz = in.wiz};
    assert_int_equal(shade_fabric_hits_eval(c.fabric, N, hits, &lights, &to), 0);
    assert_memory_equal(again.rgb, m.rgb, sizeof m.rgb);
    assert_memory_equal(again.pdf, m.pdf, sizeof m.pdf);
    assert_memory_equal(again.coverage, m.coverage, sizeof m.coverage);
    memset(again.pdf, 0, sizeof again.pdf);
    shade_fabric_hits_pdf(c.fabric, N, hits, &lights, &to);
    assert_memory_equal(again.pdf, m.pdf, sizeof m.pdf);

    int behind = 0, lit = 0;
    double worst = 0, worstf = 0;
    for (int i = 0; i < N; i++) {
      const shade_fabric_point p = point_of(&c, &m, i);
      const double wi[3] = {in.wix[i], in.wiy[i], in.wiz[i]},
                   wo[3] = {in.wox[i], in.woy[i], in.woz[i]};
      double s[3], coverage;
      shade_fabric_hit hit;
      shade_fabric_prepare(c.fabric, &p, wo, (shade_fabric_tier)tier, &hit, &coverage);
      shade_fabric_hit_eval(c.fabric, &hit, wi, s);
      const double pdf = shade_fabric_hit_pdf(c.fabric, &hit, wi, NULL);
      assert_near(shade_fabric_pdf(c.fabric, &p, wi, wo, (shade_fabric_tier)tier, NULL), pdf, 0);
      assert_near(coverage, m.coverage[i], 1e-15);
      assert_near((double)m.coveragef[i], coverage, 1e-6);
      for (int a = 0; a < 3; a++) {
        worst = fmax(worst, fabs(s[a] - m.rgb[a][i]) / (s[a] + 1e-3));
        worstf = fmax(worstf, fabs(s[a] - (double)m.rgbf[a][i]) / (s[a] + 1e-3));
      }
      worst = fmax(worst, fabs(pdf - m.pdf[i]) / (pdf + 1e-3));
      worstf = fmax(worstf, fabs(pdf - (double)m.pdff[i]) / (pdf + 1e-3));
      lit += wi[2] > 0 && s[1] > 0;
      behind += wi[2] < 0 && s[1] > 0;
    }
    print_message("tier %d: single against batch %.1e, float against double %.1e; lit %d, from "
                  "behind %d\n",
                  tier, worst, worstf, lit, behind);
    assert_true(worst <= 1e-11);
    assert_true(worstf <= 3e-4);
    assert_true(lit > N / 4 && behind > N / 40);

    assert_int_equal(shade_fabric_sample_batch(c.fabric, N, &in, (shade_fabric_tier)tier, &to) &
                         ~(unsigned)SHADE_NO_SAMPLE,
                     0);
    memcpy(m.wi, again.wi, sizeof m.wi);
    memset(again.wi, 0, sizeof again.wi);
    shade_fabric_hits_sample(c.fabric, N, hits, &in, &to);
    assert_memory_equal(again.wi, m.wi, sizeof m.wi);
    for (int i = 0; i < N; i++) {
      const shade_fabric_point p = point_of(&c, &m, i);
      const double wo[3] = {in.wox[i], in.woy[i], in.woz[i]}, u[3] = {in.u1[i], in.u2[i], in.u3[i]};
      double wi[3], s[3], pdf;
      shade_fabric_sample(c.fabric, &p, wo, (shade_fabric_tier)tier, u, wi, s, &pdf);
      for (int a = 0; a < 3; a++) {
        assert_near(wi[a], m.wi[a][i], 1e-9);
        assert_near(s[a], again.rgb[a][i], 1e-9 * (1 + s[a]));
      }
      assert_near(pdf, again.pdf[i], 1e-9 * (1 + pdf));
    }
    free(hits);
  }
  close_cloth(&c);
}

/* Footprints of few yarns that go along them for many: their noise is between up to five numbers,
 * which lanes have in common where they lie side by side, as those of a pixel do, and a single call
 * looks up one after another. */
static void streaks_of_many_are_those_of_one(void **state) {
  (void)state;
  static arrays m;
  uint64_t seed = 11;
  for (int k = 0; k < 6; k++) {
    static const char *const names[3] = {"silk_shantung", "linen", "wool_flannel"};
    cloth c = open_cloth(names[k % 3], NULL);
    fill(&m, &seed);
    for (int i = 0; i < N; i++) {
      m.in[2 + i % 2][i] = 12 * uniform(&seed);
      m.in[3 - i % 2][i] = 60 * uniform(&seed);
      for (int a = 0; a < 2 && k >= 3; a++) { /* 16 of a pixel, on either side of 0 */
        m.in[a][i] = (i / 16 * 5 % 29 - 14) * 7.5 + 9 * uniform(&seed);
        m.in[2 + a][i] = 8 + a;
      }
      for (int a = 0; a < 4; a++)
        m.inf[a][i] = (float)(m.in[a][i] = (double)(float)m.in[a][i]);
    }
    shade_fabric_lanes in = LANES_OF(m.in);
    in.size = sizeof in;
    shade_fabric_lanesf inf = LANES_OF(m.inf);
    inf.size = sizeof inf;
    const shade_fabric_result out = {
        .size = sizeof out, .r = m.rgb[0], .g = m.rgb[1], .b = m.rgb[2]};
    const shade_fabric_resultf outf = {
        .size = sizeof outf, .r = m.rgbf[0], .g = m.rgbf[1], .b = m.rgbf[2]};
    shade_fabric_eval_batch(c.fabric, N, &in, SHADE_TIER_FAR, &out);
    shade_fabric_eval_batchf(c.fabric, N, &inf, SHADE_TIER_FAR, &outf);
    double worst = 0, worstf = 0;
    for (int i = 0; i < N; i++) {
      const shade_fabric_point p = point_of(&c, &m, i);
      const double wi[3] = {in.wix[i], in.wiy[i], in.wiz[i]},
                   wo[3] = {in.wox[i], in.woy[i], in.woz[i]};
      double s[3];
      s_of(&c, &p, wi, wo, SHADE_TIER_FAR, s);
      for (int a = 0; a < 3; a++) {
        worst = fmax(worst, fabs(m.rgb[a][i] - s[a]) / fmax(s[a], 1e-3));
        worstf = fmax(worstf, fabs((double)m.rgbf[a][i] - s[a]) / fmax(s[a], 1e-2));
      }
    }
    print_message("streaks of %s, %s, and one by one: %.1e apart, in float %.1e\n", names[k % 3],
                  k < 3 ? "anywhere" : "side by side", worst, worstf);
    assert_true(worst < 1e-9);
    assert_true(worstf < 3e-4);
    close_cloth(&c);
  }
}

/* ---- lanes side by side -------------------------------------------------------- */

enum { BATCH = 1024 };
typedef struct batch {
  float in[10][BATCH], rgb[2][3][BATCH]; /* each lane by itself, and side by side */
  double ind[10][BATCH], rgbd[2][3][BATCH];
} batch;

/* What lanes side by side are off each by itself, over that. */
typedef struct apart {
  double lane, worst, pixel, mean; /* root mean squares, the largest, and of all lanes' sums */
  int others;                      /* lanes that are not the same to the last bit */
} apart;

/* Pixels of `samples` each in Z-order, as wide as their footprints, about a corner. */
static void fill_pixels(batch *b, int samples, const double corner[2], const double extent[2],
                        uint64_t *seed) {
  for (int i = 0; i < BATCH; i++) {
    const int number = i / samples;
    int pixel[2] = {0, 0};
    for (int bit = 0; bit < 8; bit++)
      for (int a = 0; a < 2; a++)
        pixel[a] |= (number >> (2 * bit + a) & 1) << bit;
    for (int a = 0; a < 2; a++) { /* as a filter 1.5 pixels wide spreads them, or nearly */
      const double in_pixel = 0.5 * (uniform(seed) + uniform(seed) + uniform(seed) - 1.5);
      b->in[a][i] = (float)(corner[a] + (pixel[a] + in_pixel) * extent[a]);
      b->in[2 + a][i] = (float)(extent[a] * (1 + 0.004 * pixel[1 - a])); /* towards a horizon */
    }
    const double rest[6] = {0.2, 0.3, sqrt(0.87), -0.1, 0.2, sqrt(0.95)};
    for (int a = 0; a < 6; a++)
      b->in[4 + a][i] = (float)rest[a];
    for (int a = 0; a < 10; a++)
      b->ind[a][i] = (double)b->in[a][i];
  }
}

#define SIDE_BY_SIDE(in, sides)                                                                    \
  {                                                                                                \
    .size = sizeof(shade_fabric_lanes), .u = in[0], .v = in[1], .du = in[2], .dv = in[3],          \
    .wix = in[4], .wiy = in[5], .wiz = in[6], .wox = in[7], .woy = in[8], .woz = in[9],            \
    .neighbours = sides                                                                            \
  }
_Static_assert(sizeof(shade_fabric_lanes) == sizeof(shade_fabric_lanesf), "pointers");

static void both_ways(const cloth *c, batch *b) {
  for (size_t k = 0; k < 2; k++) {
    const shade_fabric_lanesf inf = SIDE_BY_SIDE(b->in, k);
    const shade_fabric_resultf outf = {
        .size = sizeof outf, .r = b->rgb[k][0], .g = b->rgb[k][1], .b = b->rgb[k][2]};
    const shade_fabric_lanes in = SIDE_BY_SIDE(b->ind, k);
    const shade_fabric_result out = {
        .size = sizeof out, .r = b->rgbd[k][0], .g = b->rgbd[k][1], .b = b->rgbd[k][2]};
    assert_int_equal(shade_fabric_eval_batchf(c->fabric, BATCH, &inf, SHADE_TIER_FAR, &outf), 0);
    assert_int_equal(shade_fabric_eval_batch(c->fabric, BATCH, &in, SHADE_TIER_FAR, &out), 0);
  }
}

static apart apart_of(const cloth *c, int samples, const double extent[2], uint64_t *seed) {
  enum { TILES = 32 };
  static batch b;
  apart found = {0, 0, 0, 0, 0};
  double sum[2] = {0, 0};
  for (int tile = 0; tile < TILES; tile++) {
    const double corner[2] = {(tile % 8 - 4) * 137.3, (tile / 8 - 2) * 91.7};
    fill_pixels(&b, samples, corner, extent, seed);
    both_ways(c, &b);
    for (int first = 0; first < BATCH; first += samples) {
      double of[2] = {0, 0};
      for (int i = first; i < first + samples; i++) {
        const double own = (double)b.rgb[0][1][i], seen = (double)b.rgb[1][1][i];
        assert_near(seen, b.rgbd[1][1][i], 3e-4 * own); /* of both precisions alike */
        found.lane += pow(seen / own - 1, 2) / (TILES * BATCH);
        found.worst = fmax(found.worst, fabs(seen / own - 1));
        found.others += b.rgb[0][1][i] != b.rgb[1][1][i];
        of[0] += own;
        of[1] += seen;
      }
      found.pixel += pow(of[1] / of[0] - 1, 2) * samples / (TILES * BATCH);
      sum[0] += of[0];
      sum[1] += of[1];
    }
  }
  found.lane = sqrt(found.lane);
  found.pixel = sqrt(found.pixel);
  found.mean = sum[1] / sum[0] - 1;
  return found;
}

/* Of each lane by itself, pixel by pixel and all together: what fabric.h says of `neighbours`. */
static void lanes_side_by_side_are_near_their_own(void **state) {
  (void)state;
  static const char *const names[] = {"herringbone_tweed", "denim", "linen", "wool_flannel",
                                      "silk_shantung"};
  const double extents[][2] = {{0.8, 0.8}, {2, 2},   {3, 3}, {4, 4}, {6, 6},
                               {8, 8},     {15, 15}, {3, 9}, {9, 3}, {2, 30}};
  uint64_t seed = 21;
  for (size_t k = 0; k < sizeof names / sizeof *names; k += CLOTHS_EVERY) {
    cloth c = open_cloth(names[k], NULL);
    apart most = {0, 0, 0, 0, 0};
    for (size_t row = 0; row < sizeof extents / sizeof *extents; row++)
      for (int samples = 16; samples <= 32; samples *= 2) {
        const apart a = apart_of(&c, samples, extents[row], &seed);
        assert_true(a.others > 16 * BATCH); /* or there is nothing to be off */
        most.lane = fmax(most.lane, a.lane);
        most.worst = fmax(most.worst, a.worst);
        most.pixel = fmax(most.pixel, a.pixel);
        most.mean = fmax(most.mean, fabs(a.mean));
      }
    print_message("%s side by side: a lane %.2e (rms; at most %.3f) off its own, a pixel %.2e "
                  "(rms), all %.1e\n",
                  names[k], most.lane, most.worst, most.pixel, most.mean);
    assert_true(most.lane < 6e-3 && most.worst < 0.07);
    assert_true(most.pixel < 2.5e-3);
    assert_true(most.mean < 1e-4);
    close_cloth(&c);
  }
}

/* Lanes anywhere, of many sizes, of less than a crossing, of one place; callers that know of none.
 */
static void lanes_that_lie_apart_have_their_own(void **state) {
  (void)state;
  static batch b;
  uint64_t seed = 22;
  cloth c = open_cloth("linen", NULL);
  for (int k = 0; k < 5; k++) {
    const double corner[2] = {-40, 17}, extent[2] = {k == 2 ? 0.6 : 6, 6};
    fill_pixels(&b, k < 3 ? 16 : BATCH, corner, extent, &seed);
    for (int i = 0; i < BATCH; i++)
      for (int a = 0; a < 2; a++) {
        b.in[a][i] = k == 0 ? (float)(4e3 * uniform(&seed)) : k == 3 ? 8.25f : b.in[a][i];
        b.in[2 + a][i] *= k == 1 && i % 2 ? 1.3f : 1;
        b.ind[a][i] = (double)b.in[a][i];
        b.ind[2 + a][i] = (double)b.in[2 + a][i];
      }
    both_ways(&c, &b);
    for (int i = 0; i < BATCH && k == 3; i++) /* the same, but for what extents differ */
      assert_near((double)b.rgb[1][1][i], (double)b.rgb[0][1][i], 1e-5);
    if (k < 3) {
      assert_memory_equal(b.rgb[0], b.rgb[1], sizeof b.rgb[0]);
      assert_memory_equal(b.rgbd[0], b.rgbd[1], sizeof b.rgbd[0]);
    }
  }
  shade_fabric_lanesf in = SIDE_BY_SIDE(b.in, 1);
  const shade_fabric_resultf out = {
      .size = sizeof out, .r = b.rgb[1][0], .g = b.rgb[1][1], .b = b.rgb[1][2]};
  in.size = offsetof(shade_fabric_lanesf, neighbours);
  assert_memory_not_equal(b.rgb[0], b.rgb[1], sizeof b.rgb[0]);
  assert_int_equal(shade_fabric_eval_batchf(c.fabric, BATCH, &in, SHADE_TIER_FAR, &out), 0);
  assert_memory_equal(b.rgb[0], b.rgb[1], sizeof b.rgb[0]);
  close_cloth(&c);
}

/* ---- one light in one call ---------------------------------------------------- */

/* What the next cloth is made of. */
static shade_horizon next_horizon;
static int next_transmits;
static void with_all_parts(shade_fabric_params *p) {
  p->horizon = next_horizon;
  p->nap = 0.3;
  if (next_horizon % 2) /* yarns of two kinds are not lit in one loop */
    p->weft.diffuse = SHADE_DIFFUSE_LAMBERT;
  if (next_transmits)
    transmits(p);
  for (int a = 0; a < 3; a++)
    p->backing[a] = 0.1 + 0.2 * a;
}

/*
 * A single call runs other code than lanes do: the same answer for every horizon, kind of lane and
 * side of the cloth, in folds, at grazing angles, with directions of any length, and where there is
 * no direction.
 */
static void one_call_is_a_lane(void **state) {
  (void)state;
  static arrays m;
  uint64_t seed = 12;
  double worst = 0, worstf = 0;
  int lit[2] = {0, 0}, bad = 0;
  for (int k = 0; k < 2 * SHADE_HORIZON_COUNT; k++) {
    next_horizon = (shade_horizon)(k / 2);
    next_transmits = k % 2;
    cloth c = open_cloth(k % 2 ? "linen" : "herringbone_tweed", with_all_parts);
    for (int tier = 0; tier < 4; tier++) {
      fill(&m, &seed);
      for (int i = 0; i < N; i++) {
        const double size = i % 7 == 1 ? 1e-12 : i % 7 == 2 ? 1e12 : i % 70 == 3 ? NAN : 1;
        for (int a = 0; a < 3; a++) {
          m.in[4 + a][i] = i % 2 ? FOLD[a] : a == 2;
          m.in[7 + a][i] *= i % 90 == 4 ? 0 : size;
          if (i % 50 == 5) /* the fold's horizon */
            m.in[7 + a][i] = a == 0 ? 0.8 : a == 1 ? 0.6 - 1e-14 : 0;
          if (i % 50 == 6) /* opposite to the eye */
            m.in[7 + a][i] = -m.in[10 + a][i];
          m.inf[4 + a][i] = (float)m.in[4 + a][i];
          m.inf[7 + a][i] = (float)m.in[7 + a][i];
          m.wi[a][i] = m.in[7 + a][i];
        }
      }
      shade_fabric_lanes in = LANES_OF(m.in);
      shade_fabric_lanesf inf = LANES_OF(m.inf);
      const shade_fabric_result out = {
          .size = sizeof out, .r = m.rgb[0], .g = m.rgb[1], .b = m.rgb[2]};
      const shade_fabric_resultf outf = {
          .size = sizeof outf, .r = m.rgbf[0], .g = m.rgbf[1], .b = m.rgbf[2]};
      in.size = sizeof in;
      inf.size = sizeof inf;
      shade_fabric_eval_batch(c.fabric, N, &in, (shade_fabric_tier)tier, &out);
      shade_fabric_eval_batchf(c.fabric, N, &inf, (shade_fabric_tier)tier, &outf);
      for (int i = 0; i < N; i++) {
        const shade_fabric_point p = point_of(&c, &m, i);
        const double wi[3] = {m.wi[0][i], m.wi[1][i], m.wi[2][i]};
        const double wo[3] = {in.wox[i], in.woy[i], in.woz[i]};
        const float wif[3] = {inf.wix[i], inf.wiy[i], inf.wiz[i]};
        const float wof[3] = {inf.wox[i], inf.woy[i], inf.woz[i]};
        const float nf[3] = {inf.nx[i], inf.ny[i], inf.nz[i]};
        double s[3];
        float sf[3];
        shade_fabric_hit hit;
        shade_fabric_hitf hitf;
        shade_fabric_pointf pf;
        shade_fabric_point_initf(c.fabric, &pf);
        for (int a = 0; a < 3; a++) {
          pf.n[a] = nf[a];
          pf.warp_kd[a] = m.inf[14 + a][i];
        }
        for (int a = 0; a < 2; a++) {
          pf.uv[a] = m.inf[a][i];
          pf.footprint[a] = m.inf[2 + a][i];
        }
        pf.random = inf.random[i];
        pf.warp_gloss = inf.warp_gloss[i];
        pf.weft_gloss = inf.weft_gloss[i];
        shade_fabric_prepare(c.fabric, &p, wo, (shade_fabric_tier)tier, &hit, NULL);
        shade_fabric_preparef(c.fabric, &pf, wof, (shade_fabric_tier)tier, &hitf, NULL);
        const unsigned status = shade_fabric_hit_eval(c.fabric, &hit, wi, s);
        const double size = hypot(hypot(wi[0], wi[1]), wi[2]);
        const double opposite = size + wi[0] * wo[0] + wi[1] * wo[1] + wi[2] * wo[2];
        if (!(size > 0)) {
          assert_int_equal(status, SHADE_BAD_INPUT);
          bad++;
        } else if (opposite > 1e-6 * size) {
          assert_int_equal(status, SHADE_OK);
        }
        shade_fabric_hit_evalf(c.fabric, &hitf, wif, sf);
        lit[wi[2] < 0] += s[1] > 0;
        for (int a = 0; a < 3; a++) {
          assert_true(isfinite(s[a]) && isfinite(sf[a]));
          worst = fmax(worst, fabs(s[a] - m.rgb[a][i]) / (s[a] + 1e-3));
          worstf = fmax(worstf, (double)fabsf(sf[a] - m.rgbf[a][i]) / ((double)sf[a] + 1e-3));
        }
      }
    }
    close_cloth(&c);
  }
  print_message(
      "one call against a lane: %.1e, float %.1e; lit %d, from behind %d, no direction %d\n", worst,
      worstf, lit[0], lit[1], bad);
  assert_true(worst <= 1e-13);
  assert_true(worstf <= 1e-5);
  assert_true(lit[0] > 10000 && lit[1] > 500 && bad > 100);
}

/* ---- the random number -------------------------------------------------------- */

/* All terms in one call, of any horizon, with and without light through the cloth. */
static void random_numbers_mean_all_terms(void **state) {
  (void)state;
  const double footprints[][2] = {{0.3, 0.3}, {1.2, 0.4}, {0.2, 1.5}, {1.9, 1.9}};
  uint64_t seed = 9;
  for (int row = 0; row < 2 * SHADE_HORIZON_COUNT; row++) {
    next_horizon = (shade_horizon)(row / 2);
    next_transmits = row % 2;
    cloth c = open_cloth(row % 3 ? "linen" : "denim", with_all_parts);
    for (int k = 0; k < 60; k++) {
      shade_fabric_point p;
      shade_fabric_point_init(c.fabric, &p);
      double wi[3], wo[3], all[3], sum[3] = {0, 0, 0}, s[3], covered, coverage, sum_covered = 0;
      any_direction(&seed, k % 4 ? 0.1 : -0.9, wi);
      any_direction(&seed, 0.1, wo);
      memcpy(p.footprint, footprints[k % 4], sizeof p.footprint);
      p.uv[0] = 9 * uniform(&seed);
      p.uv[1] = 9 * uniform(&seed);
      if (k % 3)
        memcpy(p.n, FOLD, sizeof p.n);
      p.warp_gloss = k % 5 ? 1 : 0.3;
      shade_fabric_hit hit;
      shade_fabric_prepare(c.fabric, &p, wo, SHADE_TIER_AUTO, &hit, &covered);
      shade_fabric_hit_eval(c.fabric, &hit, wi, all);
      const double density = shade_fabric_hit_pdf(c.fabric, &hit, wi, NULL);
      /* far's share by bisection: random numbers below it give the far tier */
      const double longer = fmax(p.footprint[0], p.footprint[1]);
      const double x = fmin(fmax(log2(longer / 0.75) / log2(2 / 0.75), 0), 1);
      const double share = x * x * (3 - 2 * x);
      double sum_density = 0;
      for (int j = 0; j < 17; j++) {
        p.random = j ? share + (1 - share) * (j - 0.5) / 16 : 0.5 * share;
        const double part = j ? (1 - share) / 16 : share;
        if (!(part > 0))
          continue;
        shade_fabric_prepare(c.fabric, &p, wo, SHADE_TIER_AUTO, &hit, &coverage);
        shade_fabric_hit_eval(c.fabric, &hit, wi, s);
        for (int a = 0; a < 3; a++)
          sum[a] += part * s[a];
        sum_covered += part * coverage;
        sum_density += part * shade_fabric_hit_pdf(c.fabric, &hit, wi, NULL);
      }
      for (int a = 0; a < 3; a++)
        assert_near(sum[a], all[a], 1e-12 * (1 + all[a]));
      assert_near(sum_covered, covered, 1e-12);
      assert_near(sum_density, density, 1e-12 * (1 + density));
    }
    close_cloth(&c);
  }
}

/* A lane whose number is below 0 has all terms, beside others that have one: what one call has. */
static void lanes_below_0_have_all_terms(void **state) {
  (void)state;
  static arrays m;
  uint64_t seed = 12;
  cloth c = open_cloth("denim", transmits);
  fill(&m, &seed);
  for (int i = 0; i < N; i += i < 40 ? 2 : 7) { /* some blocks of lanes have few of them */
    m.in[13][i] = -0.3;
    m.inf[13][i] = -0.3F;
  }
  shade_fabric_lanes in = LANES_OF(m.in);
  in.size = sizeof in;
  shade_fabric_lanesf inf = LANES_OF(m.inf);
  inf.size = sizeof inf;
  in.neighbours = inf.neighbours = 1; /* they are not */
  const shade_fabric_result out = {sizeof out, m.rgb[0], m.rgb[1], m.rgb[2], m.pdf,
                                   m.coverage, m.wi[0],  m.wi[1],  m.wi[2]};
  const shade_fabric_resultf outf = {
      .size = sizeof outf, .r = m.rgbf[0], .g = m.rgbf[1], .b = m.rgbf[2], .pdf = m.pdff};
  void *hits = malloc(shade_fabric_hits_size(N));
  assert_int_equal(shade_fabric_prepare_batch(c.fabric, N, &in, SHADE_TIER_AUTO, hits, NULL),
                   SHADE_BAD_INPUT);
  free(hits);
  shade_fabric_eval_batchf(c.fabric, N, &inf, SHADE_TIER_AUTO, &outf);
  for (int job = 0; job < 2; job++) {
    if (job)
      shade_fabric_sample_batch(c.fabric, N, &in, SHADE_TIER_AUTO, &out);
    else
      assert_int_equal(shade_fabric_eval_batch(c.fabric, N, &in, SHADE_TIER_AUTO, &out), 0);
    for (int i = 0; i < N; i++) {
      const shade_fabric_point p = point_of(&c, &m, i);
      const double wo[3] = {in.wox[i], in.woy[i], in.woz[i]};
      const double u[3] = {in.u1[i], in.u2[i], in.u3[i]};
      double wi[3] = {in.wix[i], in.wiy[i], in.wiz[i]}, s[3], pdf, coverage;
      shade_fabric_hit hit;
      shade_fabric_prepare(c.fabric, &p, wo, SHADE_TIER_AUTO, &hit, &coverage);
      if (job) {
        shade_fabric_hit_sample(c.fabric, &hit, u, wi, s, &pdf);
      } else {
        shade_fabric_hit_eval(c.fabric, &hit, wi, s);
        pdf = shade_fabric_hit_pdf(c.fabric, &hit, wi, NULL);
      }
      assert_near(m.coverage[i], coverage, 1e-12);
      assert_near(m.pdf[i], pdf, 1e-9 * (1 + pdf));
      for (int a = 0; a < 3; a++) {
        assert_near(m.rgb[a][i], s[a], 1e-9 * (1 + s[a]));
        if (job)
          assert_near(m.wi[a][i], wi[a], 1e-9);
        else
          assert_near(m.rgbf[a][i], s[a], 1e-3 * (1 + s[a]));
      }
    }
  }
  close_cloth(&c);
}

/* ---- textures ------------------------------------------------------------------ */

static void other_yarns(shade_fabric_params *p) {
  for (int a = 0; a < 3; a++) {
    p->warp.kd[a] = 0.1 + 0.2 * a;
    p->weft.kd[a] = 0.6 - 0.2 * a;
  }
  p->nap = 0.35;
}

/* A lane's colours and nap are those of a fabric that was made with them. */
static void textures_are_parameters(void **state) {
  (void)state;
  const char *names[] = {"denim", "silk_charmeuse", "shot_taffeta"};
  uint64_t seed = 5;
  for (int name = 0; name < 3; name++) {
    cloth plain = open_cloth(names[name], transmits), made = open_cloth(names[name], transmits);
    shade_fabric_free(made.fabric);
    other_yarns(&made.preset.fabric);
    made.fabric = shade_fabric_create(made.weave, &made.preset.fabric, NULL);
    for (int k = 0; k < 200; k++) {
      double wi[3], wo[3], got[3], want[3];
      any_direction(&seed, k % 4 ? 0.1 : -0.9, wi);
      any_direction(&seed, 0.1, wo);
      shade_fabric_point p, q;
      shade_fabric_point_init(plain.fabric, &p);
      shade_fabric_point_init(made.fabric, &q);
      p.uv[0] = q.uv[0] = 9 * uniform(&seed);
      p.uv[1] = q.uv[1] = 9 * uniform(&seed);
      p.footprint[0] = p.footprint[1] = q.footprint[0] = q.footprint[1] = k % 2 ? 4 : 0.5;
      memcpy(p.warp_kd, made.preset.fabric.warp.kd, sizeof p.warp_kd);
      memcpy(p.weft_kd, made.preset.fabric.weft.kd, sizeof p.weft_kd);
      p.nap = made.preset.fabric.nap;
      for (int tier = 0; tier < 4; tier++) {
        if (wi[2] < 0 && tier != SHADE_TIER_NEAR) /* far, kt goes by the fabric's own kd */
          continue;
        s_of(&plain, &p, wi, wo, (shade_fabric_tier)tier, got);
        s_of(&made, &q, wi, wo, (shade_fabric_tier)tier, want);
        for (int a = 0; a < 3; a++)
          assert_near(got[a], want[a], 1e-12 + 2e-3 * want[a]);
      }
    }
    close_cloth(&plain);
    close_cloth(&made);
  }
}

static void duller(shade_fabric_params *p) {
  p->warp.along *= 0.3;
  p->warp.across *= 0.3;
  p->weft.along *= 0.5;
  p->weft.across *= 0.5;
}

/* Less gloss near is the yarn with smaller exponents; far it is the mean of that. */
static void gloss_scales_exponents(void **state) {
  (void)state;
  uint64_t seed = 6;
  double worst = 0;
  const char *names[] = {"silk_charmeuse", "gabardine"};
  for (int name = 0; name < 2; name++) {
    cloth plain = open_cloth(names[name], NULL), made = open_cloth(names[name], duller);
    shade_fabric_point p;
    shade_fabric_point_init(plain.fabric, &p);
    p.warp_gloss = 0.3;
    p.weft_gloss = 0.5;
    for (int k = 0; k < 200; k++) {
      double wi[3], wo[3], got[3], want[3];
      any_direction(&seed, 0.2, wi);
      any_direction(&seed, 0.2, wo);
      p.uv[0] = 9 * uniform(&seed);
      p.uv[1] = 9 * uniform(&seed);
      s_of(&plain, &p, wi, wo, SHADE_TIER_NEAR, got);
      shade_fabric_eval(made.fabric, p.uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, want);
      for (int a = 0; a < 3; a++)
        assert_near(got[a], want[a], 1e-9 * (1 + want[a]));
      const double all[2] = {1e6, 1e6};
      memcpy(p.footprint, all, sizeof all);
      s_of(&plain, &p, wi, wo, SHADE_TIER_FAR, got);
      shade_fabric_eval(made.fabric, p.uv, all, NULL, wi, wo, SHADE_TIER_FAR, want);
      p.footprint[0] = p.footprint[1] = 0;
      for (int a = 0; a < 3; a++)
        worst = fmax(worst, fabs(got[a] / want[a] - 1));
    }
    close_cloth(&plain);
    close_cloth(&made);
  }
  print_message("far with less gloss against a fabric made so: %.2f %%\n", 100 * worst);
  assert_true(worst <= 0.02);
}

static void with_nap(shade_fabric_params *p) {
  transmits(p);
  p->nap = 0.2;
}

static void no_input_breaks_it(void **state) {
  (void)state;
  cloth c = open_cloth("denim", with_nap);
  const double bad[] = {0, -0.0, 1, -1, NAN, INFINITY, -INFINITY, 1e300, 1e-300, 0.3, -1e18};
  uint64_t seed = 3;
#define ANY bad[(int)(11 * uniform(&seed))]
  for (int k = 0; k < 30000; k++) {
    shade_fabric_point p;
    shade_fabric_point_init(c.fabric, &p);
    for (int a = 0; a < 3; a++) {
      p.n[a] = ANY;
      p.warp_kd[a] = ANY;
    }
    for (int a = 0; a < 2; a++) {
      p.uv[a] = ANY;
      p.footprint[a] = ANY;
    }
    p.random = ANY;
    p.warp_gloss = ANY;
    p.weft_gloss = ANY;
    if (k % 2)
      p.nap = ANY;
    const double wo[3] = {ANY, ANY, ANY}, wi[3] = {ANY, ANY, ANY}, u[3] = {ANY, ANY, ANY};
    double s[3], coverage, drawn[3], pdf;
    shade_fabric_hit hit;
    unsigned status =
        shade_fabric_prepare(c.fabric, &p, wo, (shade_fabric_tier)(k % 6 - 1), &hit, &coverage);
    assert_true(coverage >= 0 && coverage <= 1);
    const int nowhere = !isfinite(p.uv[0]) || !isfinite(wo[1]) || !isfinite(p.n[2]);
    assert_true(!nowhere || status & SHADE_BAD_INPUT);
    status = shade_fabric_hit_eval(c.fabric, &hit, wi, s);
    for (int a = 0; a < 3; a++)
      assert_true(isfinite(s[a]) && s[a] >= 0 && (s[a] == 0 || !nowhere));
    if (!isfinite(wi[0]))
      assert_true((status & SHADE_BAD_INPUT) && s[0] == 0);
    pdf = shade_fabric_hit_pdf(c.fabric, &hit, wi, &status);
    assert_true(isfinite(pdf) && pdf >= 0 && (pdf == 0 || !nowhere));
    status = shade_fabric_hit_sample(c.fabric, &hit, u, drawn, s, &pdf);
    assert_true(isfinite(pdf) && pdf >= 0 && isfinite(s[0] + s[1] + s[2]));
    if (isnan(u[1]) || isnan(u[2]))
      assert_true((status & SHADE_BAD_INPUT) && pdf == 0);
    if (pdf > 0)
      assert_near(n_dot(drawn, drawn), 1, 1e-12);
    else
      assert_true(status & SHADE_NO_SAMPLE);
    float wof[3], wif[3], nf[3], sf[3], pdff, coveragef;
    shade_fabric_pointf q;
    shade_fabric_hitf hitf;
    shade_fabric_point_initf(c.fabric, &q);
    for (int a = 0; a < 3; a++) {
      wof[a] = (float)wo[a];
      wif[a] = (float)wi[a];
      nf[a] = (float)u[a];
      q.n[a] = (float)p.n[a];
      q.weft_kd[a] = (float)p.warp_kd[a];
    }
    q.uv[0] = (float)p.uv[0];
    q.footprint[1] = (float)p.footprint[1];
    q.random = (float)p.random;
    q.warp_gloss = (float)p.weft_gloss;
    q.nap = (float)p.nap;
    shade_fabric_preparef(c.fabric, &q, wof, (shade_fabric_tier)(k % 4), &hitf, &coveragef);
    shade_fabric_hit_evalf(c.fabric, &hitf, wif, sf);
    assert_true(isfinite(sf[0] + sf[1] + sf[2]) && sf[0] >= 0 && coveragef >= 0 && coveragef <= 1);
    pdff = shade_fabric_hit_pdff(c.fabric, &hitf, wif, NULL);
    assert_true(isfinite(pdff) && pdff >= 0);
    shade_fabric_hit_samplef(c.fabric, &hitf, nf, wif, sf, &pdff);
    assert_true(isfinite(pdff) && pdff >= 0 && isfinite(sf[0] + sf[1] + sf[2]));
  }
#undef ANY
  close_cloth(&c);
}

/* Blocks whose lanes are near or far, by their numbers: which, and what points of footprints, as
 * one call for each lane finds. */
static void mixed_blocks_are_their_lanes(void **state) {
  (void)state;
  static arrays m;
  uint64_t seed = 22;
  cloth c = open_cloth("denim", NULL);
  fill(&m, &seed);
  for (int i = 0; i < N; i++) {
    const double size = 0.6 * pow(4, (double)(i * 37 % N) / N); /* all near to all far */
    m.in[2][i] = i % 3 ? size : size / (1 + i % 5);
    m.in[3][i] = i % 3 ? size / (1 + i % 7) : size;
    m.in[13][i] = fmod(0.618034 * i, 1);
  }
  m.in[2][N / 3] = m.in[3][N / 3] = 0;
  shade_fabric_lanes in = LANES_OF(m.in);
  in.size = sizeof in;
  const shade_fabric_result out = {sizeof out, m.rgb[0], m.rgb[1], m.rgb[2], m.pdf,
                                   m.coverage, m.wi[0],  m.wi[1],  m.wi[2]};
  assert_int_equal(shade_fabric_eval_batch(c.fabric, N, &in, SHADE_TIER_AUTO, &out), 0);
  for (int i = 0; i < N; i++) {
    const shade_fabric_point p = point_of(&c, &m, i);
    const double wo[3] = {in.wox[i], in.woy[i], in.woz[i]};
    const double wi[3] = {in.wix[i], in.wiy[i], in.wiz[i]};
    double s[3], coverage;
    shade_fabric_hit hit;
    shade_fabric_prepare(c.fabric, &p, wo, SHADE_TIER_AUTO, &hit, &coverage);
    shade_fabric_hit_eval(c.fabric, &hit, wi, s);
    assert_near(m.coverage[i], coverage, 1e-12);
    for (int a = 0; a < 3; a++)
      assert_near(m.rgb[a][i], s[a], 1e-9 * (1 + s[a]));
  }
  close_cloth(&c);
}

/* A block that is far in every lane is told at once, or one that is mixed, and what is wrong in
 * one of them still said. */
static void blocks_name_bad_input(void **state) {
  (void)state;
  static arrays m;
  uint64_t seed = 21;
  cloth c = open_cloth("denim", NULL);
  fill(&m, &seed);
  shade_fabric_lanes in = LANES_OF(m.in);
  in.size = sizeof in;
  void *hits = malloc(shade_fabric_hits_size(N));
  const struct {
    int array;
    double value;
    unsigned status;
  } wrong[] = {{13, NAN, SHADE_BAD_INPUT}, {2, NAN, SHADE_BAD_INPUT}, {3, NAN, SHADE_BAD_INPUT},
               {2, -1, SHADE_BAD_INPUT},   {3, INFINITY, SHADE_OK},   {13, 7, SHADE_OK}};
  enum { WRONG = sizeof wrong / sizeof *wrong };
  for (size_t all = 0; all < 2 * WRONG; all++) {
    const size_t k = all % WRONG;
    for (int i = 0; i < N && k == 0; i++)
      m.in[2][i] = m.in[3][i] = all ? 1.2 : 3;
    double *value = &m.in[wrong[k].array][N / 2];
    const double kept = *value;
    *value = wrong[k].value;
    assert_int_equal(shade_fabric_prepare_batch(c.fabric, N, &in, SHADE_TIER_AUTO, hits, NULL),
                     wrong[k].status);
    *value = kept;
    assert_int_equal(shade_fabric_prepare_batch(c.fabric, N, &in, SHADE_TIER_AUTO, hits, NULL),
                     SHADE_OK);
  }
  free(hits);
  close_cloth(&c);
}

/* Structures that are too short, and arrays that are required. */
static void short_structures(void **state) {
  (void)state;
  static arrays m;
  uint64_t seed = 2;
  cloth c = open_cloth("denim", NULL);
  fill(&m, &seed);
  shade_fabric_lanes in = LANES_OF(m.in);
  const shade_fabric_result out = {.size = sizeof out,
                                   .r = m.rgb[0],
                                   .g = m.rgb[1],
                                   .b = m.rgb[2],
                                   .pdf = m.pdf,
                                   .coverage = m.coverage,
                                   .wix = m.wi[0],
                                   .wiy = m.wi[1],
                                   .wiz = m.wi[2]};
  shade_fabric_result less = out;
  m.rgb[0][0] = m.pdf[0] = m.wi[0][0] = -7;
  in.size = offsetof(shade_fabric_lanes, woz);
  assert_int_equal(shade_fabric_eval_batch(c.fabric, N, &in, SHADE_TIER_NEAR, &out),
                   SHADE_BAD_INPUT);
  in.size = offsetof(shade_fabric_lanes, u3);
  assert_int_equal(shade_fabric_sample_batch(c.fabric, N, &in, SHADE_TIER_NEAR, &out),
                   SHADE_BAD_INPUT);
  in.size = sizeof in;
  less.size = offsetof(shade_fabric_result, b);
  assert_int_equal(shade_fabric_eval_batch(c.fabric, N, &in, SHADE_TIER_NEAR, &less),
                   SHADE_BAD_INPUT);
  less.size = offsetof(shade_fabric_result, pdf);
  assert_int_equal(shade_fabric_pdf_batch(c.fabric, N, &in, SHADE_TIER_NEAR, &less),
                   SHADE_BAD_INPUT);
  assert_int_equal(shade_fabric_sample_batch(c.fabric, N, &in, SHADE_TIER_NEAR, &less),
                   SHADE_BAD_INPUT);
  in.random = NULL;
  void *hits = malloc(shade_fabric_hits_size(N));
  assert_int_equal(shade_fabric_prepare_batch(c.fabric, N, &in, SHADE_TIER_AUTO, hits, NULL),
                   SHADE_BAD_INPUT);
  assert_int_equal(shade_fabric_prepare_batch(c.fabric, N, &in, SHADE_TIER_NEAR, hits, NULL),
                   SHADE_OK);
  free(hits);
  assert_true(m.rgb[0][0] == -7 && m.pdf[0] == -7 && m.wi[0][0] == -7);
  /* without density or coverage, and without what comes after the eye: as with the fabric's own */
  less = (shade_fabric_result){
      .size = offsetof(shade_fabric_result, pdf), .r = m.rgb[0], .g = m.rgb[1], .b = m.rgb[2]};
  in.size = offsetof(shade_fabric_lanes, random);
  assert_int_equal(shade_fabric_eval_batch(c.fabric, N, &in, SHADE_TIER_NEAR, &less) &
                       ~(unsigned)SHADE_BAD_INPUT,
                   0);
  for (int i = 0; i < N; i++) {
    const double uv[2] = {in.u[i], in.v[i]}, n[3] = {in.nx[i], in.ny[i], in.nz[i]};
    const double wi[3] = {in.wix[i], in.wiy[i], in.wiz[i]},
                 wo[3] = {in.wox[i], in.woy[i], in.woz[i]};
    double s[3];
    shade_fabric_eval(c.fabric, uv, NULL, n, wi, wo, SHADE_TIER_NEAR, s);
    for (int a = 0; a < 3; a++)
      assert_near(s[a], m.rgb[a][i], 1e-12 * (1 + s[a]));
  }
  assert_int_equal(shade_fabric_eval_batch(c.fabric, 0, &in, SHADE_TIER_NEAR, &less), SHADE_OK);
  assert_int_equal(shade_fabric_eval_batch(c.fabric, 0, NULL, SHADE_TIER_NEAR, NULL), SHADE_OK);
  assert_int_equal(shade_fabric_hits_eval(c.fabric, 0, NULL, NULL, NULL), SHADE_OK);
  close_cloth(&c);
}

/* Compilers may compare lanes past the last (-fno-trapping-math), which hold what earlier calls
 * left there: numbers then, so that only what is computed raises exceptions. */
static void leave_numbers(void) {
  volatile float room[65536];
  for (size_t i = 0; i < sizeof room / sizeof room[0]; i++)
    room[i] = 1;
}

/* Light or eye in the horizon, down to the least number there is: a lane without nap is worth what
 * it is where no lane has one, a thick nap hides all, and nothing is divided by 0. */
static void nap_in_the_horizon(void **state) {
  (void)state;
  cloth c = open_cloth("denim", transmits);
  for (int low = 0; low < 2; low++)
    for (int tier = SHADE_TIER_NEAR; tier <= SHADE_TIER_FAR; tier++)
      for (int e = 20; e < 46; e += 5) {
        float part[16], one[16], zero[16], up[16], nap[2][16], rgb[2][3][16];
        double wide[6][16], rgbd[3][16];
        for (int i = 0; i < 16; i++) {
          part[i] = 0.6F;
          up[i] = 0.8F;
          one[i] = 1;
          zero[i] = nap[0][i] = 0;
          nap[1][i] = i % 2 ? 9.0F : 0;
          wide[0][i] = 0.6;
          wide[1][i] = 0.8;
          wide[2][i] = 1;
          wide[3][i] = 0;
          wide[4][i] = pow(10, -e * 7);
          wide[5][i] = i % 2 ? 9 : 0;
        }
        float flat[16];
        for (int i = 0; i < 16; i++)
          flat[i] = powf(10, (float)-e);
        for (int k = 0; k < 2; k++) {
          const shade_fabric_lanesf in = {.size = sizeof in,
                                          .u = part,
                                          .v = part,
                                          .wix = low ? part : one,
                                          .wiy = zero,
                                          .wiz = low ? up : flat,
                                          .wox = low ? one : part,
                                          .woy = zero,
                                          .woz = low ? flat : up,
                                          .nap = nap[k]};
          const shade_fabric_resultf out = {
              .size = sizeof out, .r = rgb[k][0], .g = rgb[k][1], .b = rgb[k][2]};
          leave_numbers();
          feclearexcept(FE_ALL_EXCEPT);
          shade_fabric_eval_batchf(c.fabric, 16, &in, (shade_fabric_tier)tier, &out);
          assert_int_equal(fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW), 0);
        }
        for (int i = 0; i < 16; i++) /* of the nap what is left is its own share */
          assert_true(rgb[1][0][i] >= 0 &&
                      (i % 2 ? rgb[1][0][i] <= 0.08F : rgb[1][0][i] == rgb[0][0][i]));
        const shade_fabric_lanes in = {.size = sizeof in,
                                       .u = wide[0],
                                       .v = wide[0],
                                       .wix = wide[low ? 0 : 2],
                                       .wiy = wide[3],
                                       .wiz = wide[low ? 1 : 4],
                                       .wox = wide[low ? 2 : 0],
                                       .woy = wide[3],
                                       .woz = wide[low ? 4 : 1],
                                       .nap = wide[5]};
        const shade_fabric_result out = {
            .size = sizeof out, .r = rgbd[0], .g = rgbd[1], .b = rgbd[2]};
        leave_numbers();
        feclearexcept(FE_ALL_EXCEPT);
        shade_fabric_eval_batch(c.fabric, 16, &in, (shade_fabric_tier)tier, &out);
        assert_int_equal(fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW), 0);
      }
  close_cloth(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_is_many_is_prepared),
      cmocka_unit_test(streaks_of_many_are_those_of_one),
      cmocka_unit_test(one_call_is_a_lane),
      cmocka_unit_test(random_numbers_mean_all_terms),
      cmocka_unit_test(textures_are_parameters),
      cmocka_unit_test(gloss_scales_exponents),
      cmocka_unit_test(no_input_breaks_it),
      cmocka_unit_test(mixed_blocks_are_their_lanes),
      cmocka_unit_test(blocks_name_bad_input),
      cmocka_unit_test(lanes_side_by_side_are_near_their_own),
      cmocka_unit_test(lanes_that_lie_apart_have_their_own),
      cmocka_unit_test(short_structures),
      cmocka_unit_test(lanes_below_0_have_all_terms),
      cmocka_unit_test(nap_in_the_horizon),
  };
  return cmocka_run_group_tests_name("fabric hit", tests, NULL, NULL);
}
