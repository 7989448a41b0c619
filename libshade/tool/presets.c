/* SPDX-License-Identifier: Apache-2.0 */
/* shade presets: cloths and metals by name, with their numbers. */
#include <stdio.h>
#include <string.h>

#include "shade/presets.h"
#include "tool/json.h"
#include "tool/tool.h"

static void usage(FILE *to) {
  fputs(
      "usage: shade presets [--json] [NAME]\n\n"
      "Without a name: all presets, one a line. With one: its numbers, and where they come from.\n"
      "  --json   as JSON: an array, or the object of that name\n\n"
      "Names read - and _ alike, capitals or not.\n",
      to);
}

static void string(const char *key, const char *value) {
  printf("\"%s\": ", key);
  json_print_string(stdout, value);
}

static void color(const char *key, const double c[3]) {
  printf(", \"%s\": [%.12g, %.12g, %.12g]", key, c[0], c[1], c[2]);
}

static void yarn_json(const char *key, shade_yarn_params *shape, const shade_yarn *y) {
  shade_param_info info;
  printf(", \"%s\": {\"along\": %.12g, \"across\": %.12g", key, y->along, y->across);
  color("f0", y->f0);
  color("kd", y->kd);
  printf(", \"diffuse\": \"%s\"", shade_list_word(SHADE_LIST_DIFFUSE, (int)y->diffuse));
  for (int row = 0; shade_yarn_param_row(row, &info); row++)
    printf(", \"%s\": %.12g", info.word, *shade_yarn_param(shape, info.word));
  putchar('}');
}

static void fabric_json(shade_preset *p) {
  const shade_fabric_params *f = &p->fabric;
  const char *occlusion = "";
  shade_occlusion_row((int)p->yarns.occlusion, NULL, &occlusion, NULL, NULL);
  printf(", \"weave\": \"%s\", \"ends_per_cm\": %.12g, \"picks_per_cm\": %.12g", p->weave,
         p->ends_per_cm, p->picks_per_cm);
  yarn_json("warp", &p->yarns.warp, &f->warp);
  yarn_json("weft", &p->yarns.weft, &f->weft);
  printf(", \"occlusion\": \"%s\", \"mdf\": \"%s\", \"brdf\": \"%s\", \"detail\": \"%s\"",
         occlusion, shade_list_word(SHADE_LIST_MDF, (int)f->mdf),
         shade_list_word(SHADE_LIST_BRDF, (int)f->brdf),
         shade_list_word(SHADE_LIST_DETAIL, (int)f->detail));
  color("backing", f->backing);
  printf(", \"nap\": %.12g", f->nap);
  color("nap_color", f->nap_color);
}

static void range(const char *key, shade_range r) {
  printf(", \"%s\": [%.12g, %.12g]", key, r.low, r.high);
}

static void metal_json(const shade_preset *p) {
  char material[2048];
  shade_params_json(&p->metal, 0, p->word, material, sizeof material);
  printf(", \"turned\": %s, \"scratch_cm\": %.12g, \"scratches\": [", p->turned ? "true" : "false",
         p->scratch_cm);
  for (int k = 0; k < p->scratches.layers; k++) {
    const shade_scratch_layer *l = &p->scratches.layer[k];
    printf("%s{\"pits\": %u", k ? ", " : "", (unsigned)l->pits);
    range("radius", l->radius);
    range("stretch", l->stretch);
    range("depth", l->depth);
    printf(", \"direction\": %.12g, \"spread\": %.12g}", l->direction, l->spread);
  }
  printf("], \"material\": %s", material);
}

static void print_json(shade_preset *p) {
  putchar('{');
  string("name", p->word);
  printf(", \"kind\": \"%s\", ", p->kind == SHADE_PRESET_FABRIC ? "fabric" : "metal");
  string("label", p->label);
  printf(", ");
  string("help", p->help);
  printf(", ");
  string("source", p->source);
  printf(", ");
  string("color_source", p->color_source);
  if (p->kind == SHADE_PRESET_FABRIC)
    fabric_json(p);
  else
    metal_json(p);
  putchar('}');
}

