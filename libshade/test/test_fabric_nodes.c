/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/*
 * What a side of a cloth makes of a cloud of tilts: its nodes keep the cloud's weight, mean and,
 * with what widens their lobe, its variance; the single lobe has the second moments of all of them,
 * by quadrature over half vectors.
 */
#include "support.h"
#include "model/fabric.h"

enum { LOOKS = 4000 };

/* Two crescents of unlike weight: neither axis is a symmetry. */
static void fill(fabric_look *looks, double size, double mean[2], double variance[2]) {
  uint64_t seed = 5;
  double sum = 0;
  mean[0] = mean[1] = variance[0] = variance[1] = 0;
  for (int i = 0; i < LOOKS; i++) {
    const double t = uniform(&seed) - .3, s = uniform(&seed), part = i % 3 ? 1 : .4;
    looks[i] = (fabric_look){(float)(size * (t + .2 * s)),
                             (float)(size * (part * t * t - .3 * s * (i % 2))), (float)part};
    mean[0] += part * (double)looks[i].x;
    mean[1] += part * (double)looks[i].y;
    sum += part;
  }
  for (int k = 0; k < 2; k++)
    mean[k] /= sum;
  for (int i = 0; i < LOOKS; i++) {
    const double x = (double)looks[i].x - mean[0], y = (double)looks[i].y - mean[1];
    variance[0] += (double)looks[i].weight * x * x / sum;
    variance[1] += (double)looks[i].weight * y * y / sum;
  }
}

static void make(fabric_side *side, shade_mdf mdf, double along, double across,
                 fabric_look *looks) {
  shade_fabric_params p;
  unsigned status = SHADE_OK;
  shade_fabric_params_init(&p);
  p.mdf = mdf;
  p.brdf = SHADE_BRDF_ASHIKHMIN_SHIRLEY;
  shade_yarn yarn = p.warp;
  yarn.along = along;
  yarn.across = across;
  *side = (fabric_side){.tx = 0};
  shade_fabric_set_side(side, &p, &yarn, looks, LOOKS, &status);
  assert_int_equal(status, SHADE_OK);
}

static void nodes_keep_mean_and_variance(void **state) {
  (void)state;
  static fabric_look looks[LOOKS];
  const double exponents[][2] = {{30, 200}, {400, 60}, {3000, 2500}};
  for (int e = 0; e < 3; e++) {
    fabric_side side;
    double mean[2], variance[2];
    /* small: sines are angles to a thousandth */
    fill(looks, .15, mean, variance);
    make(&side, SHADE_MDF_ASHIKHMIN_SHIRLEY, exponents[e][0], exponents[e][1], looks);
    const fabric_nodes *sets[2] = {&side.nodes, &side.coarse};
    const fabric_lobe lobes[2] = {FABRIC_FAR, FABRIC_DRAW};
    const int most[2] = {FABRIC_NODES, FABRIC_COARSE};
    const double left[2] = {.1, .5}; /* of the lobe's own variance, 1/20 at least */
    for (int k = 0; k < 2; k++) {
      const fabric_nodes *n = sets[k];
      const shade_params *made = &side.made_of[lobes[k]];
      double w = 0, m[2] = {0, 0}, v[2] = {0, 0};
      for (int i = 0; i < n->count; i++) {
        assert_near(n->x[i] * n->x[i] + n->y[i] * n->y[i] + n->z[i] * n->z[i], 1, 1e-12);
        w += n->weight[i];
        m[0] += n->weight[i] * n->x[i];
        m[1] += n->weight[i] * n->y[i];
      }
      for (int i = 0; i < n->count; i++) {
        v[0] += n->weight[i] * (n->x[i] - mean[0]) * (n->x[i] - mean[0]);
        v[1] += n->weight[i] * (n->y[i] - mean[1]) * (n->y[i] - mean[1]);
      }
      assert_near(w, 1, 1e-9);
      for (int axis = 0; axis < 2; axis++) {
        /* the lobe's variance is 1/e: what it gained is what is left within the nodes */
        const double gained = 1 / (axis ? made->ey : made->ex) - 1 / exponents[e][axis];
        assert_near(m[axis], mean[axis], 1e-6);
        assert_true(gained >= 0);
        /* cut where that asks for it, few are enough */
        assert_true(n->count < most[k] || e == 2);
        if (n->count < most[k])
          assert_true(gained * fmax(exponents[e][axis], 20) <= 1.001 * left[k]);
        assert_near(v[axis] + gained, variance[axis], .01 * variance[axis]);
        assert_near(side.spread[axis], variance[axis], .02 * variance[axis]);
      }
    }
    assert_true(side.coarse.count <= side.nodes.count && side.nodes.count > 1);
    shade_fabric_table_free(side.table);
  }
}

