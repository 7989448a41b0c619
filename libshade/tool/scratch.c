/* SPDX-License-Identifier: Apache-2.0 */
/* shade scratch: pictures of a field of scratches, or its values at points. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shade/maps.h"
#include "tool/points.h"
#include "tool/tool.h"
#include "tool/work.h"

enum { MOST_SAMPLES = 64, MOST_THREADS = 256 };

static void usage(FILE *to) {
  fputs("usage: shade scratch -o NORMAL.exr|png [--height H.exr] [options]\n"
        "       shade scratch --eval [options] < points\n\n"
        "Makes a seamless map of scratches: pits that are spherical caps, stretched. Lengths are\n"
        "in widths of the picture. A or A,B: one value, or one drawn between two for each pit.\n\n"
        "  -o FILE            normal map, 0 to 1 for -1 to 1, green up (OpenGL), without gamma\n"
        "  --height FILE.exr  heights, in widths of the picture, 0 at the plate\n"
        "  --size W[xH]       texels (default 1024); H is W if not given\n"
        "  --pits N           how many (default 5000)\n"
        "  --radius A[,B]     half width across the scratch (default 0.0005,0.002)\n"
        "  --stretch A[,B]    half length over half width; 1 is round (default 20,60)\n"
        "  --depth A[,B]      depth over half width, 0 to 0.99 (default 0.05,0.25)\n"
        "  --direction DEG    of the scratches, from right towards up (default 0)\n"
        "  --spread DEG       to either side of it; 90 is any direction (default 10)\n"
        "  --layer            begin another layer; what follows is said of it (8 at most)\n"
        "  --seed N           other scratches of the same kind (default 1)\n"
        "  --samples N        average N x N points a texel, 1 to 64 (default 1, its centre)\n"
        "  --bits 8|16        of a PNG (default 16)\n"
        "  --half, --float    values of an EXR (default float)\n"
        "  --directx          green down\n"
        "  --threads N        (default: all CPUs); the files do not depend on it\n"
        "  --eval             read lines 'u v' or 'u v du1 dv1 du2 dv2' (a pixel's two sides),\n"
        "                     write 'height nx ny nz cxx cxy cyy', the last three being the\n"
        "                     covariance of the slopes. u, v are 0 to 1, v upwards\n\n"
        "Exit status: 0 done, 1 bad input, 2 bad usage.\n",
        to);
}

typedef struct options {
  const char *normal, *height;
  int width, rows, samples, bits, half, wide, directx, threads, eval, help;
  shade_scratch_params params;
} options;

/* ---- reading options ---------------------------------------------------------------- */

static int bad(const char *option, const char *value, const char *format, ...) {
  va_list arguments;
  fprintf(stderr, "shade scratch: %s '%s': expected ", option, value);
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
  fputs("\n", stderr);
  return TOOL_BAD_USAGE;
}

static int read_whole(const char *text, unsigned long long most, unsigned long long *value) {
  char *end;
  errno = 0;
  *value = strtoull(text, &end, 10);
  return isdigit((unsigned char)text[0]) && !*end && !errno && *value <= most;
}

static int whole(const char *option, const char *text, int low, int high, int *value) {
  unsigned long long read;
  if (!read_whole(text, (unsigned long long)high, &read) || (int)read < low)
    return bad(option, text, "a whole number from %d to %d", low, high);
  *value = (int)read;
  return TOOL_DONE;
}

static int number(const char *option, const char *text, double low, double high, double scale,
                  double *value) {
  char *end;
  const double read = strtod(text, &end);
  if (end == text || *end || !(read >= low && read <= high))
    return bad(option, text, "a number from %g to %g", low, high);
  *value = scale * read;
  return TOOL_DONE;
}

static int range(const char *option, const char *text, double low, double high,
                 shade_range *value) {
  char *end;
  shade_range read;
  read.low = read.high = strtod(text, &end);
  int fits = end != text;
  if (fits && *end == ',') {
    const char *second = end + 1;
    read.high = strtod(second, &end);
    fits = end != second;
  }
  if (!fits || *end || !(read.low >= low && read.low <= read.high && read.high <= high))
    return bad(option, text, "A or A,B with %g <= A <= B <= %g", low, high);
  *value = read;
  return TOOL_DONE;
}

static int size(const char *option, const char *text, options *o) {
  char copy[64];
  unsigned long long w = 0, h = 0;
  const char *cross = strchr(text, 'x');
  int fits = strlen(text) < sizeof copy;
  if (fits) {
    strcpy(copy, text);
    if (cross)
      copy[cross - text] = 0;
    fits = read_whole(copy, SHADE_IMAGE_MAX_SIDE, &w);
    h = w;
    if (cross)
      fits = fits && read_whole(cross + 1, SHADE_IMAGE_MAX_SIDE, &h);
  }
  if (!fits || w < 1 || h < 1 || w > 1000 * h || h > 1000 * w)
    return bad(option, text, "W or WxH, 1 to %d texels a side, up to 1000 times longer than wide",
               SHADE_IMAGE_MAX_SIDE);
  o->width = (int)w;
  o->rows = (int)h;
  return TOOL_DONE;
}

