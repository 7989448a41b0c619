/* SPDX-License-Identifier: Apache-2.0 */
/* Names, defaults, ranges and the JSON of a material, all from the table. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "shade/shade.h"
#include "names.h"
#include "params.h"

static const shade_list_entry mdf_rows[] = {SHADE_TABLE_MDF(SHADE_LIST_ENTRY)};
static const shade_list_entry brdf_rows[] = {SHADE_TABLE_BRDF(SHADE_LIST_ENTRY)};
static const shade_list_entry detail_rows[] = {SHADE_TABLE_DETAIL(SHADE_LIST_ENTRY)};
static const shade_list_entry groove_rows[] = {SHADE_TABLE_GROOVE(SHADE_LIST_ENTRY)};
static const shade_list_entry fresnel_rows[] = {SHADE_TABLE_FRESNEL(SHADE_LIST_ENTRY)};
static const shade_list_entry diffuse_rows[] = {SHADE_TABLE_DIFFUSE(SHADE_LIST_ENTRY)};
static const shade_list_entry horizon_rows[] = {SHADE_TABLE_HORIZON(SHADE_LIST_ENTRY)};

static const struct {
  const char *name;
  const shade_list_entry *rows;
  int count;
} lists[SHADE_LIST_COUNT] = {
    [SHADE_LIST_MDF] = {"mdf", mdf_rows, SHADE_MDF_COUNT},
    [SHADE_LIST_BRDF] = {"brdf", brdf_rows, SHADE_BRDF_COUNT},
    [SHADE_LIST_DETAIL] = {"detail", detail_rows, SHADE_DETAIL_COUNT},
    [SHADE_LIST_GROOVE] = {"groove", groove_rows, SHADE_GROOVE_COUNT},
    [SHADE_LIST_FRESNEL] = {"fresnel", fresnel_rows, SHADE_FRESNEL_COUNT},
    [SHADE_LIST_DIFFUSE] = {"diffuse", diffuse_rows, SHADE_DIFFUSE_COUNT},
    [SHADE_LIST_HORIZON] = {"horizon", horizon_rows, SHADE_HORIZON_COUNT},
};

#define COMPONENTS_REAL 1
#define COMPONENTS_COLOUR 3
#define PARAM_ROW(word, kind, unit, low, high, initial, help)                                      \
  {#word, unit, help, COMPONENTS_##kind, low, high, initial},
static const shade_param_info params[] = {SHADE_TABLE_PARAMS(PARAM_ROW)};

#define PARAM_INDEX(word, kind, unit, low, high, initial, help) PARAM_##word,
enum { SHADE_TABLE_PARAMS(PARAM_INDEX) PARAM_COUNT };

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
  return (unsigned)list < SHADE_LIST_COUNT ? lists[list].name : NULL;
}

int shade_param_row(int row, shade_param_info *info) {
  if (row < 0 || row >= PARAM_COUNT)
    return 0;
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

void shade_params_init(shade_params *p) {
  memset(p, 0, sizeof *p);
  p->size = sizeof *p;
  p->detail = SHADE_DETAIL_ROTATE;
  p->fresnel = SHADE_FRESNEL_SCHLICK;
  p->horizon = SHADE_HORIZON_VALID_ESTEVEZ;
  for (int c = 0; c < 3; c++) {
    p->f0[c] = params[PARAM_f0].initial;
    p->f82[c] = params[PARAM_f82].initial;
    p->eta[c] = params[PARAM_eta].initial;
    p->k[c] = params[PARAM_k].initial;
    p->kd[c] = params[PARAM_kd].initial;
  }
  shade_params_set_exponents(p, params[PARAM_ex].initial, params[PARAM_ey].initial);
}

/* e = 2/alpha^2 - 2 and back. */
static double alpha_of(double exponent) {
  return sqrt(2 / (exponent + 2));
}
static double exponent_of(double alpha) {
  return fmax(0, 2 / (alpha * alpha) - 2);
}

unsigned shade_params_set_exponents(shade_params *p, double ex, double ey) {
  unsigned status = SHADE_OK;
  p->ex = clamp(PARAM_ex, ex, &status);
  p->ey = clamp(PARAM_ey, ey, &status);
  p->ax = alpha_of(p->ex);
  p->ay = alpha_of(p->ey);
  return status;
}

unsigned shade_params_set_alphas(shade_params *p, double ax, double ay) {
  unsigned status = SHADE_OK, ignored = SHADE_OK;
  p->ax = clamp(PARAM_ax, ax, &status);
  p->ay = clamp(PARAM_ay, ay, &status);
  /* alpha below 1.41e-3 lies past the largest exponent: the pair may differ there */
  p->ex = clamp(PARAM_ex, exponent_of(p->ax), &ignored);
  p->ey = clamp(PARAM_ey, exponent_of(p->ay), &ignored);
  return status;
}

