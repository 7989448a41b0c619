/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Look-ups of slopes over a block of lanes: the points, texels and weights of shade_slope_lookup,
 * in single precision. Points near a lane's own place are found and added up in vectors over lanes;
 * of the pyramid each lane reads whole texels, rows of them. Single precision only.
 */
#include "../src/slope_map.h"

#if defined(__GNUC__) && VECTOR_BYTES >= 32
#include <immintrin.h>
#endif

/* Two vectors of AVX-512, of which one can go on while the other waits; of four no more does. */
enum { SLOPE_GROUP = 32 };

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

LEAF float power_of_half(int n) { /* -127 < n < 127 */
  return from_bitsf((uint32_t)(127 - n) << 23);
}

LEAF double floor_of(double x) { /* |x| < 2^51 */
  const double magic = 6755399441055744.0, r = (x + magic) - magic;
  return r > x ? r - 1 : r;
}

/* Whether all points within half of a and b about f, in texels after `base`, lie between the
 * middles of n texels, along one axis; of a group. */
LEAF int is_within(const int *restrict base, const float *restrict f, const float *restrict a,
                   const float *restrict b, int n) {
  int beyond = 0;
#pragma omp simd reduction(| : beyond)
  for (int k = 0; k < SLOPE_GROUP; k++) {
    /* a hundredth more than what roundings of the places may add */
    const float reach = 0.505F * (fabsf(a[k]) + fabsf(b[k])) + 0.01F;
    const int low = base[k] + floor_to_int(f[k] - reach);
    const int high = base[k] + floor_to_int(f[k] + reach) + 1;
    beyond |= (low < 0) | (high >= n);
  }
  return !beyond;
}

/* The texel that lies at i, for -2n <= i < 3n. What lies further gives some texel. */
LEAF int wrap_near(int i, int n, int wrap) {
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
  /* of the footprint, times twelve, in texels: covariance, larger eigenvalue, root of the
   * determinant */
  float mxx[SLOPE_BLOCK], mxy[SLOPE_BLOCK], myy[SLOPE_BLOCK], longer2[SLOPE_BLOCK];
  float area[SLOPE_BLOCK], blend[SLOPE_BLOCK];
  float x[SLOPE_BLOCK], y[SLOPE_BLOCK], xx[SLOPE_BLOCK], xy[SLOPE_BLOCK], yy[SLOPE_BLOCK];
} slope_lanes;

/* Places and footprints. What is not finite, or reaches far round the picture, is left out. */
static void slope_places(const shade_slope_map *m, size_t count, const slope_block *b,
                         slope_lanes *restrict o) {
  const float w = (float)m->width, h = (float)m->height;
  const int clamp = m->wrap == WRAP_CLAMP, mirror = m->wrap == WRAP_MIRROR;
  const float *restrict u = b->u, *restrict v = b->v;
  unsigned char *restrict single = b->single;
  int far[SLOPE_BLOCK]; /* bytes in these loops, and gcc 12 does not vectorise them */
  const double period = mirror ? 2 : 1, inverse = mirror ? 0.5 : 1;
  const double low = clamp ? -1 : -2e9, high = clamp ? 2 : 2e9, tile = clamp ? 0 : period;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    /* beyond 2^25 single precision knows even numbers only, and 1e9 is as good as any */
    const float big = 1e9F, u1 = u[i] < -big ? -big : u[i], v1 = v[i] < -big ? -big : v[i];
    const float u2 = u1 > big ? big : u1, v2 = v1 > big ? big : v1;
    const int known = (fabsf(u[i]) <= 3.4e38F) & (fabsf(v[i]) <= 3.4e38F);
    const uint32_t keep = 0u - (uint32_t)known; /* as bits, or gcc makes a branch of it */
    const double p = (double)from_bitsf(to_bitsf(u2) & keep);
    const double q = (double)from_bitsf(to_bitsf(v2) & keep);
    /* clamped, one tile away is as good as any */
    double p1 = p < low ? low : p, q1 = q < low ? low : q;
    p1 = p1 > high ? high : p1;
    q1 = q1 > high ? high : q1;
    o->u[i] = p1 - tile * floor_of(p1 * inverse);
    o->v[i] = q1 - tile * floor_of(q1 * inverse);
    far[i] = !known;
  }
  for (size_t i = 0; i < count; i++)
    single[i] = (unsigned char)far[i];
  if (!b->side[0]) {
    for (size_t i = 0; i < count; i++) {
      o->ax[i] = o->ay[i] = o->bx[i] = o->by[i] = o->blend[i] = 0;
    }
    return;
  }
  const float *restrict du1 = b->side[0], *restrict dv1 = b->side[1], *restrict du2 = b->side[2],
                        *restrict dv2 = b->side[3];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const float d1 = du1[i], e1 = dv1[i], d2 = du2[i], e2 = dv2[i];
    /* half a tile to either side, at most */
    const int near =
        (fabsf(d1) < 0.5F) & (fabsf(e1) < 0.5F) & (fabsf(d2) < 0.5F) & (fabsf(e2) < 0.5F);
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
  int between = 0;
#pragma omp simd reduction(| : between)
  for (size_t i = 0; i < count; i++) {
    const float cx = o->ax[i], cy = o->ay[i], dx = o->bx[i], dy = o->by[i];
    const float xx = cx * cx + dx * dx, xy = cx * cy + dx * dy, yy = cy * cy + dy * dy;
    const float gap = 0.5F * (xx - yy), longer2 = 0.5F * (xx + yy) + sqrtf(gap * gap + xy * xy);
    o->mxx[i] = xx;
    o->mxy[i] = xy;
    o->myy[i] = yy;
    o->longer2[i] = longer2;
    const float whole = fabsf(cx * dy - cy * dx);
    o->area[i] = whole;
    const int near = (longer2 <= (float)(SLOPE_LONG_NEAR * SLOPE_LONG_NEAR)) &
                     (whole <= (float)(SLOPE_NEAR * SLOPE_NEAR));
    const int beyond = (longer2 >= (float)(SLOPE_LONG_FAR * SLOPE_LONG_FAR)) |
                       (whole >= (float)(SLOPE_FAR * SLOPE_FAR));
    between |= !(near | beyond);
    o->blend[i] = beyond ? 1 : 0;
  }
  if (!between) /* most often: no roots */
    return;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const float thin = (sqrtf(o->longer2[i]) - (float)SLOPE_LONG_NEAR) *
                       (float)(1 / (SLOPE_LONG_FAR - SLOPE_LONG_NEAR));
    const float round =
        (sqrtf(o->area[i]) - (float)SLOPE_NEAR) * (float)(1 / (SLOPE_FAR - SLOPE_NEAR));
    float blend = thin > round ? thin : round;
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
  float end1[SLOPE_GROUP], end2[SLOPE_GROUP], middle1[SLOPE_GROUP], middle2[SLOPE_GROUP];
  float ax[SLOPE_GROUP], ay[SLOPE_GROUP], bx[SLOPE_GROUP], by[SLOPE_GROUP];
  float cx[SLOPE_GROUP], cy[SLOPE_GROUP];
  float sx[SLOPE_GROUP], sy[SLOPE_GROUP], sxx[SLOPE_GROUP], sxy[SLOPE_GROUP], syy[SLOPE_GROUP];
} slope_group;

/* Point (a, b): where it is along the sides, and where that is in lane k; in the middle if the lane
 * has no such point. */
typedef struct slope_chosen {
  int a, b;
  float at_a, sign_a, at_b, sign_b;
} slope_chosen;

LEAF slope_chosen slope_chosen_of(int a, int b) {
  return (slope_chosen){a, b, (float)a + 0.5F, a % 2 ? 1 : -1, (float)b + 0.5F, b % 2 ? 1 : -1};
}

typedef struct slope_place {
  int inside;
  float x, y;
} slope_place;

LEAF slope_place slope_place_of(const slope_group *g, int k, slope_chosen c) {
  const int inside = c.a < g->n1[k] && c.b < g->n2[k];
  float s = (c.at_a + c.sign_a * g->apart1[k]) * g->over1[k] - 0.5F;
  float t = (c.at_b + c.sign_b * g->apart2[k]) * g->over2[k] - 0.5F;
  s = inside ? s : 0;
  t = inside ? t : 0;
  return (slope_place){inside, g->fx[k] + (s * g->ax[k] + t * g->bx[k]),
                       g->fy[k] + (s * g->ay[k] + t * g->by[k])};
}

/* Each lane's. Choices that all lanes share are no choices in vectors. */
LEAF void slope_point_wrapped(const shade_slope_map *m, slope_group *restrict g, int a, int b,
                              int wrap) {
  const int width = m->width, height = m->height;
  const float begins = a == 0 && b == 0 ? 1 : 0;
  const slope_chosen c = slope_chosen_of(a, b);
  const float *restrict part1 = a == 1 ? g->middle1 : g->end1;
  const float *restrict part2 = b == 1 ? g->middle2 : g->end2;
  const slope_pair *restrict pairs = SLOPE_PAIRS(m->slopes);
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const slope_place at = slope_place_of(g, k, c);
    const int inside = at.inside;
    const float x = at.x, y = at.y;
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
    const float dx = gx - cx, dy = gy - cy, weight = part1[k] * part2[k];
    const float wx = inside ? weight * dx : 0, wy = inside ? weight * dy : 0;
    g->cx[k] = cx;
    g->cy[k] = cy;
    g->sx[k] += wx;
    g->sy[k] += wy;
    g->sxx[k] += wx * dx;
    g->sxy[k] += wx * dy;
    g->syy[k] += wy * dy;
  }
}

/*
 * The same where no lane reaches an edge: a cell's texels lie side by side, and a lane takes two at
 * once. Of the gathers that would be needed this is a third of the time. Several points at a time,
 * for a vector that reads what was just written in parts waits for it.
 */
