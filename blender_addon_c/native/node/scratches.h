/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A field of scratches. `field` is its index in the scene. `at`, two operands, is the place on it
 * in metres. `amount` multiplies its depth.
 *
 * `what` is HEIGHT or NORMAL. HEIGHT writes `out`, the height there in metres and whether that is
 * in a scratch, by the amount up to 1. NORMAL adds the slopes of the field to those of `normal`,
 * three operands, and writes `out`, a normal in the shading frame. `near`, four operands, is the
 * place `step` further along u and as far along v.
 *
 * With `filtered` the normal is that of the mean slope where the ray stands for more than two cells
 * of the field's table. Two more numbers are then written, twice the variance of the slopes along
 * the frame's x and y, as node NORMAL_MAP says them. With `drawn` each ray has its own slope, drawn
 * of those there. This is for what cannot be widened, at the same cost.
 */
#ifndef LIBSHADE_NODE_SCRATCHES_H
#define LIBSHADE_NODE_SCRATCHES_H

#include "node/bump.h"
#include "scene/scratches.h"

enum { SCRATCHES_NORMAL, SCRATCHES_HEIGHT };

typedef struct node_scratches {
  const scratches *of;
  int what, out[5];
  bool filtered, drawn;
  bool coarse; /* by the table, where the ray stands for much */
  float per_step;
  operand at[2], near[4], amount, normal[3];
} node_scratches;

static inline bool node_scratches_read(reader *r, node_scratches *n, graph *g) {
  static const char *const words[] = {"NORMAL", "HEIGHT", NULL};
  int number;
  float step = 1.0f;
  n->filtered = n->drawn = false;
  if (!reader_word(r, "what", words, &n->what) ||
      !reader_integer(r, "field", 0, (long)g->scratch_fields - 1, &number) ||
      !graph_operands(r, g, "at", 2, n->at) || !graph_operands(r, g, "amount", 1, &n->amount))
    return false;
  n->of = &g->scratches[number];
  if (n->what == SCRATCHES_HEIGHT)
    return graph_outputs(r, g, "out", 2, n->out);
  if (!reader_may_flag(r, "filtered", &n->filtered) || !reader_may_flag(r, "drawn", &n->drawn) ||
      !reader_number_within(r, "step", 1e-6f, 1, &step) ||
      !graph_operands(r, g, "near", 4, n->near) || !graph_operands(r, g, "normal", 3, n->normal))
    return false;
  n->per_step = 1.0f / step;
  return graph_outputs(r, g, "out", n->filtered ? 5 : 3, n->out);
}

static inline bool node_scratches_build(node_scratches *n, const node_place *place) {
  n->coarse = (n->filtered || n->drawn) && place->normal_blur > 0.0f;
  return true;
}

/* Of a run of hits. */
typedef struct scratch_lanes {
  lane_f xt, xb, yt, yb;     /* how the place on the field changes along the frame's x and y */
  lane_f du1, dv1, du2, dv2; /* what the ray stands for there */
  lane_f x, y, xx, xy, yy;   /* slopes: mean, and covariance */
} scratch_lanes;

/*
 * A step along the surface is M (du, dv) in the frame, and J (du, dv) on the field: J over M, here
 * divided by how much larger the field is: scratches on what is scaled grow deeper as they grow
 * wider. What a ray covers is longer along its way, up to a hundred times its width.
 */
