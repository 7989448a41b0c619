/* SPDX-License-Identifier: Apache-2.0 */
/* What a point of the cloth shows: the draft, the yarns' shape, their noise, their shadow. */
#include "cloth_model.h"

#include <stdint.h>
#include <string.h>

/* ---- parameters within their ranges ------------------------------------------------- */

double ref_number(double x, double low, double high, double initial) {
  return isnan(x) ? initial : x < low ? low : x > high ? high : x;
}

static void mend_yarn(shade_yarn_params *y) {
#define MEND(word, unit, low, high, initial, help)                                                 \
  y->word = ref_number(y->word, low, high, initial);
  SHADE_TABLE_YARN(MEND)
#undef MEND
}

static int is_stated(double length) {
  return length > 0 && length <= 1e9;
}

static double mean_stated(const shade_thread *threads, int count, int spacing) {
  real sum = 0;
  int stated = 0;
  for (int i = 0; i < count; i++) {
    double length = spacing ? threads[i].spacing : threads[i].thickness;
    if (is_stated(length)) {
      sum += length;
      stated++;
    }
  }
  return stated ? (double)(sum / stated) : 0;
}

void ref_mend_weave(shade_ref_cloth *c) {
  mend_yarn(&c->yarns.warp);
  mend_yarn(&c->yarns.weft);
  if ((unsigned)c->yarns.occlusion >= SHADE_OCCLUSION_COUNT)
    c->yarns.occlusion = SHADE_OCCLUSION_NONE;
  for (int k = 0; k < 2; k++) {
    const shade_thread *threads = k == SHADE_TOP_WARP ? c->draft->warp : c->draft->weft;
    int count = k == SHADE_TOP_WARP ? c->draft->ends : c->draft->picks;
    c->thickness[k] = mean_stated(threads, count, 0);
    c->spacing[k] = mean_stated(threads, count, 1);
  }
}

/* ---- noise --------------------------------------------------------------------------- */

/* The uses of noise, in the order of their channels: seven of the weft, seven of the warp. */
enum noise {
  YARN_BRIGHTNESS,
  YARN_TILT_ALONG,
  YARN_TILT_ACROSS,
  ALONG_BRIGHTNESS,
  ALONG_TILT_ALONG,
  ALONG_TILT_ACROSS,
  ALONG_WIDTH,
  NOISES
};

/* The hash of docs/theory/conventions.md, in whole numbers modulo 2^32; in [-1, 1). */
static real random_of(uint32_t seed, int channel, int64_t yarn, int64_t knot) {
  const uint64_t modulus = UINT64_C(1) << 32;
  const uint64_t words[3] = {(uint64_t)yarn % modulus, (uint64_t)knot % modulus, 0x27d4eb2f};
  uint64_t h = (seed * UINT64_C(0x9e3779b1) + (uint64_t)channel) % modulus;
  for (int i = 0; i < 3; i++) {
    h = (h ^ words[i]) * 0x85ebca6b % modulus;
    h = (h ^ h / 32768) * 0xc2b2ae35 % modulus;
    h = h ^ h / 8192;
  }
  return (real)(h / 256) / 8388608 - 1;
}

/* ---- one yarn ------------------------------------------------------------------------ */

/* A point beside or on one yarn. */
typedef struct place {
  int kind;          /* SHADE_TOP_WEFT or SHADE_TOP_WARP */
  int64_t number;    /* of the yarn, counted on over repeats */
  int64_t crossing;  /* along it */
  real s;            /* within that crossing */
  real share, sigma; /* of its crossing that it fills here; position across it */
} place;

static const shade_yarn_params *yarn_of(const shade_ref_cloth *c, int kind) {
  return kind == SHADE_TOP_WARP ? &c->yarns.warp : &c->yarns.weft;
}

static int channel_of(int kind, enum noise use) {
  return (kind == SHADE_TOP_WARP ? NOISES : 0) + (int)use;
}

static real per_yarn(const shade_ref_cloth *c, const place *p, enum noise use) {
  return random_of(c->yarns.seed, channel_of(p->kind, use), p->number, 0);
}

/* Values at knots, joined by cubics that are level there. */
static real along_yarn(const shade_ref_cloth *c, const place *p, enum noise use) {
  real at = (p->crossing + p->s) / yarn_of(c, p->kind)->along_length;
  int64_t knot = (int64_t)at;
  knot -= at < (real)knot; /* floorl takes as long as all the rest */
  real t = at - (real)knot;
  real a = random_of(c->yarns.seed, channel_of(p->kind, use), p->number, knot);
  real b = random_of(c->yarns.seed, channel_of(p->kind, use), p->number, knot + 1);
  return a * (1 - t) * (1 - t) * (1 + 2 * t) + b * t * t * (3 - 2 * t);
}

