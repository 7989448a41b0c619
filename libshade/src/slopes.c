/* SPDX-License-Identifier: Apache-2.0 */
/* Normal maps as fields of slopes, and what a covariance of slopes does to a lobe. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shade/maps.h"
#include "../model/mdf.h"
#include "src/moments.h"
#include "src/params.h"

#define PI 3.14159265358979323846
#define STEEPEST 50.0

struct shade_slope_map {
  int width, height;
  moment_wrap wrap;
  float *slopes; /* two a texel, row 0 the top */
  moment_pyramid pyramid;
};

/* Sides in texels up to which three points are enough; with two a texel, two are exact again. Sides
 * so little longer than a whole number of texels count as that. */
#define SLOPE_FEW 1.9
#define SLOPE_COUNT_SLACK 1e-4
/* Root of a footprint's area, or its longer side, in texels: up to the one it is sampled, from the
 * other on the pyramid answers. */
#define SLOPE_NEAR 1.85
#define SLOPE_FAR 1.99
#define SLOPE_LONG_NEAR 4.0
#define SLOPE_LONG_FAR 4.3
/* How far Gauss's two points are from the middles of an interval's halves, in halves: 1/sqrt 3 -
 * 1/2. */
#define SLOPE_GAUSS_SHIFT 0.07735026918962576

/* ---- texels to slopes ------------------------------------------------------------------ */

void shade_slope_options_init(shade_slope_options *o) {
  memset(o, 0, sizeof *o);
  o->size = sizeof *o;
  o->strength = 1;
}

static shade_slope_options within_ranges(const shade_slope_options *given, unsigned *status) {
  shade_slope_options o;
  shade_slope_options_init(&o);
  if (given && given->size >= sizeof given->size)
    memcpy(&o, given, given->size < sizeof o ? given->size : sizeof o);
  else if (given)
    *status |= SHADE_BAD_INPUT;
  if ((unsigned)o.normals > SHADE_NORMALS_SLOPE || (unsigned)o.wrap > SHADE_WRAP_MIRROR)
    *status |= SHADE_BAD_CHOICE;
  if ((unsigned)o.normals > SHADE_NORMALS_SLOPE)
    o.normals = SHADE_NORMALS_COLOUR;
  if ((unsigned)o.wrap > SHADE_WRAP_MIRROR)
    o.wrap = SHADE_WRAP_REPEAT;
  const double strength = isnan(o.strength) ? 1 : fmin(fmax(o.strength, 0), 100);
  if (!(strength == o.strength))
    *status |= SHADE_CLAMPED_PARAMETER;
  o.strength = strength;
  return o;
}

/* The slope of a normal given in any length, after the strength. 0 without a direction. */
static int slope_of_normal(double x, double y, double z, double strength, double slope[2],
                           unsigned *status) {
  const double length = sqrt(x * x + y * y + z * z);
  if (!(length > 1e-6))
    return 0;
  if (!(z > 1e-4 * length)) { /* flatter than the steepest slope, too: nothing is divided by 0 */
    *status |= SHADE_CLAMPED_NORMAL;
    z = 1e-4 * length;
  }
  const double up = 1 + fmin(strength, 1) * (z / length - 1);
  slope[0] = -strength * x / length / up;
  slope[1] = -strength * y / length / up;
  return 1;
}

static unsigned read_texel(const float *p, int channels, const shade_slope_options *o,
                           float slope[2]) {
  unsigned status = SHADE_OK;
  double x = (double)p[0], y = (double)p[1], z = channels > 2 ? (double)p[2] : 0;
  const int has_z = channels > 2 && o->normals != SHADE_NORMALS_SLOPE;
  double s[2] = {0, 0};
  slope[0] = slope[1] = 0;
  if (!isfinite(x) || !isfinite(y) || (has_z && !isfinite(z)))
    return SHADE_BAD_INPUT;
  if (o->normals == SHADE_NORMALS_COLOUR) {
    x = 2 * x - 1;
    y = 2 * y - 1;
    z = 2 * z - 1;
  }
  y = o->directx ? -y : y;
  if (o->normals == SHADE_NORMALS_SLOPE) {
    s[0] = o->strength * x;
    s[1] = o->strength * y;
  } else {
    if (!has_z)
      z = sqrt(fmax(1 - x * x - y * y, 0));
    if (!slope_of_normal(x, y, z, o->strength, s, &status))
      return SHADE_BAD_INPUT;
  }
  const double length = hypot(s[0], s[1]), cut = length > STEEPEST ? STEEPEST / length : 1;
  if (cut < 1)
    status |= SHADE_CLAMPED_NORMAL;
  slope[0] = (float)(cut * s[0]);
  slope[1] = (float)(cut * s[1]);
  return status;
}