enum { SLOPE_POINTS = 9, SLOPE_LOOKS = SLOPE_POINTS * SLOPE_GROUP };
typedef struct slope_few {
  int a[SLOPE_POINTS], b[SLOPE_POINTS];
  int at[SLOPE_LOOKS]; /* of a point all lanes, then the next */
  float along[SLOPE_LOOKS], down[SLOPE_LOOKS], in[SLOPE_LOOKS];
  _Alignas(64) float cell[SLOPE_LOOKS][4];
} slope_few;

static SLOPE_APART void slope_places_within(const slope_group *restrict g, int width, int count,
                                            slope_few *restrict p) {
  for (int n = 0; n < count; n++) {
    const int a = p->a[n], b = p->b[n];
    const slope_chosen c = slope_chosen_of(a, b);
    const float *restrict part1 = a == 1 ? g->middle1 : g->end1;
    const float *restrict part2 = b == 1 ? g->middle2 : g->end2;
    const size_t begin = (size_t)n * SLOPE_GROUP;
    int *restrict at = p->at + begin;
    float *restrict along = p->along + begin, *restrict down = p->down + begin;
    float *restrict in = p->in + begin;
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const slope_place to = slope_place_of(g, k, c);
      const float x = to.x, y = to.y;
      const int ix = floor_to_int(x), iy = floor_to_int(y);
      at[k] = (g->base_y[k] + iy) * width + g->base_x[k] + ix;
      along[k] = x - (float)ix;
      down[k] = y - (float)iy;
      const float weight = part1[k] * part2[k];
      in[k] = to.inside ? weight : 0;
    }
  }
}

/* Both slopes at the left and the right texel of a cell, as far down as the point is. */
static SLOPE_APART void slope_sides_of_cells(const shade_slope_map *m, size_t count,
                                             const int *restrict at, const float *restrict down,
                                             float (*restrict cell)[4]) {
  const float *slopes = m->slopes;
  const ptrdiff_t stride = 2 * (ptrdiff_t)m->width;
  for (size_t i = 0; i < count; i++) {
    const float *top = slopes + 2 * (ptrdiff_t)at[i], *bottom = top + stride;
    const float part = down[i];
#pragma omp simd
    for (int c = 0; c < 4; c++)
      cell[i][c] = top[c] + part * (bottom[c] - top[c]);
  }
}

static SLOPE_APART void slope_sums_within(slope_group *restrict g, int count, int first,
                                          const slope_few *restrict p) {
  for (int n = 0; n < count; n++) {
    const float begins = first && n == 0 ? 1 : 0;
    const size_t begin = (size_t)n * SLOPE_GROUP;
    const float(*restrict cell)[4] = p->cell + begin;
    const float *restrict along = p->along + begin, *restrict in = p->in + begin;
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const float gx = cell[k][0] + along[k] * (cell[k][2] - cell[k][0]);
      const float gy = cell[k][1] + along[k] * (cell[k][3] - cell[k][1]);
      const float cx = g->cx[k] + begins * gx, cy = g->cy[k] + begins * gy;
      const float dx = gx - cx, dy = gy - cy, wx = in[k] * dx, wy = in[k] * dy;
      g->cx[k] = cx;
      g->cy[k] = cy;
      g->sx[k] += wx;
      g->sy[k] += wy;
      g->sxx[k] += wx * dx;
      g->sxy[k] += wx * dy;
      g->syy[k] += wy * dy;
    }
  }
}

/* All points of a group. */
static void slope_all_within(const shade_slope_map *m, slope_group *restrict g, int most1,
                             int most2) {
  slope_few p;
  int count = 0, first = 1;
  for (int a = 0; a < most1; a++)
    for (int b = 0; b < most2; b++) {
      p.a[count] = a;
      p.b[count++] = b;
      if (count < SLOPE_POINTS && !(a == most1 - 1 && b == most2 - 1))
        continue;
      slope_places_within(g, m->width, count, &p);
      slope_sides_of_cells(m, (size_t)count * SLOPE_GROUP, p.at, p.down, p.cell);
      slope_sums_within(g, count, first, &p);
      count = first = 0;
    }
}

static SLOPE_APART void slope_point(const shade_slope_map *m, slope_group *restrict g, int a,
                                    int b) {
  if (m->wrap == WRAP_REPEAT)
    slope_point_wrapped(m, g, a, b, WRAP_REPEAT);
  else if (m->wrap == WRAP_CLAMP)
    slope_point_wrapped(m, g, a, b, WRAP_CLAMP);
  else
    slope_point_wrapped(m, g, a, b, WRAP_MIRROR);
}

/* Points along a side so many texels long, as slopes.c has them. As masks, or gcc makes branches.
 */
LEAF int slope_count(float texels) {
  const float most = 8, counted = texels - (float)SLOPE_COUNT_SLACK;
  const float whole = counted < most ? counted : most;
  const int few = -(counted <= (float)SLOPE_FEW), none = -(texels <= 0);
  const int steps = (-2 * floor_to_int(-whole) & ~few) | (3 & few);
  return (steps & ~none) | (1 & none);
}

LEAF float slope_apart(float texels) {
  float part = 3 - 2 * texels;
  part = part < -1 ? -1 : part;
  return (float)SLOPE_GAUSS_SHIFT * (part > 1 ? 1 : part);
}

/* Where lanes look in the picture. */
static SLOPE_APART void slope_begin(const shade_slope_map *m, const double *restrict u,
                                    const double *restrict v, slope_group *restrict g) {
  const int width = m->width, height = m->height;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const double x = u[k] * width - 0.5, whole = floor_of(x);
    g->base_x[k] = (int)whole;
    g->fx[k] = (float)(x - whole);
  }
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const double y = (1 - v[k]) * height - 0.5, whole = floor_of(y);
    g->base_y[k] = (int)whole;
    g->fy[k] = (float)(y - whole);
  }
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    g->n1[k] = g->n2[k] = 1;
    g->over1[k] = g->over2[k] = g->end1[k] = g->end2[k] = g->middle1[k] = g->middle2[k] = 1;
    g->apart1[k] = g->apart2[k] = g->ax[k] = g->ay[k] = g->bx[k] = g->by[k] = 0;
    g->cx[k] = g->cy[k] = g->sx[k] = g->sy[k] = g->sxx[k] = g->sxy[k] = g->syy[k] = 0;
  }
}

/* The points along one side of each lane, of which `blend` says whether it needs any. The most of
 * them. */
static SLOPE_APART int slope_side(const float *restrict x, const float *restrict y,
                                  const float *restrict blend, int *restrict n,
                                  float *restrict over, float *restrict apart, float *restrict end,
                                  float *restrict middle) {
  int most = 0;
#pragma omp simd reduction(max : most)
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float texels = sqrtf(x[k] * x[k] + y[k] * y[k]);
    const int steps = slope_count(texels), needed = steps & -(blend[k] < 1);
    const float each = 1 / (float)steps, shift = slope_apart(texels);
    most = needed > most ? needed : most;
    n[k] = needed;
    over[k] = each;
    apart[k] = steps > 3 ? shift : 0;
    end[k] = steps == 3 ? 0.375F : each;
    middle[k] = steps == 3 ? 0.25F : each;
  }
  return most;
}

/* Means and covariances over the points of lanes [first, first + SLOPE_GROUP). */
static void slope_points(const shade_slope_map *m, slope_lanes *restrict o, size_t first,
                         int sides) {
  slope_group g;
  int most[2] = {1, 1};
  slope_begin(m, o->u + first, o->v + first, &g);
  if (sides) {
    const size_t size = sizeof g.ax;
    memcpy(g.ax, o->ax + first, size);
    memcpy(g.ay, o->ay + first, size);
    memcpy(g.bx, o->bx + first, size);
    memcpy(g.by, o->by + first, size);
    most[0] = slope_side(g.ax, g.ay, o->blend + first, g.n1, g.over1, g.apart1, g.end1, g.middle1);
    most[1] = slope_side(g.bx, g.by, o->blend + first, g.n2, g.over2, g.apart2, g.end2, g.middle2);
  }
  const int within = is_within(g.base_x, g.fx, g.ax, g.bx, m->width) &&
                     is_within(g.base_y, g.fy, g.ay, g.by, m->height);
  if (within)
    slope_all_within(m, &g, most[0], most[1]);
  else
    for (int a = 0; a < most[0]; a++)
      for (int b = 0; b < most[1]; b++)
        slope_point(m, &g, a, b);
  float *restrict ox = o->x + first, *restrict oy = o->y + first, *restrict oxx = o->xx + first,
                  *restrict oxy = o->xy + first, *restrict oyy = o->yy + first;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float dx = g.sx[k], dy = g.sy[k];
    ox[k] = g.cx[k] + dx;
    oy[k] = g.cy[k] + dy;
    oxx[k] = g.sxx[k] - dx * dx;
    oxy[k] = g.sxy[k] - dx * dy;
    oyy[k] = g.syy[k] - dy * dy;
  }
}

/* Lanes without footprint, in the same way. */
enum { SLOPE_PLAIN = 64 };
typedef struct slope_plain {
  int at[SLOPE_PLAIN];
  float along[SLOPE_PLAIN], down[SLOPE_PLAIN];
  _Alignas(64) float cell[SLOPE_PLAIN][4];
} slope_plain;

/* Where `count` lanes look; 1 if none reaches an edge. */
static SLOPE_APART int slope_plain_places(const shade_slope_map *m, const double *restrict u,
                                          const double *restrict v, size_t count,
                                          slope_plain *restrict p) {
  const int width = m->width, height = m->height;
  int beyond = 0;
#pragma omp simd reduction(| : beyond)
  for (size_t i = 0; i < count; i++) {
    const double x = u[i] * width - 0.5, y = (1 - v[i]) * height - 0.5;
    const double left = floor_of(x), top = floor_of(y);
    const int column = (int)left, row = (int)top;
    p->along[i] = (float)(x - left);
    p->down[i] = (float)(y - top);
    p->at[i] = (int)((unsigned)row * (unsigned)width + (unsigned)column); /* any, if beyond */
    beyond |= (column < 0) | (column + 1 >= width) | (row < 0) | (row + 1 >= height);
  }
  return !beyond;
}

