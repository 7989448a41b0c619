/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/relief.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "closure/closure.h"
#include "node/hash.h"
#include "node/node.h"
#include "render/hits.h"

/* Of a material: of POINTS the root of a variance is within 2 %. Where bumps may be uneven FINE
 * make a map. Its cells, SIDE along either axis, hold four of them, as those of a first one do. */
enum { POINTS = 4 * BATCH, FIRST_SIDE = 32, FINE = 256 * BATCH, SIDE = 256, COARSEST = 8 };
_Static_assert((int)COARSEST >= (int)RELIEF_WIDER, "a shape has a cell");

static bool is_mutual(const closure *c) {
  return c->type == CLOSURE_METAL && c->of.metal.params.horizon == SHADE_HORIZON_MUTUAL;
}

static bool wants_slopes(const closure *c) {
  return is_mutual(c) && !c->of.metal.told && c->of.metal.normal[0] != REGISTER_NORMAL;
}

typedef struct point {
  double at[3], n[3]; /* of a triangle in the world; its normal is as long as twice its area */
} point;

/* The point (u, v) of a triangle. */
static point point_of(const instance *in, const mesh *m, size_t t, double u, double v) {
  double corner[3][3], a[3], b[3];
  point p;
  for (size_t k = 0; k < 3; k++)
    instance_place(in->matrix, m->position + 3 * (size_t)m->corner_position[3 * t + k], corner[k]);
  for (int i = 0; i < 3; i++) {
    a[i] = corner[1][i] - corner[0][i];
    b[i] = corner[2][i] - corner[0][i];
    p.at[i] = corner[0][i] + u * a[i] + v * b[i];
  }
  for (int i = 0; i < 3; i++)
    p.n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  return p;
}

