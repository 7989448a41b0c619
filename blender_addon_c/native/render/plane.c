/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/plane.h"

#include "batch/leaf.h"
#include "closure/closure.h"
#include "render/vector.h"

#define PLANE_WORD(TYPE, channels, filtered) #TYPE,
#define PLANE_COUNT(TYPE, channels, filtered) channels,
#define PLANE_FILTERED(TYPE, channels, filtered) filtered,

const char *plane_word(plane_type type) {
  static const char *const words[] = {PLANE_TABLE(PLANE_WORD)};
  return words[type];
}

int plane_channels(plane_type type) {
  static const int channels[] = {PLANE_TABLE(PLANE_COUNT)};
  return channels[type];
}

bool plane_is_filtered(plane_type type) {
  static const bool filtered[] = {PLANE_TABLE(PLANE_FILTERED)};
  return filtered[type];
}

plane_type plane_divisor(plane_type type) {
  int number = (int)type - PLANE_LIGHT;
  if (number < 0 || type >= PLANE_EMISSION || number % LIGHT_PARTS == LIGHT_COLOR)
    return PLANES;
  return (plane_type)((int)type - number % LIGHT_PARTS + LIGHT_COLOR);
}

unsigned plane_needs(unsigned wanted) {
  if (wanted >> PLANE_VECTOR & 1u)
    wanted |= 1u << PLANE_VECTOR_HITS;
  for (int k = PLANE_LIGHT; k < PLANES; k++)
    if (wanted >> k & 1u && plane_divisor((plane_type)k) != PLANES)
      wanted |= 1u << plane_divisor((plane_type)k);
  return wanted;
}

plane_layout plane_layout_of(unsigned wanted) {
  plane_layout l = {.wanted = wanted};
  for (int k = 0; k < PLANES; k++) {
    l.at[k] = l.channels;
    l.channels += wanted >> k & 1u ? plane_channels((plane_type)k) : 0;
  }
  return l;
}

/* A direction of the shading frame in the world. */
static vec3 to_world(const surfaces *at, size_t i, vec3 v) {
  vec3 t = load(&at->t, i), b = load(&at->b, i), n = load(&at->n, i);
  return (vec3){v.x * t.x + v.y * b.x + v.z * n.x, v.x * t.y + v.y * b.y + v.z * n.y,
                v.x * t.z + v.y * b.z + v.z * n.z};
}

static vec3 shading_normal(const batch *b, const material *m, size_t i) {
  const int *from = m->normal;
  const lane_f *at = b->input.at;
  return to_world(&b->surface, i, (vec3){at[from[0]][i], at[from[1]][i], at[from[2]][i]});
}

#define CLOSURE_COLOR(TYPE, name)                                                                  \
  case CLOSURE_##TYPE:                                                                             \
    return closure_##name##_color(&c->of.name, in, k, i);
float plane_closure_color(const inputs *in, const closure *c, int k, size_t i) {
  switch (c->type) {
    CLOSURES_COLORED(CLOSURE_COLOR)
  default:
    return 1.0f;
  }
}

/* What the surface reflects of white light, roughly. */
static vec3 albedo_of(const batch *b, const material *m, size_t i) {
  float sum[3] = {0, 0, 0};
  for (size_t number = 0; number < m->closures; number++) {
    const closure *c = &m->closure[number];
    for (int k = 0; k < 3; k++)
      sum[k] += closure_color_of(&b->input, c->weight[k], (double)c->weight[k].number, i) *
                plane_closure_color(&b->input, c, k, i);
  }
  return (vec3){clampf(sum[0], 0.0f, 1.0f), clampf(sum[1], 0.0f, 1.0f), clampf(sum[2], 0.0f, 1.0f)};
}

/* What a plane has to say of one hit. */
static vec3 value_of(plane_type type, const scene *s, const batch *b, const material *m, size_t i) {
  const camera *eye = &s->camera;
  const surfaces *at = &b->surface;
  vec3 p = load(&at->p, i);
  switch (type) {
  case PLANE_DEPTH: {
    vec3 d = {p.x - eye->origin[0], p.y - eye->origin[1], p.z - eye->origin[2]};
    if (eye->panorama)
      return (vec3){sqrtf(dot(d, d)), 0, 0};
    return (vec3){-(d.x * eye->axis[2][0] + d.y * eye->axis[2][1] + d.z * eye->axis[2][2]), 0, 0};
  }
  case PLANE_POSITION:
    return p;
  case PLANE_DISTANCE: {
    vec3 d = load(&b->ray->d, i);
    if (eye->panorama)
      return (vec3){b->ray->tfar[i] - eye->clip[0], 0, 0};
    float near =
        -eye->clip[0] / (d.x * eye->axis[2][0] + d.y * eye->axis[2][1] + d.z * eye->axis[2][2]);
    return (vec3){(b->ray->tfar[i] - near) * sqrtf(dot(d, d)), 0, 0};
  }
  case PLANE_SEEN_NORMAL: {
    vec3 n = shading_normal(b, m, i);
    const float(*axis)[3] = eye->axis;
    return (vec3){n.x * axis[0][0] + n.y * axis[0][1] + n.z * axis[0][2],
                  n.x * axis[1][0] + n.y * axis[1][1] + n.z * axis[1][2],
                  -(n.x * axis[2][0] + n.y * axis[2][1] + n.z * axis[2][2])};
  }
  case PLANE_NORMAL:
    return shading_normal(b, m, i);
  case PLANE_ALBEDO:
    return albedo_of(b, m, i);
  case PLANE_UV:
    return (vec3){at->u[i], at->v[i], 1.0f};
  case PLANE_OBJECT:
    return (vec3){(float)instance_at(s, b, i)->pass_index, 0, 0};
  case PLANE_VECTOR_HITS:
    return (vec3){1, 0, 0};
  case PLANE_MATERIAL:
    return (vec3){(float)m->pass_index, 0, 0};
  default:
    return (vec3){0, 0, 0};
  }
}

void plane_add(const plane_layout *layout, const scene *s, const batch *b, const camera_view *view,
               bool first, float *numbers) {
  const queue *q = &b->queue;
  for (const segment *g = q->segment; g < q->segment + q->segments; g++)
    for (size_t i = g->run.begin; i < g->run.end; i++) {
      uint32_t sample = view->first + q->lane[i];
      float *pixel = numbers + (size_t)layout->channels * (sample / view->samples);
      bool has_first = first && sample % view->samples == 0;
      for (int k = 0; k < PLANE_LIGHT; k++) {
        if (!(layout->wanted >> k & 1u) || !(has_first || plane_is_filtered((plane_type)k)))
          continue;
        if (k == PLANE_VECTOR) {
          float moved[4];
          vector_of(s, b, i, moved);
          for (int c = 0; c < 4; c++)
            pixel[layout->at[k] + c] += moved[c];
          continue;
        }
        vec3 v = value_of((plane_type)k, s, b, g->material, i);
        const float value[3] = {v.x, v.y, v.z};
        for (int c = 0; c < plane_channels((plane_type)k); c++)
          pixel[layout->at[k] + c] += value[c];
      }
    }
}
