/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/read.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light/pattern.h"
#include "light/light.h"
#include "closure/closure.h"
#include "node/node.h"
#include "render/build.h"
#include "render/matte.h"
#include "render/plane.h"
#include "system/parallel.h"

enum {
  MAX_SIZE = 1 << 16,
  MAX_SAMPLES = 1 << 16,
  MAX_THREADS = 256,
  MAX_BOUNCES = 1024,
  MAX_INDEX = 32767,
  MAX_ATTRIBUTES = 1 << 20,
  LINKS_MOST = 30 /* lights that are for some instances alone */
};

/* Embree takes no rays whose numbers are larger than 1.8e18. */
static float within_reach(double x) {
  return (float)(x < -1e17 ? -1e17 : x > 1e17 ? 1e17 : x);
}

static bool read_lens(reader *r, camera *c) {
  static const reader_key keys[] = {FLOATS_KEY("lens", camera, lens, 2),
                                    NUMBER_KEY("focus", camera, focus, 1e-6f, 1e18f),
                                    INTEGER_KEY("blades", camera, blades, 0, 1024),
                                    NUMBER_KEY("turn", camera, turn, -1e3f, 1e3f),
                                    {.name = NULL}};
  if (!reader_keys(r, keys, c))
    return false;
  if (!(c->lens[0] >= 0 && c->lens[1] >= 0))
    return reader_expected(r, "lens", "two lengths from 0 on");
  for (int k = 0; k < 2; k++)
    c->lens[k] = within_reach((double)c->lens[k]);
  return true;
}

/* Places at evenly spaced times, from 0 to 1: 12 numbers each. What cannot move stays. */
static bool read_motion(reader *r, motion *out) {
  reader_buffer items;
  if (!reader_has(r, "motion"))
    return true;
  if (!reader_items(r, "motion", SIZE_MAX, "f", 4, &items))
    return false;
  size_t steps = items.size / (12 * sizeof(float));
  if (items.size != 12 * steps * sizeof(float) || steps < 2 || steps > MOTION_STEPS_MOST)
    return reader_expected(r, "motion", "12 numbers at each of 2 to 129 times");
  return motion_make(items.data, (int)steps, out) || !out->steps || reader_out_of_memory(r);
}

static bool read_frames(reader *r, camera *c) {
  reader_buffer items;
  size_t bytes = 4 * (size_t)c->motion.steps * sizeof *c->frames;
  if (!c->motion.steps || !reader_has(r, "frames"))
    return true;
  if (!reader_items(r, "frames", bytes / sizeof(float), "f", 4, &items))
    return false;
  c->frames = malloc(bytes);
  if (!c->frames)
    return reader_out_of_memory(r);
  for (size_t k = 0; k < bytes / sizeof(float); k++)
    c->frames[k] = within_reach((double)((const float *)items.data)[k]);
  return true;
}

#define PANORAMA_WORD(WORD) #WORD,
static bool read_panorama(reader *r, camera *c) {
  static const char *const words[] = {PANORAMA_TABLE(PANORAMA_WORD) NULL};
  static const reader_key keys[] = {WORD_KEY("panorama", camera, panorama, words),
                                    FLOATS_KEY("range", camera, range, 4),
                                    NUMBER_KEY("fov", camera, fov, 0, 100),
                                    NUMBER_KEY("focal", camera, focal, 1e-6, 1e6),
                                    FLOATS_KEY("sensor", camera, sensor, 2),
                                    FLOATS_KEY("polynomial", camera, polynomial, 5),
                                    {.name = NULL}};
  if (!reader_keys(r, keys, c))
    return false;
  for (int k = 0; k < 4; k++) /* sines of what is larger would be noise */
    c->range[k] = fminf(fmaxf(c->range[k], -1e4f), 1e4f);
  for (int k = 0; k < 2; k++)
    c->sensor[k] = fminf(fmaxf(c->sensor[k], -1e6f), 1e6f);
  return c->panorama != PANORAMA_NONE || reader_expected(r, "panorama", "a kind");
}

static bool read_camera(reader *r, void *out, void *context) {
  static const char *const types[] = {"ORTHO", "PERSP", "PANO", NULL};
  camera *c = out;
  double matrix[16];
  int type;
  (void)context;
  if (!reader_word(r, "type", types, &type) || !reader_numbers(r, "matrix", 16, matrix) ||
      !reader_floats(r, "frame", 4, c->frame) || !reader_floats(r, "clip", 2, c->clip))
    return false;
  c->perspective = type != 0;
  if (type == 2 && !read_panorama(r, c))
    return false;
  for (int k = 0; k < 4; k++)
    c->frame[k] = within_reach((double)c->frame[k]);
  for (int column = 0; column < 3; column++) {
    vec3 axis = {(float)matrix[column], (float)matrix[4 + column], (float)matrix[8 + column]};
    if (!make_unit(&axis))
      return reader_expected(r, "matrix", "invertible");
    memcpy(c->axis[column], &axis, sizeof axis);
  }
  for (int row = 0; row < 3; row++)
    c->origin[row] = within_reach(matrix[4 * row + 3]);
  if (!(c->clip[0] >= 0 && c->clip[0] < c->clip[1])) /* Embree's rays begin at 0 or later */
    return reader_expected(r, "clip", "two distances from 0 on, near before far");
  if (!read_motion(r, &c->motion) || !read_frames(r, c))
    return false;
  return !reader_has(r, "lens") || read_lens(r, c);
}

