/* SPDX-License-Identifier: Apache-2.0 */
/* Names, defaults, ranges and set-up, all from the table. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "shade/shade.h"
#include "names.h"
#include "params.h"

#define PI 3.14159265358979323846

typedef struct list_row {
  int value;
  const char *word, *label, *help;
} list_row;

#define LIST_ROW(NAME, word, value, label, help) {value, #word, label, help},
static const list_row mdf_rows[] = {SHADE_TABLE_MDF(LIST_ROW)};
static const list_row brdf_rows[] = {SHADE_TABLE_BRDF(LIST_ROW)};
static const list_row detail_rows[] = {SHADE_TABLE_DETAIL(LIST_ROW)};
static const list_row groove_rows[] = {SHADE_TABLE_GROOVE(LIST_ROW)};
static const list_row fresnel_rows[] = {SHADE_TABLE_FRESNEL(LIST_ROW)};
static const list_row diffuse_rows[] = {SHADE_TABLE_DIFFUSE(LIST_ROW)};
static const list_row horizon_rows[] = {SHADE_TABLE_HORIZON(LIST_ROW)};

static const struct {
  const char *name;
  const list_row *rows;
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

static int fill_row(const list_row *rows, int count, int row, int *value, const char **word,
                    const char **label, const char **help) {
  if (row < 0 || row >= count)
    return 0;
  const list_row *r = &rows[row];
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
         fill_row(lists[list].rows, lists[list].count, row, value, word, label, help);
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

static const list_row roughness_rows[] = {SHADE_TABLE_ROUGHNESS(LIST_ROW)};

int shade_roughness_row(int row, int *value, const char **word, const char **label,
                        const char **help) {
  return fill_row(roughness_rows, SHADE_ROUGHNESS_COUNT, row, value, word, label, help);
}

static double between(double x, double low, double high) {
  return fmin(fmax(isnan(x) ? 0 : x, low), high);
}

unsigned shade_params_set_roughness(shade_params *p, shade_roughness convention, double roughness,
                                    double anisotropy) {
  unsigned status = SHADE_OK;
  if ((unsigned)convention >= SHADE_ROUGHNESS_COUNT) {
    status = SHADE_BAD_CHOICE;
    convention = SHADE_ROUGHNESS_BLENDER_PRINCIPLED;
  }
  const int glossy = convention == SHADE_ROUGHNESS_BLENDER_GLOSSY ||
                     convention == SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79;
  const double r = between(roughness, 0, 1), a = between(anisotropy, glossy ? -1 : 0, 1);
  if (!(r == roughness && a == anisotropy))
    status |= SHADE_CLAMPED_PARAMETER;
  double ax = r * r, ay = r * r;
  switch (convention) {
  case SHADE_ROUGHNESS_BLENDER_GLOSSY:
  case SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79: {
    double alpha = convention == SHADE_ROUGHNESS_BLENDER_GLOSSY ? r * r : r;
    double stretch = 1 - fmin(fabs(a), 0.99);
    ax = a < 0 ? alpha / stretch : alpha * stretch;
    ay = a < 0 ? alpha * stretch : alpha / stretch;
    break;
  }
  case SHADE_ROUGHNESS_GLTF:
    ax += (1 - ax) * a * a;
    break;
  case SHADE_ROUGHNESS_MATERIALX: {
    double aspect = sqrt(1 - fmin(a, 0.98));
    ax = fmin(ax / aspect, 1);
    ay *= aspect;
    break;
  }
  case SHADE_ROUGHNESS_OPENPBR:
    ax *= sqrt(2 / (1 + (1 - a) * (1 - a)));
    ay = (1 - a) * ax;
    break;
  case SHADE_ROUGHNESS_BLENDER_PRINCIPLED:
  default: {
    double aspect = sqrt(1 - 0.9 * a);
    ax /= aspect;
    ay *= aspect;
  }
  }
  /* a mirror's alpha of 0 is not out of range there, only here */
  shade_params_set_alphas(p, fmax(ax, 1e-4), fmax(ay, 1e-4));
  return status;
}

