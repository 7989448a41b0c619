/* SPDX-License-Identifier: Apache-2.0 */
/* build/displaced: the command line. study_truth.py runs it; see the usage below. */
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dump/whole.h"
#include "program.h"

static void usage(FILE *to) {
  fputs(
      "usage: displaced pictures OUT.csv [options]   errors against a displaced surface\n"
      "       displaced lobes OUT.csv [options]      total variation of lobes\n\n"
      "  --mdf WORD --brdf WORD   as for `shade eval` (default ashikhmin_shirley, auto)\n"
      "  --first N --second N     exponents of Ashikhmin-Shirley, alphas of the others: along\n"
      "                           x and y (default 200, 10)\n"
      "  --methods A,B,...        words of details (default all but auto)\n"
      "  --base plate|cylinder|sphere   --bumps waves|scratches|smooth\n"
      "  --slope S                steepest, 0 to 2 (default 0.6)   --seed N  (default 3)\n"
      "  --size N                 pixels along a side, 1 to 1024 (default 128)\n"
      "  --lights N               suns, 1 to 4 (default 1); the first leaves the plate unshadowed\n"
      "  --over N                 samples along a pixel's side, 1 to 8 (default 1)\n"
      "  --picture FILE.pfm       pictures: the truth, then each method, side by side\n"
      "  --tilt DEGREES           lobes: of the normal, 0 to 89 (default 30)\n"
      "  --azimuths N             lobes: of the normal, 1 to 360 (default 45)\n"
      "Exit status: 0 done; 1 it could not be written; 2 bad usage.\n",
      to);
}

void text_line(text *t, const char *format, ...) {
  va_list list, again;
  va_start(list, format);
  va_copy(again, list);
  const int more = vsnprintf(NULL, 0, format, again);
  va_end(again);
  char *grown = more < 0 ? NULL : realloc(t->bytes, t->length + (size_t)more + 1);
  if (grown) {
    t->bytes = grown;
    vsnprintf(t->bytes + t->length, (size_t)more + 1, format, list);
    t->length += (size_t)more;
  } else {
    t->failed = 1;
  }
  va_end(list);
}

static int write_whole(const char *path, const char *bytes, size_t length) {
  char why[256] = "out of memory";
  const int status = bytes ? shade_whole_write(path, bytes, length, why, sizeof why) : -1;
  if (status != 0)
    fprintf(stderr, "displaced: %s: %s\n", path, why);
  return status != 0;
}

int text_write(text *t, const char *path) {
  const int status = write_whole(path, t->failed ? NULL : t->bytes, t->length);
  free(t->bytes);
  *t = (text){0};
  return status;
}

int pfm_write(const char *path, const float *pixels, int width, int height) {
  char head[64];
  const int one = 1, little = *(const char *)&one == 1;
  const int first =
      snprintf(head, sizeof head, "Pf\n%d %d\n%s\n", width, height, little ? "-1.0" : "1.0");
  const size_t start = (size_t)first, body = (size_t)width * (size_t)height * sizeof *pixels;
  char *all = malloc(start + body);
  if (all) {
    memcpy(all, head, start);
    memcpy(all + start, pixels, body);
  }
  const int status = write_whole(path, all, start + body);
  free(all);
  return status;
}

/* ---- the order ------------------------------------------------------------------------------ */

typedef struct order {
  scene scene;
  base base;
  bumps bumps;
  double slope, tilt;
  long seed, azimuths;
  const char *out, *picture;
} order;

static int number(const char *text, double low, double high, double *value) {
  char *end;
  *value = strtod(text, &end);
  return end != text && !*end && *value >= low && *value <= high;
}

static int whole(const char *text, long low, long high, long *value) {
  double v;
  const int good = number(text, (double)low, (double)high, &v) && v == floor(v);
  *value = good ? (long)v : low;
  return good;
}

static int word_of(const char *const *words, int count, const char *text, int *value) {
  for (*value = 0; *value < count; ++*value)
    if (strcmp(words[*value], text) == 0)
      return 1;
  return 0;
}

static int read_methods(scene *sc, const char *text) {
  sc->methods = 0;
  for (text += strspn(text, ","); *text; text += strspn(text, ",")) {
    char word[32] = "";
    const size_t length = strcspn(text, ",");
    memcpy(word, text, length < sizeof word ? length : 0);
    const int value = shade_list_find(SHADE_LIST_DETAIL, word);
    if (value < 0 || sc->methods == SHADE_DETAIL_COUNT)
      return 0;
    sc->method[sc->methods++] = value;
    text += length;
  }
  return sc->methods > 0;
}