#define LIGHT_WORD(TYPE, name) #TYPE,
#define LIGHT_READ(TYPE, name)                                                                     \
  case LIGHT_##TYPE:                                                                               \
    return light_##name##_read(r, &l->common, &l->of.name);
static bool read_kind_of_light(reader *r, light *l) {
  static const char *const types[] = {LIGHT_TABLE(LIGHT_WORD) NULL};
  int type;
  if (!reader_word(r, "type", types, &type))
    return false;
  switch (l->type = (light_type)type) {
    LIGHT_TABLE(LIGHT_READ)
  case LIGHT_TYPES:
    break;
  }
  return false;
}

/* The bits of a light that is for some instances alone, and of one that some alone shade; or 0. */
static bool read_links(reader *r, scene *s, uint32_t *link, uint32_t *shade) {
  int bit[2] = {-1, -1};
  if ((reader_has(r, "link") && !reader_integer(r, "link", 0, LINKS_MOST - 1, &bit[0])) ||
      (reader_has(r, "shade") && !reader_integer(r, "shade", 0, LINKS_MOST - 1, &bit[1])))
    return false;
  *link = bit[0] < 0 ? 0 : 1u << bit[0];
  *shade = bit[1] < 0 ? 0 : 1u << bit[1];
  s->features.shadow_linking |= *shade != 0;
  return true;
}

static bool read_pattern(reader *r, void *out, void *context) {
  static const reader_key keys[] = {INTEGER_KEY("width", light_pattern, width, 1, MAX_SIZE),
                                    INTEGER_KEY("height", light_pattern, height, 1, MAX_SIZE),
                                    {.name = NULL}};
  static const reader_key options[] = {FLAG_KEY("face", light_pattern, face),
                                       INTEGER_KEY("gain", light_pattern, gain, 0, 2),
                                       NUMBER_KEY("smooth", light_pattern, smooth, 0, 1e18),
                                       {.name = NULL}};
  light_pattern **made = out, *p = *made = calloc(1, sizeof *p);
  const light *l = context;
  float axes[9];
  reader_buffer data;
  bool upright = false;
  if (!p)
    return reader_out_of_memory(r);
  if (!reader_keys(r, keys, p) || !reader_options(r, options, p) ||
      !reader_floats(r, "axes", 9, axes) || !reader_may_flag(r, "upright", &upright))
    return false;
  if (p->face && l->type != LIGHT_AREA)
    return reader_expected(r, "face", "an area light");
  size_t count = 3 * (size_t)p->width * (size_t)p->height;
  if (!reader_items(r, "data", count, "f", 4, &data))
    return false;
  if (!(p->texel = malloc(count * sizeof(float))))
    return reader_out_of_memory(r);
  for (size_t k = 0; k < count; k++) {
    float x = ((const float *)data.data)[k];
    p->texel[k] = x > 0.0f ? fminf(x, 1e18f) : 0.0f; /* not a number: none */
  }
  for (int k = 0; k < 3; k++) {
    p->axis[k] = (vec3){axes[3 * k], axes[3 * k + 1], axes[3 * k + 2]};
    if (!make_unit(&p->axis[k]))
      return reader_expected(r, "axes", "three directions");
  }
  const light_bulb *bulb = l->type == LIGHT_SPOT ? &l->of.spot.bulb : &l->of.point.bulb;
  if (l->type == LIGHT_AREA) {
    p->middle = l->of.area.center;
    p->flat = l->common.soft; /* without an extent all of it is the middle */
    p->normal = l->of.area.normal;
    for (int k = 0; k < 2; k++)
      p->across[k] = p->flat ? l->of.area.across[k] : (vec3){0, 0, 0};
  } else {
    p->ball = bulb->ball != 0;
    p->bulb = bulb->radius;
    p->middle = (vec3){bulb->position[0], bulb->position[1], bulb->position[2]};
    p->radius = bulb->ball && upright ? bulb->radius : 0.0f;
  }
  return true;
}

/* met: missing means yes. Light that throws no shadows would be met only where nothing is before
 * it: it is sampled alone. */