/* A steep cloud along one axis spreads by its arc. */
static void steep_tilts_are_arcs(void **state) {
  (void)state;
  static fabric_look looks[LOOKS];
  for (int axis = 0; axis < 2; axis++) {
    const double x = .7, y = .3, step = .02;
    double arc[3];
    for (int i = 0; i < LOOKS; i++) {
      const double a = x + step * (i % 2 ? 1 : -1);
      looks[i] = (fabric_look){(float)(axis ? y : a), (float)(axis ? a : y), 1};
      const double v[3] = {a, y, sqrt(1 - a * a - y * y)};
      if (i == 1)
        arc[2] = acos(v[0] * arc[0] + y * y + v[2] * arc[1]);
      arc[0] = v[0];
      arc[1] = v[2];
    }
    fabric_side side;
    make(&side, SHADE_MDF_WARD, 40, 40, looks);
    assert_near(side.spread[axis] / (arc[2] * arc[2] / 4), 1, .01);
    assert_near(side.spread[!axis], 0, 1e-9);
    shade_fabric_table_free(side.table);
  }
}

/* E[(h.a)^2] of D about nodes, for the axes of `rotate` about n. */
static void moments_by_quadrature(const shade_bsdf *b, const fabric_nodes *nodes, const double n[3],
                                  double moments[2]) {
  enum { TURNS = 90, STEPS = 240 };
  const double l = hypot(n[0], n[2]);
  const double ax[3] = {n[2] / l, 0, -n[0] / l}, ay[3] = {-n[0] * n[1] / l, l, -n[1] * n[2] / l};
  double sum = 0;
  moments[0] = moments[1] = 0;
  for (int i = 0; i < STEPS; i++)
    for (int j = 0; j < TURNS; j++) {
      /* 1 - z by the square of what is even, so that peaks are met often */
      const double s = (i + .5) / STEPS, z = 1 - s * s * s, r = sqrt(1 - z * z);
      const double turned = 2 * PI * (j + .5) / TURNS, h[3] = {r * cos(turned), r * sin(turned), z};
      const double x = h[0] * ax[0] + h[1] * ax[1] + h[2] * ax[2];
      const double y = h[0] * ay[0] + h[1] * ay[1] + h[2] * ay[2];
      double d = 0;
      for (int k = 0; k < nodes->count; k++) {
        const double m[3] = {nodes->x[k], nodes->y[k], nodes->z[k]};
        d += nodes->weight[k] * shade_mdf_eval(b, m, h, NULL);
      }
      d *= 3 * s * s;
      sum += d;
      moments[0] += d * x * x;
      moments[1] += d * y * y;
    }
  moments[0] /= sum;
  moments[1] /= sum;
}

static void one_lobe_has_the_moments_of_all(void **state) {
  (void)state;
  static fabric_look looks[LOOKS];
  const double exponents[][2] = {{40, 160}, {300, 50}};
  for (int e = 0; e < 2; e++) {
    fabric_side side;
    double mean[2], variance[2], all[2], one[2];
    fill(looks, .4, mean, variance);
    make(&side, SHADE_MDF_ASHIKHMIN_SHIRLEY, exponents[e][0], exponents[e][1], looks);
    const double n[3] = {side.one.x[0], side.one.y[0], side.one.z[0]};
    double m[3] = {0, 0, 0};
    for (int k = 0; k < side.nodes.count; k++) {
      m[0] += side.nodes.weight[k] * side.nodes.x[k];
      m[1] += side.nodes.weight[k] * side.nodes.y[k];
      m[2] += side.nodes.weight[k] * side.nodes.z[k];
    }
    const double length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
    for (int c = 0; c < 3; c++)
      assert_near(n[c], m[c] / length, 1e-9);
    moments_by_quadrature(&side.lobe[FABRIC_FAR], &side.nodes, n, all);
    moments_by_quadrature(&side.lobe[FABRIC_SINGLE], &side.one, n, one);
    print_message("second moments %.5f %.5f, of one lobe %.5f %.5f\n", all[0], all[1], one[0],
                  one[1]);
    for (int axis = 0; axis < 2; axis++)
      assert_near(one[axis] / all[axis], 1, .005);
    shade_fabric_table_free(side.table);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(nodes_keep_mean_and_variance),
                                     cmocka_unit_test(steep_tilts_are_arcs),
                                     cmocka_unit_test(one_lobe_has_the_moments_of_all)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
