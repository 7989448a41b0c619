/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sky.h"

#include <limits.h>

static bool read_image(reader *r, sky *s, int images) {
  static const char *const projections[] = {"EQUIRECTANGULAR", "MIRROR_BALL", NULL};
  int projection;
  if ((reader_has(r, "shader") && !reader_integer(r, "shader", 1, INT_MAX, &s->shader)) ||
      !reader_integer(r, "image", 0, images - 1, &s->image) ||
      !reader_word(r, "projection", projections, &projection))
    return false;
  s->ball = projection == 1 ? UINT32_MAX : 0;
  return true;
}

static bool read_atmosphere(reader *r, sky *s) {
  static const char *const models[] = {"SINGLE", "MULTIPLE", "PREETHAM", NULL};
  atmosphere *a = &s->air;
  int model;
  if (!reader_word(r, "model", models, &model) ||
      !reader_number_within(r, "elevation", -1.5708, 1.5708, &a->elevation) ||
      !reader_rgb_of_xyz(r, "rgb", a->rgb))
    return false;
  a->model = (atmosphere_model)model;
  s->modelled = true;
  s->dome = UINT32_MAX;
  if (a->model == ATMOSPHERE_PREETHAM)
    return reader_number_within(r, "turbidity", 1, 1000, &a->turbidity);
  return reader_number_within(r, "altitude", 0, 1e5, &a->altitude) &&
         reader_number_within(r, "air", 0, 1e3, &a->air) &&
         reader_number_within(r, "dust", 0, 1e3, &a->dust) &&
         reader_number_within(r, "ozone", 0, 1e3, &a->ozone) &&
         reader_flag(r, "later", &a->later) &&
         reader_number_within(r, "sun_size", 0, 1.5708, &a->sun_size) &&
         reader_number_within(r, "sun_bright", 0, 1e6, &a->sun_bright);
}

static bool read_one(reader *r, void *out, void *context) {
  const int *images = context;
  sky *s = out;
  if (!reader_floats(r, "strength", 3, s->strength) || !reader_floats(r, "matrix", 12, s->matrix) ||
      !(reader_has(r, "model") ? read_atmosphere(r, s) : read_image(r, s, *images)))
    return false;
  s->there = true;
  return true;
}

bool sky_read(reader *r, const char *key, sky *s, int images) {
  return reader_dict(r, key, read_one, s, &images);
}