static SLOPE_APART void slope_plain_slopes(const slope_plain *restrict p, size_t count,
                                           float *restrict x, float *restrict y) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    x[i] = p->cell[i][0] + p->along[i] * (p->cell[i][2] - p->cell[i][0]);
    y[i] = p->cell[i][1] + p->along[i] * (p->cell[i][3] - p->cell[i][1]);
  }
}

/* Slopes at the points of the first lanes of a block. */
static void slope_plain_lanes(const shade_slope_map *m, slope_lanes *restrict o, size_t end) {
  slope_plain p;
  for (size_t first = 0; first < end; first += SLOPE_PLAIN) {
    const size_t count = end - first < SLOPE_PLAIN ? end - first : SLOPE_PLAIN;
    if (slope_plain_places(m, o->u + first, o->v + first, count, &p)) {
      slope_sides_of_cells(m, count, p.at, p.down, p.cell);
      slope_plain_slopes(&p, count, o->x + first, o->y + first);
      memset(o->xx + first, 0, count * sizeof *o->xx);
      memset(o->xy + first, 0, count * sizeof *o->xy);
      memset(o->yy + first, 0, count * sizeof *o->yy);
    } else {
      for (size_t i = first; i < first + count; i += SLOPE_GROUP)
        slope_points(m, o, i, 0);
    }
  }
}

/* As moments.c has them. */
LEAF float slope_covered(float depth) {
#ifdef __AVX512F__
  /* cut at 0 and 2 as bits, of which no comparison is made; of floats it is one and more */
  const int bits = (int)to_bitsf(depth), two = 0x40000000, low = bits < 0 ? 0 : bits;
  const float cut = from_bitsf((uint32_t)(low < two ? low : two));
  return cut - 0.5F * cut * fabsf(cut - 1);
#else
  /* twice what is cut at -1 and 1, without a comparison: of those gcc makes five and more */
  const float cut2 = fabsf(depth) - fabsf(depth - 2);
  return (1 + 0.5F * cut2) * (1 - 0.25F * fabsf(cut2));
#endif
}

LEAF float slope_cover(float half, float distance) {
  return slope_covered(half - distance) + slope_covered(half + distance) - 1;
}

/* `over`: 1/side^3 */
LEAF float slope_filter_width(float side, float over) {
  return side * (0.54403F + 0.45597F * sqrtf(1 - 5.1961524F * over)) + 0.18635F * side * over;
}

/* Filters of a group of lanes on a level each, in its texels. */
typedef struct slope_filter {
  const float *texels[SLOPE_GROUP]; /* NULL: cells between the picture's texels */
  int width[SLOPE_GROUP], height[SLOPE_GROUP];
  float middle[SLOPE_GROUP];                    /* of the first of them, from the picture's edge */
  int base_x[SLOPE_GROUP], base_y[SLOPE_GROUP]; /* what `fx` and all below are from */
  float fx[SLOPE_GROUP], fy[SLOPE_GROUP];
  float half_x[SLOPE_GROUP], half_y[SLOPE_GROUP], shear[SLOPE_GROUP], weight[SLOPE_GROUP];
  int top[SLOPE_GROUP], rows[SLOPE_GROUP], cols[SLOPE_GROUP]; /* 0: an idle lane */
  /* in texels as they are stored: row to row, and where the first row has x = 0 */
  int pitch[SLOPE_GROUP], start[SLOPE_GROUP];
  int most_rows, least_rows, most_cols, least_cols; /* of those in use */
  int narrow;                                       /* some less than 3 wide */
  int straight;              /* rows begin one below the other, but for what roundings move them */
  float sum[SLOPE_GROUP][8]; /* of texels */
  float x[SLOPE_GROUP], y[SLOPE_GROUP]; /* of cells */
  float xx[SLOPE_GROUP], xy[SLOPE_GROUP], yy[SLOPE_GROUP];
} slope_filter;

/* Texels of some rows of the filters: where each row begins, and weights. No row is longer: 16
 * times 1.85 texels (MOMENT_LONGEST, MOMENT_ACROSS), twice that of the finer of two levels, and 2.
 */
enum { SLOPE_TAPS = 64, SLOPE_STRAIGHT = 8 };
/* Of rows in pairs of texels one or two more each: ten rows of six columns, eight of eight. */
enum { SLOPE_PARTS = 80 };
/* Cells are added up in patches of so many rows and columns at most. */
enum { SLOPE_ROWS = 4, SLOPE_COLS = 5 };
typedef struct slope_taps {
  int left[SLOPE_TAPS][SLOPE_GROUP], at[SLOPE_TAPS][SLOPE_GROUP]; /* x; where that is stored */
  float begin[SLOPE_TAPS][SLOPE_GROUP], weight[SLOPE_TAPS][SLOPE_GROUP]; /* of rows */
  float part[SLOPE_PARTS][SLOPE_GROUP];                                  /* of texels */
  float column[SLOPE_STRAIGHT][SLOPE_GROUP]; /* where all rows are alike: of each */
} slope_taps;

/* Where rows begin, from the filter's middle too, and what they weigh. */
static SLOPE_APART void slope_rows(const slope_filter *restrict f, slope_taps *restrict t,
                                   int first, int count) {
  for (int r = 0; r < count; r++) {
    int(*restrict left) = t->left[r], (*restrict place) = t->at[r];
    float(*restrict begin) = t->begin[r], (*restrict weight) = t->weight[r];
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const float down = (float)(f->top[k] + first + r) - f->fy[k];
      const float at = f->fx[k] + f->shear[k] * down;
      left[k] = -floor_to_int(f->half_x[k] - at);
      begin[k] = (float)left[k] - at;
      place[k] = (int)((unsigned)f->start[k] + (unsigned)(first + r) * (unsigned)f->pitch[k] +
                       (unsigned)left[k]);
      weight[k] = f->weight[k] * slope_cover(f->half_y[k], down);
    }
  }
}

/* Weights of `cols` texels a row by lanes, times `weight`; `narrow`: any of them may be near both
 * edges. */
LEAF void slope_row_weights(const slope_filter *restrict f, const float *restrict begin,
                            const float *restrict weight, int cols, int narrow,
                            float (*restrict part)[SLOPE_GROUP]) {
  /* three texels wide and more, no texel is near both edges */
  for (int c = 0; c < cols; c++) {
    const int near_left = narrow || c < 2;
    const int near_right = narrow || c >= f->least_cols - 3;
    if (near_left && near_right) {
#pragma omp simd
      for (int k = 0; k < SLOPE_GROUP; k++)
        part[c][k] = weight[k] * slope_cover(f->half_x[k], begin[k] + (float)c);
    } else if (near_left) {
#pragma omp simd
      for (int k = 0; k < SLOPE_GROUP; k++)
        part[c][k] = weight[k] * slope_covered(f->half_x[k] + (begin[k] + (float)c));
    } else if (near_right) {
#pragma omp simd
      for (int k = 0; k < SLOPE_GROUP; k++)
        part[c][k] = weight[k] * slope_covered(f->half_x[k] - (begin[k] + (float)c));
    } else {
      memcpy(part[c], weight, sizeof part[c]);
    }
  }
}

/* Where rows are straight, of one of them. */
static SLOPE_APART void slope_columns(const slope_filter *restrict f, slope_taps *restrict t,
                                      int cols) {
  float whole[SLOPE_GROUP];
  for (int k = 0; k < SLOPE_GROUP; k++)
    whole[k] = 1;
  slope_row_weights(f, t->begin[0], whole, cols, f->narrow, t->column);
}

static SLOPE_APART void slope_weights(const slope_filter *restrict f, slope_taps *restrict t,
                                      int count, int cols, int narrow) {
  if (f->straight && cols <= SLOPE_STRAIGHT) {
    slope_columns(f, t, cols);
    for (int r = 0; r < count; r++)
      for (int c = 0; c < cols; c++)
#pragma omp simd
        for (int k = 0; k < SLOPE_GROUP; k++)
          t->part[r * cols + c][k] = t->weight[r][k] * t->column[c][k];
    return;
  }
  for (int r = 0; r < count; r++)
    slope_row_weights(f, t->begin[r], t->weight[r], cols, narrow, t->part + r * cols);
}

/* A texel as stored: one value, since gcc unrolls a loop over texels into gathers of them; two
 * where vectors are shorter, or gcc keeps it in memory. */
#if defined(__GNUC__)
typedef float __attribute__((vector_size(16), aligned(4), may_alias)) slope_four;
#define SLOPE_FOUR(from) (*(const slope_four *)(const void *)(from))
#endif
#if defined(__GNUC__) && VECTOR_BYTES >= 32
typedef float __attribute__((vector_size(32), aligned(4), may_alias)) slope_eight;
#define SLOPE_EIGHT(from) (*(const slope_eight *)(const void *)(from))
#define SLOPE_ADD(sum, w, from) (sum) += (w)*SLOPE_EIGHT(from)
#define SLOPE_JOIN(a, b) ((a) += (b))
#define SLOPE_SCALED(sum, w, a) (sum) += (w) * (a)
#define SLOPE_PUT(to, a) (*(slope_eight *)(void *)(to) = (a))
#elif defined(__GNUC__)
typedef struct slope_eight {
  slope_four low, high;
} slope_eight;
#define SLOPE_EIGHT(from) ((slope_eight){SLOPE_FOUR(from), SLOPE_FOUR((from) + 4)})
#define SLOPE_ADD(sum, w, from)                                                                    \
  ((sum).low += (w)*SLOPE_FOUR(from), (sum).high += (w)*SLOPE_FOUR((from) + 4))
