/* SPDX-License-Identifier: Apache-2.0 */
/* shade weave: drafts, what lies on top at a point, and maps of it. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shade/weave.h"
#include "tool/parse.h"
#include "tool/text.h"
#include "tool/tool.h"
#include "tool/work.h"

typedef enum map { MAP_NORMAL, MAP_ID, MAP_OCCLUSION, MAP_COLOR } map;
static const char *const map_words[] = {"normal", "id", "occlusion", "color"};
enum { MAPS = sizeof map_words / sizeof map_words[0] };

/* --twist of one direction, applied when the widths are known. */
typedef struct twist {
  int given, hand, plied;
  double angle, strands;
} twist;

typedef struct request {
  shade_draft *draft;
  const char *source; /* the option that named the draft, for messages */
  shade_weave_params params;
  twist twist[2]; /* by shade_top */
  int sized[2];   /* width or gap given: the draft's thickness and spacing do not set them */
  int single, print, help;
  const char *wif, *map_path;
  int has_map, width, height, bits, half, threads;
  int width_given, cells[2];
  map map;
} request;

static void usage(FILE *to) {
  const char *word, *help;
  int value;
  fputs("usage: shade weave --pattern N_W,N_P,N_S | --draft FILE.wif | --name NAME [options]\n\n"
        "  --pattern N_W,N_P,N_S   N_W ends under the weft, then N_P over it; each next pick\n"
        "                          shifted by N_S; N_W may be inf: all weft\n"
        "  --draft FILE.wif        a Weaving Information File\n"
        "  --name NAME             ",
        to);
  for (int row = 0; shade_weave_row(row, &word, NULL, NULL); row++)
    fprintf(to, "%s%s", row == 0 ? "" : row % 6 ? ", " : ",\n                          ", word);
  fputs("\n\nWithout an option of those below: reads lines of u v, in crossings (u counts ends,\n"
        "v picks, both repeating), and writes what is seen there:\n"
        "  weft|warp|gap yarn sigma dx dy    the pick's or end's number from 0, the position\n"
        "                          across it, -1 to 1 (a gap: beyond), the tilt along u and v\n"
        "  --print                 the draft: X warp, . weft on top, the first pick at the bottom\n"
        "  --wif OUT.wif           the draft as a Weaving Information File\n"
        "  -o MAP.exr              normal, fibre direction, what is on top, yarn, occlusion, …\n"
        "  -o MAP.png              one of them: --map normal|id|occlusion|color\n"
        "  --size W[xH]            pixels (the longer side 512 by default)\n"
        "  --cells W[xH]           crossings in the map (default: one repeat)\n"
        "  --bits 8|16             of a PNG (8)\n"
        "  --half                  EXR in half\n"
        "  --threads N             (default: one a CPU)\n"
        "  --precision double|float\n\n"
        "Yarns. --NAME sets warp and weft, --warp-NAME or --weft-NAME one of them:\n",
        to);
  shade_param_info info;
  for (int row = 0; shade_yarn_param_row(row, &info); row++)
    fprintf(to, "  --%-21s %s (%g to %g, default %g)\n", info.word, info.help, info.minimum,
            info.maximum, info.initial);
  fputs(
      "  --twist S|Z|none[,DEGREES[,STRANDS[,plied]]]\n"
      "                          slant, segments and fibre from the yarn's twist: the angle of\n"
      "                          its strands to its axis (30), how many lie along a crossing (1)\n"
      "  --occlusion WORD        ",
      to);
  for (int row = 0; shade_occlusion_row(row, &value, &word, NULL, &help); row++)
    fprintf(to, "%s%s", row ? " | " : "", word);
  fputs(" (default tilt)\n"
        "  --seed N                of all variation (0)\n\n"
        "A draft that states thickness and spacing sets width and gap, unless they are given.\n"
        "Names read - and _ alike.\n",
        to);
}

static int bad_value(const char *option, const char *value, const char *expected) {
  fprintf(stderr, "shade weave: %s '%s': expected %s\n", option, value, expected);
  return TOOL_BAD_USAGE;
}

/* ---- options ------------------------------------------------------------------------ */