LEAF void node_scratches_place(const node_scratches *n, lane_run g, float blur,
                               const surfaces *restrict point, inputs *at,
                               scratch_lanes *restrict to) {
  const float *x = lane_of(at, n->at[0], 0, g), *y = lane_of(at, n->at[1], 1, g);
  const float *ux = lane_of(at, n->near[0], 2, g), *uy = lane_of(at, n->near[1], 3, g);
  const float *vx = lane_of(at, n->near[2], 4, g), *vy = lane_of(at, n->near[3], 5, g);
  const float per = n->per_step;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 du = in_frame(point, i, load(&point->du, i)), dv = in_frame(point, i, load(&point->dv, i));
    float area = du.x * dv.y - du.y * dv.x;
    bool flat = !(fabsf(area) > 1e-30f); /* true for NaN */
    float by = per / (flat ? 1.0f : area);
    float xu = (ux[i] - x[i]) * by, yu = (uy[i] - y[i]) * by;
    float xv = (vx[i] - x[i]) * by, yv = (vy[i] - y[i]) * by;
    float xt = xu * dv.y - xv * du.y, xb = xv * du.x - xu * dv.x;
    float yt = yu * dv.y - yv * du.y, yb = yv * du.x - yu * dv.x;
    bool good = !flat & (xt * xt + xb * xb + yt * yt + yb * yb < 1e12f);
    xt = good ? xt : 0.0f;
    xb = good ? xb : 0.0f;
    yt = good ? yt : 0.0f;
    yb = good ? yb : 0.0f;
    vec3 eye = load(&point->wo, i);
    float level2 = eye.x * eye.x + eye.y * eye.y;
    bool leans = level2 > 1e-12f;
    float one = 1.0f / sqrtf(leans ? level2 : 1.0f);
    float cx = leans ? eye.x * one : 1.0f, cy = leans ? eye.y * one : 0.0f;
    float z = fabsf(eye.z), width = blur * point->width[i];
    float along = width / (z > 0.01f ? z : 0.01f);
    float size = fabsf(xt * yb - xb * yt), even = 1.0f / sqrtf(size > 1e-12f ? size : 1.0f);
    even = size > 1e-12f ? even : 0.0f;
    to->xt[i] = even * xt;
    to->xb[i] = even * xb;
    to->yt[i] = even * yt;
    to->yb[i] = even * yb;
    to->du1[i] = along * (xt * cx + xb * cy);
    to->dv1[i] = along * (yt * cx + yb * cy);
    to->du2[i] = width * (xb * cx - xt * cy);
    to->dv2[i] = width * (yb * cx - yt * cy);
  }
}

/* A number in [0, 1) for a point, of several. */
LEAF float scratches_random(float u, float v, uint32_t number) {
  return unit_float(
      mix(((uint32_t)bits_of_float(u) * 0x9e3779b1u ^ (uint32_t)bits_of_float(v)) + number));
}

/* Does a footprint, in tiles, reach from where the library leaves its samples for the table to four
 * times as far, or, by chance, further? Else points of it, one for each ray, say the same but for
 * what the far model is off: of a camera that goes by constant ratios each frame has as much more
 * of it.
 */
static inline bool scratches_far(const scratches *s, const double side[4], float random) {
  const double xx = side[0] * side[0] + side[2] * side[2];
  const double yy = side[1] * side[1] + side[3] * side[3];
  const double xy = side[0] * side[1] + side[2] * side[3], half = 0.5 * (xx - yy);
  const double cells2 = (double)s->params.cells * s->params.cells;
  const double extent2 = cells2 * (0.5 * (xx + yy) + sqrt(half * half + xy * xy));
  const double least2 = 12.1; /* (2 sqrt 3)^2 */
  return extent2 > least2 && extent2 > least2 * (double)exp2f(4.0f * random);
}

/*
 * Of what a footprint stands for, one square chosen by chance, about as wide as the footprint is or
 * a sixteenth of its length, or, the more likely the less wider these are, half as wide: the mean
 * over rays is the mean over it, and moves as slowly as the footprint does. False where squares are
 * too wide.
 */
static inline bool scratches_square(const scratches *s, double u, double v, const double side[4],
                                    const float random[3], shade_slopes *to) {
  const double one = hypot(side[0], side[1]), other = hypot(side[2], side[3]);
  const double longer = one > other ? one : other, shorter = one > other ? other : one;
  const double wanted = shorter > longer / 16 ? shorter : longer / 16;
  int level = -ilogb(wanted); /* 2^-level <= wanted, but for what is above a tile */
  if (!(longer > 0) || level > s->squares.levels)
    return false;
  if (level >= 0 && level < s->squares.levels)
    level += ldexp(wanted, level) < 1 + (double)random[2];
  level = level < 0 ? 0 : level;
  const double width = ldexp(1, -level), square = width * width;
  const double a = one > width ? sqrt(1 - square / (one * one)) * ((double)random[0] - 0.5) : 0;
  const double b =
      other > width ? sqrt(1 - square / (other * other)) * ((double)random[1] - 0.5) : 0;
  u += a * side[0] + b * side[2];
  v += a * side[1] + b * side[3];
  if (!isfinite(u) || !isfinite(v))
    return false;
  const int wide = 1 << level;
  const int i = (int)((u - floor(u)) * wide) & (wide - 1),
            j = (int)((v - floor(v)) * wide) & (wide - 1);
  const scratch_slopes *q = s->squares.level[level] + (size_t)j * (size_t)wide + i;
  to->mean[0] = (double)q->x;
  to->mean[1] = (double)q->y;
  to->covariance[0] = (double)(q->xx - q->x * q->x);
  to->covariance[1] = (double)(q->xy - q->x * q->y);
  to->covariance[2] = (double)(q->yy - q->y * q->y);
  return true;
}

