/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A rough interface between air and a clear body: GGX, or `beckmann`'s, with exact Fresnel
 * [Walter2007].
 *
 * `ior` and `alpha` are an operand each, and `tint`, three, is the colour of what is refracted.
 * `reflects` and `refracts` say whether it does. If it refracts only, it has no Fresnel. `joint`
 * is Smith's shadowing of both directions together, as Cycles has it from 4.0 on. Without it each
 * direction has its own [Heitz2014]. With `flat` Fresnel is that of the surface and not of its
 * facets, as Cycles had it until then.
 *
 * `film_thickness`, in nm, and `film_ior` are an operand each. With them a thin film reflects
 * (node/interference.h), by colour, and the rest is refracted. From inside a body the film's index
 * counts over that of the body, but its thickness stays, as in Cycles: the colours are those of a
 * film that is so much thinner.
 *
 * `mirror_tint`, three, is the colour of what is reflected head-on, and the rest is refracted. With
 * `straight` what would be reflected goes on, mirrored by the surface, as through a thin pane.
 *
 * As in Cycles, refraction does not scale radiance by the squared indices. So a ray never carries
 * more than before, and light that enters a body and leaves it is the same either way.
 */
#ifndef LIBSHADE_CLOSURE_GLASS_H
#define LIBSHADE_CLOSURE_GLASS_H

#include "closure/common.h"
#include "node/interference.h"
#include "node/common.h"
#include "node/dielectric.h"

typedef struct closure_glass {
  operand ior, alpha, tint[3];
  bool reflects, refracts, joint, flat, beckmann, straight;
  thin_film film; /* its thickness and index; the body's is `ior` */
  bool hued;
  operand hue[3];
  int normal[3];
} closure_glass;

static inline bool closure_glass_read(reader *r, closure_glass *c, graph *g) {
  c->film = (thin_film){.there = reader_has(r, "film_thickness")};
  if (c->film.there && !((c->film.table = thin_film_table(r)) &&
                         graph_operands(r, g, "film_thickness", 1, &c->film.thickness) &&
                         graph_operands(r, g, "film_ior", 1, &c->film.ior)))
    return false;
  c->hued = reader_has(r, "mirror_tint");
  if (c->hued && !graph_operands(r, g, "mirror_tint", 3, c->hue))
    return false;
  if (!graph_operands(r, g, "ior", 1, &c->ior) || !graph_operands(r, g, "alpha", 1, &c->alpha) ||
      !graph_operands(r, g, "tint", 3, c->tint) || !reader_flag(r, "reflects", &c->reflects) ||
      !reader_flag(r, "refracts", &c->refracts) || !reader_flag(r, "joint", &c->joint) ||
      !reader_may_flag(r, "flat", &c->flat) || !reader_may_flag(r, "beckmann", &c->beckmann) ||
      !reader_may_flag(r, "straight", &c->straight))
    return false;
  const bool sharp = c->alpha.at < 0 && (double)c->alpha.number <= CLOSURE_LEAST_ALPHA;
  g->exponent = alpha_exponent(c->alpha);
  g->focus = 1;
  g->traits |= (c->refracts || c->straight ? CLOSURE_THROUGH : 0u) | (sharp ? CLOSURE_SHARP : 0u);
  return graph_normal(r, g, c->normal);
}

/* Smith's Lambda of GGX for a direction with this cosine from the normal. */
LEAF float glass_lambda(float cosine, float alpha) {
  float c2 = cosine * cosine;
  c2 = c2 > 1e-12f ? c2 : 1e-12f;
  float tan2 = (1.0f - c2) / c2;
  tan2 = tan2 > 0.0f ? tan2 : 0.0f;
  return 0.5f * (sqrtf(1.0f + alpha * alpha * tan2) - 1.0f);
}

/* Beckmann's, a fit to .4 % [Walter2007]. */
LEAF float glass_beckmann_lambda(float cosine, float alpha) {
  float c2 = clampf(cosine * cosine, 1e-12f, 1.0f), sine2 = 1.0f - c2;
  float a = sqrtf(c2 / (sine2 > 1e-12f ? sine2 : 1e-12f)) / alpha;
  float fit = (1.0f + a * (-1.259f + a * 0.396f)) / (a * (3.535f + a * 2.181f));
  return a < 1.6f ? fit : 0.0f;
}

