/* SPDX-License-Identifier: Apache-2.0 */
/* Names, defaults, ranges and the JSON of a material, all from the table. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "shade/shade.h"
#include "json_text.h"
#include "names.h"
#include "params.h"

#define LIST_ENTRIES(NAME, word, ...)                                                              \
  static const shade_list_entry word##_rows[] = {SHADE_TABLE_##NAME(SHADE_LIST_ENTRY)};
SHADE_TABLE_LISTS(LIST_ENTRIES)

#define IN_EVERY 1
#define IN_LATER 0

#define LIST_ROWS(NAME, word, initial, older, dumps, help)                                         \
  {word##_rows,                                                                                    \
   SHADE_##NAME##_COUNT,                                                                           \
   {#word, help, (int)SHADE_##NAME##_##initial, (int)SHADE_##NAME##_##older, IN_##dumps,           \
    offsetof(shade_params, word)}},
static const struct {
  const shade_list_entry *rows;
  int count;
  shade_list_info about;
} lists[] = {SHADE_TABLE_LISTS(LIST_ROWS)};

#define COMPONENTS_REAL 1
#define COMPONENTS_COLOUR 3
#define PARAM_ROW(word, kind, unit, low, high, initial, list, choices, dumps, help)                \
  {#word, unit,    help,       COMPONENTS_##kind,           low, high, initial,                    \
   list,  choices, IN_##dumps, offsetof(shade_params, word)},
static const shade_param_info params[] = {SHADE_TABLE_PARAMS(PARAM_ROW)};

#define PARAM_INDEX(word, ...) PARAM_##word,
enum { SHADE_TABLE_PARAMS(PARAM_INDEX) PARAM_COUNT };

/* Rows and members are the same. Here, one 0 for each number: a member without a row lacks its
 * initialiser, one 0 too many has no member. */
#define ONE_ZERO(...) 0,
#define ZEROS_REAL 0,
#define ZEROS_COLOUR 0, 0, 0,
#define KIND_OF_ZEROS(word, kind, ...) ZEROS_##kind
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-braces"
#pragma GCC diagnostic error "-Wmissing-field-initializers"
static const shade_params nothing = {0,
                                     0,
                                     SHADE_TABLE_LISTS(ONE_ZERO)
                                         SHADE_TABLE_PARAMS(KIND_OF_ZEROS) /* defaults */ 0,
                                     {0, 0, 0, 0, 0}};
