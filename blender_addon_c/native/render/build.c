/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/pattern.h"
#include "light/light.h"
#include "render/relief.h"
#include "closure/closure.h"
#include "node/node.h"
#include "stage/stage.h"
#include "scene/world.h"
#include "system/parallel.h"

static double sharpest(const material *m) {
  double most = 0;
  for (size_t k = 0; k < m->closures; k++)
    most = fmax(most, m->closure[k].exponent);
  return most;
}

#define NODE_BUILD(TYPE, name)                                                                     \
  case NODE_##TYPE:                                                                                \
    return node_##name##_build(&n->of.name, place);
static bool build_node(node *n, const node_place *place) {
  switch (n->type) {
    NODES_BUILT(NODE_BUILD)
  default:
    return true;
  }
}

/* Do nodes read position by u and v? fine: where footprints are fine, too. */
static bool reads_derivatives(const scene *s, bool fine) {
  for (const material *m = s->material; m < s->material + s->materials; m++)
    for (const node *n = m->node; n < m->node + m->nodes; n++)
      if (n->type == NODE_BUMP || n->type == NODE_WEAVE || n->type == NODE_STEP ||
          (n->type == NODE_IMAGE && n->of.image.averaged && (n->of.image.placed || !fine)) ||
          (n->type == NODE_NORMAL_MAP && n->of.normal_map.squares && !fine) ||
          (n->type == NODE_SCRATCHES && n->of.scratches.what == SCRATCHES_NORMAL) ||
          (n->type == NODE_GEOMETRY && geometry_stretches(&n->of.geometry)))
        return true;
  return false;
}

static bool build_cloths(scene *s, const atomic_bool *cancel, message_log *log) {
  for (size_t k = 0; k < s->cloths; k++) {
    if (atomic_load_explicit(cancel, memory_order_relaxed))
      return false;
    if (!cloth_build(&s->cloth[k]))
      return message_error(log, "out of memory");
  }
  return true;
}

static bool build_scratches(scene *s, const atomic_bool *cancel, message_log *log) {
  for (size_t k = 0; k < s->scratch_fields; k++) {
    if (atomic_load_explicit(cancel, memory_order_relaxed))
      return false;
    if (!scratches_build(&s->scratches[k]))
      return message_error(log, "out of memory");
  }
  return true;
}

/* Of those that average what a ray stands for, how many texels the UV map counts. */
static float texels_of(const node *n) {
  return n->type == NODE_IMAGE && n->of.image.averaged            ? n->of.image.texels
         : n->type == NODE_NORMAL_MAP && n->of.normal_map.squares ? n->of.normal_map.texels
                                                                  : 0.0f;
}

/* Does it ask itself how much a ray stands for? */
static bool reads_width(const node *n) {
  return (n->type == NODE_SCRATCHES && n->of.scratches.coarse) ||
         (n->type == NODE_PATH && n->of.path.what == PATH_WIDTH);
}

static bool build_materials(scene *s, const atomic_bool *cancel, message_log *log) {
  bool good = true;
  s->features.ray_cones = s->cloths > 0;
  s->finest = 0.0f;
  for (material *m = s->material; m < s->material + s->materials; m++) {
    if (m->status & SHADE_CLAMPED_PARAMETER)
      message_warn(log, "material %s: a parameter is out of its range and was clamped", m->name);
    node_place place = {.image = s->image,
                        .textures = &s->textures,
                        .layer = s->layer,
                        .texture_blur = s->texture_blur,
                        .normal_blur = s->normal_blur,
                        .material = m->name,
                        .exponent = sharpest(m),
                        .log = log};
    for (size_t k = 0; good && k < m->nodes; k++)
      good = build_node(&m->node[k], &place);
    for (size_t k = 0; good && k < m->nodes; k++) {
      s->finest = fmaxf(s->finest, texels_of(&m->node[k]));
      s->features.ray_cones = s->features.ray_cones || s->finest > 0.0f || reads_width(&m->node[k]);
    }
  }
  s->features.derivatives = reads_derivatives(s, false);
  s->features.fine_derivatives = reads_derivatives(s, true);
  texture_take(&s->textures, &s->kept);
  free(s->kept_image);
  s->kept_image = NULL;
  if (!good || !texture_pack(&s->textures, s->threads, cancel))
    return message_error(log, "out of memory");
  return true;
}

