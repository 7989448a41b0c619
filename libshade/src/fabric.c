/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Setting up a fabric. The far model is not told what the yarns look like: it looks at some
 * 10^5 points of the weave, spread over the repeat and over the noise, and keeps
 *   - a table of what is seen of either side, block by block, and of its diffuse colour;
 *   - a few nodes of the tilt of each side, found by cutting the cloud of tilts where it
 *     spreads most for the width of the lobe. What spread is left within the cuts widens the lobe.
 * Against Gauss-Legendre nodes of the same number this has half the error for uniform tilts,
 * and, unlike those, no separate peaks when the lobe is narrower than the nodes are apart.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fabric.h"

#define PI 3.14159265358979323846

enum {
  LOOKS = 1 << 18,  /* points in all, about */
  MAX_BLOCKS = 512, /* of the table along a side: larger repeats share */
  MAX_LOOKS = 48,   /* along a side of a block */
  MIN_LOOKS = 2
};

/*
 * Spread of the tilt within a cut that is left to the lobe, as a share of its own variance; for
 * broad lobes that of an exponent of 20, since the horizons and the diffuse part ask for nodes too.
 */
#define SPREAD_LEFT 0.1
#define SPREAD_LEFT_GAUSSIAN 0.06 /* lobes that are steeper in their flanks */
#define BROAD 20.0

/* One look at a yarn: tilt in the frame of its fibres, angles; weight is its occlusion. */
typedef struct look {
  float x, y, weight;
} look;

/* A cut of the cloud. */
typedef struct cut {
  size_t start, count;
  double weight, x, y; /* means */
  double vx, vy;       /* variances, as angles about the mean */
} cut;

