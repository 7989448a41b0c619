/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shade check: recompute a dump with the reference.
 *
 * A check that cannot fail is none. So a dump fails not only where S differs, but
 * also where nothing could be compared, where a value is no number or a direction
 * not unit, where a pixel names a material that the header lacks, and where a miss
 * carries light.
 */
#include "tool/tool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void usage(FILE *to) {
  fputs("usage: shade check DUMP.exr [options]\n\n"
        "Recomputes what a renderer wrote with LIBSHADE_DUMP=DUMP.exr and compares every\n"
        "value S above 1e-4 of the largest of its material and light, in either, unless both\n"
        "are below 1.2e-38, where float32 runs out of digits.\n"
        "An error is |S - reference| over the larger of the two. A dump holds float32\n"
        "directions. What their rounding alone may do to a value, at large exponents or at\n"
        "grazing angles, is computed from the reference and taken off errors over the limit.\n"
        "Cloth far away is compared with the mean of the near model over its footprint, and\n"
        "single lobes with those of the reference, each apart: a value by 15 and 5 % of itself\n"
        "or a tenth of the largest, the sum of eight hits or more by 2 and 4 %. Where there is\n"
        "much of it the mean is of 256 points; what is over the limit then, of 4096.\n\n"
        "  --tolerance E        largest error to pass, beyond that (default 1e-4)\n"
        "  --mean-tolerance E   largest mean error of a material under a light to pass,\n"
        "                       beyond that (default 1e-5)\n"
        "  --all                fail also when a material of the header or a light has\n"
        "                       nothing to compare\n"
        "  --json               the result as JSON\n"
        "  --threads N          (default: one a CPU); the result is the same\n\n"
        "Exit status: 0 within tolerance; 1 over it, or a bad dump; 2 bad usage.\n",
        to);
}

#ifndef HAVE_OPENEXR

int shade_cmd_check(int argc, char **argv) {
  if (argc == 2 && strcmp(argv[1], "--help") == 0) {
    usage(stdout);
    return TOOL_DONE;
  }
  fputs("shade check: this `shade` was built without OpenEXR; install Debian's package "
        "libopenexr-dev and run make again\n",
        stderr);
  return TOOL_BAD_INPUT;
}

#else

#include "tool/check.h"

static const char out_of_memory[] = "shade check: out of memory\n";

static int check_dump(const check_options *o, const shade_dump *d, const json *header) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  const json *renderer = json_member(header, "renderer");
  check c = {.options = o, .dump = d, .pixels = pixels};
  c.renderer = renderer && renderer->type == JSON_STRING ? renderer->string : "unknown";
  c.materials = check_read_materials(o->path, header, &c.material_count);
  if (!c.materials)
    return TOOL_BAD_INPUT;
  c.cells = calloc((size_t)c.material_count * (size_t)d->lights + 1, sizeof *c.cells);
  c.index = malloc(pixels * sizeof *c.index);
  c.reference = malloc(3 * pixels * sizeof *c.reference);
  c.doubt = malloc(3 * pixels * sizeof *c.doubt);
  c.rounding = malloc(3 * pixels * sizeof *c.rounding);
  int status = TOOL_BAD_INPUT;
  if (c.cells && c.index && c.reference && c.doubt && c.rounding) {
    tool_progress_begin(&c.progress, "check", d->lights);
    check_find_hits(&c);
    int light = 0;
    while (light < d->lights && check_compare_light(&c, light) == 0)
      light++;
    tool_progress_end(&c.progress);
    if (light == d->lights)
      status = check_report(&c) ? TOOL_DONE : TOOL_BAD_INPUT;
    else
      fputs(out_of_memory, stderr);
  } else {
    fputs(out_of_memory, stderr);
  }
  free(c.cells);
  free(c.index);
  free(c.reference);
  free(c.doubt);
  free(c.rounding);
  check_free_materials(c.materials, c.material_count);
  return status;
}

static int check_file(const check_options *o) {
  char error[512];
  shade_dump *d = shade_dump_read(shade_exr_api_linked(), o->path, error, sizeof error);
  if (!d) {
    fprintf(stderr, "shade check: %s\n", error);
    return TOOL_BAD_INPUT;
  }
  int status = TOOL_BAD_INPUT;
  json *header = json_read(d->json, error, sizeof error);
  if (header)
    status = check_dump(o, d, header);
  else
    fprintf(stderr, "shade check: %s: header attribute \"libshade\": %s\n", o->path, error);
  json_free(header);
  shade_dump_free(d);
  return status;
}

static int read_threads(const char *text, int *threads) {
  char *end;
  const long n = text ? strtol(text, &end, 10) : 0;
  *threads = n < TOOL_MAX_THREADS ? (int)n : TOOL_MAX_THREADS;
  return text && end != text && *end == 0 && n >= 1;
}

static int read_tolerance(const char *text, double *tolerance) {
  char *end;
  *tolerance = text ? strtod(text, &end) : NAN;
  return text && end != text && *end == 0 && isfinite(*tolerance) && *tolerance >= 0;
}

/* text is NULL where there is none. */
static int refuse_value(const char *option, const char *text, const char *wanted) {
  if (text)
    fprintf(stderr, "shade check: %s '%s': expected %s\n", option, text, wanted);
  else
    fprintf(stderr, "shade check: option '%s' lacks its value: %s\n", option, wanted);
  return TOOL_BAD_USAGE;
}

int shade_cmd_check(int argc, char **argv) {
  check_options o = {.tolerance = 1e-4, .mean_tolerance = 1e-5, .threads = tool_threads()};
  for (int i = 1; i < argc; i++) {
    const char *word = argv[i];
    double *number = strcmp(word, "--tolerance") == 0        ? &o.tolerance
                     : strcmp(word, "--mean-tolerance") == 0 ? &o.mean_tolerance
                                                             : NULL;
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
      usage(stdout);
      return TOOL_DONE;
    }
    if (number) {
      if (!read_tolerance(argv[++i], number))
        return refuse_value(word, argv[i], "a number of at least 0");
    } else if (strcmp(word, "--threads") == 0) {
      if (!read_threads(argv[++i], &o.threads))
        return refuse_value(word, argv[i], "a whole number of at least 1");
    } else if (strcmp(word, "--json") == 0) {
      o.json = 1;
    } else if (strcmp(word, "--all") == 0) {
      o.all = 1;
    } else if (word[0] == '-' || o.path) {
      fprintf(stderr, "shade check: unexpected '%s' (see shade check --help)\n", word);
      return TOOL_BAD_USAGE;
    } else {
      o.path = word;
    }
  }
  if (o.path)
    return check_file(&o);
  fputs("shade check: which dump? (see shade check --help)\n", stderr);
  return TOOL_BAD_USAGE;
}

#endif
