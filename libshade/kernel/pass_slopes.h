/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Look-ups of slopes over a block of lanes: the points, probes and weights of shade_slope_lookup,
 * in single precision. Points near the lane's own place are gathered for 16 lanes at a time; of the
 * pyramid each lane reads whole texels. Single precision only.
 */
#include "../src/slope_map.h"

enum { SLOPE_GROUP = 16 };

/* A call of its own: inlined, gcc sees no vectors in some loops. gcc 12 also takes a callee that
 * fills a local structure for one without effect, unless it looks into none. */
#if defined(__clang__)
#define SLOPE_APART __attribute__((noinline))
#elif defined(__GNUC__)
#define SLOPE_APART __attribute__((noipa))
#else
#define SLOPE_APART
#endif

LEAF int floor_to_int(float x) { /* |x| < 2^31 */
  const int i = (int)x;
  return i - (x < (float)i);
}

LEAF double floor_of(double x) { /* |x| < 2^51 */
  const double magic = 6755399441055744.0, r = (x + magic) - magic;
  return r > x ? r - 1 : r;
}

/* Beside the choices of moment_wrap: no lane reaches an edge. */
enum { WRAP_NOT = WRAP_MIRROR + 1 };

/* Whether all points within half of a and b about f lie between the middles of the n texels from
 * `base` on, along one axis; of a group. */
LEAF int is_within(const int *restrict base, const float *restrict f, const float *restrict a,
                   const float *restrict b, const int *restrict n) {
  int beyond = 0;
#pragma omp simd reduction(| : beyond)
  for (int k = 0; k < SLOPE_GROUP; k++) {
    /* a hundredth more than what roundings of the places may add */
    const float reach = 0.505F * (fabsf(a[k]) + fabsf(b[k])) + 0.01F;
    const int low = base[k] + floor_to_int(f[k] - reach);
    const int high = base[k] + floor_to_int(f[k] + reach) + 1;
    beyond |= (low < 0) | (high >= n[k]);
  }
  return !beyond;
}

/* The texel that lies at i, for -2n <= i < 3n. What lies further gives some texel. */
LEAF int wrap_near(int i, int n, int wrap) {
  if (wrap == WRAP_NOT)
    return i;
  const int last = n - 1;
  int repeated = i < 0 ? i + n : i;
  repeated = repeated < 0 ? repeated + n : repeated;
  repeated = repeated > last ? repeated - n : repeated;
  repeated = repeated > last ? repeated - n : repeated;
  int mirrored = i < 0 ? -1 - i : i;
  mirrored = mirrored >= 2 * n ? mirrored - 2 * n : mirrored;
  mirrored = mirrored > last ? 2 * n - 1 - mirrored : mirrored;
  int to = wrap == WRAP_CLAMP ? i : wrap == WRAP_MIRROR ? mirrored : repeated;
  to = to < 0 ? 0 : to;
  return to > last ? last : to;
}

/* What a block's lanes ask for. Sides are in texels, y downwards. */
typedef struct slope_lanes {
  double u[SLOPE_BLOCK], v[SLOPE_BLOCK]; /* within the first copies */
  float ax[SLOPE_BLOCK], ay[SLOPE_BLOCK], bx[SLOPE_BLOCK], by[SLOPE_BLOCK];
  float longer[SLOPE_BLOCK], shorter[SLOPE_BLOCK], cs[SLOPE_BLOCK], sn[SLOPE_BLOCK]; /* level 0 */
  float blend[SLOPE_BLOCK];
  int n1[SLOPE_BLOCK], n2[SLOPE_BLOCK];
  float x[SLOPE_BLOCK], y[SLOPE_BLOCK], xx[SLOPE_BLOCK], xy[SLOPE_BLOCK], yy[SLOPE_BLOCK];
} slope_lanes;

LEAF int footprint_steps(float texels) {
  const float most = 8;
  float n = texels - (float)SLOPE_COUNT_SLACK;
  n = n < most ? n : most;
  int k = -floor_to_int(-n);
  k = k < 2 ? 2 : k;
  k *= 2;
  return texels > 0 ? k : 1;
}