static bool read_light(reader *r, void *out, void *context) {
  static const reader_key options[] = {INTEGER_KEY("hidden", light, common.hidden, 0, RAY_BOUNCED),
                                       {.name = NULL}};
  light *l = out;
  light_common *c = &l->common;
  scene *s = context;
  bool mis = true;
  if (!reader_flag(r, "shadow", &c->shadow) || !read_kind_of_light(r, l) ||
      !reader_may_flag(r, "met", &mis) || !reader_options(r, options, l))
    return false;
  s->features.light_visibility |= c->hidden != 0;
  if (reader_has(r, "pattern")) {
    if (l->type == LIGHT_SUN)
      return reader_fail(r, "a sun shines one way and has no pattern");
    if (!reader_dict(r, "pattern", read_pattern, &c->pattern, l))
      return false;
  }
  if (!read_links(r, s, &c->link, &c->shade))
    return false;
  c->mis = mis && c->soft && c->shadow && !c->link && !c->shade;
  for (int k = 0; k < 3; k++) /* a highlight of what is brighter would be no number */
    c->color[k] = fminf(fmaxf(c->color[k], -1e30f), 1e30f);
  c->power = (fabsf(c->color[0]) + fabsf(c->color[1]) + fabsf(c->color[2])) / 3.0f;
  return true;
}

static bool read_image(reader *r, void *out, void *context) {
  static const char *const wraps[] = {"REPEAT", "EXTEND", "CLIP", "MIRROR", NULL};
  static const char *const filters[] = {"LINEAR", "CLOSEST", NULL};
  static const reader_key keys[] = {
      INTEGER_KEY("width", image, width, 1, MAX_SIZE),
      INTEGER_KEY("height", image, height, 1, MAX_SIZE),
      INTEGER_KEY("channels", image, channels, 1, 4),
      FLAG_KEY("srgb", image, srgb),
      WORD_KEY("wrap", image, wrap, wraps), /* in the order of the enum */
      {.name = NULL}};
  image *m = out;
  int filter;
  reader_buffer data;
  (void)context;
  if (!reader_keys(r, keys, m) || !reader_word(r, "filter", filters, &filter))
    return false;
  if ((size_t)(m->width + TEXTURE_RIM) * (size_t)(m->height + TEXTURE_RIM) > INT32_MAX)
    return reader_fail(r, "the image has too many pixels");
  size_t count = (size_t)m->width * (size_t)m->height * (size_t)m->channels;
  if (!reader_items(r, "data", count, "fHB", 0, &data))
    return false;
  m->type = data.item_size == 4 ? IMAGE_FLOAT32 : data.item_size == 2 ? IMAGE_UINT16 : IMAGE_UINT8;
  m->data = data.data;
  if (!reader_may_flag(r, "paged", &m->paged) || !reader_may_flag(r, "wide", &m->wide))
    return false;
  m->wide = m->wide && m->type == IMAGE_FLOAT32 && !m->srgb;
  m->closest = filter == 1;
  return true;
}

#define NODE_WORD(TYPE, name) #TYPE,
#define NODE_READ(TYPE, name)                                                                      \
  case NODE_##TYPE:                                                                                \
    return node_##name##_read(r, &n->of.name, g);
static bool read_node(reader *r, void *out, void *context) {
  static const char *const types[] = {NODE_TABLE(NODE_WORD) NULL};
  graph *g = context;
  node *n = out;
  int type;
  if (!reader_word(r, "type", types, &type))
    return false;
  switch (n->type = (node_type)type) {
    NODE_TABLE(NODE_READ)
  case NODE_TYPES:
    break;
  }
  return false;
}

#define CLOSURE_WORD(TYPE, name, always) #TYPE,
#define CLOSURE_READ(TYPE, name, always)                                                           \
  case CLOSURE_##TYPE:                                                                             \
    g->traits = always;                                                                            \
    return closure_##name##_read(r, &c->of.name, g);
static bool read_kind_of_closure(reader *r, closure *c, graph *g) {
  switch (c->type) {
    CLOSURE_TABLE(CLOSURE_READ)
  case CLOSURE_TYPES:
    break;
  }
  return false;
}

static bool read_closure(reader *r, void *out, void *context) {
  static const char *const types[] = {CLOSURE_TABLE(CLOSURE_WORD) NULL};
  graph *g = context;
  closure *c = out;
  int type;
  for (int k = 0; k < 3; k++)
    c->weight[k] = (operand){.at = OPERAND_NUMBER, .number = 1.0f};
  c->colored = reader_has(r, "pass_color");
  if (!reader_word(r, "closure", types, &type) ||
      (reader_has(r, "weight") && !graph_operands(r, g, "weight", 3, c->weight)) ||
      (c->colored && !graph_operands(r, g, "pass_color", 3, c->color)))
    return false;
  c->type = (closure_type)type;
  g->exponent = g->focus = 0;
  bool good = read_kind_of_closure(r, c, g);
  c->traits = g->traits;
  c->exponent = g->exponent;
  c->focus = g->focus;
  return good;
}

