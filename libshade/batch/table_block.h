/* SPDX-License-Identifier: Apache-2.0 */
/* The tables of src/fabric_table.h over arrays. */
#ifndef SHADE_BATCH_TABLE_BLOCK_H
#define SHADE_BATCH_TABLE_BLOCK_H

#include "../model/table.h"
#include "vec.h"

typedef struct table_place {
  _Alignas(64) int32_t at[BLOCK];
  ROOM x[BLOCK], y[BLOCK];
} table_place;

/*
 * n as a number that compilers do not know: of bounds they know, gcc makes a branch for each order
 * of what is between them, and of those several masks a lane, where two instructions would do.
 */
LEAF real table_bound(const fabric_table *table, int n) {
  return (real)(table->columns > 0 ? n : 0);
}

/* Of the diffuse part; last: its last column and row. */
static void pass_table_find(size_t count, vec v, real last, table_place *restrict p) {
  ARRAYS(v);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const table_spot spot = table_find(vx[i], vy[i], vz[i], 1, last, last, FABRIC_MATT_SIDE);
    p->at[i] = spot.at;
    p->x[i] = spot.x;
    p->y[i] = spot.y;
  }
}

/*
 * All fields of a vertex lie side by side, and a lane takes them at once: this is a third of the
 * time of a gather for each, also where there are wide ones.
 */
#define TABLE_FETCH(name, type, fields)                                                            \
  LEAF void table_##name(const type *restrict table, int columns, table_spot p,                    \
                         real *restrict to) {                                                      \
    const type *low = table + (size_t)p.at * fields, *high = low + (size_t)columns * fields;       \
    ROOM v[2 * fields];                                                                            \
    _Pragma("omp simd") for (int k = 0; k < 2 * fields; k++) {                                     \
      const real a = (real)low[k], b = (real)high[k];                                              \
      v[k] = a + p.y * (b - a);                                                                    \
    }                                                                                              \
    _Pragma("omp simd") for (int k = 0; k < fields; k++) to[k] =                                   \
        v[k] + p.x * (v[fields + k] - v[k]);                                                       \
  }                                                                                                \
  static void pass_table_##name(size_t count, const type *restrict table, int columns,             \
                                const table_place *restrict p, real(*restrict to)[fields]) {       \
    for (size_t i = 0; i < count; i++) {                                                           \
      const table_spot spot = {p->at[i], p->x[i], p->y[i]};                                        \
      table_##name(table, columns, spot, to[i]);                                                   \
    }                                                                                              \
  }
TABLE_FETCH(fetch_spec, uint16_t, FABRIC_FIELDS)
TABLE_FETCH(fetch_matt, int16_t, FABRIC_RANK)
#undef TABLE_FETCH

/* The same of h = wi + wo, of any length. */
static void pass_table_find_half(size_t count, vec wi, vec wo, int columns, int rows,
                                 table_place *restrict p) {
  ARRAYS(wi);
  ARRAYS(wo);
  const real right = (real)(columns - 1), top = (real)(rows - 1);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const real x = wix[i] + wox[i], y = wiy[i] + woy[i], z = wiz[i] + woz[i];
    const real size = root(x * x + y * y + z * z);
    const table_spot spot = table_find(x, y, z, size, right, top, columns);
    p->at[i] = spot.at;
    p->x[i] = spot.x;
    p->y[i] = spot.y;
  }
}

static void pass_table_spec(const fabric_table *table, size_t count,
                            real (*restrict f)[FABRIC_FIELDS], vec wi, vec wo,
                            real *restrict spec) {
  ARRAYS(wi);
  ARRAYS(wo);
  const real sine = (real)table->unit[FABRIC_ALONG], square = (real)table->unit[FABRIC_VARIANCE];
  table_strips low, high;
  low.one = high.one = table_bound(table, 1);
  for (int k = 0; k < 3; k++) {
    low.d[k] = (real)table->scale[k];
    low.tilt[k] = (real)table->tilt[k];
    low.spread[k] = (real)table->spread[k];
    high.d[k] = (real)table->scale[k + 3];
    high.tilt[k] = (real)table->tilt[k + 3];
    high.spread[k] = (real)table->spread[k + 3];
  }
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const table_turned v =
        table_turn(wix[i], wiy[i], wiz[i], wox[i], woy[i], woz[i], sine * f[i][FABRIC_ALONG] - 1,
                   square * f[i][FABRIC_VARIANCE]);
    const real sum = table_three(v, low, f[i][0], f[i][1], f[i][2]) +
                     table_three(v, high, f[i][3], f[i][4], f[i][5]);
    spec[i] = minimum(wiz[i], woz[i]) > 0 ? sum * v.per_cosine : 0;
  }
}
_Static_assert(FABRIC_STRIPS == 6, "as many as are written out above");