/* TOOL_DONE and a draft, or a message. */
static int set_draft(request *r, const char *option, const char *value) {
  if (r->draft) {
    fprintf(stderr, "shade weave: %s and %s: expected one of them\n", r->source, option);
    return TOOL_BAD_USAGE;
  }
  r->source = option;
  if (!strcmp(option, "--draft")) {
    char message[4096];
    r->draft = shade_wif_read(value, message, sizeof message);
    if (*message)
      fprintf(stderr, "shade weave: %s%s\n", r->draft ? "warning: " : "", message);
    return r->draft ? TOOL_DONE : TOOL_BAD_INPUT;
  }
  if (!strcmp(option, "--name")) {
    r->draft = shade_draft_named(value);
    return r->draft ? TOOL_DONE : bad_value(option, value, "a weave of shade weave --help");
  }
  int n[3];
  if (!tool_parse_pattern(value, n))
    return bad_value(option, value, "three whole numbers, as in 2,1,1 or inf,1,1");
  if (n[0] < 1)
    return bad_value(option, value, "N_W of at least 1: ends under the weft");
  if (n[1] < 0)
    return bad_value(option, value, "N_P of at least 0: ends over the weft");
  r->draft = shade_draft_from_pattern(n[0], n[1], n[2]);
  if (!r->draft)
    return bad_value(option, value, "N_W + N_P of at most 4096");
  return TOOL_DONE;
}

/* "Z,30,2,plied" */
static int set_twist(twist *t, const char *option, const char *value) {
  static const char form[] = "S, Z or none, then degrees of .6 to 90, strands of 0 to 1000, plied";
  char copy[64], *rest = copy;
  if (strlen(value) >= sizeof copy)
    return bad_value(option, value, form);
  strcpy(copy, value);
  *t = (twist){.given = 1, .angle = 30, .strands = 1};
  for (int i = 0; rest; i++) {
    char *item = rest;
    rest = strchr(item, ',');
    if (rest)
      *rest++ = 0;
    int good = 0;
    if (i == 0) {
      t->hand = strcmp(item, "none") ? toupper((unsigned char)*item) : 0;
      good = !strcmp(item, "none") || ((t->hand == 'S' || t->hand == 'Z') && !item[1]);
    }
    if (i == 1)
      good = tool_parse_number(item, &t->angle) && t->angle >= .6 && t->angle <= 90;
    if (i == 2)
      good = tool_parse_number(item, &t->strands) && t->strands >= 0 && t->strands <= 1000;
    if (i == 3)
      good = t->plied = !strcmp(item, "plied");
    if (!good)
      return bad_value(option, value, form);
  }
  return TOOL_DONE;
}

/* What an option of yarns says behind -- or --warp-, or --weft-; *system is which of them, or -1:
 * both. */
static const char *yarn_word(const char *option, int *system) {
  const char *word = strncmp(option, "--", 2) ? "" : option + 2;
  *system = !strncmp(word, "weft-", 5)   ? SHADE_TOP_WEFT
            : !strncmp(word, "warp-", 5) ? SHADE_TOP_WARP
                                         : -1;
  return *system < 0 ? word : word + 5;
}

/* Whether an option is one that has a value: those of set_option. */
static int takes_value(const char *option) {
  static const char *const valued[] = {
      "--pattern", "--draft", "--name",    "-o",          "--wif",  "--size",     "--cells",
      "--map",     "--bits",  "--threads", "--precision", "--seed", "--occlusion"};
  for (size_t k = 0; k < sizeof valued / sizeof valued[0]; k++)
    if (!strcmp(option, valued[k]))
      return 1;
  int system;
  shade_yarn_params any;
  const char *word = yarn_word(option, &system);
  return !strcmp(word, "twist") || shade_yarn_param(&any, word);
}