#define SLOPE_JOIN(a, b) ((a).low += (b).low, (a).high += (b).high)
#define SLOPE_SCALED(sum, w, a) ((sum).low += (w) * (a).low, (sum).high += (w) * (a).high)
#define SLOPE_PUT(to, a)                                                                           \
  (*(slope_four *)(void *)(to) = (a).low, *(slope_four *)(void *)((to) + 4) = (a).high)
#else
typedef struct slope_eight {
  float c[8];
} slope_eight;
#define SLOPE_EIGHT(from) (*(const slope_eight *)(const void *)(from))
#define SLOPE_ADD(sum, w, from)                                                                    \
  for (int i = 0; i < 8; i++)                                                                      \
  (sum).c[i] += (w) * (from)[i]
#define SLOPE_JOIN(a, b)                                                                           \
  for (int i = 0; i < 8; i++)                                                                      \
  (a).c[i] += (b).c[i]
#define SLOPE_SCALED(sum, w, a)                                                                    \
  for (int i = 0; i < 8; i++)                                                                      \
  (sum).c[i] += (w) * (a).c[i]
#define SLOPE_PUT(to, a)                                                                           \
  for (int i = 0; i < 8; i++)                                                                      \
  (to)[i] = (a).c[i]
#endif

/* Add rows of a lane's texels that lie side by side. Two sums, or each texel would wait for the one
 * before. */
static SLOPE_APART void slope_read(slope_filter *restrict f, const slope_taps *restrict t, int k,
                                   int rows, int cols, int stride) {
  static const float none[8];
  const float *part = &t->part[0][k];
  slope_eight sum = SLOPE_EIGHT(f->sum[k]), other = SLOPE_EIGHT(none);
  for (int r = 0; r < rows; r++) {
    const float *texel = f->texels[k] + t->at[r][k] * (ptrdiff_t)MOMENT_FLOATS;
    for (int c = 0; c < cols; c++) {
      if (c % 2)
        SLOPE_ADD(other, part[c * SLOPE_GROUP], texel + c * MOMENT_FLOATS);
      else
        SLOPE_ADD(sum, part[c * SLOPE_GROUP], texel + c * MOMENT_FLOATS);
    }
    part += stride * SLOPE_GROUP;
  }
  SLOPE_JOIN(sum, other);
  SLOPE_PUT(f->sum[k], sum);
}

/* The same where they reach an edge. */
static SLOPE_APART void slope_read_wrapped(slope_filter *restrict f, const slope_taps *restrict t,
                                           int k, int first, int rows, int cols, moment_wrap wrap) {
  slope_eight sum = SLOPE_EIGHT(f->sum[k]);
  for (int r = 0; r < rows; r++) {
    const int y = wrap_index(f->base_y[k] + f->top[k] + first + r, f->height[k], wrap);
    const float *row = f->texels[k] + y * moment_stride(f->width[k]);
    const float *part = &t->part[r * f->most_cols][k];
    for (int c = 0; c < cols; c++) {
      const int x = wrap_index(f->base_x[k] + t->left[r][k] + c, f->width[k], wrap);
      SLOPE_ADD(sum, part[c * SLOPE_GROUP], row + x * MOMENT_FLOATS);
    }
  }
  SLOPE_PUT(f->sum[k], sum);
}

/* Whether a group's filters lie within their levels, and where. */
static SLOPE_APART void slope_inside(slope_filter *restrict f, int *restrict inside) {
  const int rows = f->most_rows + 1, cols = f->most_cols + 1; /* a cell's texels, too */
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const int apron = f->middle[k] < 1 ? MOMENT_APRON : 0; /* none about cells */
    f->pitch[k] = f->width[k] + 2 * apron;
    f->start[k] = (int)((unsigned)(f->base_y[k] + f->top[k]) * (unsigned)f->pitch[k] +
                        (unsigned)f->base_x[k]);
    const int top = f->base_y[k] + f->top[k] + apron;
    const float begin = f->shear[k] * ((float)f->top[k] - f->fy[k]);
    const float end = begin + f->shear[k] * (float)(rows - 1);
    const float low = (begin < end ? begin : end) - f->half_x[k] + f->fx[k] - 0.01F;
    const float high = (begin < end ? end : begin) - f->half_x[k] + f->fx[k] + 0.01F;
    const int left = f->base_x[k] + floor_to_int(low) + apron;
    const int right = f->width[k] + apron - (f->base_x[k] + floor_to_int(high) + 1 + cols);
    inside[k] = (top | (f->height[k] + 2 * apron - top - rows) | left | right) >= 0;
  }
}

/* Rows of lanes that all lie within one level and are alike, without a branch in between. */
LEAF void slope_read_alike(slope_filter *restrict f, const slope_taps *restrict t,
                           const int *restrict inside, int first, int rows, moment_wrap wrap,
                           int cols) {
  const float *restrict texels = f->texels[0];
  static const float none[8];
  const slope_eight zero = SLOPE_EIGHT(none);
  for (int k = 0; k < SLOPE_GROUP; k++) {
    if (!inside[k]) {
      const int own = f->rows[k] - first < rows ? f->rows[k] - first : rows;
      slope_read_wrapped(f, t, k, first, own, f->cols[k], wrap);
      continue;
    }
    const int *at = &t->at[0][k];
    const float *part = &t->part[0][k];
    slope_eight sum = SLOPE_EIGHT(f->sum[k]), sum1 = zero, sum2 = zero, sum3 = zero;
    for (int r = 0; r < rows; r++) {
      const float *texel = texels + *at * (ptrdiff_t)MOMENT_FLOATS;
#define SLOPE_COLUMN(to, c)                                                                        \
  if ((c) < cols)                                                                                  \
  SLOPE_ADD(to, part[(c)*SLOPE_GROUP], texel + (c)*MOMENT_FLOATS)
      SLOPE_COLUMN(sum, 0);
      SLOPE_COLUMN(sum1, 1);
      SLOPE_COLUMN(sum2, 2);
      SLOPE_COLUMN(sum3, 3);
      SLOPE_COLUMN(sum, 4);
      SLOPE_COLUMN(sum1, 5);
      SLOPE_COLUMN(sum2, 6);
      SLOPE_COLUMN(sum3, 7);
#undef SLOPE_COLUMN
      at += SLOPE_GROUP;
      part += cols * SLOPE_GROUP;
    }
    SLOPE_JOIN(sum, sum1);
    SLOPE_JOIN(sum2, sum3);
    SLOPE_JOIN(sum, sum2);
    SLOPE_PUT(f->sum[k], sum);
  }
}

#if defined(__GNUC__) && VECTOR_BYTES == 64
/*
 * Sheared rows where a vector is a pair of texels: half as many loads, of which there are more than
 * of anything else. Pairs are aligned, or every other one would lie in two lines of cache: rows
 * begin at even texels, where need be at one more that weighs nothing.
 */
#define SLOPE_PAIRED
enum { SLOPE_TWO = 2 * SLOPE_GROUP };

/* As slope_covered; of comparisons there gcc makes more. */
LEAF __m512 slope_covered_wide(__m512 depth) {
  const __m512 one = _mm512_set1_ps(1), two = _mm512_set1_ps(2), half = _mm512_set1_ps(0.5F);
  const __m512 cut = _mm512_min_ps(_mm512_max_ps(depth, _mm512_setzero_ps()), two);
  const __m512 off = _mm512_abs_ps(_mm512_sub_ps(cut, one));
  return _mm512_fnmadd_ps(_mm512_mul_ps(half, cut), off, cut);
}

/* Of column c, as slope_row_weights has it. */
LEAF __m512 slope_column_weight(__m512 half, __m512 begin, __m512 weight, int c, int cols,
                                int right, int narrow) {
  if (c >= cols)
    return _mm512_setzero_ps();
  const __m512 from = _mm512_add_ps(begin, _mm512_set1_ps((float)c));
  const int near_left = narrow || c < 2, near_right = narrow || c >= right;
  if (near_left && near_right) {
    const __m512 low = slope_covered_wide(_mm512_add_ps(half, from));
    const __m512 high = slope_covered_wide(_mm512_sub_ps(half, from));
    return _mm512_mul_ps(weight, _mm512_sub_ps(_mm512_add_ps(high, low), _mm512_set1_ps(1)));
  }
  if (near_left)
    return _mm512_mul_ps(weight, slope_covered_wide(_mm512_add_ps(half, from)));
  if (near_right)
    return _mm512_mul_ps(weight, slope_covered_wide(_mm512_sub_ps(half, from)));
  return weight;
}

/* Let rows begin at even texels, and weigh pairs: both of a lane lie side by side. */
LEAF void slope_pair_weights(const slope_filter *restrict f, slope_taps *restrict t, int rows,
                             int cols, int pairs) {
  const __m512i low = _mm512_set_epi32(23, 7, 22, 6, 21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0);
  const __m512i high = _mm512_add_epi32(low, _mm512_set1_epi32(8)), one = _mm512_set1_epi32(1);
  const int right = f->least_cols - 3, narrow = f->narrow;
  for (int k = 0; k < SLOPE_GROUP; k += 16) {
    const __m512 half = _mm512_loadu_ps(f->half_x + k);
    for (int r = 0; r < rows; r++) {
      const __m512 begin = _mm512_loadu_ps(t->begin[r] + k);
      const __m512 weight = _mm512_loadu_ps(t->weight[r] + k);
      const __m512i at = _mm512_loadu_si512(t->at[r] + k),
                    left = _mm512_loadu_si512(t->left[r] + k);
      const __mmask16 odd = _mm512_test_epi32_mask(at, one);
      _mm512_storeu_si512(t->at[r] + k, _mm512_mask_sub_epi32(at, odd, at, one));
      _mm512_storeu_si512(t->left[r] + k, _mm512_mask_sub_epi32(left, odd, left, one));
      float *part = t->part[2 * r * pairs] + 2 * k;
      __m512 last = _mm512_setzero_ps();
      for (int c = 0; c < 2 * pairs; c += 2, part += SLOPE_TWO) {
        const __m512 a = slope_column_weight(half, begin, weight, c, cols, right, narrow);
        const __m512 b = slope_column_weight(half, begin, weight, c + 1, cols, right, narrow);
        const __m512 first = _mm512_mask_mov_ps(a, odd, last);
        const __m512 second = _mm512_mask_mov_ps(b, odd, a);
        _mm512_storeu_ps(part, _mm512_permutex2var_ps(first, low, second));
        _mm512_storeu_ps(part + 16, _mm512_permutex2var_ps(first, high, second));
        last = b;
      }
    }
  }
}

