/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shade swatch: pictures of the presets, by the library alone. A swatch lies flat or hangs in
 * folds round a cylinder; each is seen near, where single yarns are clear, and far.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shade/presets.h"
#include "tool/parse.h"
#include "tool/tool.h"
#include "tool/work.h"

#define PI 3.14159265358979323846

enum {
  MARGIN = 8,
  COLUMNS = 4, /* positions of the light */
  ROWS = 4,    /* flat near, flat far, cylinder near, cylinder far */
  KEY = 13,    /* samples of the key light, a disc */
  SKY = 12,    /* and of the sky */
  LIGHTS = KEY + SKY
};

/* How many crossings, or cm of metal, a tile is wide. */
#define NEAR_CROSSINGS 28.0
#define FAR_CM 16.0
#define CYLINDER 0.88 /* its radius, half a tile being 1 */

/* What a white Lambert sheet that faces it shows of each: the key's 1 is white. */
#define KEY_LIGHT 1.0
#define SKY_LIGHT 0.22

typedef struct light {
  double to[3], power;
} light;

typedef struct tile {
  int cylinder, far, preset;
  double azimuth; /* of the light, radians */
} tile;

typedef struct material {
  shade_preset preset;
  shade_weave *weave;
  shade_fabric *fabric;
  shade_bsdf metal;
} material;

typedef struct sheet {
  int size, across, down; /* pixels of a tile, tiles */
  material *materials;
  tile *tiles;
} sheet;

static void unit(double v[3]) {
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int c = 0; c < 3; c++)
    v[c] /= length;
}

/* Key light: a disc of 9 degrees on an arc from left to right, 35 degrees up. Sky: evenly over
 * the hemisphere about the eye's side, brighter above. */
static void place_lights(double azimuth, light lights[LIGHTS]) {
  const double golden = PI * (3 - sqrt(5.0));
  double to[3] = {sin(azimuth), 0.62, cos(azimuth)};
  unit(to);
  double side[3] = {to[2], 0, -to[0]}, up[3];
  unit(side);
  up[0] = to[1] * side[2] - to[2] * side[1];
  up[1] = to[2] * side[0] - to[0] * side[2];
  up[2] = to[0] * side[1] - to[1] * side[0];
  for (int i = 0; i < KEY; i++) {
    double r = 0.16 * sqrt((i + 0.5) / KEY), x = r * cos(i * golden), y = r * sin(i * golden);
    for (int c = 0; c < 3; c++)
      lights[i].to[c] = to[c] + x * side[c] + y * up[c];
    unit(lights[i].to);
    lights[i].power = PI * KEY_LIGHT / KEY;
  }
  double total = 0;
  for (int i = 0; i < SKY; i++) {
    light *l = &lights[KEY + i];
    double z = (i + 0.5) / SKY, r = sqrt(1 - z * z);
    l->to[0] = r * cos(i * golden);
    l->to[1] = r * sin(i * golden);
    l->to[2] = z;
    l->power = 1 + 0.6 * l->to[1];
    total += l->power * z;
  }
  for (int i = 0; i < SKY; i++)
    lights[KEY + i].power *= PI * SKY_LIGHT / total;
}

/* A point of the swatch: frame, place in half tiles along the cloth, and how much that is
 * stretched against the picture. */
typedef struct spot {
  double x[3], y[3], z[3], at[2], stretch;
  double n[3]; /* of the folds, in that frame */
} spot;

/* 0 beside the swatch. x and y run from -1 to 1 over the tile. */
static int find_spot(const tile *t, double x, double y, spot *s) {
  const spot flat = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {x, y}, 1, {0, 0, 1}};
  *s = flat;
  if (!t->cylinder)
    return fabs(x) < 0.98 && fabs(y) < 0.98;
  double sine = x / CYLINDER;
  if (fabs(sine) >= 1 || fabs(y) > 0.98)
    return 0;
  double cosine = sqrt(1 - sine * sine), angle = asin(sine);
  s->x[0] = s->z[2] = cosine;
  s->x[2] = -sine;
  s->z[0] = sine;
  s->at[0] = CYLINDER * angle;
  s->stretch = 1 / fmax(cosine, 0.02);
  /* folds that open downwards */
  double slope = 0.30 * fmin(fmax(0.6 - y, 0), 1.6) * sin(7 * angle + 0.8) * cosine;
  s->n[0] = -slope;
  unit(s->n);
  return 1;
}

static void local(const spot *s, const double v[3], double out[3]) {
  out[0] = v[0] * s->x[0] + v[1] * s->x[1] + v[2] * s->x[2];
  out[1] = v[0] * s->y[0] + v[1] * s->y[1] + v[2] * s->y[2];
  out[2] = v[0] * s->z[0] + v[1] * s->z[1] + v[2] * s->z[2];
}