static void pass_table_matt(const fabric_table *table, size_t count,
                            real (*restrict a)[FABRIC_RANK], real (*restrict b)[FABRIC_RANK],
                            const real *restrict iz, const real *restrict oz, real *restrict matt) {
  const float *unit = table->matt_unit;
  const real u0 = (real)unit[0], u1 = (real)unit[1], u2 = (real)unit[2], u3 = (real)unit[3];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const real sum = u0 * a[i][0] * b[i][0] + u1 * a[i][1] * b[i][1] +
                     (u2 * a[i][2] * b[i][2] + u3 * a[i][3] * b[i][3]);
    matt[i] = minimum(iz[i], oz[i]) > 0 ? maximum(sum, 0) : 0;
  }
}

/* spec: NULL where it is not wanted. */
static void table_block(const fabric_table *table, size_t count, vec wi, vec wo, real *spec,
                        real *matt) {
  table_place place;
  ROOM fields[BLOCK][FABRIC_FIELDS], a[BLOCK][FABRIC_RANK], b[BLOCK][FABRIC_RANK];
  const real last = table_bound(table, FABRIC_MATT_SIDE - 1);
  if (spec) {
    pass_table_find_half(count, wi, wo, table->columns, table->rows, &place);
    pass_table_fetch_spec(count, table->spec, table->columns, &place, fields);
    pass_table_spec(table, count, fields, wi, wo, spec);
  }
  pass_table_find(count, wi, last, &place);
  pass_table_fetch_matt(count, table->matt[0], FABRIC_MATT_SIDE, &place, a);
  pass_table_find(count, wo, last, &place);
  pass_table_fetch_matt(count, table->matt[1], FABRIC_MATT_SIDE, &place, b);
  pass_table_matt(table, count, a, b, wi.z, wo.z, matt);
}

/* What is asked of a table in single lanes. */
typedef struct table_query {
  const fabric_table *table;
  real wi[3], wo[3];
} table_query;

/* The answer, from the places of h, wi and wo: vectors of fields. */
LEAF void table_answer(const table_query *q, const table_spot at[3], real *spec, real *matt) {
  const fabric_table *table = q->table;
  const real *i = q->wi, *o = q->wo;
  ROOM f[FABRIC_FIELDS], a[FABRIC_RANK], b[FABRIC_RANK];
  table_fetch_spec(table->spec, table->columns, at[0], f);
  table_fetch_matt(table->matt[0], FABRIC_MATT_SIDE, at[1], a);
  table_fetch_matt(table->matt[1], FABRIC_MATT_SIDE, at[2], b);
  const table_turned v = table_turn(i[0], i[1], i[2], o[0], o[1], o[2],
                                    (real)table->unit[FABRIC_ALONG] * f[FABRIC_ALONG] - 1,
                                    (real)table->unit[FABRIC_VARIANCE] * f[FABRIC_VARIANCE]);
  real sum = 0, more = 0;
#pragma omp simd reduction(+ : sum)
  for (int k = 0; k < FABRIC_FIELDS; k++) {
    const real tilt = (real)table->tilt[k], per = 1 / table_over(v, tilt);
    const table_strip strip = table_strip_of(v, tilt, (real)table->spread[k], per);
    sum += (real)table->scale[k] * f[k] * (table_width(strip, 1) / strip.half);
  }
  for (int k = 0; k < FABRIC_RANK; k++)
    more += (real)table->matt_unit[k] * a[k] * b[k];
  const int lit = minimum(i[2], o[2]) > 0;
  *spec = lit ? sum * v.per_cosine : 0;
  *matt = lit ? maximum(more, 0) : 0;
}

