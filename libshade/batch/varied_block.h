/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Parameters of each sample: the material's own, or those given, within their ranges, in the terms
 * of the distribution; and light and eye turned into the frame of each groove.
 */
#ifndef SHADE_BATCH_VARIED_BLOCK_H
#define SHADE_BATCH_VARIED_BLOCK_H

#include "../model/mutual.h"
#include "../model/public.h"
#include "diffuse_block.h"
#include "direction_block.h"
#include "lobe_block.h"

/* What shade_lanes and shade_sample_lanes end in, from f0r on. */
typedef struct varied_arrays {
  const real *f0[3], *ax, *ay, *ex, *ey, *f82[3], *eta[3], *k[3], *kd[3], *groove_x, *groove_y;
  size_t parts;
  const real *slopes[5];
} varied_arrays;

/* Room for a block's parameters. */
typedef struct varied_room {
  ROOM kx[BLOCK], ky[BLOCK], peak[BLOCK], gx[BLOCK], gy[BLOCK];
  ROOM f0[3][BLOCK], tint[3][BLOCK], k[3][BLOCK], kd[3][BLOCK], slopes[5][BLOCK];
  int turned; /* into the frame whose x' is (c, s), and whose y' points the other way at side -1 */
  ROOM c[BLOCK], s[BLOCK], side[BLOCK];
  vec_room n, wi, wo;
} varied_room;

/* One number for all lanes. */
static const real *filled(size_t count, real own, real *restrict room) {
  const size_t lanes =
      count < BLOCK ? count : BLOCK; /* for the compiler: a block is never larger */
#pragma omp simd
  for (size_t i = 0; i < lanes; i++)
    room[i] = own;
  return room;
}

/* The material's own lobe, and the whole of its own parameters, as far as it reads them. */
static void own_shape(const bsdf *b, size_t count, varied_room *m, sample_block *s) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  m->turned = 0;
  s->shape = (lobe_shape){filled(count, own->kx, m->kx), filled(count, own->ky, m->ky),
                          filled(count, own->peak, m->peak), filled(count, own->gx, m->gx),
                          filled(count, own->gy, m->gy)};
  s->bumps = has_bumps(b) ? BUMPS_OF_ALL : BUMPS_OF_NONE;
  s->met = NULL;
  for (int c = 0; c < 5; c++)
    s->slopes[c] = filled(s->bumps ? count : 0, own->slopes[c], m->slopes[c]);
}

static void own_block(const bsdf *b, size_t count, varied_room *m, sample_block *s) {
  const shade_fresnel_traits reads = shade_fresnel_is(b->fresnel);
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  own_shape(b, count, m, s);
  for (int c = 0; c < 3; c++) {
    s->f0[c] = filled(reads.f0 || b->has_diffuse ? count : 0, own->f0[c], m->f0[c]);
    s->tint[c] = filled(reads.tint ? count : 0, own->tint[c], m->tint[c]);
    s->k[c] = filled(reads.k ? count : 0, own->k[c], m->k[c]);
    s->kd[c] = filled(b->has_diffuse ? count : 0, own->kd[c], m->kd[c]);
  }
}

/* What draws and densities read of it. */
static void own_proposal(const bsdf *b, size_t count, varied_room *m, sample_block *s) {
  (b->has_diffuse || shade_horizon_is(b->horizon).mutual ? own_block : own_shape)(b, count, m, s);
}

/* `in` to `out` within the range; NaN becomes `own`. Nonzero when something had to change. */
static int pass_within(size_t count, real low, real high, real own, const real *restrict in,
                       real *restrict out) {
  int changed = 0;
#pragma omp simd reduction(| : changed)
  for (size_t i = 0; i < count; i++) {
    real v = in[i] == in[i] ? in[i] : own;
    v = minimum(maximum(v, low), high);
    changed |= !(v == in[i]);
    out[i] = v;
  }
  return changed;
}

/*
 * x' of the groove as a unit vector; what is no direction is the material's own, x. Divided by
 * the larger component first, which keeps the square in range.
 */
static int pass_groove(size_t count, const real *restrict x, const real *restrict y,
                       real *restrict c, real *restrict s) {
  int changed = 0;
#pragma omp simd reduction(| : changed)
  for (size_t i = 0; i < count; i++) {
    real size = maximum(absolute(x[i]), absolute(y[i]));
    int known = (x[i] - x[i] == 0) & (y[i] - y[i] == 0) & (size >= LEAST_NORMAL);
    real a = known ? x[i] : 1, b = known ? y[i] : 0;
    real largest = known ? size : 1;
    changed |= !known;
    a /= largest;
    b /= largest;
    real scale = 1 / root(a * a + b * b);
    c[i] = a * scale;
    s[i] = b * scale;
  }
  return changed;
}

