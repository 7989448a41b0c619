/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of a cloth by row, and a cloth as JSON for the header of a dump. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "json_writer.h"
#include "shade/fabric.h"
#include "params.h"

#define COMPONENTS_REAL 1
#define COMPONENTS_COLOUR 3
typedef struct number_row {
  shade_param_info info;
  size_t offset;
} number_row;

#define ROW_OF(type, member, kind, low, high, start, about)                                        \
  {{.word = #member,                                                                               \
    .unit = "",                                                                                    \
    .help = about,                                                                                 \
    .components = COMPONENTS_##kind,                                                               \
    .minimum = low,                                                                                \
    .maximum = high,                                                                               \
    .initial = start},                                                                             \
   offsetof(type, member)},
#define YARN_ROW(...) ROW_OF(shade_yarn, __VA_ARGS__)
#define FABRIC_ROW(...) ROW_OF(shade_fabric_params, __VA_ARGS__)
static const number_row yarn_rows[] = {SHADE_TABLE_FABRIC_YARN(YARN_ROW)};
static const number_row fabric_rows[] = {SHADE_TABLE_FABRIC(FABRIC_ROW)};
enum {
  YARN_ROWS = sizeof yarn_rows / sizeof yarn_rows[0],
  FABRIC_ROWS = sizeof fabric_rows / sizeof fabric_rows[0]
};

double *shade_fabric_yarn_number(shade_yarn *yarn, int row, shade_param_info *info) {
  if (row < 0 || row >= YARN_ROWS)
    return NULL;
  if (info)
    *info = yarn_rows[row].info;
  return (double *)(void *)((char *)yarn + yarn_rows[row].offset);
}

double *shade_fabric_number(shade_fabric_params *p, int row, shade_param_info *info) {
  if (row < 0 || row >= FABRIC_ROWS)
    return NULL;
  if (info)
    *info = fabric_rows[row].info;
  return (double *)(void *)((char *)p + fabric_rows[row].offset);
}

static void put_key(json_text *t, const char **comma, const char *key) {
  json_put(t, *comma);
  json_put_string(t, key);
  json_put(t, ": ");
  *comma = ", ";
}

static void put_numbers(json_text *t, const char **comma, const shade_param_info *info,
                        const double *v) {
  put_key(t, comma, info->word);
  for (int c = 0; c < info->components; c++) {
    const double x = isnan(v[c]) ? info->initial : fmin(fmax(v[c], info->minimum), info->maximum);
    json_put_number(t, c ? ", " : info->components > 1 ? "[" : "", x);
  }
  json_put(t, info->components > 1 ? "]" : "");
}

static void put_choice(json_text *t, const char **comma, shade_list list, int value) {
  const char *word = shade_list_word(list, value);
  if (!word)
    shade_list_row(list, 0, NULL, &word, NULL, NULL);
  put_key(t, comma, shade_list_name(list));
  json_put_string(t, word);
}

static void put_shape(json_text *t, const shade_yarn_params *given) {
  const char *comma = "{";
  shade_yarn_params yarn = *given;
  shade_param_info info;
  for (int row = 0; shade_yarn_param_row(row, &info); row++)
    put_numbers(t, &comma, &info, shade_yarn_param(&yarn, info.word));
  json_put(t, "}");
}

int shade_weave_params_json(const shade_weave_params *given, char *buffer, size_t capacity) {
  json_text t = {buffer, capacity, 0};
  const char *comma = "{", *word = NULL;
  shade_weave_params p;
  shade_weave_params_init(&p);
  memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  if (!shade_occlusion_row((int)p.occlusion, NULL, &word, NULL, NULL))
    shade_occlusion_row(0, NULL, &word, NULL, NULL);
  put_key(&t, &comma, "occlusion");
  json_put_string(&t, word);
  put_key(&t, &comma, "seed");
  json_put_number(&t, "", (double)p.seed);
  put_key(&t, &comma, "warp");
  put_shape(&t, &p.warp);
  put_key(&t, &comma, "weft");
  put_shape(&t, &p.weft);
  json_put(&t, "}");
  return json_end(&t);
}

static void put_yarn(json_text *t, const shade_yarn *given) {
  const char *comma = "{";
  shade_yarn yarn = *given;
  shade_param_info info;
  const double *v;
  for (int row = 0; (v = shade_fabric_yarn_number(&yarn, row, &info)); row++)
    put_numbers(t, &comma, &info, v);
  put_choice(t, &comma, SHADE_LIST_DIFFUSE, (int)yarn.diffuse);
  json_put(t, "}");
}

int shade_fabric_params_json(const shade_fabric_params *given, char *buffer, size_t capacity) {
  json_text t = {buffer, capacity, 0};
  const char *comma = "{";
  shade_param_info info;
  const double *v;
  shade_fabric_params p = shade_whole_fabric(given);
  put_choice(&t, &comma, SHADE_LIST_MDF, (int)p.mdf);
  put_choice(&t, &comma, SHADE_LIST_BRDF, (int)p.brdf);
  put_choice(&t, &comma, SHADE_LIST_DETAIL, (int)p.detail);
  put_choice(&t, &comma, SHADE_LIST_HORIZON, (int)p.horizon);
  put_key(&t, &comma, "draft_colors");
  json_put(&t, p.draft_colors ? "true" : "false");
  put_key(&t, &comma, "shadows");
  json_put(&t, p.shadows ? "true" : "false");
  for (int row = 0; (v = shade_fabric_number(&p, row, &info)); row++)
    put_numbers(&t, &comma, &info, v);
  put_key(&t, &comma, "warp");
  put_yarn(&t, &p.warp);
  put_key(&t, &comma, "weft");
  put_yarn(&t, &p.weft);
  json_put(&t, "}");
  return json_end(&t);
}

/* Appends what `write` gives. */
static void put_all(json_text *t, int length) {
  t->length += (size_t)length;
}
static char *rest_of(const json_text *t, size_t *room) {
  *room = t->length < t->capacity ? t->capacity - t->length : 0;
  return *room ? t->buffer + t->length : NULL;
}

int shade_fabric_json(int id, const char *name, const shade_draft *draft, const char *weave,
                      const shade_weave_params *yarns, const shade_fabric_params *cloth,
                      char *buffer, size_t capacity) {
  json_text t = {buffer, capacity, 0};
  char *text = weave ? NULL : shade_wif_text(draft);
  if (!weave && !text)
    return -1;
  size_t room;
  json_put_number(&t, "{\"id\": ", id);
  json_put(&t, ", \"name\": ");
  json_put_string(&t, name ? name : "");
  json_put(&t, weave ? ", \"fabric\": {\"weave\": " : ", \"fabric\": {\"draft\": ");
  json_put_string(&t, weave ? weave : text);
  free(text);
  json_put(&t, ", \"yarns\": ");
  char *at = rest_of(&t, &room);
  put_all(&t, shade_weave_params_json(yarns, at, room));
  json_put(&t, ", \"cloth\": ");
  at = rest_of(&t, &room);
  put_all(&t, shade_fabric_params_json(cloth, at, room));
  json_put(&t, "}}");
  return json_end(&t);
}