/* Places and footprints. What is not finite, or reaches far round the picture, is left out. */
static void slope_places(const shade_slope_map *m, size_t count, const slope_block *b,
                         slope_lanes *restrict o) {
  const float w = (float)m->width, h = (float)m->height;
  const float half_x = (float)m->pyramid.level[0].width / w,
              half_y = (float)m->pyramid.level[0].height / h;
  const int clamp = m->wrap == WRAP_CLAMP, mirror = m->wrap == WRAP_MIRROR;
  const float *restrict u = b->u, *restrict v = b->v;
  unsigned char *restrict single = b->single;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    /* beyond 2^25 single precision knows even numbers only, and 1e9 is as good as any */
    const float big = 1e9F, u1 = u[i] < -big ? -big : u[i], v1 = v[i] < -big ? -big : v[i];
    const float u2 = u1 > big ? big : u1, v2 = v1 > big ? big : v1;
    const int known = (fabsf(u[i]) <= 3.4e38F) & (fabsf(v[i]) <= 3.4e38F);
    const double p = known ? (double)u2 : 0, q = known ? (double)v2 : 0;
    const double period = mirror ? 2 : 1, inverse = mirror ? 0.5 : 1;
    const double p1 = p - period * floor_of(p * inverse), q1 = q - period * floor_of(q * inverse);
    /* clamped, one tile away is as good as any */
    double p2 = p < -1 ? -1 : p, q2 = q < -1 ? -1 : q;
    p2 = p2 > 2 ? 2 : p2;
    q2 = q2 > 2 ? 2 : q2;
    o->u[i] = clamp ? p2 : p1;
    o->v[i] = clamp ? q2 : q1;
    single[i] = (unsigned char)!known;
  }
  if (!b->side[0]) {
    for (size_t i = 0; i < count; i++) {
      o->ax[i] = o->ay[i] = o->bx[i] = o->by[i] = o->blend[i] = 0;
      o->n1[i] = o->n2[i] = 1;
    }
    return;
  }
  const float *restrict du1 = b->side[0], *restrict dv1 = b->side[1], *restrict du2 = b->side[2],
                        *restrict dv2 = b->side[3];
  int far[SLOPE_BLOCK]; /* bytes in this loop, and gcc 12 does not vectorise it */
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const float d1 = du1[i], e1 = dv1[i], d2 = du2[i], e2 = dv2[i];
    /* half a tile to either side, at most */
    const int near =
        (fabsf(d1) < 0.5F) & (fabsf(e1) < 0.5F) & (fabsf(d2) < 0.5F) & (fabsf(e2) < 0.5F);
    /* as bits, or gcc makes a branch of it */
    const uint32_t keep = 0u - (uint32_t)near;
    const float side1 = from_bitsf(to_bitsf(d1) & keep), up1 = from_bitsf(to_bitsf(e1) & keep);
    const float side2 = from_bitsf(to_bitsf(d2) & keep), up2 = from_bitsf(to_bitsf(e2) & keep);
    far[i] = !near;
    o->ax[i] = side1 * w;
    o->ay[i] = -up1 * h;
    o->bx[i] = side2 * w;
    o->by[i] = -up2 * h;
  }
  for (size_t i = 0; i < count; i++)
    single[i] = (unsigned char)(single[i] | far[i]);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const float ax = o->ax[i], ay = o->ay[i], bx = o->bx[i], by = o->by[i];
    o->n1[i] = footprint_steps(sqrtf(ax * ax + ay * ay));
    o->n2[i] = footprint_steps(sqrtf(bx * bx + by * by));
  }
  /* the ellipse's axes, in texels of level 0 */
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const float ax = o->ax[i], ay = o->ay[i], bx = o->bx[i], by = o->by[i];
    const float cx = ax * half_x, cy = ay * half_y, dx = bx * half_x, dy = by * half_y;
    const float xx = cx * cx + dx * dx, xy = cx * cy + dx * dy, yy = cy * cy + dy * dy;
    const float gap = 0.5F * (xx - yy), root = sqrtf(gap * gap + xy * xy);
    const float longer = sqrtf(0.5F * (xx + yy) + root), area = fabsf(cx * dy - cy * dx);
    /* half the angle of (gap, xy), without cancellation */
    const float part = sqrtf(0.5F * (root + fabsf(gap)) / (root + 1e-30F));
    const float other = 0.5F * fabsf(xy) / ((root + 1e-30F) * (part + 1e-30F));
    const float cs = gap > 0 ? part : other, sn = gap > 0 ? other : part;
    /* no axis to speak of: the first side's direction, as moments.c has it */
    const int round = root <= 0.5F * (float)MOMENT_ROUND * (xx + yy);
    const float side = 1 / (sqrtf(cx * cx + cy * cy) + 1e-30F);
    const float along = (cx + 1e-30F) * side, across = cy * side;
    const float turned = xy < 0 ? -sn : sn;
    o->cs[i] = round ? along : cs;
    o->sn[i] = round ? across : turned;
    o->longer[i] = longer;
    o->shorter[i] = area / (longer + 1e-30F);
    float blend = longer * 0.57735026918962576F - 1;
    blend = blend < 0 ? 0 : blend;
    o->blend[i] = blend > 1 ? 1 : blend;
  }
}

