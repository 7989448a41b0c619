/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/cloth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double mean_of(const double color[3]) {
  return (color[0] + color[1] + color[2]) / 3;
}

static double within_one(double x) {
  return x > 0 ? fmin(x, 1) : 0; /* NaN too */
}

/* New over old, where the old one says anything. */
static double ratio_of(double to, double from) {
  return from > 1e-3 ? to / from : 1;
}

/* A yarn in another dye: a highlight that had a colour takes the new one, and stays as bright. */
static void dye(shade_yarn *yarn, const double color[3]) {
  double f0[3];
  bool grey = yarn->f0[0] == yarn->f0[1] && yarn->f0[1] == yarn->f0[2];
  for (int k = 0; k < 3; k++) {
    f0[k] = yarn->f0[k] * ratio_of(color[k], yarn->kd[k]);
    yarn->kd[k] = color[k];
  }
  double before = mean_of(yarn->f0), after = mean_of(f0);
  for (int k = 0; k < 3 && !grey; k++)
    yarn->f0[k] = after > 1e-6 ? within_one(f0[k] * before / after) : before;
}

static bool read_color(reader *r, const char *key, double color[3], bool *there) {
  *there = reader_has(r, key);
  if (*there && !reader_numbers(r, key, 3, color))
    return false;
  for (int k = 0; k < 3; k++)
    color[k] = within_one(color[k]);
  return true;
}

static bool read_colors(reader *r, shade_fabric_params *p) {
  double warp[3] = {0}, weft[3] = {0}, before[3];
  bool dyed_warp, dyed_weft;
  if (!read_color(r, "warp", warp, &dyed_warp) || !read_color(r, "weft", weft, &dyed_weft))
    return false;
  for (int k = 0; k < 3; k++)
    before[k] = p->warp.kd[k] + p->weft.kd[k];
  if (dyed_warp)
    dye(&p->warp, warp);
  if (dyed_weft)
    dye(&p->weft, weft);
  for (int k = 0; k < 3; k++)
    p->backing[k] = within_one(p->backing[k] * ratio_of(p->warp.kd[k] + p->weft.kd[k], before[k]));
  return true;
}

static bool read_preset(reader *r, shade_preset *preset) {
  char *word;
  if (!reader_text(r, "preset", NULL, &word))
    return false;
  bool good = shade_preset_find(word, preset) && preset->kind == SHADE_PRESET_FABRIC;
  if (!good)
    reader_fail(r, "preset: no cloth '%s'", word);
  free(word);
  return good;
}

bool cloth_read(reader *r, void *out, void *context) {
  cloth *c = out;
  shade_fabric_params *p = &c->preset.fabric;
  float size, transmit;
  bool open;
  (void)context;
  if (!read_preset(r, &c->preset) || !reader_number_within(r, "size", 1e-6f, 1e6f, &size) ||
      !reader_number_within(r, "transmit", 0, 1, &transmit) || !reader_flag(r, "open", &open) ||
      !read_colors(r, p))
    return false;
  c->bright = (float)(0.5 * (mean_of(p->warp.kd) + mean_of(p->weft.kd)) +
                      0.5 * (mean_of(p->warp.f0) + mean_of(p->weft.f0)) + 0.05);
  for (int k = 0; k < 3; k++) {
    p->warp_transmit[k] = (double)transmit * p->warp.kd[k];
    p->weft_transmit[k] = (double)transmit * p->weft.kd[k];
    p->warp.kd[k] -= p->warp_transmit[k];
    p->weft.kd[k] -= p->weft_transmit[k];
    p->backing[k] = open ? 0 : p->backing[k];
  }
  c->per_u = (float)(100 * (double)size * c->preset.ends_per_cm);
  c->per_v = (float)(100 * (double)size * c->preset.picks_per_cm);
  c->through = transmit > 0.0f;
  return true;
}

bool cloth_build(cloth *c) {
  c->fabric = shade_preset_fabric(&c->preset, &c->weave, NULL);
  return c->fabric != NULL;
}

void cloth_free(cloth *c) {
  shade_fabric_free(c->fabric);
  shade_weave_free(c->weave);
}

bool cloth_room_init(cloth_room *room) {
  /* each run is rounded up to the library's blocks */
  room->size = shade_fabric_hits_sizef(BATCH) + (CLOTH_RUNS - 1) * shade_fabric_hits_sizef(1);
  room->bytes = malloc(room->size);
  return room->bytes != NULL;
}

void cloth_room_free(cloth_room *room) {
  free(room->bytes);
}
