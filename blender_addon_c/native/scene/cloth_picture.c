/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/cloth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The draft that a cloth is woven by; a new one in *own where it is that of a name. */
static const shade_draft *draft_of(const cloth *c, shade_draft **own) {
  *own = c->draft ? NULL : shade_draft_named(c->preset.weave);
  return c->draft ? c->draft : *own;
}

static int texels_of(int crossings) {
  int each = CLOTH_TEXELS;
  while (each > 1 && each * crossings > CLOTH_MOST_TEXELS)
    each /= 2;
  return each * crossings < CLOTH_MOST_TEXELS ? each * crossings : CLOTH_MOST_TEXELS;
}

bool cloth_draft_tinted(const shade_draft *d) {
  for (int k = 0; k < d->ends + d->picks; k++) {
    const double *color = k < d->ends ? d->warp[k].color : d->weft[k - d->ends].color;
    if (color[0] < 1 || color[1] < 1 || color[2] < 1)
      return true;
  }
  return false;
}

bool cloth_texels(const cloth *c, int *width, int *height, bool *tinted) {
  shade_draft *own;
  const shade_draft *d = draft_of(c, &own);
  if (d) {
    *width = texels_of(d->ends);
    *height = texels_of(d->picks);
    *tinted = c->preset.fabric.draft_colors && cloth_draft_tinted(d);
  }
  shade_draft_free(own);
  return d != NULL;
}

/* What differs from one repeat to the next. */
static void still(shade_yarn_params *y) {
  y->vary_brightness = y->vary_tilt = y->along_brightness = y->along_tilt = y->slub = 0;
}

/* The cloth's yarns, every repeat the same, and its draft, a new one in *own where it is that of a
 * name; NULL without memory. */
static shade_weave *even_weave(const cloth *c, const shade_draft **d, shade_draft **own) {
  shade_weave_params p = c->preset.yarns;
  *d = draft_of(c, own);
  still(&p.warp);
  still(&p.weft);
  return *d ? shade_weave_create(*d, &p, NULL) : NULL;
}

