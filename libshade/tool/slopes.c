/* SPDX-License-Identifier: Apache-2.0 */
/* shade slopes: what a normal map is at a footprint, and the lobe that stands for it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "image/read.h"
#include "model/mdf.h"
#include "shade/maps.h"
#include "tool/numbers.h"
#include "tool/parse.h"
#include "tool/points.h"
#include "tool/tool.h"

static void usage(FILE *to) {
  fputs("usage: shade slopes IMAGE [options] < points\n\n"
        "Reads lines 'u v' or 'u v du1 dv1 du2 dv2' (a pixel's two sides; u, v are 0 to 1, v\n"
        "upwards) and writes 'nx ny nz cxx cxy cyy': the mean normal of the normal map over the\n"
        "pixel and the covariance of its slopes. With a lobe also 'x y angle': the exponents or\n"
        "alphas of the widened lobe and its turn from the tangent, in degrees.\n\n"
        "  --normals KIND   colour (0 to 1 for -1 to 1, default), signed (-1 to 1) or slope\n"
        "                   (dH/dx, dH/dy in the first two channels)\n"
        "  --wrap KIND      repeat (default), clamp or mirror\n"
        "  --strength S     0 to 100 (default 1)\n"
        "  --directx        green points down\n"
        "  --mdf WORD       the lobe's distribution (default ashikhmin_shirley)\n"
        "  --ex E --ey E    its exponents, or\n"
        "  --ax A --ay A    its alphas\n"
        "  --defaults N     the version of the defaults, as shade eval has it: the BRDF says how\n"
        "                   much narrower tilted lobes are\n"
        "  --lobes K        that many lobes at most, 1 to 8, instead of one: x, y and angle are\n"
        "                   those of each; 'weight nx ny nz' of every lobe follow (normals in the\n"
        "                   map's own axes, not turned by the angle)\n\n"
        "Exit status: 0 done, 1 bad input, 2 bad usage.\n",
        to);
}

typedef struct options {
  const char *path;
  shade_slope_options slopes;
  shade_params lobe;
  unsigned given;            /* numbers of the lobe, as numbers.h has them */
  int help, has_lobe, lobes; /* lobes 0: not given */
} options;

static int bad(const char *option, const char *value, const char *expected) {
  fprintf(stderr, "shade slopes: %s '%s': expected %s\n", option, value, expected);
  return TOOL_BAD_USAGE;
}

static int fail(const char *message) {
  fprintf(stderr, "shade slopes: %s\n", message);
  return TOOL_BAD_USAGE;
}

/* Place of a word among three, or -1. */
static int find(const char *word, const char *const words[3]) {
  for (int i = 0; i < 3; i++)
    if (!strcmp(word, words[i]))
      return i;
  return -1;
}

/* The row of a number that states a lobe, or -1. */
static int lobe_row(const char *option) {
  const int row = strncmp(option, "--", 2) ? -1 : shade_param_find(option + 2);
  return row >= 0 && tool_numbers_of_any(SHADE_LIST_MDF) >> row & 1 ? row : -1;
}

static int set_number(options *o, int row, const char *option, const char *text) {
  shade_param_info info;
  double x;
  char expected[80];
  shade_param_row(row, &info);
  o->given |= 1u << row;
  o->has_lobe = 1;
  if (tool_parse_number(text, &x) && shade_params_set(&o->lobe, row, &x) == SHADE_OK)
    return TOOL_DONE;
  snprintf(expected, sizeof expected, "a number from %g to %g", info.minimum, info.maximum);
  return bad(option, text, expected);
}

static int read_value(options *o, const char *option, const char *text) {
  static const char *const kinds[3] = {"colour", "signed", "slope"};
  static const char *const wraps[3] = {"repeat", "clamp", "mirror"};
  int place;
  if (lobe_row(option) >= 0)
    return set_number(o, lobe_row(option), option, text);
  if (!strcmp(option, "--strength")) {
    double x;
    if (!tool_parse_number(text, &x) || !(x >= 0 && x <= 100))
      return bad(option, text, "a number from 0 to 100");
    o->slopes.strength = x;
  } else if (!strcmp(option, "--lobes")) {
    if (strlen(text) != 1 || *text < '1' || *text > '0' + SHADE_SLOPE_LOBES)
      return bad(option, text, "a whole number from 1 to 8");
    o->lobes = *text - '0';
    o->has_lobe = 1;
  } else if (!strcmp(option, "--defaults")) {
    int64_t defaults;
    if (!tool_parse_whole(text, 0, SHADE_DEFAULTS, &defaults))
      return bad(option, text, "a version of the defaults, as shade eval --help has them");
    for (int list = 0; list < SHADE_LIST_COUNT; list++)
      if (list != SHADE_LIST_MDF)
        shade_params_set_choice(&o->lobe, (shade_list)list,
                                shade_list_default((shade_list)list, (int)defaults));
  } else if (!strcmp(option, "--normals")) {
    if ((place = find(text, kinds)) < 0)
      return bad(option, text, "colour, signed or slope");
    o->slopes.normals = (shade_normals)place;
  } else if (!strcmp(option, "--wrap")) {
    if ((place = find(text, wraps)) < 0)
      return bad(option, text, "repeat, clamp or mirror");
    o->slopes.wrap = (shade_wrap)place;
  } else {
    if ((place = shade_list_find(SHADE_LIST_MDF, text)) < 0)
      return bad(option, text, "ashikhmin_shirley, ward, ward_half, beckmann or ggx");
    o->lobe.mdf = (shade_mdf)place;
    o->has_lobe = 1;
  }
  return TOOL_DONE;
}