static double length(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* A number of a triangle's own, by its vertices: Blender 5 may give triangles in another order each
 * time, and what is found of the same mesh has to be the same. */
static uint32_t number_of(const mesh *m, size_t t, uint32_t instance) {
  uint32_t sum = 0;
  for (size_t k = 0; k < 3; k++)
    sum += jenkins(1, (uint32_t)m->corner_position[3 * t + k], 0, 0, 0);
  return jenkins(2, sum, instance, 0, 0);
}

/* Adds up the areas of a material's triangles; where there is room, puts down up to `count` points
 * that lie as densely on all of it. Returns the sum. */
static double walk(const scene *s, int32_t material, double area, size_t count, point *points) {
  const double wanted = (double)count - 4 * sqrt((double)count); /* chance adds some */
  double sum = 0;
  size_t made = 0;
  for (const instance *in = s->instance; in < s->instance + s->instances; in++) {
    const mesh *m = &s->mesh[in->mesh];
    for (size_t t = 0; t < m->triangles; t++) {
      if (m->material[t] != material)
        continue;
      const double own = length(point_of(in, m, t, 0, 0).n);
      sum += own < 1e30 ? own : 0;
      if (!points || !(own < 1e30))
        continue;
      const uint32_t number = number_of(m, t, (uint32_t)(in - s->instance));
      const double first[2] = {(double)closed_unit(jenkins(1, number, 0, 0, 0)),
                               (double)closed_unit(jenkins(2, number, 0, 0, 0))};
      const size_t end = made + (size_t)(own / area * wanted + (double)closed_unit(number));
      for (size_t k = 1; made < count && made < end; k++, made++) {
        /* multiples of the plastic number's powers lie evenly in a square, which is folded */
        double u = first[0] + (double)k * 0.7548776662466927,
               v = first[1] + (double)k * 0.5698402909980532;
        u -= floor(u);
        v -= floor(v);
        points[made] = u + v > 1 ? point_of(in, m, t, 1 - u, 1 - v) : point_of(in, m, t, u, v);
      }
    }
  }
  return sum;
}

/* A short ray to each point, straight down on it: what it meets is that point, and all that is
 * known of it. */
static size_t aim_down(const point *points, size_t count, rays *ray) {
  size_t made = 0;
  for (size_t k = 0; k < count; k++) {
    const point *p = &points[k];
    const double size = length(p->n), reach = fmax(sqrt(size), 1e-4 * length(p->at)) * 1e-2;
    if (!(size > 1e-30))
      continue;
    float *o[3] = {ray->o.x, ray->o.y, ray->o.z}, *d[3] = {ray->d.x, ray->d.y, ray->d.z};
    for (int i = 0; i < 3; i++) {
      o[i][made] = (float)(p->at[i] + reach * p->n[i] / size);
      d[i][made] = (float)(-p->n[i] / size);
    }
    ray->tnear[made] = 0.0f;
    ray->tfar[made] = (float)(2 * reach);
    ray->time[made++] = 0.5f;
  }
  return made;
}

/* What a closure's normals say at points that were looked at. */
typedef struct bump {
  float u, v, x, y; /* a place of the UV map, a slope */
} bump;
typedef struct bumps {
  size_t count;
  bump *of;
} bumps;

/* Those of the normals that a closure takes, in the run of its material. */
static void add_bumps(const closure_metal *c, lane_run run, const batch *b, bumps *to) {
  const float shallowest = 0.02f;
  for (size_t i = run.begin; i < run.end; i++) {
    const vec3 n = normal_at(&b->input, c->normal, i);
    const float u = b->surface.u[i], v = b->surface.v[i];
    if (n.z > shallowest && isfinite(u) && isfinite(v))
      to->of[to->count++] = (bump){u, v, -n.x / n.z, -n.y / n.z};
  }
}

/* Slopes of bumps: their mean, and the second moment about it. */
typedef struct moments {
  double x, y, xx, xy, yy;
} moments;

static moments moments_of(const bumps *all) {
  moments m = {0};
  const double share = 1 / (double)all->count;
  for (const bump *b = all->of; b < all->of + all->count; b++) {
    m.x += share * (double)b->x;
    m.y += share * (double)b->y;
  }
  for (const bump *b = all->of; b < all->of + all->count; b++) {
    const double x = (double)b->x - m.x, y = (double)b->y - m.y;
    m.xx += share * x * x;
    m.xy += share * x * y;
    m.yy += share * y * y;
  }
  return m;
}

/* Sums of slopes in a cell, taken from the mean. */
typedef struct cell {
  float count, x, y, xx, xy, yy;
} cell;

static cell plus(cell a, cell b) {
  return (cell){a.count + b.count, a.x + b.x, a.y + b.y, a.xx + b.xx, a.xy + b.xy, a.yy + b.yy};
}

static const cell *cell_at(const cell *cells, int side, int x, int y) {
  return &cells[(y & (side - 1)) * side + (x & (side - 1))];
}

/* Windows of 3 by 3 cells, by 1, 2 and 1 along either axis: those of 2 come twice. */
static void blur(const cell *cells, int side, cell *to) {
  for (int k = 0; k < side * side; k++) {
    const int x = k % side, y = k / side;
    cell sum = {0};
    for (int j = 0; j < 16; j++)
      sum = plus(sum, *cell_at(cells, side, x + j % 4 / 2 + j % 2 - 1, y + j / 8 + j / 4 % 2 - 1));
    to[k] = sum;
  }
}

static void halve(cell *cells, int side) {
  for (int k = 0; k < side * side / 4; k++) {
    const cell *low = cells + 4 * (k / (side / 2)) * (side / 2) + 2 * (k % (side / 2));
    cells[k] = plus(plus(low[0], low[1]), plus(low[side], low[side + 1]));
  }
}

/* The squares of the means in windows, which is what windows do not hold. */
static double left_out(const cell *cells, const cell *windows, int side) {
  double sum = 0;
  for (int k = 0; k < side * side; k++) {
    const cell w = windows[k];
    if (cells[k].count > 0)
      sum += (double)(cells[k].count * (w.x * w.x + w.y * w.y) / (w.count * w.count));
  }
  return sum;
}

/* The square of the UV map that the bumps lie in; all of it, again and again, where that is larger.
 * About a shape there is a rim as wide as the finest map's cells of means, so that none of its
 * windows reaches the other side; those of a coarser one at the edge do. */
static void frame(const bumps *all, bool shape, relief_map *map) {
  float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (const bump *b = all->of; b < all->of + all->count; b++) {
    const float at[2] = {b->u, b->v};
    for (int k = 0; k < 2; k++) {
      low[k] = fminf(low[k], at[k]);
      high[k] = fmaxf(high[k], at[k]);
    }
  }
  const float size = fmaxf(high[0] - low[0], high[1] - low[1]),
              rim = shape ? size / (SIDE / RELIEF_WIDER - 2) : 0.01f * size;
  const bool repeats = !(size < 1.0f);
  for (int k = 0; k < 2; k++)
    map->first[k] = repeats ? 0.0f : low[k] - rim;
  map->scale = repeats ? 1.0f : 1.0f / fmaxf(size + 2 * rim, 1e-6f);
}

static void fill(const bumps *all, const moments *m, const relief_map *map, cell *cells) {
  for (const bump *b = all->of; b < all->of + all->count; b++) {
    const float x = b->x - (float)m->x, y = b->y - (float)m->y;
    const int i = relief_find_place(b->u, map->first[0], map->scale, map->side).nearest;
    const int j = relief_find_place(b->v, map->first[1], map->scale, map->side).nearest;
    cell *to = &cells[j * map->side + i];
    *to = plus(*to, (cell){1.0f, x, y, x * x, x * y, y * y});
  }
}

/* The variance of moments in windows, over the square of their mean. */
static double varied(const cell *cells, const cell *windows, int side, double sum, double count) {
  double squares = 0;
  for (int k = 0; k < side * side; k++) {
    const cell w = windows[k];
    const double here = cells[k].count > 0 ? (double)((w.xx + w.yy) / w.count) / sum : 0;
    squares += (double)cells[k].count * here * here / count;
  }
  return squares - 1;
}

/* Moments in windows count the more, not that of all, the more they vary: waves' are even enough,
 * and where half of a map is flat they count wholly. */
static float nearness(double varies) {
  const double even = 0.5, uneven = 0.8;
  return (float)fmin(fmax((varies - even) / (uneven - even), 0), 1);
}

/* What lies on a mean. */
static cell about(cell c, float x, float y) {
  return (cell){c.count,
                c.x - c.count * x,
                c.y - c.count * y,
                c.xx + x * (c.count * x - 2 * c.x),
                c.xy + c.count * x * y - x * c.y - y * c.x,
                c.yy + y * (c.count * y - 2 * c.y)};
}

/* The mean in wide windows, and what is left of cells about it; `spare` has room for them. */
static void detrend(const cell *cells, int side, float (*mean)[2], cell *left, cell *spare) {
  const int wide = side / RELIEF_WIDER;
  const float none = 1e-3f, cell_size = 1 / (float)side;
  memcpy(left, cells, (size_t)side * (size_t)side * sizeof *cells);
  for (int k = side; k > wide; k /= 2)
    halve(left, k);
  blur(left, wide, spare);
  for (int k = 0; k < wide * wide; k++) {
    mean[k][0] = spare[k].x / (spare[k].count + none);
    mean[k][1] = spare[k].y / (spare[k].count + none);
  }
  for (int k = 0; k < side * side; k++) {
    const float u = ((float)(k % side) + 0.5f) * cell_size;
    const float v = ((float)(k / side) + 0.5f) * cell_size;
    const relief_place x = relief_find_place(u, 0, 1, wide), y = relief_find_place(v, 0, 1, wide);
    left[k] = about(cells[k], relief_between(mean[0], 2, wide, x, y),
                    relief_between(mean[0] + 1, 2, wide, x, y));
  }
}

/* The moments about a shape; its mean becomes that of all slopes, not what it adds to theirs. */
static void set_rest(const cell *left, relief_map *map, moments *m, size_t count) {
  const int wide = map->side / RELIEF_WIDER;
  double xx = 0, xy = 0, yy = 0;
  for (int k = 0; k < map->side * map->side; k++) {
    xx += (double)left[k].xx;
    xy += (double)left[k].xy;
    yy += (double)left[k].yy;
  }
  m->xx = fmax(xx / (double)count, 1e-10);
  m->xy = xy / (double)count;
  m->yy = fmax(yy / (double)count, 1e-10);
  for (int k = 0; k < wide * wide; k++) {
    map->mean[k][0] += (float)m->x;
    map->mean[k][1] += (float)m->y;
  }
}

/* Room for a map; its windows are to be found. NULL when out of memory. */
static relief_map *new_map(const bumps *all, int side, bool shape) {
  const size_t room = (size_t)side * (size_t)side;
  const size_t wide = shape ? room / (RELIEF_WIDER * RELIEF_WIDER) : 0;
  relief_map *map = malloc(sizeof *map + room * sizeof *map->moment + wide * sizeof *map->mean);
  if (!map)
    return NULL;
  map->side = side;
  map->mean = shape ? (float(*)[2])(map->moment + room) : NULL;
  frame(all, shape, map);
  return map;
}

/* The finest map, of so many cells along a side or fewer, whose windows hold four fifths of the
 * variance, and how much they vary; of a shape, what they do not hold has to be in its own windows.
 * *m becomes the moments about that. NULL when out of memory. */
static relief_map *map_of(const bumps *all, moments *m, int side, bool shape, double *varies) {
  const double most = 0.2 * (m->xx + m->yy) * (double)all->count;
  const size_t room = (size_t)side * (size_t)side;
  const float none = 1e-3f;
  cell *cells = calloc((shape ? 3 : 2) * room, sizeof *cells), *left = cells;
  relief_map *map = cells ? new_map(all, side, shape) : NULL;
  if (map) {
    cell *windows = cells + room;
    fill(all, m, map, cells);
    for (;; map->side /= 2) {
      if (shape)
        detrend(cells, map->side, map->mean, left = windows + room, windows);
      blur(left, map->side, windows);
      if (map->side == COARSEST || left_out(left, windows, map->side) <= most)
        break;
      halve(cells, map->side);
    }
    if (shape)
      set_rest(left, map, m, all->count);
    *varies = varied(left, windows, map->side, m->xx + m->yy, (double)all->count);
    const float near = nearness(*varies), whole[3] = {(float)m->xx, (float)m->xy, (float)m->yy};
    for (int k = 0; k < map->side * map->side; k++) {
      const cell w = windows[k];
      const float here[3] = {w.xx, w.xy, w.yy}, part = near / (w.count + none);
      for (int i = 0; i < 3; i++) /* where nothing was seen that of all */
        map->moment[k][i] = whole[i] + part * (here[i] - w.count * whole[i]);
      for (int i = 0; i < 3; i += 2) /* about a shape they are differences, which round */
        map->moment[k][i] = fmaxf(map->moment[k][i], 0.0f);
    }
  }
  free(cells);
  return map;
}

/* Gives the node of uneven bumps, or of a shape, its map, or says whether a first one, whose
 * windows are wide and so vary less, is worth a *finer. False when out of memory. */
static bool set_map(node_relief *n, const bumps *all, moments *m, bool first, bool *finer) {
  const double hint = 0.2;
  const bool shape = n->outs > 3;
  double varies = 0;
  if (!(m->xx + m->yy > 1e-10))
    return true;
  if (first && shape)
    return *finer = true;
  relief_map *map = map_of(all, m, first ? FIRST_SIDE : SIDE, shape, &varies);
  if (!map)
    return false;
  *finer = *finer || (first && varies > hint);
  if (!first && (shape || nearness(varies) > 0))
    n->map = map;
  else
    free(map);
  return true;
}

static void set_slopes(closure_metal *c, const moments *m) {
  shade_params_set_slopes(&c->params, (const double[5]){m->x, m->y, m->xx, m->xy, m->yy});
  shade_bsdf_setup(&c->bsdf, &c->params);
}

/* The node that a closure reads. */
static node_relief *node_of(material *m, const closure_metal *c) {
  for (size_t k = m->nodes; k-- > 0;)
    if (m->node[k].type == NODE_RELIEF && m->node[k].of.relief.out[0] == c->moment[0].at)
      return &m->node[k].of.relief;
  return NULL;
}

/* What the points say, by closure. */
static void see(worker *w, const material *m, const point *points, size_t points_count,
                bumps *found) {
  batch *b = w->batch;
  for (size_t first = 0; first < points_count; first += BATCH) {
    if (atomic_load_explicit(w->cancel, memory_order_relaxed))
      return;
    const size_t count = aim_down(points + first, BATCH, &b->sample_ray);
    hits_trace(w, RAY_CAMERA, count);
    if (!b->queue.hits)
      continue;
    hits_sort(w, count, NULL);
    hits_surface(w);
    hits_nodes(w);
    for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++)
      for (size_t k = 0; g->material == m && k < m->closures; k++)
        if (wants_slopes(&m->closure[k]))
          add_bumps(&m->closure[k].of.metal, g->run, b, &found[k]);
  }
}

