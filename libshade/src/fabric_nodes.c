/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Lobes of the far model: a few nodes of the tilt of each side, found by cutting the cloud of
 * tilts that look-ups found where it spreads most for the width of the lobe. What spread is left
 * within the cuts widens the lobe. Against Gauss-Legendre nodes of the same number this has half
 * the error for uniform tilts, and, unlike those, no separate peaks when the lobe is narrower
 * than the nodes are apart.
 */
#include <math.h>

#include "../model/fabric.h"
#include "../model/mdf.h"

/*
 * Spread of the tilt within a cut that is left to the lobe, as a share of its own variance; for
 * broad lobes that of an exponent of 20, since the horizons and the diffuse part ask for nodes too.
 */
#define SPREAD_LEFT 0.1
#define SPREAD_LEFT_GAUSSIAN 0.06 /* lobes that are steeper in their flanks */
#define SPREAD_LEFT_COARSE 0.5    /* what directions are drawn from */
#define SPREAD_LEFT_FINE 0.05     /* what tables are made of */
/* Up to which spread of all tilts one lobe draws as well as the coarse ones: with no more noise, at
 * a fraction of the time. */
#define SPREAD_OF_ONE 2.5
#define BROAD 20.0

/* A cut of the cloud. */
typedef struct cut {
  size_t start, count;
  double weight, x, y; /* means */
  double vx, vy;       /* variances, as angles about the mean */
} cut;

/* A lobe of these yarns; vx and vy are variances of the tilt to be added to its own. */
static void make_lobe(fabric_side *side, fabric_lobe which, const shade_fabric_params *p,
                      const shade_yarn *yarn, double vx, double vy, unsigned *status) {
  shade_params q;
  shade_params_init(&q);
  q.mdf = p->mdf;
  q.brdf = p->brdf;
  q.detail = p->detail;
  q.horizon = SHADE_HORIZON_HARD;
  q.groove = SHADE_GROOVE_X;
  q.diffuse = yarn->diffuse;
  if (shade_mdf_reads_exponents(p->mdf)) {
    shade_params_set_exponents(&q, yarn->along / (1 + yarn->along * vx),
                               yarn->across / (1 + yarn->across * vy));
  } else {
    double ax = sqrt(2 / (yarn->along + 2) + 2 * vx), ay = sqrt(2 / (yarn->across + 2) + 2 * vy);
    shade_params_set_alphas(&q, ax, ay);
  }
  side->made_of[which] = q;
  *status |= shade_bsdf_setup(&side->lobe[which], &q);
}

static void measure(const fabric_look *looks, cut *c) {
  double w = 0, x = 0, y = 0, xx = 0, yy = 0;
  for (size_t i = c->start; i < c->start + c->count; i++) {
    const fabric_look *l = &looks[i];
    w += (double)l->weight;
    x += (double)(l->weight * l->x);
    y += (double)(l->weight * l->y);
  }
  c->weight = w;
  c->x = w > 0 ? x / w : 0;
  c->y = w > 0 ? y / w : 0;
  for (size_t i = c->start; i < c->start + c->count; i++) {
    const fabric_look *l = &looks[i];
    double dx = (double)l->x - c->x, dy = (double)l->y - c->y;
    xx += (double)l->weight * dx * dx;
    yy += (double)l->weight * dy * dy;
  }
  /* a tilt that is already steep changes more by the same step of its sine */
  const double z2 = fmax(1 - c->x * c->x - c->y * c->y, 0.03);
  c->vx = w > 0 ? xx / w * (1 - c->y * c->y) / z2 : 0;
  c->vy = w > 0 ? yy / w * (1 - c->x * c->x) / z2 : 0;
}

