/* SPDX-License-Identifier: Apache-2.0 */
/* shade check: what came out, as text or as JSON. */
#include "tool/check.h"
#include "tool/tool.h"

#include <math.h>
#include <stdio.h>

static const char *const fault_words[FAULT_COUNT] = {
    [FAULT_ID] = "material.ID is not in the header",
    [FAULT_MISS] = "a miss (material.ID -1) carries S",
    [FAULT_NOT_FINITE] = "P, uv, Color or what else varies is not finite",
    [FAULT_UNIT_N] = "N is not unit",
    [FAULT_UNIT_T] = "T is not unit",
    [FAULT_UNIT_NS] = "Ns is not unit",
    [FAULT_UNIT_V] = "V is not unit",
    [FAULT_UNIT_L] = "a light's L is not unit",
    [FAULT_TANGENT] = "T is not orthogonal to N",
    [FAULT_E] = "E is negative or not finite",
    [FAULT_S] = "S is not finite",
    [FAULT_REFERENCE] = "the reference gives no finite value",
    [FAULT_CLOTH] = "foot or uv on cloth is out of range, or tier is none",
    [FAULT_COVERAGE] = "coverage is not what the cloth has there",
    [FAULT_LOBE] = "a lobe's Ns is not a unit vector, or shares are no parts of 1",
};

static const char *const tier_words[CHECK_TIERS] = {[CHECK_FAR] = "far", [CHECK_SINGLE] = "single"};

typedef struct verdict {
  size_t checked, faults, apart_over;
  double largest, beyond, mean, mean_beyond; /* the worst of all cells */
  size_t excused;
  int idle_materials, idle_lights; /* with nothing to compare */
  int pass;
} verdict;

static double mean_of(const check_cell *in) {
  return in->checked ? in->sum / (double)in->checked : 0;
}

/* The same less what the rounding of directions may do, where that was asked. */
static double mean_beyond(const check_cell *in) {
  return in->checked ? in->beyond_sum / (double)in->checked : 0;
}

/* How far the sums of what is judged apart are from each other. */
static double off(const check_apart *a) {
  return a->reference > 0 ? fabs(a->s / a->reference - 1) : a->s > 0;
}

/* Values that are judged apart, and whether they pass. */
static size_t judge_apart(const check_cell *in, size_t *over) {
  size_t checked = 0;
  for (int tier = CHECK_FAR; tier < CHECK_TIERS; tier++) {
    const check_apart *a = &in->apart[tier];
    checked += a->checked;
    /* a few values are no mean */
    *over += a->over + (a->checked >= 24 && off(a) > check_sum_limit((check_tier)tier));
  }
  return checked;
}

static verdict judge(const check *c) {
  verdict v = {0};
  const int lights = c->dump->lights;
  for (int m = 0; m < c->material_count; m++) {
    size_t checked = 0;
    for (int light = 0; light < lights; light++) {
      const check_cell *in = check_cell_at(c, m, light);
      checked += in->checked + judge_apart(in, &v.apart_over);
      v.largest = fmax(v.largest, in->largest);
      v.beyond = fmax(v.beyond, in->beyond);
      v.excused += in->excused;
      v.mean = fmax(v.mean, mean_of(in));
      v.mean_beyond = fmax(v.mean_beyond, mean_beyond(in));
    }
    v.checked += checked;
    v.idle_materials += checked == 0;
  }
  for (int light = 0; light < lights; light++) {
    size_t checked = 0;
    for (int m = 0; m < c->material_count; m++) {
      size_t counted_above = 0;
      const check_cell *in = check_cell_at(c, m, light);
      checked += in->checked + judge_apart(in, &counted_above);
    }
    v.idle_lights += checked == 0;
  }
  for (int i = 0; i < FAULT_COUNT; i++)
    v.faults += c->faults[i];
  v.pass = v.checked > 0 && v.faults == 0 && v.apart_over == 0 &&
           v.beyond <= c->options->tolerance && v.mean_beyond <= c->options->mean_tolerance &&
           !(c->options->all && (v.idle_materials || v.idle_lights));
  return v;
}

