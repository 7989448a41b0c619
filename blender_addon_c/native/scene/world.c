/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/parts.h"
#include "system/parallel.h"

/*
 * A copy of a mesh in the arrays: of an instance, in the world, or the one that many instances
 * share, as it is. share: where its part of the arrays begins.
 */
typedef struct share {
  size_t mesh;
  const double *matrix; /* 12 */
  uint32_t object;
  uint8_t hidden;
  size_t position, quad, single;
  size_t moved;       /* where the normals of a mesh that changes its shape begin */
  double normal[9];   /* inverse transpose but for a positive factor */
  float mirror;       /* -1 when the matrix mirrors */
  float bounds[2][3]; /* of a shared mesh */
} share;

typedef struct build {
  scene *scene;
  const atomic_bool *cancel;
  message_log *log;
  parts *parts;       /* per mesh */
  size_t *shared;     /* per mesh: number of its share, or WORLD where each instance has its own */
  share *share;       /* those of the world first */
  size_t shares, own; /* their number, and that of those in the world */
  size_t *chunk;      /* per share: its first chunk; one more at the end */
  float *position;
  uint32_t *quad, *single;
  size_t positions, singles, moved;
  size_t own_quads, own_singles; /* of the world */
  float reach;                   /* of its numbers */
} build;

/* Of a world that may be taken over. */
typedef struct world_plan {
  build made;
  bool moved, own_moved; /* since: something, and something that is in the world itself */
} world_plan;

enum { CHUNK = 8192 };
#define WORLD SIZE_MAX

static bool cancelled(const build *b) {
  return atomic_load_explicit(b->cancel, memory_order_relaxed);
}

static void *array(build *b, size_t count, size_t size) {
  return scene_array(b->log, count, size);
}

static void normal_matrix(const double m[12], share *s) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      s->normal[3 * r + c] = m[4 * r1 + c1] * m[4 * r2 + c2] - m[4 * r1 + c2] * m[4 * r2 + c1];
    }
  double determinant = m[0] * s->normal[0] + m[1] * s->normal[1] + m[2] * s->normal[2];
  s->mirror = determinant < 0 ? -1.0f : 1.0f;
  for (int k = 0; k < 9; k++)
    s->normal[k] *= (double)s->mirror;
}

/* Unit vector of v; false where it has no direction. */
static bool normalized(const double v[3], float out[3]) {
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (!(length > 1e-30 && length < 1e30))
    return false;
  for (int k = 0; k < 3; k++)
    out[k] = (float)(v[k] / length);
  return true;
}

static void turned(const double *m, int stride, const float v[3], double out[3]) {
  for (int r = 0; r < 3; r++, m += stride)
    out[r] = m[0] * (double)v[0] + m[1] * (double)v[1] + m[2] * (double)v[2];
}

static void face_normal(const float *a, const float *b, const float *c, float out[3]) {
  double u[3], v[3];
  for (int k = 0; k < 3; k++) {
    u[k] = (double)b[k] - (double)a[k];
    v[k] = (double)c[k] - (double)a[k];
  }
  double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  if (!normalized(n, out))
    out[0] = out[1] = 0.0f, out[2] = 1.0f;
}

static uint16_t upper_half(float x) {
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return (uint16_t)((bits + 0x8000u) >> 16);
}

/* How far a triangle bulges, by its corners' normals; not worth it below a thousandth. */
static void find_heights(const float *const corner[3], triangle *out) {
  int next = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      if (i == j)
        continue;
      float height = 0, length = 0;
      for (int k = 0; k < 3; k++) {
        float step = corner[j][k] - corner[i][k];
        height += step * out->corner[i][k];
        length += step * step;
      }
      bool finite = length < 1e36f; /* false for NaN */
      out->height[next++] = upper_half(finite ? height : 0.0f);
      out->curved |= finite && fabsf(height) > 1e-3f * sqrtf(length);
    }
}

/* Position by u and v, or by two edges where these are no measure. */
static void find_stretch(const float *const corner[3], const triangle *t, stretch *out) {
  double u1 = (double)t->corner[1][6] - (double)t->corner[0][6];
  double v1 = (double)t->corner[1][7] - (double)t->corner[0][7];
  double u2 = (double)t->corner[2][6] - (double)t->corner[0][6];
  double v2 = (double)t->corner[2][7] - (double)t->corner[0][7];
  double area = u1 * v2 - u2 * v1;
  bool good = uv_spans(t->corner[0][6], t->corner[0][7], t->corner[1][6], t->corner[1][7],
                       t->corner[2][6], t->corner[2][7]);
  out->edges = !good;
  for (int k = 0; k < 3; k++) {
    double a = (double)corner[1][k] - (double)corner[0][k];
    double b = (double)corner[2][k] - (double)corner[0][k];
    out->u[k] = (float)(good ? (a * v2 - b * v1) / area : a);
    out->v[k] = (float)(good ? (b * u1 - a * u2) / area : b);
  }
  double uu = 0, vv = 0, uv = 0;
  for (int k = 0; k < 3; k++) {
    uu += (double)out->u[k] * (double)out->u[k];
    vv += (double)out->v[k] * (double)out->v[k];
    uv += (double)out->u[k] * (double)out->v[k];
  }
  double half = 0.5 * (uu - vv),
         square = uu * vv - uv * uv; /* of the larger step's singular value */
  double larger = 0.5 * (uu + vv) + sqrt(half * half + uv * uv);
  out->dense = square > 0 ? (float)sqrt(larger / square) : INFINITY;
}