/* Both slopes of a texel, of which half as many are gathered. */
#if defined(__GNUC__)
typedef uint64_t __attribute__((may_alias)) slope_pair;
#define SLOPE_PAIRS(slopes) ((const slope_pair *)(const void *)(slopes))
#define SLOPE_OF(pairs, i, x, y)                                                                   \
  const uint64_t x##y = (pairs)[i];                                                                \
  const float x = from_bitsf((uint32_t)(x##y >> SLOPE_X)),                                         \
              y = from_bitsf((uint32_t)(x##y >> (32 - SLOPE_X)))
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
enum { SLOPE_X = 32 };
#else
enum { SLOPE_X = 0 };
#endif
#else
#define SLOPE_PAIRS(slopes) (slopes)
#define SLOPE_OF(pairs, i, x, y) const float x = (pairs)[2 * (i)], y = (pairs)[2 * (i) + 1]
#endif

/* Points of a group of lanes, in texels, and their sums about the first of each. */
typedef struct slope_group {
  int base_x[SLOPE_GROUP], base_y[SLOPE_GROUP], n1[SLOPE_GROUP], n2[SLOPE_GROUP];
  float fx[SLOPE_GROUP], fy[SLOPE_GROUP], over1[SLOPE_GROUP], over2[SLOPE_GROUP];
  float apart1[SLOPE_GROUP], apart2[SLOPE_GROUP]; /* as slopes.c has it */
  float ax[SLOPE_GROUP], ay[SLOPE_GROUP], bx[SLOPE_GROUP], by[SLOPE_GROUP];
  float cx[SLOPE_GROUP], cy[SLOPE_GROUP];
  float sx[SLOPE_GROUP], sy[SLOPE_GROUP], sxx[SLOPE_GROUP], sxy[SLOPE_GROUP], syy[SLOPE_GROUP];
} slope_group;

/* Point (a, b) of each lane. Choices that all lanes share are no choices in vectors. */
LEAF void slope_point_wrapped(const shade_slope_map *m, slope_group *restrict g, int a, int b,
                              int wrap) {
  const int width = m->width, height = m->height;
  const float begins = a == 0 && b == 0 ? 1 : 0;
  const float at_a = (float)a + 0.5F, sign_a = a % 2 ? 1 : -1;
  const float at_b = (float)b + 0.5F, sign_b = b % 2 ? 1 : -1;
  const slope_pair *restrict pairs = SLOPE_PAIRS(m->slopes);
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const int inside = a < g->n1[k] && b < g->n2[k];
    float s = (at_a + sign_a * g->apart1[k]) * g->over1[k] - 0.5F;
    float t = (at_b + sign_b * g->apart2[k]) * g->over2[k] - 0.5F;
    s = inside ? s : 0;
    t = inside ? t : 0;
    const float x = g->fx[k] + (s * g->ax[k] + t * g->bx[k]);
    const float y = g->fy[k] + (s * g->ay[k] + t * g->by[k]);
    const int ix = floor_to_int(x), iy = floor_to_int(y);
    const float tx = x - (float)ix, ty = y - (float)iy;
    const int left = wrap_near(g->base_x[k] + ix, width, wrap);
    const int right = wrap_near(g->base_x[k] + ix + 1, width, wrap);
    const int top = wrap_near(g->base_y[k] + iy, height, wrap) * width;
    const int bottom = wrap_near(g->base_y[k] + iy + 1, height, wrap) * width;
    SLOPE_OF(pairs, top + left, px, py);
    SLOPE_OF(pairs, top + right, qx, qy);
    SLOPE_OF(pairs, bottom + left, rx, ry);
    SLOPE_OF(pairs, bottom + right, zx, zy);
    const float hx = px + tx * (qx - px), hy = py + tx * (qy - py);
    const float lx = rx + tx * (zx - rx), ly = ry + tx * (zy - ry);
    const float gx = hx + ty * (lx - hx), gy = hy + ty * (ly - hy);
    /* about the first point: what is subtracted last is small */
    const float cx = g->cx[k] + begins * gx, cy = g->cy[k] + begins * gy;
    float dx = gx - cx, dy = gy - cy;
    dx = inside ? dx : 0;
    dy = inside ? dy : 0;
    g->cx[k] = cx;
    g->cy[k] = cy;
    g->sx[k] += dx;
    g->sy[k] += dy;
    g->sxx[k] += dx * dx;
    g->sxy[k] += dx * dy;
    g->syy[k] += dy * dy;
  }
}

/*
 * The same where no lane reaches an edge: a cell's texels lie side by side, and a lane takes two at
 * once. Of the gathers that would be needed this is a third of the time.
 */
static SLOPE_APART void slope_point_within(const shade_slope_map *m, slope_group *restrict g, int a,
                                           int b) {
  const int width = m->width;
  const float at_a = (float)a + 0.5F, sign_a = a % 2 ? 1 : -1;
  const float at_b = (float)b + 0.5F, sign_b = b % 2 ? 1 : -1;
  const float begins = a == 0 && b == 0 ? 1 : 0;
  int at[SLOPE_GROUP];
  float along[SLOPE_GROUP], down[SLOPE_GROUP], in[SLOPE_GROUP];
  _Alignas(64) float cell[SLOPE_GROUP][4];
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const int inside = a < g->n1[k] && b < g->n2[k];
    float s = (at_a + sign_a * g->apart1[k]) * g->over1[k] - 0.5F;
    float t = (at_b + sign_b * g->apart2[k]) * g->over2[k] - 0.5F;
    s = inside ? s : 0;
    t = inside ? t : 0;
    const float x = g->fx[k] + (s * g->ax[k] + t * g->bx[k]);
    const float y = g->fy[k] + (s * g->ay[k] + t * g->by[k]);
    const int ix = floor_to_int(x), iy = floor_to_int(y);
    at[k] = (g->base_y[k] + iy) * width + g->base_x[k] + ix;
    along[k] = x - (float)ix;
    down[k] = y - (float)iy;
    in[k] = inside ? 1 : 0;
  }
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float *top = m->slopes + 2 * (ptrdiff_t)at[k], *bottom = top + 2 * (ptrdiff_t)width;
    const float part = down[k];
#pragma omp simd
    for (int c = 0; c < 4; c++)
      cell[k][c] = top[c] + part * (bottom[c] - top[c]);
  }
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float gx = cell[k][0] + along[k] * (cell[k][2] - cell[k][0]);
    const float gy = cell[k][1] + along[k] * (cell[k][3] - cell[k][1]);
    const float cx = g->cx[k] + begins * gx, cy = g->cy[k] + begins * gy;
    const float dx = in[k] * (gx - cx), dy = in[k] * (gy - cy);
    g->cx[k] = cx;
    g->cy[k] = cy;
    g->sx[k] += dx;
    g->sy[k] += dy;
    g->sxx[k] += dx * dx;
    g->sxy[k] += dx * dy;
    g->syy[k] += dy * dy;
  }
}