static int pixel_x(const check *c, size_t pixel) {
  return (int)(pixel % (size_t)c->dump->width);
}
static int pixel_y(const check *c, size_t pixel) {
  return (int)(pixel / (size_t)c->dump->width);
}

static void print_apart(const check *c) {
  for (int m = 0; m < c->material_count; m++)
    for (int light = 0; light < c->dump->lights; light++)
      for (int tier = CHECK_FAR; tier < CHECK_TIERS; tier++) {
        const check_apart *a = &check_cell_at(c, m, light)->apart[tier];
        if (a->checked)
          printf("apart: material %d, light %d, cloth %s: %zu values, largest error %.3e at (%d, "
                 "%d), beyond doubt %.3e (limit %g), %zu over it, of their sum %.3e (limit %g)\n",
                 c->materials[m].id, light, tier_words[tier], a->checked, a->largest,
                 pixel_x(c, a->worst_pixel), pixel_y(c, a->worst_pixel), a->beyond,
                 check_limit((check_tier)tier), a->over, off(a), check_sum_limit((check_tier)tier));
      }
}

static void print_text(const check *c, const verdict *v) {
  const shade_dump *d = c->dump;
  printf("%s: %d x %d pixels, %d light%s, %d material%s, from %s\n", c->options->path, d->width,
         d->height, d->lights, d->lights == 1 ? "" : "s", c->material_count,
         c->material_count == 1 ? "" : "s", c->renderer);
  printf("%8s %-20s %-12s %9s %6s %5s %9s %10s %10s  %s\n", "material", "", "detail", "pixels",
         "tilt", "light", "values", "largest", "mean", "worst pixel: S, reference");
  for (int m = 0; m < c->material_count; m++)
    for (int light = 0; light < d->lights; light++) {
      const check_material *mat = &c->materials[m];
      const check_cell *in = check_cell_at(c, m, light);
      printf("%8d %-20s %-12s %9zu %6.2f %5d %9zu ", mat->id, mat->name,
             shade_list_word(SHADE_LIST_DETAIL, (int)mat->params.detail), mat->pixels,
             mat->tilt / DEGREE, light, in->checked);
      if (in->checked)
        printf("%10.3e %10.3e  (%d, %d) %c: %.9g, %.9g\n", in->largest, mean_of(in),
               pixel_x(c, in->worst_pixel), pixel_y(c, in->worst_pixel), "RGB"[in->worst_channel],
               in -> worst_s, in -> worst_reference);
      else
        printf("%10s %10s  %s\n", "-", "-",
               !mat->pixels ? "not in the picture"
               : v->faults  ? "unlit, or at fault (below)"
                            : "unlit");
    }
  print_apart(c);
  for (int i = 0; i < FAULT_COUNT; i++)
    if (c->faults[i])
      printf("fault: %s: %zu times, first at (%d, %d)\n", fault_words[i], c->faults[i],
             pixel_x(c, c->first_fault[i]), pixel_y(c, c->first_fault[i]));
  if (c->horizon)
    printf("left out: %zu values on the horizon, where rounding decides\n", c->horizon);
  if (v->idle_materials || v->idle_lights)
    printf("not compared: %d material%s and %d light%s without a value\n", v->idle_materials,
           v->idle_materials == 1 ? "" : "s", v->idle_lights, v->idle_lights == 1 ? "" : "s");
  if (v->excused)
    printf(
        "excused: %zu values over the limit by no more than the rounding of the dump's directions "
        "may do; the others, and what is left of these, are off by at most %.3e\n",
        v->excused, v->beyond);
  if (v->mean > c->options->mean_tolerance)
    printf("means over the limit: beyond what that rounding may do, they are %.3e at most\n",
           v->mean_beyond);
  printf("%s: ", v->pass ? "PASS" : "FAIL");
  if (v->checked == 0)
    printf("nothing to compare\n");
  else
    printf("%zu values, largest error %.3e (limit %g), largest mean %.3e (limit %g), "
           "%zu fault%s\n",
           v->checked, v->largest, c->options->tolerance, v->mean, c->options->mean_tolerance,
           v->faults, v->faults == 1 ? "" : "s");
}