/* The scene's layers of triangle t, its corners turned so that `turn` comes first, for a record. */
static void fill_layers(const build *b, const share *sh, size_t t, unsigned turn, size_t record) {
  const scene *s = b->scene;
  const mesh *m = &s->mesh[sh->mesh];
  for (size_t k = 0; k < s->layers; k++) {
    const layer *to = &s->layer[k];
    size_t width = (size_t)to->width;
    const float *from = to->tangents_of < 0 ? m->layer[k] : b->parts[sh->mesh].layer[k];
    for (unsigned corner = 0; corner < 3; corner++) {
      float *out = to->corner + (3 * record + corner) * width;
      const float *in = from ? from + (3 * t + (turn + corner) % 3) * width : NULL;
      for (size_t i = 0; i < width; i++)
        out[i] = in && fabsf(in[i]) < 1e18f ? in[i] : 0.0f;
      double v[3];
      if (!in || to->tangents_of < 0)
        continue;
      turned(sh->matrix, 4, in, v);
      if (!normalized(v, out))
        out[0] = out[1] = out[2] = 0.0f;
      out[3] *= sh->mirror;
    }
  }
}

/* Normals of triangle t at each step, in the order of a record. */
static void fill_moved(const build *b, const share *sh, size_t t, unsigned turn, size_t record,
                       const triangle *now) {
  const scene *s = b->scene;
  const mesh *m = &s->mesh[sh->mesh];
  const parts *p = &b->parts[sh->mesh];
  size_t records = 2 * p->pairs + p->singles;
  /* the mesh's own halves of quads stand first there, then its single triangles */
  size_t local = record < 2 * s->quad_count
                     ? record - 2 * sh->quad
                     : 2 * p->pairs + record - (2 * s->quad_count + sh->single);
  for (size_t k = 0; k < (size_t)m->steps; k++)
    for (unsigned corner = 0; corner < 3; corner++) {
      const float *in = m->moved_normal + 9 * m->triangles * k + 3 * (3 * t + (turn + corner) % 3);
      float *out = s->moved_normal + sh->moved + 9 * (k * records + local) + 3 * corner;
      const double v[3] = {(double)in[0], (double)in[1], (double)in[2]};
      if (!normalized(v, out))
        memcpy(out, now->corner[corner], 3 * sizeof *out);
    }
}

/* The record of triangle t, its corners turned so that `turn` comes first. */
static void fill_record(const build *b, size_t index, size_t t, unsigned turn, triangle *out) {
  const share *sh = &b->share[index];
  const mesh *m = &b->scene->mesh[sh->mesh];
  const float *world[3];
  *out = (triangle){.material = (uint32_t)m->material[t], .handed = 1.0f, .object = sh->object};
  size_t now = m->steps && index >= b->own ? (size_t)(m->steps / 2) * m->positions : 0;
  for (unsigned k = 0; k < 3; k++)
    world[k] = b->position + 3 * (sh->position + now + m->corner_position[3 * t + (turn + k) % 3]);
  for (unsigned k = 0; k < 3; k++) {
    size_t corner = 3 * t + (turn + k) % 3;
    const float *tangent = b->parts[sh->mesh].tangent + 4 * corner;
    float *row = out->corner[k];
    double v[3];
    turned(sh->normal, 3, m->corner_normal + 3 * corner, v);
    if (!normalized(v, row))
      face_normal(world[0], world[1], world[2], row);
    turned(sh->matrix, 4, tangent, v);
    if (!normalized(v, row + 3))
      row[3] = row[4] = row[5] = 0.0f; /* stage_surface finds one */
    if (tangent[3] < 0.0f)             /* all three, or those beside a corner without a direction */
      out->handed = -1.0f;
    for (unsigned axis = 0; m->corner_uv && axis < 2; axis++) {
      float uv = m->corner_uv[2 * corner + axis];
      row[6 + axis] = fabsf(uv) < 1e18f ? uv : 0.0f; /* so that its differences are numbers */
    }
    for (int axis = 0; axis < 3; axis++)
      out->reach = fmaxf(out->reach, fabsf(world[k][axis]));
  }
  out->handed *= sh->mirror;
  out->mirrored = sh->mirror < 0.0f;
  if (b->scene->features.shadow_terminator)
    find_heights(world, out);
  if (m->steps && index >= b->own)
    fill_moved(b, sh, t, turn, (size_t)(out - b->scene->triangle), out);
  if (b->scene->hidden)
    b->scene->hidden[out - b->scene->triangle] = sh->hidden;
  if (b->scene->layers)
    fill_layers(b, sh, t, turn, (size_t)(out - b->scene->triangle));
  if (b->scene->stretch)
    find_stretch(world, out, &b->scene->stretch[out - b->scene->triangle]);
}

