/* SPDX-License-Identifier: Apache-2.0 */
/* Setting up the tables of a mixture. */
#include "../model/fabric_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../model/bsdf.h"
#include "../batch/isa.h"

enum {
  MATT_VERTICES = FABRIC_MATT_SIDE * FABRIC_MATT_SIDE,
  EVEN_SIDE = (FABRIC_MATT_SIDE + 1) / 2, /* every other one is enough to weigh the lobes by */
  EVEN = EVEN_SIDE * EVEN_SIDE,
  TURNS = 16 /* of the iterations that find strips and diffuse factors */
};
#define LEAST_PER_WIDTH 14.0
#define PER_WIDTH 16.0 /* vertices a lobe's width 1/sqrt(exponent), over both sides of 0 */

/* The direction at a vertex, and the solid angle that goes with it. */
static double vertex(int i, int columns, int j, int rows, double w[3]) {
  /* X = +-1 and z = 0 are approached only */
  const double most = 1 - 1e-6;
  const double x = most * (2.0 * i / (columns - 1) - 1), y = most * (2.0 * j / (rows - 1) - 1);
  const double length = (1 - x * x) / (1 + x * x);
  w[0] = 2 * x / (1 + x * x);
  w[1] = length * 2 * y / (1 + y * y);
  w[2] = length * (1 - y * y) / (1 + y * y);
  return length * 2 / (1 + x * x) * 2 / (1 + y * y) * 4 / ((columns - 1.0) * (rows - 1.0));
}

/* Vertices for an exponent: odd, so that one stands at 0; 0 if those that there may be are too few.
 */
static int side_of(double exponent) {
  const double wanted = PER_WIDTH * sqrt(exponent + 2),
               least = LEAST_PER_WIDTH / PER_WIDTH * wanted;
  const double count = fmin(fmax(wanted + 1, FABRIC_LEAST_SIDE), FABRIC_MOST_SIDE);
  return least + 1 > FABRIC_MOST_SIDE ? 0 : (int)count | 1;
}

/* The exponent of Ashikhmin-Shirley, or as narrow. */
static double exponent_of(const bsdf *b, double k) {
  return b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? k : fmax(2 * k - 2, 0);
}

/* Lobes by their tilt: sine along the fibres, tangent across them, strip. */
typedef struct tilts {
  double along[FABRIC_FINE], across[FABRIC_FINE];
  float n[3][FABRIC_FINE];
  int strip[FABRIC_FINE];
} tilts;

/* Strips of even width by angle, then each lobe in turn to the strip whose mean is nearest. */
static void set_strips(fabric_table *t, const fabric_lobes *l, tilts *tilt) {
  double least = INFINITY, most = -INFINITY, weight[FABRIC_STRIPS], angle[FABRIC_STRIPS];
  for (size_t k = 0; k < l->count; k++) {
    const double length = hypot(l->n[0][k], l->n[2][k]);
    tilt->along[k] = l->n[0][k] / length;
    tilt->across[k] = l->n[1][k] / length;
    for (int c = 0; c < 3; c++)
      tilt->n[c][k] = (float)l->n[c][k];
    least = fmin(least, atan(tilt->across[k]));
    most = fmax(most, atan(tilt->across[k]));
  }
  for (int s = 0; s < FABRIC_STRIPS; s++)
    angle[s] = least + (most - least) * (s + 0.5) / FABRIC_STRIPS;
  for (int turn = 0; turn < TURNS; turn++) {
    double sum[FABRIC_STRIPS] = {0};
    memset(weight, 0, sizeof weight);
    for (size_t k = 0; k < l->count; k++) {
      const double own = atan(tilt->across[k]);
      int nearest = 0;
      for (int s = 1; s < FABRIC_STRIPS; s++)
        if (fabs(own - angle[s]) < fabs(own - angle[nearest]))
          nearest = s;
      tilt->strip[k] = nearest;
      weight[nearest] += l->weight[k];
      sum[nearest] += l->weight[k] * own;
    }
    for (int s = 0; s < FABRIC_STRIPS; s++)
      angle[s] = weight[s] > 0 ? sum[s] / weight[s] : angle[s];
  }
  for (int s = 0; s < FABRIC_STRIPS; s++) {
    double mean = 0, square = 0;
    for (size_t k = 0; k < l->count; k++)
      if (tilt->strip[k] == s) {
        mean += l->weight[k] / weight[s] * tilt->across[k];
        square += l->weight[k] / weight[s] * tilt->across[k] * tilt->across[k];
      }
    t->tilt[s] = (float)mean;
    t->spread[s] = (float)fmax(square - mean * mean, 0);
  }
}