static SLOPE_APART void slope_point(const shade_slope_map *m, slope_group *restrict g, int wrap,
                                    int a, int b) {
  if (wrap == WRAP_NOT)
    slope_point_within(m, g, a, b);
  else if (wrap == WRAP_REPEAT)
    slope_point_wrapped(m, g, a, b, WRAP_REPEAT);
  else if (wrap == WRAP_CLAMP)
    slope_point_wrapped(m, g, a, b, WRAP_CLAMP);
  else
    slope_point_wrapped(m, g, a, b, WRAP_MIRROR);
}

/* Means and covariances over the points of lanes [first, first + SLOPE_GROUP). */
static void slope_points(const shade_slope_map *m, slope_lanes *restrict o, size_t first) {
  const int width = m->width, height = m->height;
  slope_group g;
  int n1 = 0, n2 = 0;
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const int needed = o->blend[first + (size_t)k] < 1;
    n1 = needed && o->n1[first + (size_t)k] > n1 ? o->n1[first + (size_t)k] : n1;
    n2 = needed && o->n2[first + (size_t)k] > n2 ? o->n2[first + (size_t)k] : n2;
  }
  const double *restrict u = o->u + first, *restrict v = o->v + first;
  const float *restrict ax = o->ax + first, *restrict ay = o->ay + first,
                        *restrict bx = o->bx + first, *restrict by = o->by + first;
  const int *restrict m1 = o->n1 + first, *restrict m2 = o->n2 + first;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const double x = u[k] * width - 0.5, y = (1 - v[k]) * height - 0.5;
    const double whole_x = floor_of(x), whole_y = floor_of(y);
    g.base_x[k] = (int)whole_x;
    g.base_y[k] = (int)whole_y;
    g.fx[k] = (float)(x - whole_x);
    g.fy[k] = (float)(y - whole_y);
    g.n1[k] = m1[k];
    g.n2[k] = m2[k];
    g.over1[k] = 1 / (float)m1[k];
    g.over2[k] = 1 / (float)m2[k];
    const float near1 = 3 - 2 * sqrtf(ax[k] * ax[k] + ay[k] * ay[k]);
    const float near2 = 3 - 2 * sqrtf(bx[k] * bx[k] + by[k] * by[k]);
    const float part1 = near1 < -1 ? -1 : near1 > 1 ? 1 : near1;
    const float part2 = near2 < -1 ? -1 : near2 > 1 ? 1 : near2;
    g.apart1[k] = m1[k] == 1 ? 0 : (float)SLOPE_GAUSS_SHIFT * part1;
    g.apart2[k] = m2[k] == 1 ? 0 : (float)SLOPE_GAUSS_SHIFT * part2;
    g.ax[k] = ax[k];
    g.ay[k] = ay[k];
    g.bx[k] = bx[k];
    g.by[k] = by[k];
    g.cx[k] = g.cy[k] = g.sx[k] = g.sy[k] = g.sxx[k] = g.sxy[k] = g.syy[k] = 0;
  }
  int widths[SLOPE_GROUP], heights[SLOPE_GROUP];
  for (int k = 0; k < SLOPE_GROUP; k++)
    widths[k] = width, heights[k] = height;
  const int within = is_within(g.base_x, g.fx, g.ax, g.bx, widths) &&
                     is_within(g.base_y, g.fy, g.ay, g.by, heights);
  const int wrap = within ? (int)WRAP_NOT : (int)m->wrap;
  for (int a = 0; a < n1; a++)
    for (int b = 0; b < n2; b++)
      slope_point(m, &g, wrap, a, b);
  float *restrict ox = o->x + first, *restrict oy = o->y + first, *restrict oxx = o->xx + first,
                  *restrict oxy = o->xy + first, *restrict oyy = o->yy + first;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float part = g.over1[k] * g.over2[k], dx = g.sx[k] * part, dy = g.sy[k] * part;
    ox[k] = g.cx[k] + dx;
    oy[k] = g.cy[k] + dy;
    oxx[k] = g.sxx[k] * part - dx * dx;
    oxy[k] = g.sxy[k] * part - dx * dy;
    oyy[k] = g.syy[k] * part - dy * dy;
  }
}

