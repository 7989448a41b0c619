/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Choices of horizon against a surface that is really displaced; horizon.py runs this.
 *
 * A periodic height field over the unit square, and the same bumps as normals on a flat one.
 * The truth is ray-cast: the eye's ray through each point of the square finds the surface, a
 * ray to the light finds whether it is lit, and the BRDF is that of the facet found. Light
 * reflected once counts; what a second reflection adds to the mean is estimated beside it.
 * Slopes, heights and normals come from one formula, so nothing but the choice differs.
 */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dump/whole.h"
#include "shade/shade.h"

#define PI 3.14159265358979323846

typedef struct vec {
  double x, y, z;
} vec;

static vec add(vec a, double s, vec b) {
  return (vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static double dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static vec unit(vec a) {
  return add((vec){0, 0, 0}, 1 / sqrt(dot(a, a)), a);
}
static vec at_angles(double elevation, double azimuth) {
  double e = elevation * PI / 180, a = azimuth * PI / 180;
  return (vec){cos(e) * cos(a), cos(e) * sin(a), sin(e)};
}

static uint64_t random_state = 1;
static double uniform(void) { /* splitmix64 */
  uint64_t z = (random_state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* ---- height fields: sums of waves with whole frequencies ------------------------------- */

enum { WAVES = 12 };
typedef struct field {
  const char *name;
  int waves;
  double kx[WAVES], ky[WAVES], phase[WAVES], height[WAVES];
  double top, steepest; /* bounds of |height| and |slope| */
} field;

static void bound(field *f) {
  f->top = f->steepest = 0;
  for (int i = 0; i < f->waves; i++) {
    f->top += f->height[i];
    f->steepest += f->height[i] * hypot(f->kx[i], f->ky[i]);
  }
}

/* plate.py's bumps: slope/k sin(k u) sin(k v), as the two waves of which it is the difference. */
static field sinusoid(double slope) {
  const double k = 4 * PI, half = slope / k / 2;
  field f = {"sinusoid", 2, {k, k}, {-k, k}, {PI / 2, -PI / 2}, {half, half}, 0, 0};
  bound(&f);
  return f;
}

/* Waves of 2 to 5 periods in random directions, each with the same share of the mean square slope.
 */
static field band_limited(double rms_slope) {
  field f = {.name = "random", .waves = WAVES};
  for (int i = 0; i < WAVES;) {
    double a = floor(11 * uniform()) - 5, b = floor(11 * uniform()) - 5, size = hypot(a, b);
    if (size < 2 || size > 5)
      continue;
    f.kx[i] = 2 * PI * a;
    f.ky[i] = 2 * PI * b;
    f.phase[i] = 2 * PI * uniform();
    f.height[i++] = rms_slope * sqrt(2. / WAVES) / (2 * PI * size);
  }
  bound(&f);
  return f;
}

static double height(const field *f, double u, double v) {
  double h = 0;
  for (int i = 0; i < f->waves; i++)
    h += f->height[i] * sin(f->kx[i] * u + f->ky[i] * v + f->phase[i]);
  return h;
}

static vec normal(const field *f, double u, double v) {
  vec n = {0, 0, 1};
  for (int i = 0; i < f->waves; i++) {
    double slope = f->height[i] * cos(f->kx[i] * u + f->ky[i] * v + f->phase[i]);
    n.x -= slope * f->kx[i];
    n.y -= slope * f->ky[i];
  }
  return unit(n);
}

/*
 * The first point of the field along a ray from above it, as a distance, or -1. A step is what
 * the gap allows at the steepest slope, but at least `least`: bumps are 1/5 wide or wider, so
 * what that may skip is a ray that dips less than 1e-4 under a crest.
 */
static double cast(const field *f, vec from, vec along) {
  const double least = 0.004;
  const double closing = f->steepest * hypot(along.x, along.y) - along.z;
  double t = 0, before = 0;
  if (along.z < 0 && from.z > f->top) /* to where the field may begin */
    before = t = (from.z - f->top) / -along.z;
  while (from.z + t * along.z <= f->top || along.z < 0) {
    vec p = add(from, t, along);
    double gap = p.z - height(f, p.x, p.y);
    if (gap < 0) {
      for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (before + t);
        vec q = add(from, middle, along);
        if (q.z < height(f, q.x, q.y))
          t = middle;
        else
          before = middle;
      }
      return before;
    }
    before = t;
    double step = closing > 0 ? gap / closing : 1;
    t += step > least ? step : least;
  }
  return -1;
}

/* Whether light reaches p, on the field with normal n. */
static int lit(const field *f, vec p, vec n, vec wi) {
  return dot(n, wi) > 0 && cast(f, add(p, 1e-6, n), wi) < 0;
}

/* ---- materials ----------------------------------------------------------------------- */

enum { MATERIALS = 3, CHOICES = SHADE_HORIZON_MUTUAL }; /* those of the normal alone */
static const char *const material_words[MATERIALS] = {"ashikhmin_shirley", "ggx", "lambert"};

static shade_bsdf material(int which, int horizon) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, 200, 10);
  p.detail = SHADE_DETAIL_ROTATE;
  p.fresnel = SHADE_FRESNEL_NONE;
  p.horizon = (shade_horizon)horizon;
  if (which == 1) {
    p.mdf = SHADE_MDF_GGX;
    p.brdf = SHADE_BRDF_MICROFACET;
  }
  if (which == 2)
    for (int c = 0; c < 3; c++) {
      p.f0[c] = 0;
      p.kd[c] = 1;
    }
  shade_bsdf b;
  shade_bsdf_setup(&b, &p);
  return b;
}

/* A direction from the facet's lobe (for Lambert, from the cosine): f cos / its density. */
static vec sample(int which, const shade_bsdf *b, vec n, vec wo, double *weight) {
  const double ex = 200, ey = 10, ax = sqrt(2. / 202), ay = sqrt(2. / 12);
  double u = uniform(), turn = 2 * PI * uniform(), density;
  vec x = unit((vec){n.z, 0, -n.x}), y = cross(n, x), local, w;
  if (which == 2) {
    local = (vec){sqrt(u) * cos(turn), sqrt(u) * sin(turn), sqrt(1 - u)};
    density = local.z / PI;
  } else if (which == 1) {
    double r = sqrt(u / (1 - u)), sx = ax * r * cos(turn), sy = ay * r * sin(turn);
    local = unit((vec){sx, sy, 1});
    density = local.z / (PI * ax * ay * pow(1 + r * r, 2) * pow(local.z, 4));
  } else {
    double c = cos(turn) / sqrt(ex + 1), s = sin(turn) / sqrt(ey + 1), size = hypot(c, s);
    double e = (ex * c * c + ey * s * s) / (size * size), z = pow(1 - u, 1 / (e + 1));
    double side = sqrt(1 - z * z) / size;
    local = (vec){c * side, s * side, z};
    density = sqrt((ex + 1) * (ey + 1)) / (2 * PI) * pow(z, e);
  }
  vec h = add(add(add((vec){0, 0, 0}, local.x, x), local.y, y), local.z, n);
  if (which == 2) {
    w = h;
  } else {
    double hwo = dot(h, wo);
    w = add(add((vec){0, 0, 0}, -1, wo), 2 * hwo, h);
    density /= 4 * hwo;
    if (hwo <= 0)
      density = 0;
  }
  /* The library's f, of the facet, knows a horizon of z, which facets do not: w and wo in the
     facet's own frame, where both are the same. */
  double f[3] = {0}, cosine = 0;
  const double up[3] = {0, 0, 1};
  const double i[3] = {dot(x, w), dot(y, w), dot(n, w)},
               o[3] = {dot(x, wo), dot(y, wo), dot(n, wo)};
  if (density > 0)
    shade_bsdf_eval(b, up, i, o, f, &cosine);
  *weight = density > 0 ? f[0] * cosine / density : 0;
  return w;
}

/* f cos of a facet, likewise. */
static double facet(const shade_bsdf *b, vec n, vec wi, vec wo) {
  vec x = unit((vec){n.z, 0, -n.x}), y = cross(n, x);
  const double up[3] = {0, 0, 1};
  const double i[3] = {dot(x, wi), dot(y, wi), dot(n, wi)};
  const double o[3] = {dot(x, wo), dot(y, wo), dot(n, wo)};
  double f[3], cosine;
  shade_bsdf_eval(b, up, i, o, f, &cosine);
  return f[0] * cosine;
}

/* ---- the experiment -------------------------------------------------------------------- */

typedef struct point {
  vec flat_n; /* of the base at this pixel */
  vec p, n;   /* what the eye sees of the field */
} point;

typedef struct second {
  vec p, n, back;
  double weight; /* 0: it does not */
} second;

static double shaded(const shade_bsdf *b, vec n, vec wi, vec wo) {
  const double m[3] = {n.x, n.y, n.z}, i[3] = {wi.x, wi.y, wi.z}, o[3] = {wo.x, wo.y, wo.z};
  double f[3], cosine;
  shade_bsdf_eval(b, m, i, o, f, &cosine);
  return f[0] * cosine;
}

/* A whole number from 1 to `most`, or 0. */
static long whole(const char *text, long most) {
  char *end;
  long value = strtol(text, &end, 10);
  return end != text && !*end && value >= 1 && value <= most ? value : 0;
}

int main(int argc, char **argv) {
  static const double elevations[] = {80, 60, 40, 20, 10, 5};
  enum { ELEVATIONS = sizeof elevations / sizeof elevations[0], MOST = 512 };
  long size = argc > 2 ? whole(argv[2], MOST) : 64, turns = argc > 3 ? whole(argv[3], 360) : 5;
  const int asked = argc == 2 && strcmp(argv[1], "--help") == 0;
  if (argc < 2 || argc > 4 || argv[1][0] == '-' || !size || !turns) {
    fprintf(asked ? stdout : stderr,
            "usage: horizon OUTPUT.csv [POINTS [AZIMUTHS]]\n\n"
            "  POINTS    along a side of the field, 1 to %d (default 64)\n"
            "  AZIMUTHS  of light and eye, 1 to 360 (default 5)\n",
            MOST);
    return asked ? 0 : 2;
  }
  /* the table grows in memory: what is stopped half way leaves nothing */
  char why[256], *text = NULL;
  size_t length = 0;
  if (shade_whole_write(argv[1], NULL, 0, why, sizeof why) != 0) {
    fprintf(stderr, "horizon: %s: %s\n", argv[1], why);
    return 1;
  }
  FILE *out = open_memstream(&text, &length);
  size_t count = (size_t)(size * size);
  point *points = malloc(count * sizeof *points);
  second *seconds[MATERIALS];
  char *light = malloc(count), *light2 = malloc(count * MATERIALS);
  int enough = out && points && light && light2;
  for (int m = 0; m < MATERIALS; m++)
    enough &= (seconds[m] = malloc(count * sizeof *seconds[m])) != NULL;
  if (!enough) {
    fputs("horizon: out of memory\n", stderr);
    return 1;
  }
  shade_bsdf bsdf[MATERIALS][CHOICES];
  for (int m = 0; m < MATERIALS; m++)
    for (int k = 0; k < CHOICES; k++)
      bsdf[m][k] = material(m, k);
  const field fields[] = {sinusoid(0.6), band_limited(0.6 / sqrt(2))};

  fputs("field,material,horizon,light,light_azimuth,view,view_azimuth,truth,truth_twice,mean,"
        "image,shading\n",
        out);
  const long views = ELEVATIONS * turns;
  for (int which = 0; which < 2; which++)
    for (long view = 0; view < views; view++) {
      const field *f = &fields[which];
      const double elevation = elevations[view / turns];
      const double azimuth = 360. * ((double)(view % turns) + 0.3) / (double)turns;
      const vec wo = at_angles(elevation, azimuth);
      printf("%ld %%\n", 100 * (which * views + view) / (2 * views));
      fflush(stdout);
      for (size_t i = 0; i < count; i++) {
        point *q = &points[i];
        double u = ((double)(i % (size_t)size) + uniform()) / (double)size;
        double v = ((double)(i / (size_t)size) + uniform()) / (double)size;
        vec above = add((vec){u, v, 0}, 1.001 * f->top / wo.z, wo);
        vec down = add((vec){0, 0, 0}, -1, wo);
        q->flat_n = normal(f, u, v);
        q->p = add(above, cast(f, above, down), down);
        q->n = normal(f, q->p.x, q->p.y);
        for (int m = 0; m < MATERIALS; m++) {
          second *s = &seconds[m][i];
          vec w = sample(m, &bsdf[m][0], q->n, wo, &s->weight);
          vec start = add(q->p, 1e-6, q->n);
          double t = s->weight > 0 ? cast(f, start, w) : -1;
          if (t < 0)
            s->weight = 0;
          s->p = add(start, t, w);
          s->n = normal(f, s->p.x, s->p.y);
          s->back = add((vec){0, 0, 0}, -1, w);
        }
      }
      for (long k = 0; k < views; k++) {
        const double sun = elevations[k / turns];
        const double sun_azimuth = 360. * ((double)(k % turns) + 0.3) / (double)turns;
        const vec wi = at_angles(sun, sun_azimuth);
        for (size_t i = 0; i < count; i++) {
          light[i] = (char)lit(f, points[i].p, points[i].n, wi);
          for (int m = 0; m < MATERIALS; m++)
            light2[i * MATERIALS + (size_t)m] =
                seconds[m][i].weight > 0 && lit(f, seconds[m][i].p, seconds[m][i].n, wi);
        }
        for (int m = 0; m < MATERIALS; m++) {
          double truth = 0, more = 0, mean[CHOICES] = {0};
          double image[CHOICES] = {0}, shading[CHOICES] = {0};
          for (size_t i = 0; i < count; i++) {
            const point *q = &points[i];
            const second *s = &seconds[m][i];
            double here = light[i] ? facet(&bsdf[m][0], q->n, wi, wo) : 0;
            truth += here;
            if (light2[i * MATERIALS + (size_t)m])
              more += s->weight * facet(&bsdf[m][0], s->n, wi, s->back);
            for (int h = 0; h < CHOICES; h++) {
              double flat = shaded(&bsdf[m][h], q->flat_n, wi, wo);
              mean[h] += flat;
              image[h] += fabs(flat - here);
              shading[h] += fabs(shaded(&bsdf[m][h], q->n, wi, wo) - here);
            }
          }
          for (int h = 0; h < CHOICES; h++)
            fprintf(out, "%s,%s,%s,%g,%g,%g,%g,%.6g,%.6g,%.6g,%.6g,%.6g\n", f->name,
                    material_words[m], shade_list_word(SHADE_LIST_HORIZON, h), sun, sun_azimuth,
                    elevation, azimuth, truth / (double)count, (truth + more) / (double)count,
                    mean[h] / (double)count, image[h] / (double)count, shading[h] / (double)count);
        }
      }
    }
  for (int m = 0; m < MATERIALS; m++)
    free(seconds[m]);
  free(light2);
  free(light);
  free(points);
  snprintf(why, sizeof why, "out of memory");
  const int failed = ferror(out) != 0;
  const int filled = fclose(out) == 0 && !failed;
  const int status = filled ? shade_whole_write(argv[1], text, length, why, sizeof why) : -1;
  if (status != 0)
    fprintf(stderr, "horizon: %s: %s\n", argv[1], why);
  free(text);
  return status != 0;
}