/* A list, or one as the material itself. */
static bool read_closures(reader *r, graph *g, material *m) {
  m->closures = 1;
  if (!reader_has(r, "closures")) {
    m->closure = calloc(1, sizeof *m->closure);
    return m->closure ? read_closure(r, m->closure, g) : reader_out_of_memory(r);
  }
  if (!reader_each(r, "closures", sizeof(closure), &m->closures, &m->closure, read_closure, g))
    return false;
  return (m->closures >= 1 && m->closures <= CLOSURES_MOST) ||
         reader_fail(r, "closures has %zu items; 1 to %d are expected", m->closures,
                     (int)CLOSURES_MOST);
}

static bool read_material(reader *r, void *out, void *context) {
  static const reader_key options[] = {
      INTEGER_KEY("pass_index", material, pass_index, 0, MAX_INDEX),
      FLOATS_KEY("matte", material, matte, 1),
      {.name = NULL}};
  scene *s = context;
  material *m = out;
  graph g = {.features = &s->features,
             .images = s->images,
             .cloth = s->cloth,
             .cloths = s->cloths,
             .scratches = s->scratches,
             .scratch_fields = s->scratch_fields,
             .layers = s->layers,
             .attributes = (size_t)s->attributes,
             .dump = s->dump != NULL};
  m->number = (int)(m - s->material);
  bool drawn = true;
  if (!reader_options(r, options, m) || !reader_may_flag(r, "drawn", &drawn) ||
      !reader_may_flag(r, "turned", &m->turned))
    return false;
  m->undrawn = !drawn;
  if (!reader_text(r, "name", NULL, &m->name) ||
      !reader_each(r, "nodes", sizeof(node), &m->nodes, &m->node, read_node, &g))
    return false;
  g.named = false;
  for (int k = 0; k < 3; k++)
    g.normal[k] = REGISTER_NORMAL + k;
  if (!read_closures(r, &g, m))
    return false;
  m->status = g.status;
  for (size_t k = 0; k < m->closures; k++)
    m->traits |= m->closure[k].traits;
  memcpy(m->normal, g.normal, sizeof m->normal);
  m->bare = g.bare || !g.named;
  s->features.transparency |= (m->traits & CLOSURE_PASSES) != 0;
  s->features.holdout |= (m->traits & CLOSURE_HOLDS) != 0;
  return true;
}

typedef struct look_reader {
  scene *of;
  int images;
  uint8_t number; /* of the one that is read, from 1 on */
} look_reader;

/* `rays`: by which ways they come, each a sum of ray_kinds. */
static bool read_look(reader *r, void *out, void *context) {
  look_reader *looks = context;
  scene *s = looks->of;
  ray_look *look = out;
  reader_buffer rays;
  if (looks->number++ == MAX_LOOKS)
    return reader_fail(r, "there are more looks than ways");
  if (!reader_items(r, "rays", SIZE_MAX, "IL", sizeof(uint32_t), &rays))
    return false;
  const uint32_t *ray = rays.data;
  for (size_t k = 0; k < rays.size / sizeof *ray; k++) {
    unsigned way = ray_way(ray[k]);
    if (!way || (ray[k] & ~(uint32_t)(RAY_BOUNCED | RAY_SINGULAR)))
      return reader_expected(r, "rays", "kinds of rays that surfaces draw");
    s->look_of[way] = looks->number;
  }
  if (reader_has(r, "sky"))
    return sky_read(r, "sky", &look->sky, looks->images);
  return reader_floats(r, "background", 3, look->even);
}

/* `backdrop`: a colour, `backdrop_sky`: an image or sky that rays of the camera see instead,
 * whatever lights the scene. */
static bool read_sky(reader *r, scene *s) {
  int images = (int)(s->images < INT_MAX ? s->images : INT_MAX);
  if (reader_has(r, "sky")) {
    memset(s->background, 0, sizeof s->background);
    if (!sky_read(r, "sky", &s->sky, images))
      return false;
  }
  bool apart = reader_has(r, "backdrop"), hidden = (s->sky_hidden & RAY_CAMERA) != 0;
  memcpy(s->backdrop, s->background, sizeof s->backdrop);
  if (apart && !reader_floats(r, "backdrop", 3, s->backdrop))
    return false;
  if (reader_has(r, "backdrop_sky") && !sky_read(r, "backdrop_sky", &s->behind, images))
    return false;
  apart = apart || s->behind.there;
  s->behind.there = s->behind.there && !hidden;
  if (hidden || s->behind.there)
    memset(s->backdrop, 0, sizeof s->backdrop);
  if (apart)
    s->sky_hidden |= RAY_CAMERA;
  look_reader looks = {.of = s, .images = images};
  if (!reader_has(r, "looks"))
    return true;
  return reader_each(r, "looks", sizeof(ray_look), &s->looks, &s->look, read_look, &looks);
}

static bool all_below(size_t count, const uint32_t *index, size_t limit) {
  uint32_t largest = 0;
  for (size_t i = 0; i < count; i++)
    largest = index[i] > largest ? index[i] : largest;
  return count == 0 || largest < limit;
}