static void place_positions(void *context, size_t index) {
  build *b = context;
  const share *sh = &b->share[index];
  const mesh *m = &b->scene->mesh[sh->mesh];
  float *out = b->position + 3 * sh->position;
  if (m->steps && index >= b->own) {
    memcpy(out, m->moved_position, 3 * (size_t)m->steps * m->positions * sizeof *out);
    return;
  }
  for (size_t i = 0; i < m->positions; i++, out += 3) {
    double v[3];
    turned(sh->matrix, 4, m->position + 3 * i, v);
    for (int k = 0; k < 3; k++)
      out[k] = (float)(v[k] + sh->matrix[4 * k + 3]);
  }
}

static void place_chunk(void *context, size_t chunk) {
  build *b = context;
  scene *s = b->scene;
  if (cancelled(b))
    return;
  size_t low = 0, high = b->shares; /* the share that holds this chunk */
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (b->chunk[middle] <= chunk)
      low = middle;
    else
      high = middle;
  }
  const share *sh = &b->share[low];
  const mesh *m = &s->mesh[sh->mesh];
  const parts *p = &b->parts[sh->mesh];
  size_t begin = (chunk - b->chunk[low]) * CHUNK, end = begin + CHUNK;
  uint32_t base = (uint32_t)sh->position;
  for (size_t i = begin; i < end && i < p->pairs; i++) {
    const pair *two = &p->pair[i];
    const uint32_t *c = m->corner_position + 3 * (size_t)two->first, *d = c + 3;
    size_t q = sh->quad + i;
    /* halves (0, 1, 3) and (2, 3, 1) */
    b->quad[4 * q + 0] = base + c[two->turn[0]];
    b->quad[4 * q + 1] = base + c[(two->turn[0] + 1u) % 3];
    b->quad[4 * q + 2] = base + d[two->turn[1]];
    b->quad[4 * q + 3] = base + c[(two->turn[0] + 2u) % 3];
    fill_record(b, low, two->first, two->turn[0], &s->triangle[2 * q]);
    fill_record(b, low, two->first + 1, two->turn[1], &s->triangle[2 * q + 1]);
  }
  for (size_t i = begin > p->pairs ? begin : p->pairs; i < end && i < p->pairs + p->singles; i++) {
    size_t single = sh->single + i - p->pairs;
    uint32_t t = p->single[i - p->pairs];
    for (unsigned k = 0; k < 3; k++)
      b->single[3 * single + k] = base + m->corner_position[3 * (size_t)t + k];
    fill_record(b, low, t, 0, &s->triangle[2 * s->quad_count + single]);
  }
}

/* How far from 0 the scene's numbers reach; 1e18 where a part of it is farther and left out. */
static float find_reach(const scene *s) {
  float reach = 1.0f;
  float *largest = calloc(s->meshes + 1, sizeof *largest);
  for (size_t i = 0; largest && i < s->meshes; i++)
    for (size_t k = 0; k < 3 * s->mesh[i].positions; k++) {
      float x = fabsf(s->mesh[i].position[k]);
      largest[i] = x > largest[i] && x < 1e18f ? x : largest[i];
    }
  for (size_t i = 0; largest && i < s->instances; i++) {
    const double *m = s->instance[i].matrix;
    double far = 0;
    for (int k = 0; k < 12; k++)
      far += fabs(m[k]) * ((k & 3) == 3 ? 1.0 : (double)largest[s->instance[i].mesh]);
    if (isfinite(far)) /* else all of it is left out */
      reach = fmaxf(reach, (float)fmin(far, 1e18));
  }
  for (const instance *in = s->instance; in < s->instance + s->instances; in++)
    for (int step = 0; step < in->motion.steps; step++)
      for (int k = 0; k < 3; k++)
        reach = fmaxf(reach, fabsf(in->motion.pose[step].place[k]));
  for (int k = 0; k < 3; k++)
    reach = fmaxf(reach, fabsf(s->camera.origin[k]));
  free(largest);
  return largest && reach < 1e18f ? reach : 1e18f;
}

/* Whether Embree may turn the rays of a scene of such a reach into the space of such an instance:
 * in there they must be numbers less than 1.8e18. */