/* Of a lane that reaches an edge. */
static SLOPE_APART void slope_pairs_wrapped(slope_filter *restrict f, const slope_taps *restrict t,
                                            int k, int first, int rows, int pairs,
                                            moment_wrap wrap) {
  slope_eight sum = SLOPE_EIGHT(f->sum[k]);
  for (int r = 0; r < rows; r++) {
    const int y = wrap_index(f->base_y[k] + f->top[k] + first + r, f->height[k], wrap);
    const float *row = f->texels[k] + y * moment_stride(f->width[k]);
    const float *part = t->part[2 * r * pairs] + 2 * k;
    for (int c = 0; c < 2 * pairs; c++) {
      const int x = wrap_index(f->base_x[k] + t->left[r][k] + c, f->width[k], wrap);
      SLOPE_ADD(sum, part[c / 2 * SLOPE_TWO + c % 2], row + x * MOMENT_FLOATS);
    }
  }
  SLOPE_PUT(f->sum[k], sum);
}

LEAF __m512 slope_pair_weight(const float *part) {
  const __m512i first_second = _mm512_set_epi32(1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0);
  const long long both = (long long)*(const slope_pair *)(const void *)part;
  return _mm512_permutevar_ps(_mm512_castsi512_ps(_mm512_set1_epi64(both)), first_second);
}

LEAF void slope_read_pairs(slope_filter *restrict f, const slope_taps *restrict t,
                           const int *restrict inside, int first, int rows, moment_wrap wrap,
                           int pairs) {
  const float *restrict texels = f->texels[0];
  for (int k = 0; k < SLOPE_GROUP; k++) {
    if (!inside[k]) {
      const int own = f->rows[k] - first < rows ? f->rows[k] - first : rows;
      slope_pairs_wrapped(f, t, k, first, own, pairs, wrap);
      continue;
    }
    const int *at = &t->at[0][k];
    const float *part = t->part[0] + 2 * k;
    __m512 sum = _mm512_setzero_ps(), sum1 = sum, sum2 = sum;
    for (int r = 0; r < rows; r++) {
      const float *texel = texels + *at * (ptrdiff_t)MOMENT_FLOATS;
#define SLOPE_COLUMNS(to, p)                                                                       \
  if ((p) < pairs)                                                                                 \
  to = _mm512_fmadd_ps(slope_pair_weight(part + (p)*SLOPE_TWO),                                    \
                       _mm512_loadu_ps(texel + (p)*2 * MOMENT_FLOATS), to)
      SLOPE_COLUMNS(sum, 0);
      SLOPE_COLUMNS(sum1, 1);
      SLOPE_COLUMNS(sum2, 2);
      SLOPE_COLUMNS(sum, 3);
      SLOPE_COLUMNS(sum1, 4);
#undef SLOPE_COLUMNS
      at += SLOPE_GROUP;
      part += pairs * SLOPE_TWO;
    }
    sum = _mm512_add_ps(_mm512_add_ps(sum, sum1), sum2);
    slope_eight all = SLOPE_EIGHT(f->sum[k]);
    const __m256d high = _mm512_extractf64x4_pd(_mm512_castps_pd(sum), 1);
    all += (slope_eight)_mm512_castps512_ps256(sum) + (slope_eight)_mm256_castpd_ps(high);
    SLOPE_PUT(f->sum[k], all);
  }
}

static SLOPE_APART void slope_texels_paired(slope_filter *restrict f, slope_taps *restrict t,
                                            const int *restrict inside, int first, int rows,
                                            moment_wrap wrap) {
#define SLOPE_PAIRS_OF(n)                                                                          \
  case n:                                                                                          \
    slope_pair_weights(f, t, rows, n, ((n) + 2) / 2);                                              \
    slope_read_pairs(f, t, inside, first, rows, wrap, ((n) + 2) / 2);                              \
    break
  switch (f->most_cols) {
    SLOPE_PAIRS_OF(3);
    SLOPE_PAIRS_OF(4);
    SLOPE_PAIRS_OF(5);
    SLOPE_PAIRS_OF(6);
    SLOPE_PAIRS_OF(7);
    SLOPE_PAIRS_OF(8);
  default:
    break;
  }
#undef SLOPE_PAIRS_OF
}
#endif

/* The same of straight rows: their sums by the weights of columns, which all share. */
LEAF void slope_read_straight(slope_filter *restrict f, const slope_taps *restrict t,
                              const int *restrict inside, int rows, int cols) {
  const float *restrict texels = f->texels[0];
  const ptrdiff_t pitch = (ptrdiff_t)f->pitch[0] * MOMENT_FLOATS;
  static const float none[8];
  const slope_eight zero = SLOPE_EIGHT(none);
  for (int k = 0; k < SLOPE_GROUP; k++) {
    if (!inside[k])
      continue;
    const float *texel = texels + t->at[0][k] * (ptrdiff_t)MOMENT_FLOATS;
    const float *column = &t->column[0][k], *weight = &t->weight[0][k];
    slope_eight sum = SLOPE_EIGHT(f->sum[k]);
    for (int r = 0; r < rows; r++, texel += pitch, weight += SLOPE_GROUP) {
      slope_eight row = zero, row1 = zero;
#define SLOPE_COLUMN(to, c)                                                                        \
  if ((c) < cols)                                                                                  \
  SLOPE_ADD(to, column[(c)*SLOPE_GROUP], texel + (c)*MOMENT_FLOATS)
      SLOPE_COLUMN(row, 0);
      SLOPE_COLUMN(row1, 1);
      SLOPE_COLUMN(row, 2);
      SLOPE_COLUMN(row1, 3);
      SLOPE_COLUMN(row, 4);
      SLOPE_COLUMN(row1, 5);
      SLOPE_COLUMN(row, 6);
      SLOPE_COLUMN(row1, 7);
#undef SLOPE_COLUMN
      SLOPE_JOIN(row, row1);
      SLOPE_SCALED(sum, *weight, row);
    }
    SLOPE_PUT(f->sum[k], sum);
  }
}

/* Those of lanes that reach an edge. */
static SLOPE_APART void slope_straight_wrapped(slope_filter *restrict f, slope_taps *restrict t,
                                               const int *restrict inside, int first, int rows,
                                               moment_wrap wrap) {
  const int cols = f->most_cols;
  for (int k = 0; k < SLOPE_GROUP; k++) {
    if (inside[k])
      continue;
    const int own = f->rows[k] - first < rows ? f->rows[k] - first : rows;
    for (int r = 0; r < own; r++)
      for (int c = 0; c < cols; c++)
        t->part[r * cols + c][k] = t->weight[r][k] * t->column[c][k];
    slope_read_wrapped(f, t, k, first, own, f->cols[k], wrap);
  }
}

/* 0 if nothing is done. */
static SLOPE_APART int slope_texels_alike(slope_filter *restrict f, slope_taps *restrict t,
                                          const int *restrict inside, int first, int rows,
                                          moment_wrap wrap) {
  const int cols = f->most_cols;
  if (cols < 3 || cols > SLOPE_STRAIGHT)
    return 0;
#ifdef SLOPE_PAIRED
  if (!f->straight) {
    slope_texels_paired(f, t, inside, first, rows, wrap);
    return 1;
  }
#endif
  if (f->straight) {
    slope_columns(f, t, cols);
    slope_straight_wrapped(f, t, inside, first, rows, wrap);
  } else {
    slope_weights(f, t, rows, cols, f->narrow);
  }
#define SLOPE_ALIKE(n)                                                                             \
  if (cols == (n) && f->straight)                                                                  \
    slope_read_straight(f, t, inside, rows, n);                                                    \
  else if (cols == (n))                                                                            \
  slope_read_alike(f, t, inside, first, rows, wrap, n)
  SLOPE_ALIKE(3);
  SLOPE_ALIKE(4);
  SLOPE_ALIKE(5);
  SLOPE_ALIKE(6);
  SLOPE_ALIKE(7);
  SLOPE_ALIKE(8);
#undef SLOPE_ALIKE
  return 1;
}

/* Rows [first, first + rows) of all. Lanes that are nearly alike read as many texels, with weights
 * of 0: a branch would be mistaken as often as not. */
static SLOPE_APART void slope_texels(slope_filter *restrict f, const slope_taps *restrict t,
                                     const int *restrict inside, int first, int rows,
                                     moment_wrap wrap) {
  const int stride = f->most_cols, alike = stride - f->least_cols < 2;
  for (int k = 0; k < SLOPE_GROUP; k++) {
    if (f->rows[k] <= first || !f->texels[k])
      continue;
    const int own = f->rows[k] - first < rows ? f->rows[k] - first : rows;
    if (!inside[k])
      slope_read_wrapped(f, t, k, first, own, f->cols[k], wrap);
    else if (!alike || rows - own > 1)
      slope_read(f, t, k, own, f->cols[k], stride);
    else
      slope_read(f, t, k, rows, stride, stride);
  }
}

#if defined(__GNUC__)
/* As many lanes as fill a vector. */
enum { SLOPE_WIDE = VECTOR_BYTES / sizeof(float) };
typedef float __attribute__((vector_size(VECTOR_BYTES), aligned(4), may_alias)) slope_wide;
typedef int32_t __attribute__((vector_size(VECTOR_BYTES), aligned(4), may_alias)) slope_wide_ints;
#define SLOPE_WIDE_AT(from) (*(const slope_wide *)(const void *)(from))
#define SLOPE_INTS_AT(from) (*(const slope_wide_ints *)(const void *)(from))

