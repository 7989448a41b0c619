/* SPDX-License-Identifier: Apache-2.0 */
/* One look-up into a weave, from the leaves; the rules are those of weave.h. */

/* A point on one yarn, whichever way the yarn runs. */
typedef struct FN(weave_point) {
  uint32_t yarn, base; /* number of the yarn, counted on over repeats; channel of its noise */
  int64_t crossing;    /* number of the crossing along it */
  real s;              /* position within that crossing, 0 to 1 */
  real share, sigma;
} FN(weave_point);

/* `t`: its crossing's position across it. Width, and with it sigma, may vary along the yarn. */
LEAF FN(weave_point) FN(weave_place)(const shade_weave *w, int kind, const weave_thread *thread,
                                     int64_t yarn, int64_t crossing, real s, real t) {
  const FN(weave_yarn) *y = &w->FN(yarn)[kind];
  FN(weave_point)
  p = {(uint32_t)yarn, (uint32_t)kind * WEAVE_CHANNELS, crossing, s, thread->FN(share), 0};
  if (y->slub > 0) {
    real r = FN(weave_along)(w->params.seed, p.base + WEAVE_SLUB, p.yarn, (real)crossing + s,
                             y->along_frequency);
    p.share = FN(minimum)(FN(maximum)(p.share * (1 + y->slub * r), p.share * R(0.05)), 1);
  }
  p.sigma = (2 * t - 1) / p.share;
  return p;
}

/* Tilt along and across, and brightness. before, after: cells to the float's ends; side: 1
 * above the other yarn, -1 below. */
LEAF void FN(weave_surface)(const shade_weave *w, int kind, const FN(weave_point) * p, int before,
                            int after, real side, real *along, real *across, real *brightness) {
  const FN(weave_yarn) *y = &w->FN(yarn)[kind];
  const uint32_t seed = w->params.seed;
  real a = 0, c = y->curve * p->sigma, light = 1;
  if (y->segments > 0)
    a = y->ridge * FN(weave_ridge)(y->segments, y->slant, p->s, p->sigma);
  if (y->crimp > 0) {
    /* beyond the float's other end the slope there would not be met from the other side */
    const real per_length = FN(maximum)(y->per_crimp_length, 1 / (real)(before + after + 1));
    a += side * y->crimp *
         (FN(weave_dive)((real)after + 1 - p->s, per_length) -
          FN(weave_dive)((real)before + p->s, per_length));
  }
  if (y->vary_tilt > 0) {
    a += y->vary_tilt * FN(weave_random)(seed, p->base + WEAVE_VARY_TILT_ALONG, p->yarn, 0);
    c += y->vary_tilt * FN(weave_random)(seed, p->base + WEAVE_VARY_TILT_ACROSS, p->yarn, 0);
  }
  if (y->vary_brightness > 0)
    light +=
        y->vary_brightness * FN(weave_random)(seed, p->base + WEAVE_VARY_BRIGHTNESS, p->yarn, 0);
  const real s = (real)p->crossing + p->s, f = y->along_frequency;
  if (y->along_tilt > 0) {
    a += y->along_tilt * FN(weave_along)(seed, p->base + WEAVE_ALONG_TILT_ALONG, p->yarn, s, f);
    c += y->along_tilt * FN(weave_along)(seed, p->base + WEAVE_ALONG_TILT_ACROSS, p->yarn, s, f);
  }
  if (y->along_brightness > 0)
    light += y->along_brightness *
             FN(weave_along)(seed, p->base + WEAVE_ALONG_BRIGHTNESS, p->yarn, s, f);
  FN(weave_clamp)(&a, &c);
  *along = a;
  *across = c;
  *brightness = FN(maximum)(light, 0);
}