/* Microfacets whose h is inclined by this, of GGX or Beckmann. off2: squared sine. */
LEAF float glass_facets(bool beckmann, float alpha, float nh, float off2) {
  float a2 = alpha * alpha, n2 = nh * nh;
  if (beckmann) {
    n2 = n2 > 1e-12f ? n2 : 1e-12f;
    return exponential2(-1.44269504f * off2 / (n2 * a2)) / (3.14159265f * a2 * n2 * n2);
  }
  float spread = off2 + a2 * n2;
  return a2 / (3.14159265f * spread * spread);
}

/* Does it split light by colour? */
LEAF bool glass_is_colored(const closure_glass *c) {
  return (c->film.there || c->hued) && c->reflects && c->refracts;
}

/* What it does, as factors: loops without branches. */
typedef struct glass_kind {
  float both, mirror, clear; /* which of three: Fresnel decides, all is reflected, or refracted */
  float joint, flat, straight;
  float film; /* shares are left to glass_film */
} glass_kind;
static inline glass_kind glass_kind_of(const closure_glass *c) {
  return (glass_kind){.both = c->reflects && c->refracts,
                      .mirror = c->reflects && !c->refracts,
                      .clear = !c->reflects,
                      .joint = c->joint,
                      .flat = c->flat,
                      .straight = c->straight,
                      .film = glass_is_colored(c)};
}

/* A direction, mirrored by the surface where all goes on straight. */
LEAF vec3 glass_straight(const glass_kind *c, vec3 n, vec3 l) {
  float by = -2.0f * c->straight * dot(n, l);
  return (vec3){l.x + by * n.x, l.y + by * n.y, l.z + by * n.z};
}

typedef struct glass_terms {
  float reflected, refracted, pdf; /* f cos */
} glass_terms;

/* Which share is reflected where both is done; `own`: at the facet. */
LEAF float glass_mirrored(const glass_kind *c, float own, float no, float eta) {
  float t, whole = dielectric_fresnel(clampf(no, 0.0f, 1.0f), eta, &t);
  return own + c->flat * (whole - own);
}

/* For a microfacet h with h.n, h.wo > 0; `through`: wi lies beyond. */
LEAF glass_terms glass_of(bool beckmann, const glass_kind *c, float alpha, float eta, vec3 n,
                          vec3 h, float ho, float hi, float no, float ni, bool through) {
  float nh = dot(n, h), t;
  vec3 off = {h.x - nh * n.x, h.y - nh * n.y, h.z - nh * n.z};
  float d = glass_facets(beckmann, alpha, nh, dot(off, off));
  float fresnel = dielectric_fresnel(ho, eta, &t);
  fresnel = c->both * glass_mirrored(c, fresnel, no, eta) + c->mirror +
            c->clear * (fresnel < 1.0f ? 0.0f : 1.0f);
  float lo = beckmann ? glass_beckmann_lambda(no, alpha) : glass_lambda(no, alpha);
  float li = beckmann ? glass_beckmann_lambda(ni, alpha) : glass_lambda(ni, alpha);
  float first = 1.0f / (1.0f + lo);
  float both = first / (1.0f + li), together = 1.0f / (1.0f + lo + li);
  both += c->joint * (together - both);
  float down = ho + eta * hi;
  float beyond = eta * eta * fabsf(hi) * ho / (down * down + 1e-30f);
  float jacobian = through ? beyond : 0.25f;
  float per_facet = d * jacobian / no;
  float share = through ? 1.0f - fresnel : (1.0f - c->clear) * fresnel;
  share += c->film * (1.0f - share);
  bool there = (nh > 0.0f) & (ho > 0.0f) & (no > 0.0f) & ((hi < 0.0f) == through);
  per_facet = there ? per_facet * share : 0.0f;
  return (glass_terms){.reflected = through ? 0.0f : per_facet * both,
                       .refracted = through ? per_facet * both : 0.0f,
                       /* of visible facets, or of all by their cosine */
                       .pdf = per_facet * (beckmann ? no * nh / (ho > 1e-6f ? ho : 1e-6f) : first)};
}

/* What it reads of a run's points. */
typedef struct glass_lanes {
  const float *ior, *alpha, *tint[3];
} glass_lanes;

static inline glass_lanes glass_lanes_of(const closure_glass *c, inputs *given, lane_run run) {
  glass_lanes lanes = {.ior = lane_of(given, c->ior, 3, run),
                       .alpha = alpha_lane(given, c->alpha, 4, 0, run)};
  for (int k = 0; k < 3; k++)
    lanes.tint[k] = lane_of(given, c->tint[k], k, run);
  return lanes;
}