/* So many numbers of four bytes, which stay the reader's; formats: "f", or INDEX. */
#define INDEX "iIlL"
static bool read_array(reader *r, const char *key, size_t count, const char *formats, void *out) {
  reader_buffer items;
  bool good = reader_items(r, key, count, formats, 4, &items);
  if (good)
    memcpy(out, &items.data, sizeof items.data);
  return good;
}

/* What a mesh has of one of the scene's layers. */
typedef struct own_layer {
  int number;
  const float *data;
} own_layer;

typedef struct layer_reader {
  const scene *of;
  size_t triangles;
} layer_reader;

static bool read_own_layer(reader *r, void *out, void *context) {
  const layer_reader *m = context;
  own_layer *own = out;
  if (!reader_integer(r, "layer", 0, (long)m->of->layers - 1, &own->number))
    return false;
  size_t width = (size_t)m->of->layer[own->number].width;
  return read_array(r, "data", 3 * width * m->triangles, "f", &own->data);
}

static bool read_layers_of(reader *r, const scene *s, mesh *m) {
  layer_reader context = {.of = s, .triangles = m->triangles};
  own_layer *list = NULL;
  size_t count;
  if (!s->layers)
    return true;
  m->layer = calloc(s->layers, sizeof *m->layer);
  if (!m->layer)
    return reader_out_of_memory(r);
  bool good = !reader_has(r, "layers") ||
              reader_each(r, "layers", sizeof *list, &count, &list, read_own_layer, &context);
  for (size_t k = 0; good && list && k < count; k++)
    m->layer[list[k].number] = list[k].data;
  free(list);
  return good;
}

static bool read_layer(reader *r, void *out, void *context) {
  const scene *s = context;
  layer *l = out;
  int before = (int)(l - s->layer);
  l->tangents_of = -1;
  return reader_integer(r, "width", 2, 4, &l->width) &&
         (l->width != 3 || reader_expected(r, "width", "2 or 4")) &&
         (!reader_has(r, "tangents_of") ||
          (reader_integer(r, "tangents_of", 0, before - 1, &l->tangents_of) &&
           ((l->width == 4 && s->layer[l->tangents_of].width == 2) ||
            reader_expected(r, "tangents_of", "a layer of two numbers"))));
}

/* Of a mesh that changes its shape: positions and normals at evenly spaced times. */
static bool read_shapes(reader *r, bool vectors, mesh *m) {
  reader_buffer items;
  if (!reader_has(r, "moved_positions") || !m->positions || !m->triangles)
    return true;
  if (!reader_items(r, "moved_positions", SIZE_MAX, "f", 4, &items))
    return false;
  size_t steps = items.size / (12 * m->positions);
  if (items.size != 12 * m->positions * steps || steps < 2 || steps > MOTION_STEPS_MOST)
    return reader_expected(r, "moved_positions", "all positions at each of 2 to 129 times");
  m->moved_position = items.data;
  *(vectors ? &m->shapes : &m->steps) = (int)steps;
  return read_array(r, "moved_normals", 9 * m->triangles * steps, "f", &m->moved_normal);
}

static bool read_mesh(reader *r, void *out, void *context) {
  const scene *s = context;
  mesh *m = out;
  char fallback[32];
  reader_buffer items;
  snprintf(fallback, sizeof fallback, "mesh %td", m - s->mesh);
  if (!reader_text(r, "name", fallback, &m->name) ||
      !reader_items(r, "positions", SIZE_MAX, "f", 4, &items))
    return false;
  m->position = items.data;
  m->positions = items.size / 12;
  if (items.size != 12 * m->positions)
    return reader_expected(r, "positions", "3 floats per position");
  if (!reader_items(r, "corner_position", SIZE_MAX, INDEX, 4, &items))
    return false;
  m->corner_position = items.data;
  m->triangles = items.size / 12;
  if (items.size != 12 * m->triangles)
    return reader_expected(r, "corner_position", "3 indices per triangle");
  if (m->triangles > UINT32_MAX / 4 || m->positions > UINT32_MAX / 4)
    return reader_fail(r, "the mesh has too many triangles");
  if (!read_array(r, "corner_normals", 9 * m->triangles, "f", &m->corner_normal) ||
      !read_array(r, "material", m->triangles, INDEX, &m->material) ||
      (reader_has(r, "corner_uvs") &&
       !read_array(r, "corner_uvs", 6 * m->triangles, "f", &m->corner_uv)) ||
      !read_layers_of(r, s, m) || !read_shapes(r, s->features.motion_vectors, m))
    return false;
  if (!all_below(3 * m->triangles, m->corner_position, m->positions))
    return reader_fail(r, "corner_position has an index outside of the %zu positions",
                       m->positions);
  if (!all_below(m->triangles, (const uint32_t *)m->material, s->materials))
    return reader_fail(r, "material has an index outside of the %zu materials", s->materials);
  return true;
}