/* Looks at so many points of a material; *finer: whether some of its bumps are worth FINE. */
static bool look(worker *w, material *m, double area, size_t count, bool *finer) {
  bumps found[CLOSURES_MOST] = {{0}};
  point *points = calloc(count, sizeof *points);
  bool good = points != NULL;
  for (size_t k = 0; k < m->closures; k++)
    if (wants_slopes(&m->closure[k]))
      good = (found[k].of = malloc(count * sizeof *found[k].of)) && good;
  *finer = false;
  if (good) {
    walk(w->scene, (int32_t)(m - w->scene->material), area, count, points);
    see(w, m, points, count, found);
  }
  for (size_t k = 0; good && k < m->closures; k++)
    if (found[k].count > 0) {
      closure_metal *c = &m->closure[k].of.metal;
      node_relief *n = node_of(m, c);
      moments all = moments_of(&found[k]);
      /* of a node that several closures of a file read the first one's */
      good = !n || n->map || set_map(n, &found[k], &all, count < FINE, finer);
      set_slopes(c, &all);
    }
  for (size_t k = 0; k < m->closures; k++)
    free(found[k].of);
  free(points);
  return good;
}

static bool wants(const material *m) {
  for (const closure *c = m->closure; c < m->closure + m->closures; c++)
    if (wants_slopes(c))
      return true;
  return false;
}