unsigned shade_params_get_roughness(const shade_params *given, shade_roughness convention,
                                    double *roughness, double *anisotropy, int *turned) {
  shade_params p;
  shade_params_init(&p);
  unsigned status = shade_params_set_alphas(&p, given->ax, given->ay);
  if ((unsigned)convention >= SHADE_ROUGHNESS_COUNT) {
    status |= SHADE_BAD_CHOICE;
    convention = SHADE_ROUGHNESS_BLENDER_PRINCIPLED;
  }
  const int glossy = convention == SHADE_ROUGHNESS_BLENDER_GLOSSY ||
                     convention == SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79;
  const int narrow_x = p.ax < p.ay;
  const double wide = fmax(p.ax, p.ay), narrow = fmin(p.ax, p.ay), ratio = narrow / wide;
  double r2 = sqrt(wide * narrow), a = 0;
  switch (convention) {
  case SHADE_ROUGHNESS_BLENDER_GLOSSY:
  case SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79:
    a = fmin(1 - sqrt(ratio), 0.99) * (narrow_x ? 1 : -1);
    break;
  case SHADE_ROUGHNESS_GLTF:
    r2 = fmin(narrow, 1);
    a = r2 < 1 ? sqrt(fmin((wide - r2) / (1 - r2), 1)) : 0;
    break;
  case SHADE_ROUGHNESS_MATERIALX:
    a = fmin(1 - ratio, 0.98);
    break;
  case SHADE_ROUGHNESS_OPENPBR:
    a = 1 - ratio;
    r2 = wide * sqrt(0.5 * (1 + ratio * ratio));
    break;
  case SHADE_ROUGHNESS_BLENDER_PRINCIPLED:
  default:
    a = fmin((1 - ratio) / 0.9, 1);
  }
  *roughness = fmin(convention == SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79 ? r2 : sqrt(r2), 1);
  *anisotropy = a;
  *turned = narrow_x && !glossy;
  /* there and back: whatever their clamps or ours kept from coming through shows */
  shade_params_set_roughness(&p, convention, *roughness, a);
  if (!(fabs(fmax(p.ax, p.ay) - wide) <= 1e-9 * wide &&
        fabs(fmin(p.ax, p.ay) - narrow) <= 1e-9 * narrow))
    status |= SHADE_CLAMPED_PARAMETER;
  return status;
}