/* ---- moments of the interpolated field ---------------------------------------------------- */

static const float *texel(const shade_slope_map *m, int i, int j) {
  const size_t row = (size_t)wrap_index(j, m->height, m->wrap);
  return m->slopes + 2 * (row * (size_t)m->width + (size_t)wrap_index(i, m->width, m->wrap));
}

/*
 * Means over each texel of row j. Between texel centres the field is bilinear, so its
 * square is of degree two each way: two Gauss points in either half are exact.
 */
static void texel_moments(const void *context, int j, float *to) {
  static const double at[4] = {-0.39433756729740643, -0.10566243270259357, 0.10566243270259357,
                               0.39433756729740643};
  const shade_slope_map *m = context;
  for (int i = 0; i < m->width; i++) {
    double column[3][4][2]; /* texels left, here, right at four places down */
    for (int k = 0; k < 3; k++) {
      const float *up = texel(m, i + k - 1, j - 1), *here = texel(m, i + k - 1, j),
                  *down = texel(m, i + k - 1, j + 1);
      for (int a = 0; a < 4; a++)
        for (int c = 0; c < 2; c++) {
          const double near = (double)here[c], far = (double)(at[a] < 0 ? up[c] : down[c]);
          column[k][a][c] = near + fabs(at[a]) * (far - near);
        }
    }
    double sum[MOMENTS] = {0};
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++) {
        const double *near = column[1][a], *far = column[at[b] < 0 ? 0 : 2][a], t = fabs(at[b]);
        shade_moments_add(sum, 1.0 / 16, 0, near[0] + t * (far[0] - near[0]),
                          near[1] + t * (far[1] - near[1]));
      }
    for (int c = 0; c < MOMENTS; c++)
      to[i * MOMENTS + c] = (float)sum[c];
  }
}

/* Means over the bilinear patch between the middles of four texels. */
static void cell_moments(const void *context, int i, int j, double to[MOMENTS]) {
  const shade_slope_map *m = context;
  const float *a = texel(m, i, j), *b = texel(m, i + 1, j), *c = texel(m, i, j + 1),
              *d = texel(m, i + 1, j + 1);
  double mean[2], across[2], down[2], twist[2];
  for (int k = 0; k < 2; k++) {
    const double p = (double)a[k], q = (double)b[k], r = (double)c[k], s = (double)d[k];
    mean[k] = (p + q + r + s) / 4;
    across[k] = (q - p + s - r) / 2;
    down[k] = (r - p + s - q) / 2;
    twist[k] = p - q - r + s;
  }
  memset(to, 0, MOMENTS * sizeof *to);
  shade_moments_add(to, 1, 0, mean[0], mean[1]);
  /* what is linear in one direction, and in both, has no mean, but a mean square */
  for (int k = 0; k < 3; k++) {
    const int x = k == 2, y = k != 0;
    to[MOMENT_XX + k] +=
        (across[x] * across[y] + down[x] * down[y]) / 12 + twist[x] * twist[y] / 144;
  }
}

/* ---- public --------------------------------------------------------------------------------- */

