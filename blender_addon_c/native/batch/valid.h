/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normals by which the eye's mirror image is not below the facet, as Cycles' closures take them. */
#ifndef LIBSHADE_VALID_H
#define LIBSHADE_VALID_H

#include "batch/leaf.h"

/* Height over the facet that the eye's mirror image is to have, where `facet` is the eye's. */
LEAF float least_image(float facet) {
  return 0.9f * facet < 0.01f ? 0.9f * facet : 0.01f;
}

/* n, turned towards the facet's normal as far as brings the mirror image of the eye up, as Cycles
 * does: it halves the angle between both in the plane of these normals. d: away from the eye;
 * facet, along: cosines of the facet's normal with the eye and with n. */
LEAF vec3 valid_normal(vec3 n, vec3 flat, vec3 d, float facet, float along) {
  vec3 side = {n.x - along * flat.x, n.y - along * flat.y, n.z - along * flat.z};
  float length = sqrtf(dot(side, side));
  bool good = (length > 1e-6f) & (facet > 1e-6f);
  side = scaled(side, 1.0f / (good ? length : 1.0f));
  float low = least_image(facet), eye = -dot(d, side);
  float over = (facet - low) * (facet + low),
        image = sqrtf(eye * eye + (over > 0.0f ? over : 0.0f));
  float x = eye < 0.0f ? over / (image - eye) : image + eye, z = facet + low;
  vec3 to = {x * side.x + z * flat.x, x * side.y + z * flat.y, x * side.z + z * flat.z};
  float square = dot(to, to);
  good = good & (square > 1e-20f);
  return select3(good, scaled(to, 1.0f / sqrtf(good ? square : 1.0f)), n);
}

#endif