/* Half a tile in crossings along u and v. */
static void tile_scale(const tile *t, const shade_preset *p, double scale[2]) {
  const double cm = t->far ? FAR_CM / 2 : NEAR_CROSSINGS / 2 / p->ends_per_cm;
  scale[0] = cm * p->ends_per_cm;
  scale[1] = cm * p->picks_per_cm;
}

static void shade_pixel(const sheet *sh, const tile *t, const light *lights, double x, double y,
                        float rgb[3]) {
  const material *m = &sh->materials[t->preset];
  spot s;
  double sum[3] = {0.02, 0.02, 0.022};
  if (find_spot(t, x, y, &s)) {
    double eye[3] = {t->cylinder ? 0 : -x, -y, 5}, wo[3], scale[2];
    unit(eye);
    local(&s, eye, wo);
    tile_scale(t, &m->preset, scale);
    const double pixel = 2.0 / sh->size;
    const double uv[2] = {s.at[0] * scale[0] + 4096, s.at[1] * scale[1] + 4096};
    const double footprint[2] = {pixel * scale[0] * s.stretch, pixel * scale[1]};
    memset(sum, 0, sizeof sum);
    for (int i = 0; i < LIGHTS; i++) {
      double wi[3], f[3];
      local(&s, lights[i].to, wi);
      shade_fabric_eval(m->fabric, uv, footprint, s.n, wi, wo, SHADE_TIER_AUTO, f);
      for (int c = 0; c < 3; c++)
        sum[c] += f[c] * lights[i].power;
    }
  }
  for (int c = 0; c < 3; c++)
    rgb[c] = (float)sum[c];
}

static void fill_rows(void *context, int first, int count, float *const *out) {
  const sheet *sh = context;
  const int pitch = sh->size + MARGIN, width = sh->across * pitch + MARGIN;
  for (int row = first; row < first + count; row++)
    for (int tx = 0; tx <= sh->across; tx++) {
      const int ty = (row - MARGIN + pitch) / pitch - 1, py = row - MARGIN - ty * pitch;
      const int inside = tx < sh->across && ty >= 0 && ty < sh->down && py < sh->size;
      const tile *t = &sh->tiles[inside ? ty * sh->across + tx : 0];
      light lights[LIGHTS];
      if (inside)
        place_lights(t->azimuth, lights);
      for (int px = -MARGIN; px < (tx < sh->across ? sh->size : 0); px++) {
        float *rgb = out[0] + 3 * ((size_t)(row - first) * (size_t)width +
                                   (size_t)(MARGIN + tx * pitch + px));
        rgb[0] = rgb[1] = rgb[2] = 0.02f;
        if (inside && px >= 0 && t->preset >= 0)
          shade_pixel(sh, t, lights, 2 * (px + 0.5) / sh->size - 1, 1 - 2 * (py + 0.5) / sh->size,
                      rgb);
      }
    }
}

static void usage(FILE *to) {
  fputs("usage: shade swatch PRESET -o sheet.png|sheet.exr [options]\n"
        "       shade swatch --all -o sheet.png|sheet.exr [options]\n\n"
        "A sheet of one preset: flat near, flat far, hung in folds near, the same far; from left\n"
        "to right the light moves from the left to the right of the eye. --all: every preset,\n"
        "flat near and hung far, in the order of `shade presets`.\n\n"
        "  -o FILE          PNG (8 bits, sRGB) or EXR (half float, linear)\n"
        "  --size N         pixels along a tile, 16 to 2048 (default 256; --all 192)\n"
        "  --across N       --all: presets in a row, 1 to 16 (default 5)\n"
        "  --threads N      1 to 256 (default: as many as there are processors)\n\n"
        "Near a tile is 28 yarns of cloth wide, far 16 cm. The exposure is fixed: a white Lambert\n"
        "sheet that faces the key light shows 1.0 of it; a sky adds 0.22.\n",
        to);
}

typedef struct options {
  const char *word, *path;
  int all, help, size, across, threads;
} options;

static int bad_usage(const char *what, const char *value) {
  fprintf(stderr, "shade swatch: %s '%s' (see shade swatch --help)\n", what, value);
  return TOOL_BAD_USAGE;
}