static void print_json_cell(const check *c, const check_material *m, const check_cell *in,
                            int light) {
  printf("{\"material\": %d, \"name\": ", m->id);
  json_print_string(stdout, m->name);
  printf(", \"detail\": \"%s\", \"pixels\": %zu, \"tilt\": %.6g, \"light\": %d, \"values\": %zu",
         shade_list_word(SHADE_LIST_DETAIL, (int)m->params.detail), m->pixels, m->tilt / DEGREE,
         light, in->checked);
  if (in->checked)
    printf(", \"largest\": %.17g, \"mean\": %.17g, \"mean_beyond\": %.17g, \"worst\": {\"x\": %d, "
           "\"y\": %d, "
           "\"channel\": \"%c\", \"s\": %.9g, \"reference\": %.17g, \"rounding\": %.6g}",
           in->largest, mean_of(in), mean_beyond(in), pixel_x(c, in->worst_pixel),
           pixel_y(c, in->worst_pixel), "RGB"[in->worst_channel], in -> worst_s,
           in -> worst_reference, in -> worst_rounding);
  for (int tier = CHECK_FAR; tier < CHECK_TIERS; tier++) {
    const check_apart *a = &in->apart[tier];
    if (a->checked)
      printf(", \"%s\": {\"values\": %zu, \"largest\": %.17g, \"beyond_doubt\": %.17g, \"sum\": "
             "%.17g, \"limit\": %g, \"sum_limit\": %g, \"over\": %zu, \"x\": %d, \"y\": %d}",
             tier_words[tier], a->checked, a->largest, a->beyond, off(a),
             check_limit((check_tier)tier), check_sum_limit((check_tier)tier), a->over,
             pixel_x(c, a->worst_pixel), pixel_y(c, a->worst_pixel));
  }
  printf("}");
}

static void print_json(const check *c, const verdict *v) {
  const shade_dump *d = c->dump;
  printf("{\"file\": ");
  json_print_string(stdout, c->options->path);
  printf(", \"renderer\": ");
  json_print_string(stdout, c->renderer);
  printf(",\n \"pass\": %s, \"width\": %d, \"height\": %d, \"lights\": %d,\n"
         " \"tolerance\": %.17g, \"mean_tolerance\": %.17g, \"values\": %zu, \"largest\": %.17g, "
         "\"beyond_rounding\": %.17g, \"excused\": %zu, \"mean\": %.17g, \"mean_beyond_rounding\": "
         "%.17g,\n \"horizon\": %zu, "
         "\"idle_materials\": %d, \"idle_lights\": %d,\n"
         " \"faults\": [",
         v->pass ? "true" : "false", d->width, d->height, d->lights, c->options->tolerance,
         c->options->mean_tolerance, v->checked, v->largest, v->beyond, v->excused, v->mean,
         v->mean_beyond, c->horizon, v->idle_materials, v->idle_lights);
  const char *comma = "";
  for (int i = 0; i < FAULT_COUNT; i++)
    if (c->faults[i]) {
      printf("%s\n  {\"what\": \"%s\", \"count\": %zu, \"x\": %d, \"y\": %d}", comma,
             fault_words[i], c->faults[i], pixel_x(c, c->first_fault[i]),
             pixel_y(c, c->first_fault[i]));
      comma = ",";
    }
  printf("],\n \"cells\": [");
  comma = "";
  for (int m = 0; m < c->material_count; m++)
    for (int light = 0; light < d->lights; light++) {
      printf("%s\n  ", comma);
      print_json_cell(c, &c->materials[m], check_cell_at(c, m, light), light);
      comma = ",";
    }
  printf("]}\n");
}

int check_report(const check *c) {
  const verdict v = judge(c);
  (c->options->json ? print_json : print_text)(c, &v);
  return v.pass;
}
