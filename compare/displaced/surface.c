/* SPDX-License-Identifier: Apache-2.0 */
#include "surface.h"

#include <stdint.h>

const char *const base_words[BASES] = {"plate", "cylinder", "sphere"};
const char *const bumps_words[BUMPS] = {"smooth", "waves", "scratches"};

static double uniform(uint64_t *state) { /* splitmix64 */
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

void surface_make(surface *s, base base, bumps bumps, double slope, unsigned seed) {
  uint64_t state = seed;
  *s = (surface){.base = base, .bumps = slope > 0 ? bumps : SMOOTH, .slope = slope};
  s->wave = 2 * PI * (base == PLATE ? 2 : 7);
  s->k = slope / sqrt(1 + slope * slope);
  for (int i = 0; i < PITS; i++) {
    pit *q = &s->pits[i];
    const double turn = PI * uniform(&state), wide = base == PLATE ? 1 : 0.7;
    q->x = uniform(&state);
    q->y = uniform(&state);
    q->cosine = cos(turn);
    q->sine = sin(turn);
    q->radius = wide * (0.02 + 0.03 * uniform(&state));
    q->stretch = 1.5 + 4.5 * uniform(&state);
  }
  if (s->bumps == WAVES) {
    s->top = slope / s->wave;
    s->bottom = -s->top;
  } else if (s->bumps == SCRATCHES) {
    s->bottom = -0.05 / s->k * (1 - sqrt(1 - s->k * s->k));
  }
  /* u's slope grows by R/(R + h) in a valley; a sphere's height falls off with the latitude */
  s->lipschitz = slope;
  if (base != PLATE)
    s->lipschitz = slope * RADIUS / (RADIUS + s->bottom) + (base == SPHERE ? s->top / RADIUS : 0);
}

static double waves(const surface *s, double u, double v, double *du, double *dv) {
  const double k = s->wave;
  *du = s->slope * cos(k * u) * sin(k * v);
  *dv = s->slope * sin(k * u) * cos(k * v);
  return s->slope / k * sin(k * u) * sin(k * v);
}

/* The deepest pit wins. */
static double scratches(const surface *s, double u, double v, double *du, double *dv) {
  const double k = s->k, rim = sqrt(1 - k * k);
  double lowest = 0;
  *du = *dv = 0;
  for (int i = 0; i < PITS; i++) {
    const pit *q = &s->pits[i];
    const double dx = u - q->x - floor(u - q->x + 0.5), dy = v - q->y - floor(v - q->y + 0.5);
    const double a = (q->cosine * dx + q->sine * dy) / (q->radius * q->stretch);
    const double b = (q->cosine * dy - q->sine * dx) / q->radius, rho2 = a * a + b * b;
    if (rho2 >= 1)
      continue;
    const double root = sqrt(1 - k * k * rho2), height = -q->radius / k * (root - rim);
    if (height < lowest) {
      lowest = height;
      *du = k / root * (a / q->stretch * q->cosine - b * q->sine);
      *dv = k / root * (a / q->stretch * q->sine + b * q->cosine);
    }
  }
  return lowest;
}

/* Height and its derivatives by u and v. */
static double height(const surface *s, double u, double v, double *du, double *dv) {
  double h = 0;
  *du = *dv = 0;
  if (s->bumps == WAVES)
    h = waves(s, u, v, du, dv);
  else if (s->bumps == SCRATCHES)
    h = scratches(s, u, v, du, dv);
  if (s->base == SPHERE) { /* flat at the poles, where u runs together */
    const double c = cos(v / RADIUS);
    *du *= c;
    *dv = c * *dv - sin(v / RADIUS) / RADIUS * h;
    h *= c;
  }
  return h;
}

void surface_at(const surface *s, double u, double v, place *at) {
  double hu, hv;
  const double h = height(s, u, v, &hu, &hv), a = u / RADIUS, b = v / RADIUS;
  at->u = u;
  at->v = v;
  if (s->base == PLATE) {
    at->x = (vec){1, 0, 0};
    at->y = (vec){0, 1, 0};
    at->z = (vec){0, 0, 1};
    at->p = (vec){u, v, h};
    at->du = (vec){1, 0, hu};
    at->dv = (vec){0, 1, hv};
  } else if (s->base == CYLINDER) {
    const double scale = (RADIUS + h) / RADIUS;
    at->x = (vec){cos(a), 0, -sin(a)};
    at->y = (vec){0, 1, 0};
    at->z = (vec){sin(a), 0, cos(a)};
    at->p = add((vec){0, v, 0}, RADIUS + h, at->z);
    at->du = add(add((vec){0, 0, 0}, scale, at->x), hu, at->z);
    at->dv = add(at->y, hv, at->z);
  } else {
    const double scale = (RADIUS + h) / RADIUS;
    at->x = (vec){cos(a), 0, -sin(a)};
    at->y = (vec){-sin(b) * sin(a), cos(b), -sin(b) * cos(a)};
    at->z = (vec){cos(b) * sin(a), sin(b), cos(b) * cos(a)};
    at->p = add((vec){0, 0, 0}, RADIUS + h, at->z);
    at->du = add(add((vec){0, 0, 0}, scale * cos(b), at->x), hu, at->z);
    at->dv = add(add((vec){0, 0, 0}, scale, at->y), hv, at->z);
  }
  at->n = unit(cross(at->du, at->dv));
}

void surface_under(const surface *s, vec p, double *u, double *v) {
  *u = s->base == PLATE ? p.x : RADIUS * atan2(p.x, p.z);
  *v = s->base == SPHERE ? RADIUS * asin(fmax(-1, fmin(1, p.y / sqrt(dot(p, p))))) : p.y;
}

/* How far a point is above the surface, along the base's normal. */
static double gap(const surface *s, vec p) {
  double u, v, du, dv, out = p.z;
  surface_under(s, p, &u, &v);
  if (s->base == CYLINDER)
    out = hypot(p.x, p.z) - RADIUS;
  else if (s->base == SPHERE)
    out = sqrt(dot(p, p)) - RADIUS;
  if (out > s->top + 0.01)
    return out - s->top; /* what lies between is air */
  return out - height(s, u, v, &du, &dv);
}

/*
 * A step is what the gap allows at the steepest slope, but at least `least`, a fiftieth of a bump:
 * what that may skip is a ray that dips less than 1e-4 under a crest.
 */
double surface_cast(const surface *s, vec from, vec along) {
  const double least = 0.001, far = 3, closing = sqrt(1 + s->lipschitz * s->lipschitz);
  double before = 0;
  for (double t = 0; t < far;) {
    const double g = gap(s, add(from, t, along));
    if (g < 0) {
      for (int i = 0; i < 40; i++) {
        const double middle = 0.5 * (before + t);
        if (gap(s, add(from, middle, along)) < 0)
          t = middle;
        else
          before = middle;
      }
      return before;
    }
    if (s->base == PLATE && from.z + t * along.z > s->top && along.z > 0)
      return -1;
    before = t;
    t += fmax(g / closing, least);
  }
  return -1;
}

int surface_base_seen(const surface *s, double x, double y, double *u, double *v) {
  const double left = RADIUS * RADIUS - x * x - (s->base == SPHERE ? y * y : 0);
  if (s->base != PLATE && left <= 0)
    return 0;
  surface_under(s, (vec){x, y, s->base == PLATE ? 0 : sqrt(left)}, u, v);
  return 1;
}

void surface_window(const surface *s, double *half, double *x, double *y) {
  *half = s->base == PLATE ? 0.5 : 1.16 * RADIUS;
  *x = *y = s->base == PLATE ? 0.5 : 0;
}