/* Probes along one axis and the part of its length that they take, as moments.c has it. */
LEAF int slope_probes_along(float length, float texel, float *part) {
  float ratio = length / texel - (float)SLOPE_COUNT_SLACK;
  ratio = ratio < 16 ? ratio : 16;
  int n = -floor_to_int(-ratio);
  n = n < 1 ? 1 : n;
  const float rest = 1 - 3 * texel * texel / (length * length + 1e-30F);
  const float spread = sqrtf((rest > 0 ? rest : 0) / (1 - 1 / ((float)(n * n) + 1e-6F)));
  *part = n > 1 ? spread : 0;
  return n;
}

/* Probes of a group of lanes on a level each, in its texels. */
typedef struct slope_level {
  int n1[SLOPE_GROUP], n2[SLOPE_GROUP];
  int width[SLOPE_GROUP], height[SLOPE_GROUP];
  int base_x[SLOPE_GROUP], base_y[SLOPE_GROUP];
  float over1[SLOPE_GROUP], over2[SLOPE_GROUP];
  float fx[SLOPE_GROUP], fy[SLOPE_GROUP];
  float sx[SLOPE_GROUP], sy[SLOPE_GROUP], tx[SLOPE_GROUP], ty[SLOPE_GROUP]; /* whole axes */
  float weight[SLOPE_GROUP];                                                /* of a probe */
  const float *texels[SLOPE_GROUP];
  float sum[SLOPE_GROUP][8];
} slope_level;