/*
 * Squares of four of either vector's quarters: elements i to l of a and b. And what lies at `from`
 * lane j, and each fourth lane from there; by intrinsics, for of shuffles gcc makes twice as many
 * instructions.
 */
#ifdef __has_builtin
#if __has_builtin(__builtin_shufflevector)
#define SLOPE_TURNED
#if VECTOR_BYTES == 64
#define SLOPE_MIXED(a, b, i, j, k, l)                                                              \
  __builtin_shufflevector(a, b, i, j, k, l, 4 + (i), 4 + (j), 4 + (k), 4 + (l), 8 + (i), 8 + (j),  \
                          8 + (k), 8 + (l), 12 + (i), 12 + (j), 12 + (k), 12 + (l))
#elif VECTOR_BYTES == 32
#define SLOPE_MIXED(a, b, i, j, k, l)                                                              \
  __builtin_shufflevector(a, b, i, j, k, l, 4 + (i), 4 + (j), 4 + (k), 4 + (l))
#else
#define SLOPE_MIXED(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#endif
LEAF slope_wide slope_quarters(const float *const *from, ptrdiff_t on) {
#if VECTOR_BYTES == 64
  __m512 all = _mm512_castps128_ps512(_mm_loadu_ps(from[0] + on));
  all = _mm512_insertf32x4(all, _mm_loadu_ps(from[4] + on), 1);
  all = _mm512_insertf32x4(all, _mm_loadu_ps(from[8] + on), 2);
  return (slope_wide)_mm512_insertf32x4(all, _mm_loadu_ps(from[12] + on), 3);
#elif VECTOR_BYTES == 32
  const __m256 low = _mm256_castps128_ps256(_mm_loadu_ps(from[0] + on));
  return (slope_wide)_mm256_insertf128_ps(low, _mm_loadu_ps(from[4] + on), 1);
#else
  return SLOPE_FOUR(from[0] + on);
#endif
}
#endif
#endif

/* Texels between which patches of cells lie. Rows of cells that begin at different columns have two
 * rows of texels each. */
typedef struct slope_patch {
  slope_wide x[2 * SLOPE_ROWS][SLOPE_COLS + 1], y[2 * SLOPE_ROWS][SLOPE_COLS + 1];
} slope_patch;

/* A row of `count` texels of each lane, from texel at[k] on. */
LEAF void slope_patch_row(const float *slopes, const int *at, int count, slope_wide *x,
                          slope_wide *y) {
#ifdef SLOPE_TURNED
  enum { N = SLOPE_WIDE, PAIRS = SLOPE_COLS / 2 + 1 };
  slope_wide of[4][PAIRS];
  for (int j = 0; j < 4; j++) {
    const float *from[SLOPE_WIDE];
    for (int k = j; k < SLOPE_WIDE; k += 4)
      from[k - j] = slopes + 2 * (size_t)(unsigned)at[k];
    for (int i = 0; 2 * i < count; i++)
      of[j][i] = slope_quarters(from, (ptrdiff_t)4 * i);
  }
  for (int i = 0; 2 * i < count; i++) {
    const slope_wide low = SLOPE_MIXED(of[0][i], of[1][i], 0, N, 1, N + 1),
                     low2 = SLOPE_MIXED(of[2][i], of[3][i], 0, N, 1, N + 1);
    x[2 * i] = SLOPE_MIXED(low, low2, 0, 1, N, N + 1);
    y[2 * i] = SLOPE_MIXED(low, low2, 2, 3, N + 2, N + 3);
    if (2 * i + 1 == count)
      break;
    const slope_wide high = SLOPE_MIXED(of[0][i], of[1][i], 2, N + 2, 3, N + 3),
                     high2 = SLOPE_MIXED(of[2][i], of[3][i], 2, N + 2, 3, N + 3);
    x[2 * i + 1] = SLOPE_MIXED(high, high2, 0, 1, N, N + 1);
    y[2 * i + 1] = SLOPE_MIXED(high, high2, 2, 3, N + 2, N + 3);
  }
#else
  for (int i = 0; i < count; i++)
    for (int k = 0; k < SLOPE_WIDE; k++) {
      x[i][k] = slopes[2 * ((size_t)(unsigned)at[k] + (size_t)i)];
      y[i][k] = slopes[2 * ((size_t)(unsigned)at[k] + (size_t)i) + 1];
    }
#endif
}

/* Of two texels side by side: sums; differences over the root of 3; sums of products of either. */
typedef struct slope_edge {
  slope_wide x, y, rise_x, rise_y, xx, xy, yy;
} slope_edge;

LEAF slope_edge slope_edge_of(const slope_patch *p, int row, int column) {
  const slope_wide *x = &p->x[row][column], *y = &p->y[row][column];
  const float third = 0.57735026918962576F;
  slope_edge e;
  e.x = x[0] + x[1];
  e.y = y[0] + y[1];
  e.rise_x = third * (x[1] - x[0]);
  e.rise_y = third * (y[1] - y[0]);
  e.xx = e.x * e.x + e.rise_x * e.rise_x;
  e.xy = e.x * e.y + e.rise_x * e.rise_y;
  e.yy = e.y * e.y + e.rise_y * e.rise_y;
  return e;
}

/*
 * Add moments over patches of cells by their weights. Of the bilinear patch between two edges, s
 * the sum of their sums and r that of their differences, four times the mean is s, and 24 times
 * that of a product the product of s and s, and of r and r, and what either edge has of it.
 * `bent`: 1 where rows begin at different columns.
 */
LEAF void slope_patch_sums(slope_filter *restrict f, const float *restrict part,
                           const slope_patch *restrict p, const int *restrict mask, size_t k,
                           int stride, int rows, int cols, int bent) {
  const slope_wide_ints keep = SLOPE_INTS_AT(mask + k);
  slope_wide x = {0}, y = {0}, xx = {0}, xy = {0}, yy = {0};
  for (int c = 0; c < cols; c++) {
    slope_edge upper = slope_edge_of(p, 0, c);
    for (int r = 0; r < rows; r++) {
      if (bent && r)
        upper = slope_edge_of(p, 2 * r, c);
      const slope_edge lower = slope_edge_of(p, bent ? 2 * r + 1 : r + 1, c);
      const slope_wide w =
          (slope_wide)(SLOPE_INTS_AT(part + (r * stride + c) * SLOPE_GROUP) & keep);
      const slope_wide sx = upper.x + lower.x, sy = upper.y + lower.y;
      const slope_wide rx = upper.rise_x + lower.rise_x, ry = upper.rise_y + lower.rise_y;
      x += w * sx;
      y += w * sy;
      xx += w * (upper.xx + lower.xx + sx * sx + rx * rx);
      xy += w * (upper.xy + lower.xy + sx * sy + rx * ry);
      yy += w * (upper.yy + lower.yy + sy * sy + ry * ry);
      upper = lower;
    }
  }
  const float quarter = 0.25F, least = 0.041666666666666667F;
  *(slope_wide *)(void *)(f->x + k) += quarter * x;
  *(slope_wide *)(void *)(f->y + k) += quarter * y;
  *(slope_wide *)(void *)(f->xx + k) += least * xx;
  *(slope_wide *)(void *)(f->xy + k) += least * xy;
  *(slope_wide *)(void *)(f->yy + k) += least * yy;
}

/* `all` cells a row, in patches of `cols`. */
LEAF void slope_patches(const shade_slope_map *m, slope_filter *restrict f,
                        const slope_taps *restrict t, const int *restrict mask, int first, int rows,
                        int all, int cols, int bent) {
  const float *below = m->slopes + 2 * (ptrdiff_t)m->width;
  slope_patch p;
  for (size_t k = 0; k < SLOPE_GROUP; k += SLOPE_WIDE) {
    int last = rows, end = all;
    if (bent) { /* lanes may be unlike: no more than these need */
      last = end = 0;
      for (size_t i = k; i < k + SLOPE_WIDE; i++) {
        const int down = (f->rows[i] - first) & mask[i], across = f->cols[i] & mask[i];
        last = down > last ? down : last;
        end = across > end ? across : end;
      }
      last = last < rows ? last : rows;
    }
    for (int r = 0; r < last; r += SLOPE_ROWS) {
      const int count = last - r < SLOPE_ROWS ? last - r : SLOPE_ROWS;
      for (int from = 0; from < end; from += cols) {
        const int own = end - from < cols ? end - from : cols;
        for (int i = 0; i < count; i++) {
          const int *at = &t->at[r + i][k], to = bent ? 2 * i : i;
          if (bent || i == 0)
            slope_patch_row(m->slopes + 2 * from, at, cols + 1, p.x[to], p.y[to]);
          slope_patch_row(below + 2 * from, at, cols + 1, p.x[to + 1], p.y[to + 1]);
        }
        slope_patch_sums(f, &t->part[r * all + from][k], &p, mask, k, all, count, own, bent);
      }
    }
  }
}

/*
 * Whether rows of all lanes in `mask` begin at the same column; where few begin a little apart,
 * from the first of these on. What the longest then is; 0 where they are left as they were.
 */
LEAF int slope_straight(slope_taps *restrict t, const int *restrict mask, int rows, int cols) {
  int first[SLOPE_GROUP], most = 0, bent = 0;
  for (int r = 1; r < rows; r++)
#pragma omp simd reduction(| : bent)
    for (int k = 0; k < SLOPE_GROUP; k++)
      bent |= (t->left[r][k] ^ t->left[0][k]) & mask[k];
  if (!bent)
    return cols;
  memcpy(first, t->left[0], sizeof first);
  for (int r = 1; r < rows; r++)
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++)
      first[k] = t->left[r][k] < first[k] ? t->left[r][k] : first[k];
  for (int r = 0; r < rows; r++)