static bool invertible(const double m[12], float reach) {
  share s;
  double size = 0, largest = 0, inverse = 0;
  normal_matrix(m, &s);
  for (int k = 0; k < 12; k++) {
    if (!isfinite(m[k]))
      return false;
    size = fmax(size, fabs(m[k]));
    largest = (k & 3) == 3 ? largest : fmax(largest, fabs(m[k]));
  }
  for (int k = 0; k < 9; k++)
    inverse = fmax(inverse, fabs(s.normal[k]));
  double determinant = fabs(m[0] * s.normal[0] + m[1] * s.normal[1] + m[2] * s.normal[2]);
  return size < 1e12 && determinant > 1e-9 * largest * largest * largest && largest > 1e-9 &&
         6.0 * inverse * fmax(size, (double)reach) < 1e18 * determinant;
}

/* Where one that moves is; it stays where rays could not be turned into its space at all times. */
static void check_motion(const build *b, instance *in) {
  motion *m = &in->motion;
  for (int k = 0; k < m->steps; k++) {
    float at[12];
    double matrix[12];
    motion_at(m, (float)k / (float)(m->steps - 1), at);
    for (int i = 0; i < 12; i++)
      matrix[i] = (double)at[i];
    if (!invertible(matrix, b->reach)) {
      motion_free(m);
      in->unmoved = true;
    }
  }
  if (in->unmoved)
    message_warn(b->log,
                 "%s moves too far, or to no size, while the shutter is open: it is not blurred",
                 b->scene->mesh[in->mesh].name);
}

/*
 * Meshes whose copies would be many triangles are kept once, as they are. Few are copied: rays go
 * through a world without levels in half the time.
 */
static bool find_shared(build *b) {
  enum { FEW = 100000, FEW_OWN = 200000 };
  const scene *s = b->scene;
  b->reach = find_reach(s);
  b->shared = array(b, s->meshes, sizeof *b->shared);
  size_t *copies = calloc(s->meshes + 1, sizeof *copies), all = 0; /* those that are small */
  for (size_t i = 0; b->shared && copies && i < s->instances; i++)
    copies[s->instance[i].mesh] += invertible(s->instance[i].matrix, b->reach);
  for (size_t i = 0; b->shared && copies && i < s->meshes; i++)
    all += s->mesh[i].triangles < (size_t)s->apart ? copies[i] * s->mesh[i].triangles : 0;
  for (size_t i = 0; b->shared && copies && i < s->meshes; i++) {
    bool many = copies[i] > 1 && s->mesh[i].triangles > FEW / (copies[i] - 1);
    many = many || (s->apart && (all > FEW_OWN || s->mesh[i].triangles >= (size_t)s->apart));
    b->shared[i] = many || s->mesh[i].steps ? 0 : WORLD;
  }
  for (instance *in = s->instance; s->features.motion && in < s->instance + s->instances; in++) {
    check_motion(b, in);
    if (b->shared && in->motion.steps)
      b->shared[in->mesh] = 0;
  }
  bool good = b->shared && copies;
  free(copies);
  return good || message_error(b->log, "out of memory");
}

/* Whether it refers to the mesh's share. */
static bool is_reference(const build *b, const instance *in) {
  return b->shared[in->mesh] != WORLD && invertible(in->matrix, b->reach);
}

/* Of what is seen of it: by these rays set out from it. */
static void find_bounds(const mesh *m, float bounds[2][3]) {
  const float *position = m->steps ? m->moved_position : m->position;
  bool first = true;
  for (size_t i = 0; i < m->positions * (m->steps ? (size_t)m->steps : 1); i++) {
    if (!parts_usable(position + 3 * i))
      continue;
    for (size_t k = 0; k < 3; k++) {
      float x = position[3 * i + k];
      bounds[0][k] = first || x < bounds[0][k] ? x : bounds[0][k];
      bounds[1][k] = first || x > bounds[1][k] ? x : bounds[1][k];
    }
    first = false;
  }
}

/* Room in the arrays for another copy of a mesh. */
static void add_share(build *b, size_t mesh_index, const double *matrix, size_t object, int hidden,
                      bool shared) {
  scene *s = b->scene;
  const parts *p = &b->parts[mesh_index];
  share *sh = &b->share[b->shares++];
  *sh = (share){.mesh = mesh_index,
                .matrix = matrix,
                .object = (uint32_t)object,
                .hidden = (uint8_t)hidden,
                .position = b->positions,
                .quad = s->quad_count,
                .single = b->singles};
  normal_matrix(matrix, sh);
  const mesh *m = &s->mesh[mesh_index];
  b->positions += m->positions * (m->steps && shared ? (size_t)m->steps : 1);
  if (m->steps && shared) {
    sh->moved = b->moved;
    b->moved += 9 * (size_t)m->steps * m->triangles;
  }
  s->quad_count += p->pairs;
  b->singles += p->singles;
}

