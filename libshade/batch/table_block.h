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
 * n as a number that compilers do not know, so that to bring a number between two of them takes two
 * instructions and no branch.
 */
LEAF real table_bound(const fabric_table *table, int n) {
  return (real)(table->columns > 0 ? n : 0);
}

/*
 * All fields of a vertex lie side by side, and a lane takes them at once, which is quicker than a
 * gather for each.
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

/* Where v lies among the vertices of the diffuse part. */
LEAF table_spot table_find_matt(const fabric_table *table, triple v) {
  const real last = table_bound(table, FABRIC_MATT_SIDE - 1);
  return table_find(XYZ(v), 1, last, last, FABRIC_MATT_SIDE);
}

/* The same of h = wi + wo, of any length, among those of the specular part. */
LEAF table_spot table_find_half(const fabric_table *table, triple wi, triple wo) {
  const real x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
  const real size = root(x * x + y * y + z * z);
  return table_find(x, y, z, size, (real)(table->columns - 1), (real)(table->rows - 1),
                    table->columns);
}

static void pass_table_find(const fabric_table *table, size_t count, vec v,
                            table_place *restrict p) {
  ARRAYS(v);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const table_spot spot = table_find_matt(table, (triple){vx[i], vy[i], vz[i]});
    p->at[i] = spot.at;
    p->x[i] = spot.x;
    p->y[i] = spot.y;
  }
}

static void pass_table_find_half(const fabric_table *table, size_t count, vec wi, vec wo,
                                 table_place *restrict p) {
  ARRAYS(wi);
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const table_spot spot =
        table_find_half(table, (triple){wix[i], wiy[i], wiz[i]}, (triple){wox[i], woy[i], woz[i]});
    p->at[i] = spot.at;
    p->x[i] = spot.x;
    p->y[i] = spot.y;
  }
}

static table_lobes table_lobes_of(const fabric_table *table) {
  table_lobes t = {.along = (real)table->unit[FABRIC_ALONG],
                   .variance = (real)table->unit[FABRIC_VARIANCE],
                   .one = table_bound(table, 1)};
  for (int k = 0; k < 3; k++) {
    t.low.d[k] = (real)table->scale[k];
    t.low.tilt[k] = (real)table->tilt[k];
    t.low.spread[k] = (real)table->spread[k];
    t.high.d[k] = (real)table->scale[k + 3];
    t.high.tilt[k] = (real)table->tilt[k + 3];
    t.high.spread[k] = (real)table->spread[k + 3];
  }
  return t;
}

static void pass_table_spec(const fabric_table *table, size_t count,
                            real (*restrict f)[FABRIC_FIELDS], vec wi, vec wo,
                            real *restrict spec) {
  const table_lobes t = table_lobes_of(table);
  ARRAYS(wi);
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    spec[i] =
        table_spec(t, f[i], (triple){wix[i], wiy[i], wiz[i]}, (triple){wox[i], woy[i], woz[i]});
}

static void pass_table_matt(const real unit[FABRIC_RANK], size_t count,
                            real (*restrict a)[FABRIC_RANK], real (*restrict b)[FABRIC_RANK],
                            const real *restrict iz, const real *restrict oz, real *restrict matt) {
  const real own[FABRIC_RANK] = {unit[0], unit[1], unit[2], unit[3]};
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    matt[i] = table_matt(own, a[i], b[i], minimum(iz[i], oz[i]));
}

static void table_block(const fabric_table *table, size_t count, vec wi, vec wo, real *spec,
                        real *matt) {
  table_place place;
  ROOM fields[BLOCK][FABRIC_FIELDS], a[BLOCK][FABRIC_RANK], b[BLOCK][FABRIC_RANK];
  const float *unit = table->matt_unit;
  const real units[FABRIC_RANK] = {(real)unit[0], (real)unit[1], (real)unit[2], (real)unit[3]};
  pass_table_find_half(table, count, wi, wo, &place);
  pass_table_fetch_spec(count, table->spec, table->columns, &place, fields);
  pass_table_spec(table, count, fields, wi, wo, spec);
  pass_table_find(table, count, wi, &place);
  pass_table_fetch_matt(count, table->matt[0], FABRIC_MATT_SIDE, &place, a);
  pass_table_find(table, count, wo, &place);
  pass_table_fetch_matt(count, table->matt[1], FABRIC_MATT_SIDE, &place, b);
  pass_table_matt(units, count, a, b, wi.z, wo.z, matt);
}

/* spec and matt of entry_yarn, the mean over the lobes of the table: of one pair, of arrays. */
static void table_one(const fabric_table *table, triple wi, triple wo, real *spec, real *matt) {
  ROOM fields[FABRIC_FIELDS], a[FABRIC_RANK], b[FABRIC_RANK];
  const float *unit = table->matt_unit;
  const real units[FABRIC_RANK] = {(real)unit[0], (real)unit[1], (real)unit[2], (real)unit[3]};
  table_fetch_spec(table->spec, table->columns, table_find_half(table, wi, wo), fields);
  table_fetch_matt(table->matt[0], FABRIC_MATT_SIDE, table_find_matt(table, wi), a);
  table_fetch_matt(table->matt[1], FABRIC_MATT_SIDE, table_find_matt(table, wo), b);
  *spec = table_spec(table_lobes_of(table), fields, wi, wo);
  *matt = table_matt(units, a, b, minimum(wi.z, wo.z));
}

static void entry_table(const fabric_table *table, size_t count, const real *const wi[3],
                        const real *const wo[3], real *spec, real *matt) {
  for (size_t start = 0; start < count; start += BLOCK)
    table_block(table, count - start < BLOCK ? count - start : BLOCK,
                vec_from(wi[0], wi[1], wi[2], start), vec_from(wo[0], wo[1], wo[2], start),
                spec + start, matt + start);
}

#endif