#define METAL_ROW(NAME, word, label, er, eg, eb, kr, kg, kb)                                       \
  {#word, label, {er, eg, eb}, {kr, kg, kb}},
static const shade_metal metals[] = {SHADE_TABLE_METALS(METAL_ROW)};

int shade_metal_row(int row, shade_metal *metal) {
  if (row < 0 || row >= (int)(sizeof metals / sizeof metals[0]))
    return 0;
  *metal = metals[row];
  return 1;
}

int shade_params_set_metal(shade_params *p, const char *word) {
  shade_metal m;
  for (int row = 0; word && shade_metal_row(row, &m); row++) {
    if (!same_word(word, m.word))
      continue;
    p->fresnel = SHADE_FRESNEL_CONDUCTOR;
    for (int c = 0; c < 3; c++) {
      double k2 = m.k[c] * m.k[c];
      p->eta[c] = m.eta[c];
      p->k[c] = m.k[c];
      p->f0[c] = ((m.eta[c] - 1) * (m.eta[c] - 1) + k2) / ((m.eta[c] + 1) * (m.eta[c] + 1) + k2);
    }
    return 1;
  }
  return 0;
}

static int choice(shade_list list, int value, unsigned *status) {
  if (shade_list_word(list, value))
    return value;
  *status |= SHADE_BAD_CHOICE;
  return lists[list].rows[0].value;
}

/* ratio_only: Ashikhmin-Shirley sees neither a common scale of x and y, nor L. */
static shade_map resolve(const shade_bsdf *b, int ratio_only, int groove_y) {
  shade_map short_by_l = groove_y ? SHADE_MAP_APPROXIMATE_Y : SHADE_MAP_APPROXIMATE_X;
  switch (b->detail) {
  case SHADE_DETAIL_PERTURB:
    return ratio_only ? SHADE_MAP_PERTURB_RATIO : SHADE_MAP_PERTURB;
  case SHADE_DETAIL_GRAM_SCHMIDT:
    /* its x' is x without its part along n: the x' of groove transport along y */
    return ratio_only ? SHADE_MAP_APPROXIMATE_Y : SHADE_MAP_ROTATE_Y;
  case SHADE_DETAIL_ROTATE:
    return ratio_only ? short_by_l : groove_y ? SHADE_MAP_ROTATE_Y : SHADE_MAP_ROTATE_X;
  case SHADE_DETAIL_ROTATE_APPROXIMATE:
    return short_by_l;
  case SHADE_DETAIL_SHORTEST_ARC:
    return SHADE_MAP_SHORTEST_ARC;
  case SHADE_DETAIL_DEFORM_LINEAR:
  case SHADE_DETAIL_DEFORM_LINEAR_CONSERVING:
    return SHADE_MAP_DEFORM_LINEAR;
  case SHADE_DETAIL_DEFORM_SMOOTH:
  case SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING:
    return SHADE_MAP_DEFORM_SMOOTH;
  default:
    return SHADE_MAP_NONE;
  }
}

/* No more than the lobe needs: a round one is carried exactly by perturb. */
static shade_detail choose_detail(const shade_bsdf *b) {
  return b->kx == b->ky ? SHADE_DETAIL_PERTURB : SHADE_DETAIL_ROTATE;
}

shade_params shade_whole_params(const shade_params *given) {
  shade_params p;
  shade_params_init(&p);
  p.horizon = SHADE_HORIZON_HARD;
  memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  p.size = sizeof p;
  return p;
}

/* The same with the parameters within their ranges. */
static shade_params within_ranges(const shade_params *given, unsigned *status) {
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

/* What directions are drawn from; see kernel/pass_sample.h. */
static void setup_draws(shade_bsdf *b, const shade_params *p, int groove_y) {
  const int warp = b->map >= SHADE_MAP_DEFORM_LINEAR;
  const int visible = b->brdf == SHADE_BRDF_MICROFACET && !warp;
  const double per_alpha = b->mdf == SHADE_MDF_WARD ? 2 : 1;
  b->sx = b->kx * per_alpha;
  b->sy = b->ky * per_alpha;
  switch (b->mdf) {
  case SHADE_MDF_WARD_HALF:
    b->draw = SHADE_DRAW_HALF;
    break;
  case SHADE_MDF_BECKMANN:
    b->draw = visible ? SHADE_DRAW_VISIBLE_GAUSSIAN : SHADE_DRAW_GAUSSIAN;
    break;
  case SHADE_MDF_GGX:
    b->draw = visible ? SHADE_DRAW_VISIBLE_GGX : SHADE_DRAW_GGX;
    break;
  default: /* Ward too: with exponents 2/alpha^2 its lobe is within this one */
    b->draw = SHADE_DRAW_PHONG;
  }
  b->draw_parts = 1;
  b->draw_map = resolve(b, 0, groove_y);
  if (b->detail == SHADE_DETAIL_PERTURB) { /* a round lobe is carried by any rigid frame */
    b->draw_map = SHADE_MAP_SHORTEST_ARC;
    b->draw_parts = b->kx == b->ky ? 1 : 3;
  }
  if (b->detail == SHADE_DETAIL_ROTATE_APPROXIMATE)
    b->draw_map = groove_y ? SHADE_MAP_ROTATE_Y : SHADE_MAP_ROTATE_X;
  b->draw_even =
      b->diffuse != SHADE_DIFFUSE_LAMBERT && b->diffuse != SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY;
  for (int c = 0; c < 3; c++) {
    double f0 = b->f0[c], k2 = b->k[c] * b->k[c];
    double left = b->diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY ? 1 - f0 : 1;
    if (b->fresnel == SHADE_FRESNEL_CONDUCTOR)
      f0 = ((p->eta[c] - 1) * (p->eta[c] - 1) + k2) / ((p->eta[c] + 1) * (p->eta[c] + 1) + k2);
    b->share_lobe += f0 / 3;
    b->share_diffuse += b->kd[c] * left / 3;
  }
  b->sxf = (float)b->sx;
  b->syf = (float)b->sy;
  b->share_lobef = (float)b->share_lobe;
  b->share_diffusef = (float)b->share_diffuse;
}

unsigned shade_bsdf_setup(shade_bsdf *b, const shade_params *given) {
  unsigned status = SHADE_OK;
  const shade_params p = within_ranges(given, &status);
  memset(b, 0, sizeof *b);
  b->mdf = p.mdf;
  b->brdf = p.brdf;
  b->detail = p.detail;
  b->fresnel = p.fresnel;
  b->diffuse = p.diffuse;

  if (b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    b->kx = p.ex;
    b->ky = p.ey;
    b->gx = 2 / (b->kx + 2);
    b->gy = 2 / (b->ky + 2);
    b->peak = sqrt((b->kx + 1) * (b->ky + 1)) / (2 * PI);
  } else {
    b->gx = p.ax * p.ax;
    b->gy = p.ay * p.ay;
    b->kx = 1 / b->gx;
    b->ky = 1 / b->gy;
    b->peak = 1 / (PI * p.ax * p.ay);
  }

  int groove_y = p.groove == SHADE_GROOVE_Y || (p.groove == SHADE_GROOVE_AUTO && b->ky > b->kx);
  if (b->detail == SHADE_DETAIL_AUTO)
    b->detail = choose_detail(b);
  b->fibres_along_y = groove_y;
  b->horizon = b->detail == SHADE_DETAIL_NONE ? SHADE_HORIZON_HARD : p.horizon;
  b->map = resolve(b, b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY, groove_y);
  b->shadow_map = b->map >= SHADE_MAP_DEFORM_LINEAR ? SHADE_MAP_PERTURB : resolve(b, 0, groove_y);

  b->conserve = b->detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING ||
                b->detail == SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING;
  b->fast = p.fast && b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY &&
            (b->map == SHADE_MAP_NONE || b->map == SHADE_MAP_PERTURB_RATIO ||
             b->map == SHADE_MAP_APPROXIMATE_X || b->map == SHADE_MAP_APPROXIMATE_Y);
  b->kxf = (float)b->kx;
  b->kyf = (float)b->ky;
  b->gxf = (float)b->gx;
  b->gyf = (float)b->gy;
  b->peakf = (float)b->peak;
  for (int c = 0; c < 3; c++) {
    b->f0[c] = p.f0[c];
    b->f0f[c] = (float)b->f0[c];
    if (b->fresnel == SHADE_FRESNEL_F82)
      b->tint[c] = p.f82[c];
    if (b->fresnel == SHADE_FRESNEL_CONDUCTOR) {
      b->tint[c] = p.eta[c];
      b->k[c] = p.k[c];
    }
    b->kd[c] = p.kd[c];
    b->has_diffuse |= b->kd[c] > 0;
    b->kdf[c] = (float)b->kd[c];
    b->tintf[c] = (float)b->tint[c];
    b->kf[c] = (float)b->k[c];
  }
  setup_draws(b, &p, groove_y);
  return status;
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
  const shade_params p = within_ranges(given, &unused);
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