static bool is_veiled(const scene *s) {
  for (const instance *in = s->instance; in < s->instance + s->instances; in++)
    if (in->hidden)
      return true;
  return false;
}

/* Where the positions of each instance are. */
static void find_bases(const build *b) {
  scene *s = b->scene;
  for (size_t i = 0; i < b->own; i++)
    s->instance[b->share[i].object].base = b->share[i].position;
  for (instance *in = s->instance; in < s->instance + s->instances; in++)
    if (is_reference(b, in))
      in->base = b->share[b->shared[in->mesh]].position;
}

static bool share_out(build *b) {
  static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  scene *s = b->scene;
  size_t chunks = 0;
  b->share = array(b, s->instances + s->meshes, sizeof *b->share);
  b->chunk = array(b, s->instances + s->meshes + 1, sizeof *b->chunk);
  if (!b->share || !b->chunk || !find_shared(b))
    return false;
  for (const instance *in = s->instance; in < s->instance + s->instances; in++)
    if (!is_reference(b, in))
      add_share(b, in->mesh, in->matrix, (size_t)(in - s->instance), in->hidden, false);
  b->own = b->shares;
  b->own_quads = s->quad_count;
  b->own_singles = b->singles;
  for (size_t i = 0; i < s->meshes; i++)
    if (b->shared[i] != WORLD) {
      b->shared[i] = b->shares;
      add_share(b, i, identity, 0, 0, true);
      find_bounds(&s->mesh[i], b->share[b->shared[i]].bounds);
    }
  find_bases(b);
  for (size_t i = 0; i < b->shares; i++) {
    const parts *p = &b->parts[b->share[i].mesh];
    b->chunk[i] = chunks;
    chunks += (p->pairs + p->singles + CHUNK - 1) / CHUNK;
  }
  b->chunk[b->shares] = chunks;
  s->triangle_count = 2 * s->quad_count + b->singles;
  if (b->positions > UINT32_MAX || s->triangle_count >= RECORD_MISS)
    return message_error(b->log, "the scene has too many triangles (%zu)", s->triangle_count);
  b->position = array(b, 3 * b->positions, sizeof *b->position);
  b->quad = array(b, 4 * s->quad_count, sizeof *b->quad);
  b->single = array(b, 3 * b->singles, sizeof *b->single);
  s->triangle = array(b, s->triangle_count, sizeof *s->triangle);
  if (b->moved && !(s->moved_normal = array(b, b->moved, sizeof *s->moved_normal)))
    return false;
  if (is_veiled(s) && !(s->hidden = array(b, s->triangle_count, sizeof *s->hidden)))
    return false;
  if (s->features.derivatives && !(s->stretch = array(b, s->triangle_count, sizeof *s->stretch)))
    return false;
  for (size_t k = 0; k < s->layers; k++) {
    layer *l = &s->layer[k];
    l->corner = array(b, 3 * s->triangle_count, (size_t)l->width * sizeof *l->corner);
    l->record = (const float *)s->triangle;
    if (!l->corner)
      return false;
  }
  return b->position && b->quad && b->single && s->triangle;
}

/* The matrix as floats, its largest number 1: directions alone count. Returns that number. */
static float scaled_matrix(const double *m, int stride, float out[3][3]) {
  double largest = 1e-300;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      largest = fmax(largest, fabs(m[stride * r + c]));
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      out[r][c] = (float)(m[stride * r + c] / largest);
  return (float)largest;
}

/* Largest coordinate in the world of a box. */
static float reach_of(float bounds[2][3], const double matrix[12]) {
  double largest = 0;
  for (unsigned corner = 0; corner < 8; corner++) {
    float v[3];
    double w[3];
    for (unsigned k = 0; k < 3; k++)
      v[k] = bounds[corner >> k & 1u][k];
    turned(matrix, 4, v, w);
    for (int k = 0; k < 3; k++)
      largest = fmax(largest, fabs(w[k] + matrix[4 * k + 3]));
  }
  return (float)largest;
}

/* Where meshes that change their shape are. */
static bool build_deforms(build *b) {
  scene *s = b->scene;
  s->deform = b->moved ? array(b, s->meshes, sizeof *s->deform) : NULL;
  for (size_t i = 0; s->deform && i < s->meshes; i++) {
    const mesh *m = &s->mesh[i];
    if (!m->steps || b->shared[i] == WORLD)
      continue;
    const share *sh = &b->share[b->shared[i]];
    s->deform[i] = (deform){.steps = m->steps,
                            .positions = (uint32_t)m->positions,
                            .records = (uint32_t)m->triangles,
                            .position = sh->position,
                            .normal = sh->moved};
  }
  return !b->moved || s->deform;
}

