/* SPDX-License-Identifier: Apache-2.0 */
/* Roughness and anisotropy as other programs state them, and measured metals. */
#include <math.h>

#include "shade/shade.h"
#include "names.h"
#include "params.h"

static const shade_list_entry roughness_rows[] = {SHADE_TABLE_ROUGHNESS(SHADE_LIST_ENTRY)};

int shade_roughness_row(int row, int *value, const char **word, const char **label,
                        const char **help) {
  return shade_fill_row(roughness_rows, SHADE_ROUGHNESS_COUNT, row, value, word, label, help);
}

static double between(double x, double low, double high) {
  return fmin(fmax(isnan(x) ? 0 : x, low), high);
}

unsigned shade_params_set_roughness(shade_params *p, shade_roughness convention, double roughness,
                                    double anisotropy) {
  if (!shade_size_is_set(p->size))
    return SHADE_BAD_INPUT;
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
  unsigned status = shade_size_is_set(given->size) ? SHADE_OK : SHADE_BAD_INPUT;
  if (!status)
    status = shade_params_set_alphas(&p, given->ax, given->ay);
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
  if (metal)
    *metal = metals[row];
  return 1;
}

int shade_params_set_metal(shade_params *p, const char *word) {
  shade_metal m;
  for (int row = 0; word && shade_metal_row(row, &m); row++) {
    if (!same_word(word, m.word))
      continue;
    if (!shade_size_is_set(p->size))
      return 0;
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