/* --width, --warp-width, --weft-twist, …: TOOL_DONE or TOOL_BAD_USAGE. */
static int set_yarn(request *r, const char *option, const char *value) {
  int system;
  const char *word = yarn_word(option, &system);
  const int first = system < 0 ? SHADE_TOP_WEFT : system,
            last = system < 0 ? SHADE_TOP_WARP : system;
  for (int k = first; k <= last; k++) {
    shade_yarn_params *yarn = k == SHADE_TOP_WARP ? &r->params.warp : &r->params.weft;
    if (!strcmp(word, "twist")) {
      int status = set_twist(&r->twist[k], option, value);
      if (status)
        return status;
      continue;
    }
    double *number = shade_yarn_param(yarn, word);
    shade_param_info info;
    for (int row = 0; shade_yarn_param_row(row, &info); row++)
      if (shade_yarn_param(yarn, info.word) == number)
        break;
    if (!tool_parse_number(value, number) || *number < info.minimum || *number > info.maximum) {
      fprintf(stderr, "shade weave: %s '%s': expected a number of %g to %g\n", option, value,
              info.minimum, info.maximum);
      return TOOL_BAD_USAGE;
    }
    r->sized[k] |= number == &yarn->width || number == &yarn->gap;
  }
  return TOOL_DONE;
}

static int set_occlusion(request *r, const char *option, const char *value) {
  const char *word;
  int number;
  for (int row = 0; shade_occlusion_row(row, &number, &word, NULL, NULL); row++)
    if (!strcmp(word, value)) {
      r->params.occlusion = (shade_occlusion)number;
      return TOOL_DONE;
    }
  return bad_value(option, value, "none, tilt or sky");
}

static int set_output(request *r, const char *option, const char *value) {
  if (shade_image_format_of(value) == SHADE_IMAGE_UNKNOWN)
    return bad_value(option, value, "a name that ends in .exr or .png");
  r->map_path = value;
  return TOOL_DONE;
}

/* An option of takes_value. */
static int set_option(request *r, const char *option, const char *value) {
  int64_t number;
  if (!strcmp(option, "--pattern") || !strcmp(option, "--draft") || !strcmp(option, "--name"))
    return set_draft(r, option, value);
  if (!strcmp(option, "-o"))
    return set_output(r, option, value);
  if (!strcmp(option, "--wif")) {
    r->wif = value;
    return TOOL_DONE;
  }
  if (!strcmp(option, "--size")) {
    r->width_given = 1;
    return tool_parse_size(value, SHADE_IMAGE_MAX_SIDE, &r->width, &r->height)
               ? TOOL_DONE
               : bad_value(option, value, "W or WxH, 1 to 65536 pixels a side");
  }
  if (!strcmp(option, "--cells"))
    return tool_parse_size(value, 1000000, &r->cells[0], &r->cells[1])
               ? TOOL_DONE
               : bad_value(option, value, "W or WxH, 1 to 1000000 crossings a side");
  if (!strcmp(option, "--map")) {
    for (int k = 0; k < MAPS; k++)
      if (!strcmp(value, map_words[k])) {
        r->map = (map)k;
        r->has_map = 1;
        return TOOL_DONE;
      }
    return bad_value(option, value, "normal, id, occlusion or color");
  }
  if (!strcmp(option, "--bits")) {
    if (!tool_parse_whole(value, 8, 16, &number) || (number != 8 && number != 16))
      return bad_value(option, value, "8 or 16");
    r->bits = (int)number;
    return TOOL_DONE;
  }
  if (!strcmp(option, "--threads")) {
    if (!tool_parse_whole(value, 1, 256, &number))
      return bad_value(option, value, "1 to 256");
    r->threads = (int)number;
    return TOOL_DONE;
  }
  if (!strcmp(option, "--precision")) {
    r->single = !strcmp(value, "float");
    return r->single || !strcmp(value, "double") ? TOOL_DONE
                                                 : bad_value(option, value, "double or float");
  }
  if (!strcmp(option, "--seed")) {
    if (!tool_parse_whole(value, 0, 4294967295, &number))
      return bad_value(option, value, "a whole number of 0 to 4294967295");
    r->params.seed = (uint32_t)number;
    return TOOL_DONE;
  }
  if (!strcmp(option, "--occlusion"))
    return set_occlusion(r, option, value);
  return set_yarn(r, option, value);
}