static int check(options *o) {
  if (!o->path)
    return fail("expected a picture (see shade slopes --help)");
  return tool_whole_lobe("slopes", o->given);
}

static int read_options(options *o, int argc, char **argv) {
  static const char *const valued[] = {"--normals", "--wrap",  "--strength",
                                       "--mdf",     "--lobes", "--defaults"};
  for (int i = 1; i < argc; i++) {
    const char *option = argv[i];
    int takes = lobe_row(option) >= 0;
    for (size_t k = 0; k < sizeof valued / sizeof valued[0]; k++)
      takes |= !strcmp(option, valued[k]);
    if (!strcmp(option, "--help") || !strcmp(option, "-h")) {
      o->help = 1;
      return TOOL_DONE;
    }
    if (!strcmp(option, "--directx")) {
      o->slopes.directx = 1;
    } else if (takes && i + 1 == argc) {
      fprintf(stderr, "shade slopes: option '%s' lacks its value\n", option);
      return TOOL_BAD_USAGE;
    } else if (takes) {
      const int status = read_value(o, option, argv[++i]);
      if (status)
        return status;
    } else if (!strncmp(option, "-", 1)) {
      fprintf(stderr, "shade slopes: unknown option '%s' (see shade slopes --help)\n", option);
      return TOOL_BAD_USAGE;
    } else if (o->path) {
      fprintf(stderr, "shade slopes: unexpected argument '%s'\n", option);
      return TOOL_BAD_USAGE;
    } else {
      o->path = option;
    }
  }
  return check(o);
}

typedef struct job {
  const options *o;
  const shade_slope_map *map;
} job;

static void answer(void *context, double u, double v, const double footprint[4]) {
  const job *j = context;
  shade_slopes s;
  shade_slope_lookup(j->map, u, v, footprint, &s);
  printf("%.17g %.17g %.17g %.17g %.17g %.17g", s.normal[0], s.normal[1], s.normal[2],
         s.covariance[0], s.covariance[1], s.covariance[2]);
  if (j->o->has_lobe) {
    shade_params wide;
    double angle;
    shade_slope_lobes lobes;
    const int most = j->o->lobes ? j->o->lobes : 1;
    shade_params_split(&j->o->lobe, s.normal, s.covariance, most, &wide, &angle, &lobes);
    const int exponents = shade_mdf_reads_exponents(wide.mdf);
    printf(" %.17g %.17g %.17g", exponents ? wide.ex : wide.ax, exponents ? wide.ey : wide.ay,
           angle / DEGREE);
    const double cs = cos(angle), sn = sin(angle);
    for (int i = 0; i < lobes.count && j->o->lobes; i++) {
      const double x = lobes.nx[i], y = lobes.ny[i];
      printf(" %.17g %.17g %.17g %.17g", lobes.weight[i], cs * x - sn * y, sn * x + cs * y,
             lobes.nz[i]);
    }
  }
  putchar('\n');
}

int shade_cmd_slopes(int argc, char **argv) {
  options o;
  memset(&o, 0, sizeof o);
  shade_slope_options_init(&o.slopes);
  shade_params_init(&o.lobe);
  int status = read_options(&o, argc, argv);
  if (status)
    return status;
  if (o.help) {
    usage(stdout);
    return TOOL_DONE;
  }
  shade_picture picture;
  char error[1024];
  if (shade_image_read(o.path, 3, &picture, error, sizeof error) != 0) {
    fprintf(stderr, "shade slopes: %s\n", error);
    return TOOL_BAD_INPUT;
  }
  if (picture.channels < 2) {
    fprintf(stderr, "shade slopes: %s: expected 2 channels or more, found 1\n", o.path);
    free(picture.pixels);
    return TOOL_BAD_INPUT;
  }
  unsigned found = 0;
  shade_slope_map *map = shade_slope_map_create(picture.pixels, picture.width, picture.height,
                                                picture.channels, &o.slopes, &found);
  free(picture.pixels);
  if (!map) {
    fprintf(stderr, "shade slopes: %s: out of memory\n", o.path);
    return TOOL_BAD_INPUT;
  }
  if (found & SHADE_BAD_INPUT)
    fprintf(stderr, "shade slopes: %s: texels that are no normal count as flat\n", o.path);
  if (found & SHADE_CLAMPED_NORMAL)
    fprintf(stderr, "shade slopes: %s: normals that point inwards are cut to slope 50\n", o.path);
  job j = {&o, map};
  status = tool_read_points("slopes", answer, &j);
  shade_slope_map_free(map);
  return status;
}