/* An option without a value. 1 if it is one; 2 if that is too much. */
static int read_flag(options *o, const char *option) {
  shade_scratch_params *p = &o->params;
  if (!strcmp(option, "--half"))
    o->half = 1;
  else if (!strcmp(option, "--float"))
    o->wide = 1;
  else if (!strcmp(option, "--directx"))
    o->directx = 1;
  else if (!strcmp(option, "--eval"))
    o->eval = 1;
  else if (!strcmp(option, "--layer") && p->layers == SHADE_SCRATCH_LAYERS)
    return 2;
  else if (!strcmp(option, "--layer"))
    p->layers++;
  else
    return 0;
  return 1;
}

static int read_value(options *o, const char *option, const char *text) {
  shade_scratch_params *p = &o->params;
  shade_scratch_layer *l = &p->layer[p->layers - 1];
  if (!strcmp(option, "-o"))
    o->normal = text;
  else if (!strcmp(option, "--height"))
    o->height = text;
  else if (!strcmp(option, "--size"))
    return size(option, text, o);
  else if (!strcmp(option, "--radius"))
    return range(option, text, 1e-6, 0.5, &l->radius);
  else if (!strcmp(option, "--stretch"))
    return range(option, text, 1, 1e5, &l->stretch);
  else if (!strcmp(option, "--depth"))
    return range(option, text, 0, 0.99, &l->depth);
  else if (!strcmp(option, "--direction"))
    return number(option, text, -360, 360, DEGREE, &l->direction);
  else if (!strcmp(option, "--spread"))
    return number(option, text, 0, 90, DEGREE, &l->spread);
  else if (!strcmp(option, "--samples"))
    return whole(option, text, 1, MOST_SAMPLES, &o->samples);
  else if (!strcmp(option, "--threads"))
    return whole(option, text, 1, MOST_THREADS, &o->threads);
  else if (!strcmp(option, "--pits")) {
    int pits = 0;
    if (whole(option, text, 0, SHADE_SCRATCH_MAX_PITS, &pits) != TOOL_DONE)
      return TOOL_BAD_USAGE;
    l->pits = (uint32_t)pits;
  } else if (!strcmp(option, "--seed")) {
    unsigned long long seed;
    if (!read_whole(text, UINT64_MAX, &seed))
      return bad(option, text, "a whole number from 0 to 2^64 - 1");
    p->seed = seed;
  } else if (!strcmp(option, "--bits")) {
    if (strcmp(text, "8") && strcmp(text, "16"))
      return bad(option, text, "8 or 16");
    o->bits = text[0] == '8' ? 8 : 16;
  }
  return TOOL_DONE;
}