#pragma omp simd reduction(max : most)
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const int on = (t->left[r][k] - first[k]) & mask[k];
      most = on > most ? on : most;
    }
  if (rows > SLOPE_ROWS || cols + most > SLOPE_COLS)
    return 0;
  for (int r = 0; r < rows; r++)
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const int on = t->left[r][k] - first[k];
      t->at[r][k] -= on;
      t->begin[r][k] -= (float)on;
    }
  return cols + most;
}
#endif

/* The same wherever they lie. */
static SLOPE_APART void slope_read_cells_wrapped(const shade_slope_map *m, slope_filter *restrict f,
                                                 const slope_taps *restrict t, int k, int first,
                                                 int rows, int cols) {
  float *to[5] = {f->x + k, f->y + k, f->xx + k, f->xy + k, f->yy + k};
  for (int r = 0; r < rows; r++) {
    const int y = f->base_y[k] + f->top[k] + first + r;
    const float *upper = m->slopes + 2 * (ptrdiff_t)wrap_index(y, m->height, m->wrap) * m->width;
    const float *lower =
        m->slopes + 2 * (ptrdiff_t)wrap_index(y + 1, m->height, m->wrap) * m->width;
    for (int c = 0; c < cols; c++) {
      const int x = f->base_x[k] + t->left[r][k] + c;
      const int left = 2 * wrap_index(x, m->width, m->wrap);
      const int right = 2 * wrap_index(x + 1, m->width, m->wrap);
      const float w = t->weight[r][k] * slope_cover(f->half_x[k], t->begin[r][k] + (float)c);
      float sum[2], across[2], down[2], twist[2];
      for (int i = 0; i < 2; i++) {
        const float rise = upper[right + i] - upper[left + i];
        const float rise2 = lower[right + i] - lower[left + i];
        const float both = upper[right + i] + upper[left + i];
        const float both2 = lower[right + i] + lower[left + i];
        sum[i] = both + both2;
        across[i] = rise + rise2;
        down[i] = both2 - both;
        twist[i] = rise2 - rise;
        *to[i] += 0.25F * w * sum[i];
      }
      for (int i = 0; i < 3; i++) {
        const int a = i == 2, b = i != 0;
        *to[2 + i] += 0.0625F * w *
                      (sum[a] * sum[b] + (across[a] * across[b] + down[a] * down[b]) / 3 +
                       twist[a] * twist[b] / 9);
      }
    }
  }
}

/* Rows [first, first + rows) of lanes that read cells, all as many: the rest weigh nothing. */
static SLOPE_APART void slope_cells(const shade_slope_map *m, slope_filter *restrict f,
                                    slope_taps *restrict t, const int *restrict inside, int first,
                                    int rows) {
#if defined(__GNUC__)
  int mask[SLOPE_GROUP], some = 0;
  unsigned left_out = 0;
#pragma omp simd reduction(| : left_out)
  for (int k = 0; k < SLOPE_GROUP; k++) {
    mask[k] = -(inside[k] & (f->middle[k] > 0.75F) & (f->rows[k] > first));
    left_out |= ~(unsigned)mask[k];
  }
#else
  const int left_out = 1;
#endif
  for (int k = 0; k < SLOPE_GROUP && left_out; k++) {
    if (f->rows[k] <= first || f->texels[k])
      continue;
#if defined(__GNUC__)
    if (mask[k]) {
      some = k;
      continue;
    }
#endif
    const int own = f->rows[k] - first < rows ? f->rows[k] - first : rows;
    slope_read_cells_wrapped(m, f, t, k, first, own, f->cols[k]);
  }
#if defined(__GNUC__)
  if (!mask[some])
    return;
  const int cols = slope_straight(t, mask, rows, f->most_cols), own = cols ? cols : f->most_cols;
  slope_weights(f, t, rows, own, f->narrow || own > f->most_cols);
  for (int r = 0; r < rows && left_out; r++)
    for (int k = 0; k < SLOPE_GROUP; k++) /* idle lanes read what another does */
      t->at[r][k] = mask[k] ? t->at[r][k] : t->at[r][some];
  if (!cols && own == 3)
    slope_patches(m, f, t, mask, first, rows, 3, 3, 1);
  else if (!cols)
    slope_patches(m, f, t, mask, first, rows, own, 5, 1);
  else if (cols == 3)
    slope_patches(m, f, t, mask, first, rows, 3, 3, 0);
  else if (cols == 4)
    slope_patches(m, f, t, mask, first, rows, 4, 4, 0);
  else
    slope_patches(m, f, t, mask, first, rows, own, 5, 0);
#endif
}

/* Levels that a group of lanes reads. */
typedef struct slope_choice {
  int level[SLOPE_GROUP], coarse[SLOPE_GROUP]; /* coarse: 1 where the next level is mixed in */
  float next[SLOPE_GROUP];                     /* how much of it */
  float own[SLOPE_GROUP], thin[SLOPE_GROUP];   /* the shorter axis' square; at least a part of the
                                                * longer one's */
} slope_choice;

static SLOPE_APART void slope_choose(const slope_lanes *restrict o, size_t first, int last,
                                     slope_choice *restrict c) {
  const float *restrict longer2 = o->longer2 + first, *restrict area = o->area + first;
  const float across = (float)(MOMENT_ACROSS * MOMENT_ACROSS);
  const float along = (float)(MOMENT_SQUARE * MOMENT_SQUARE);
  const float from = (float)MOMENT_CELLS_NEAR, to = (float)MOMENT_CELLS_FAR;
  const float next4 = (float)(MOMENT_NEXT * MOMENT_NEXT * MOMENT_NEXT * MOMENT_NEXT);
  float side4[SLOPE_GROUP]; /* fourth powers and squares, as far as they do: roots are slow */
  int finest[SLOPE_GROUP], mixed = 0;
#pragma omp simd reduction(| : mixed)
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float longer = longer2[k] + 1e-30F, own = area[k] * area[k] / longer;
    const float part = longer * (float)MOMENT_LONGEST, thin = own > part ? own : part;
    const float across4 = thin * thin * across, along4 = longer * thin * along;
    const float small = across4 < along4 ? across4 : along4, own4 = small > 1 ? small : 1;
    const int own_finest = ((int)(to_bitsf(own4) >> 23) - 127) >> 2;
    const float own_side4 = own4 * power_of_half(4 * own_finest);
    const int cells = own_finest == 0, leave = cells & (area[k] >= to * to);
    const int own_level = own_finest + leave, few = own_level < last;
    mixed |= few & !leave & ((cells & (area[k] > from * from)) | (!cells & (own_side4 > next4)));
    c->own[k] = own;
    c->thin[k] = thin;
    c->level[k] = few ? own_level : last;
    c->coarse[k] = 0;
    c->next[k] = 0;
    finest[k] = own_finest;
    side4[k] = own_side4;
  }
  if (!mixed)
    return;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float cells = (sqrtf(area[k]) - from) * (1 / (to - from));
    const float beyond =
        (sqrtf(sqrtf(side4[k])) - (float)MOMENT_NEXT) * (float)(1 / (2 - MOMENT_NEXT));
    const int stays = (c->level[k] == finest[k]) & (c->level[k] < last);
    float above = finest[k] == 0 ? cells : beyond;
    above = stays ? above : 0;
    c->coarse[k] = above > 0 ? 1 : 0;
    c->next[k] = above > 0 ? above : 0;
  }
}

/* Where lanes look on their levels. */
static SLOPE_APART void slope_locate(const double *restrict u, const double *restrict v,
                                     slope_filter *restrict f) {
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const double x = u[k] * f->width[k] - (double)f->middle[k], whole = floor_of(x);
    f->base_x[k] = (int)whole;
    f->fx[k] = (float)(x - whole);
  }
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const double y = (1 - v[k]) * f->height[k] - (double)f->middle[k], whole = floor_of(y);
    f->base_y[k] = (int)whole;
    f->fy[k] = (float)(y - whole);
  }
}

/* Square of the shortest axis that a level's kind can tell. The shorter one is grown to it, to
 * where the longer is at most. */
LEAF float slope_told(int level) {
  return (float)MOMENT_LEAST * (level ? 4.0F : 1.0F);
}

/* Filters on levels of which level 0 is w0, h0 times as large. `used`: -1 for lanes that are. */
static SLOPE_APART void slope_shape(const slope_lanes *restrict o, size_t at,
                                    const slope_choice *restrict c, int coarse,
                                    const int *restrict used, float w0, float h0,
                                    slope_filter *restrict f) {
  const float fine = coarse ? 0 : 1, sign = coarse ? 1 : -1;
  const float *restrict longer2 = o->longer2 + at;
  const float *restrict mxx = o->mxx + at, *restrict mxy = o->mxy + at, *restrict myy = o->myy + at;
  int most_rows = 0, least_rows = 99, most_cols = 0, least_cols = 99, narrow = 0, slanted = 0;
  float grown[SLOPE_GROUP];
  int grows = 0;
#pragma omp simd reduction(| : grows)
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float told = slope_told(c->level[k] + (coarse & c->coarse[k])), own = c->own[k];
    grows |= (c->thin[k] > own) | (told > own);
    grown[k] = 0;
  }
  if (grows) { /* least often: no division */
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++) {
      const float told = slope_told(c->level[k] + (coarse & c->coarse[k])), own = c->own[k];
      const float shorter = c->thin[k] > told ? c->thin[k] : told;
      const float gap = longer2[k] + 1e-30F - own;
      const float full = (shorter - own) / (gap > 1e-30F ? gap : 1e-30F);
      grown[k] = full < 1 ? full : 1;
    }
  }