/* Numbers that are the same on every machine. */
static uint64_t next(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
static double fraction(uint64_t *state) {
  return (double)(next(state) >> 11) * 0x1p-53;
}

void shade_fabric_params_init(shade_fabric_params *p) {
  memset(p, 0, sizeof *p);
  p->size = sizeof *p;
  p->detail = SHADE_DETAIL_ROTATE;
  p->warp.along = 100;
  p->warp.across = 10;
  p->warp.diffuse = SHADE_DIFFUSE_FIBRE;
  for (int c = 0; c < 3; c++) {
    p->warp.f0[c] = 0.04;
    p->warp.kd[c] = 0.5;
    p->nap_color[c] = 0.5;
  }
  p->weft = p->warp;
}

static double within(double x, double low, double high, double initial, unsigned *status) {
  double y = isnan(x) ? initial : fmin(fmax(x, low), high);
  if (!(x == y))
    *status |= SHADE_CLAMPED_PARAMETER;
  return y;
}

static void color_within(double color[3], const double initial[3], unsigned *status) {
  for (int c = 0; c < 3; c++)
    color[c] = within(color[c], 0, 1, initial[c], status);
}

static void yarn_within(shade_yarn *y, const shade_yarn *initial, unsigned *status) {
  y->along = within(y->along, 0, 1e6, initial->along, status);
  y->across = within(y->across, 0, 1e6, initial->across, status);
  color_within(y->f0, initial->f0, status);
  color_within(y->kd, initial->kd, status);
  if (!shade_list_word(SHADE_LIST_DIFFUSE, (int)y->diffuse)) {
    y->diffuse = (shade_diffuse)0;
    *status |= SHADE_BAD_CHOICE;
  }
}

static shade_fabric_params within_ranges(const shade_fabric_params *given, unsigned *status) {
  shade_fabric_params p, initial;
  shade_fabric_params_init(&initial);
  p = initial;
  if (given)
    memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  yarn_within(&p.warp, &initial.warp, status);
  yarn_within(&p.weft, &initial.weft, status);
  color_within(p.backing, initial.backing, status);
  color_within(p.nap_color, initial.nap_color, status);
  p.nap = within(p.nap, 0, 10, 0, status);
  return p;
}

/* A lobe of these yarns; vx and vy are variances of the tilt to be added to its own. */
static shade_bsdf make_lobe(const shade_fabric_params *p, const shade_yarn *yarn, double vx,
                            double vy, unsigned *status) {
  shade_params q;
  shade_params_init(&q);
  q.mdf = p->mdf;
  q.brdf = p->brdf;
  q.detail = p->detail;
  q.horizon = SHADE_HORIZON_HARD;
  q.groove = SHADE_GROOVE_X;
  q.diffuse = yarn->diffuse;
  if (p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    shade_params_set_exponents(&q, yarn->along / (1 + yarn->along * vx),
                               yarn->across / (1 + yarn->across * vy));
  } else {
    double ax = sqrt(2 / (yarn->along + 2) + 2 * vx), ay = sqrt(2 / (yarn->across + 2) + 2 * vy);
    shade_params_set_alphas(&q, ax, ay);
  }
  shade_bsdf b;
  *status |= shade_bsdf_setup(&b, &q);
  return b;
}

static void measure(const look *looks, cut *c) {
  double w = 0, x = 0, y = 0, xx = 0, yy = 0;
  for (size_t i = c->start; i < c->start + c->count; i++) {
    const look *l = &looks[i];
    w += (double)l->weight;
    x += (double)(l->weight * l->x);
    y += (double)(l->weight * l->y);
  }
  c->weight = w;
  c->x = w > 0 ? x / w : 0;
  c->y = w > 0 ? y / w : 0;
  for (size_t i = c->start; i < c->start + c->count; i++) {
    const look *l = &looks[i];
    double dx = (double)l->x - c->x, dy = (double)l->y - c->y;
    xx += (double)l->weight * dx * dx;
    yy += (double)l->weight * dy * dy;
  }
  /* a tilt that is already steep changes more by the same step of its sine */
  const double z2 = fmax(1 - c->x * c->x - c->y * c->y, 0.03);
  c->vx = w > 0 ? xx / w * (1 - c->y * c->y) / z2 : 0;
  c->vy = w > 0 ? yy / w * (1 - c->x * c->x) / z2 : 0;
}

/* Cut a cloud of looks into at most FABRIC_NODES; returns how many. */
static int cut_cloud(look *looks, size_t count, double ex, double ey, double left,
                     cut cuts[FABRIC_NODES]) {
  int made = 1;
  cuts[0].start = 0;
  cuts[0].count = count;
  measure(looks, &cuts[0]);
  const double all = cuts[0].weight;
  while (made < FABRIC_NODES) {
    int worst = -1;
    double most = 0;
    for (int k = 0; k < made; k++) {
      double spread = fmax(cuts[k].vx * ex, cuts[k].vy * ey);
      if (spread > left && cuts[k].weight > 1e-3 * all && cuts[k].weight * spread * spread > most) {
        most = cuts[k].weight * spread * spread;
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
      look *l = &looks[low];
      if ((along ? l->x : l->y) < middle) {
        low++;
      } else {
        look swap = looks[--high];
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

static void set_node(fabric_nodes *nodes, int i, double x, double y, double weight) {
  double z = sqrt(fmax(1 - x * x - y * y, 1e-4));
  double scale = 1 / sqrt(x * x + y * y + z * z);
  nodes->x[i] = x * scale;
  nodes->y[i] = y * scale;
  nodes->z[i] = z * scale;
  nodes->weight[i] = weight;
  nodes->xf[i] = (float)nodes->x[i];
  nodes->yf[i] = (float)nodes->y[i];
  nodes->zf[i] = (float)nodes->z[i];
  nodes->weightf[i] = (float)weight;
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
static shade_bsdf make_single(const shade_fabric_params *p, const shade_yarn *yarn,
                              const cut *whole, const fabric_nodes *nodes, const double rest[2],
                              fabric_nodes *one, unsigned *status) {
  one->count = 1;
  double mean[3] = {0, 0, 0};
  for (int i = 0; i < nodes->count; i++) {
    mean[0] += nodes->weight[i] * nodes->x[i];
    mean[1] += nodes->weight[i] * nodes->y[i];
    mean[2] += nodes->weight[i] * nodes->z[i];
  }
  double length = sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
  set_node(one, 0, mean[0] / length, mean[1] / length, 1);
  if (p->mdf != SHADE_MDF_ASHIKHMIN_SHIRLEY)
    return make_lobe(p, yarn, whole->vx, whole->vy, status);
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
  return make_lobe(p, &wide, 0, 0, status);
}

/* The far model of one side from its looks. */
static void set_side(fabric_side *side, const shade_fabric_params *p, const shade_yarn *yarn,
                     look *looks, size_t count, unsigned *status) {
  cut cuts[FABRIC_NODES], whole = {.start = 0, .count = count};
  side->near = make_lobe(p, yarn, 0, 0, status);
  for (int c = 0; c < 3; c++) {
    side->f0[c] = yarn->f0[c];
    side->kd[c] = yarn->kd[c];
    side->leaves[c] = (1 - yarn->f0[c]) * (1 - yarn->f0[c]);
  }
  measure(looks, &whole);
  if (!(whole.weight > 0)) { /* not seen anywhere */
    side->nodes.count = side->one.count = 1;
    set_node(&side->nodes, 0, 0, 0, 1);
    set_node(&side->one, 0, 0, 0, 1);
    side->far = side->single = side->near;
    return;
  }
  side->spread[0] = whole.vx;
  side->spread[1] = whole.vy;
  side->nodes.count =
      cut_cloud(looks, count, fmax(yarn->along, BROAD), fmax(yarn->across, BROAD),
                p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? SPREAD_LEFT : SPREAD_LEFT_GAUSSIAN, cuts);
  double rest[2] = {0, 0};
  for (int i = 0; i < side->nodes.count; i++) {
    double weight = cuts[i].weight / whole.weight;
    set_node(&side->nodes, i, cuts[i].x, cuts[i].y, weight);
    rest[0] += weight * cuts[i].vx;
    rest[1] += weight * cuts[i].vy;
  }
  if (p->detail == SHADE_DETAIL_NONE) { /* the lobes lie where they are, whatever the tilt */
    side->far = side->single = side->near;
    set_node(&side->one, 0, 0, 0, 1);
    side->one.count = 1;
    return;
  }
  side->far = make_lobe(p, yarn, rest[0], rest[1], status);
  side->single = make_single(p, yarn, &whole, &side->nodes, rest, &side->one, status);
}

/* What has been seen of one side. */
typedef struct cloud {
  look *looks;
  size_t count;
  double tx, ty;
} cloud;

/* Look at one block of the repeat; adds its means to `cell`. */
static void look_at_block(const shade_fabric *f, int column, int row, int looks, uint64_t *state,
                          cloud clouds[2], double cell[COLUMNS]) {
  const double part = 1.0 / (looks * looks);
  for (int k = 0; k < looks * looks; k++) {
    /* any repeat: the noise goes on where the draft begins again */
    const double across = (double)(next(state) & 1023) - 512,
                 up = (double)(next(state) & 1023) - 512;
    const double x = (column + (k % looks + fraction(state)) / looks) / f->columns;
    const double y = (row + (k / looks + fraction(state)) / looks) / f->rows;
    shade_crossing at;
    shade_weave_lookup(f->weave, f->width * (x + across), f->height * (y + up), &at);
    double matt[3];
    fabric_matt(f, &at, matt);
    const int warp = at.top == SHADE_TOP_WARP, gap = at.top == SHADE_TOP_GAP;
    double *into = cell + (gap ? COLUMN_GAP : warp ? COLUMN_WARP_MATT : COLUMN_WEFT_MATT);
    for (int c = 0; c < 3; c++)
      into[c] += matt[c] * part;
    if (gap)
      continue;
    cell[COLUMN_WEFT + warp] += at.occlusion * part;
    cloud *seen = &clouds[warp];
    look *l = &seen->looks[seen->count++];
    l->x = (float)(at.tx * at.dx + at.ty * at.dy);
    l->y = (float)(at.tx * at.dy - at.ty * at.dx);
    l->weight = (float)at.occlusion;
    seen->tx += at.tx * at.occlusion;
    seen->ty += at.ty * at.occlusion;
  }
}

/* Fill the table, its means, and the clouds. */
static void look_at_repeat(shade_fabric *f, int looks, cloud clouds[2]) {
  uint64_t state = 1;
  const size_t line = (size_t)(f->columns + 1) * COLUMNS;
  memset(f->table, 0, line * (size_t)(f->rows + 1) * sizeof *f->table);
  for (int j = 0; j < f->rows; j++) {
    double row[COLUMNS] = {0}; /* of the blocks so far */
    for (int i = 0; i < f->columns; i++) {
      look_at_block(f, i, j, looks, &state, clouds, row);
      double *below = f->table + (size_t)j * line + (size_t)(i + 1) * COLUMNS;
      for (int k = 0; k < COLUMNS; k++)
        below[line + (size_t)k] = below[k] + row[k];
    }
  }
  const double *all = f->table + (size_t)f->rows * line + (size_t)f->columns * COLUMNS;
  for (int k = 0; k < COLUMNS; k++)
    f->mean[k] = all[k] / ((double)f->columns * f->rows);
}

void shade_fabric_free(shade_fabric *f) {
  if (!f)
    return;
  free(f->table);
  free(f);
}

shade_fabric *shade_fabric_create(const shade_weave *weave, const shade_fabric_params *given,
                                  unsigned *status) {
  unsigned bits = SHADE_OK;
  const shade_fabric_params p = within_ranges(given, &bits);
  shade_fabric *f = weave ? calloc(1, sizeof *f) : NULL;
  if (!f)
    return NULL;
  const shade_draft *draft = shade_weave_draft(weave);
  f->weave = weave;
  memcpy(f->backing, p.backing, sizeof f->backing);
  memcpy(f->nap_color, p.nap_color, sizeof f->nap_color);
  f->nap = p.nap;
  f->draft_colors = p.draft_colors;
  const shade_weave_params *shape = shade_weave_get_params(weave);
  f->uneven = shape->warp.vary_brightness + shape->warp.along_brightness +
                  shape->weft.vary_brightness + shape->weft.along_brightness >
              0;
  f->width = draft->ends;
  f->height = draft->picks;
  f->columns = draft->ends < MAX_BLOCKS ? draft->ends : MAX_BLOCKS;
  f->rows = draft->picks < MAX_BLOCKS ? draft->picks : MAX_BLOCKS;
  const size_t blocks = (size_t)f->columns * (size_t)f->rows;
  int looks = (int)sqrt((double)(LOOKS / blocks));
  looks = looks < MIN_LOOKS ? MIN_LOOKS : looks > MAX_LOOKS ? MAX_LOOKS : looks;
  const size_t most = blocks * (size_t)(looks * looks);
  cloud clouds[2] = {{malloc(most * sizeof(look)), 0, 0, 0},
                     {malloc(most * sizeof(look)), 0, 0, 0}};
  f->table = malloc((size_t)(f->columns + 1) * (size_t)(f->rows + 1) * COLUMNS * sizeof *f->table);
  int ok = clouds[0].looks && clouds[1].looks && f->table;
  for (int k = 0; k < 2; k++) /* read by look_at_repeat */
    memcpy(f->side[k].kd, k ? p.warp.kd : p.weft.kd, sizeof f->side[k].kd);
  if (ok) {
    look_at_repeat(f, looks, clouds);
    for (int k = 0; k < 2; k++) {
      fabric_side *side = &f->side[k];
      double length = hypot(clouds[k].tx, clouds[k].ty);
      side->tx = length > 0 ? clouds[k].tx / length : k == SHADE_TOP_WEFT;
      side->ty = length > 0 ? clouds[k].ty / length : k == SHADE_TOP_WARP;
      set_side(side, &p, k ? &p.warp : &p.weft, clouds[k].looks, clouds[k].count, &bits);
    }
  }
  free(clouds[0].looks);
  free(clouds[1].looks);
  if (!ok) {
    shade_fabric_free(f);
    return NULL;
  }
  if (status)
    *status |= bits;
  return f;
}

void shade_fabric_get_info(const shade_fabric *f, shade_fabric_info *info) {
  const fabric_side *weft = &f->side[SHADE_TOP_WEFT], *warp = &f->side[SHADE_TOP_WARP];
  memset(info, 0, sizeof *info);
  info->weft_lobes = weft->nodes.count;
  info->warp_lobes = warp->nodes.count;
  info->weft_share = f->mean[COLUMN_WEFT];
  info->warp_share = f->mean[COLUMN_WARP];
  info->weft_single[0] = bsdf_of(&weft->single)->kx;
  info->weft_single[1] = bsdf_of(&weft->single)->ky;
  info->warp_single[0] = bsdf_of(&warp->single)->kx;
  info->warp_single[1] = bsdf_of(&warp->single)->ky;
}