/* The instances that refer to a share; number 0 is the world itself. */
static bool build_placed(build *b) {
  scene *s = b->scene;
  size_t count = 1;
  for (const instance *in = s->instance; in < s->instance + s->instances; in++)
    count += is_reference(b, in);
  if (count == 1)
    return true;
  s->placed = array(b, count, sizeof *s->placed);
  if (!s->placed)
    return false;
  s->placed[0] = (placed){.normal = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          .linear = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          .single = 2 * (uint32_t)s->quad_count,
                          .scale = 1.0f,
                          .mirror = 1.0f,
                          .reach = -1.0f};
  s->placed_count = 1;
  for (const instance *in = s->instance; in < s->instance + s->instances; in++) {
    if (!is_reference(b, in))
      continue;
    const share *of = &b->share[b->shared[in->mesh]];
    placed *p = &s->placed[s->placed_count++];
    *p = (placed){.quad = 2 * (uint32_t)of->quad,
                  .single = (uint32_t)(2 * s->quad_count + of->single),
                  .singles = (uint32_t)b->parts[in->mesh].singles,
                  .object = (uint32_t)(in - s->instance),
                  .hidden = (uint32_t)in->hidden,
                  .reach = reach_of(b->share[b->shared[in->mesh]].bounds, in->matrix)};
    world_place(in->matrix, p);
    if (s->features.motion && in->motion.steps)
      p->motion = &in->motion;
    if (s->mesh[in->mesh].steps)
      p->deform = &s->deform[in->mesh];
    for (int k = 0; k < in->motion.steps; k++) {
      float at[12];
      double matrix[12];
      motion_at(&in->motion, (float)k / (float)(in->motion.steps - 1), at);
      for (int i = 0; i < 12; i++)
        matrix[i] = (double)at[i];
      p->reach = fmaxf(p->reach, reach_of(b->share[b->shared[in->mesh]].bounds, matrix));
    }
    s->features.object_motion = s->features.object_motion || p->motion || p->deform;
  }
  return true;
}

void world_corners(const scene *s, uint32_t record, uint32_t out[3]) {
  static const uint32_t half[2][3] = {{0, 1, 3}, {2, 3, 1}};
  uint32_t base = (uint32_t)(2 * s->quad_count);
  const uint32_t *quad = s->world[1], *single = s->world[2];
  for (int k = 0; k < 3; k++)
    out[k] = record < base ? quad[4 * (size_t)(record / 2) + half[record & 1u][k]]
                           : single[3 * (size_t)(record - base) + (size_t)k];
}

void world_place(const double matrix[12], placed *out) {
  share own;
  normal_matrix(matrix, &own);
  out->mirror = own.mirror;
  scaled_matrix(own.normal, 3, out->normal);
  out->scale = scaled_matrix(matrix, 4, out->linear);
}

void world_object(const double m[12], object *out) {
  share own;
  normal_matrix(m, &own); /* the inverse's transpose times |determinant| */
  double size = fabs(m[0] * own.normal[0] + m[1] * own.normal[1] + m[2] * own.normal[2]);
  for (int r = 0; r < 3; r++) {
    double moved = 0;
    for (int c = 0; c < 3; c++) {
      double part = size > 0 && isfinite(size) ? own.normal[3 * c + r] / size : 0.0;
      out->inverse[4 * r + c] = (float)part;
      moved -= part * m[4 * c + 3];
    }
    out->inverse[4 * r + 3] = (float)moved;
  }
  for (int k = 0; k < 12; k++)
    out->matrix[k] = (float)m[k];
}

/* What nodes may ask of each instance. */
static bool build_objects(build *b) {
  scene *s = b->scene;
  s->object = array(b, s->instances, sizeof *s->object);
  for (size_t i = 0; s->object && i < s->instances; i++) {
    const instance *in = &s->instance[i];
    object *out = &s->object[i];
    *out = (object){.pass_index = (float)in->pass_index,
                    .random = in->random,
                    .told = in->told,
                    .metres = {in->metres[0], in->metres[1]}};
    memcpy(out->color, in->color, sizeof out->color);
    world_object(in->matrix, out);
  }
  return s->object != NULL;
}

static bool build_world(build *b) {
  scene *s = b->scene;
  b->parts = parts_make(s, NULL, b->cancel, b->log);
  if (!b->parts || !share_out(b))
    return false;
  parallel_for(s->threads, b->shares, place_positions, b);
  parallel_for(s->threads, b->chunk[b->shares], place_chunk, b);
  for (size_t i = 0; s->features.shadow_terminator && !s->features.curved && i < s->triangle_count;
       i++)
    s->features.curved = s->triangle[i].curved;
  return !cancelled(b) && build_deforms(b);
}