static bool read_instance(reader *r, void *out, void *context) {
  enum { LINKS = (1 << LINKS_MOST) - 1, KINDS = RAY_CAMERA | RAY_BOUNCED | RAY_SHADOW };
  static const reader_key options[] = {
      INTEGER_KEY("pass_index", instance, pass_index, 0, MAX_INDEX),
      FLOATS_KEY("matte", instance, matte, 2),
      INTEGER_KEY("unlit", instance, unlit, 0, LINKS),
      INTEGER_KEY("shadeless", instance, shadeless, 0, LINKS),
      INTEGER_KEY("hidden", instance, hidden, 0, KINDS),
      FLOATS_KEY("metres", instance, metres, 2),
      FLOATS_KEY("color", instance, color, 4),
      NUMBER_KEY("random", instance, random, 0, 1),
      {.name = NULL}};
  scene *s = context;
  instance *in = out;
  double matrix[16];
  int index = 0;
  if (!reader_integer(r, "mesh", 0, (long)s->meshes - 1, &index) ||
      !reader_numbers(r, "matrix", 16, matrix))
    return false;
  in->mesh = (size_t)index;
  memcpy(in->matrix, matrix, sizeof in->matrix);
  for (int k = 0; k < 4; k++)
    in->color[k] = 1.0f;
  in->metres[0] = in->metres[1] = 1.0f;
  if (!reader_options(r, options, in) || !read_motion(r, &in->motion) ||
      !read_links(r, s, &in->link, &in->shade) ||
      (s->attributes && reader_has(r, "attributes") && /* without names none is asked for */
       !read_array(r, "attributes", 4 * (size_t)s->attributes, "f", &in->told)))
    return false;
  s->features.emitter_linking |= in->link || in->shade;
  in->unmoved = reader_has(r, "motion") && !in->motion.steps;
  s->features.motion |= in->unmoved || in->motion.steps || s->mesh[in->mesh].steps;
  return true;
}

/* Kinds that are wanted: a list of words, as bits. */
typedef struct word_list {
  const char *const *words;
  unsigned bits;
} word_list;

static bool read_word(reader *r, void *out, void *context) {
  word_list *list = context;
  int *kind = out;
  if (!reader_word(r, "type", list->words, kind))
    return false;
  list->bits |= 1u << *kind;
  return true;
}

static bool read_words(reader *r, const char *key, const char *const *words, unsigned *bits) {
  word_list list = {.words = words};
  size_t count;
  int *kinds = NULL;
  bool good =
      !reader_has(r, key) || reader_each(r, key, sizeof *kinds, &count, &kinds, read_word, &list);
  free(kinds);
  *bits = list.bits;
  return good;
}

static bool read_mist(reader *r, void *out, void *context) {
  static const char *const falloffs[] = {"LINEAR", "QUADRATIC", "INVERSE_QUADRATIC", NULL};
  static const reader_key keys[] = {NUMBER_KEY("start", mist, start, 0, 1e30),
                                    WORD_KEY("falloff", mist, falloff, falloffs),
                                    {.name = NULL}};
  mist *m = out;
  float depth;
  (void)context;
  if (!reader_keys(r, keys, m) || !reader_number_within(r, "depth", 0, 1e30, &depth))
    return false;
  m->rise = depth > 0.0f ? 1.0f / depth : 0.0f;
  return true;
}

/* When the shutter is open: times by an even number, and whether line after line. */
static bool read_shutter(reader *r, scene *s) {
  reader_buffer items;
  s->features.rolling_shutter = reader_has(r, "line_time");
  if (s->features.rolling_shutter && !reader_number_within(r, "line_time", 0, 1, &s->line_time))
    return false;
  if (!reader_has(r, "shutter"))
    return true;
  if (!reader_items(r, "shutter", SHUTTER_STEPS + 1, "f", 4, &items))
    return false;
  s->shutter = malloc(items.size);
  if (!s->shutter)
    return reader_out_of_memory(r);
  const float *from = items.data;
  for (size_t k = 0; k <= SHUTTER_STEPS; k++) /* NaN becomes 0 */
    s->shutter[k] = from[k] > 0.0f ? fminf(from[k], 1.0f) : 0.0f;
  return true;
}

/* How large the picture is, which part of it is wanted, and how well. */
static bool read_size(reader *r, scene *s) {
  static const reader_key keys[] = {INTEGER_KEY("width", scene, width, 1, MAX_SIZE),
                                    INTEGER_KEY("height", scene, height, 1, MAX_SIZE),
                                    INTEGER_KEY("samples", scene, samples, 1, MAX_SAMPLES),
                                    {.name = NULL}};
  double region[4];
  if (!reader_keys(r, keys, s) || !reader_numbers(r, "region", 4, region))
    return false;
  for (int k = 0; k < 4; k++) {
    int limit = k % 2 ? s->height : s->width;
    if (!(region[k] >= 0 && region[k] <= limit))
      return reader_expected(r, "region", "x0, y0, x1, y1 inside of the picture");
    s->region[k] = (int)region[k];
  }
  return (s->region[0] < s->region[2] && s->region[1] < s->region[3]) ||
         reader_fail(r, "region is empty");
}

