/* SPDX-License-Identifier: Apache-2.0 */
/* Normal maps as fields of slopes, and what a covariance of slopes does to a lobe. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shade/maps.h"
#include "src/moments.h"

#define PI 3.14159265358979323846
#define STEEPEST 50.0

struct shade_slope_map {
  int width, height;
  moment_wrap wrap;
  float *slopes; /* two a texel, row 0 the top */
  moment_pyramid pyramid;
};

/* ---- texels to slopes ------------------------------------------------------------------ */

void shade_slope_options_init(shade_slope_options *o) {
  memset(o, 0, sizeof *o);
  o->size = sizeof *o;
  o->strength = 1;
}

static shade_slope_options within_ranges(const shade_slope_options *given, unsigned *status) {
  shade_slope_options o;
  shade_slope_options_init(&o);
  if (given)
    memcpy(&o, given, given->size < sizeof o ? given->size : sizeof o);
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
  if (z <= 0) {
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
        moments_add(sum, 1.0 / 16, 0, near[0] + t * (far[0] - near[0]),
                    near[1] + t * (far[1] - near[1]));
      }
    for (int c = 0; c < MOMENTS; c++)
      to[i * MOMENTS + c] = (float)sum[c];
  }
}

/* ---- public --------------------------------------------------------------------------------- */

shade_slope_map *shade_slope_map_create(const float *pixels, int width, int height, int channels,
                                        const shade_slope_options *options, unsigned *status) {
  unsigned found = SHADE_OK, ignored;
  status = status ? status : &ignored;
  *status = SHADE_BAD_INPUT;
  if (width < 1 || height < 1 || width > SHADE_SLOPE_MAX_SIDE || height > SHADE_SLOPE_MAX_SIDE ||
      channels < 2)
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
  if (!m->slopes || moments_create(&m->pyramid, width, height, 2, m->wrap, texel_moments, m) != 0) {
    shade_slope_map_free(m);
    return NULL;
  }
  return m;
}

void shade_slope_map_free(shade_slope_map *m) {
  if (!m)
    return;
  moments_free(&m->pyramid);
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
  moments_add(moments, weight, 0, s[0], s[1]);
}

/* Two points a texel, but few enough and at least four, so that there is a covariance. */
static int steps(double texels) {
  const double least = 2, most = 8;
  return texels > 0 ? 2 * (int)fmin(fmax(ceil(texels), least), most) : 1;
}

/* Point k of n along a side, -1/2 to 1/2. Two by two they are Gauss's for the square of a
 * linear piece: exact where the footprint's sides lie on the texels' edges. */
static double along(int k, int n) {
  const double shift = n == 1 ? 0 : 0.07735026918962576; /* 1/sqrt 3 - 1/2 */
  return (k + 0.5 + (k % 2 ? -shift : shift)) / n - 0.5;
}

/* Where a texture coordinate lies in the first copies of the picture. */
static double place(double u, moment_wrap wrap) {
  if (wrap == WRAP_REPEAT)
    return u - floor(u);
  return wrap == WRAP_MIRROR ? u - 2 * floor(u / 2) : fmin(fmax(u, -1e3), 1e3);
}

unsigned shade_slope_lookup(const shade_slope_map *m, double u, double v, const double footprint[4],
                            shade_slopes *slopes) {
  double side[4] = {0}, moments[MOMENTS] = {0}, far[MOMENTS] = {0};
  int finite = isfinite(u) && isfinite(v);
  for (int i = 0; i < 4 && footprint; i++) {
    finite = finite && isfinite(footprint[i]);
    side[i] = fmin(fmax(footprint[i], -1e3), 1e3);
  }
  moments_flat(slopes);
  if (!finite)
    return SHADE_BAD_INPUT;
  u = place(u, m->wrap);
  v = place(v, m->wrap);
  const double blend = moments_blend(moments_extent(&m->pyramid, side));
  if (blend < 1) {
    const int n1 = steps(hypot(side[0] * m->width, side[1] * m->height));
    const int n2 = steps(hypot(side[2] * m->width, side[3] * m->height));
    for (int k = 0; k < n1 * n2; k++) {
      const double s = along(k / n2, n1), t = along(k % n2, n2);
      add_point(m, u + s * side[0] + t * side[2], v + s * side[1] + t * side[3], 1.0 / (n1 * n2),
                moments);
    }
  }
  if (blend > 0) {
    moments_lookup(&m->pyramid, u, v, side, far);
    for (int c = 0; c < MOMENTS; c++)
      moments[c] += blend * (far[c] - moments[c]);
  }
  moments_slopes(moments, slopes);
  return SHADE_OK;
}

/* ---- widening -----------------------------------------------------------------------------------
 */

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

unsigned shade_params_widen(const shade_params *given, const double n[3],
                            const double covariance[3], shade_params *out, double *angle) {
  shade_params p;
  shade_params_init(&p);
  memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  p.size = sizeof p;
  const int exponents = p.mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY;
  double c[3] = {covariance[0], covariance[1], covariance[2]}, s[3];
  unsigned status = mend(c);

  /* squared widths along x and y, in the unit in which `unit` times the covariance adds */
  const double unit = exponents ? 1 : 2;
  const double wx = exponents ? 1 / fmax(p.ex, 1e-12) : p.ax * p.ax;
  const double wy = exponents ? 1 / fmax(p.ey, 1e-12) : p.ay * p.ay;
  const int groove_y = p.groove == SHADE_GROOVE_Y || (p.groove != SHADE_GROOVE_X && (wy < wx));
  if (p.groove == SHADE_GROOVE_AUTO && (wx < wy || wy < wx))
    p.groove = groove_y ? SHADE_GROOVE_Y : SHADE_GROOVE_X;

  double normal[3] = {0, 0, 1};
  if (n) {
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (isfinite(length) && length > 0 && n[2] > 1e-4 * length)
      for (int k = 0; k < 3; k++)
        normal[k] = n[k] / length;
    else
      status |= SHADE_BAD_INPUT;
  }
  carry(normal, groove_y, c, s);
  s[0] = wx + unit * s[0];
  s[1] = unit * s[1];
  s[2] = wy + unit * s[2];

  /* the principal axis nearest to x becomes x */
  double turn = 0.5 * atan2(2 * s[1], s[0] - s[2]);
  turn = turn > PI / 4 ? turn - PI / 2 : turn < -PI / 4 ? turn + PI / 2 : turn;
  const double cs = cos(turn), sn = sin(turn), cross = 2 * cs * sn * s[1];
  const double vx = cs * cs * s[0] + cross + sn * sn * s[2];
  const double vy = sn * sn * s[0] - cross + cs * cs * s[2];
  if (exponents)
    status |= shade_params_set_exponents(&p, 1 / vx, 1 / vy);
  else
    status |= shade_params_set_alphas(&p, sqrt(vx), sqrt(vy));
  *angle = turn;
  memcpy(out, &p, out == given && given->size < sizeof p ? given->size : sizeof p);
  return status;
}