static const shade_thread *thread_of(const shade_ref_cloth *c, int kind, int index) {
  return kind == SHADE_TOP_WARP ? &c->draft->warp[index] : &c->draft->weft[index];
}

/* t: its crossing's position across it, 0 to 1. */
static place place_on(const shade_ref_cloth *c, int kind, int index, int64_t number,
                      int64_t crossing, real s, real t) {
  const shade_yarn_params *y = yarn_of(c, kind);
  const shade_thread *thread = thread_of(c, kind, index);
  place p = {.kind = kind, .number = number, .crossing = crossing, .s = s};
  real share = y->width / ((real)y->width + y->gap);
  if (is_stated(thread->thickness))
    share *= thread->thickness / (real)c->thickness[kind];
  if (is_stated(thread->spacing))
    share /= thread->spacing / (real)c->spacing[kind];
  share = within(share, 1e-6L, 1);
  if (y->slub > 0)
    share = within(share * (1 + y->slub * along_yarn(c, &p, ALONG_WIDTH)), share / 20, 1);
  p.share = share;
  p.sigma = (2 * t - 1) / share;
  return p;
}

static int covers(const place *p) {
  return fabsl(p->sigma) <= 1;
}

static int index_in(int64_t number, int count) {
  int64_t rest = number % count;
  return (int)(rest < 0 ? rest + count : rest);
}

static int warp_is_up(const shade_draft *d, int64_t end, int64_t pick) {
  return d->warp_up[(size_t)index_in(pick, d->picks) * (size_t)d->ends +
                    (size_t)index_in(end, d->ends)] != 0;
}

/* Crossings that the float goes on beyond this one, forwards or back; far enough is enough. */
static int float_beyond(const shade_draft *d, const place *p, int step) {
  enum { ENOUGH = 64 }; /* crimp reaches 16 crossings at most */
  const int warp = p->kind == SHADE_TOP_WARP;
  int here = warp ? warp_is_up(d, p->number, p->crossing) : warp_is_up(d, p->crossing, p->number);
  for (int k = 1; k <= ENOUGH; k++) {
    int64_t at = p->crossing + k * step;
    if ((warp ? warp_is_up(d, p->number, at) : warp_is_up(d, at, p->number)) != here)
      return k - 1;
  }
  return ENOUGH;
}

/* w(d) of weave.h. */
static real dive(real distance, real length) {
  real t = distance / length < 1 ? distance / length : 1;
  return (1 - t) * (1 - t) * (1 + 2 * t);
}

/* Tilt along and across; side: 1 above the other yarns, -1 below. */
static void tilt_of(const shade_ref_cloth *c, const place *p, int side, real *along, real *across) {
  const shade_yarn_params *y = yarn_of(c, p->kind);
  real a = 0, b = y->curve * p->sigma;
  if (y->ridge > 0 && y->segments > 0) {
    real strand = y->segments * (p->s - y->slant * p->sigma);
    a += y->ridge * (2 * (strand - floorl(strand)) - 1);
  }
  if (y->crimp > 0) {
    int behind = float_beyond(c->draft, p, -1), ahead = float_beyond(c->draft, p, 1);
    real length = y->crimp_length, whole = behind + 1 + ahead;
    if (length > whole)
      length = whole;
    a += side * y->crimp * (dive(ahead + 1 - p->s, length) - dive(behind + p->s, length));
  }
  if (y->vary_tilt > 0) {
    a += y->vary_tilt * per_yarn(c, p, YARN_TILT_ALONG);
    b += y->vary_tilt * per_yarn(c, p, YARN_TILT_ACROSS);
  }
  if (y->along_tilt > 0) {
    a += y->along_tilt * along_yarn(c, p, ALONG_TILT_ALONG);
    b += y->along_tilt * along_yarn(c, p, ALONG_TILT_ACROSS);
  }
  real size = length2(a, b), most = 0.98L;
  *along = size > most ? a / size * most : a;
  *across = size > most ? b / size * most : b;
}

static real brightness_of(const shade_ref_cloth *c, const place *p) {
  const shade_yarn_params *y = yarn_of(c, p->kind);
  real light = 1;
  if (y->vary_brightness > 0)
    light += y->vary_brightness * per_yarn(c, p, YARN_BRIGHTNESS);
  if (y->along_brightness > 0)
    light += y->along_brightness * along_yarn(c, p, ALONG_BRIGHTNESS);
  return light > 0 ? light : 0;
}

/* ---- occlusion by the sky that is left ------------------------------------------------- */

/*
 * Yarns as arcs of radius 1, side by side: the line that touches the neighbour stands at the angle
 * `above` over the horizon, and the surface leans towards it by `lean`. Of an even sky the cosine
 * weights, from lean + above to the horizon on the other side, are left.
 */
