/* SPDX-License-Identifier: Apache-2.0 */
/* shade check: the hits of a dump, their frames and what is wrong with them. */
#include "tool/check.h"

#include <math.h>
#include <string.h>

#include "reference/reference.h"

/* Directions of the dump are unit to float rounding; more is an error of the back end. */
#define UNIT_TOLERANCE 1e-4

void check_note_fault(check *c, check_fault what, size_t pixel) {
  if (c->faults[what]++ == 0)
    c->first_fault[what] = pixel;
}

/* Three planes from `first` on. */
void check_read_three(const check *c, const float *first, size_t pixel, double v[3]) {
  for (size_t i = 0; i < 3; i++)
    v[i] = (double)first[i * c->pixels + pixel];
}

int check_finite_three(const double v[3]) {
  return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

double check_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise(double v[3]) {
  const double length = sqrt(check_dot(v, v));
  for (int i = 0; i < 3; i++)
    v[i] /= length;
}

/* Reads a direction and makes it unit in double; 0 if it was not nearly so. */
int check_read_unit(const check *c, const float *first, size_t pixel, double v[3]) {
  check_read_three(c, first, pixel, v);
  if (!(fabs(sqrt(check_dot(v, v)) - 1) < UNIT_TOLERANCE)) /* NaN fails too */
    return 0;
  normalise(v);
  return 1;
}

void check_to_local(const check_frame *f, const double v[3], double local[3]) {
  for (int i = 0; i < 3; i++)
    local[i] = check_dot(f->axis[i], v);
}

/* A channel of this hit in place of what the material has, if it is in the file. 0: not finite. */
static int replace(const check *c, enum shade_dump_optional channel, size_t pixel, int planes,
                   double *numbers) {
  if (!shade_dump_has(c->dump, channel))
    return 1;
  const float *plane = shade_dump_plane(c->dump, (int)channel);
  for (size_t i = 0; i < (size_t)planes; i++) {
    numbers[i] = (double)plane[i * c->pixels + pixel];
    if (!isfinite(numbers[i]))
      return 0;
  }
  return 1;
}

void check_set_alphas(shade_params *p, const double alpha[2]) {
  p->ax = alpha[0];
  p->ay = alpha[1];
  p->ex = fmax(0, 2 / (alpha[0] * alpha[0]) - 2);
  p->ey = fmax(0, 2 / (alpha[1] * alpha[1]) - 2);
}

/* What a hit has of its own. The grooves' angle turns the frame, and with it n and wo. */
static int read_varied(const check *c, size_t pixel, check_hit *h) {
  shade_params *p = &h->params;
  double alpha[2] = {1, 1}, angle = 0;
  if (!replace(c, SHADE_DUMP_F82, pixel, 3, p->f82) ||
      !replace(c, SHADE_DUMP_ETA, pixel, 3, p->eta) || !replace(c, SHADE_DUMP_K, pixel, 3, p->k) ||
      !replace(c, SHADE_DUMP_KD, pixel, 3, p->kd) ||
      !replace(c, SHADE_DUMP_ALPHA, pixel, 2, alpha) ||
      !replace(c, SHADE_DUMP_SLOPES, pixel, 5, p->slopes) ||
      !replace(c, SHADE_DUMP_GROOVE, pixel, 1, &angle))
    return 0;
  if (shade_dump_has(c->dump, SHADE_DUMP_ALPHA))
    check_set_alphas(p, alpha);
  if (shade_dump_has(c->dump, SHADE_DUMP_GROOVE)) {
    double *x = h->frame.axis[0], *y = h->frame.axis[1];
    for (int i = 0; i < 3; i++) {
      const double along = x[i], across = y[i];
      x[i] = cos(angle) * along + sin(angle) * across;
      y[i] = cos(angle) * across - sin(angle) * along;
    }
    shade_ref_turned(angle, h->n, h->n);
    shade_ref_turned(angle, h->wo, h->wo);
    shade_ref_turned_slopes(angle, p->slopes, p->slopes);
  }
  return 1;
}

/* The lobes besides the first, to be asked before read_varied turns the frame. 0: with a fault
 * noted, they are not what may be. */
static int read_lobes(check *c, size_t pixel, check_hit *h) {
  double rest = 1, angle = 0;
  h->lobes = 0;
  if (!replace(c, SHADE_DUMP_GROOVE, pixel, 1, &angle))
    return 1; /* is found there */
  for (int k = 0; k < CHECK_LOBES; k++) {
    const int channel = SHADE_DUMP_LOBE2 + k * SHADE_DUMP_PER_LOBE;
    double numbers[SHADE_DUMP_PER_LOBE] = {0}, ns[3];
    if (!replace(c, (enum shade_dump_optional)channel, pixel, SHADE_DUMP_PER_LOBE, numbers)) {
      check_note_fault(c, FAULT_NOT_FINITE, pixel);
      return 0;
    }
    check_lobe *l = &h->lobe[h->lobes];
    l->share = numbers[SHADE_DUMP_LOBE_SHARE];
    if (l->share == 0)
      continue;
    rest -= l->share;
    if (!(l->share > 0 && rest > -1e-6) ||
        !check_read_unit(c, shade_dump_plane(c->dump, channel + SHADE_DUMP_LOBE_NS), pixel, ns)) {
      check_note_fault(c, FAULT_LOBE, pixel);
      return 0;
    }
    memcpy(l->alpha, numbers + SHADE_DUMP_LOBE_ALPHA, sizeof l->alpha);
    l->angle = numbers[SHADE_DUMP_LOBE_GROOVE] - angle;
    check_to_local(&h->frame, ns, l->n);
    shade_ref_turned(numbers[SHADE_DUMP_LOBE_GROOVE], l->n, l->n);
    h->lobes++;
  }
  return 1;
}

/* On cloth: where, over what extent, by which tier. 0: not what may be. */
static int read_place(const check *c, size_t pixel, check_hit *h) {
  const float *uv = shade_dump_plane(c->dump, SHADE_DUMP_UV);
  double tier = SHADE_TIER_AUTO;
  h->uv[0] = (double)uv[pixel];
  h->uv[1] = (double)uv[c->pixels + pixel];
  h->foot[0] = h->foot[1] = 0;
  if (!replace(c, SHADE_DUMP_FOOT, pixel, 2, h->foot) ||
      !replace(c, SHADE_DUMP_TIER, pixel, 1, &tier) || h->foot[0] < 0 || h->foot[1] < 0 ||
      !(tier >= SHADE_TIER_AUTO && tier <= SHADE_TIER_SINGLE) || tier != floor(tier) ||
      fabs(h->uv[0]) > 1e9 || fabs(h->uv[1]) > 1e9)
    return 0;
  h->tier = (shade_fabric_tier)(int)tier;
  return 1;
}

/* 0 with a fault noted if the hit's planes are unfit. */
int check_read_hit(check *c, size_t pixel, check_hit *h) {
  const shade_dump *d = c->dump;
  double tangent[3], ns[3], v[3], color[3], place[3];
  double *x = h->frame.axis[0], *y = h->frame.axis[1], *z = h->frame.axis[2];
  const struct {
    const float *plane;
    double *to;
    check_fault fault;
  } directions[] = {{shade_dump_plane(d, SHADE_DUMP_N), z, FAULT_UNIT_N},
                    {shade_dump_plane(d, SHADE_DUMP_T), tangent, FAULT_UNIT_T},
                    {shade_dump_plane(d, SHADE_DUMP_NS), ns, FAULT_UNIT_NS},
                    {shade_dump_plane(d, SHADE_DUMP_V), v, FAULT_UNIT_V}};
  for (int i = 0; i < 4; i++)
    if (!check_read_unit(c, directions[i].plane, pixel, directions[i].to)) {
      check_note_fault(c, directions[i].fault, pixel);
      return 0;
    }
  const double along = check_dot(tangent, z);
  if (fabs(along) > UNIT_TOLERANCE) {
    check_note_fault(c, FAULT_TANGENT, pixel);
    return 0;
  }
  for (int i = 0; i < 3; i++)
    x[i] = tangent[i] - along * z[i];
  normalise(x);
  y[0] = z[1] * x[2] - z[2] * x[1];
  y[1] = z[2] * x[0] - z[0] * x[2];
  y[2] = z[0] * x[1] - z[1] * x[0];
  check_to_local(&h->frame, ns, h->n);
  check_to_local(&h->frame, v, h->wo);

  check_read_three(c, shade_dump_plane(d, SHADE_DUMP_P), pixel, place);
  check_read_three(c, shade_dump_plane(d, SHADE_DUMP_COLOR), pixel, color);
  const float *uv = shade_dump_plane(d, SHADE_DUMP_UV);
  if (!check_finite_three(place) || !check_finite_three(color) || !isfinite(uv[pixel]) ||
      !isfinite(uv[c->pixels + pixel])) {
    check_note_fault(c, FAULT_NOT_FINITE, pixel);
    return 0;
  }
  h->params = c->materials[c->index[pixel]].params;
  h->cloth = c->materials[c->index[pixel]].cloth;
  if (d->has_color)
    memcpy(h->params.f0, color, sizeof color);
  if (!read_lobes(c, pixel, h))
    return 0;
  if (!read_varied(c, pixel, h)) {
    check_note_fault(c, FAULT_NOT_FINITE, pixel);
    return 0;
  }
  if (h->cloth && !read_place(c, pixel, h)) {
    check_note_fault(c, FAULT_CLOTH, pixel);
    return 0;
  }
  return 1;
}

/* Find each pixel's material; what is no hit or unfit gets -1. */
void check_find_hits(check *c) {
  const float *id = shade_dump_plane(c->dump, SHADE_DUMP_MATERIAL);
  size_t far = 0;
  for (size_t pixel = 0; pixel < c->pixels; pixel++) {
    const int index = c->index[pixel] = check_find_material(c, id[pixel]);
    if (index < 0) {
      if (id[pixel] != -1)
        check_note_fault(c, FAULT_ID, pixel);
      continue;
    }
    check_material *m = &c->materials[index];
    m->pixels++;
    check_hit h;
    if (!check_read_hit(c, pixel, &h)) {
      c->index[pixel] = -1;
      continue;
    }
    m->tilt = fmax(m->tilt, atan2(hypot(h.n[0], h.n[1]), h.n[2]));
    far += h.cloth && check_tier_of(&h) == CHECK_FAR;
    if (h.cloth && check_tier_of(&h) == CHECK_SINGLE)
      check_prepare_single(h.cloth);
    if (h.cloth && shade_dump_has(c->dump, SHADE_DUMP_COVERAGE) &&
        !check_coverage(&h, (double)shade_dump_plane(c->dump, SHADE_DUMP_COVERAGE)[pixel]))
      check_note_fault(c, FAULT_COVERAGE, pixel);
  }
  const double affordable = 2e6 / fmax((double)far * c->dump->lights, 1); /* some half a minute */
  c->far_points = (int)fmax(256, fmin(affordable, 16384));
}