shade_slope_map *shade_slope_map_create(const float *pixels, int width, int height, int channels,
                                        const shade_slope_options *options, unsigned *status) {
  unsigned found = SHADE_OK, ignored;
  status = status ? status : &ignored;
  *status = SHADE_BAD_INPUT;
  if (!pixels || width < 1 || height < 1 || width > SHADE_SLOPE_MAX_SIDE ||
      height > SHADE_SLOPE_MAX_SIDE || channels < 2)
    return NULL;
  const shade_slope_options o = within_ranges(options, &found);
  const size_t count = (size_t)width * (size_t)height;
  shade_slope_map *m = calloc(1, sizeof *m);
  *status = found;
  if (!m)
    return NULL;
  m->width = width;
  m->height = height;
  m->wrap = (moment_wrap)o.wrap;
  m->slopes = malloc(2 * count * sizeof *m->slopes);
  for (size_t i = 0; m->slopes && i < count; i++)
    found |= read_texel(pixels + i * (size_t)channels, channels, &o, m->slopes + 2 * i);
  *status = found;
  if (!m->slopes || shade_moments_create(&m->pyramid, width, height, m->wrap, texel_moments,
                                         cell_moments, m) != 0) {
    shade_slope_map_free(m);
    return NULL;
  }
  return m;
}

void shade_slope_map_free(shade_slope_map *m) {
  if (!m)
    return;
  shade_moments_free(&m->pyramid);
  free(m->slopes);
  free(m);
}

/* Add the interpolated slope at (u, v). */
static void add_point(const shade_slope_map *m, double u, double v, double weight,
                      double moments[MOMENTS]) {
  const double x = u * m->width - 0.5, y = (1 - v) * m->height - 0.5;
  const double fx = floor(x), fy = floor(y), tx = x - fx, ty = y - fy;
  const int i = (int)fx, j = (int)fy;
  const float *a = texel(m, i, j), *b = texel(m, i + 1, j), *c = texel(m, i, j + 1),
              *d = texel(m, i + 1, j + 1);
  double s[2];
  for (int k = 0; k < 2; k++)
    s[k] = (1 - ty) * ((1 - tx) * (double)a[k] + tx * (double)b[k]) +
           ty * ((1 - tx) * (double)c[k] + tx * (double)d[k]);
  shade_moments_add(moments, weight, 0, s[0], s[1]);
}

/* Two points a texel, but few enough; three where that is enough, so that there is a covariance. */
static int steps(double texels) {
  const double most = 8, counted = texels - SLOPE_COUNT_SLACK;
  if (!(texels > 0))
    return 1;
  return counted > SLOPE_FEW ? 2 * (int)fmin(ceil(counted), most) : 3;
}

/*
 * By how much the points of a side so long leave the middles of their places, two by two: apart
 * (> 0) or towards each other. Two that share one of a texel's two straight pieces stand apart, as
 * Gauss has them for it. Two that share a texel stand closer: of two pieces in a row the ones of
 * the first and the ones of the second then are Gauss's for what lies between the texels' middles,
 * so that footprints side by side are exact together.
 */
static double apart(double texels, int n) {
  if (n <= 3)
    return 0;
  return SLOPE_GAUSS_SHIFT * fmin(fmax(3 - 2 * texels, -1), 1);
}

/* Point k of n along a side, -1/2 to 1/2. */
static double along(int k, int n, double shift) {
  return (k + 0.5 + (k % 2 ? shift : -shift)) / n - 0.5;
}

/* Its weight: of three, what makes them exact for two straight pieces that meet in the middle. */
static double weight_of(int k, int n) {
  return n != 3 ? 1.0 / n : k == 1 ? 0.25 : 0.375;
}

/* How far a look-up leaves points for the pyramid: once footprints are as large as its filter is
 * good for, and thin ones as others that use it. */
static double blend_of(const moment_pyramid *p, const double side[4]) {
  const double texels = (double)p->level[0].width * p->level[0].height;
  const double root = sqrt(fabs(side[0] * side[3] - side[1] * side[2]) * texels);
  const double round = (root - SLOPE_NEAR) / (SLOPE_FAR - SLOPE_NEAR);
  const double thin =
      (shade_moments_extent(p, side) - SLOPE_LONG_NEAR) / (SLOPE_LONG_FAR - SLOPE_LONG_NEAR);
  return fmin(fmax(fmax(round, thin), 0), 1);
}