/*
 * One Gaussian of all slopes would be too dark at the peak and too bright in the tail, for those of
 * the plate are 0: a ray is, by chance, of the plate or of its scratches, and mean and covariance
 * over both as they were. How much of the footprint is scratched its slopes tell, which squared are
 * in scratches as they are in the mean over the whole field. Is it of the scratches?
 */
static inline bool scratches_part(const scratches *s, float random, shade_slopes *to) {
  const scratch_slopes *all = s->squares.level[0];
  const double x = to->mean[0], y = to->mean[1];
  const double xx = to->covariance[0] + x * x, yy = to->covariance[2] + y * y;
  const double xy = to->covariance[1] + x * y, square = xx + yy; /* in the mean */
  const double deep = (double)(all->xx + all->yy) / fmax((double)s->share, 1e-3);
  /* Fewer could not have that mean and spread along it: m' S^-1 m, of the mean m and squares S.
     Padded: strokes may all lie one way. */
  const double pad = 1e-9 * square, area = (xx + pad) * (yy + pad) - xy * xy;
  const double of_mean = (yy + pad) * x * x - 2 * xy * x * y + (xx + pad) * y * y;
  const double least = area > 0 ? of_mean / area : 1;
  const double share = fmin(fmax(square / fmax(deep, 1e-30), least), 1), more = 1 / share - 1;
  const bool in = (double)random < share;
  const double by = in ? 1 / share : 0;
  to->mean[0] = by * x;
  to->mean[1] = by * y;
  to->covariance[0] = by * (to->covariance[0] - more * x * x);
  to->covariance[1] = by * (to->covariance[1] - more * x * y);
  to->covariance[2] = by * (to->covariance[2] - more * y * y);
  return in;
}

/* A slope of a Gaussian of these, in place of its mean; nothing is left of its spread. */
static inline void scratches_draw(scratch_lanes *to, size_t i, float u, float v) {
  const float xx = to->xx[i] > 1e-12f ? to->xx[i] : 0.0f, one = sqrtf(xx);
  const float lean = xx > 0.0f ? to->xy[i] / xx : 0.0f, rest = to->yy[i] - lean * to->xy[i];
  const float radius = sqrtf(-2.0f * logf(1.0f - u)), turn = 6.2831853f * v;
  const float x = one * radius * cosf(turn);
  to->x[i] += x;
  to->y[i] += lean * x + sqrtf(rest > 0.0f ? rest : 0.0f) * radius * sinf(turn);
  to->xx[i] = to->xy[i] = to->yy[i] = 0.0f;
}