static void table_lane(const fabric_table *table, size_t i, vec wi, vec wo, real *spec,
                       real *matt) {
  ARRAYS(wi);
  ARRAYS(wo);
  const table_query q = {table, {wix[i], wiy[i], wiz[i]}, {wox[i], woy[i], woz[i]}};
  const real x = wix[i] + wox[i], y = wiy[i] + woy[i], z = wiz[i] + woz[i];
  const real size = root(x * x + y * y + z * z), side = FABRIC_MATT_SIDE - 1;
  const table_spot at[3] = {
      table_find(x, y, z, size, (real)(table->columns - 1), (real)(table->rows - 1),
                 table->columns),
      table_find(wix[i], wiy[i], wiz[i], 1, side, side, FABRIC_MATT_SIDE),
      table_find(wox[i], woy[i], woz[i], 1, side, side, FABRIC_MATT_SIDE),
  };
  table_answer(&q, at, spec, matt);
}

/* Both sides of a cloth: all that is looked up is found in one vector. */
static void table_sides(const table_query q[2], real spec[2], real matt[2]) {
  enum { LOOKS = 8 }; /* of h, wi and wo of either side; two are none */
  ROOM x[LOOKS], y[LOOKS], z[LOOKS], whole[LOOKS], right[LOOKS], top[LOOKS], px[LOOKS], py[LOOKS];
  _Alignas(64) int32_t at[LOOKS], columns[LOOKS];
  table_spot spot[LOOKS];
  for (size_t k = 0; k < 2; k++) {
    const real *i = q[k].wi, *o = q[k].wo;
    const size_t j = 4 * k;
#define LOOK(J, X, Y, Z, WHOLE, COLUMNS, ROWS)                                                     \
  x[J] = X, y[J] = Y, z[J] = Z, whole[J] = WHOLE, columns[J] = COLUMNS,                            \
  right[J] = (real)(COLUMNS - 1), top[J] = (real)(ROWS - 1)
    LOOK(j, i[0] + o[0], i[1] + o[1], i[2] + o[2], 0, q[k].table->columns, q[k].table->rows);
    LOOK(j + 1, i[0], i[1], i[2], 1, FABRIC_MATT_SIDE, FABRIC_MATT_SIDE);
    LOOK(j + 2, o[0], o[1], o[2], 1, FABRIC_MATT_SIDE, FABRIC_MATT_SIDE);
    LOOK(j + 3, 0, 0, 1, 1, FABRIC_MATT_SIDE, FABRIC_MATT_SIDE);
#undef LOOK
  }
#pragma omp simd
  for (size_t j = 0; j < LOOKS; j++) {
    const real size = root(x[j] * x[j] + y[j] * y[j] + z[j] * z[j]);
    const table_spot to =
        table_find(x[j], y[j], z[j], whole[j] > 0 ? 1 : size, right[j], top[j], columns[j]);
    at[j] = to.at;
    px[j] = to.x;
    py[j] = to.y;
  }
  for (size_t j = 0; j < LOOKS; j++)
    spot[j] = (table_spot){at[j], px[j], py[j]};
  for (size_t k = 0; k < 2; k++)
    table_answer(q + k, spot + 4 * k, spec + k, matt + k);
}

/* spec, if it is not NULL, and matt of entry_yarn, the mean over the lobes of the table. */
static void entry_table(const fabric_table *table, size_t count, const real *const wi[3],
                        const real *const wo[3], real *spec, real *matt) {
  real unused;
  for (size_t i = 0; count < FABRIC_FEW && i < count; i++)
    table_lane(table, i, vec_of(wi), vec_of(wo), spec ? spec + i : &unused, matt + i);
  for (size_t start = 0; count >= FABRIC_FEW && start < count; start += BLOCK)
    table_block(table, count - start < BLOCK ? count - start : BLOCK,
                vec_from(wi[0], wi[1], wi[2], start), vec_from(wo[0], wo[1], wo[2], start),
                spec ? spec + start : NULL, matt + start);
}

#endif
