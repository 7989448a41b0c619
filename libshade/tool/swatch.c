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
#include "tool/letters.h"
#include "tool/parse.h"
#include "tool/tool.h"
#include "tool/work.h"

#define PI 3.14159265358979323846

enum {
  MARGIN = 8,
  COLUMNS = 4, /* positions of the light */
  ROWS = 4,    /* flat near, flat far, cylinder near, cylinder far */
  KEY = 13,    /* samples of the key light, a disc; of cloth */
  SKY = 12,    /* and of the sky */
  LIGHTS = KEY + SKY,
  KEY_POINTS = 64, /* for metals, whose lobes are narrower */
  SKY_DRAWS = 32,
  MOST_LIGHTS = KEY_POINTS
};

/* How many crossings, or cm of metal, a tile is wide. */
#define NEAR_CROSSINGS 28.0
#define NEAR_METAL_CM 2.0
#define FAR_CM 16.0
#define CYLINDER 0.88 /* its radius, half a tile being 1 */

/* What a white Lambert sheet that faces it shows of each light, 1 being white in the picture;
 * metals are taken with less of the key, which they throw back as a whole. */
#define CLOTH_KEY 1.5
#define CLOTH_SKY 0.4
#define METAL_KEY 0.4
#define METAL_SKY 0.55
#define GROUND 0.02 /* behind the swatches */

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
  shade_scratch_field *scratches;
  int shared; /* the scratches are another material's */
} material;

typedef struct sheet {
  int size, across, down; /* pixels of a tile, tiles */
  int labels;             /* names under pairs of tiles */
  double sky;             /* its scale */
  material *materials;
  tile *tiles;
} sheet;

static void unit(double v[3]) {
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int c = 0; c < 3; c++)
    v[c] /= length;
}

/* What the sky sends from direction d: a bright wall above, a window to the left, a dark floor. */
static double sky(const double d[3]) {
  const double up = fmin(fmax((d[1] + 0.25) / 1.1, 0), 1), across = (d[0] + 0.75) / 0.16;
  return 0.10 + 0.5 * up * up * (3 - 2 * up) + 0.9 * up * exp(-across * across);
}

/* The key light: `count` points of a disc 9 degrees across on an arc from left to right, 22
 * degrees up. */
static void place_key(double azimuth, double power, int count, light *lights) {
  const double golden = PI * (3 - sqrt(5.0));
  double to[3] = {sin(azimuth), 0.4, cos(azimuth)};
  unit(to);
  double side[3] = {to[2], 0, -to[0]}, up[3];
  unit(side);
  up[0] = to[1] * side[2] - to[2] * side[1];
  up[1] = to[2] * side[0] - to[0] * side[2];
  up[2] = to[0] * side[1] - to[1] * side[0];
  for (int i = 0; i < count; i++) {
    double r = 0.16 * sqrt((i + 0.5) / count), x = r * cos(i * golden), y = r * sin(i * golden);
    for (int c = 0; c < 3; c++)
      lights[i].to[c] = to[c] + x * side[c] + y * up[c];
    unit(lights[i].to);
    lights[i].power = PI * power / count;
  }
}

/* What multiplies sky() so that on a sheet that faces the eye it comes to 1. */
static double sky_scale(void) {
  const double golden = PI * (3 - sqrt(5.0));
  double total = 0;
  enum { N = 512 };
  for (int i = 0; i < N; i++) {
    double z = sqrt((i + 0.5) / N), r = sqrt(1 - z * z);
    double d[3] = {r * cos(i * golden), r * sin(i * golden), z};
    total += sky(d) / N;
  }
  return 1 / total;
}

/* The sky as lights, evenly over the hemisphere about the eye's side. */
static void place_sky(double scale, int count, light *lights) {
  const double golden = PI * (3 - sqrt(5.0));
  for (int i = 0; i < count; i++) {
    double z = (i + 0.5) / count, r = sqrt(1 - z * z);
    light *l = &lights[i];
    l->to[0] = r * cos(i * golden);
    l->to[1] = r * sin(i * golden);
    l->to[2] = z;
    l->power = scale * sky(l->to) * 2 * PI / count;
  }
}

