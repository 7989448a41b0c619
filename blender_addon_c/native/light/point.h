/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bulb that shines evenly: irradiance `intensity` / distance². */
#ifndef LIBSHADE_LIGHT_POINT_H
#define LIBSHADE_LIGHT_POINT_H

#include "light/common.h"

typedef struct light_point {
  light_bulb bulb;
} light_point;

static inline bool light_point_read(reader *r, light_common *common, light_point *l) {
  return light_bulb_read(r, common, &l->bulb);
}

LEAF light_sample light_point_sample(const light_point *l, bool spread, float x, float y, vec3 p) {
  return light_bulb_sample(&l->bulb, spread, x, y, p);
}

LEAF light_intersection light_point_intersect(const light_point *l, vec3 o, vec3 d) {
  return light_bulb_intersect(&l->bulb, o, d);
}

LEAF float light_point_weight(const light_point *l, vec3 p) {
  return light_bulb_weight(&l->bulb, p);
}

#endif