/* Those that stand in the world itself, at their new places. */
static bool move_own(build *b) {
  const scene *s = b->scene;
  bool *wanted = calloc(s->meshes + 1, sizeof *wanted);
  for (size_t i = 0; wanted && i < b->own; i++)
    wanted[b->share[i].mesh] = true;
  parts *made = wanted ? parts_make(s, wanted, b->cancel, b->log) : NULL, *counts = b->parts;
  free(wanted);
  if (!made)
    return message_error(b->log, "out of memory");
  b->parts = made;
  for (size_t i = 0; i < b->own; i++)
    normal_matrix(b->share[i].matrix, &b->share[i]);
  parallel_for(s->threads, b->own, place_positions, b);
  parallel_for(s->threads, b->chunk[b->own], place_chunk, b);
  b->parts = counts;
  parts_free(made, s);
  return true;
}

/* Of how many of its triangles strokes go by its tangents, and of how many of these the UV map says
 * no direction. */
static size_t count_grooved(const scene *s, const mesh *m, size_t *lost) {
  size_t grooved = 0;
  *lost = 0;
  for (size_t t = 0; t < m->triangles; t++) {
    const material *of = &s->material[m->material[t]];
    if (!(of->traits & CLOSURE_GROOVED) || of->turned)
      continue;
    const float *a = m->corner_uv ? m->corner_uv + 6 * t : NULL;
    grooved++;
    *lost += !a || !uv_spans(a[0], a[1], a[2], a[3], a[4], a[5]);
  }
  return grooved;
}

static void warn_of_grooves(const scene *s, message_log *log) {
  for (const mesh *m = s->mesh; m < s->mesh + s->meshes; m++) {
    size_t lost, grooved = count_grooved(s, m, &lost);
    if (grooved && !m->corner_uv)
      message_warn(log, "%s has no UV map: its tangent is the object's X axis", m->name);
    else if (lost && lost == grooved)
      message_warn(log, "%s: its UV map has no area: its tangent is the object's X axis", m->name);
    else if (50 * lost > grooved) /* some are in most maps, at poles */
      message_warn(log, "%s: %d%% of its UV map has no area: strokes there go as those beside it",
                   m->name, (int)(100.0 * (double)lost / (double)grooved));
  }
}

/* What Embree is to know of the shares from `first` on; the arrays' own for the world. */
static accel_part part_of(const build *b, size_t quad, size_t quads, size_t single,
                          size_t singles) {
  return (accel_part){.quads = quads,
                      .triangles = singles,
                      .quad_position = b->quad + 4 * quad,
                      .triangle_position = b->single + 3 * single};
}

static bool build_accel(build *b) { /* or places it again, where there is one */
  scene *s = b->scene;
  char error[MESSAGE_SIZE];
  size_t shared = b->shares - b->own, references = s->placed_count ? s->placed_count - 1 : 0;
  accel_part *part = array(b, shared, sizeof *part);
  accel_instance *reference = array(b, references, sizeof *reference);
  bool good = part && reference;
  for (size_t i = 0; good && i < shared; i++) {
    const share *sh = &b->share[b->own + i];
    part[i] =
        part_of(b, sh->quad, b->parts[sh->mesh].pairs, sh->single, b->parts[sh->mesh].singles);
    part[i].steps = s->mesh[sh->mesh].steps;
    part[i].stride = s->mesh[sh->mesh].positions;
  }
  accel_instance *next = reference;
  for (size_t i = 0; good && i < s->instances; i++)
    if (is_reference(b, &s->instance[i])) {
      next->part = b->shared[s->instance[i].mesh] - b->own;
      for (int k = 0; k < 12; k++)
        next->matrix[k] = (float)s->instance[i].matrix[k];
      next->hidden = (uint32_t)s->instance[i].hidden;
      next->motion =
          s->features.motion && s->instance[i].motion.steps ? &s->instance[i].motion : NULL;
      next++;
    }
  accel_input input = {.positions = b->positions,
                       .position = b->position,
                       .world = part_of(b, 0, b->own_quads, 0, b->own_singles),
                       .parts = shared,
                       .instances = references,
                       .part = part,
                       .instance = reference,
                       .quad_hidden = s->hidden,
                       .triangle_hidden = s->hidden ? s->hidden + 2 * s->quad_count : NULL,
                       .timed = s->features.object_motion,
                       .hasty = s->hasty};
  error[0] = 0;
  if (good && s->accel)
    good = accel_place(s->accel, &input, error, sizeof error);
  else if (good)
    good = (s->accel = accel_create(&input, s->threads, b->cancel, error, sizeof error)) != NULL;
  if (error[0])
    message_error(b->log, "%s", error);
  free(part);
  free(reference);
  return good;
}

static bool same_mesh(const mesh *a, const mesh *b, size_t layers) {
  for (size_t k = 0; k < layers; k++)
    if (a->layer[k] != b->layer[k])
      return false;
  return a->position == b->position && a->positions == b->positions &&
         a->triangles == b->triangles && a->corner_position == b->corner_position &&
         a->corner_normal == b->corner_normal && a->corner_uv == b->corner_uv &&
         a->material == b->material;
}