#define PLANE_WORD(TYPE, channels, filtered) #TYPE,
#define MATTE_WORD(KIND) #KIND,
static bool read_planes(reader *r, scene *s) {
  static const char *const planes[] = {PLANE_TABLE(PLANE_WORD) NULL};
  static const char *const mattes[] = {MATTE_TABLE(MATTE_WORD) NULL};
  if (!read_words(r, "planes", planes, &s->planes) ||
      !read_words(r, "mattes", mattes, &s->mattes) ||
      (reader_has(r, "mattes") &&
       !reader_integer(r, "matte_slots", 1, MATTE_SLOTS_MOST, &s->matte_slots)))
    return false;
  if (s->features.denoise)
    s->planes |= 1u << PLANE_ALBEDO | 1u << PLANE_NORMAL;
  s->planes = plane_needs(s->planes);
  return true;
}

/* How often a path may do what. From some version on Cycles lets paths through one surface less
 * than shadow rays. */
static bool read_limits(reader *r, bounce_limits *limits, int all) {
  static const reader_key options[] = {
      INTEGER_KEY("diffuse_bounces", bounce_limits, kind[0], 0, MAX_BOUNCES),
      INTEGER_KEY("glossy_bounces", bounce_limits, kind[1], 0, MAX_BOUNCES),
      INTEGER_KEY("transmission_bounces", bounce_limits, kind[2], 0, MAX_BOUNCES),
      INTEGER_KEY("transparent_max_bounces", bounce_limits, kind[3], 0, MAX_BOUNCES),
      {.name = NULL}};
  bool less = false;
  uint32_t *straight = &limits->kind[BOUNCE_TRANSPARENT];
  *limits =
      (bounce_limits){.kind = {MAX_BOUNCES, MAX_BOUNCES, MAX_BOUNCES, 8}, .all = (uint32_t)all};
  if (!reader_options(r, options, limits) || !reader_may_flag(r, "transparent_less", &less))
    return false;
  limits->shadows = *straight;
  *straight -= less && *straight > 0;
  return true;
}

static bool read_picture(reader *r, scene *s) {
  static const char *const filters[] = {"BLACKMAN_HARRIS", "GAUSSIAN", NULL};
  static const reader_key keys[] = {INTEGER_KEY("threads", scene, threads, 0, MAX_THREADS),
                                    FLAG_KEY("transparent", scene, features.transparent_film),
                                    FLOATS_KEY("background", scene, background, 3),
                                    {.name = NULL}};
  static const reader_key options[] = {
      INTEGER_KEY("sky_hidden", scene, sky_hidden, 0, RAY_CAMERA | RAY_BOUNCED),
      NUMBER_KEY("reach", scene, reach, 0, 1e30),
      NUMBER_KEY("clear_glass", scene, clear_alpha, 0, 1),
      NUMBER_KEY("filter_width", scene, filter_width, 0, 100),
      WORD_KEY("pixel_filter_type", scene, filter, filters),
      FLAG_KEY("vectors", scene, features.motion_vectors),
      FLAG_KEY("matt_leans", scene, features.interpolated_diffuse),
      FLAG_KEY("soft_terminator", scene, features.shadow_terminator),
      FLAG_KEY("use_denoising", scene, features.denoise),
      NUMBER_KEY("time_limit", scene, time_limit, 0, 1e9),
      INTEGER_KEY("max_bounces", scene, max_bounces, 0, MAX_BOUNCES),
      NUMBER_KEY("sample_clamp_direct", scene, clamp_direct, 0, 1e30),
      NUMBER_KEY("sample_clamp_indirect", scene, clamp_indirect, 0, 1e30),
      NUMBER_KEY("adaptive_threshold", scene, adaptive_threshold, 0, 1e30),
      INTEGER_KEY("adaptive_min_samples", scene, adaptive_least, 1, MAX_SAMPLES),
      NUMBER_KEY("light_sampling_threshold", scene, light_threshold, 0, 1e30),
      NUMBER_KEY("texture_blur", scene, texture_blur, 0, 1e3),
      NUMBER_KEY("normal_blur", scene, normal_blur, 0, 1e3),
      NUMBER_KEY("blur_glossy", scene, blur_glossy, 0, 1e30),
      FLAG_KEY("caustics_reflective", scene, features.reflective_caustics),
      FLAG_KEY("caustics_refractive", scene, features.refractive_caustics),
      INTEGER_KEY("apart", scene, apart, 0, INT_MAX),
      {.name = NULL}};
  features *f = &s->features;
  double seed;
  f->reflective_caustics = f->refractive_caustics = true;
  if (!read_size(r, s) || !reader_number(r, "seed", &seed) || !reader_keys(r, keys, s) ||
      !reader_options(r, options, s) || !reader_text(r, "dump", "", &s->dump) ||
      !reader_text(r, "renderer", "libshade", &s->renderer) ||
      (f->denoise && !reader_text(r, "denoiser", "", &s->denoiser)) || !read_shutter(r, s) ||
      !read_planes(r, s) || !read_limits(r, &s->limits, s->max_bounces) ||
      (reader_has(r, "mist") && !reader_dict(r, "mist", read_mist, &s->mist, NULL)))
    return false;
  if (!*s->dump) {
    free(s->dump);
    s->dump = NULL;
  }
  f->transparent_glass = f->transparent_film && reader_has(r, "clear_glass");
  f->light_visibility = (s->sky_hidden & RAY_BOUNCED) != 0;
  s->seed = (uint32_t)(int64_t)fmod(seed, 0x1p32);
  if (!s->threads)
    s->threads = parallel_cores();
  return true;
}

