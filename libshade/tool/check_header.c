/* SPDX-License-Identifier: Apache-2.0 */
/* shade check: the materials that a dump's header lists. */
#include "tool/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Says what is wrong with a material of the file's header. Always 0. */
static int bad_material(const char *path, int index, const char *message, const char *word) {
  fprintf(stderr, "shade check: %s: material number %d of the header: %s '%s'\n", path, index,
          message, word);
  return 0;
}

void check_expected_number(const shade_param_info *info, char *text, size_t size) {
  snprintf(text, size, "%s from %g to %g", info->components > 1 ? "[r, g, b], each" : "a number",
           info->minimum, info->maximum);
}

void check_add_choice(const char *word, char *text, size_t size, size_t *length) {
  if (*length < size)
    *length +=
        (size_t)snprintf(text + *length, size - *length, "%s\"%s\"", *length ? " or " : "", word);
}

void check_expected_choice(shade_list list, char *text, size_t size) {
  const char *word;
  size_t length = 0;
  text[0] = 0;
  for (int row = 0; shade_list_row(list, row, NULL, &word, NULL, NULL); row++)
    check_add_choice(word, text, size, &length);
}

/* As bad_material, with what the key of the table wants. Always 0. */
static int bad_value(const char *path, int index, const char *key) {
  char wanted[CHECK_EXPECTED] = "";
  shade_param_info info;
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    if (strcmp(key, shade_list_name((shade_list)list)) == 0)
      check_expected_choice((shade_list)list, wanted, sizeof wanted);
  for (int row = 0; shade_param_row(row, &info); row++)
    if (strcmp(key, info.word) == 0)
      check_expected_number(&info, wanted, sizeof wanted);
  if (strcmp(key, "id") == 0)
    snprintf(wanted, sizeof wanted, "a whole number from 0 to %d", 1 << 24);
  if (strcmp(key, "name") == 0)
    snprintf(wanted, sizeof wanted, "a string");
  if (strcmp(key, "slopes") == 0)
    snprintf(wanted, sizeof wanted, "[x, y, xx, xy, yy] as a map's slopes are");
  fprintf(stderr,
          "shade check: %s: material number %d of the header: bad value of '%s': expected %s\n",
          path, index, key, wanted);
  return 0;
}

/* One number, or an array of as many as the parameter has, into its place in *p, as the file has
 * them: an exponent and an alpha that do not belong together are the dump's to answer for. */