LEAF void glass_store(const glass_lanes *from, size_t i, glass_terms terms, lane_c *f) {
  f->r[i] = terms.reflected + terms.refracted * from->tint[0][i];
  f->g[i] = terms.reflected + terms.refracted * from->tint[1][i];
  f->b[i] = terms.reflected + terms.refracted * from->tint[2][i];
}

LEAF void glass_eval(bool beckmann, const closure_glass *glass, lane_run run,
                     const surfaces *restrict at, inputs *given, const lane_v *restrict wi,
                     reflections *restrict out) {
  const closure_glass own = *glass;
  const glass_kind what = glass_kind_of(glass);
  const glass_lanes from = glass_lanes_of(glass, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, own.normal, i), there = load(wi, i), v = load(&at->wo, i);
    vec3 l = glass_straight(&what, n, there);
    float alpha = clampf(from.alpha[i], 1e-4f, 1.0f);
    float eta = dielectric_eta(from.ior[i], at->side[i]);
    float ni = dot(n, l), no = dot(n, v);
    bool through = ni < 0.0f;
    float by = through ? eta : 1.0f;
    vec3 h = {v.x + by * l.x, v.y + by * l.y, v.z + by * l.z};
    float square = dot(h, h), up = dot(h, n) < 0.0f ? -1.0f : 1.0f;
    h = scaled(h, up / sqrtf(square > 1e-20f ? square : 1e-20f));
    glass_terms terms =
        glass_of(beckmann, &what, alpha, eta, n, h, dot(h, v), dot(h, l), no, fabsf(ni), through);
    float z = there.z * (1.0f - 2.0f * what.straight);
    bool sided = through ? z < 0.0f : z > 0.0f;
    terms.reflected = sided ? terms.reflected : 0.0f;
    terms.refracted = sided ? terms.refracted : 0.0f;
    glass_store(&from, i, terms, &out->f);
    out->cosine[i] = 1.0f; /* it is in f */
    out->pdf[i] = sided ? terms.pdf : 0.0f;
  }
}

/* FILM_ROOM rays' facets at most: cosines of their angles, and what they reflect there. */
typedef struct glass_film {
  float cosine[FILM_ROOM], color[3][FILM_ROOM], mean[FILM_ROOM];
} glass_film;

/* A tint's part in the colours, from head-on to where all is reflected; beside a film it tints what
 * that reflects, as in Cycles 5.0. */
LEAF void glass_film_hue(const closure_glass *c, lane_run run, inputs *given,
                         const float *restrict body, glass_film *restrict f) {
  const bool filmed = c->film.there;
  const size_t count = run.end - run.begin;
  for (int k = 0; k < 3; k++) {
    const float *hue = lane_of(given, c->hue[k], 7 + k, run) + run.begin;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      float root = (body[i] - 1.0f) / (body[i] + 1.0f), head_on = root * root;
      float tint = clampf(hue[i], 0.0f, 1.0f), all = f->color[k][i];
      float rest = clampf((all - head_on) / (1.0f - head_on), 0.0f, 1.0f);
      f->color[k][i] = filmed ? all * lerp(tint, 1.0f, rest) : lerp(head_on * tint, 1.0f, rest);
    }
  }
}

/* Fills in what is reflected. */
LEAF void glass_film_reflects(const closure_glass *c, lane_run run, const surfaces *restrict at,
                              inputs *given, glass_film *restrict f) {
  const size_t count = run.end - run.begin;
  const float *ior = lane_of(given, c->ior, 3, run) + run.begin;
  const float *index = NULL, *thick = NULL;
  if (c->film.there) {
    index = lane_of(given, c->film.ior, 5, run) + run.begin;
    thick = lane_of(given, c->film.thickness, 6, run) + run.begin;
  }
  const float *side = at->side + run.begin;
  float body[FILM_ROOM], film[FILM_ROOM], clear[FILM_ROOM];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float t;
    body[i] = dielectric_eta(ior[i], side[i]);
    clear[i] = 0.0f;
    f->color[0][i] = f->color[1][i] = f->color[2][i] =
        dielectric_fresnel(f->cosine[i], body[i], &t);
  }
  if (c->film.there) {
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      film[i] = side[i] < 0.0f ? index[i] * body[i] : index[i];
    const thin_film_lanes from = {.thickness = thick,
                                  .ior = film,
                                  .eta = {body, body, body},
                                  .k = {clear, clear, clear},
                                  .table = c->film.table};
    for (int k = 0; k < 3; k++)
      thin_film_reflects(false, &from, k, 0, count, f->cosine, f->color[k]);
  }
  if (c->hued)
    glass_film_hue(c, run, given, body, f);
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    f->mean[i] = (f->color[0][i] + f->color[1][i] + f->color[2][i]) * (1.0f / 3.0f);
}