/* A point of the swatch: frame, place in half tiles along the cloth, and how much that is
 * stretched against the picture. */
typedef struct spot {
  double x[3], y[3], z[3], at[2], stretch;
  double n[3]; /* of the folds, in that frame */
} spot;

/* 0 beside the swatch. x and y run from -1 to 1 over the tile. */
static int find_spot(const tile *t, double x, double y, int folds, spot *s) {
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
  s->n[0] = folds ? -slope : 0;
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

static void draw_cloth(const material *m, const tile *t, const light *lights, const spot *s,
                       const double wo[3], double pixel, double sum[3]) {
  double scale[2];
  tile_scale(t, &m->preset, scale);
  const double uv[2] = {s->at[0] * scale[0] + 4096, s->at[1] * scale[1] + 4096};
  const double footprint[2] = {pixel * scale[0] * s->stretch, pixel * scale[1]};
  for (int i = 0; i < LIGHTS; i++) {
    double wi[3], f[3];
    local(s, lights[i].to, wi);
    shade_fabric_eval(m->fabric, uv, footprint, s->n, wi, wo, SHADE_TIER_AUTO, f);
    for (int c = 0; c < 3; c++)
      sum[c] += f[c] * lights[i].power;
  }
}

/* Turn x and y of the frame about z. */
static void turn(spot *s, double cosine, double sine) {
  for (int c = 0; c < 3; c++) {
    double x = s->x[c], y = s->y[c];
    s->x[c] = cosine * x + sine * y;
    s->y[c] = cosine * y - sine * x;
  }
}

/* Two numbers that look random but are the same every time. */
static void jitter(double x, double y, double out[2]) {
  const double a = sin(x * 12.9898 + y * 78.233) * 43758.5453,
               b = sin(x * 39.346 + y * 11.135) * 24634.6345;
  out[0] = a - floor(a);
  out[1] = b - floor(b);
}

/*
 * Metal: what its strokes' slopes do within the pixel widens the lobe; the key light is taken
 * point by point, the sky by directions that the lobe draws.
 */
static void draw_metal(const material *m, const tile *t, const light *lights, double sky_size,
                       const spot *given, const double eye[3], double pixel, double sum[3]) {
  spot s = *given;
  const shade_preset *p = &m->preset;
  const double cm = t->far ? FAR_CM / 2 : NEAR_METAL_CM / 2, tiles = cm / p->scratch_cm;
  double u = s.at[0] * tiles, v = s.at[1] * tiles;
  const double side = pixel * tiles;
  double footprint[4] = {side * s.stretch, 0, 0, side};
  if (p->turned && !t->cylinder) {
    /* whole tiles round the middle, so that no seam shows */
    const double r = fmax(hypot(s.at[0], s.at[1]), 1e-6);
    const double around = fmax(floor(2 * PI * 0.5 * tiles + 0.5), 1);
    u = around * (atan2(s.at[1], s.at[0]) / (2 * PI) + 1);
    v = r * tiles;
    footprint[0] = fmin(around * pixel / (2 * PI * r), 1);
    turn(&s, -s.at[1] / r, s.at[0] / r);
  }
  shade_slopes slopes;
  shade_scratch_eval(m->scratches, u - floor(u), v - floor(v), footprint, NULL, &slopes);
  shade_params wide;
  shade_bsdf b;
  double angle, wo[3], n[3] = {slopes.normal[0], slopes.normal[1], slopes.normal[2]};
  shade_params_widen(&p->metal, n, slopes.covariance, &wide, &angle);
  shade_bsdf_setup(&b, &wide);
  turn(&s, cos(angle), sin(angle));
  const double nx = n[0];
  n[0] = cos(angle) * nx + sin(angle) * n[1];
  n[1] = cos(angle) * n[1] - sin(angle) * nx;
  local(&s, eye, wo);
  for (int i = 0; i < KEY_POINTS; i++) {
    double wi[3], f[3], cosine;
    local(&s, lights[i].to, wi);
    shade_bsdf_eval(&b, n, wi, wo, f, &cosine);
    for (int c = 0; c < 3; c++)
      sum[c] += f[c] * cosine * lights[i].power;
  }
  double shift[2];
  jitter(given->at[0], given->at[1], shift);
  for (int i = 0; i < SKY_DRAWS; i++) {
    const double number[2] = {fmod(shift[0] + (i + 0.5) / SKY_DRAWS, 1),
                              fmod(shift[1] + i * 0.6180339887498949, 1)};
    double wi[3], f[3], pdf, cosine, d[3];
    shade_bsdf_sample(&b, n, wo, number, wi, f, &pdf, &cosine);
    if (!(pdf > 0))
      continue;
    for (int c = 0; c < 3; c++)
      d[c] = wi[0] * s.x[c] + wi[1] * s.y[c] + wi[2] * s.z[c];
    for (int c = 0; c < 3; c++)
      sum[c] += f[c] * cosine / pdf * sky_size * sky(d) / SKY_DRAWS;
  }
}

/* x and y run from -1 to 1 over the tile; pixel is the width of one there. */
static void draw_pixel(const sheet *sh, const tile *t, const light *lights, double x, double y,
                       float rgb[3]) {
  const material *m = &sh->materials[t->preset];
  const double pixel = 2.0 / sh->size;
  spot s;
  double sum[3] = {0, 0, 0};
  if (find_spot(t, x, y, m->fabric != NULL, &s)) {
    double eye[3] = {t->cylinder ? 0 : -x, -y, 3.2}, wo[3];
    unit(eye);
    local(&s, eye, wo);
    if (m->fabric)
      draw_cloth(m, t, lights, &s, wo, pixel, sum);
    else
      draw_metal(m, t, lights, METAL_SKY * sh->sky, &s, eye, pixel, sum);
  } else {
    sum[0] = sum[1] = sum[2] = GROUND;
  }
  for (int c = 0; c < 3; c++)
    rgb[c] = (float)sum[c];
}

/* Rows from one line of tiles to the next. */
static int line_pitch(const sheet *sh) {
  return sh->size + MARGIN + (sh->labels ? LETTER_HEIGHT + MARGIN / 2 : 0);
}

/* One row of a tile, its pixels at `rgb`. */
static void draw_row(const sheet *sh, const tile *t, int row, float *rgb) {
  light lights[MOST_LIGHTS];
  if (sh->materials[t->preset].fabric) {
    place_key(t->azimuth, CLOTH_KEY, KEY, lights);
    place_sky(CLOTH_SKY * sh->sky, SKY, lights + KEY);
  } else {
    place_key(t->azimuth, METAL_KEY, KEY_POINTS, lights);
  }
  for (int x = 0; x < sh->size; x++)
    draw_pixel(sh, t, lights, 2 * (x + 0.5) / sh->size - 1, 1 - 2 * (row + 0.5) / sh->size,
               rgb + 3 * (size_t)x);
}

/* One row of a preset's name below its two tiles; what does not fit is left out. */
static void draw_label(const sheet *sh, const tile *t, int row, float *rgb) {
  const char *label = sh->materials[t->preset].preset.label;
  const int room = 2 * sh->size + MARGIN;
  for (int x = 0; x < (int)strlen(label) * LETTER_WIDTH && x < room; x++)
    if (letter_ink(label[x / LETTER_WIDTH], x % LETTER_WIDTH, row))
      for (int c = 0; c < 3; c++)
        rgb[3 * (size_t)x + (size_t)c] = 0.5f;
}

static void fill_rows(void *context, int first, int count, float *const *out) {
  const sheet *sh = context;
  const int pitch = sh->size + MARGIN, down = line_pitch(sh), width = sh->across * pitch + MARGIN;
  for (int row = first; row < first + count; row++) {
    float *line = out[0] + 3 * (size_t)(row - first) * (size_t)width;
    for (int i = 0; i < 3 * width; i++)
      line[i] = (float)GROUND;
    const int ty = (row - MARGIN + down) / down - 1, y = row - MARGIN - ty * down;
    const int label = y - sh->size - MARGIN / 2;
    for (int tx = 0; ty >= 0 && ty < sh->down && tx < sh->across; tx++) {
      const tile *t = &sh->tiles[ty * sh->across + tx];
      float *rgb = line + 3 * (size_t)(MARGIN + tx * pitch);
      if (t->preset >= 0 && y < sh->size)
        draw_row(sh, t, y, rgb);
      else if (t->preset >= 0 && sh->labels && tx % 2 == 0 && label >= 0)
        draw_label(sh, t, label, rgb);
    }
  }
}

static void usage(FILE *to) {
  fputs(
      "usage: shade swatch PRESET -o sheet.png|sheet.exr [options]\n"
      "       shade swatch --all -o sheet.png|sheet.exr [options]\n\n"
      "A sheet of one preset: flat near, flat far, hung in folds near, the same far; from left\n"
      "to right the light moves from the left to the right of the eye. --all: every preset,\n"
      "flat near and hung far, with its name, in the order of `shade presets`.\n\n"
      "  -o FILE          PNG (8 bits, sRGB) or EXR (half float, linear)\n"
      "  --size N         pixels along a tile, 16 to 2048 (default 256; --all 192)\n"
      "  --across N       --all: presets in a row, 1 to 16 (default 5)\n"
      "  --threads N      1 to 256 (default: as many as there are processors)\n\n"
      "Near a tile is 28 yarns of cloth or 2 cm of metal wide, far 16 cm. The exposure is fixed:\n"
      "1 is white, and a white Lambert sheet that faces the key light would show 1.5 of it\n"
      "(metals: 0.4) and 0.4 of the sky (metals: 0.55).\n",
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
        int64_t number;
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
  if (shade_image_format_of(o->path) == SHADE_IMAGE_UNKNOWN) {
    fprintf(stderr, "shade swatch: -o '%s': expected a name that ends in .exr or .png\n", o->path);
    return TOOL_BAD_USAGE;
  }
  return TOOL_DONE;
}

/* Ready m[i]; metals of the same finish share its scratches. */
static int set_material(material *all, int i) {
  unsigned status = SHADE_OK;
  material *m = &all[i];
  if (m->preset.kind == SHADE_PRESET_METAL) {
    for (int k = 0; k < i; k++)
      if (all[k].scratches &&
          !memcmp(&all[k].preset.scratches, &m->preset.scratches, sizeof m->preset.scratches)) {
        m->scratches = all[k].scratches;
        m->shared = 1;
        return 1;
      }
    m->scratches = shade_scratch_create(&m->preset.scratches, &status);
    return m->scratches != NULL;
  }
  m->fabric = shade_preset_fabric(&m->preset, &m->weave, &status);
  return m->fabric != NULL;
}

static void free_materials(material *m, int count) {
  for (int i = 0; m && i < count; i++) {
    shade_fabric_free(m[i].fabric);
    shade_weave_free(m[i].weave);
    if (!m[i].shared)
      shade_scratch_free(m[i].scratches);
  }
  free(m);
}

/* The presets asked for; NULL after a message, exit status in *status. */
static material *find_materials(const options *o, int *count, int *status) {
  shade_preset p;
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
    ok = set_material(m, i);
  }
  if (!ok) {
    fputs("shade swatch: out of memory\n", stderr);
    free_materials(m, *count);
    return NULL;
  }
  return m;
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
      sh->tiles[i] = (tile){column % 2, column % 2, i / 2, (column % 2 ? 25 : -25) * PI / 180};
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
  sheet sh = {.size = o.size ? o.size : o.all ? 192 : 256, .labels = o.all, .sky = sky_scale()};
  sh.materials = find_materials(&o, &count, &status);
  if (!sh.materials)
    return status;
  if (lay_out(&sh, &o, count)) {
    const int pitch = sh.size + MARGIN, exr = shade_image_format_of(o.path) == SHADE_IMAGE_EXR;
    tool_picture picture = {
        .path = o.path,
        .spec = {.width = sh.across * pitch + MARGIN,
                 .height = sh.down * line_pitch(&sh) + MARGIN,
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