static int read_option(order *o, const char *name, char *text) {
  scene *sc = &o->scene;
  long n = 0;
  int value = 0, good = 0;
  if (strcmp(name, "--mdf") == 0) {
    good = (value = shade_list_find(SHADE_LIST_MDF, text)) >= 0;
    sc->params.mdf = good ? (shade_mdf)value : sc->params.mdf;
  } else if (strcmp(name, "--brdf") == 0) {
    good = (value = shade_list_find(SHADE_LIST_BRDF, text)) >= 0;
    sc->params.brdf = good ? (shade_brdf)value : sc->params.brdf;
  } else if (strcmp(name, "--first") == 0 || strcmp(name, "--second") == 0) {
    good = number(text, 0, 1e6, name[2] == 'f' ? &sc->first : &sc->second);
  } else if (strcmp(name, "--methods") == 0) {
    good = read_methods(sc, text);
  } else if (strcmp(name, "--base") == 0) {
    good = word_of(base_words, BASES, text, &value);
    o->base = good ? (base)value : PLATE;
  } else if (strcmp(name, "--bumps") == 0) {
    good = word_of(bumps_words, BUMPS, text, &value);
    o->bumps = good ? (bumps)value : WAVES;
  } else if (strcmp(name, "--slope") == 0) {
    good = number(text, 0, 2, &o->slope);
  } else if (strcmp(name, "--tilt") == 0) {
    good = number(text, 0, 89, &o->tilt);
  } else if (strcmp(name, "--seed") == 0) {
    good = whole(text, 0, 1000000, &o->seed);
  } else if (strcmp(name, "--azimuths") == 0) {
    good = whole(text, 1, 360, &o->azimuths);
  } else if (strcmp(name, "--size") == 0) {
    good = whole(text, 1, 1024, &n);
    sc->size = (int)n;
  } else if (strcmp(name, "--lights") == 0) {
    good = whole(text, 1, MOST_LIGHTS, &n);
    sc->lights = (int)n;
  } else if (strcmp(name, "--over") == 0) {
    good = whole(text, 1, 8, &n);
    sc->over = (int)n;
  } else if (strcmp(name, "--picture") == 0) {
    o->picture = text;
    good = 1;
  }
  return good;
}

/* The materials that the order asks for; 0 if its numbers are no lobe. */
static int make_ready(order *o) {
  scene *sc = &o->scene;
  shade_params *p = &sc->params;
  p->fresnel = SHADE_FRESNEL_NONE;
  p->horizon = SHADE_HORIZON_HARD; /* the plain formula, by which the detail methods are compared */
  const int exponents = p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY;
  if ((exponents ? shade_params_set_exponents : shade_params_set_alphas)(p, sc->first, sc->second))
    return 0;
  sc->along_y = exponents ? sc->first < sc->second : sc->first > sc->second;
  for (int row = 0, value; sc->methods == 0 && row < SHADE_DETAIL_COUNT; row++)
    for (value = 0; value < SHADE_DETAIL_COUNT; value++)
      if (value != SHADE_DETAIL_AUTO)
        sc->method[sc->methods++] = value;
  for (int m = 0; m < sc->methods; m++) {
    p->detail = (shade_detail)sc->method[m];
    shade_bsdf_setup(&sc->bsdf[m], p);
  }
  p->detail = SHADE_DETAIL_NONE;
  shade_bsdf_setup(&sc->plain, p);
  surface_make(&sc->surface, o->base, o->bumps, o->slope, (unsigned)o->seed);
  return 1;
}

int main(int argc, char **argv) {
  static order o = {
      .base = PLATE, .bumps = WAVES, .slope = 0.6, .tilt = 30, .seed = 3, .azimuths = 45};
  o.scene.size = 128;
  o.scene.over = 1;
  o.scene.lights = 1;
  o.scene.first = 200;
  o.scene.second = 10;
  shade_params_init(&o.scene.params);
  for (int i = 1; i < argc; i++)
    if (strcmp(argv[i], "--help") == 0) {
      usage(stdout);
      return 0;
    }
  if (argc < 3 || argv[2][0] == '-') {
    usage(stderr);
    return 2;
  }
  o.out = argv[2];
  for (int i = 3; i < argc; i += 2)
    if (i + 1 == argc || !read_option(&o, argv[i], argv[i + 1])) {
      fprintf(stderr, "displaced: bad %s%s%s (see displaced --help)\n", argv[i],
              i + 1 < argc ? " " : ": its value is missing", i + 1 < argc ? argv[i + 1] : "");
      return 2;
    }
  if (!make_ready(&o)) {
    fputs("displaced: --first and --second are out of range (see displaced --help)\n", stderr);
    return 2;
  }
  if (strcmp(argv[1], "pictures") == 0)
    return displaced_pictures(&o.scene, o.out, o.picture);
  if (strcmp(argv[1], "lobes") == 0)
    return displaced_lobes(&o.scene, o.tilt, (int)o.azimuths, o.out);
  fprintf(stderr, "displaced: unknown '%s' (see displaced --help)\n", argv[1]);
  return 2;
}