/* Is what a material shines with the same everywhere? */
static void find_radiance(material *m) {
  memset(m->radiance, 0, sizeof m->radiance);
  m->shines = false;
  if (m->undrawn)
    return;
  for (const closure *c = m->closure; c < m->closure + m->closures; c++) {
    if (!(c->traits & CLOSURE_EMITS))
      continue;
    for (int k = 0; k < 3; k++) {
      if (c->weight[k].at != OPERAND_NUMBER) {
        m->shines = false;
        return;
      }
      m->radiance[k] += c->weight[k].number;
      m->shines = m->shines || c->weight[k].number != 0.0f;
    }
  }
}

/* Below these, light that is gathered is no brighter than what is around. What nodes say is taken
 * for white. */
static bool focuses(const scene *s, const closure *c) {
  const double least_exponent = 8, least_reflected = 0.25;
  const features *f = &s->features;
  double weight = 0;
  for (int k = 0; k < 3; k++)
    weight += (c->weight[k].at >= 0 ? 1 : (double)c->weight[k].number) / 3;
  return (f->reflective_caustics || (c->traits & CLOSURE_CLEAR && f->refractive_caustics)) &&
         c->exponent >= least_exponent && weight * c->focus >= least_reflected;
}

static bool build_aims(scene *s, const geometry *all) {
  bool any = false, matt = false;
  for (material *m = s->material; m < s->material + s->materials; m++) {
    for (size_t k = 0; k < m->closures; k++)
      m->focuses = m->focuses || focuses(s, &m->closure[k]);
    any = any || m->focuses;
    matt = matt || m->traits & CLOSURE_MATT;
  }
  any = any && matt && s->lights + s->emitters.count > 0 && s->limits.kind[BOUNCE_DIFFUSE] > 0;
  return !any || aims_build(all, &s->aims);
}

/* What may light a surface, and by which way. An even sky is no light to choose: rays that are
 * drawn by the surface find it as well as can be. */
static bool build_lights(scene *s, const atomic_bool *cancel, message_log *log) {
  sky_look *const look = stages_choose()->sky;
  const geometry all = {.materials = s->materials,
                        .meshes = s->meshes,
                        .instances = s->instances,
                        .material = s->material,
                        .mesh = s->mesh,
                        .instance = s->instance};
  s->choices = s->lights;
  bool sky_dark = (s->sky_hidden & RAY_BOUNCED) == RAY_BOUNCED;
  s->features.hit_lights =
      !sky_dark && (s->background[0] > 0.0f || s->background[1] > 0.0f || s->background[2] > 0.0f);
  for (size_t k = 0; k < s->lights; k++)
    s->features.hit_lights = s->features.hit_lights || s->light[k].common.mis;
  for (int k = 0; k < 3; k++) /* behind surfaces that let its rays pass */
    s->features.hit_lights =
        s->features.hit_lights || (s->features.transparency && s->backdrop[k] > 0.0f);
  for (material *m = s->material; m < s->material + s->materials; m++)
    find_radiance(m);
  s->features.hit_lights = s->features.hit_lights || (s->features.transparency && s->behind.there);
  if ((s->sky.there && !sky_build(&s->sky, s->image, look, s->threads, cancel)) ||
      (s->behind.there && !sky_build(&s->behind, s->image, look, s->threads, cancel)) ||
      !emitters_build(&all, &s->emitters))
    return message_error(log, "out of memory");
  for (ray_look *way = s->look; !sky_dark && way < s->look + s->looks; way++) {
    if (way->sky.there && !sky_build(&way->sky, s->image, look, s->threads, cancel))
      return message_error(log, "out of memory");
    s->features.hit_lights = true;
  }
  s->sky.power = sky_dark ? 0.0f : s->sky.power;
  s->choices += (size_t)(s->sky.power > 0.0f) + (size_t)(s->emitters.count > 0);
  s->features.hit_lights = s->features.hit_lights || s->sky.power > 0.0f || s->emitters.count > 0;
  return build_aims(s, &all) || message_error(log, "out of memory");
}

