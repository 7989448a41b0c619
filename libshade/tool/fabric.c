/* SPDX-License-Identifier: Apache-2.0 */
/* shade fabric: what a cloth of the presets reflects, one query a line in, one answer a line out.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shade/presets.h"
#include "tool/text.h"
#include "tool/tool.h"

static const char *const tiers[] = {"auto", "near", "far", "single"};

static void usage(FILE *to) {
  fputs(
      "usage: shade fabric PRESET [options] < queries\n\n"
      "Lines of `u v footprint wix wiy wiz wox woy woz` -> `r g b`: radiance towards wo for unit\n"
      "irradiance from wi, f cos in 1/sr. u (along the weft) and v (along the warp) count\n"
      "crossings; footprint is the pixel's width in crossings; wi to the light, wo to the eye,\n"
      "unit, x along u, y along v, z out of the cloth.\n\n"
      "  --tier auto|near|far|single   near: the point; far: a mixture of lobes for the mean;\n"
      "                                single: one lobe a direction of yarn; auto: by footprint\n"
      "  --precision double|float      (default double)\n"
      "  --no-diffuse                  the highlights alone\n"
      "  --info                        what the far model made of it, and no queries\n\n"
      "Blank lines and lines that begin with # are skipped. Answers are in %.17g (float: %.9g).\n",
      to);
}

typedef struct request {
  shade_preset preset;
  int named, single, info, help;
  shade_fabric_tier tier;
} request;

static int refuse(const char *what, const char *value) {
  fprintf(stderr, "shade fabric: %s '%s' (see shade fabric --help)\n", what, value);
  return TOOL_BAD_USAGE;
}

static void leave_highlights(shade_fabric_params *p) {
  for (int c = 0; c < 3; c++)
    p->warp.kd[c] = p->weft.kd[c] = p->backing[c] = 0;
  p->nap = 0;
}

static int read_options(request *r, int argc, char **argv) {
  int highlights = 0;
  for (int i = 1; i < argc; i++) {
    const char *a = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
    if (!strcmp(a, "--help") || !strcmp(a, "-h")) {
      r->help = 1;
      return TOOL_DONE;
    }
    if (!strcmp(a, "--tier")) {
      int k = 0;
      while (k < 4 && strcmp(value, tiers[k]) != 0)
        k++;
      if (k == 4)
        return refuse("--tier: expected auto, near, far or single, not", value);
      r->tier = (shade_fabric_tier)k;
      i++;
    } else if (!strcmp(a, "--precision")) {
      if (strcmp(value, "float") != 0 && strcmp(value, "double") != 0)
        return refuse("--precision: expected double or float, not", value);
      r->single = value[0] == 'f';
      i++;
    } else if (!strcmp(a, "--no-diffuse")) {
      highlights = 1;
    } else if (!strcmp(a, "--info")) {
      r->info = 1;
    } else if (a[0] == '-') {
      return refuse("unknown option", a);
    } else if (r->named) {
      return refuse("one preset at a time, not also", a);
    } else if (!shade_preset_find(a, &r->preset)) {
      fprintf(stderr, "shade fabric: no cloth '%s'; shade presets lists them\n", a);
      return TOOL_BAD_USAGE;
    } else if (r->preset.kind != SHADE_PRESET_FABRIC) {
      fprintf(stderr,
              "shade fabric: '%s' is a metal, no cloth: shade presets %s says its numbers, and "
              "shade eval evaluates it\n",
              a, a);
      return TOOL_BAD_USAGE;
    } else {
      r->named = 1;
    }
  }
  if (!r->named) {
    usage(stderr);
    return TOOL_BAD_USAGE;
  }
  if (highlights)
    leave_highlights(&r->preset.fabric);
  return TOOL_DONE;
}

static unsigned answer(const request *r, const shade_fabric *f, const double v[9]) {
  const double footprint[2] = {v[2], v[2]};
  double s[3];
  unsigned status;
  if (r->single) {
    float x[9], two[2] = {(float)v[2], (float)v[2]}, sf[3];
    for (int i = 0; i < 9; i++)
      x[i] = (float)v[i];
    status = shade_fabric_evalf(f, x, two, NULL, x + 3, x + 6, r->tier, sf);
    printf("%.9g %.9g %.9g\n", (double)sf[0], (double)sf[1], (double)sf[2]);
  } else {
    status = shade_fabric_eval(f, v, footprint, NULL, v + 3, v + 6, r->tier, s);
    printf("%.17g %.17g %.17g\n", s[0], s[1], s[2]);
  }
  return status;
}

static int answer_lines(const request *r, const shade_fabric *f) {
  tool_lines in = {.title = "fabric", .form = "u v footprint wix wiy wiz wox woy woz"};
  double v[9];
  while (tool_next_line(&in, 9, 0, v) > 0)
    if (v[2] < 0)
      tool_bad_line(&in, "the footprint is below 0");
    else if (answer(r, f, v) & SHADE_BAD_INPUT)
      fprintf(stderr, "shade fabric: standard input, line %ld: warning: no such direction: 0\n",
              in.number);
  return tool_end_lines(&in);
}

static void print_info(const shade_preset *p, const shade_fabric *f) {
  shade_fabric_info i;
  shade_fabric_get_info(f, &i);
  printf("%s: seen and not occluded: warp %.4f, weft %.4f\n", p->word, i.warp_share, i.weft_share);
  printf("mixture: %d lobes of warp, %d of weft\n", i.warp_lobes, i.weft_lobes);
  printf("single lobe, exponents along and across: warp %.4g %.4g, weft %.4g %.4g\n",
         i.warp_single[0], i.warp_single[1], i.weft_single[0], i.weft_single[1]);
}

int shade_cmd_fabric(int argc, char **argv) {
  request r;
  memset(&r, 0, sizeof r);
  int status = read_options(&r, argc, argv);
  if (r.help)
    usage(stdout);
  if (status || r.help)
    return status;
  shade_weave *weave;
  shade_fabric *fabric = shade_preset_fabric(&r.preset, &weave, NULL);
  if (!fabric) {
    fputs("shade fabric: out of memory\n", stderr);
    return TOOL_BAD_INPUT;
  }
  if (r.info)
    print_info(&r.preset, fabric);
  else
    status = answer_lines(&r, fabric);
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  return status;
}