static int read_options(int argc, char **argv, options *o) {
  const struct {
    const char *name;
    int *value, low, high;
  } numbers[] = {{"--size", &o->size, 16, 2048},
                 {"--across", &o->across, 1, 16},
                 {"--threads", &o->threads, 1, 256}};
  for (int i = 1; i < argc; i++) {
    const char *a = argv[i];
    int known = 0;
    if (!strcmp(a, "--help") || !strcmp(a, "-h")) {
      o->help = 1;
      return TOOL_DONE;
    }
    for (int k = 0; k < 3; k++)
      if (!strcmp(a, numbers[k].name)) {
        long number;
        if (i + 1 == argc ||
            !tool_parse_whole(argv[i + 1], numbers[k].low, numbers[k].high, &number)) {
          fprintf(stderr, "shade swatch: %s: expected a whole number from %d to %d\n", a,
                  numbers[k].low, numbers[k].high);
          return TOOL_BAD_USAGE;
        }
        *numbers[k].value = (int)number;
        known = 1;
        i++;
      }
    if (known)
      continue;
    if (!strcmp(a, "--all")) {
      o->all = 1;
    } else if (!strcmp(a, "-o")) {
      if (i + 1 == argc)
        return bad_usage("a file's name is missing after", a);
      o->path = argv[++i];
    } else if (a[0] == '-') {
      return bad_usage("unknown option", a);
    } else if (o->word) {
      return bad_usage("one preset at a time, not also", a);
    } else {
      o->word = a;
    }
  }
  if (!o->path || !o->all == !o->word) {
    fputs("shade swatch: expected a preset, or --all, and -o FILE\n\n", stderr);
    usage(stderr);
    return TOOL_BAD_USAGE;
  }
  return TOOL_DONE;
}

static int set_material(material *m) {
  unsigned status = SHADE_OK;
  if (m->preset.kind == SHADE_PRESET_METAL) {
    shade_bsdf_setup(&m->metal, &m->preset.metal);
    return 1;
  }
  m->fabric = shade_preset_fabric(&m->preset, &m->weave, &status);
  return m->fabric != NULL;
}

/* The presets asked for; NULL after a message, exit status in *status. */
static material *find_materials(const options *o, int *count, int *status) {
  shade_preset p;
  *count = 1;
  *status = TOOL_BAD_INPUT;
  for (*count = 0; shade_preset_row(*count, &p); ++*count)
    ;
  material *m = calloc((size_t)*count, sizeof *m);
  if (m && !o->all) {
    *count = 1;
    if (!shade_preset_find(o->word, &m->preset)) {
      fprintf(stderr, "shade swatch: no preset '%s'; shade presets lists them\n", o->word);
      *status = TOOL_BAD_USAGE;
      free(m);
      return NULL;
    }
  }
  int ok = m != NULL;
  for (int i = 0; ok && i < *count; i++) {
    if (o->all)
      shade_preset_row(i, &m[i].preset);
    ok = set_material(&m[i]);
  }
  if (!ok)
    fputs("shade swatch: out of memory\n", stderr);
  return m;
}

static void free_materials(material *m, int count) {
  for (int i = 0; m && i < count; i++) {
    shade_fabric_free(m[i].fabric);
    shade_weave_free(m[i].weave);
  }
  free(m);
}

static int lay_out(sheet *sh, const options *o, int count) {
  if (!o->all) {
    sh->across = COLUMNS;
    sh->down = ROWS;
  } else {
    const int pairs = o->across < count ? o->across : count;
    sh->across = 2 * pairs;
    sh->down = (count + pairs - 1) / pairs;
  }
  const int tiles = sh->across * sh->down;
  sh->tiles = calloc((size_t)tiles, sizeof *sh->tiles);
  for (int i = 0; sh->tiles && i < tiles; i++) {
    const int row = i / sh->across, column = i % sh->across;
    if (o->all)
      sh->tiles[i] = (tile){column % 2, column % 2, i / 2, (column % 2 ? 30 : -35) * PI / 180};
    else
      sh->tiles[i] = (tile){row / 2, row % 2, 0, (-60 + 40 * column) * PI / 180};
    if (sh->tiles[i].preset >= count)
      sh->tiles[i].preset = -1;
  }
  return sh->tiles != NULL;
}

int shade_cmd_swatch(int argc, char **argv) {
  options o = {.size = 0, .across = 5, .threads = tool_threads()};
  int status = read_options(argc, argv, &o), count;
  if (o.help)
    usage(stdout);
  if (status || o.help)
    return status;
  sheet sh = {.size = o.size ? o.size : o.all ? 192 : 256};
  sh.materials = find_materials(&o, &count, &status);
  if (!sh.materials)
    return status;
  if (lay_out(&sh, &o, count)) {
    const int pitch = sh.size + MARGIN, exr = shade_image_format_of(o.path) == SHADE_IMAGE_EXR;
    tool_picture picture = {
        .path = o.path,
        .spec = {.width = sh.across * pitch + MARGIN,
                 .height = sh.down * pitch + MARGIN,
                 .channels = 3,
                 .type = exr ? SHADE_IMAGE_HALF : SHADE_IMAGE_U8,
                 .srgb = 1,
                 .note = o.all ? "shade swatch --all" : sh.materials->preset.label}};
    status = tool_write_pictures("swatch", &picture, 1, o.threads, fill_rows, &sh);
  } else {
    fputs("shade swatch: out of memory\n", stderr);
  }
  free(sh.tiles);
  free_materials(sh.materials, count);
  return status;
}
