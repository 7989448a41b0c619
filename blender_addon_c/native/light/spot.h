/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bulb in a cone: full within, less over its rim, by the angle between axis and direction. */
#ifndef LIBSHADE_LIGHT_SPOT_H
#define LIBSHADE_LIGHT_SPOT_H

#include "light/common.h"

typedef struct light_spot {
  light_bulb bulb;
  vec3 axis;           /* where it shines, unit */
  vec3 across[2];      /* of the cone, unit where it is round; longer where it is narrow */
  float cosine;        /* of half the cone's angle */
  float rim;           /* 1 / that over which it fades, in the cosine */
  uint32_t cosine_law; /* dimmed by the cosine too, as Cycles' spots were until 3.4; for either() */
} light_spot;

static inline bool light_spot_read(reader *r, light_common *common, light_spot *l) {
  float angle, blend, v[3];
  if (!light_bulb_read(r, common, &l->bulb) || !reader_floats(r, "direction", 3, v) ||
      !reader_number_within(r, "angle", 0, 3.1416, &angle) ||
      !reader_number_within(r, "blend", 0, 1, &blend) ||
      !light_switch_read(r, "cosine_law", &l->cosine_law))
    return false;
  l->axis = (vec3){v[0], v[1], v[2]};
  if (!make_unit(&l->axis))
    return reader_expected(r, "direction", "a direction");
  across(l->axis, &l->across[0], &l->across[1]);
  for (int k = 0; k < 2; k++) {
    const char *key = k ? "across_v" : "across_u";
    if (reader_has(r, key) && !reader_floats(r, key, 3, v))
      return false;
    if (reader_has(r, key))
      l->across[k] = (vec3){v[0], v[1], v[2]};
  }
  l->cosine = cosf(0.5f * angle);
  float width = (1.0f - l->cosine) * blend;
  l->rim = 1.0f / (width > 1e-7f ? width : 1e-7f);
  return true;
}

/* d: from the point to the light. */
LEAF float light_spot_part(const light_spot *l, vec3 d) {
  float z = -dot(d, l->axis), x = dot(d, l->across[0]), y = dot(d, l->across[1]);
  float length2 = x * x + y * y + z * z;
  float cosine = z / sqrtf(length2 > 1e-30f ? length2 : 1e-30f);
  float t = clampf((cosine - l->cosine) * l->rim, 0.0f, 1.0f);
  float law = either(l->cosine_law, cosine, 1.0f);
  return t * t * (3.0f - 2.0f * t) * (law > 0.0f ? law : 0.0f);
}

LEAF light_sample light_spot_sample(const light_spot *l, bool spread, float x, float y, vec3 p) {
  light_sample s = light_bulb_sample(&l->bulb, spread, x, y, p);
  s.e *= light_spot_part(l, s.direction);
  return s;
}

LEAF light_intersection light_spot_intersect(const light_spot *l, vec3 o, vec3 d) {
  light_intersection m = light_bulb_intersect(&l->bulb, o, d);
  m.radiance *= light_spot_part(l, d);
  return m;
}

/* Of a soft one the cone's rim is soft too. */
LEAF float light_spot_weight(const light_spot *l, vec3 p) {
  vec3 d = {l->bulb.position[0] - p.x, l->bulb.position[1] - p.y, l->bulb.position[2] - p.z};
  float d2 = dot(d, d), least = l->bulb.radius > 0.0f ? 0.05f : 0.0f;
  float part = light_spot_part(l, scaled(d, 1.0f / sqrtf(d2 > 1e-30f ? d2 : 1e-30f)));
  return light_bulb_weight(&l->bulb, p) * (part > least ? part : least);
}

#endif