/* f and density of each way by what goes it. */
LEAF void glass_film_parts(const closure_glass *c, lane_run run, const inputs *given,
                           const glass_film *restrict film, const lane_v *restrict wi,
                           lane_c *restrict f, float *restrict pdf) {
  const closure_glass own = *c;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    size_t at = i - run.begin;
    bool through = dot(normal_at(given, own.normal, i), load(wi, i)) < 0.0f;
    float base = through ? 1.0f : 0.0f, by = through ? -1.0f : 1.0f;
    f->r[i] *= base + by * film->color[0][at];
    f->g[i] *= base + by * film->color[1][at];
    f->b[i] *= base + by * film->color[2][at];
    pdf[i] *= base + by * film->mean[at];
  }
}

/* The facets' angles to the eye that directions say. */
LEAF void glass_film_half(const closure_glass *c, lane_run run, const surfaces *restrict at,
                          inputs *given, const lane_v *restrict wi, glass_film *restrict f) {
  const closure_glass own = *c;
  const float *ior = lane_of(given, c->ior, 3, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 l = load(wi, i);
    float both = dot(l, load(&at->wo, i));
    float eta = dielectric_eta(ior[i], at->side[i]);
    float by = dot(normal_at(given, own.normal, i), l) < 0.0f ? eta : 1.0f;
    float square = 1.0f + by * (by + 2.0f * both);
    f->cosine[i - run.begin] =
        clampf(fabsf(1.0f + by * both) / sqrtf(square > 1e-20f ? square : 1e-20f), 0.0f, 1.0f);
  }
}

LEAF unsigned closure_glass_eval(const closure_glass *c, lane_run run, const surfaces *restrict at,
                                 inputs *given, const lane_v *restrict wi, bool density,
                                 reflections *restrict out) {
  (void)density;
  if (c->beckmann)
    glass_eval(true, c, run, at, given, wi, out);
  else
    glass_eval(false, c, run, at, given, wi, out);
  for (size_t begin = run.begin; glass_is_colored(c) && begin < run.end; begin += FILM_ROOM) {
    size_t end = run.end - begin < FILM_ROOM ? run.end : begin + FILM_ROOM;
    lane_run part = {begin, end};
    glass_film film;
    glass_film_half(c, part, at, given, wi, &film);
    glass_film_reflects(c, part, at, given, &film);
    glass_film_parts(c, part, given, &film, wi, &out->f, out->pdf);
  }
  return 0;
}

/* A microfacet in the frame of the normal that the eye, v there, sees [Heitz2018,
 * DupuyBenyoub2023]. */
LEAF vec3 glass_visible(float alpha, vec3 v, float x, float y) {
  vec3 w = {alpha * v.x, alpha * v.y, v.z};
  w = scaled(w, 1.0f / sqrtf(dot(w, w) + 1e-30f));
  float s, c, z = (1.0f - x) * (1.0f + w.z) - w.z;
  float sine = sqrtf(clampf(1.0f - z * z, 0.0f, 1.0f));
  turn(y, &s, &c);
  vec3 m = {alpha * (sine * c + w.x), alpha * (sine * s + w.y), clampf(z + w.z, 0.0f, 2.0f)};
  return scaled(m, 1.0f / sqrtf(dot(m, m) + 1e-30f));
}

/* Any of Beckmann's, by its cosine. */
LEAF vec3 glass_beckmann_facet(float alpha, float x, float y) {
  float s, c, tan2 = -0.69314718f * alpha * alpha * logarithm2(1.0f - x);
  float z = 1.0f / sqrtf(1.0f + tan2), sine = sqrtf(clampf(tan2, 0.0f, 1e12f)) * z;
  turn(y, &s, &c);
  return (vec3){sine * c, sine * s, z};
}

/* A microfacet. */
LEAF vec3 glass_facet(bool beckmann, float alpha, vec3 n, vec3 v, float x, float y) {
  vec3 a, b;
  across(n, &a, &b);
  vec3 seen = {dot(v, a), dot(v, b), dot(n, v)};
  vec3 m = beckmann ? glass_beckmann_facet(alpha, x, y) : glass_visible(alpha, seen, x, y);
  return (vec3){m.x * a.x + m.y * b.x + m.z * n.x, m.x * a.y + m.y * b.y + m.z * n.y,
                m.x * a.z + m.y * b.z + m.z * n.z};
}