/* Where a texture coordinate lies in the first copies of the picture. Clamped, one tile away is as
 * good as any for footprints that do not reach as far. */
static double place(double u, moment_wrap wrap, double longest) {
  const double away = longest < 0.5 ? 1 : 1e3;
  if (wrap == WRAP_REPEAT)
    return u - floor(u);
  return wrap == WRAP_MIRROR ? u - 2 * floor(u / 2) : fmin(fmax(u, -away), 1 + away);
}

unsigned shade_slope_lookup(const shade_slope_map *m, double u, double v, const double footprint[4],
                            shade_slopes *slopes) {
  double side[4] = {0}, moments[MOMENTS] = {0}, far[MOMENTS] = {0}, longest = 0;
  int finite = isfinite(u) && isfinite(v);
  for (int i = 0; i < 4 && footprint; i++) {
    finite = finite && isfinite(footprint[i]);
    side[i] = fmin(fmax(footprint[i], -1e3), 1e3);
    longest = fmax(longest, fabs(side[i]));
  }
  shade_moments_flat(slopes);
  if (!finite)
    return SHADE_BAD_INPUT;
  u = place(u, m->wrap, longest);
  v = place(v, m->wrap, longest);
  const double blend = blend_of(&m->pyramid, side);
  if (blend < 1) {
    const double texels1 = hypot(side[0] * m->width, side[1] * m->height);
    const double texels2 = hypot(side[2] * m->width, side[3] * m->height);
    const int n1 = steps(texels1), n2 = steps(texels2);
    for (int k = 0; k < n1 * n2; k++) {
      const double s = along(k / n2, n1, apart(texels1, n1));
      const double t = along(k % n2, n2, apart(texels2, n2));
      add_point(m, u + s * side[0] + t * side[2], v + s * side[1] + t * side[3],
                weight_of(k / n2, n1) * weight_of(k % n2, n2), moments);
    }
  }
  if (blend > 0) {
    shade_moments_lookup(&m->pyramid, u, v, side, far);
    for (int c = 0; c < MOMENTS; c++)
      moments[c] += blend * (far[c] - moments[c]);
  }
  shade_moments_slopes(moments, slopes);
  return SHADE_OK;
}

/* ---- widening ----------------------------------------------------------------------------- */

/*
 * Slopes about n in its own tangent plane, from slopes over the flat tangent plane: the
 * derivative of the one by the other at n, in the frame that carries the groove.
 */
static void carry(const double n[3], int groove_y, const double c[3], double out[3]) {
  const double x = n[0], y = n[1], z = n[2];
  double j[2][2]; /* rows: along the carried x and y */
  if (groove_y) {
    const double m = sqrt(y * y + z * z);
    j[0][0] = m * z;
    j[0][1] = -x * y * z / m;
    j[1][0] = 0;
    j[1][1] = z * z / m;
  } else {
    const double l = sqrt(x * x + z * z);
    j[0][0] = z * z / l;
    j[0][1] = 0;
    j[1][0] = -x * y * z / l;
    j[1][1] = l * z;
  }
  for (int k = 0; k < 3; k++) {
    const double *a = j[k == 2], *b = j[k != 0];
    out[k] = a[0] * b[0] * c[0] + (a[0] * b[1] + a[1] * b[0]) * c[1] + a[1] * b[1] * c[2];
  }
}

/* Nearest matrix without a negative direction. */
static unsigned mend(double c[3]) {
  for (int k = 0; k < 3; k++)
    if (!isfinite(c[k])) {
      c[0] = c[1] = c[2] = 0;
      return SHADE_BAD_INPUT;
    }
  /* no lobe tells more from this, and products of it stay finite */
  const double most = 1e12, size = fmax(fmax(fabs(c[0]), fabs(c[1])), fabs(c[2]));
  for (int k = 0; k < 3 && size > most; k++)
    c[k] = c[k] / size * most;
  const double mean = 0.5 * (c[0] + c[2]), gap = 0.5 * (c[0] - c[2]), root = hypot(gap, c[1]);
  const double low = mean - root, high = mean + root;
  if (low >= -1e-12 * fabs(high))
    return SHADE_OK;
  /* keep the larger direction, if that is not negative itself */
  const double keep = fmax(high, 0) / 2, along = root > 0 ? 1 / root : 0;
  c[0] = keep * (1 + gap * along);
  c[2] = keep * (1 - gap * along);
  c[1] = keep * c[1] * along;
  return SHADE_BAD_INPUT;
}