/* The fields at h: D of each strip, then the mean and variance of the sine along the fibres. */
static void fields_at(const fabric_lobes *l, const tilts *tilt, const double h[3],
                      double fields[FABRIC_FIELDS]) {
  float d[FABRIC_FINE], same[3][FABRIC_FINE];
  double sum = 0, mean = 0, square = 0;
  for (int c = 0; c < 3; c++)
    for (size_t k = 0; k < l->count; k++)
      same[c][k] = (float)h[c];
  shade_isa_pick(0)->entriesf->mdf_batch(l->bsdf, l->count, tilt->n[0], tilt->n[1], tilt->n[2],
                                         same[0], same[1], same[2], d);
  memset(fields, 0, FABRIC_FIELDS * sizeof *fields);
  for (size_t k = 0; k < l->count; k++) {
    const double part = l->weight[k] * (double)d[k];
    fields[tilt->strip[k]] += part;
    sum += part;
    mean += part * tilt->along[k];
    square += part * tilt->along[k] * tilt->along[k];
  }
  if (!(sum > 1e-25)) { /* nothing to be seen: as if the lobes were there */
    fields[FABRIC_ALONG] = 1 + h[0] / hypot(h[0], h[2]);
    return;
  }
  mean /= sum;
  fields[FABRIC_ALONG] = 1 + mean;
  fields[FABRIC_VARIANCE] = fmax(square / sum - mean * mean, 0);
}

static void set_spec(fabric_table *t, const fabric_lobes *l, double (*all)[FABRIC_FIELDS]) {
  const int columns = t->columns, rows = t->rows;
  double most[FABRIC_FIELDS] = {0};
  tilts tilt;
  set_strips(t, l, &tilt);
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < columns; i++) {
      double h[3], *fields = all[j * columns + i];
      vertex(i, columns, j, rows, h);
      fields_at(l, &tilt, h, fields);
      for (int c = 0; c < FABRIC_FIELDS; c++)
        most[c] = fmax(most[c], fields[c]);
    }
  for (int c = 0; c < FABRIC_FIELDS; c++) {
    most[c] *= c < FABRIC_STRIPS ? 1.05 : 1; /* peaks are raised below */
    t->unit[c] = (float)(most[c] / UINT16_MAX);
    t->scale[c] = c < FABRIC_STRIPS ? t->unit[c] / 8 : 0; /* 1 / (4 h.wo), a mean over 2 */
  }
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < columns; i++) {
      const double *here = all[j * columns + i];
      for (int c = 0; c < FABRIC_FIELDS; c++) {
        double value = here[c], bend = 0;
        /* straight lines lie above a curve that bends upwards, by a twelfth of the bend on average
         */
        if (c < FABRIC_STRIPS && i > 0 && i < columns - 1)
          bend += here[c - FABRIC_FIELDS] - 2 * value + here[c + FABRIC_FIELDS];
        if (c < FABRIC_STRIPS && j > 0 && j < rows - 1)
          bend += all[(j - 1) * columns + i][c] - 2 * value + all[(j + 1) * columns + i][c];
        value = fmin(fmax(value - bend / 12, 0.5 * value), most[c]);
        t->spec[(j * columns + i) * FABRIC_FIELDS + c] =
            (uint16_t)(most[c] > 0 ? lrint(UINT16_MAX * (value / most[c])) : 0);
      }
    }
}

/* What the diffuse iteration works on: count x count matrices, and vectors of count. */
typedef struct factors {
  double a[FABRIC_MATT_LOBES][MATT_VERTICES],
      b[FABRIC_MATT_LOBES][MATT_VERTICES]; /* of wi and wo, by lobe */
  double inner[2][FABRIC_MATT_LOBES]
              [FABRIC_MATT_LOBES]; /* of a's rows, of b's, over the solid angle */
  double vector[FABRIC_RANK][FABRIC_MATT_LOBES], next[FABRIC_RANK][FABRIC_MATT_LOBES];
  double even[FABRIC_MATT_LOBES][EVEN], area[EVEN], made[FABRIC_RANK][MATT_VERTICES];
} factors;

static double product(const double *a, const double *b, size_t count) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (size_t k = 0; k < count; k++)
    sum += a[k] * b[k];
  return sum;
}

/* to = matrix from, with the weights of the lobes if there are any. */
static void apply(size_t count, double matrix[FABRIC_MATT_LOBES][FABRIC_MATT_LOBES],
                  const double *weight, const double *from, double *to) {
  for (size_t k = 0; k < count; k++)
    to[k] = (weight ? weight[k] : 1) * product(matrix[k], from, count);
}