double cloth_shown(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

/* Sums over the points of one texel. */
typedef struct texel {
  double dx, dy, occlusion, warp, weft, color[3];
} texel;

static void add_point(texel *t, const shade_crossing *at) {
  t->occlusion += at->occlusion;
  t->dx += at->dx;
  t->dy += at->dy;
  t->warp += at->top == SHADE_TOP_WARP;
  t->weft += at->top == SHADE_TOP_WEFT;
  for (int k = 0; k < 3; k++)
    t->color[k] += at->color[k];
}

static void write_texel(const texel *t, int points, float *tilt, float *yarns, float *tint) {
  const double by = 1.0 / points, yarn = t->warp + t->weft;
  const double on_yarn = yarn > 0 ? 1 / yarn : 0;
  tilt[0] = (float)(0.5 + 0.5 * t->dx * on_yarn);
  tilt[1] = (float)(0.5 + 0.5 * t->dy * on_yarn);
  tilt[2] = (float)(t->occlusion * by);
  yarns[0] = (float)(t->warp * by);
  yarns[1] = (float)(t->weft * by);
  yarns[2] = 0.0f;
  tilt[3] = yarns[3] = 1.0f;
  for (int k = 0; tint && k < 3; k++)
    tint[k] = yarn > 0 ? (float)cloth_shown(t->color[k] * on_yarn) : 1.0f;
  if (tint)
    tint[3] = 1.0f;
}

bool cloth_picture(const cloth *c, int width, int height, float *tilt, float *yarns, float *tint) {
  const int64_t texels = (int64_t)width * height;
  const int side = texels <= 1 << 18 ? 3 : texels <= 1 << 20 ? 2 : 1;
  shade_draft *own;
  const shade_draft *d;
  shade_weave *w = even_weave(c, &d, &own);
  for (int j = 0; w && j < height; j++)
    for (int i = 0; i < width; i++) {
      texel t = {0};
      for (int k = 0; k < side * side; k++) {
        shade_crossing at;
        shade_weave_lookup(w, (i + (k % side + 0.5) / side) * d->ends / width,
                           (j + (k / side + 0.5) / side) * d->picks / height, &at);
        add_point(&t, &at);
      }
      const size_t texel = 4 * ((size_t)j * (size_t)width + (size_t)i);
      write_texel(&t, side * side, tilt + texel, yarns + texel, tint ? tint + texel : NULL);
    }
  const bool good = w != NULL;
  shade_weave_free(w);
  shade_draft_free(own);
  return good;
}

/* How the yarns of one direction lean: mean normal and covariance (xx, xy, yy) over their points.
 */
typedef struct lean {
  double share, mean[3], spread[3];
} lean;

static void find_leans(const shade_weave *w, const shade_draft *d, lean to[2]) {
  enum { POINTS = 2048 };
  for (int k = 0; k < POINTS; k++) {
    shade_crossing at;
    shade_weave_lookup(w, d->ends * fmod(0.5 + k * 0.7548776662466927, 1),
                       d->picks * fmod(0.5 + k * 0.5698402909980532, 1), &at);
    if (at.top == SHADE_TOP_GAP)
      continue;
    lean *l = &to[at.top == SHADE_TOP_WARP];
    const double m[3] = {at.dx, at.dy, sqrt(1 - at.dx * at.dx - at.dy * at.dy)};
    l->share += 1.0 / POINTS;
    for (int i = 0; i < 3; i++) {
      l->mean[i] += m[i] / POINTS;
      l->spread[i] += m[i > 1] * m[i > 0] / POINTS;
    }
  }
  for (int kind = 0; kind < 2; kind++) {
    lean *l = &to[kind];
    for (int i = 0; i < 3 && l->share > 0; i++)
      l->mean[i] /= l->share;
    for (int i = 0; i < 3 && l->share > 0; i++)
      l->spread[i] = l->spread[i] / l->share - l->mean[i > 1] * l->mean[i > 0];
  }
}

/* What they would take of light from w, each for itself: the mean of what is above 0 of numbers
 * spread evenly about the mean of m . w [docs/theory/conventions.md, "Shadows of yarns"]. */
static double taken(const lean *l, const double w[3]) {
  const double variance =
      l->spread[0] * w[0] * w[0] + 2 * l->spread[1] * w[0] * w[1] + l->spread[2] * w[1] * w[1];
  const double middle = l->mean[0] * w[0] + l->mean[1] * w[1] + l->mean[2] * w[2];
  const double reach = sqrt(fmax(3 * variance, 0)), high = middle + reach;
  const double low = fmax(middle - reach, 0);
  if (reach < 1e-9)
    return l->share * fmax(middle, 0);
  return high > low ? l->share * (high * high - low * low) / (4 * reach) : 0;
}

double cloth_lit(const cloth *c) {
  enum { RINGS = 64, TURNS = 16 };
  shade_draft *own;
  const shade_draft *d;
  shade_weave *weave = even_weave(c, &d, &own);
  const bool good = weave != NULL;
  lean leans[2] = {{0}};
  double left = 0;
  if (weave)
    find_leans(weave, d, leans);
  for (int k = 0; weave && k < RINGS * TURNS; k++) { /* by the cosine */
    const double z = sqrt(((double)(k / TURNS) + 0.5) / RINGS), s = sqrt(1 - z * z);
    const double turn = 6.283185307179586 * (k % TURNS + 0.5) / TURNS;
    const double w[3] = {s * cos(turn), s * sin(turn), z};
    const double all =
        (1 - leans[0].share - leans[1].share) * z + taken(&leans[0], w) + taken(&leans[1], w);
    left += all > z ? z / all : 1;
  }
  shade_weave_free(weave);
  shade_draft_free(own);
  return good ? left / (RINGS * TURNS) : -1;
}