/*
 * The material with what is read here within its range. Bringing all into range takes as long as
 * widening does, so that only a material that needs it pays.
 */
static shade_params readable_params(const shade_params *given, unsigned *status) {
  const shade_params p = shade_whole_params(given);
  const double least = fmin(p.ax, p.ay), most = fmax(p.ax, p.ay);
  const int known = (unsigned)p.mdf < SHADE_MDF_COUNT;
  if (given && given->size >= sizeof given->size && known && p.ex >= 0 && p.ex <= 1e6 &&
      p.ey >= 0 && p.ey <= 1e6 && least >= 1e-4 && most <= 10 && p.ax == p.ax && p.ay == p.ay)
    return p;
  return shade_params_within_ranges(given, status);
}

/*
 * Squared widths along x and y, in the unit in which `unit` times a covariance of slopes adds,
 * and the axis of the grooves.
 */
typedef struct lobe_widths {
  double unit, x, y;
  int groove_y;
  double narrowed, blunted; /* of the distribution's traits */
} lobe_widths;

/*
 * Half as much without shadowing: what that BRDF makes of the lobe is as near as it gets then over
 * all lights, if not at the peak.
 */
static double narrowed(const shade_params *p) {
  const int shadowed = shade_brdf_with(p->mdf, p->brdf) == SHADE_BRDF_MICROFACET;
  return fmin(shade_mdf_is(p->mdf).narrowed, shadowed ? 1 : 0.5);
}

static lobe_widths widths_of(const shade_params *p) {
  const int exponents = shade_mdf_reads_exponents(p->mdf);
  const shade_mdf_traits mdf = shade_mdf_is(p->mdf);
  lobe_widths w;
  w.unit = exponents ? 1 : 2;
  w.x = exponents ? 1 / fmax(p->ex, 1e-12) : p->ax * p->ax;
  w.y = exponents ? 1 / fmax(p->ey, 1e-12) : p->ay * p->ay;
  w.groove_y = p->groove == SHADE_GROOVE_Y || (p->groove != SHADE_GROOVE_X && w.y < w.x);
  w.narrowed = narrowed(p);
  w.blunted = mdf.blunted;
  return w;
}

static unsigned unit_normal(const double n[3], double normal[3]) {
  normal[0] = normal[1] = 0;
  normal[2] = 1;
  if (!n)
    return SHADE_OK;
  const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!isfinite(length) || !(length > 0) || !(n[2] > 1e-4 * length))
    return SHADE_BAD_INPUT;
  for (int k = 0; k < 3; k++)
    normal[k] = n[k] / length;
  return SHADE_OK;
}

/*
 * Widen by a covariance that was carried.
 *
 * Squared widths A and slopes S of the same unit would add to A + S if lobes of tilted normals were
 * what they are shifted in the plane of slopes. They are not. At the mean normal a lobe of Beckmann
 * is a Gaussian of its slope s there times (1 + s^2)^2. The slopes that count there have the
 * variance P = A (A + S)^-1 S (parallel sum). So the mean of the lobes is higher than the one of
 * A + S by its trace (1 + tr P, in this unit), and A + S - A S - S A is as high. N S N with
 * N = 1/(1 + A) is that to the first order, never negative, and still right where A is not small.
 *
 * A slope widens a lobe of GGX most while S is small beside A: twice as much at the peak
 * (A + S + P), and 1.3 times as much where the whole lobe counts. Where S is large it is A + S
 * again. S + 0.4 P, with half of Beckmann's narrowing, stands between both errors. It was found by
 * quadrature over alphas of 0.02 to 0.5 and slopes of 0.02 to 0.35, as was which distributions need
 * none.
 */