/* What is narrow along the other axis than the material's has its axes change places: x' is y'. */
static void pass_exchange(size_t count, const real *restrict mirror, real *restrict x,
                          real *restrict y) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const real_bits other = mask_of(mirror[i]);
    const real a = x[i], b = y[i];
    x[i] = kept(other, b, a);
    y[i] = kept(other, a, b);
  }
}
static void pass_axes(size_t count, const real *restrict mirror, real *restrict c, real *restrict s,
                      real *restrict side) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const real_bits other = mask_of(mirror[i]);
    const real x = c[i], y = s[i];
    c[i] = kept(other, -y, x);
    s[i] = kept(other, x, y);
    side[i] = kept(other, -1, 1);
  }
}

/* Directions to the frames of the grooves, and back in place. */
static void pass_turn(size_t count, const varied_room *m, vec v, vec_room *restrict to) {
  const real *restrict c = m->c, *restrict s = m->s, *restrict side = m->side;
  ARRAYS(v);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const triple w = turned_into(c[i], s[i], side[i], AT(v));
    to->x[i] = w.x;
    to->y[i] = w.y;
    to->z[i] = w.z;
  }
}
static void pass_turn_back(size_t count, const varied_room *m, real *restrict wx,
                           real *restrict wy) {
  const real *restrict c = m->c, *restrict s = m->s, *restrict side = m->side;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const triple w = turned_back(c[i], s[i], side[i], (triple){wx[i], wy[i], 0});
    wx[i] = w.x;
    wy[i] = w.y;
  }
}

/* Exponents to alphas and back, as shade_params_set_exponents and set_alphas do. */
static void pass_alpha_of(size_t count, real *restrict v) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    v[i] = minimum(maximum(root(2 / (v[i] + 2)), R(1e-4)), 10);
}
static void pass_exponent_of(size_t count, real *restrict v) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    v[i] = minimum(maximum(2 / (v[i] * v[i]) - 2, 0), R(1e6));
}

/* A lobe's kx and ky are exponents, or alphas, on entry. */
LEAF void pass_shape(int exponents, size_t count, varied_room *m) {
  real *restrict kx = m->kx, *restrict ky = m->ky, *restrict peak = m->peak;
  real *restrict gx = m->gx, *restrict gy = m->gy;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const lobe_numbers lobe =
        exponents ? numbers_of_exponents(kx[i], ky[i]) : numbers_of_alphas(kx[i], ky[i]);
    kx[i] = lobe.kx;
    ky[i] = lobe.ky;
    peak[i] = lobe.peak;
    gx[i] = lobe.gx;
    gy[i] = lobe.gy;
  }
}

/* Which lanes' narrow axis, that of the greater of x and y, is not the material's. */
static int pass_mirrored(size_t count, int own_y, const real *restrict x, const real *restrict y,
                         real *restrict mirror) {
  int any = 0;
#pragma omp simd reduction(| : any)
  for (size_t i = 0; i < count; i++) {
    int other = own_y ? x[i] >= y[i] : y[i] > x[i];
    any |= other;
    mirror[i] = other ? R(1.0) : R(0.0);
  }
  return any;
}
/* One axis of the lobe, exponents or alphas as the distribution reads them; `own` the material's
   k. Status bits. */
static unsigned read_axis(int exponents, size_t count, real own, const real *alpha,
                          const real *exponent, real *to) {
  /* not of exponents, which may be 0 */
  const real own_alpha = exponents ? 1 : minimum(maximum(1 / root(own), R(1e-4)), 10);
  const real own_value = exponents ? own : own_alpha;
  const real *given = exponents ? (exponent ? exponent : alpha) : alpha ? alpha : exponent;
  if (!given) {
    for (size_t i = 0; i < count; i++)
      to[i] = own_value;
    return SHADE_OK;
  }
  const int as_exponent = given == exponent;
  real fallback = own_value;
  if (as_exponent != exponents) { /* own in terms of what is given */
    if (as_exponent)
      pass_exponent_of(1, &fallback);
    else
      pass_alpha_of(1, &fallback);
  }
  const int changed = as_exponent ? pass_within(count, 0, R(1e6), fallback, given, to)
                                  : pass_within(count, R(1e-4), 10, fallback, given, to);
  if (as_exponent && !exponents)
    pass_alpha_of(count, to);
  else if (!as_exponent && exponents)
    pass_exponent_of(count, to);
  return changed ? SHADE_CLAMPED_PARAMETER : SHADE_OK;
}

