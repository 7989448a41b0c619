/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Detail methods against a surface that is really displaced, as pictures.
 *
 * The truth is ray-cast: the eye's ray finds the displaced surface, a ray to the light finds
 * whether it is lit, and what is shaded is the facet, in its own frame, by the library's lobe
 * with no detail at all. Beside it the smooth base with the same bumps as normals, once per
 * method. Lights far away, an eye far away straight above, no second reflection.
 */
#include "program.h"

#include <stdlib.h>
#include <string.h>

/* To the lights. Under the first no facet of the plate shades another up to slopes of 1.37. */
static const vec SUNS[MOST_LIGHTS] = {
    {0.3, 0.5, 0.8}, {-0.75, 0.2, 0.65}, {0.7, -0.35, 0.6}, {-0.1, -0.8, 0.6}};

typedef struct tally {
  double seen, point, mean,
      energy; /* sums of |error|, of the same at the truth's points, of values */
} tally;

static double shaded(const shade_bsdf *b, vec n, vec wi, vec wo) {
  const double m[3] = {n.x, n.y, n.z}, i[3] = {wi.x, wi.y, wi.z}, o[3] = {wo.x, wo.y, wo.z};
  double f[3], cosine;
  shade_bsdf_eval(b, m, i, o, f, &cosine);
  return f[0] * cosine;
}

static vec local(vec x, vec y, vec z, vec w) {
  return (vec){dot(x, w), dot(y, w), dot(z, w)};
}

/* The facet's own frame: grooves along x follow dP/du, along y dP/dv. */
static double facet(const shade_bsdf *b, const place *at, int along_y, vec wi, vec wo) {
  vec x, y;
  if (along_y) {
    y = unit(at->dv);
    x = cross(y, at->n);
  } else {
    x = unit(at->du);
    y = cross(at->n, x);
  }
  return shaded(b, (vec){0, 0, 1}, local(x, y, at->n, wi), local(x, y, at->n, wo));
}

/* The base with the bumps as a normal. */
static double mapped(const shade_bsdf *b, const place *at, vec wi, vec wo) {
  return shaded(b, local(at->x, at->y, at->z, at->n), local(at->x, at->y, at->z, wi),
                local(at->x, at->y, at->z, wo));
}

typedef struct sample {
  double truth;
  int hit, base, lit[MOST_LIGHTS];
  place there, here; /* what the eye sees of the displaced surface, and of the base */
} sample;

static sample look(const scene *sc, double x, double y, const vec *suns, vec eye) {
  sample q = {0};
  const surface *s = &sc->surface;
  double u, v;
  const vec above = {x, y, (s->base == PLATE ? 0 : RADIUS) + s->top + 0.02};
  const double t = surface_cast(s, above, (vec){0, 0, -1});
  q.base = surface_base_seen(s, x, y, &u, &v);
  if (q.base)
    surface_at(s, u, v, &q.here);
  q.hit = t >= 0;
  if (q.hit) {
    surface_under(s, add(above, t, (vec){0, 0, -1}), &u, &v);
    surface_at(s, u, v, &q.there);
    for (int k = 0; k < sc->lights; k++) {
      q.lit[k] = dot(q.there.n, suns[k]) > 0 &&
                 surface_cast(s, add(q.there.p, 2e-5, q.there.n), suns[k]) < 0;
      q.truth += q.lit[k] ? facet(&sc->plain, &q.there, sc->along_y, suns[k], eye) : 0;
    }
  }
  return q;
}

int displaced_pictures(const scene *sc, const char *csv, const char *pfm) {
  const int size = sc->size, over = sc->over, across = sc->methods + 1;
  const vec eye = {0, 0, 1};
  vec suns[MOST_LIGHTS];
  for (int k = 0; k < MOST_LIGHTS; k++)
    suns[k] = unit(SUNS[k]);
  tally *of = calloc((size_t)sc->methods, sizeof *of);
  float *image = calloc((size_t)(size * size * across), sizeof *image);
  double *value = calloc((size_t)(2 * sc->methods + 1), sizeof *value);
  if (!of || !image || !value) {
    fputs("displaced: out of memory\n", stderr);
    free(of);
    free(image);
    free(value);
    return 1;
  }
  double half, middle_x, middle_y, total = 0, hits = 0;
  surface_window(&sc->surface, &half, &middle_x, &middle_y);
  for (int row = 0; row < size; row++)
    for (int column = 0; column < size; column++) {
      double truth = 0, *seen = value, *point = value + sc->methods;
      memset(value, 0, (size_t)(2 * sc->methods) * sizeof *value);
      for (int k = 0; k < over * over; k++) {
        const double x = (column + (k % over + 0.5) / over) / size;
        const double y = (row + (k / over + 0.5) / over) / size;
        const sample q =
            look(sc, middle_x + half * (2 * x - 1), middle_y + half * (2 * y - 1), suns, eye);
        truth += q.truth;
        hits += q.hit;
        for (int m = 0; m < sc->methods; m++)
          for (int i = 0; i < sc->lights; i++) {
            seen[m] += q.base ? mapped(&sc->bsdf[m], &q.here, suns[i], eye) : 0;
            point[m] += q.lit[i] ? mapped(&sc->bsdf[m], &q.there, suns[i], eye) : 0;
          }
      }
      const double each = 1. / (over * over);
      float *to = image + (size_t)row * (size_t)(size * across) + column;
      *to = (float)(each * truth);
      total += each * truth;
      for (int m = 0; m < sc->methods; m++) {
        to[(m + 1) * size] = (float)(each * seen[m]);
        of[m].seen += each * fabs(seen[m] - truth);
        of[m].point += each * fabs(point[m] - truth);
        of[m].energy += each * seen[m];
      }
    }
  text out = {0};
  text_line(
      &out,
      "base,bumps,slope,distribution,first,second,method,error,error_point,brightness,truth\n");
  for (int m = 0; m < sc->methods; m++)
    text_line(&out, "%s,%s,%.9g,%s,%.9g,%.9g,%s,%.9g,%.9g,%.9g,%.9g\n",
              base_words[sc->surface.base], bumps_words[sc->surface.bumps], sc->surface.slope,
              shade_list_word(SHADE_LIST_MDF, (int)sc->params.mdf), sc->first, sc->second,
              shade_list_word(SHADE_LIST_DETAIL, sc->method[m]), of[m].seen / total,
              of[m].point / total, of[m].energy / total, hits > 0 ? total / hits * over * over : 0);
  int status = text_write(&out, csv);
  if (status == 0 && pfm)
    status = pfm_write(pfm, image, size * across, size);
  free(of);
  free(image);
  free(value);
  return status;
}