/* Cut a cloud of looks, or on from the `made` cuts of it, into at most `most`; returns how many. */
static int cut_cloud(fabric_look *looks, const cut *whole, double ex, double ey, double left,
                     int most, int made, cut *cuts) {
  const double all = whole->weight;
  if (!made) {
    made = 1;
    cuts[0] = *whole;
    measure(looks, &cuts[0]);
  }
  while (made < most) {
    int worst = -1;
    double largest = 0;
    for (int k = 0; k < made; k++) {
      double spread = fmax(cuts[k].vx * ex, cuts[k].vy * ey);
      if (spread > left && cuts[k].weight > 1e-3 * all &&
          cuts[k].weight * spread * spread > largest) {
        largest = cuts[k].weight * spread * spread;
        worst = k;
      }
    }
    if (worst < 0)
      break;
    cut *old = &cuts[worst], *new = &cuts[made];
    const int along = old->vx * ex > old->vy * ey;
    const float middle = (float)(along ? old->x : old->y);
    size_t low = old->start, high = old->start + old->count;
    while (low < high) {
      fabric_look *l = &looks[low];
      if ((along ? l->x : l->y) < middle) {
        low++;
      } else {
        fabric_look swap = looks[--high];
        looks[high] = *l;
        *l = swap;
      }
    }
    new->start = low;
    new->count = old->start + old->count - low;
    old->count = low - old->start;
    if (!old->count || !new->count) { /* all alike in float: no further */
      old->count += new->count;
      break;
    }
    measure(looks, old);
    measure(looks, new);
    made++;
  }
  return made;
}

/* The normal that leans by x and y, if there is one. */
static void normal_of(double x, double y, double *nx, double *ny, double *nz) {
  const double z = sqrt(fmax(1 - x * x - y * y, 1e-4));
  const double scale = 1 / sqrt(x * x + y * y + z * z);
  *nx = x * scale;
  *ny = y * scale;
  *nz = z * scale;
}

static void set_node(fabric_nodes *nodes, int i, double x, double y, double weight) {
  normal_of(x, y, &nodes->x[i], &nodes->y[i], &nodes->z[i]);
  nodes->weight[i] = weight;
  nodes->xf[i] = (float)nodes->x[i];
  nodes->yf[i] = (float)nodes->y[i];
  nodes->zf[i] = (float)nodes->z[i];
  nodes->weightf[i] = (float)weight;
}

/* Of no weight, to whole vectors. */
static void fill_nodes(fabric_nodes *nodes) {
  for (int i = nodes->count; i < FABRIC_WHOLE(nodes->count); i++)
    set_node(nodes, i, nodes->x[0], nodes->y[0], 0);
}

/* Second moments E[hx^2], E[hy^2] of Ashikhmin and Shirley's D. */
static void moments_of(double ex, double ey, double m[2]) {
  const double e[2] = {ex, ey}, size = sqrt((ex + 1) * (ey + 1));
  for (int k = 0; k < 2; k++) {
    double g[2];
    for (int j = 0; j < 2; j++) {
      double a = sqrt(e[k] + (j ? 3 : 1)), b = sqrt(e[1 - k] + (j ? 3 : 1));
      g[j] = 1 / (a * (a + b));
    }
    m[k] = size * (g[0] - g[1]);
  }
}

/* Exponents with given second moments: Newton's method on their logarithms. */
static void exponents_of(const double wanted[2], double e[2]) {
  double l[2] = {log(fmax(1 / fmax(wanted[0], 1e-7) - 2, 0.1)),
                 log(fmax(1 / fmax(wanted[1], 1e-7) - 2, 0.1))};
  for (int step = 0; step < 60; step++) {
    double m[2], mx[2], my[2];
    const double tiny = 1e-6;
    moments_of(exp(l[0]), exp(l[1]), m);
    moments_of(exp(l[0] + tiny), exp(l[1]), mx);
    moments_of(exp(l[0]), exp(l[1] + tiny), my);
    double r[2], j[2][2];
    for (int k = 0; k < 2; k++) {
      r[k] = log(m[k] / wanted[k]);
      j[k][0] = log(mx[k] / m[k]) / tiny;
      j[k][1] = log(my[k] / m[k]) / tiny;
    }
    double det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    if (!(fabs(det) > 1e-12))
      break;
    double d0 = (r[0] * j[1][1] - r[1] * j[0][1]) / det;
    double d1 = (r[1] * j[0][0] - r[0] * j[1][0]) / det;
    l[0] = fmin(fmax(l[0] - fmin(fmax(d0, -1), 1), -7), 13.8);
    l[1] = fmin(fmax(l[1] - fmin(fmax(d1, -1), 1), -7), 13.8);
    if (fabs(d0) + fabs(d1) < 1e-10)
      break;
  }
  e[0] = exp(l[0]);
  e[1] = exp(l[1]);
}