/* Would the arrays of both be alike, but for where things are? */
static bool same_world(const scene *a, const scene *b) {
  bool same = a->meshes == b->meshes && a->instances == b->instances && a->layers == b->layers &&
              a->threads == b->threads && a->apart == b->apart && !a->features.motion &&
              !b->features.motion && !a->features.motion_vectors && !b->features.motion_vectors &&
              a->features.shadow_terminator == b->features.shadow_terminator &&
              a->features.derivatives == b->features.derivatives && is_veiled(a) == is_veiled(b);
  for (size_t k = 0; same && k < a->layers; k++)
    same = a->layer[k].width == b->layer[k].width &&
           a->layer[k].tangents_of == b->layer[k].tangents_of;
  for (size_t k = 0; same && k < a->meshes; k++)
    same = same_mesh(&a->mesh[k], &b->mesh[k], a->layers);
  for (size_t k = 0; same && k < a->instances; k++)
    same = a->instance[k].mesh == b->instance[k].mesh &&
           a->instance[k].hidden == b->instance[k].hidden;
  return same;
}

void world_take(scene *to, scene *from) {
  world_plan *plan = from->plan;
  to->hasty = plan || from->hasty; /* until its world turns out to be the same */
  if (!plan || !same_world(to, from))
    return;
  build now = plan->made;
  now.scene = to;
  now.reach = find_reach(to);
  plan->moved = plan->own_moved = false;
  for (size_t i = 0; i < to->instances; i++) {
    const instance *in = &to->instance[i], *before = &from->instance[i];
    bool reference = is_reference(&now, in);
    if (reference != is_reference(&plan->made, before))
      return;
    bool moved = memcmp(in->matrix, before->matrix, sizeof in->matrix) != 0;
    plan->moved = plan->moved || moved;
    plan->own_moved = plan->own_moved || (moved && !reference);
  }
  plan->made = now;
  to->hasty = from->hasty;
  for (size_t i = 0; i < now.own; i++)
    now.share[i].matrix = to->instance[now.share[i].object].matrix;
  to->plan = plan;
  from->plan = NULL;
  to->triangle = from->triangle;
  to->stretch = from->stretch;
  to->hidden = from->hidden;
  to->accel = from->accel;
  from->triangle = NULL;
  from->stretch = NULL;
  from->hidden = NULL;
  from->accel = NULL;
  to->triangle_count = from->triangle_count;
  to->quad_count = from->quad_count;
  to->features.curved = from->features.curved;
  for (size_t k = 0; k < to->layers; k++) {
    to->layer[k].corner = from->layer[k].corner;
    to->layer[k].record = from->layer[k].record;
    from->layer[k].corner = NULL;
  }
  for (int k = 0; k < 3; k++) {
    to->world[k] = from->world[k];
    from->world[k] = NULL;
  }
}

void world_plan_free(world_plan *plan) {
  if (!plan)
    return;
  free(plan->made.parts);
  free(plan->made.share);
  free(plan->made.shared);
  free(plan->made.chunk);
  free(plan);
}

/* Keep what tells how the world was made. */
static void keep_plan(scene *s, const build *b) {
  s->plan = calloc(1, sizeof *s->plan);
  if (s->plan)
    s->plan->made = *b;
}

/* What has moved of a world that was taken over. */
static bool build_again(scene *s, const atomic_bool *cancel, message_log *log, scene_times *times) {
  build *b = &s->plan->made;
  double start = parallel_clock();
  b->cancel = cancel;
  b->log = log;
  find_bases(b);
  bool good = (!s->plan->own_moved || move_own(b)) && build_placed(b) &&
              (!s->features.object_info || build_objects(b));
  double built = parallel_clock();
  good = good && (!s->plan->moved || build_accel(b));
  times->mesh = built - start;
  times->bvh = parallel_clock() - built;
  return good;
}

bool world_build(scene *s, const atomic_bool *cancel, message_log *log, scene_times *times) {
  warn_of_grooves(s, log);
  if (s->plan)
    return build_again(s, cancel, log, times);
  build b = {.scene = s, .cancel = cancel, .log = log};
  double start = parallel_clock();
  bool good =
      build_world(&b) && build_placed(&b) && (!s->features.object_info || build_objects(&b));
  parts_used(b.parts, s); /* room for the BVH */
  double built = parallel_clock();
  good = good && build_accel(&b) && !cancelled(&b);
  times->mesh = built - start;
  times->bvh = parallel_clock() - built;
  s->world[0] = b.position; /* Embree reads these while it lives */
  s->world[1] = b.quad;
  s->world[2] = b.single;
  if (good && s->apart)
    keep_plan(s, &b);
  if (s->plan)
    return true;
  parts_free(b.parts, s);
  free(b.share);
  free(b.shared);
  free(b.chunk);
  return good;
}