static bool look_at(worker *w, material *m) {
  bool finer;
  const double area = walk(w->scene, (int32_t)(m - w->scene->material), 0, 0, NULL);
  if (!(area > 0))
    return true;
  if (!w->batch && !batch_init(w))
    return false;
  memset(w->batch->path_states, 0, sizeof w->batch->path_states);
  return look(w, m, area, POINTS, &finer) && (!finer || look(w, m, area, FINE, &finer));
}

/* Of even bumps there is one moment, which the closure knows. */
static void leave_even(material *m) {
  for (closure *c = m->closure; c < m->closure + m->closures; c++) {
    const node_relief *n = c->type == CLOSURE_METAL ? node_of(m, &c->of.metal) : NULL;
    if (n && !n->map)
      closure_metal_even(&c->of.metal);
  }
}

bool relief_find(scene *s, const atomic_bool *cancel) {
  static const sampling none;
  worker w = {.scene = s, .sampling = &none, .cancel = cancel};
  bool good = true;
  for (material *m = s->material; good && m < s->material + s->materials; m++) {
    if (wants(m) && !atomic_load_explicit(cancel, memory_order_relaxed))
      good = look_at(&w, m);
    leave_even(m);
  }
  if (w.batch)
    batch_free(&w);
  return good;
}

void relief_free(material *m) {
  for (node *n = m->node; m->node && n < m->node + m->nodes; n++)
    if (n->type == NODE_RELIEF)
      free(n->of.relief.map);
}

bool relief_told(const material *m, double slopes[5]) {
  const closure *c = m->closure, *const end = m->closure + m->closures;
  while (c < end && !is_mutual(c))
    c++;
  if (c == end)
    return false;
  shade_params_get_slopes(&c->of.metal.params, slopes);
  return true;
}
