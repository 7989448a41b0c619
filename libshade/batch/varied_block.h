/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Parameters of each sample: within their ranges, in the terms of the distribution, and light and
 * eye turned into the frame of each groove.
 */
#ifndef SHADE_BATCH_VARIED_BLOCK_H
#define SHADE_BATCH_VARIED_BLOCK_H

#include "diffuse_block.h"
#include "lobe_block.h"

/* What shade_lanes and shade_sample_lanes end in, from f0r on. */
typedef struct varied_arrays {
  const real *f0[3], *ax, *ay, *ex, *ey, *f82[3], *eta[3], *k[3], *kd[3], *groove_x, *groove_y;
  size_t parts;
} varied_arrays;

/* Room for a block's parameters. */
typedef struct varied_room {
  ROOM ax[BLOCK], ay[BLOCK], kx[BLOCK], ky[BLOCK], peak[BLOCK], gx[BLOCK], gy[BLOCK];
  ROOM f0[3][BLOCK], tint[3][BLOCK], k[3][BLOCK], kd[3][BLOCK];
  int turned; /* into the frame whose x' is (c, s), then x and y exchanged where mirror is 1 */
  ROOM c[BLOCK], s[BLOCK], mirror[BLOCK];
  vec_room n, wi, wo;
} varied_room;

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

/* Directions to the frames of the grooves, and back in place. */
static void pass_turn(size_t count, const real *restrict c, const real *restrict s,
                      const real *restrict mirror, vec v, vec_room *restrict to) {
  ARRAYS(v);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real x = c[i] * vx[i] + s[i] * vy[i], y = c[i] * vy[i] - s[i] * vx[i];
    to->x[i] = mirror[i] > 0 ? y : x;
    to->y[i] = mirror[i] > 0 ? x : y;
    to->z[i] = vz[i];
  }
}
static void pass_turn_back(size_t count, const real *restrict c, const real *restrict s,
                           const real *restrict mirror, real *restrict wx, real *restrict wy) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real x = mirror[i] > 0 ? wy[i] : wx[i], y = mirror[i] > 0 ? wx[i] : wy[i];
    wx[i] = c[i] * x - s[i] * y;
    wy[i] = s[i] * x + c[i] * y;
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

static void pass_shape_of_exponents(size_t count, const real *restrict kx, const real *restrict ky,
                                    real *restrict gx, real *restrict gy, real *restrict peak) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    gx[i] = 2 / (kx[i] + 2);
    gy[i] = 2 / (ky[i] + 2);
    peak[i] = peak_of_exponents(kx[i], ky[i]);
  }
}
/*
 * Whether no alpha has to be mended, as far as one look tells: those from 2^-13 to 8 are 16 powers
 * of 2, whose bits less those of the first lie below 2^27 (2^56). All others, NaN and negative ones
 * too, have a higher one set.
 */
static int are_alphas(size_t count, const real *restrict ax, const real *restrict ay) {
  const real_bits low = to_bits(R(0x1p-13)), range = to_bits(8) - low;
  real_bits off = 0;
#pragma omp simd reduction(| : off)
  for (size_t i = 0; i < count; i++)
    off |= (to_bits(ax[i]) - low) | (to_bits(ay[i]) - low);
  return off < range;
}