/* One colour, of which any channels may be given. Status bits. */
static unsigned read_colour(size_t count, size_t start, const real *const given[3],
                            const real own[3], real low, real high, real room[3][BLOCK]) {
  int changed = 0;
  for (int c = 0; c < 3; c++)
    if (given[c])
      changed |= pass_within(count, low, high, own[c], given[c] + start, room[c]);
  return changed ? SHADE_CLAMPED_PARAMETER : SHADE_OK;
}

/* The material as lanes that hold parameters need it: *b, or a copy with what they change for all
 * samples. */
static const bsdf *for_lanes(const bsdf *b, const varied_arrays *in, bsdf *copy) {
  const int shape = in->ax || in->ay || in->ex || in->ey;
  const int uneven = b->uneven.map != b->carry.map || b->uneven.parts != b->carry.parts;
  const int kd = in->kd[0] || in->kd[1] || in->kd[2];
  const int parts = in->parts == SHADE_PART_SPECULAR || in->parts == SHADE_PART_DIFFUSE;
  if (!(shape && uneven) && !(kd && !b->has_diffuse) && !parts)
    return b;
  *copy = *b;
  if (shape)
    copy->carry = b->uneven;
  copy->has_diffuse |= kd;
  if (in->parts == SHADE_PART_SPECULAR)
    copy->has_diffuse = 0;
  if (in->parts == SHADE_PART_DIFFUSE) {
    copy->has_specular = 0;
    copy->has_diffuse = 1;
  }
  return copy;
}

/* The lobe of each sample by what is given of ax, ay, ex and ey, and which are mirrored. Status
 * bits. */
static unsigned read_shape(const bsdf *b, size_t count, const real *const given[4], varied_room *m,
                           real *mirror, int *mirrored) {
  unsigned status = read_axis(b->exponents, count, numbers_of(b)->kx, given[0], given[2], m->kx);
  status |= read_axis(b->exponents, count, numbers_of(b)->ky, given[1], given[3], m->ky);
  if (b->exponents)
    pass_shape(1, count, m);
  else
    pass_shape(0, count, m);
  if (b->groove_auto && pass_mirrored(count, b->fibres_along_y, m->kx, m->ky, mirror)) {
    *mirrored = 1;
    pass_exchange(count, mirror, m->kx, m->ky);
    pass_exchange(count, mirror, m->gx, m->gy);
  }
  return status;
}

/* The map's slopes of each sample, of which any may be given. */
static int any_slopes(const varied_arrays *in) {
  return in->slopes[0] || in->slopes[1] || in->slopes[2] || in->slopes[3] || in->slopes[4];
}
/* |xy| is at most sqrt(xx yy), to rounding. Returns whether it was not. */
LEAF int bound_slopes(real v[5]) {
  const real widest = root(v[2]) * root(v[4]);
  if (absolute(v[3]) <= widest * R(1.000001))
    return 0;
  v[3] = v[3] > 0 ? widest : -widest;
  return 1;
}
static unsigned read_slopes(const bsdf *b, const varied_arrays *in, size_t start,
                            sample_block *block, varied_room *m) {
  static const real least[5] = {-1000, -1000, 0, -1000000, 0};
  const size_t count = block->count;
  const real *own = numbers_of(b)->slopes;
  size_t flat = 0;
  int changed = 0;
  for (int c = 0; c < 5; c++) {
    filled(count, own[c], m->slopes[c]);
    if (in->slopes[c])
      changed |= pass_within(count, least[c], c < 2 ? 1000 : 1000000, own[c], in->slopes[c] + start,
                             m->slopes[c]);
  }
  for (size_t i = 0; i < count; i++) {
    real v[5] = {0, 0, m->slopes[2][i], m->slopes[3][i], m->slopes[4][i]};
    changed |= bound_slopes(v);
    m->slopes[3][i] = v[3];
    flat += v[2] + v[4] > 0 ? 0 : 1;
  }
  block->bumps = !flat ? BUMPS_OF_ALL : flat < count ? BUMPS_OF_SOME : BUMPS_OF_NONE;
  return changed ? SHADE_CLAMPED_PARAMETER : SHADE_OK;
}

