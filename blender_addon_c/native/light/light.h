/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Kinds of light. Each is one file, light/<name>.h, with
 *
 *   light_<name>          what it keeps
 *   light_<name>_read     reads it from a scene
 *   light_<name>_sample   a leaf: what it gives to a point, from its middle or, if samples are to
 *                         be spread over it, from where (x, y) of the unit square falls on it
 *   light_<name>_intersect  a leaf: where a ray meets it, and with which density samples go there
 *   light_<name>_weight   a leaf: about how much it gives to a point, for the choice among lights;
 *                         more than 0 wherever it gives something
 *
 * and one row of light/table.h: ROW(TYPE, name). TYPE is the word in a scene, LIGHT_TYPE its
 * number, stage_<name> its stage and light_<name> its clock.
 */
#ifndef LIBSHADE_LIGHT_H
#define LIBSHADE_LIGHT_H

#include "light/area.h"
#include "light/point.h"
#include "light/spot.h"
#include "light/sun.h"
#include "light/table.h"

#define LIGHT_MEMBER(TYPE, name) light_##name name;
typedef struct light {
  light_type type;
  light_common common;
  union {
    LIGHT_TABLE(LIGHT_MEMBER)
  } of;
} light;

#endif