static void show_yarn(const char *name, shade_yarn_params *shape, const shade_yarn *y) {
  shade_param_info info;
  printf("  %s\n    %-16s %g along the fibres, %g across\n", name, "exponents", y->along,
         y->across);
  printf("    %-16s %g %g %g\n", "f0", y->f0[0], y->f0[1], y->f0[2]);
  printf("    %-16s %g %g %g (%s)\n", "kd", y->kd[0], y->kd[1], y->kd[2],
         shade_list_word(SHADE_LIST_DIFFUSE, (int)y->diffuse));
  for (int row = 0; shade_yarn_param_row(row, &info); row++)
    printf("    %-16s %-8g %s\n", info.word, *shade_yarn_param(shape, info.word), info.help);
}

static void show(shade_preset *p) {
  printf("%s: %s, %s\n  sources: %s; colour: %s\n", p->word, p->label, p->help, p->source,
         p->color_source);
  if (p->kind == SHADE_PRESET_FABRIC) {
    printf("  weave %s, %g ends and %g picks per cm\n", p->weave, p->ends_per_cm, p->picks_per_cm);
    show_yarn("warp", &p->yarns.warp, &p->fabric.warp);
    show_yarn("weft", &p->yarns.weft, &p->fabric.weft);
    printf("  backing %g %g %g, nap %g\n", p->fabric.backing[0], p->fabric.backing[1],
           p->fabric.backing[2], p->fabric.nap);
    return;
  }
  const shade_params *m = &p->metal;
  printf("  exponents %g along the strokes, %g across (alphas %.3f, %.3f), strokes %s\n", m->ex,
         m->ey, m->ax, m->ay, p->turned ? "in circles" : "straight");
  printf("  eta %g %g %g, k %g %g %g\n", m->eta[0], m->eta[1], m->eta[2], m->k[0], m->k[1],
         m->k[2]);
  for (int k = 0; k < p->scratches.layers; k++) {
    const shade_scratch_layer *l = &p->scratches.layer[k];
    printf("  scratches: %u on %g cm, radius %g to %g of that, stretch %g to %g, depth %g to %g, "
           "direction %.3g, spread %.3g degrees\n",
           (unsigned)l->pits, p->scratch_cm, l->radius.low, l->radius.high, l->stretch.low,
           l->stretch.high, l->depth.low, l->depth.high, l->direction / DEGREE, l->spread / DEGREE);
  }
}

int shade_cmd_presets(int argc, char **argv) {
  const char *name = NULL;
  int as_json = 0;
  shade_preset p;
  for (int i = 1; i < argc; i++) {
    if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
      usage(stdout);
      return TOOL_DONE;
    }
    if (!strcmp(argv[i], "--json")) {
      as_json = 1;
    } else if (argv[i][0] == '-' || name) {
      fprintf(stderr, "shade presets: unexpected '%s' (see shade presets --help)\n", argv[i]);
      return TOOL_BAD_USAGE;
    } else {
      name = argv[i];
    }
  }
  if (name) {
    if (!shade_preset_find(name, &p)) {
      fprintf(stderr, "shade presets: no preset '%s'; shade presets lists them\n", name);
      return TOOL_BAD_USAGE;
    }
    if (as_json) {
      print_json(&p);
      putchar('\n');
    } else {
      show(&p);
    }
    return TOOL_DONE;
  }
  if (as_json)
    putchar('[');
  for (int row = 0; shade_preset_row(row, &p); row++) {
    if (as_json) {
      if (row)
        printf(",\n");
      print_json(&p);
    } else {
      printf("%-20s %s: %s\n", p.word, p.label, p.help);
    }
  }
  if (as_json)
    printf("]\n");
  return TOOL_DONE;
}