static void pass_shape_of_alphas(size_t count, const real *restrict ax, const real *restrict ay,
                                 real *restrict kx, real *restrict ky, real *restrict gx,
                                 real *restrict gy, real *restrict peak) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const lobe_numbers lobe = numbers_of_alphas(ax[i], ay[i]);
    peak[i] = lobe.peak;
    gx[i] = lobe.gx;
    gy[i] = lobe.gy;
    kx[i] = lobe.kx;
    ky[i] = lobe.ky;
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
/* Their parameters change places; to may be from. */
static void pass_exchange(size_t count, const real *restrict mirror, const real *x, const real *y,
                          real *to_x, real *to_y) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real a = x[i], b = y[i];
    to_x[i] = mirror[i] > 0 ? b : a;
    to_y[i] = mirror[i] > 0 ? a : b;
  }
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
                            const real own[3], real low, real high, real room[3][BLOCK],
                            const real *to[3]) {
  int changed = 0;
  for (int c = 0; c < 3; c++)
    if (given[c]) {
      changed |= pass_within(count, low, high, own[c], given[c] + start, room[c]);
      to[c] = room[c];
    }
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

/* Exponents of each sample, in the terms of D and Smith's Lambda. Status bits. */
static unsigned read_exponents(const bsdf *b, size_t count, const real *const given[4],
                               varied_room *m, lobe_shape *to, int *mirrored) {
  unsigned status = read_axis(1, count, numbers_of(b)->kx, given[0], given[2], m->kx);
  status |= read_axis(1, count, numbers_of(b)->ky, given[1], given[3], m->ky);
  pass_shape_of_exponents(count, m->kx, m->ky, m->gx, m->gy, m->peak);
  if (b->groove_auto && pass_mirrored(count, b->fibres_along_y, m->kx, m->ky, m->mirror)) {
    *mirrored = 1;
    pass_exchange(count, m->mirror, m->kx, m->ky, m->kx, m->ky);
    pass_exchange(count, m->mirror, m->gx, m->gy, m->gx, m->gy);
  }
  *to = (lobe_shape){1, m->kx, m->ky, m->peak, m->gx, m->gy, NULL, NULL, 0};
  return status;
}

/*
 * Alphas of each sample, read where they are if nothing has to change. `alone`: the passes to come
 * read nothing else.
 */
static unsigned read_alphas(const bsdf *b, size_t count, const real *const given[4], int alone,
                            varied_room *m, lobe_shape *to, int *mirrored) {
  const real *x = given[0], *y = given[1];
  unsigned status = SHADE_OK;
  if (!x || !y || !are_alphas(count, x, y)) {
    status |= read_axis(0, count, numbers_of(b)->kx, given[0], given[2], m->ax);
    status |= read_axis(0, count, numbers_of(b)->ky, given[1], given[3], m->ay);
    x = m->ax;
    y = m->ay;
  }
  if (b->groove_auto && pass_mirrored(count, b->fibres_along_y, y, x, m->mirror)) {
    *mirrored = 1;
    pass_exchange(count, m->mirror, x, y, m->ax, m->ay);
    x = m->ax;
    y = m->ay;
  }
  if (!alone)
    pass_shape_of_alphas(count, x, y, m->kx, m->ky, m->gx, m->gy, m->peak);
  *to = (lobe_shape){1, m->kx, m->ky, m->peak, m->gx, m->gy, x, y, alone};
  return status;
}

/* Whether any colour is given: most lanes that hold alphas hold nothing else. */
LEAF int has_colours(const varied_arrays *in) {
  uintptr_t any = 0;
  for (int c = 0; c < 3; c++)
    any |= (uintptr_t)in->f0[c] | (uintptr_t)in->f82[c] | (uintptr_t)in->eta[c] |
           (uintptr_t)in->k[c] | (uintptr_t)in->kd[c];
  return any != 0;
}

static unsigned read_colours(const bsdf *b, const varied_arrays *in, size_t start,
                             sample_block *block, varied_room *m) {
  const size_t count = block->count;
  unsigned status = SHADE_OK;
  status |= read_colour(count, start, in->f0, numbers_of(b)->f0, 0, 1, m->f0, block->f0);
  status |= read_colour(count, start, in->kd, numbers_of(b)->kd, 0, 1, m->kd, block->kd);
  if (b->fresnel == SHADE_FRESNEL_F82)
    status |= read_colour(count, start, in->f82, numbers_of(b)->tint, 0, 1, m->tint, block->tint);
  if (b->fresnel == SHADE_FRESNEL_CONDUCTOR) {
    status |=
        read_colour(count, start, in->eta, numbers_of(b)->tint, R(1e-3), 100, m->tint, block->tint);
    status |= read_colour(count, start, in->k, numbers_of(b)->k, 0, 100, m->k, block->k);
  }
  return status;
}

/*
 * Everything but directions of `block`, from lane `start` on; then directions that are not NULL
 * (n, and wi or wo) into the frames of the grooves. `alone`: of alphas nothing else is read.
 * Returns status bits.
 */
static unsigned read_varied(const bsdf *b, const varied_arrays *in, size_t start, int alone,
                            sample_block *block, varied_room *m) {
  const size_t count = block->count;
  unsigned status = SHADE_OK;
  m->turned = 0;
  if (has_colours(in))
    status |= read_colours(b, in, start, block, m);
  int mirrored = 0;
  const real *given[4] = {in->ax, in->ay, in->ex, in->ey};
  if (given[0] || given[1] || given[2] || given[3]) {
    for (int k = 0; k < 4; k++)
      given[k] = given[k] ? given[k] + start : NULL;
    status |= b->exponents ? read_exponents(b, count, given, m, &block->shape, &mirrored)
                           : read_alphas(b, count, given, alone, m, &block->shape, &mirrored);
  }
  if (!mirrored && !(in->groove_x && in->groove_y))
    return status;
  m->turned = 1;
  if (!mirrored)
    memset(m->mirror, 0, count * sizeof(real));
  if (in->groove_x && in->groove_y) {
    if (pass_groove(count, in->groove_x + start, in->groove_y + start, m->c, m->s))
      status |= SHADE_CLAMPED_PARAMETER;
  } else {
    for (size_t i = 0; i < count; i++)
      m->c[i] = 1, m->s[i] = 0;
  }
  vec *const v[3] = {&block->n, &block->wi, &block->wo};
  vec_room *const to[3] = {&m->n, &m->wi, &m->wo};
  for (int k = 0; k < 3; k++)
    if (v[k]->x) {
      pass_turn(count, m->c, m->s, m->mirror, *v[k], to[k]);
      *v[k] = vec_in(to[k]);
    }
  return status;
}

/* Mean reflectances that draws are shared out by: of the lobe at normal incidence, and diffuse. */
static void read_shares(const bsdf *b, const sample_block *block, real *restrict lobe,
                        real *restrict diffuse) {
  const size_t count = block->count;
  const int less = shade_diffuse_is(b->diffuse).less_f0;
  const shade_fresnel_traits reads = shade_fresnel_is(b->fresnel);
  ROOM room[4][BLOCK];
  for (size_t i = 0; i < count; i++)
    lobe[i] = diffuse[i] = 0;
  for (int c = 0; c < 3; c++) {
    const real *restrict f0 = filled(count, block->f0[c], 1, numbers_of(b)->f0[c], room[0]);
    const real *restrict eta = filled(count, block->tint[c], 1, numbers_of(b)->tint[c], room[1]);
    const real *restrict k = filled(count, block->k[c], 1, numbers_of(b)->k[c], room[2]);
    const real *restrict kd = filled(count, block->kd[c], 1, numbers_of(b)->kd[c], room[3]);
    const int conductor = !reads.f0;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      real k2 = k[i] * k[i], under = (eta[i] + 1) * (eta[i] + 1) + k2;
      real metal = ((eta[i] - 1) * (eta[i] - 1) + k2) / under;
      lobe[i] += (conductor ? metal : f0[i]) / 3;
      diffuse[i] += kd[i] * (1 - (less ? f0[i] : 0)) / 3;
    }
  }
}

#endif
