/* SPDX-License-Identifier: Apache-2.0 */
/* shade check: cloths of the header, and what the reference says of a hit on one. */
#include "tool/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reference/cloth.h"

enum {
  LOOKS = 1 << 16 /* at the weave, for the tier of single lobes */
};

struct check_cloth {
  shade_draft *draft;
  shade_ref_cloth reference;
  shade_ref_seen seen; /* valid once has_seen */
  int has_seen;
};

/* What is read of an object, and the first key that was wrong. */
typedef struct reading {
  char *wrong;
  size_t size;
} reading;

/* Always 0. */
static int wrong(const reading *r, const char *what, const char *key) {
  if (!*r->wrong)
    snprintf(r->wrong, r->size, "%s '%s'", what, key);
  return 0;
}

/* The same with what was expected in its place. */
static int bad_value(const reading *r, const char *key, const char *expected) {
  if (!*r->wrong)
    snprintf(r->wrong, r->size, "bad value of '%s': expected %s", key, expected);
  return 0;
}

static int bad_number(const reading *r, const shade_param_info *info) {
  char wanted[CHECK_EXPECTED];
  check_expected_number(info, wanted, sizeof wanted);
  return bad_value(r, info->word, wanted);
}

static int bad_choice(const reading *r, shade_list list) {
  char wanted[CHECK_EXPECTED];
  check_expected_choice(list, wanted, sizeof wanted);
  return bad_value(r, shade_list_name(list), wanted);
}

static int read_numbers(const json *value, const shade_param_info *info, double *place) {
  const json *item = value;
  if (info->components > 1)
    item = value->type == JSON_ARRAY ? value->child : NULL;
  for (int i = 0; i < info->components; i++, item = item->next) {
    if (!item || item->type != JSON_NUMBER || !(item->number >= info->minimum) ||
        !(item->number <= info->maximum))
      return 0;
    place[i] = item->number;
  }
  return info->components == 1 || !item;
}

/* Every member of an object must be one of those counted here: -1 less for each that was read. */
static int members(const json *object) {
  int count = 0;
  for (const json *item = object->child; item; item = item->next)
    count++;
  return count;
}

/* A member that must be there, and once: twice leaves one member over. */
static const json *take(const reading *r, const json *object, const char *key, int *left) {
  const json *value = json_member(object, key);
  --*left;
  if (!value)
    wrong(r, "lacks", key);
  return value;
}

static int take_numbers(const reading *r, const json *object, const shade_param_info *info,
                        double *place, int *left) {
  const json *value = take(r, object, info->word, left);
  return value && (read_numbers(value, info, place) || bad_number(r, info));
}

static int take_choice(const reading *r, const json *object, shade_list list, int *value,
                       int *left) {
  const json *word = take(r, object, shade_list_name(list), left);
  *value = word ? shade_list_find(list, word->string) : 0;
  return word && (*value >= 0 || bad_choice(r, list));
}

static int is_object(const reading *r, const json *value, const char *key) {
  return value && (value->type == JSON_OBJECT || bad_value(r, key, "{ }"));
}

static int none_left(const reading *r, int left, const char *key) {
  return left == 0 || wrong(r, "unknown or repeated key in", key);
}

static int read_shape(const reading *r, const json *object, const char *key,
                      shade_yarn_params *yarn) {
  shade_param_info info;
  if (!is_object(r, object, key))
    return 0;
  int left = members(object), good = 1;
  for (int row = 0; good && shade_yarn_param_row(row, &info); row++)
    good = take_numbers(r, object, &info, shade_yarn_param(yarn, info.word), &left);
  return good && none_left(r, left, key);
}