/* The look-ups are all there is to it. */
static inline void node_scratches_look(const node_scratches *n, lane_run g, bool coarse, inputs *at,
                                       scratch_lanes *to) {
  const float *x = lane_of(at, n->at[0], 0, g), *y = lane_of(at, n->at[1], 1, g);
  const double per = 1.0 / n->of->tile;
  for (size_t i = g.begin; i < g.end; i++) {
    const double side[4] = {per * (double)to->du1[i], per * (double)to->dv1[i],
                            per * (double)to->du2[i], per * (double)to->dv2[i]};
    const bool far = coarse && scratches_far(n->of, side, scratches_random(x[i], y[i], 0));
    const float random[3] = {scratches_random(x[i], y[i], 0x3c6ef372u),
                             scratches_random(x[i], y[i], 0x1b873593u),
                             scratches_random(x[i], y[i], 0x85ebca77u)};
    const double u = per * (double)x[i], v = per * (double)y[i];
    shade_slopes s;
    if (!far || !scratches_square(n->of, u, v, side, random, &s))
      shade_scratch_eval(n->of->field, u, v, far ? side : NULL, NULL, &s);
    bool in = false;
    if (far)
      in = scratches_part(n->of, scratches_random(x[i], y[i], 0x51ed270bu), &s);
    to->x[i] = (float)s.mean[0];
    to->y[i] = (float)s.mean[1];
    to->xx[i] = in ? (float)s.covariance[0] : 0.0f;
    to->xy[i] = in ? (float)s.covariance[1] : 0.0f;
    to->yy[i] = in ? (float)s.covariance[2] : 0.0f;
    if (in && !n->filtered)
      scratches_draw(to, i, scratches_random(x[i], y[i], 0x2545f491u),
                     scratches_random(x[i], y[i], 0x9e3779b9u));
  }
}

/* Slopes are added: those of a normal n are n.x/n.z and n.y/n.z. On the back the whole is turned
 * round. */
LEAF void node_scratches_add(const node_scratches *n, lane_run g, bool spread,
                             const surfaces *restrict point, inputs *at,
                             const scratch_lanes *restrict from) {
  const float *force = lane_of(at, n->amount, 6, g), *x = lane_of(at, n->normal[0], 7, g);
  const float *y = lane_of(at, n->normal[1], 8, g), *z = lane_of(at, n->normal[2], 9, g);
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
  float *sx = spread ? at->at[n->out[3]] : at->constant[10];
  float *sy = spread ? at->at[n->out[4]] : at->constant[11];
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float amount = clampf(force[i], 0.0f, 100.0f), turned = amount * point->side[i];
    float up = z[i] > 1e-3f ? z[i] : 1e-3f;
    float xt = from->xt[i], xb = from->xb[i], yt = from->yt[i], yb = from->yb[i];
    float gt = xt * from->x[i] + yt * from->y[i], gb = xb * from->x[i] + yb * from->y[i];
    vec3 to = upright((vec3){x[i] - turned * up * gt, y[i] - turned * up * gb, up});
    float xx = from->xx[i], xy = from->xy[i], yy = from->yy[i], twice = 2.0f * amount * amount;
    sx[i] = twice * (xt * xt * xx + 2.0f * xt * yt * xy + yt * yt * yy);
    sy[i] = twice * (xb * xb * xx + 2.0f * xb * yb * xy + yb * yb * yy);
    nx[i] = to.x;
    ny[i] = to.y;
    nz[i] = to.z;
  }
}

static inline void node_scratches_heights(const node_scratches *n, lane_run g, inputs *at) {
  const float *x = lane_of(at, n->at[0], 0, g), *y = lane_of(at, n->at[1], 1, g);
  const float *force = lane_of(at, n->amount, 6, g);
  float *height = at->at[n->out[0]], *mask = at->at[n->out[1]];
  const double per = 1.0 / n->of->tile;
  for (size_t i = g.begin; i < g.end; i++) {
    shade_slopes s;
    double h;
    shade_scratch_eval(n->of->field, per * (double)x[i], per * (double)y[i], NULL, &h, &s);
    float amount = clampf(force[i], 0.0f, 100.0f);
    height[i] = (float)(h * n->of->tile) * amount;
    mask[i] = h < 0.0 ? (amount < 1.0f ? amount : 1.0f) : 0.0f;
  }
}

static inline void node_scratches_run(const node_scratches *n, lane_run g, const corners *corner,
                                      const surfaces *point, inputs *at) {
  static _Thread_local scratch_lanes lanes;
  (void)corner;
  if (n->what == SCRATCHES_HEIGHT) {
    node_scratches_heights(n, g, at);
    return;
  }
  const bool coarse = n->coarse && at->normal_blur > 0.0f;
  node_scratches_place(n, g, coarse ? at->normal_blur : 0.0f, point, at, &lanes);
  node_scratches_look(n, g, coarse, at, &lanes);
  if (n->filtered)
    node_scratches_add(n, g, true, point, at, &lanes);
  else
    node_scratches_add(n, g, false, point, at, &lanes);
}

#endif