static void set_lanes(shade_lanes *lanes, const double *const wi[3], const double *const wo[3]) {
  lanes->wix = wi[0];
  lanes->wiy = wi[1];
  lanes->wiz = wi[2];
  lanes->wox = wo[0];
  lanes->woy = wo[1];
  lanes->woz = wo[2];
}

/* The diffuse part of each lobe for light from w alone, and for an eye there. */
static void look_matt(const fabric_lobes *l, factors *f) {
  double w[3][FABRIC_MATT_LOBES], spec[FABRIC_MATT_LOBES], matt[FABRIC_MATT_LOBES],
      own[FABRIC_MATT_LOBES];
  const double *const *n = l->n;
  const shade_isa_table *isa = shade_isa_pick(0);
  shade_lanes lanes = {.size = sizeof lanes, .nx = n[0], .ny = n[1], .nz = n[2]};
  set_lanes(&lanes, n, n);
  isa->entries->yarn(l->bsdf, l->count, &lanes, spec, own);
  for (int at = 0; at < MATT_VERTICES; at++) {
    double v[3];
    vertex(at % FABRIC_MATT_SIDE, FABRIC_MATT_SIDE, at / FABRIC_MATT_SIDE, FABRIC_MATT_SIDE, v);
    for (size_t k = 0; k < l->count; k++)
      for (int c = 0; c < 3; c++)
        w[c][k] = v[c];
    const double *const there[3] = {w[0], w[1], w[2]};
    set_lanes(&lanes, there, n);
    isa->entries->yarn(l->bsdf, l->count, &lanes, spec, matt);
    for (size_t k = 0; k < l->count; k++)
      f->a[k][at] = matt[k];
    set_lanes(&lanes, n, there);
    isa->entries->yarn(l->bsdf, l->count, &lanes, spec, matt);
    for (size_t k = 0; k < l->count; k++)
      f->b[k][at] = own[k] > 0 ? matt[k] / own[k] : 0;
  }
}

/* As in set_spec: lines between vertices are to be right on average. */
static void unbend(double values[MATT_VERTICES]) {
  double bend[MATT_VERTICES] = {0};
  for (int j = 0; j < FABRIC_MATT_SIDE; j++)
    for (int i = 0; i < FABRIC_MATT_SIDE; i++) {
      const double *here = &values[j * FABRIC_MATT_SIDE + i];
      if (i > 0 && i < FABRIC_MATT_SIDE - 1)
        bend[here - values] += here[-1] - 2 * *here + here[1];
      if (j > 0 && j < FABRIC_MATT_SIDE - 1)
        bend[here - values] += here[-FABRIC_MATT_SIDE] - 2 * *here + here[FABRIC_MATT_SIDE];
    }
  for (int at = 0; at < MATT_VERTICES; at++)
    values[at] -= bend[at] / 12;
}

/*
 * M(wi, wo) = sum of weight a(wi) b(wo). The best subspace for wo, orthonormal over the solid
 * angle, by iteration with M^T M, in coefficients of the b; M projected on it.
 */