/* A microfacet, then which way light goes at it; film: NULL, or what that reflects. */
LEAF void glass_draw(bool beckmann, const closure_glass *glass, lane_run run,
                     const surfaces *restrict at, inputs *given, const glass_film *restrict film,
                     draws *restrict out) {
  const closure_glass own = *glass;
  const glass_kind what = glass_kind_of(glass);
  const glass_lanes from = glass_lanes_of(glass, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, own.normal, i), v = load(&at->wo, i);
    float alpha = clampf(from.alpha[i], 1e-4f, 1.0f);
    float eta = dielectric_eta(from.ior[i], at->side[i]);
    vec3 h = glass_facet(beckmann, alpha, n, v, out->x[i], out->y[i]);
    float no = dot(n, v), ho = dot(h, v), t;
    float fresnel = dielectric_fresnel(ho, eta, &t);
    float share = film ? film->mean[i - run.begin]
                       : what.both * glass_mirrored(&what, fresnel, no, eta) + what.mirror;
    bool bends = fresnel < 1.0f, turned = (out->choice[i] < share) | !(bends | (what.flat > 0.0f));
    float inverse = 1.0f / eta, bent = ho * inverse - t;
    float along = turned ? 2.0f * ho : bent, back = turned ? 1.0f : inverse;
    vec3 l = {along * h.x - back * v.x, along * h.y - back * v.y, along * h.z - back * v.z};
    float ni = dot(n, l);
    l = glass_straight(&what, n, l);
    bool sided = (l.z * (1.0f - 2.0f * what.straight) > 0.0f) == turned;
    bool good = (ho > 0.0f) & (no > 0.0f) & ((ni > 0.0f) == turned) & sided & (turned | bends);
    glass_terms terms =
        glass_of(beckmann, &what, alpha, eta, n, h, ho, turned ? ho : -t, no, fabsf(ni), !turned);
    glass_store(&from, i, terms, &out->f);
    store(&out->wi, i, l);
    out->cosine[i] = 1.0f;
    out->pdf[i] = good ? terms.pdf : 0.0f;
  }
}

/* The angles of the facets that will be drawn. */
LEAF void glass_film_meet(bool beckmann, const closure_glass *glass, lane_run run,
                          const surfaces *restrict at, inputs *given, const draws *restrict out,
                          glass_film *restrict f) {
  const closure_glass own = *glass;
  const glass_lanes from = glass_lanes_of(glass, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, own.normal, i), v = load(&at->wo, i);
    float alpha = clampf(from.alpha[i], 1e-4f, 1.0f);
    vec3 h = glass_facet(beckmann, alpha, n, v, out->x[i], out->y[i]);
    f->cosine[i - run.begin] = clampf(dot(h, v), 0.0f, 1.0f);
  }
}

LEAF void glass_film_draw(bool beckmann, const closure_glass *c, lane_run run,
                          const surfaces *restrict at, inputs *given, draws *restrict out) {
  for (size_t begin = run.begin; begin < run.end; begin += FILM_ROOM) {
    size_t end = run.end - begin < FILM_ROOM ? run.end : begin + FILM_ROOM;
    lane_run part = {begin, end};
    glass_film film;
    glass_film_meet(beckmann, c, part, at, given, out, &film);
    glass_film_reflects(c, part, at, given, &film);
    glass_draw(beckmann, c, part, at, given, &film, out);
    glass_film_parts(c, part, given, &film, &out->wi, &out->f, out->pdf);
  }
}

LEAF unsigned closure_glass_draw(const closure_glass *c, lane_run run, const surfaces *restrict at,
                                 inputs *given, draws *restrict out) {
  if (glass_is_colored(c) && c->beckmann)
    glass_film_draw(true, c, run, at, given, out);
  else if (glass_is_colored(c))
    glass_film_draw(false, c, run, at, given, out);
  else if (c->beckmann)
    glass_draw(true, c, run, at, given, NULL, out);
  else
    glass_draw(false, c, run, at, given, NULL, out);
  return 0;
}

LEAF void closure_glass_albedo(const closure_glass *c, lane_run run, const surfaces *at,
                               inputs *given, float *out) {
  (void)c, (void)at, (void)given;
  for (size_t i = run.begin; i < run.end; i++)
    out[i] = 1.0f;
}

#endif