/*
 * One lobe for all nodes: about their mean direction, with the second moments of the mixture. For
 * Ashikhmin-Shirley those are exact; the other distributions add the variance of the tilts.
 */
static void make_single(fabric_side *side, const shade_fabric_params *p, const shade_yarn *yarn,
                        const cut *whole, const double rest[2], unsigned *status) {
  const fabric_nodes *nodes = &side->nodes;
  fabric_nodes *one = &side->one;
  double mean[3] = {0, 0, 0};
  for (int i = 0; i < nodes->count; i++) {
    mean[0] += nodes->weight[i] * nodes->x[i];
    mean[1] += nodes->weight[i] * nodes->y[i];
    mean[2] += nodes->weight[i] * nodes->z[i];
  }
  double length = sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
  set_node(one, 0, mean[0] / length, mean[1] / length, 1);
  if (p->mdf != SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    make_lobe(side, FABRIC_SINGLE, p, yarn, whole->vx, whole->vy, status);
    return;
  }
  /* axes about the mean, as rotate lays them: x stays in the plane of x and z */
  const double n[3] = {one->x[0], one->y[0], one->z[0]}, l = hypot(n[0], n[2]);
  const double ax[3] = {n[2] / l, 0, -n[0] / l};
  const double ay[3] = {-n[0] * n[1] / l, l, -n[1] * n[2] / l};
  double own[2], sum[2] = {0, 0};
  moments_of(yarn->along / (1 + yarn->along * rest[0]), yarn->across / (1 + yarn->across * rest[1]),
             own);
  for (int i = 0; i < nodes->count; i++) {
    const double m[3] = {nodes->x[i], nodes->y[i], nodes->z[i]}, k = hypot(m[0], m[2]);
    const double tx[3] = {m[2] / k, 0, -m[0] / k};
    const double ty[3] = {-m[0] * m[1] / k, k, -m[1] * m[2] / k};
    const double *axes[2] = {ax, ay};
    for (int a = 0; a < 2; a++) {
      double x = 0, y = 0, z = 0;
      for (int c = 0; c < 3; c++) {
        x += axes[a][c] * tx[c];
        y += axes[a][c] * ty[c];
        z += axes[a][c] * m[c];
      }
      sum[a] +=
          nodes->weight[i] * (x * x * own[0] + y * y * own[1] + z * z * (1 - own[0] - own[1]));
    }
  }
  shade_yarn wide = *yarn;
  double e[2];
  exponents_of(sum, e);
  wide.along = e[0];
  wide.across = e[1];
  make_lobe(side, FABRIC_SINGLE, p, &wide, 0, 0, status);
}

/* Nodes at the means of the cuts of a cloud; rest: the mean variance that is left within them. */
static void set_nodes(fabric_nodes *nodes, const cut *cuts, int count, double whole,
                      double rest[2]) {
  rest[0] = rest[1] = 0;
  nodes->count = count;
  for (int i = 0; i < count; i++) {
    const double weight = cuts[i].weight / whole;
    set_node(nodes, i, cuts[i].x, cuts[i].y, weight);
    rest[0] += weight * cuts[i].vx;
    rest[1] += weight * cuts[i].vy;
  }
  fill_nodes(nodes);
}