static unsigned widen(shade_params *p, const lobe_widths *w, const double carried[3],
                      double *angle) {
  if (p->groove == SHADE_GROOVE_AUTO && (w->x < w->y || w->y < w->x))
    p->groove = w->groove_y ? SHADE_GROOVE_Y : SHADE_GROOVE_X;
  const double nx = 1 / (1 + w->narrowed * w->x), ny = 1 / (1 + w->narrowed * w->y);
  const double sxx = w->unit * nx * nx * carried[0], sxy = w->unit * nx * ny * carried[1],
               syy = w->unit * ny * ny * carried[2];
  /* P is (|A| S + |S| A) / |A + S| */
  const double own = w->x * w->y, slopes = fmax(sxx * syy - sxy * sxy, 0);
  const double share = w->blunted / (own + slopes + w->x * syy + w->y * sxx);
  const double of_own = 1 + share * slopes, of_slopes = 1 + share * own;
  const double xx = of_own * w->x + of_slopes * sxx;
  const double xy = of_slopes * sxy;
  const double yy = of_own * w->y + of_slopes * syy;

  /* the principal axis nearest to x becomes x */
  double turn = 0.5 * atan2(2 * xy, xx - yy);
  turn = turn > PI / 4 ? turn - PI / 2 : turn < -PI / 4 ? turn + PI / 2 : turn;
  const double cs = cos(turn), sn = sin(turn), cross = 2 * cs * sn * xy;
  const double vx = cs * cs * xx + cross + sn * sn * yy;
  const double vy = sn * sn * xx - cross + cs * cs * yy;
  *angle = turn;
  if (shade_mdf_reads_exponents(p->mdf))
    return shade_params_set_exponents(p, 1 / vx, 1 / vy);
  return shade_params_set_alphas(p, sqrt(vx), sqrt(vy));
}

static void give_params(const shade_params *p, const shade_params *given, shade_params *out) {
  memcpy(out, p, out == given && given->size < sizeof *p ? given->size : sizeof *p);
}

unsigned shade_params_widen(const shade_params *given, const double n[3],
                            const double covariance[3], shade_params *out, double *angle) {
  unsigned status = SHADE_OK;
  shade_params p = readable_params(given, &status);
  const lobe_widths w = widths_of(&p);
  double c[3] = {covariance[0], covariance[1], covariance[2]}, s[3], normal[3];
  status |= mend(c) | unit_normal(n, normal);
  carry(normal, w.groove_y, c, s);
  status |= widen(&p, &w, s, angle);
  give_params(&p, given, out);
  return status;
}

/* ---- splitting ---------------------------------------------------------------------------- */

enum { ROW = 4 };

/*
 * Up to four points, evenly apart, that stand for part of a variance along one axis; the lobe
 * widens by the rest.
 *
 * Even steps rather than those of Gauss and Hermite, which grow outwards: at equal numbers
 * they have half the error, since the outer lobes stay within reach of each other.
 */
typedef struct axis_points {
  int count;
  double place[ROW], weight[ROW]; /* in the lobe's deviations; weights sum to 1 */
  double taken;                   /* of the variance */
} axis_points;

/* lambda: the variance over the lobe's own. */
static axis_points points_of(int count, double lambda) {
  /* in deviations of the points themselves; weights give them variance 1 */
  static const double steps[ROW] = {0, 2, 1.45, 1.35};
  /* a hundredth of the lobe's own variance does not need them */
  const double negligible = 0.01;
  /* lobes this many of their deviations apart still melt into one */
  const double apart = 1.1;
  axis_points a;
  memset(&a, 0, sizeof a);
  a.count = lambda > negligible ? count : 1;
  a.weight[0] = 1;
  if (a.count == 1)
    return a;
  const double step = steps[a.count - 1];
  /* step^2 part lambda = apart^2 (1 + (1 - part) lambda) */
  const double part =
      fmin(1, apart * apart * (1 + lambda) / (lambda * (step * step + apart * apart)));
  double outer = 0.5; /* weight of the first and last */
  if (a.count == 3)
    outer = 0.5 / (step * step);
  if (a.count == 4)
    outer = (1 - step * step / 4) / (4 * step * step);
  for (int i = 0; i < a.count; i++) {
    a.place[i] = sqrt(part * lambda) * step * (i - 0.5 * (a.count - 1));
    a.weight[i] = i == 0 || i == a.count - 1 ? outer : (1 - 2 * outer) / (a.count - 2);
  }
  a.taken = part * lambda;
  return a;
}