static int read_yarns(const reading *r, const json *object, shade_weave_params *p) {
  if (!is_object(r, object, "yarns"))
    return 0;
  int left = members(object), found = -1;
  const json *seed = take(r, object, "seed", &left), *word = take(r, object, "occlusion", &left);
  const json *warp = take(r, object, "warp", &left), *weft = take(r, object, "weft", &left);
  const char *name;
  if (!seed || !word || !none_left(r, left, "yarns"))
    return 0;
  if (seed->type != JSON_NUMBER || !(seed->number >= 0) || !(seed->number <= UINT32_MAX) ||
      seed->number != floor(seed->number))
    return bad_value(r, "seed", "a whole number from 0 to 4294967295");
  p->seed = (uint32_t)seed->number;
  char wanted[CHECK_EXPECTED] = "";
  size_t length = 0;
  for (int row = 0, value; shade_occlusion_row(row, &value, &name, NULL, NULL); row++) {
    check_add_choice(name, wanted, sizeof wanted, &length);
    if (word->type == JSON_STRING && strcmp(name, word->string) == 0)
      found = value;
  }
  if (found < 0)
    return bad_value(r, "occlusion", wanted);
  p->occlusion = (shade_occlusion)found;
  return read_shape(r, warp, "warp", &p->warp) && read_shape(r, weft, "weft", &p->weft);
}

static int read_yarn(const reading *r, const json *object, const char *key, shade_yarn *yarn) {
  shade_param_info info;
  double *place;
  if (!is_object(r, object, key))
    return 0;
  int left = members(object), good = 1, diffuse = 0;
  for (int row = 0; good && (place = shade_fabric_yarn_number(yarn, row, &info)); row++)
    good = take_numbers(r, object, &info, place, &left);
  good = good && take_choice(r, object, SHADE_LIST_DIFFUSE, &diffuse, &left);
  yarn->diffuse = (shade_diffuse)diffuse;
  return good && none_left(r, left, key);
}

static int take_switch(const reading *r, const json *object, const char *key, int *value,
                       int *left) {
  const json *given = take(r, object, key, left);
  if (!given)
    return 0;
  *value = given->type == JSON_TRUE;
  return *value || given->type == JSON_FALSE || bad_value(r, key, "true or false");
}

static int read_cloth(const reading *r, const json *object, shade_fabric_params *p) {
  shade_param_info info;
  double *place;
  if (!is_object(r, object, "cloth"))
    return 0;
  int left = members(object), good, mdf, brdf = 0, detail = 0, horizon = 0;
  good = take_choice(r, object, SHADE_LIST_MDF, &mdf, &left) &&
         take_choice(r, object, SHADE_LIST_BRDF, &brdf, &left) &&
         take_choice(r, object, SHADE_LIST_DETAIL, &detail, &left) &&
         take_choice(r, object, SHADE_LIST_HORIZON, &horizon, &left);
  p->mdf = (shade_mdf)mdf;
  p->brdf = (shade_brdf)brdf;
  p->detail = (shade_detail)detail;
  p->horizon = (shade_horizon)horizon;
  for (int row = 0; good && (place = shade_fabric_number(p, row, &info)); row++)
    good = take_numbers(r, object, &info, place, &left);
  if (!good || !take_switch(r, object, "draft_colors", &p->draft_colors, &left))
    return 0;
  p->shadows = 0; /* of dumps older than they are */
  if (json_member(object, "shadows") && !take_switch(r, object, "shadows", &p->shadows, &left))
    return 0;
  const json *warp = take(r, object, "warp", &left), *weft = take(r, object, "weft", &left);
  return none_left(r, left, "cloth") && read_yarn(r, warp, "warp", &p->warp) &&
         read_yarn(r, weft, "weft", &p->weft);
}

static shade_draft *read_draft(const reading *r, const json *object, int *left) {
  char error[256] = "";
  const int named = json_member(object, "weave") != NULL;
  const json *text = take(r, object, named ? "weave" : "draft", left);
  if (!text)
    return NULL;
  shade_draft *draft =
      text->type != JSON_STRING ? NULL
      : named                   ? shade_draft_named(text->string)
              : shade_wif_parse(text->string, strlen(text->string), "draft", error, sizeof error);
  if (!draft)
    bad_value(r, text->key, named ? "a name of shade weave --help" : *error ? error : "a string");
  return draft;
}