#pragma GCC diagnostic pop
#define MEMBER_FITS(word, kind, ...)                                                               \
  _Static_assert(sizeof nothing.word == COMPONENTS_##kind * sizeof(double),                        \
                 #word ": its row and its member differ in kind");
SHADE_TABLE_PARAMS(MEMBER_FITS)
#define CHOICE_FITS(NAME, word, ...)                                                               \
  _Static_assert(sizeof nothing.word == sizeof(int), #word ": no enum");
SHADE_TABLE_LISTS(CHOICE_FITS)

int shade_list_find(shade_list list, const char *word) {
  if (!word || (unsigned)list >= SHADE_LIST_COUNT)
    return -1;
  for (int i = 0; i < lists[list].count; i++)
    if (same_word(word, lists[list].rows[i].word))
      return lists[list].rows[i].value;
  return -1;
}

const char *shade_list_word(shade_list list, int value) {
  if ((unsigned)list >= SHADE_LIST_COUNT)
    return NULL;
  for (int i = 0; i < lists[list].count; i++)
    if (lists[list].rows[i].value == value)
      return lists[list].rows[i].word;
  return NULL;
}

int shade_fill_row(const shade_list_entry *rows, int count, int row, int *value, const char **word,
                   const char **label, const char **help) {
  if (row < 0 || row >= count)
    return 0;
  const shade_list_entry *r = &rows[row];
  if (value)
    *value = r->value;
  if (word)
    *word = r->word;
  if (label)
    *label = r->label;
  if (help)
    *help = r->help;
  return 1;
}

int shade_list_row(shade_list list, int row, int *value, const char **word, const char **label,
                   const char **help) {
  return (unsigned)list < SHADE_LIST_COUNT &&
         shade_fill_row(lists[list].rows, lists[list].count, row, value, word, label, help);
}

const char *shade_list_name(shade_list list) {
  return (unsigned)list < SHADE_LIST_COUNT ? lists[list].about.word : NULL;
}

int shade_list_about(shade_list list, shade_list_info *info) {
  if ((unsigned)list >= SHADE_LIST_COUNT)
    return 0;
  *info = lists[list].about;
  return 1;
}

int shade_list_default(shade_list list, int defaults) {
  if ((unsigned)list >= SHADE_LIST_COUNT)
    return -1;
#define CHANGE_ROW(version, LIST, before)                                                          \
  if (list == SHADE_LIST_##LIST && defaults < version)                                             \
    return (int)SHADE_##LIST##_##before;
  SHADE_TABLE_CHANGES(CHANGE_ROW)
  return lists[list].about.initial;
}

int shade_param_find(const char *word) {
  for (int row = 0; word && row < PARAM_COUNT; row++)
    if (same_word(word, params[row].word))
      return row;
  return -1;
}

int shade_param_row(int row, shade_param_info *info) {
  if (row < 0 || row >= PARAM_COUNT)
    return 0;
  if (info)
    *info = params[row];
  return 1;
}

/* Clamp to the table's range; NaN becomes the default. */
static double clamp(int index, double x, unsigned *status) {
  const shade_param_info *p = &params[index];
  double y = isnan(x) ? p->initial : fmin(fmax(x, p->minimum), p->maximum);
  if (!(x == y))
    *status |= SHADE_CLAMPED_PARAMETER;
  return y;
}

/* Where a list's choice and a row's numbers stand. */
static int *choice_at(shade_params *p, shade_list list) {
  return (int *)(void *)((char *)p + lists[list].about.offset);
}
static double *numbers_at(shade_params *p, int row) {
  return (double *)(void *)((char *)p + params[row].offset);
}

void shade_params_init(shade_params *p) {
  shade_params_init_as(p, SHADE_DEFAULTS);
}

void shade_params_init_as(shade_params *p, int defaults) {
  *p = nothing;
  p->size = sizeof *p;
  p->defaults = defaults < 0 ? 0 : defaults < SHADE_DEFAULTS ? (size_t)defaults : SHADE_DEFAULTS;
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    *choice_at(p, (shade_list)list) = shade_list_default((shade_list)list, defaults);
  for (int row = 0; row < PARAM_COUNT; row++)
    for (int c = 0; c < params[row].components; c++)
      numbers_at(p, row)[c] = params[row].initial;
  /* the table states its alphas to eight digits */
  shade_params_set_exponents(p, params[PARAM_ex].initial, params[PARAM_ey].initial);
}

/* e = 2/alpha^2 - 2 and back. */
static double alpha_of(double exponent) {
  return sqrt(2 / (exponent + 2));
}
static double exponent_of(double alpha) {
  return fmax(0, 2 / (alpha * alpha) - 2);
}

/* Where two rows say the same of one axis. */
static const struct { int exponent, alpha; } axes[] = {{PARAM_ex, PARAM_ax}, {PARAM_ey, PARAM_ay}};

static unsigned set_axis(shade_params *p, int axis, int row, double x) {
  const int exponent = axes[axis].exponent, alpha = axes[axis].alpha;
  unsigned status = SHADE_OK, ignored = SHADE_OK;
  double *e = numbers_at(p, exponent), *a = numbers_at(p, alpha);
  if (row == exponent) {
    *e = clamp(exponent, x, &status);
    *a = alpha_of(*e);
  } else {
    *a = clamp(alpha, x, &status);
    /* alpha below 1.41e-3 lies past the largest exponent: the pair may differ there */
    *e = clamp(exponent, exponent_of(*a), &ignored);
  }
  return status;
}

unsigned shade_params_set_exponents(shade_params *p, double ex, double ey) {
  if (!shade_size_is_set(p->size))
    return SHADE_BAD_INPUT;
  return set_axis(p, 0, PARAM_ex, ex) | set_axis(p, 1, PARAM_ey, ey);
}

unsigned shade_params_set_alphas(shade_params *p, double ax, double ay) {
  if (!shade_size_is_set(p->size))
    return SHADE_BAD_INPUT;
  return set_axis(p, 0, PARAM_ax, ax) | set_axis(p, 1, PARAM_ay, ay);
}

static int has_list(const shade_params *p, shade_list list) {
  return (unsigned)list < SHADE_LIST_COUNT && lists[list].about.offset + sizeof(int) <= p->size;
}

static int has_row(const shade_params *p, int row) {
  return row >= 0 && row < PARAM_COUNT &&
         params[row].offset + (size_t)params[row].components * sizeof(double) <= p->size;
}

unsigned shade_params_set_choice(shade_params *p, shade_list list, int value) {
  if (!has_list(p, list))
    return SHADE_BAD_INPUT;
  const int known = shade_list_word(list, value) != NULL;
  *choice_at(p, list) = known ? value : lists[list].rows[0].value;
  return known ? SHADE_OK : SHADE_BAD_CHOICE;
}

int shade_params_get_choice(const shade_params *p, shade_list list) {
  int value = -1;
  if (has_list(p, list))
    memcpy(&value, (const char *)p + lists[list].about.offset, sizeof value);
  return value;
}

unsigned shade_params_set(shade_params *p, int row, const double *v) {
  unsigned status = SHADE_OK;
  if (!has_row(p, row))
    return SHADE_BAD_INPUT;
  for (int axis = 0; axis < 2; axis++)
    if (row == axes[axis].exponent || row == axes[axis].alpha)
      return set_axis(p, axis, row, *v);
  for (int c = 0; c < params[row].components; c++)
    numbers_at(p, row)[c] = clamp(row, v[c], &status);
  return status;
}

unsigned shade_params_get(const shade_params *p, int row, double *v) {
  if (!has_row(p, row))
    return SHADE_BAD_INPUT;
  memcpy(v, (const char *)p + params[row].offset, (size_t)params[row].components * sizeof *v);
  return SHADE_OK;
}

shade_brdf shade_brdf_before_auto(shade_brdf brdf) {
  return brdf == SHADE_BRDF_AUTO ? (shade_brdf)shade_list_default(SHADE_LIST_BRDF, 0) : brdf;
}

shade_params shade_whole_params(const shade_params *given) {
  shade_params p;
  shade_params_init(&p);
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    *choice_at(&p, (shade_list)list) = lists[list].about.older;
  p.defaults = 0;
  if (given && shade_size_is_set(given->size)) {
    memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
    if (given->size <= offsetof(shade_params, defaults))
      p.brdf = shade_brdf_before_auto(p.brdf);
  } else
    shade_params_init(&p);
  p.size = sizeof p;
  return p;
}

/* A map's slopes within their ranges; what is no number is 0. Returns status bits. */
static unsigned clamp_slopes(double slopes[5]) {
  static const double least[5] = {-1e3, -1e3, 0, -1e6, 0}, most[5] = {1e3, 1e3, 1e6, 1e6, 1e6};
  double within[5];
  for (int c = 0; c < 5; c++)
    within[c] = isnan(slopes[c]) ? 0 : fmin(fmax(slopes[c], least[c]), most[c]);
  const double widest = sqrt(within[2]) * sqrt(within[4]);
  if (!(fabs(within[3]) <= widest * (1 + 1e-7))) /* rounded to float it may lie beyond */
    within[3] = within[3] > 0 ? widest : -widest;
  int same = 1;
  for (int c = 0; c < 5; c++)
    same &= within[c] == slopes[c];
  memcpy(slopes, within, sizeof within);
  return same ? SHADE_OK : SHADE_CLAMPED_PARAMETER;
}

static int has_slopes(const shade_params *p) {
  return offsetof(shade_params, slopes) + sizeof p->slopes <= p->size;
}

unsigned shade_params_set_slopes(shade_params *p, const double slopes[5]) {
  if (!has_slopes(p))
    return SHADE_BAD_INPUT;
  memcpy(p->slopes, slopes, sizeof p->slopes);
  return clamp_slopes(p->slopes);
}

unsigned shade_params_get_slopes(const shade_params *p, double slopes[5]) {
  if (!has_slopes(p))
    return SHADE_BAD_INPUT;
  memcpy(slopes, p->slopes, sizeof p->slopes);
  return SHADE_OK;
}

shade_params shade_params_within_ranges(const shade_params *given, unsigned *status) {
  shade_params p = shade_whole_params(given);
  if (given && !shade_size_is_set(given->size))
    *status |= SHADE_BAD_INPUT;
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    *status |= shade_params_set_choice(&p, (shade_list)list, *choice_at(&p, (shade_list)list));
  /* exponents and alphas each by themselves: a caller may have set the pair that is read, only */
  for (int row = 0; row < PARAM_COUNT; row++)
    for (int c = 0; c < params[row].components; c++)
      numbers_at(&p, row)[c] = clamp(row, numbers_at(&p, row)[c], status);
  *status |= clamp_slopes(p.slopes);
  return p;
}

/* Appends as snprintf does, counting what did not fit. */
typedef struct text {
  char *buffer;
  size_t capacity, length;
} text;

static void put(text *t, const char *s) {
  for (; *s; s++, t->length++)
    if (t->length + 1 < t->capacity)
      t->buffer[t->length] = *s;
}

static void put_number(text *t, const char *key, double value) {
  char number[64];
  snprintf(number, sizeof number, "%.17g", value);
  for (char *c = number; *c; c++) /* a comma locale must not break the JSON */
    if (*c == ',')
      *c = '.';
  put(t, key);
  put(t, number);
}

static void put_string(text *t, const char *s) {
  put(t, "\"");
  for (; *s; s++) {
    char letter[JSON_LETTER];
    json_letter(*s, letter);
    put(t, letter);
  }
  put(t, "\"");
}

static void put_key(text *t, const char *key) {
  put(t, ", \"");
  put(t, key);
  put(t, "\": ");
}

int shade_params_json(const shade_params *given, int id, const char *name, char *buffer,
                      size_t capacity) {
  unsigned unused = SHADE_OK;
  shade_params p = shade_params_within_ranges(given, &unused);
  text t = {buffer, capacity, 0};
  put_number(&t, "{\"id\": ", id);
  put(&t, ", \"name\": ");
  put_string(&t, name ? name : "");
  for (int list = 0; list < SHADE_LIST_COUNT; list++) {
    put_key(&t, lists[list].about.word);
    put_string(&t, shade_list_word((shade_list)list, *choice_at(&p, (shade_list)list)));
  }
  for (int row = 0; row < PARAM_COUNT; row++) {
    const int count = params[row].components;
    put_key(&t, params[row].word);
    for (int c = 0; c < count; c++)
      put_number(&t, c > 0 ? ", " : count > 1 ? "[" : "", numbers_at(&p, row)[c]);
    put(&t, count > 1 ? "]" : "");
  }
  if (p.slopes[2] > 0 || p.slopes[4] > 0)
    for (int c = 0; c < 5; c++)
      put_number(&t, c ? ", " : ", \"slopes\": [", p.slopes[c]);
  put(&t, p.slopes[2] > 0 || p.slopes[4] > 0 ? "]}" : "}");
  if (capacity)
    buffer[t.length < capacity ? t.length : capacity - 1] = 0;
  return (int)t.length;
}