static int read_options(request *r, int argc, char **argv) {
  for (int i = 1; i < argc; i++)
    if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
      r->help = 1;
      return TOOL_DONE;
    }
  for (int i = 1; i < argc; i++) {
    const char *option = argv[i];
    if (!strcmp(option, "--print")) {
      r->print = 1;
      continue;
    }
    if (!strcmp(option, "--half")) {
      r->half = 1;
      continue;
    }
    if (*option != '-') {
      fprintf(stderr, "shade weave: unexpected argument '%s' (see shade weave --help)\n", option);
      return TOOL_BAD_USAGE;
    }
    if (!takes_value(option)) {
      fprintf(stderr, "shade weave: unknown option '%s' (see shade weave --help)\n", option);
      return TOOL_BAD_USAGE;
    }
    if (i + 1 == argc) {
      fprintf(stderr, "shade weave: option '%s' lacks its value\n", option);
      return TOOL_BAD_USAGE;
    }
    const int status = set_option(r, option, argv[++i]);
    if (status)
      return status;
  }
  if (!r->draft) {
    fputs("shade weave: expected --pattern, --draft or --name (see shade weave --help)\n", stderr);
    return TOOL_BAD_USAGE;
  }
  const shade_image_format format = shade_image_format_of(r->map_path ? r->map_path : "");
  const char *const wrong =
      r->has_map && format != SHADE_IMAGE_PNG ? "--map chooses what -o writes as .png"
      : r->bits && format != SHADE_IMAGE_PNG  ? "--bits is for PNG; an EXR has --half"
      : r->half && format != SHADE_IMAGE_EXR  ? "--half is for EXR; a PNG has --bits"
                                              : NULL;
  if (wrong) {
    fprintf(stderr, "shade weave: %s\n", wrong);
    return TOOL_BAD_USAGE;
  }
  return TOOL_DONE;
}

/* Widths from the draft where it has them, then the twist, which depends on them. */
static void finish_params(request *r) {
  shade_weave_params p = r->params;
  if (shade_weave_params_from_draft(&p, r->draft) && !r->sized[0] && !r->sized[1]) {
    for (int k = 0; k < 2; k++) {
      const shade_yarn_params *from = k ? &p.warp : &p.weft;
      shade_yarn_params *to = k ? &r->params.warp : &r->params.weft;
      to->width = from->width;
      to->gap = from->gap;
    }
  }
  for (int k = 0; k < 2; k++)
    if (r->twist[k].given)
      shade_weave_params_set_twist(&r->params, (shade_top)k, r->twist[k].hand,
                                   r->twist[k].angle * DEGREE, r->twist[k].strands,
                                   r->twist[k].plied);
}

/* ---- text --------------------------------------------------------------------------- */

static void print_draft(const shade_draft *d) {
  for (int j = d->picks - 1; j >= 0; j--) {
    for (int i = 0; i < d->ends; i++)
      putchar(d->warp_up[(size_t)j * (size_t)d->ends + (size_t)i] ? 'X' : '.');
    putchar('\n');
  }
}

static int write_wif(const shade_draft *d, const char *path) {
  char *text = shade_wif_text(d);
  if (!text) {
    fputs("shade weave: out of memory\n", stderr);
    return TOOL_BAD_INPUT;
  }
  const int status = tool_save_text("weave", path, text, strlen(text));
  free(text);
  return status;
}

static void print_answer(const shade_weave *w, int single, double u, double v) {
  static const char *const words[] = {"weft", "warp", "gap"};
  if (single) {
    shade_crossingf c;
    shade_weave_lookupf(w, (float)u, (float)v, &c);
    printf("%s %d %.9g %.9g %.9g\n", words[c.top], c.yarn, (double)c.sigma, (double)c.dx,
           (double)c.dy);
  } else {
    shade_crossing c;
    shade_weave_lookup(w, u, v, &c);
    printf("%s %d %.17g %.17g %.17g\n", words[c.top], c.yarn, c.sigma, c.dx, c.dy);
  }
}

static int answer_lines(const shade_weave *w, int single) {
  tool_lines in = {.title = "weave", .form = "u v"};
  double at[2];
  while (tool_next_line(&in, 2, 0, at) > 0)
    print_answer(w, single, at[0], at[1]);
  return tool_end_lines(&in);
}

/* ---- maps --------------------------------------------------------------------------- */

static const char *const exr_names[] = {"N.X",    "N.Y",     "N.Z",     "T.X",       "T.Y",
                                        "top.ID", "yarn.ID", "sigma",   "occlusion", "brightness",
                                        "fuzz",   "color.R", "color.G", "color.B"};