/* Texels of a row of probes, as places of floats, and their weights. */
enum { SLOPE_ROW = 16 };
typedef struct slope_row {
  int at[SLOPE_ROW][4][SLOPE_GROUP];
  float part[SLOPE_ROW][4][SLOPE_GROUP];
} slope_row;

/* Texels and weights of probe (a, b). */
LEAF void slope_probe_wrapped(const slope_level *restrict l, slope_row *restrict r, int a, int b,
                              int wrap) {
  int(*restrict at)[SLOPE_GROUP] = r->at[b];
  float(*restrict part)[SLOPE_GROUP] = r->part[b];
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const int inside = a < l->n1[k] && b < l->n2[k];
    float s = ((float)a + 0.5F) * l->over1[k] - 0.5F, t = ((float)b + 0.5F) * l->over2[k] - 0.5F;
    s = inside ? s : 0;
    t = inside ? t : 0;
    const float x = l->fx[k] + (s * l->sx[k] + t * l->tx[k]);
    const float y = l->fy[k] + (s * l->sy[k] + t * l->ty[k]);
    const int ix = floor_to_int(x), iy = floor_to_int(y);
    const float tx = x - (float)ix, ty = y - (float)iy;
    const int width = l->width[k], height = l->height[k];
    const int left = wrap_near(l->base_x[k] + ix, width, wrap);
    const int right = wrap_near(l->base_x[k] + ix + 1, width, wrap);
    const int top = wrap_near(l->base_y[k] + iy, height, wrap) * width;
    const int bottom = wrap_near(l->base_y[k] + iy + 1, height, wrap) * width;
    const float weight = l->weight[k], w = inside ? weight : 0;
    at[0][k] = (top + left) * MOMENTS;
    at[1][k] = (top + right) * MOMENTS;
    at[2][k] = (bottom + left) * MOMENTS;
    at[3][k] = (bottom + right) * MOMENTS;
    part[0][k] = w * (1 - tx) * (1 - ty);
    part[1][k] = w * tx * (1 - ty);
    part[2][k] = w * (1 - tx) * ty;
    part[3][k] = w * tx * ty;
  }
}

static SLOPE_APART void slope_probe(const slope_level *restrict l, slope_row *restrict r, int wrap,
                                    int a, int b) {
  if (wrap == WRAP_NOT)
    slope_probe_wrapped(l, r, a, b, WRAP_NOT);
  else if (wrap == WRAP_REPEAT)
    slope_probe_wrapped(l, r, a, b, WRAP_REPEAT);
  else if (wrap == WRAP_CLAMP)
    slope_probe_wrapped(l, r, a, b, WRAP_CLAMP);
  else
    slope_probe_wrapped(l, r, a, b, WRAP_MIRROR);
}

/* Eight floats at any address, of which the last two are the next texel's: as one value, since gcc
 * unrolls a loop over probes into gathers of them. */
#if defined(__GNUC__)
typedef float __attribute__((vector_size(32), aligned(4), may_alias)) slope_eight;
#define SLOPE_EIGHT(from) (*(const slope_eight *)(const void *)(from))
#define SLOPE_ADD(sum, w, from) (sum) += (w)*SLOPE_EIGHT(from)
#else
typedef struct slope_eight {
  float c[8];
} slope_eight;
#define SLOPE_EIGHT(from) (*(const slope_eight *)(const void *)(from))
#define SLOPE_ADD(sum, w, from)                                                                    \
  for (int c = 0; c < 8; c++)                                                                      \
  (sum).c[c] += (w) * (from)[c]