static int takes_value(const char *option) {
  static const char *const names[] = {
      "-o",       "--height",  "--size",    "--radius", "--stretch", "--depth", "--direction",
      "--spread", "--samples", "--threads", "--pits",   "--seed",    "--bits"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
    if (!strcmp(option, names[i]))
      return 1;
  return 0;
}

static int fail(const char *message) {
  fprintf(stderr, "shade scratch: %s\n", message);
  return TOOL_BAD_USAGE;
}

static int check(const options *o) {
  if (o->eval)
    return o->normal || o->height ? fail("--eval and files do not go together") : TOOL_DONE;
  if (!o->normal && !o->height)
    return fail("nothing to write: give -o, --height or --eval (see shade scratch --help)");
  const shade_image_format format = o->normal ? shade_image_format_of(o->normal) : SHADE_IMAGE_EXR;
  if (format == SHADE_IMAGE_UNKNOWN)
    return bad("-o", o->normal, "a name that ends in .exr or .png");
  if (o->height && shade_image_format_of(o->height) != SHADE_IMAGE_EXR)
    return bad("--height", o->height, "a name that ends in .exr");
  if (o->normal && o->height && !strcmp(o->normal, o->height))
    return fail("-o and --height name the same file");
  if (o->half && o->wide)
    return fail("--half and --float do not go together");
  if (o->bits && (!o->normal || format != SHADE_IMAGE_PNG))
    return fail("--bits is for PNG; an EXR has --half or --float");
  if ((o->half || o->wide) && format != SHADE_IMAGE_EXR)
    return fail("--half and --float are for EXR; a PNG has --bits");
  uint64_t pits = 0;
  for (int i = 0; i < o->params.layers; i++)
    pits += o->params.layer[i].pits;
  if (pits > SHADE_SCRATCH_MAX_PITS)
    return fail("more than 4000000 pits in all layers");
  return TOOL_DONE;
}

static int read_options(options *o, int argc, char **argv) {
  for (int i = 1; i < argc; i++) {
    const char *option = argv[i];
    if (!strcmp(option, "--help") || !strcmp(option, "-h")) {
      o->help = 1;
      return TOOL_DONE;
    }
    const int flag = read_flag(o, option);
    if (flag == 2)
      return fail("more than 8 layers");
    if (flag)
      continue;
    if (!takes_value(option)) {
      fprintf(stderr, "shade scratch: %s '%s' (see shade scratch --help)\n",
              option[0] == '-' ? "unknown option" : "unexpected argument", option);
      return TOOL_BAD_USAGE;
    }
    if (i + 1 == argc) {
      fprintf(stderr, "shade scratch: option '%s' lacks its value\n", option);
      return TOOL_BAD_USAGE;
    }
    const int status = read_value(o, option, argv[++i]);
    if (status)
      return status;
  }
  return check(o);
}

/* ---- points --------------------------------------------------------------------------- */

static void eval_point(void *context, double u, double v, const double footprint[4]) {
  double height;
  shade_slopes s;
  shade_scratch_eval(context, u, v, footprint, &height, &s);
  printf("%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", height, s.normal[0], s.normal[1],
         s.normal[2], s.covariance[0], s.covariance[1], s.covariance[2]);
}

/* ---- pictures --------------------------------------------------------------------------- */

typedef struct job {
  const options *o;
  const shade_scratch_field *field;
} job;

static void fill(void *context, int first, int count, float *const *out) {
  const job *j = context;
  const options *o = j->o;
  float *normal = o->normal ? out[0] : NULL;
  float *height = o->height ? out[o->normal ? 1 : 0] : NULL;
  shade_scratch_rows(j->field, o->width, o->rows, first, count, o->samples, height, normal);
  const float green = o->directx ? -0.5F : 0.5F;
  for (size_t i = 0; normal && i < (size_t)count * (size_t)o->width; i++) {
    normal[3 * i] = 0.5F + 0.5F * normal[3 * i];
    normal[3 * i + 1] = 0.5F + green * normal[3 * i + 1];
    normal[3 * i + 2] = 0.5F + 0.5F * normal[3 * i + 2];
  }
}

/* The command that makes the same picture, for the file's comment. */
static void describe(const options *o, char *text, size_t size) {
  const shade_scratch_params *p = &o->params;
  int length = snprintf(text, size, "shade scratch --size %dx%d --seed %llu --samples %d", o->width,
                        o->rows, (unsigned long long)p->seed, o->samples);
  for (int i = 0; i < p->layers; i++) {
    const shade_scratch_layer *l = &p->layer[i];
    length += snprintf(text + length, size - (size_t)length,
                       "%s --pits %u --radius %.9g,%.9g --stretch %.9g,%.9g --depth %.9g,%.9g "
                       "--direction %.9g --spread %.9g",
                       i ? " --layer" : "", l->pits, l->radius.low, l->radius.high, l->stretch.low,
                       l->stretch.high, l->depth.low, l->depth.high, l->direction / DEGREE,
                       l->spread / DEGREE);
  }
  if (o->directx)
    snprintf(text + length, size - (size_t)length, " --directx");
}

static int write_pictures(const options *o, const shade_scratch_field *field) {
  char note[4096];
  describe(o, note, sizeof note);
  tool_picture pictures[2];
  int count = 0;
  if (o->normal) {
    const int png = shade_image_format_of(o->normal) == SHADE_IMAGE_PNG;
    const shade_image_type type = png       ? o->bits == 8 ? SHADE_IMAGE_U8 : SHADE_IMAGE_U16
                                  : o->half ? SHADE_IMAGE_HALF
                                            : SHADE_IMAGE_FLOAT;
    pictures[count++] = (tool_picture){
        o->normal,
        {.width = o->width, .height = o->rows, .channels = 3, .type = type, .note = note}};
  }
  if (o->height)
    pictures[count++] = (tool_picture){o->height,
                                       {.width = o->width,
                                        .height = o->rows,
                                        .channels = 1,
                                        .type = SHADE_IMAGE_FLOAT,
                                        .note = note}};
  job j = {o, field};
  return tool_write_pictures("scratch", pictures, count, o->threads, fill, &j);
}

int shade_cmd_scratch(int argc, char **argv) {
  options o;
  memset(&o, 0, sizeof o);
  o.width = o.rows = 1024;
  o.samples = 1;
  o.threads = tool_threads();
  shade_scratch_params_init(&o.params);
  const int status = read_options(&o, argc, argv);
  if (status)
    return status;
  if (o.help) {
    usage(stdout);
    return TOOL_DONE;
  }
  const char *const names[] = {o.normal, o.height};
  for (int i = 0; i < 2; i++) {
    const char *missing = names[i] ? shade_image_missing(shade_image_format_of(names[i])) : NULL;
    if (missing) {
      fprintf(stderr, "shade scratch: %s: %s\n", names[i], missing);
      return TOOL_BAD_INPUT;
    }
  }
  o.params.aspect = (double)o.rows / o.width;
  o.params.cells = o.eval ? o.params.cells : 0;
  shade_scratch_field *field = shade_scratch_create(&o.params, NULL);
  if (!field) {
    fputs("shade scratch: out of memory\n", stderr);
    return TOOL_BAD_INPUT;
  }
  const int done =
      o.eval ? tool_read_points("scratch", eval_point, field) : write_pictures(&o, field);
  shade_scratch_free(field);
  return done;
}