/* The tables: of the cuts, and for the diffuse part of the nodes. */
static void set_table(fabric_side *side, const shade_fabric_params *p, const shade_yarn *yarn,
                      const cut *cuts, int count, double whole, unsigned *status) {
  double n[3][FABRIC_FINE], weight[FABRIC_FINE], vx = 0, vy = 0;
  for (int i = 0; i < count; i++) {
    weight[i] = cuts[i].weight / whole;
    normal_of(cuts[i].x, cuts[i].y, &n[0][i], &n[1][i], &n[2][i]);
    vx += weight[i] * cuts[i].vx;
    vy += weight[i] * cuts[i].vy;
  }
  make_lobe(side, FABRIC_TABLED, p, yarn, vx, vy, status);
  const fabric_nodes *of = &side->nodes;
  const fabric_lobes fine = {&side->lobe[FABRIC_TABLED], (size_t)count, {n[0], n[1], n[2]}, weight};
  const fabric_lobes matt = {
      &side->lobe[FABRIC_FAR], (size_t)of->count, {of->x, of->y, of->z}, of->weight};
  side->table = shade_fabric_table_create(&fine, &matt);
}

static void set_one_node(fabric_nodes *nodes) {
  nodes->count = 1;
  set_node(nodes, 0, 0, 0, 1);
  fill_nodes(nodes);
}

void shade_fabric_set_side(fabric_side *side, const shade_fabric_params *p, const shade_yarn *yarn,
                           fabric_look *looks, size_t count, unsigned *status) {
  cut cuts[FABRIC_FINE], whole = {.start = 0, .count = count};
  const double ex = fmax(yarn->along, BROAD), ey = fmax(yarn->across, BROAD);
  const int gaussian = p->mdf != SHADE_MDF_ASHIKHMIN_SHIRLEY;
  double rest[2];
  for (int which = 0; which < FABRIC_LOBES; which++)
    make_lobe(side, (fabric_lobe)which, p, yarn, 0, 0, status);
  set_one_node(&side->nodes);
  set_one_node(&side->one);
  set_one_node(&side->coarse);
  side->draws_one = 0;
  for (int c = 0; c < 3; c++) {
    side->f0[c] = yarn->f0[c];
    side->kd[c] = yarn->kd[c];
    side->leaves[c] = (1 - yarn->f0[c]) * (1 - yarn->f0[c]);
  }
  measure(looks, &whole);
  if (!(whole.weight > 0)) /* not seen anywhere */
    return;
  side->spread[0] = whole.vx;
  side->spread[1] = whole.vy;
  int made = cut_cloud(looks, &whole, ex, ey, SPREAD_LEFT_COARSE, FABRIC_COARSE, 0, cuts);
  set_nodes(&side->coarse, cuts, made, whole.weight, rest);
  if (p->detail == SHADE_DETAIL_NONE)
    set_one_node(&side->coarse); /* the lobes lie where they are, whatever the tilt */
  else
    make_lobe(side, FABRIC_DRAW, p, yarn, rest[0], rest[1], status);
  made = cut_cloud(looks, &whole, ex, ey, gaussian ? SPREAD_LEFT_GAUSSIAN : SPREAD_LEFT,
                   FABRIC_NODES, 0, cuts);
  set_nodes(&side->nodes, cuts, made, whole.weight, rest);
  if (p->detail == SHADE_DETAIL_NONE)
    return;
  make_lobe(side, FABRIC_FAR, p, yarn, rest[0], rest[1], status);
  make_single(side, p, yarn, &whole, rest, status);
  side->draws_one = fmax(whole.vx * ex, whole.vy * ey) <= SPREAD_OF_ONE;
  if (!shade_fabric_table_models(&side->lobe[FABRIC_FAR]))
    return;
  made = cut_cloud(looks, &whole, ex, ey, SPREAD_LEFT_FINE, FABRIC_FINE, made, cuts);
  set_table(side, p, yarn, cuts, made, whole.weight, status);
}