#endif

/* Add what a row of probes holds. A lane's sums stay in registers; two, or each texel would wait
 * for the one before. */
static SLOPE_APART void slope_texels(slope_level *restrict l, const slope_row *restrict r,
                                     int probes) {
  static const float none[8];
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float *texels = l->texels[k];
    float below[8];
    slope_eight sum = SLOPE_EIGHT(l->sum[k]), other = SLOPE_EIGHT(none);
    for (int b = 0; b < probes; b++) {
      SLOPE_ADD(sum, r->part[b][0][k], texels + r->at[b][0][k]);
      SLOPE_ADD(other, r->part[b][2][k], texels + r->at[b][2][k]);
      SLOPE_ADD(sum, r->part[b][1][k], texels + r->at[b][1][k]);
      SLOPE_ADD(other, r->part[b][3][k], texels + r->at[b][3][k]);
    }
    memcpy(below, &other, sizeof below);
    SLOPE_ADD(sum, 1.0F, below);
    memcpy(l->sum[k], &sum, sizeof l->sum[k]);
  }
}

/* What lanes [first, first + SLOPE_GROUP) find in the pyramid, blended with the points. */
static void slope_probes(const shade_slope_map *m, slope_lanes *restrict o, size_t first) {
  const moment_pyramid *p = &m->pyramid;
  const float *restrict longer = o->longer + first, *restrict shorter = o->shorter + first;
  const float *restrict blend = o->blend + first, *restrict cs = o->cs + first,
                        *restrict sn = o->sn + first;
  const double *restrict u = o->u + first, *restrict v = o->v + first;
  int level[SLOPE_GROUP], most1 = 0, most2 = 0;
  float part1[SLOPE_GROUP], part2[SLOPE_GROUP], next[SLOPE_GROUP];
  slope_level l;
  slope_row row;
  const int last = p->levels - 1;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    float texel = shorter[k] * (1 / 3.0F), part = longer[k] * 0.0625F;
    texel = texel > part ? texel : part;
    texel = texel > 1 ? texel : 1;
    int which = (int)(to_bitsf(texel) >> 23) - 127;
    const int beyond = which >= last;
    which = beyond ? last : which;
    const float side = from_bitsf((uint32_t)(which + 127) << 23);
    texel = beyond ? side : texel;
    next[k] = beyond ? 0 : (texel * texel / (side * side) - 1) * (1 / 3.0F);
    level[k] = which;
    const int n1 = slope_probes_along(longer[k], texel, &part1[k]);
    l.n1[k] = blend[k] > 0 ? n1 : 0;
    l.n2[k] = slope_probes_along(shorter[k], texel, &part2[k]);
    l.over1[k] = 1 / (float)n1;
    l.over2[k] = 1 / (float)l.n2[k];
  }
  for (int k = 0; k < SLOPE_GROUP; k++) {
    most1 = l.n1[k] > most1 ? l.n1[k] : most1;
    most2 = l.n1[k] && l.n2[k] > most2 ? l.n2[k] : most2;
  }
  memset(l.sum, 0, sizeof l.sum);
  const float w0 = 1 / (float)p->level[0].width, h0 = 1 / (float)p->level[0].height;
  for (int coarse = 0; coarse < 2; coarse++) {
    int used = 0;
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const moment_level *from = &p->level[level[k] + (level[k] < last ? coarse : 0)];
      l.texels[k] = from->texels;
      l.width[k] = from->width;
      l.height[k] = from->height;
      used |= l.n1[k] && (!coarse || next[k] > 0);
    }
    if (!used)
      continue;
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const double x = u[k] * l.width[k] - 0.5, y = (1 - v[k]) * l.height[k] - 0.5;
      const double whole_x = floor_of(x), whole_y = floor_of(y);
      l.base_x[k] = (int)whole_x;
      l.base_y[k] = (int)whole_y;
      l.fx[k] = (float)(x - whole_x);
      l.fy[k] = (float)(y - whole_y);
      const float gx = (float)l.width[k] * w0, gy = (float)l.height[k] * h0;
      const float s = part1[k] * longer[k], t = part2[k] * shorter[k];
      l.sx[k] = s * cs[k] * gx;
      l.sy[k] = s * sn[k] * gy;
      l.tx[k] = -t * sn[k] * gx;
      l.ty[k] = t * cs[k] * gy;
      l.weight[k] = (coarse ? next[k] : 1 - next[k]) * l.over1[k] * l.over2[k];
    }
    const int within = is_within(l.base_x, l.fx, l.sx, l.tx, l.width) &&
                       is_within(l.base_y, l.fy, l.sy, l.ty, l.height);
    const int wrap = within ? (int)WRAP_NOT : (int)p->wrap;
    for (int a = 0; a < most1; a++) {
      for (int b = 0; b < most2; b++)
        slope_probe(&l, &row, wrap, a, b);
      slope_texels(&l, &row, most2);
    }
  }
  float *restrict x = o->x + first, *restrict y = o->y + first, *restrict xx = o->xx + first,
                  *restrict xy = o->xy + first, *restrict yy = o->yy + first;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float mx = l.sum[k][MOMENT_X], my = l.sum[k][MOMENT_Y];
    const float b = blend[k], dx = mx - x[k], dy = my - y[k], mixed = b * (1 - b);
    const int far = b >= 1;
    const float cxx = l.sum[k][MOMENT_XX] - mx * mx, cxy = l.sum[k][MOMENT_XY] - mx * my,
                cyy = l.sum[k][MOMENT_YY] - my * my;
    xx[k] = far ? cxx : xx[k] + b * (cxx - xx[k]) + mixed * dx * dx;
    xy[k] = far ? cxy : xy[k] + b * (cxy - xy[k]) + mixed * dx * dy;
    yy[k] = far ? cyy : yy[k] + b * (cyy - yy[k]) + mixed * dy * dy;
    x[k] = far ? mx : x[k] + b * dx;
    y[k] = far ? my : y[k] + b * dy;
  }
}