/* The normal of a slope, not flatter than a map's steepest. */
static void normal_of(double x, double y, double n[3]) {
  const double slope = hypot(x, y), cut = slope > STEEPEST ? STEEPEST / slope : 1;
  const double length = hypot(1, cut * slope);
  n[0] = -cut * x / length;
  n[1] = -cut * y / length;
  n[2] = 1 / length;
}

unsigned shade_params_split(const shade_params *given, const double n[3],
                            const double covariance[3], int most, shade_params *out, double *angle,
                            shade_slope_lobes *lobes) {
  unsigned status = SHADE_OK;
  shade_params p = readable_params(given, &status);
  lobe_widths w = widths_of(&p);
  double c[3] = {covariance[0], covariance[1], covariance[2]}, normal[3];
  status |= mend(c) | unit_normal(n, normal);
  if (most < 1 || most > SHADE_SLOPE_LOBES)
    status |= SHADE_CLAMPED_PARAMETER;
  most = most < 1 ? 1 : most > SHADE_SLOPE_LOBES ? SHADE_SLOPE_LOBES : most;

  /* axes along which the slopes spread most beside the lobe: those of the covariance where
     the lobe's own is the unit */
  const double lx = sqrt(w.x / w.unit), ly = sqrt(w.y / w.unit);
  const double xx = c[0] / (lx * lx), xy = c[1] / (lx * ly), yy = c[2] / (ly * ly);
  const double mean = 0.5 * (xx + yy), gap = 0.5 * (xx - yy), root = hypot(gap, xy);
  const double turn = root > 0 ? 0.5 * atan2(xy, gap) : 0;
  const double first[2] = {lx * cos(turn), ly * sin(turn)};
  const double second[2] = {-lx * sin(turn), ly * cos(turn)};
  const int across = most >= 4 ? 2 : 1;
  const axis_points a = points_of(most / across, mean + root);
  const axis_points b = points_of(across, fmax(mean - root, 0));
  const double rest[3] = {c[0] - a.taken * first[0] * first[0] - b.taken * second[0] * second[0],
                          c[1] - a.taken * first[0] * first[1] - b.taken * second[0] * second[1],
                          c[2] - a.taken * first[1] * first[1] - b.taken * second[1] * second[1]};

  /* one lobe for all: by what is left of the covariance, carried to each normal, in the mean */
  double carried[3] = {0, 0, 0};
  memset(lobes, 0, sizeof *lobes);
  lobes->count = a.count * b.count;
  for (int i = 0; i < lobes->count; i++) {
    const int k = i % a.count, l = i / a.count;
    double m[3], s[3];
    normal_of(-normal[0] / normal[2] + a.place[k] * first[0] + b.place[l] * second[0],
              -normal[1] / normal[2] + a.place[k] * first[1] + b.place[l] * second[1], m);
    lobes->weight[i] = a.weight[k] * b.weight[l];
    carry(m, w.groove_y, rest, s);
    for (int j = 0; j < 3; j++)
      carried[j] += lobes->weight[i] * s[j];
    lobes->nx[i] = m[0];
    lobes->ny[i] = m[1];
    lobes->nz[i] = m[2];
  }
  if (lobes->count > 1) /* what spreads them is what blunts one */
    w.blunted = 0;
  status |= widen(&p, &w, carried, angle);
  const double cs = cos(*angle), sn = sin(*angle);
  for (int i = 0; i < lobes->count; i++) {
    const double x = lobes->nx[i], y = lobes->ny[i];
    lobes->nx[i] = cs * x + sn * y;
    lobes->ny[i] = cs * y - sn * x;
  }
  give_params(&p, given, out);
  return status;
}