static real sky_on_yarn(real curve, real share, real sigma) {
  real lean = asinl(curve * fabsl(sigma));
  real across = 2 * curve / share - sinl(lean), down = cosl(lean); /* to the neighbour's centre */
  real distance = length2(across, down);
  real above = asinl(distance > 1 ? 1 / distance : 1) - atan2l(down, across);
  return (1 + cosl(lean + above)) / 2;
}

/* On the ground between two walls as high as half a yarn's width. */
static real sky_in_gap(real share, real sigma) {
  real to_near = fabsl(sigma) - 1, between = 2 / share - 2, to_far = between - to_near;
  real near = atanl(to_near > 0 ? to_near : 0), far = atanl(to_far > 0 ? to_far : 0);
  return (sinl(near) + sinl(far)) / 2;
}

/* ---- the look-up ------------------------------------------------------------------------- */

static real linear(real shown) { /* of sRGB */
  shown = shown > 0 ? shown < 1 ? shown : 1 : 0;
  return shown <= 0.04045L ? shown / 12.92L : powl((shown + 0.055L) / 1.055L, 2.4L);
}

void ref_draft_color(const shade_ref_cloth *c, int kind, int index, real color[3]) {
  const shade_thread *thread = thread_of(c, kind, index);
  for (int i = 0; i < 3; i++)
    color[i] = linear(thread->color[i]);
}

ref_point ref_look(const shade_ref_cloth *c, double u, double v) {
  const shade_draft *d = c->draft;
  const int64_t iu = (int64_t)floor(u), iv = (int64_t)floor(v);
  const real a = u - (real)iu, b = v - (real)iv;
  const int end = index_in(iu, d->ends), pick = index_in(iv, d->picks);
  const place weft = place_on(c, SHADE_TOP_WEFT, pick, iv, iu, a, b);
  const place warp = place_on(c, SHADE_TOP_WARP, end, iu, iv, b, a);
  const int up = warp_is_up(d, iu, iv);
  const place *upper = up ? &warp : &weft, *lower = up ? &weft : &warp;
  const place *seen = !covers(upper) && covers(lower) ? lower : upper;
  const shade_yarn_params *y = yarn_of(c, seen->kind);

  ref_point at = {.kind = seen->kind, .gap = !covers(seen), .below = !covers(upper)};
  at.yarn = seen->kind == SHADE_TOP_WARP ? end : pick;
  at.sigma = seen->sigma;
  at.along = seen->s;
  at.occlusion = at.brightness = 1;
  real along = 0, across = 0, angle = 0;
  if (at.gap) {
    at.fuzz = 1 - (1 - (real)c->yarns.warp.fuzz) * (1 - (real)c->yarns.weft.fuzz);
  } else {
    tilt_of(c, seen, seen == upper ? 1 : -1, &along, &across);
    at.brightness = brightness_of(c, seen);
    angle = y->fibre;
  }
  /* the warp's axis is y; its tilt across is towards +x */
  const int on_warp = seen->kind == SHADE_TOP_WARP;
  at.dx = on_warp ? across : along;
  at.dy = on_warp ? along : across;
  const real axis = on_warp ? pi / 2 : 0;
  at.tx = cosl(axis + angle);
  at.ty = sinl(axis + angle);
  if (c->yarns.occlusion == SHADE_OCCLUSION_TILT)
    at.occlusion = 1 - length2(along, across);
  if (c->yarns.occlusion == SHADE_OCCLUSION_SKY) {
    at.occlusion = at.gap ? sky_in_gap(lower->share, lower->sigma)
                          : sky_on_yarn(y->curve, seen->share, seen->sigma);
    if (!covers(upper))
      at.occlusion *= sky_in_gap(upper->share, upper->sigma);
  }
  return at;
}

void shade_ref_crossing(const shade_ref_cloth *c, double u, double v, shade_crossing *out) {
  const ref_point at = ref_look(c, u, v);
  real color[3] = {0, 0, 0};
  if (!at.gap)
    ref_draft_color(c, at.kind, at.yarn, color);
  memset(out, 0, sizeof *out);
  out->top = at.gap ? SHADE_TOP_GAP : (shade_top)at.kind;
  out->swap = at.kind == SHADE_TOP_WARP;
  out->below = at.below;
  out->yarn = at.yarn;
  out->sigma = (double)at.sigma;
  out->along = (double)at.along;
  out->dx = (double)at.dx;
  out->dy = (double)at.dy;
  out->tx = (double)at.tx;
  out->ty = (double)at.ty;
  out->occlusion = (double)at.occlusion;
  out->brightness = (double)at.brightness;
  out->fuzz = (double)at.fuzz;
  for (int i = 0; i < 3; i++)
    out->color[i] = (double)color[i];
}
