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

/* A colour in linear Rec. 709 becomes that of the scene's working space. */
static void carry(const double by[9], double color[3]) {
  const double old[3] = {color[0], color[1], color[2]};
  for (int k = 0; k < 3; k++, by += 3)
    color[k] = within_one(by[0] * old[0] + by[1] * old[1] + by[2] * old[2]);
}

static bool carry_preset(reader *r, shade_fabric_params *p) {
  double by[9],
      *colors[] = {p->warp.f0, p->warp.kd, p->weft.f0, p->weft.kd, p->backing, p->nap_color};
  if (!reader_has(r, "from_rec709"))
    return true;
  if (!reader_numbers(r, "from_rec709", 9, by))
    return false;
  for (size_t i = 0; i < sizeof colors / sizeof *colors; i++)
    carry(by, colors[i]);
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

/* Where it is there. */
static bool read_within(reader *r, const char *key, double low, double high, double *out) {
  float x;
  if (!reader_has(r, key))
    return true;
  if (!reader_number_within(r, key, low, high, &x))
    return false;
  *out = (double)x;
  return true;
}

/* An exponent within what libshade takes: gloss has a share of the yarn's own. */
static bool read_finish(reader *r, cloth *c) {
  static const char *const words[] = {"auto", "near", "far", NULL};
  static const shade_fabric_tier tiers[] = {SHADE_TIER_AUTO, SHADE_TIER_NEAR, SHADE_TIER_FAR};
  shade_fabric_params *p = &c->preset.fabric;
  double gloss = 1;
  int tier = 0;
  if (!read_within(r, "gloss", 0, 1, &gloss) || !read_within(r, "nap", 0, 10, &p->nap) ||
      (reader_has(r, "tier") && !reader_word(r, "tier", words, &tier)))
    return false;
  gloss = fmax(gloss, 1e-6); /* as the library's lanes */
  p->warp.along *= gloss;
  p->warp.across *= gloss;
  p->weft.along *= gloss;
  p->weft.across *= gloss;
  c->tier = tiers[tier];
  return true;
}

static double light_of(double shown) {
  return shown <= 0.04045 ? shown / 12.92 : pow((shown + 0.055) / 1.055, 2.4);
}

/* The draft's colours, which are those of displays, become the scene's. */
static bool carry_draft(reader *r, shade_draft *d) {
  double by[9];
  if (!reader_has(r, "draft_from_rec709"))
    return true;
  if (!reader_numbers(r, "draft_from_rec709", 9, by))
    return false;
  for (int i = 0; i < d->ends + d->picks; i++) {
    double *color = i < d->ends ? d->warp[i].color : d->weft[i - d->ends].color;
    for (int k = 0; k < 3; k++)
      color[k] = light_of(color[k]);
    carry(by, color);
    for (int k = 0; k < 3; k++)
      color[k] = cloth_shown(color[k]);
  }
  return true;
}

static bool read_draft(reader *r, cloth *c) {
  char *text = NULL, *name = NULL, message[256];
  bool good = reader_text(r, "draft", NULL, &text) && reader_text(r, "draft_name", "draft", &name);
  if (good && !(c->draft = shade_wif_parse(text, strlen(text), name, message, sizeof message)))
    good = reader_fail(r, "%s", message);
  bool colors = false;
  if (good && reader_has(r, "draft_colors"))
    good = reader_flag(r, "draft_colors", &colors);
  good = good && carry_draft(r, c->draft);
  c->preset.fabric.draft_colors = colors;
  free(text);
  free(name);
  return good;
}

static bool read_weave(reader *r, cloth *c) {
  char *word = NULL;
  if (reader_has(r, "draft"))
    return read_draft(r, c);
  if (!reader_has(r, "weave"))
    return true;
  if (!reader_text(r, "weave", NULL, &word))
    return false;
  const char *known = NULL;
  for (int row = 0; shade_weave_row(row, &known, NULL, NULL) && strcmp(known, word) != 0; row++)
    known = NULL;
  c->preset.weave = known;
  bool good = known || reader_fail(r, "weave: no weave '%s'", word);
  free(word);
  return good;
}

typedef struct yarn_context {
  cloth *cloth;
  shade_top yarns;
} yarn_context;

/* Where `warp_yarn` or `weft_yarn` has a twist, with all widths known. */
static bool read_twist(reader *r, void *unused, void *context) {
  const yarn_context *y = context;
  shade_weave_params *p = &y->cloth->preset.yarns;
  const shade_yarn_params *yarn = y->yarns == SHADE_TOP_WARP ? &p->warp : &p->weft;
  double twist = 0;
  bool plied = false;
  (void)unused;
  if (!reader_has(r, "twist"))
    return true;
  if (!read_within(r, "twist", -1.5707964, 1.5707964, &twist) ||
      !reader_may_flag(r, "plied", &plied))
    return false;
  shade_weave_params_set_twist(p, y->yarns,
                               twist > 0   ? 'S'
                               : twist < 0 ? 'Z'
                                           : 0,
                               fabs(twist), yarn->segments > 0 ? yarn->segments : 1, plied);
  return true;
}

static bool read_yarn(reader *r, void *unused, void *context) {
  const yarn_context *y = context;
  const bool warp = y->yarns == SHADE_TOP_WARP;
  shade_yarn_params *shape = warp ? &y->cloth->preset.yarns.warp : &y->cloth->preset.yarns.weft;
  shade_yarn *made = warp ? &y->cloth->preset.fabric.warp : &y->cloth->preset.fabric.weft;
  shade_param_info info;
  double *number;
  (void)unused;
  for (int row = 0; shade_yarn_param_row(row, &info); row++)
    if (!read_within(r, info.word, info.minimum, info.maximum, shade_yarn_param(shape, info.word)))
      return false;
  for (int row = 0; (number = shade_fabric_yarn_number(made, row, &info)); row++)
    if (info.components == 1 && !read_within(r, info.word, info.minimum, info.maximum, number))
      return false;
  return true;
}

static bool read_yarns(reader *r, cloth *c) {
  static const char *const keys[] = {"warp_yarn", "weft_yarn"};
  static reader_one *const turns[] = {read_yarn, read_twist}; /* twist asks for both widths */
  for (int turn = 0; turn < 2; turn++)
    for (int k = 0; k < 2; k++) {
      yarn_context y = {c, k ? SHADE_TOP_WEFT : SHADE_TOP_WARP};
      if (reader_has(r, keys[k]) && !reader_dict(r, keys[k], turns[turn], NULL, &y))
        return false;
    }
  return true;
}

/* Crossings in one unit of the UV map. */
static bool read_size(reader *r, cloth *c) {
  double counts[2] = {c->preset.ends_per_cm, c->preset.picks_per_cm}, repeats[2];
  float size = 1.0f;
  if (reader_has(r, "counts") && !reader_numbers(r, "counts", 2, counts))
    return false;
  if (!(counts[0] >= 0.01 && counts[0] <= 1e4 && counts[1] >= 0.01 && counts[1] <= 1e4))
    return reader_expected(r, "counts", "two numbers from .01 to 10000");
  c->preset.ends_per_cm = counts[0];
  c->preset.picks_per_cm = counts[1];
  if (!reader_has(r, "repeats")) {
    if (!reader_number_within(r, "size", 1e-6f, 1e6f, &size))
      return false;
    c->per_u = (float)(100 * (double)size * counts[0]);
    c->per_v = (float)(100 * (double)size * counts[1]);
    return true;
  }
  if (!reader_numbers(r, "repeats", 2, repeats))
    return false;
  if (!(fabs(repeats[0]) <= 1e6 && fabs(repeats[1]) <= 1e6))
    return reader_expected(r, "repeats", "two numbers to a million");
  shade_draft *named = c->draft ? NULL : shade_draft_named(c->preset.weave);
  const shade_draft *draft = c->draft ? c->draft : named;
  if (!draft)
    return reader_out_of_memory(r);
  c->per_u = (float)(repeats[0] * draft->ends);
  c->per_v = (float)(repeats[1] * draft->picks);
  shade_draft_free(named);
  return true;
}

bool cloth_read(reader *r, void *out, void *context) {
  cloth *c = out;
  shade_fabric_params *p = &c->preset.fabric;
  float transmit;
  bool open;
  (void)context;
  if (!read_preset(r, &c->preset) || !carry_preset(r, p) || !read_weave(r, c) || !read_size(r, c) ||
      !read_yarns(r, c) || !reader_number_within(r, "transmit", 0, 1, &transmit) ||
      !reader_flag(r, "open", &open) || !read_colors(r, p) || !read_finish(r, c))
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
  c->through = transmit > 0.0f;
  return true;
}

bool cloth_build(cloth *c) {
  if (!c->draft) {
    c->fabric = shade_preset_fabric(&c->preset, &c->weave, NULL);
    return c->fabric != NULL;
  }
  c->weave = shade_weave_create(c->draft, &c->preset.yarns, NULL);
  c->fabric = shade_fabric_create(c->weave, &c->preset.fabric, NULL);
  return c->fabric != NULL;
}

void cloth_free(cloth *c) {
  shade_draft_free(c->draft);
  shade_fabric_free(c->fabric);
  shade_weave_free(c->weave);
}

bool cloth_room_init(cloth_room *room) {
  /* each run is rounded up to the library's blocks */
  room->size = shade_fabric_hits_sizef(BATCH) + (CLOTH_RUNS - 1) * shade_fabric_hits_sizef(1);
  room->between = room->mixed = false;
  room->bytes = malloc(room->size);
  return room->bytes != NULL;
}

void cloth_room_free(cloth_room *room) {
  free(room->bytes);
}