/* `count`: SLOPE_BLOCK at most. */
static void kernel_slopes(const shade_slope_map *m, size_t count, const slope_block *b) {
  slope_lanes o;
  slope_places(m, count, b, &o);
  const size_t whole = (count + SLOPE_GROUP - 1) / SLOPE_GROUP * SLOPE_GROUP;
  for (size_t i = count; i < whole; i++) { /* idle lanes look where the last one does */
    o.u[i] = o.u[count - 1];
    o.v[i] = o.v[count - 1];
    o.ax[i] = o.ay[i] = o.bx[i] = o.by[i] = o.blend[i] = o.longer[i] = o.shorter[i] = 0;
    o.cs[i] = o.sn[i] = 0;
    o.n1[i] = o.n2[i] = 1;
  }
  for (size_t first = 0; first < whole; first += SLOPE_GROUP) {
    int near = 0, far = 0;
    for (size_t i = first; i < first + SLOPE_GROUP && i < count; i++) {
      near |= o.blend[i] < 1;
      far |= o.blend[i] > 0;
    }
    if (near)
      slope_points(m, &o, first);
    if (far)
      slope_probes(m, &o, first);
  }
  float *restrict nx = b->nx, *restrict ny = b->ny, *restrict nz = b->nz;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const float inverse = 1 / sqrtf(o.x[i] * o.x[i] + o.y[i] * o.y[i] + 1);
    nx[i] = -o.x[i] * inverse;
    ny[i] = -o.y[i] * inverse;
    nz[i] = inverse;
  }
  if (!b->covariance[0])
    return;
  float *restrict cxx = b->covariance[0], *restrict cxy = b->covariance[1],
                  *restrict cyy = b->covariance[2];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const float xx = o.xx[i] > 0 ? o.xx[i] : 0, yy = o.yy[i] > 0 ? o.yy[i] : 0;
    const float most = sqrtf(xx * yy);
    float xy = o.xy[i] < -most ? -most : o.xy[i];
    xy = xy > most ? most : xy;
    cxx[i] = xx;
    cxy[i] = xy;
    cyy[i] = yy;
  }
}
