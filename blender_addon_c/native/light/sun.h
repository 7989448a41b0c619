/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light from afar: a disc, as large from everywhere. `irradiance` is that of a surface facing it.
 */
#ifndef LIBSHADE_LIGHT_SUN_H
#define LIBSHADE_LIGHT_SUN_H

#include "light/common.h"

typedef struct light_sun {
  vec3 to;      /* unit */
  vec3 axis[2]; /* across it, tan(angle / 2) long */
} light_sun;

static inline bool light_sun_read(reader *r, light_common *common, light_sun *l) {
  float angle = 0, v[3];
  if (!reader_floats(r, "irradiance", 3, common->color) || !reader_floats(r, "direction", 3, v) ||
      !reader_number_within(r, "angle", 0, 3.141592654, &angle))
    return false;
  l->to = (vec3){v[0], v[1], v[2]};
  if (!make_unit(&l->to))
    return reader_expected(r, "direction", "a direction");
  float radius = tanf(fminf(angle, 3.14f) / 2);
  common->soft = radius > 0.0f;
  across(l->to, &l->axis[0], &l->axis[1]);
  for (int k = 0; k < 2; k++)
    l->axis[k] = scaled(l->axis[k], radius);
  return true;
}

LEAF light_sample light_sun_sample(const light_sun *l, bool spread, float x, float y, vec3 p) {
  (void)p; /* it is as far from every point */
  vec3 d = l->to;
  if (spread) {
    const vec3 *u = &l->axis[0], *v = &l->axis[1];
    float a, b;
    disc_point(x, y, &a, &b);
    d = (vec3){d.x + a * u->x + b * v->x, d.y + a * u->y + b * v->y, d.z + a * u->z + b * v->z};
  }
  return (light_sample){
      .direction = scaled(d, 1.0f / sqrtf(dot(d, d))), .distance = INFINITY, .e = 1.0f};
}

#endif