bool scene_look(reader *r, scene *s) {
  scene view = {.width = 0};
  bool good = read_size(r, &view) && reader_dict(r, "camera", read_camera, &view.camera, &view);
  if (good && view.camera.motion.steps)
    good = reader_expected(r, "camera", "one that stands still");
  if (!good) {
    motion_free(&view.camera.motion);
    free(view.camera.frames);
    return false;
  }
  motion_free(&s->camera.motion);
  free(s->camera.frames);
  s->camera = view.camera;
  s->width = view.width;
  s->height = view.height;
  s->samples = view.samples;
  memcpy(s->region, view.region, sizeof s->region);
  return true;
}

/* The nodes of a sky's shader know directions and no surface. */
static bool check_shader(reader *r, const scene *s, const sky *sky) {
  static const bool known[] = {
      [NODE_IMAGE] = true,   [NODE_GEOMETRY] = true,    [NODE_MATH] = true,  [NODE_MIX] = true,
      [NODE_HUE] = true,     [NODE_RAMP] = true,        [NODE_CURVE] = true, [NODE_NOISE] = true,
      [NODE_VORONOI] = true, [NODE_WHITE_NOISE] = true, [NODE_BRICK] = true, [NODE_BOX] = true};
  if (!sky->shader)
    return true;
  if ((size_t)sky->shader > s->materials)
    return reader_fail(r, "a sky's shader is %d; there are %zu materials", sky->shader,
                       s->materials);
  const material *m = &s->material[sky->shader - 1];
  for (const node *n = m->node; n < m->node + m->nodes; n++)
    if ((size_t)n->type >= sizeof known / sizeof *known || !known[n->type])
      return reader_fail(r, "a sky's shader has a node that only surfaces know");
  return true;
}

static bool check_shaders(reader *r, const scene *s) {
  for (size_t i = 0; i < s->looks; i++)
    if (!check_shader(r, s, &s->look[i].sky))
      return false;
  return check_shader(r, s, &s->sky) && check_shader(r, s, &s->behind);
}

scene *scene_read(reader *r) {
  scene *s = calloc(1, sizeof *s);
  if (!s) {
    reader_out_of_memory(r);
    return NULL;
  }
  /* indices into a list are checked against its full length */
  if (read_picture(r, s) && reader_dict(r, "camera", read_camera, &s->camera, s) &&
      reader_each(r, "lights", sizeof(light), &s->lights, &s->light, read_light, s) &&
      reader_each(r, "images", sizeof(image), &s->images, &s->image, read_image, s) &&
      read_sky(r, s) &&
      (!reader_has(r, "cloths") ||
       reader_each(r, "cloths", sizeof(cloth), &s->cloths, &s->cloth, cloth_read, s)) &&
      (!reader_has(r, "scratches") ||
       reader_each(r, "scratches", sizeof(scratches), &s->scratch_fields, &s->scratches,
                   scratches_read, s)) &&
      (!reader_has(r, "layers") ||
       reader_each(r, "layers", sizeof(layer), &s->layers, &s->layer, read_layer, s)) &&
      (!reader_has(r, "attributes") ||
       reader_integer(r, "attributes", 0, MAX_ATTRIBUTES, &s->attributes)) &&
      reader_each(r, "materials", sizeof(material), &s->materials, &s->material, read_material,
                  s) &&
      check_shaders(r, s) &&
      reader_each(r, "meshes", sizeof(mesh), &s->meshes, &s->mesh, read_mesh, s) &&
      reader_each(r, "instances", sizeof(instance), &s->instances, &s->instance, read_instance,
                  s)) {
    s->features.motion =
        !s->features.motion_vectors && (s->features.motion || s->camera.motion.steps > 0);
    s->planes |= s->features.holdout && !s->features.transparent_film ? 1u << PLANE_HELD : 0u;
    if (!s->dump || !s->camera.panorama)
      return s;
    reader_fail(r, "camera: a dump needs one that is not panoramic");
  }
  scene_free(s);
  return NULL;
}