static int read_param(shade_params *p, const shade_param_info *info, const json *value) {
  double *place = (double *)(void *)((char *)p + info->offset);
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

/*
 * A key of the table: its number for `seen`, or -1. Lists come first, then the
 * parameters. *good says whether the value fits.
 */
static int read_table_key(shade_params *p, const json *member, int *good) {
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    if (strcmp(member->key, shade_list_name((shade_list)list)) == 0) {
      const int value = shade_list_find((shade_list)list, member->string);
      *good = value >= 0;
      if (*good)
        shade_params_set_choice(p, (shade_list)list, value);
      return list;
    }
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    if (strcmp(member->key, info.word) == 0) {
      *good = read_param(p, &info, member);
      return SHADE_LIST_COUNT + row;
    }
  return -1;
}

/* The word of a key that every dump has and this one lacks, or NULL. What dumps may lack is set
 * to what it was before there was a choice. */
static const char *lacking(shade_params *p, const char *seen) {
  shade_list_info list;
  for (int i = 0; shade_list_about((shade_list)i, &list); i++) {
    if (seen[i])
      continue;
    if (list.in_every_dump)
      return list.word;
    shade_params_set_choice(p, (shade_list)i, list.older);
  }
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    if (!seen[SHADE_LIST_COUNT + row] && info.in_every_dump)
      return info.word;
  return NULL;
}

static int is_id(const json *value) { /* a float of material.ID holds it exactly */
  return value->type == JSON_NUMBER && value->number >= 0 && value->number <= 1 << 24 &&
         value->number == floor(value->number);
}

/* A cloth: its id, its name and what it is made of, no more. */
static int read_cloth(check_material *m, const char *path, int index, const json *object) {
  int id = 0, fabric = 0, name = 0;
  char message[320];
  m->name = "";
  shade_params_init(&m->params);
  m->params.horizon = SHADE_HORIZON_HARD;
  for (const json *member = object->child; member; member = member->next) {
    int *seen = strcmp(member->key, "id") == 0       ? &id
                : strcmp(member->key, "name") == 0   ? &name
                : strcmp(member->key, "fabric") == 0 ? &fabric
                                                     : NULL;
    if (!seen)
      return bad_material(path, index, "unknown key beside fabric:", member->key);
    if ((*seen)++)
      return bad_material(path, index, "two values of", member->key);
    if ((seen == &id && !is_id(member)) || (seen == &name && member->type != JSON_STRING))
      return bad_value(path, index, member->key);
    if (seen == &id)
      m->id = (int)member->number;
    if (seen == &name)
      m->name = member->string;
    if (seen == &fabric && !(m->cloth = check_read_fabric(member, message, sizeof message))) {
      fprintf(stderr, "shade check: %s: material number %d of the header: fabric: %s\n", path,
              index, message);
      return 0;
    }
  }
  return id || bad_material(path, index, "lacks", "id");
}

/* The slopes of a map, within their ranges. */
static int read_slopes(shade_params *p, const json *value) {
  double v[5];
  const json *item = value->type == JSON_ARRAY ? value->child : NULL;
  for (int i = 0; i < 5; i++, item = item->next) {
    if (!item || item->type != JSON_NUMBER)
      return 0;
    v[i] = item->number;
  }
  return !item && shade_params_set_slopes(p, v) == SHADE_OK;
}

/* Every key that all dumps have must be there, none twice; one that is not known might matter. */
static int read_material(check_material *m, const char *path, int index, const json *object) {
#define ONE(...) +1
  enum { ID = SHADE_LIST_COUNT SHADE_TABLE_PARAMS(ONE), NAME, SLOPES, KEYS };
#undef ONE
  char seen[KEYS] = {0};
  shade_params_init(&m->params);
  m->name = "";
  if (object->type != JSON_OBJECT)
    return bad_material(path, index, "is no", "{ }");
  if (json_member(object, "fabric"))
    return read_cloth(m, path, index, object);
  for (const json *member = object->child; member; member = member->next) {
    int good = 1, key = read_table_key(&m->params, member, &good);
    if (strcmp(member->key, "id") == 0) {
      key = ID;
      good = is_id(member);
      m->id = good ? (int)member->number : 0;
    } else if (strcmp(member->key, "name") == 0) {
      key = NAME;
      good = member->type == JSON_STRING;
      m->name = member->string;
    } else if (strcmp(member->key, "slopes") == 0) {
      key = SLOPES;
      good = read_slopes(&m->params, member);
    }
    if (key < 0)
      return bad_material(path, index, "unknown key", member->key);
    if (!good)
      return bad_value(path, index, member->key);
    if (seen[key]++)
      return bad_material(path, index, "two values of", member->key);
  }
  if (!seen[ID])
    return bad_material(path, index, "lacks", "id");
  const char *word = lacking(&m->params, seen);
  if (word)
    return bad_material(path, index, "lacks", word);
  return 1;
}

static int by_id(const void *a, const void *b) {
  return ((const check_material *)a)->id - ((const check_material *)b)->id;
}

/* Sorted by id. NULL after printing why. */
check_material *check_read_materials(const char *path, const json *header, int *count) {
  const json *list = json_member(header, "materials");
  *count = 0;
  if (!list || list->type != JSON_ARRAY || !list->child) {
    fprintf(
        stderr,
        "shade check: %s: the header lists no \"materials\": expected an array of at least one\n",
        path);
    return NULL;
  }
  for (const json *item = list->child; item; item = item->next)
    ++*count;
  check_material *materials = calloc((size_t)*count, sizeof *materials);
  if (!materials) {
    fputs("shade check: out of memory\n", stderr);
    return NULL;
  }
  int good = 1, index = 0;
  for (const json *item = list->child; good && item; item = item->next, index++)
    good = read_material(&materials[index], path, index, item);
  if (good)
    qsort(materials, (size_t)*count, sizeof *materials, by_id);
  for (int i = 1; good && i < *count; i++)
    if (materials[i].id == materials[i - 1].id) {
      fprintf(stderr, "shade check: %s: two materials of the header have id %d\n", path,
              materials[i].id);
      good = 0;
    }
  if (good)
    return materials;
  check_free_materials(materials, *count);
  return NULL;
}

void check_free_materials(check_material *materials, int count) {
  for (int i = 0; i < count; i++)
    check_free_fabric(materials[i].cloth);
  free(materials);
}

int check_find_material(const check *c, float id) {
  if (!(id >= 0 && id <= 1 << 24) || id != floorf(id))
    return -1;
  const check_material key = {.id = (int)id};
  const check_material *found =
      bsearch(&key, c->materials, (size_t)c->material_count, sizeof key, by_id);
  return found ? (int)(found - c->materials) : -1;
}