enum { EXR_CHANNELS = sizeof exr_names / sizeof exr_names[0] };

typedef struct filling {
  const shade_weave *weave;
  const request *request;
  int exr, channels;
} filling;

static float encode(double x) {
  return (float)(.5 + .5 * x);
}

static void fill(void *context, int first, int count, float *const *out) {
  const filling *f = context;
  const request *r = f->request;
  float *to = out[0];
  for (int row = first; row < first + count; row++)
    for (int column = 0; column < r->width; column++, to += f->channels) {
      shade_crossing c;
      /* row 0 is the top, v runs up; a pixel shows its centre */
      shade_weave_lookup(f->weave, (column + .5) / r->width * r->cells[0],
                         (r->height - row - .5) / r->height * r->cells[1], &c);
      const double z = sqrt(1 - c.dx * c.dx - c.dy * c.dy);
      if (f->exr) {
        const double values[EXR_CHANNELS] = {
            c.dx,        c.dy,         z,      c.tx,       c.ty,       c.top,     c.yarn, c.sigma,
            c.occlusion, c.brightness, c.fuzz, c.color[0], c.color[1], c.color[2]};
        for (int k = 0; k < EXR_CHANNELS; k++)
          to[k] = (float)values[k];
      } else if (r->map == MAP_NORMAL) {
        to[0] = encode(c.dx);
        to[1] = encode(c.dy);
        to[2] = encode(z);
      } else if (r->map == MAP_OCCLUSION)
        to[0] = (float)c.occlusion;
      else if (r->map == MAP_ID)
        to[0] = (float)c.top / 2;
      else
        for (int k = 0; k < 3; k++)
          to[k] = (float)(c.color[k] * c.occlusion * c.brightness);
    }
}

static int write_map(request *r, const shade_weave *w) {
  if (!r->cells[0]) {
    r->cells[0] = r->draft->ends;
    r->cells[1] = r->draft->picks;
  }
  if (!r->width_given) {
    const int longer = r->cells[0] > r->cells[1] ? r->cells[0] : r->cells[1];
    r->width = (int)fmax(1, 512. * r->cells[0] / longer + .5);
    r->height = (int)fmax(1, 512. * r->cells[1] / longer + .5);
  }
  const int exr = shade_image_format_of(r->map_path) == SHADE_IMAGE_EXR;
  filling f = {w, r, exr, exr ? EXR_CHANNELS : r->map == MAP_ID || r->map == MAP_OCCLUSION ? 1 : 3};
  const tool_picture picture = {
      .path = r->map_path,
      .spec = {.width = r->width,
               .height = r->height,
               .channels = f.channels,
               .names = exr ? exr_names : NULL,
               .type = exr             ? r->half ? SHADE_IMAGE_HALF : SHADE_IMAGE_FLOAT
                       : r->bits == 16 ? SHADE_IMAGE_U16
                                       : SHADE_IMAGE_U8,
               .srgb = !exr && r->map == MAP_COLOR,
               .note = exr ? "shade weave: N normal, T fibre direction; top.ID 0 weft, 1 warp, "
                             "2 gap; yarn.ID pick or end from 0; color linear RGB"
                           : "shade weave"}};
  return tool_write_pictures("weave", &picture, 1, r->threads ? r->threads : tool_threads(), fill,
                             &f);
}

int shade_cmd_weave(int argc, char **argv) {
  request r = {0};
  shade_weave_params_init(&r.params);
  int status = read_options(&r, argc, argv);
  shade_weave *w = NULL;
  if (!status && r.help)
    usage(stdout);
  if (!status && !r.help) {
    finish_params(&r);
    w = shade_weave_create(r.draft, &r.params, NULL);
    if (!w) {
      fputs("shade weave: out of memory\n", stderr);
      status = TOOL_BAD_INPUT;
    }
  }
  if (w) {
    if (r.print)
      print_draft(r.draft);
    if (r.wif)
      status = write_wif(r.draft, r.wif);
    if (!status && r.map_path)
      status = write_map(&r, w);
    if (!r.print && !r.wif && !r.map_path)
      status = answer_lines(w, r.single);
  }
  shade_weave_free(w);
  shade_draft_free(r.draft);
  return status;
}