static inline unsigned FN(weave_lookup)(const shade_weave *w, real u, real v,
                                        FN(shade_crossing) * out) {
  unsigned status = SHADE_OK;
  if (!isfinite(u) || !isfinite(v)) {
    status = SHADE_BAD_INPUT;
    u = isfinite(u) ? u : 0;
    v = isfinite(v) ? v : 0;
  }
  const shade_draft *d = w->draft;
  const int64_t iu = FN(weave_index)(u), iv = FN(weave_index)(v);
  const int end = (int)((iu % d->ends + d->ends) % d->ends);
  const int pick = (int)((iv % d->picks + d->picks) % d->picks);
  const real a = FN(weave_fract)(u), b = FN(weave_fract)(v);
  const weave_cell *cell = &w->cells[(size_t)pick * (size_t)d->ends + (size_t)end];
  const weave_thread *thread[2] = {&w->thread[SHADE_TOP_WEFT][pick],
                                   &w->thread[SHADE_TOP_WARP][end]};
  const FN(weave_point) point[2] = {FN(weave_place)(w, SHADE_TOP_WEFT, thread[0], iv, iu, a, b),
                                    FN(weave_place)(w, SHADE_TOP_WARP, thread[1], iu, iv, b, a)};
  const int upper = cell->warp_up ? SHADE_TOP_WARP : SHADE_TOP_WEFT;
  int hit[2];
  for (int k = 0; k < 2; k++)
    hit[k] = point[k].sigma >= -1 && point[k].sigma <= 1;
  const int seen = hit[upper] || !hit[!upper] ? upper : !upper;
  const FN(weave_point) *p = &point[seen];
  const FN(weave_yarn) *y = &w->FN(yarn)[seen];

  out->top = hit[seen] ? (shade_top)seen : SHADE_TOP_GAP;
  out->swap = seen == SHADE_TOP_WARP;
  out->below = !hit[upper];
  out->yarn = seen == SHADE_TOP_WARP ? end : pick;
  out->sigma = p->sigma;
  out->along = p->s;
  out->fuzz = 0;
  real along = 0, across = 0, cosine = y->fibre_cos, sine = y->fibre_sin;
  if (hit[seen]) {
    FN(weave_surface)
    (w, seen, p, cell->before[seen], cell->after[seen], (real)(seen == upper ? 1 : -1), &along,
     &across, &out->brightness);
    for (int c = 0; c < 3; c++)
      out->color[c] = thread[seen]->FN(rgb)[c];
  } else {
    out->fuzz = (real)w->fuzz;
    out->brightness = cosine = 1;
    out->color[0] = out->color[1] = out->color[2] = sine = 0;
  }
  out->dx = out->swap ? across : along;
  out->dy = out->swap ? along : across;
  out->tx = out->swap ? -sine : cosine;
  out->ty = out->swap ? cosine : sine;

  real light = 1;
  if (w->params.occlusion == SHADE_OCCLUSION_TILT)
    light = 1 - FN(root)(along * along + across * across);
  if (w->params.occlusion == SHADE_OCCLUSION_SKY) {
    if (hit[seen])
      light = FN(weave_sky)(y->curve, p->share, p->sigma);
    else
      light = FN(weave_sky_gap)(point[!upper].share, point[!upper].sigma);
    if (!hit[upper])
      light *= FN(weave_sky_gap)(point[upper].share, point[upper].sigma);
  }
  out->occlusion = light;
  return status;
}

static unsigned FN(weave_lookup_batch)(const shade_weave *w, size_t count, const real *u,
                                       const real *v, const FN(shade_crossings) * out) {
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < count; i++) {
    FN(shade_crossing) c;
    status |= FN(weave_lookup)(w, u[i], v[i], &c);
    const struct {
      int *to, from;
    } whole[] = {
        {out->top, (int)c.top}, {out->swap, c.swap}, {out->below, c.below}, {out->yarn, c.yarn}};
    const struct {
      real *to, from;
    } numbers[] = {{out->sigma, c.sigma},
                   {out->along, c.along},
                   {out->dx, c.dx},
                   {out->dy, c.dy},
                   {out->tx, c.tx},
                   {out->ty, c.ty},
                   {out->occlusion, c.occlusion},
                   {out->brightness, c.brightness},
                   {out->fuzz, c.fuzz},
                   {out->r, c.color[0]},
                   {out->g, c.color[1]},
                   {out->b, c.color[2]}};
    for (size_t k = 0; k < sizeof whole / sizeof whole[0]; k++)
      if (whole[k].to)
        whole[k].to[i] = whole[k].from;
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
      if (numbers[k].to)
        numbers[k].to[i] = numbers[k].from;
  }
  return status;
}