static int choice(shade_list list, int value, unsigned *status) {
  if (shade_list_word(list, value))
    return value;
  *status |= SHADE_BAD_CHOICE;
  return lists[list].rows[0].value;
}

shade_params shade_whole_params(const shade_params *given) {
  shade_params p;
  shade_params_init(&p);
  p.horizon = SHADE_HORIZON_HARD;
  memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  p.size = sizeof p;
  return p;
}

shade_params shade_params_within_ranges(const shade_params *given, unsigned *status) {
  shade_params p = shade_whole_params(given);
  p.mdf = (shade_mdf)choice(SHADE_LIST_MDF, (int)p.mdf, status);
  p.brdf = (shade_brdf)choice(SHADE_LIST_BRDF, (int)p.brdf, status);
  p.detail = (shade_detail)choice(SHADE_LIST_DETAIL, (int)p.detail, status);
  p.groove = (shade_groove)choice(SHADE_LIST_GROOVE, (int)p.groove, status);
  p.fresnel = (shade_fresnel)choice(SHADE_LIST_FRESNEL, (int)p.fresnel, status);
  p.diffuse = (shade_diffuse)choice(SHADE_LIST_DIFFUSE, (int)p.diffuse, status);
  p.horizon = (shade_horizon)choice(SHADE_LIST_HORIZON, (int)p.horizon, status);
  p.ex = clamp(PARAM_ex, p.ex, status);
  p.ey = clamp(PARAM_ey, p.ey, status);
  p.ax = clamp(PARAM_ax, p.ax, status);
  p.ay = clamp(PARAM_ay, p.ay, status);
  for (int c = 0; c < 3; c++) {
    p.f0[c] = clamp(PARAM_f0, p.f0[c], status);
    p.f82[c] = clamp(PARAM_f82, p.f82[c], status);
    p.eta[c] = clamp(PARAM_eta, p.eta[c], status);
    p.k[c] = clamp(PARAM_k, p.k[c], status);
    p.kd[c] = clamp(PARAM_kd, p.kd[c], status);
  }
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
    char escaped[8] = {*s};
    if (*s == '"' || *s == '\\')
      snprintf(escaped, sizeof escaped, "\\%c", *s);
    else if ((unsigned char)*s < 0x20)
      snprintf(escaped, sizeof escaped, "\\u%04x", (unsigned)(unsigned char)*s);
    put(t, escaped);
  }
  put(t, "\"");
}

static void put_choice(text *t, shade_list list, int value) {
  const char *word = shade_list_word(list, value);
  put(t, ", \"");
  put(t, lists[list].name);
  put(t, "\": ");
  put_string(t, word ? word : lists[list].rows[0].word);
}

static void put_colour(text *t, const char *name, const double v[3]) {
  put(t, ", \"");
  put(t, name);
  put_number(t, "\": [", v[0]);
  put_number(t, ", ", v[1]);
  put_number(t, ", ", v[2]);
  put(t, "]");
}

int shade_params_json(const shade_params *given, int id, const char *name, char *buffer,
                      size_t capacity) {
  unsigned unused = SHADE_OK;
  const shade_params p = shade_params_within_ranges(given, &unused);
  text t = {buffer, capacity, 0};
  put_number(&t, "{\"id\": ", id);
  put(&t, ", \"name\": ");
  put_string(&t, name ? name : "");
  put_choice(&t, SHADE_LIST_MDF, (int)p.mdf);
  put_choice(&t, SHADE_LIST_BRDF, (int)p.brdf);
  put_choice(&t, SHADE_LIST_DETAIL, (int)p.detail);
  put_choice(&t, SHADE_LIST_GROOVE, (int)p.groove);
  put_choice(&t, SHADE_LIST_FRESNEL, (int)p.fresnel);
  put_choice(&t, SHADE_LIST_DIFFUSE, (int)p.diffuse);
  put_choice(&t, SHADE_LIST_HORIZON, (int)p.horizon);
  put_number(&t, ", \"ex\": ", p.ex);
  put_number(&t, ", \"ey\": ", p.ey);
  put_number(&t, ", \"ax\": ", p.ax);
  put_number(&t, ", \"ay\": ", p.ay);
  put_colour(&t, "f0", p.f0);
  put_colour(&t, "f82", p.f82);
  put_colour(&t, "eta", p.eta);
  put_colour(&t, "k", p.k);
  put_colour(&t, "kd", p.kd);
  put(&t, "}");
  if (capacity)
    buffer[t.length < capacity ? t.length : capacity - 1] = 0;
  return (int)t.length;
}