void scene_take(scene *to, scene *from) {
  if (!from->built || !from->apart || !to->apart)
    return;
  to->features.derivatives = reads_derivatives(to, false);
  world_take(to, from);
  for (size_t k = 0; k < to->scratch_fields; k++)
    for (size_t i = 0; i < from->scratch_fields; i++)
      scratches_take(&to->scratches[k], &from->scratches[i]);
  to->kept = from->textures;
  to->kept_image = from->image;
  from->textures = (texture_set){0};
  from->image = NULL;
  from->built = false;
}

bool scene_build(scene *s, const atomic_bool *cancel, message_log *log, scene_times *times) {
  static const atomic_bool never;
  double start = parallel_clock();
  *times = (scene_times){0};
  if (s->built) {
    message_repeat(log, &s->said);
    return !atomic_load(cancel);
  }
  size_t before = message_warnings(log);
  if (s->plan) /* there is little to do, and what was taken over shall not be lost */
    cancel = &never;
  if (!build_cloths(s, cancel, log) || !build_scratches(s, cancel, log) ||
      !build_materials(s, cancel, log) || !build_lights(s, cancel, log))
    return false;
  times->image = parallel_clock() - start;
  s->built = world_build(s, cancel, log, times);
  if (s->built && !relief_find(s, cancel))
    return message_error(log, "out of memory");
  message_keep(log, before, &s->said);
  return s->built;
}

void scene_free(scene *s) {
  if (!s)
    return;
  message_forget(&s->said);
  accel_free(s->accel);
  for (int i = 0; i < 3; i++)
    free(s->world[i]);
  world_plan_free(s->plan);
  free(s->triangle);
  free(s->stretch);
  free(s->hidden);
  free(s->object);
  for (size_t i = 0; s->layer && i < s->layers; i++)
    free(s->layer[i].corner);
  free(s->layer);
  free(s->placed);
  free(s->deform);
  free(s->moved_normal);
  free(s->shutter);
  motion_free(&s->camera.motion);
  free(s->camera.frames);
  for (size_t i = 0; s->instance && i < s->instances; i++)
    motion_free(&s->instance[i].motion);
  texture_free(&s->textures);
  texture_free(&s->kept);
  free(s->kept_image);
  sky_free(&s->sky);
  sky_free(&s->behind);
  for (size_t i = 0; s->look && i < s->looks; i++)
    sky_free(&s->look[i].sky);
  free(s->look);
  emitters_free(&s->emitters);
  for (size_t i = 0; s->material && i < s->materials; i++) {
    free(s->material[i].name);
    free(s->material[i].closure);
    relief_free(&s->material[i]);
    free(s->material[i].node);
  }
  for (size_t i = 0; s->mesh && i < s->meshes; i++) {
    free(s->mesh[i].name);
    free(s->mesh[i].layer);
  }
  for (size_t i = 0; s->cloth && i < s->cloths; i++)
    cloth_free(&s->cloth[i]);
  free(s->cloth);
  for (size_t i = 0; s->scratches && i < s->scratch_fields; i++)
    scratches_free(&s->scratches[i]);
  free(s->scratches);
  for (size_t k = 0; s->light && k < s->lights; k++)
    if (s->light[k].common.pattern)
      free(s->light[k].common.pattern->texel), free(s->light[k].common.pattern);
  free(s->light);
  free(s->image);
  free(s->material);
  free(s->mesh);
  free(s->instance);
  free(s->denoiser);
  free(s->dump);
  free(s->renderer);
  free(s);
}