#pragma omp simd reduction(max                                                                     \
                           : most_rows, most_cols) reduction(min                                   \
                                                             : least_rows, least_cols)             \
    reduction(|                                                                                    \
              : narrow, slanted)
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const int level = c->level[k] + (coarse & c->coarse[k]);
    const float halved = power_of_half(level);
    const float longer = longer2[k] + 1e-30F, thin = c->thin[k];
    const float told = slope_told(level), shorter = thin > told ? thin : told, grow = grown[k];
    const float of_x = (float)f->width[k] * w0, of_y = (float)f->height[k] * h0;
    const float gx = of_x < halved ? of_x : halved, gy = of_y < halved ? of_y : halved;
    const float xx = gx * gx * (mxx[k] + grow * (longer - mxx[k]));
    const float xy = gx * gy * (mxy[k] - grow * mxy[k]);
    const float yy = gy * gy * (myy[k] + grow * (longer - myy[k]));
    const float least = (float)MOMENT_LEAST, spread = (yy > least ? yy : least) - 1;
    const float area2 = gx * gx * gy * gy * longer * shorter;
    /* two reciprocals by one division */
    const float side = sqrtf(spread + 1), cube = (spread + 1) * side, both = 1 / (spread * cube);
    const float inverse = cube * both, high = slope_filter_width(side, spread * both);
    const float told2 = (area2 - xx) * inverse, square = told2 > least ? told2 : least;
    const float root = sqrtf(square), wide = slope_filter_width(root, 1 / (square * root));
    const float half_x = 0.5F * (wide + 1), half_y = 0.5F * (high + 1);
    const float shear = xy * inverse;
    slanted |= (fabsf(shear) * high > 5e-7F) & used[k];
    f->shear[k] = shear;
    f->half_x[k] = half_x;
    f->half_y[k] = half_y;
    f->weight[k] = (fine + sign * c->next[k]) / (wide * high);
    const int top = -floor_to_int(half_y - f->fy[k]);
    const int rows = (floor_to_int(f->fy[k] + half_y) + 1 - top) & used[k];
    const int cols = (int)(wide + 2) & used[k];
    f->top[k] = top;
    f->rows[k] = rows;
    f->cols[k] = cols;
    const int seen = cols | (99 & ~used[k]), seen_rows = rows | (99 & ~used[k]);
    least_cols = seen < least_cols ? seen : least_cols;
    least_rows = seen_rows < least_rows ? seen_rows : least_rows;
    narrow |= (wide < 3) & used[k];
    most_rows = rows > most_rows ? rows : most_rows;
    most_cols = cols > most_cols ? cols : most_cols;
  }
  f->most_rows = most_rows;
  f->least_rows = least_rows;
  f->most_cols = most_cols;
  f->least_cols = least_cols;
  f->narrow = narrow;
  f->straight = !slanted;
  for (int k = 0; k < SLOPE_GROUP && !slanted; k++)
    f->shear[k] = 0;
}

static SLOPE_APART void slope_begin_sums(slope_filter *restrict f) {
  static const float none[8];
  const slope_eight nothing = SLOPE_EIGHT(none);
  for (int k = 0; k < SLOPE_GROUP; k++)
    SLOPE_PUT(f->sum[k], nothing);
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++)
    f->x[k] = f->y[k] = f->xx[k] = f->xy[k] = f->yy[k] = 0;
}

/* Blend what the points of lanes found with what their filters did. */
LEAF void slope_blend_in(slope_lanes *restrict o, size_t first, const slope_filter *restrict f,
                         int texels) {
  const float *restrict blend = o->blend + first;
  float *restrict x = o->x + first, *restrict y = o->y + first, *restrict xx = o->xx + first,
                  *restrict xy = o->xy + first, *restrict yy = o->yy + first;
#pragma omp simd
  for (int k = 0; k < SLOPE_GROUP; k++) {
    const float *of = f->sum[k];
    const float mx = f->x[k] + (texels ? of[MOMENT_X] : 0);
    const float my = f->y[k] + (texels ? of[MOMENT_Y] : 0);
    const float b = blend[k], dx = mx - x[k], dy = my - y[k], mixed = b * (1 - b);
    const int far = b >= 1;
    const float cxx = f->xx[k] + (texels ? of[MOMENT_XX] : 0) - mx * mx;
    const float cxy = f->xy[k] + (texels ? of[MOMENT_XY] : 0) - mx * my;
    const float cyy = f->yy[k] + (texels ? of[MOMENT_YY] : 0) - my * my;
    xx[k] = far ? cxx : xx[k] + b * (cxx - xx[k]) + mixed * dx * dx;
    xy[k] = far ? cxy : xy[k] + b * (cxy - xy[k]) + mixed * dx * dy;
    yy[k] = far ? cyy : yy[k] + b * (cyy - yy[k]) + mixed * dy * dy;
    x[k] = far ? mx : x[k] + b * dx;
    y[k] = far ? my : y[k] + b * dy;
  }
}

static SLOPE_APART void slope_blend(slope_lanes *restrict o, size_t first,
                                    const slope_filter *restrict f, int texels) {
  if (texels)
    slope_blend_in(o, first, f, 1);
  else
    slope_blend_in(o, first, f, 0);
}

/* What lanes [first, first + SLOPE_GROUP) find in the pyramid, blended with the points. */
static SLOPE_APART void slope_levels(const shade_slope_map *m, slope_lanes *restrict o,
                                     size_t first) {
  const moment_pyramid *p = &m->pyramid;
  const float w0 = 1 / (float)p->level[0].width, h0 = 1 / (float)p->level[0].height;
  const float *restrict blend = o->blend + first;
  int level[SLOPE_GROUP], used[SLOPE_GROUP], inside[SLOPE_GROUP], mixed = 0;
  slope_choice c;
  slope_filter f;
  slope_taps taps;
  int of_texels = 0;
  slope_choose(o, first, p->levels - 1, &c);
  slope_begin_sums(&f);
  for (int k = 0; k < SLOPE_GROUP; k++)
    mixed |= c.coarse[k];
  for (int coarse = 0; coarse <= mixed; coarse++) {
    int unlike = 0, texels = 0, cells = 0;
    for (int k = 0; k < SLOPE_GROUP; k++) {
      level[k] = c.level[k] + (coarse & c.coarse[k]);
      used[k] = -((blend[k] > 0) & (c.coarse[k] | (1 - coarse)));
    }
    for (int k = 0; k < SLOPE_GROUP; k++) {
      unlike |= level[k] ^ level[0];
      texels |= used[k] & -(level[k] != 0);
      cells |= used[k] & -(level[k] == 0);
    }
    const moment_level common = p->level[level[0]];
    const float middle = level[0] ? 0.5F : 1; /* cells begin in the middles of texels */
    /* pointers apart, or the rest is written in parts too, for which the next pass waits */
    for (int k = 0; k < SLOPE_GROUP; k++)
      f.texels[k] = common.texels;
#pragma omp simd
    for (int k = 0; k < SLOPE_GROUP; k++) {
      f.width[k] = common.width;
      f.height[k] = common.height;
      f.middle[k] = middle;
    }
    for (int k = 0; k < SLOPE_GROUP && unlike; k++) {
      f.texels[k] = p->level[level[k]].texels;
      f.width[k] = p->level[level[k]].width;
      f.height[k] = p->level[level[k]].height;
      f.middle[k] = level[k] ? 0.5F : 1;
    }
    slope_locate(o->u + first, o->v + first, &f);
    slope_shape(o, first, &c, coarse, used, w0, h0, &f);
    slope_inside(&f, inside);
    const int alike =
        !unlike && level[0] && f.most_cols - f.least_cols < 2 && f.most_rows - f.least_rows < 2;
    of_texels |= texels;
    const int wide = f.most_cols > SLOPE_COLS ? f.most_cols : SLOPE_COLS;
    const int chunk = wide < SLOPE_TAPS ? SLOPE_TAPS / wide : 1;
    for (int row = 0; row < f.most_rows; row += chunk) {
      const int rows = f.most_rows - row < chunk ? f.most_rows - row : chunk;
      slope_rows(&f, &taps, row, rows);
      if (texels && !(alike && slope_texels_alike(&f, &taps, inside, row, rows, p->wrap))) {
        slope_weights(&f, &taps, rows, f.most_cols, f.narrow);
        slope_texels(&f, &taps, inside, row, rows, p->wrap);
      }
      if (cells)
        slope_cells(m, &f, &taps, inside, row, rows);
    }
  }
  slope_blend(o, first, &f, of_texels);
}

/* `count`: SLOPE_BLOCK at most. */
static void kernel_slopes(const shade_slope_map *m, size_t count, const slope_block *b) {
  slope_lanes o;
  slope_places(m, count, b, &o);
  const size_t whole = (count + SLOPE_GROUP - 1) / SLOPE_GROUP * SLOPE_GROUP, last = count - 1;
  const int sides = b->side[0] != NULL;
  for (size_t i = count; i < whole; i++) { /* idle lanes do as the last one does */
    o.u[i] = o.u[last];
    o.v[i] = o.v[last];
  }
  for (size_t i = count; sides && i < whole; i++) {
    o.ax[i] = o.ax[last];
    o.ay[i] = o.ay[last];
    o.bx[i] = o.bx[last];
    o.by[i] = o.by[last];
    o.mxx[i] = o.mxx[last];
    o.mxy[i] = o.mxy[last];
    o.myy[i] = o.myy[last];
    o.longer2[i] = o.longer2[last];
    o.area[i] = o.area[last];
    o.blend[i] = o.blend[last];
  }
  if (!sides)
    slope_plain_lanes(m, &o, whole);
  for (size_t first = 0; sides && first < whole; first += SLOPE_GROUP) {
    const float *restrict blend = o.blend + first;
    int near = 0, far = 0;
#pragma omp simd reduction(| : near, far)
    for (int k = 0; k < SLOPE_GROUP; k++) {
      near |= blend[k] < 1;
      far |= blend[k] > 0;
    }
    if (near)
      slope_points(m, &o, first, 1);
    if (far)
      slope_levels(m, &o, first);
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