check_cloth *check_read_fabric(const json *object, char *message, size_t size) {
  const reading r = {message, size};
  shade_weave_params yarns;
  shade_fabric_params cloth;
  message[0] = 0;
  shade_weave_params_init(&yarns);
  shade_fabric_params_init(&cloth);
  if (!is_object(&r, object, "fabric"))
    return NULL;
  int left = members(object);
  check_cloth *c = calloc(1, sizeof *c);
  if (!c) {
    wrong(&r, "out of memory for", "fabric");
    return NULL;
  }
  c->draft = read_draft(&r, object, &left);
  const json *shape = take(&r, object, "yarns", &left);
  const json *material = take(&r, object, "cloth", &left);
  if (c->draft && none_left(&r, left, "fabric") && read_yarns(&r, shape, &yarns) &&
      read_cloth(&r, material, &cloth)) {
    c->reference = shade_ref_cloth_of(c->draft, &yarns, &cloth);
    return c;
  }
  check_free_fabric(c);
  return NULL;
}

void check_free_fabric(check_cloth *c) {
  if (!c)
    return;
  shade_draft_free(c->draft);
  free(c);
}

/* ---- a hit ------------------------------------------------------------------------------- */

check_tier check_tier_of(const check_hit *h) {
  if (h->tier == SHADE_TIER_NEAR)
    return CHECK_NEAR;
  if (h->tier == SHADE_TIER_SINGLE)
    return CHECK_SINGLE;
  return h->tier == SHADE_TIER_AUTO && shade_ref_far_share(h->foot) <= 0 ? CHECK_NEAR : CHECK_FAR;
}

/*
 * The far model and single lobes are approximations, the far one good to 2 % of the mean colour. A
 * value of one direction may be off by more: 9 % were seen of a silk's highlight in a fold.
 */
double check_limit(check_tier tier) {
  return tier == CHECK_SINGLE ? 0.05 : 0.15;
}
double check_sum_limit(check_tier tier) {
  return tier == CHECK_SINGLE ? 0.04 : 0.02;
}

/* Near the point's, or the mean over the points of its footprint; far a share, as good as those. */
int check_coverage(const check_hit *h, double coverage) {
  const shade_ref_cloth *c = &h->cloth->reference;
  const check_tier tier = check_tier_of(h);
  double low = 1, high = 0;
  if (!(coverage >= 0 && coverage <= 1))
    return 0;
  if (tier != CHECK_NEAR || (h->tier == SHADE_TIER_AUTO && (h->foot[0] > 0 || h->foot[1] > 0)))
    return 1;
  for (int k = 0; k < 5; k++) { /* beside an edge rounding decides */
    const double step = k == 0 ? 0 : (k % 2 ? 1 : -1) * 1e-7 * fmax(1, fabs(h->uv[k > 2]));
    const double uv[2] = {h->uv[0] + (k < 3 ? step : 0), h->uv[1] + (k < 3 ? 0 : step)};
    const double one = shade_ref_cloth_coverage(c, uv, h->n, h->wo);
    low = fmin(low, one);
    high = fmax(high, one);
  }
  return coverage >= low - 1e-5 && coverage <= high + 1e-5;
}

void check_prepare_single(check_cloth *cloth) {
  if (!cloth->has_seen)
    cloth->seen = shade_ref_cloth_seen(&cloth->reference, LOOKS);
  cloth->has_seen = 1;
}

void check_cloth_s(const check_hit *h, int points, const double uv[2], const double n[3],
                   const double wi[3], const double wo[3], double s[3], double doubt[3]) {
  const check_cloth *c = h->cloth;
  double near[3];
  switch (check_tier_of(h)) {
  case CHECK_SINGLE:
    shade_ref_cloth_single(&c->reference, &c->seen, n, wi, wo, s);
    break;
  case CHECK_FAR: {
    const double share = h->tier == SHADE_TIER_FAR ? 1 : shade_ref_far_share(h->foot);
    shade_ref_cloth_mean(&c->reference, uv, h->foot, points, n, wi, wo, s, doubt);
    shade_ref_cloth_points(&c->reference, uv, h->foot, n, wi, wo, near);
    for (int i = 0; i < 3; i++) {
      s[i] = (1 - share) * near[i] + share * s[i];
      doubt[i] *= share;
    }
    break;
  }
  default:
    if (h->tier == SHADE_TIER_NEAR)
      shade_ref_cloth_near(&c->reference, uv, n, wi, wo, s);
    else
      shade_ref_cloth_points(&c->reference, uv, h->foot, n, wi, wo, s);
  }
}