/* Into the frame of turned_into. */
LEAF void turn_slopes(real c, real s, real side, real v[5]) {
  const real x = v[0], y = v[1], xx = v[2], xy = v[3], yy = v[4];
  v[0] = c * x + s * y;
  v[1] = side * (c * y - s * x);
  v[2] = c * c * xx + 2 * c * s * xy + s * s * yy;
  v[3] = side * (c * s * (yy - xx) + (c * c - s * s) * xy);
  v[4] = c * c * yy - 2 * c * s * xy + s * s * xx;
}
static void pass_turn_slopes(size_t count, varied_room *m) {
  for (size_t i = 0; i < count; i++) {
    real v[5];
    for (int c = 0; c < 5; c++)
      v[c] = m->slopes[c][i];
    turn_slopes(m->c[i], m->s[i], m->side[i], v);
    for (int c = 0; c < 5; c++)
      m->slopes[c][i] = v[c];
  }
}

static unsigned read_colours(const bsdf *b, const varied_arrays *in, size_t start,
                             sample_block *block, varied_room *m) {
  const size_t count = block->count;
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  unsigned status = read_colour(count, start, in->f0, own->f0, 0, 1, m->f0);
  status |= read_colour(count, start, in->kd, own->kd, 0, 1, m->kd);
  if (b->fresnel == SHADE_FRESNEL_F82)
    status |= read_colour(count, start, in->f82, own->tint, 0, 1, m->tint);
  if (b->fresnel == SHADE_FRESNEL_CONDUCTOR) {
    status |= read_colour(count, start, in->eta, own->tint, R(1e-3), 100, m->tint);
    status |= read_colour(count, start, in->k, own->k, 0, 100, m->k);
  }
  return status;
}

/*
 * Everything but directions of `block`, from lane `start` on; then directions that are not NULL
 * (n, and wi or wo) into the frames of the grooves. Returns status bits.
 */
static unsigned read_varied(const bsdf *b, const varied_arrays *in, size_t start,
                            sample_block *block, varied_room *m) {
  const size_t count = block->count;
  ROOM mirror[BLOCK];
  int mirrored = 0;
  static const varied_arrays none = {.parts = 0};
  m->turned = 0;
  const int slopes = shade_horizon_is(b->horizon).mutual && any_slopes(in);
  if (!slopes && !memcmp(in, &none, offsetof(varied_arrays, parts)))
    return SHADE_OK;
  unsigned status = read_colours(b, in, start, block, m);
  if (slopes)
    status |= read_slopes(b, in, start, block, m);
  const real *given[4] = {in->ax, in->ay, in->ex, in->ey};
  if (given[0] || given[1] || given[2] || given[3]) {
    for (int k = 0; k < 4; k++)
      given[k] = given[k] ? given[k] + start : NULL;
    status |= read_shape(b, count, given, m, mirror, &mirrored);
  }
  m->turned = mirrored || in->groove_x;
  if (!m->turned)
    return status;
  for (size_t i = 0; i < count; i++)
    m->c[i] = m->side[i] = 1, m->s[i] = 0;
  if (in->groove_x && pass_groove(count, in->groove_x + start, in->groove_y + start, m->c, m->s))
    status |= SHADE_CLAMPED_PARAMETER;
  if (mirrored)
    pass_axes(count, mirror, m->c, m->s, m->side);
  if (block->bumps) {
    if (!slopes) /* those of the block before are turned */
      for (int c = 0; c < 5; c++)
        filled(count, numbers_of(b)->slopes[c], m->slopes[c]);
    pass_turn_slopes(count, m);
  }
  vec *const v[3] = {&block->n, &block->wi, &block->wo};
  vec_room *const to[3] = {&m->n, &m->wi, &m->wo};
  for (int k = 0; k < 3; k++)
    if (v[k]->x) {
      pass_turn(count, m, *v[k], to[k]);
      *v[k] = vec_in(to[k]);
    }
  return status;
}

/*
 * A block whole, from lane `start` on: directions, without wi where there is none, mended; then the
 * parameters. Returns status bits.
 */
static unsigned read_lanes(const bsdf *b, const bsdf_lanes *in, const varied_arrays *varied,
                           size_t start, sample_block *s, varied_room *m, mended_room *room) {
  s->n = vec_from(in->nx, in->ny, in->nz, start);
  s->wo = vec_from(in->wox, in->woy, in->woz, start);
  s->wi = (vec){NULL, NULL, NULL};
  if (in->wix)
    s->wi = vec_from(in->wix, in->wiy, in->wiz, start);
  vec *const v[3] = {&s->n, &s->wo, &s->wi};
  const unsigned status = mend_block(s->count, in->wix ? 3 : 2, v, room);
  return status | read_varied(b, varied, start, s, m);
}

#endif