static void set_matt(fabric_table *t, const fabric_lobes *l, factors *f) {
  const size_t n = l->count;
  double turned[EVEN], unused[3];
  look_matt(l, f);
  for (int at = 0; at < EVEN; at++)
    f->area[at] = vertex(at % EVEN_SIDE, EVEN_SIDE, at / EVEN_SIDE, EVEN_SIDE, unused);
  for (int side = 0; side < 2; side++) {
    for (size_t i = 0; i < n; i++)
      for (int at = 0; at < EVEN; at++)
        f->even[i][at] =
            (side ? f->b : f->a)[i][at / EVEN_SIDE * 2 * FABRIC_MATT_SIDE + at % EVEN_SIDE * 2];
    for (size_t i = 0; i < n; i++) {
      for (int at = 0; at < EVEN; at++)
        turned[at] = f->even[i][at] * f->area[at];
      for (size_t j = 0; j <= i; j++)
        f->inner[side][i][j] = f->inner[side][j][i] = product(turned, f->even[j], EVEN);
    }
  }
  for (int r = 0; r < FABRIC_RANK; r++)
    for (size_t k = 0; k < n; k++) /* any four that differ */
      f->vector[r][k] = l->weight[k] * cos(3.14159 * r * ((double)k + 0.5) / (double)n);
  for (int turn = 0; turn <= TURNS; turn++)
    for (int r = 0; r < FABRIC_RANK; r++) {
      double *v = f->vector[r], *image = f->next[r], room[FABRIC_MATT_LOBES];
      if (turn < TURNS) {
        apply(n, f->inner[1], l->weight, v, room);
        apply(n, f->inner[0], l->weight, room, v);
      }
      for (int pass = 0; pass < 2; pass++)
        for (int q = 0; q < r; q++) {
          const double share = product(f->next[q], v, n);
          for (size_t k = 0; k < n; k++)
            v[k] -= share * f->vector[q][k];
        }
      apply(n, f->inner[1], NULL, v, image);
      const double length2 = product(v, image, n);
      /* fewer lobes than factors, or all alike: nothing is left */
      const double scale = length2 > 1e-24 ? 1 / sqrt(length2) : 0;
      for (size_t k = 0; k < n; k++) {
        v[k] *= scale;
        image[k] *= scale;
      }
    }
  for (int side = 0; side < 2; side++) {
    double most[FABRIC_RANK], (*made)[MATT_VERTICES] = f->made;
    memset(f->made, 0, sizeof f->made);
    for (int r = 0; r < FABRIC_RANK; r++) {
      most[r] = 0;
      for (size_t k = 0; k < n; k++) {
        const double c = side ? f->vector[r][k] : l->weight[k] * f->next[r][k];
        const double *row = side ? f->b[k] : f->a[k];
        for (int at = 0; at < MATT_VERTICES; at++)
          made[r][at] += c * row[at];
      }
      unbend(made[r]);
      for (int at = 0; at < MATT_VERTICES; at++)
        most[r] = fmax(most[r], fabs(made[r][at]));
      t->matt_unit[r] *= (float)(most[r] / INT16_MAX);
      most[r] = most[r] > 0 ? 1 / most[r] : 0;
    }
    for (int at = 0; at < MATT_VERTICES; at++)
      for (int r = 0; r < FABRIC_RANK; r++)
        t->matt[side][at * FABRIC_RANK + r] = (int16_t)lrint(INT16_MAX * most[r] * made[r][at]);
  }
}

int shade_fabric_table_models(const shade_bsdf *lobe) {
  const bsdf *b = bsdf_of(lobe);
  return side_of(exponent_of(b, b->numbers.kx)) && side_of(exponent_of(b, b->numbers.ky)) &&
         b->brdf == SHADE_BRDF_ASHIKHMIN_SHIRLEY && b->carry.map != SHADE_MAP_NONE &&
         b->detail != SHADE_DETAIL_PERTURB && b->diffuse != SHADE_DIFFUSE_FIBRE_VIEW &&
         b->diffuse != SHADE_DIFFUSE_POULIN_FOURNIER;
}

fabric_table *shade_fabric_table_create(const fabric_lobes *spec, const fabric_lobes *matt) {
  if (!shade_fabric_table_models(spec->bsdf) || !shade_fabric_table_models(matt->bsdf) ||
      !spec->count || spec->count > FABRIC_FINE || !matt->count || matt->count > FABRIC_MATT_LOBES)
    return NULL;
  const bsdf *b = bsdf_of(spec->bsdf);
  const int columns = side_of(exponent_of(b, b->numbers.kx)),
            rows = side_of(exponent_of(b, b->numbers.ky));
  const size_t vertices = (size_t)columns * (size_t)rows;
  const size_t size = FABRIC_FIELDS * vertices + 2 * FABRIC_RANK * MATT_VERTICES;
  fabric_table *t = calloc(1, sizeof *t);
  uint16_t *words = malloc(size * sizeof *words);
  double(*all)[FABRIC_FIELDS] = malloc(vertices * sizeof *all);
  factors *room = malloc(sizeof *room);
  if (t && words && all && room) {
    t->columns = columns;
    t->rows = rows;
    t->bytes = sizeof *t + size * sizeof *words;
    t->spec = words;
    t->matt[0] = (int16_t *)words + FABRIC_FIELDS * vertices;
    t->matt[1] = t->matt[0] + FABRIC_RANK * MATT_VERTICES;
    for (int r = 0; r < FABRIC_RANK; r++)
      t->matt_unit[r] = 1;
    set_spec(t, spec, all);
    set_matt(t, matt, room);
  } else {
    free(t);
    free(words);
    t = NULL;
  }
  free(all);
  free(room);
  return t;
}

void shade_fabric_table_free(fabric_table *table) {
  if (table)
    free(table->spec);
  free(table);
}
