/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shade check: recompute a dump with the reference.
 *
 * A check that cannot fail is none. So a dump fails not only where S differs, but
 * also where nothing could be compared, where a value is no number or a direction
 * not unit, where a pixel names a material that the header lacks, and where a miss
 * carries light.
 */
#define _POSIX_C_SOURCE 200809L /* isatty */
#include "tool/check.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tool/tool.h"

static void usage(FILE *to) {
  fputs("usage: shade check DUMP.exr [options]\n\n"
        "Recomputes what a renderer wrote with LIBSHADE_DUMP=DUMP.exr and compares every\n"
        "value S above 1e-4 of the largest of its material and light, in either.\n"
        "An error is |S - reference| over the larger of the two. A dump holds float32\n"
        "directions. What their rounding alone may do to a value, at large exponents or at\n"
        "grazing angles, is computed from the reference and taken off errors over the limit.\n\n"
        "  --tolerance E        largest error to pass, beyond that (default 1e-4)\n"
        "  --mean-tolerance E   largest mean error of a material under a light to pass\n"
        "                       (default 1e-5)\n"
        "  --all                fail also when a material of the header or a light has\n"
        "                       nothing to compare\n"
        "  --json               the result as JSON\n\n"
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

#include "dump/dump.h"
#include "reference/reference.h"
#include "tool/json.h"

/* Values below this part of the largest say nothing about relative error. */
#define SIGNIFICANT 1e-4
/* float32 directions are off by up to 6e-8 a component: rounding alone decides the
 * side of the horizon within this cosine. */
#define HORIZON 1e-6
/* Choices that fade light out towards wi.z = 0 make S proportional to wi.z there, which that
 * rounding changes by more than 5e-5 of itself below this cosine. */
#define FADED 2e-3
/* Half of float32's step at 1: what the rounding of directions may turn them by, in radians. */
#define ROUNDING 0x1p-24
/* Directions of the dump are unit to float rounding; more is an error of the back end. */
#define UNIT_TOLERANCE 1e-4

typedef struct options {
  const char *path;
  double tolerance, mean_tolerance;
  int all, json;
} options;

/* ---- materials of the header ------------------------------------------------ */

typedef struct material {
  int id;
  const char *name; /* in the JSON tree */
  shade_params params;
  size_t pixels;
  double tilt; /* largest angle of Ns from N, radians: 0 means that no bump was tested */
} material;

/* Says what is wrong with a material of the file's header. Always 0. */
static int bad_material(const char *path, int index, const char *message, const char *word) {
  fprintf(stderr, "shade check: %s: material number %d of the header: %s '%s'\n", path, index,
          message, word);
  return 0;
}

static void set_choice(shade_params *p, shade_list list, int value) {
  switch (list) {
  case SHADE_LIST_MDF:
    p->mdf = (shade_mdf)value;
    break;
  case SHADE_LIST_BRDF:
    p->brdf = (shade_brdf)value;
    break;
  case SHADE_LIST_DETAIL:
    p->detail = (shade_detail)value;
    break;
  case SHADE_LIST_GROOVE:
    p->groove = (shade_groove)value;
    break;
  case SHADE_LIST_FRESNEL:
    p->fresnel = (shade_fresnel)value;
    break;
  case SHADE_LIST_DIFFUSE:
    p->diffuse = (shade_diffuse)value;
    break;
  case SHADE_LIST_HORIZON:
    p->horizon = (shade_horizon)value;
    break;
  case SHADE_LIST_COUNT:
    break;
  }
}

/* One number, or an array of as many as the parameter has, into its place in *p. */
static int read_param(shade_params *p, int row, const shade_param_info *info, const json *value) {
#define PLACE(word, ...) offsetof(shade_params, word),
  static const size_t places[] = {SHADE_TABLE_PARAMS(PLACE)};
#undef PLACE
  double *place = (double *)(void *)((char *)p + places[row]);
  const json *item = value;
  if (info->components > 1)
    item = value->type == JSON_ARRAY ? value->child : NULL;
  for (int i = 0; i < info->components; i++, item = item->next) {
    if (!item || item->type != JSON_NUMBER || !(item->number >= info->minimum) ||
        !(item->number <= info->maximum))
      return 0;
    place[i] = item->number;
  }
  return info->components == 1 || !item;
}

/*
 * A key of the table: its number for `seen`, or -1. Lists come first, then the
 * parameters. *good says whether the value fits.
 */
static int read_table_key(shade_params *p, const json *member, int *good) {
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    if (strcmp(member->key, shade_list_name((shade_list)list)) == 0) {
      const int value = shade_list_find((shade_list)list, member->string);
      *good = value >= 0;
      if (*good)
        set_choice(p, (shade_list)list, value);
      return list;
    }
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    if (strcmp(member->key, info.word) == 0) {
      *good = read_param(p, row, &info, member);
      return SHADE_LIST_COUNT + row;
    }
  return -1;
}

static int is_id(const json *value) { /* a float of material.ID holds it exactly */
  return value->type == JSON_NUMBER && value->number >= 0 && value->number <= 1 << 24 &&
         value->number == floor(value->number);
}

/* Every key of the table must be there, but for `horizon`, once; one that is not known might
 * matter. */
static int read_material(material *m, const char *path, int index, const json *object) {
  enum { KEYS = 64, ID = KEYS - 2, NAME };
  char seen[KEYS] = {0};
  shade_params_init(&m->params);
  m->params.horizon = SHADE_HORIZON_HARD; /* what dumps older than that list were shaded by */
  m->name = "";
  if (object->type != JSON_OBJECT)
    return bad_material(path, index, "is no", "{ }");
  for (const json *member = object->child; member; member = member->next) {
    int good = 1, key = read_table_key(&m->params, member, &good);
    if (strcmp(member->key, "id") == 0) {
      key = ID;
      good = is_id(member);
      m->id = good ? (int)member->number : 0;
    } else if (strcmp(member->key, "name") == 0) {
      key = NAME;
      good = member->type == JSON_STRING;
      m->name = member->string;
    }
    if (key < 0)
      return bad_material(path, index, "unknown key", member->key);
    if (!good)
      return bad_material(path, index, "bad value of", member->key);
    if (seen[key]++)
      return bad_material(path, index, "two values of", member->key);
  }
  if (!seen[ID])
    return bad_material(path, index, "lacks", "id");
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    if (!seen[list] && list != SHADE_LIST_HORIZON)
      return bad_material(path, index, "lacks", shade_list_name((shade_list)list));
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    if (!seen[SHADE_LIST_COUNT + row])
      return bad_material(path, index, "lacks", info.word);
  return 1;
}

static int by_id(const void *a, const void *b) {
  return ((const material *)a)->id - ((const material *)b)->id;
}

/* Sorted by id. NULL after printing why. */
static material *read_materials(const char *path, const json *header, int *count) {
  const json *list = json_member(header, "materials");
  *count = 0;
  if (!list || list->type != JSON_ARRAY || !list->child) {
    fprintf(stderr, "shade check: %s: the header lists no \"materials\"\n", path);
    return NULL;
  }
  for (const json *item = list->child; item; item = item->next)
    ++*count;
  material *materials = calloc((size_t)*count, sizeof *materials);
  if (!materials) {
    fputs("shade check: out of memory\n", stderr);
    return NULL;
  }
  int good = 1, index = 0;
  for (const json *item = list->child; good && item; item = item->next, index++)
    good = read_material(&materials[index], path, index, item);
  if (good)
    qsort(materials, (size_t)*count, sizeof *materials, by_id);
  for (int i = 1; good && i < *count; i++)
    if (materials[i].id == materials[i - 1].id) {
      fprintf(stderr, "shade check: %s: two materials of the header have id %d\n", path,
              materials[i].id);
      good = 0;
    }
  if (good)
    return materials;
  free(materials);
  return NULL;
}

/* ---- the comparison ---------------------------------------------------------- */

/* What can be wrong with a dump besides a differing S. */
typedef enum fault {
  FAULT_ID,
  FAULT_MISS,
  FAULT_NOT_FINITE,
  FAULT_NOT_UNIT,
  FAULT_TANGENT,
  FAULT_E,
  FAULT_S,
  FAULT_REFERENCE,
  FAULT_COUNT
} fault;

static const char *const fault_words[FAULT_COUNT] = {
    [FAULT_ID] = "material.ID is not in the header",
    [FAULT_MISS] = "a miss (material.ID -1) carries S",
    [FAULT_NOT_FINITE] = "P, uv or Color is not finite",
    [FAULT_NOT_UNIT] = "N, T, Ns, V or a light's L is not unit",
    [FAULT_TANGENT] = "T is not orthogonal to N",
    [FAULT_E] = "E is negative or not finite",
    [FAULT_S] = "S is not finite",
    [FAULT_REFERENCE] = "the reference gives no finite value",
};

/* One material under one light. */
typedef struct cell {
  double maximum; /* of S and of the reference */
  size_t checked;
  double largest, sum; /* relative errors */
  double beyond;       /* the largest that is over the limit, less what rounding may do there */
  size_t excused;      /* values over the limit, but not by more than rounding may do */
  size_t worst_pixel;
  int worst_channel;
  double worst_s, worst_reference, worst_rounding;
} cell;

typedef struct check {
  const options *options;
  const shade_dump *dump;
  const char *renderer;
  material *materials;
  int material_count;
  size_t pixels;
  cell *cells;       /* material by material, light by light */
  int *index;        /* per pixel: its material's index, or -1: nothing to compare */
  double *reference; /* per pixel and channel, of the light at hand */
  size_t horizon;    /* values left out there */
  size_t faults[FAULT_COUNT], first_fault[FAULT_COUNT];
  struct timespec started;
  int progress; /* last percentage shown, or -1 */
} check;

static void note_fault(check *c, fault what, size_t pixel) {
  if (c->faults[what]++ == 0)
    c->first_fault[what] = pixel;
}

/* A line on the terminal once the work has taken more than two seconds. */
static void show_progress(check *c, double part) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  const int percent = (int)(100 * part);
  if (now.tv_sec - c->started.tv_sec < 2 || percent == c->progress || !isatty(STDERR_FILENO))
    return;
  c->progress = percent;
  fprintf(stderr, "\rchecking %3d %%", percent);
}

static void end_progress(const check *c) {
  if (c->progress >= 0)
    fputs("\r              \r", stderr);
}

/* Three planes from `first` on. */
static void read_three(const check *c, const float *first, size_t pixel, double v[3]) {
  for (size_t i = 0; i < 3; i++)
    v[i] = (double)first[i * c->pixels + pixel];
}

static int finite_three(const double v[3]) {
  return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise(double v[3]) {
  const double length = sqrt(dot(v, v));
  for (int i = 0; i < 3; i++)
    v[i] /= length;
}

/* Reads a direction and makes it unit in double; 0 if it was not nearly so. */
static int read_unit(const check *c, const float *first, size_t pixel, double v[3]) {
  read_three(c, first, pixel, v);
  if (!(fabs(sqrt(dot(v, v)) - 1) < UNIT_TOLERANCE)) /* NaN fails too */
    return 0;
  normalise(v);
  return 1;
}

/* x = tangent, y = z x x, z = normal: the frame of the library. */
typedef struct frame {
  double axis[3][3];
} frame;

static void to_local(const frame *f, const double v[3], double local[3]) {
  for (int i = 0; i < 3; i++)
    local[i] = dot(f->axis[i], v);
}

static int find_material(const check *c, float id) {
  if (!(id >= 0 && id <= 1 << 24) || id != floorf(id))
    return -1;
  const material key = {.id = (int)id};
  const material *found = bsearch(&key, c->materials, (size_t)c->material_count, sizeof key, by_id);
  return found ? (int)(found - c->materials) : -1;
}

/* The frame of a hit, its Ns and V in it, and the material's parameters there. */
typedef struct hit {
  frame frame;
  double n[3], wo[3];
  shade_params params;
} hit;

/* 0 with a fault noted if the hit's planes are unfit. */
static int read_hit(check *c, size_t pixel, hit *h) {
  const shade_dump *d = c->dump;
  double tangent[3], ns[3], v[3], color[3], place[3];
  double *x = h->frame.axis[0], *y = h->frame.axis[1], *z = h->frame.axis[2];
  if (!read_unit(c, shade_dump_plane(d, SHADE_DUMP_N), pixel, z) ||
      !read_unit(c, shade_dump_plane(d, SHADE_DUMP_T), pixel, tangent) ||
      !read_unit(c, shade_dump_plane(d, SHADE_DUMP_NS), pixel, ns) ||
      !read_unit(c, shade_dump_plane(d, SHADE_DUMP_V), pixel, v)) {
    note_fault(c, FAULT_NOT_UNIT, pixel);
    return 0;
  }
  const double along = dot(tangent, z);
  if (fabs(along) > UNIT_TOLERANCE) {
    note_fault(c, FAULT_TANGENT, pixel);
    return 0;
  }
  for (int i = 0; i < 3; i++)
    x[i] = tangent[i] - along * z[i];
  normalise(x);
  y[0] = z[1] * x[2] - z[2] * x[1];
  y[1] = z[2] * x[0] - z[0] * x[2];
  y[2] = z[0] * x[1] - z[1] * x[0];
  to_local(&h->frame, ns, h->n);
  to_local(&h->frame, v, h->wo);

  read_three(c, shade_dump_plane(d, SHADE_DUMP_P), pixel, place);
  read_three(c, shade_dump_plane(d, SHADE_DUMP_COLOR), pixel, color);
  const float *uv = shade_dump_plane(d, SHADE_DUMP_UV);
  if (!finite_three(place) || !finite_three(color) || !isfinite(uv[pixel]) ||
      !isfinite(uv[c->pixels + pixel])) {
    note_fault(c, FAULT_NOT_FINITE, pixel);
    return 0;
  }
  h->params = c->materials[c->index[pixel]].params;
  if (d->has_color)
    memcpy(h->params.f0, color, sizeof color);
  return 1;
}

/* Find each pixel's material; what is no hit or unfit gets -1. */
static void find_hits(check *c) {
  const float *id = shade_dump_plane(c->dump, SHADE_DUMP_MATERIAL);
  for (size_t pixel = 0; pixel < c->pixels; pixel++) {
    const int index = c->index[pixel] = find_material(c, id[pixel]);
    if (index < 0) {
      if (id[pixel] != -1)
        note_fault(c, FAULT_ID, pixel);
      continue;
    }
    material *m = &c->materials[index];
    m->pixels++;
    hit h;
    if (read_hit(c, pixel, &h))
      m->tilt = fmax(m->tilt, atan2(hypot(h.n[0], h.n[1]), h.n[2]));
    else
      c->index[pixel] = -1;
  }
}

static int on_horizon(const hit *h, const double wi[3]) {
  double n[3]; /* of the lobe */
  shade_ref_normal(&h->params, h->n, h->wo, n);
  return fabs(wi[2]) < HORIZON || fabs(h->wo[2]) < HORIZON || fabs(h->n[2]) < HORIZON ||
         fabs(dot(n, wi)) < HORIZON || fabs(dot(n, h->wo)) < HORIZON;
}

static int faded(const hit *h, const double wi[3]) {
  return h->params.horizon >= SHADE_HORIZON_ESTEVEZ && wi[2] > 0 && wi[2] < FADED;
}

/*
 * Reference values of one pixel under one light; NaN marks values not to compare:
 * a fault, or the horizon, where rounding may have taken S, or the reference, to 0 or, where
 * light fades out, to too few digits.
 */
static void refer(check *c, int light, size_t pixel, double reference[3]) {
  double s[3], e[3], l[3], wi[3], f[3], cosine;
  hit h;
  reference[0] = reference[1] = reference[2] = NAN;
  read_three(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_S), pixel, s);
  read_three(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_E), pixel, e);
  if (!finite_three(s)) {
    note_fault(c, FAULT_S, pixel);
    return;
  }
  if (!finite_three(e) || e[0] < 0 || e[1] < 0 || e[2] < 0) {
    note_fault(c, FAULT_E, pixel);
    return;
  }
  if (e[0] == 0 && e[1] == 0 && e[2] == 0) { /* in shadow L may be anything */
    reference[0] = reference[1] = reference[2] = 0;
    return;
  }
  if (!read_unit(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_L), pixel, l)) {
    note_fault(c, FAULT_NOT_UNIT, pixel);
    return;
  }
  read_hit(c, pixel, &h);
  to_local(&h.frame, l, wi);
  shade_ref_f(&h.params, h.n, wi, h.wo, f, &cosine);
  const int horizon = on_horizon(&h, wi);
  for (int i = 0; i < 3; i++) {
    const double value = f[i] * cosine * e[i];
    if (!isfinite(value))
      note_fault(c, FAULT_REFERENCE, pixel);
    else if (faded(&h, wi) || (horizon && (s[i] == 0) != (value == 0)))
      c->horizon++;
    else
      reference[i] = value;
  }
}

/* v turned about an axis by a small angle. */
static void turned(const double axis[3], double angle, double v[3]) {
  const double along = dot(axis, v), u[3] = {v[0], v[1], v[2]};
  const double across[3] = {axis[1] * u[2] - axis[2] * u[1], axis[2] * u[0] - axis[0] * u[2],
                            axis[0] * u[1] - axis[1] * u[0]};
  for (int i = 0; i < 3; i++)
    v[i] = u[i] * cos(angle) + across[i] * sin(angle) + axis[i] * along * (1 - cos(angle));
}

/*
 * How far the rounding of directions may move a value, as a relative error: normal, light and
 * eye are turned one by one about each axis of the frame, then all together, as a turned frame
 * does, and the changes are added up.
 */
static double rounding_at(check *c, int light, size_t pixel, int channel) {
  enum { TURNS = 4 * 3 };
  double e[3], l[3], f[3], cosine, wi[3], base = 0, sum = 0;
  hit h;
  if (!read_unit(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_L), pixel, l))
    return 0;
  read_three(c, shade_dump_light_plane(c->dump, light, SHADE_DUMP_E), pixel, e);
  read_hit(c, pixel, &h);
  to_local(&h.frame, l, wi);
  for (int k = -1; k < TURNS; k++) {
    double v[3][3];
    memcpy(v[0], h.n, sizeof v[0]);
    memcpy(v[1], wi, sizeof v[1]);
    memcpy(v[2], h.wo, sizeof v[2]);
    for (int which = 0; which < 3 && k >= 0; which++)
      if (k / 3 == which || k / 3 == 3) {
        const double axis[3] = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
        turned(axis, ROUNDING, v[which]);
      }
    shade_ref_f(&h.params, v[0], v[1], v[2], f, &cosine);
    const double value = f[channel] * cosine * e[channel];
    if (k < 0)
      base = value;
    else
      sum += fabs(value - base);
  }
  return base > 0 && isfinite(sum) ? sum / base : 0;
}

static cell *cell_at(const check *c, int material_index, int light) {
  return &c->cells[material_index * c->dump->lights + light];
}

static void compare_value(check *c, int light, double s, double reference, size_t pixel,
                          int channel) {
  cell *in = cell_at(c, c->index[pixel], light);
  const double larger = fmax(fabs(s), fabs(reference));
  if (isnan(reference) || !(larger > SIGNIFICANT * in->maximum))
    return;
  const double error = fabs(s - reference) / larger;
  in->checked++;
  in->sum += error;
  const double rounding = error > c->options->tolerance ? rounding_at(c, light, pixel, channel) : 0;
  if (rounding > 0 && error - rounding <= c->options->tolerance)
    in->excused++;
  if (error > c->options->tolerance)
    in->beyond = fmax(in->beyond, error - rounding);
  if (in->checked > 1 && error <= in->largest)
    return;
  in->worst_rounding = rounding;
  in->largest = error;
  in->worst_pixel = pixel;
  in->worst_channel = channel;
  in->worst_s = s;
  in->worst_reference = reference;
}

static void compare_light(check *c, int light) {
  const float *s = shade_dump_light_plane(c->dump, light, SHADE_DUMP_S);
  for (size_t pixel = 0; pixel < c->pixels; pixel++) {
    if (pixel % 4096 == 0)
      show_progress(c, ((double)light + (double)pixel / (double)c->pixels) / c->dump->lights);
    if (c->index[pixel] < 0)
      continue;
    double *reference = c->reference + 3 * pixel;
    cell *in = cell_at(c, c->index[pixel], light);
    refer(c, light, pixel, reference);
    for (size_t i = 0; i < 3; i++)
      if (!isnan(reference[i]))
        in->maximum =
            fmax(in->maximum, fmax(fabs((double)s[i * c->pixels + pixel]), fabs(reference[i])));
  }
  const float *id = shade_dump_plane(c->dump, SHADE_DUMP_MATERIAL);
  for (size_t pixel = 0; pixel < c->pixels; pixel++)
    for (int i = 0; i < 3; i++) {
      const double value = (double)s[(size_t)i * c->pixels + pixel];
      if (c->index[pixel] >= 0)
        compare_value(c, light, value, c->reference[3 * pixel + (size_t)i], pixel, i);
      else if (id[pixel] == -1 && value != 0)
        note_fault(c, FAULT_MISS, pixel);
    }
}

/* ---- the verdict --------------------------------------------------------------- */

typedef struct verdict {
  size_t checked, faults;
  double largest, beyond, mean; /* the worst of all cells */
  size_t excused;
  int idle_materials, idle_lights; /* with nothing to compare */
  int pass;
} verdict;

static double mean_of(const cell *in) {
  return in->checked ? in->sum / (double)in->checked : 0;
}

static verdict judge(const check *c) {
  verdict v = {0};
  const int lights = c->dump->lights;
  for (int m = 0; m < c->material_count; m++) {
    size_t checked = 0;
    for (int light = 0; light < lights; light++) {
      const cell *in = cell_at(c, m, light);
      checked += in->checked;
      v.largest = fmax(v.largest, in->largest);
      v.beyond = fmax(v.beyond, in->beyond);
      v.excused += in->excused;
      v.mean = fmax(v.mean, mean_of(in));
    }
    v.checked += checked;
    v.idle_materials += checked == 0;
  }
  for (int light = 0; light < lights; light++) {
    size_t checked = 0;
    for (int m = 0; m < c->material_count; m++)
      checked += cell_at(c, m, light)->checked;
    v.idle_lights += checked == 0;
  }
  for (int i = 0; i < FAULT_COUNT; i++)
    v.faults += c->faults[i];
  v.pass = v.checked > 0 && v.faults == 0 && v.beyond <= c->options->tolerance &&
           v.mean <= c->options->mean_tolerance &&
           !(c->options->all && (v.idle_materials || v.idle_lights));
  return v;
}

static int pixel_x(const check *c, size_t pixel) {
  return (int)(pixel % (size_t)c->dump->width);
}
static int pixel_y(const check *c, size_t pixel) {
  return (int)(pixel / (size_t)c->dump->width);
}

#define DEGREES (180 / 3.14159265358979323846)

static void print_text(const check *c, const verdict *v) {
  const shade_dump *d = c->dump;
  printf("%s: %d x %d pixels, %d light%s, %d material%s, from %s\n", c->options->path, d->width,
         d->height, d->lights, d->lights == 1 ? "" : "s", c->material_count,
         c->material_count == 1 ? "" : "s", c->renderer);
  printf("%8s %-20s %-12s %9s %6s %5s %9s %10s %10s  %s\n", "material", "", "detail", "pixels",
         "tilt", "light", "values", "largest", "mean", "worst pixel: S, reference");
  for (int m = 0; m < c->material_count; m++)
    for (int light = 0; light < d->lights; light++) {
      const material *mat = &c->materials[m];
      const cell *in = cell_at(c, m, light);
      printf("%8d %-20s %-12s %9zu %6.2f %5d %9zu ", mat->id, mat->name,
             shade_list_word(SHADE_LIST_DETAIL, (int)mat->params.detail), mat->pixels,
             mat->tilt * DEGREES, light, in->checked);
      if (in->checked)
        printf("%10.3e %10.3e  (%d, %d) %c: %.9g, %.9g\n", in->largest, mean_of(in),
               pixel_x(c, in->worst_pixel), pixel_y(c, in->worst_pixel), "RGB"[in->worst_channel],
               in -> worst_s, in -> worst_reference);
      else
        printf("%10s %10s  %s\n", "-", "-", mat->pixels ? "unlit" : "not in the picture");
    }
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
  printf("%s: ", v->pass ? "PASS" : "FAIL");
  if (v->checked == 0)
    printf("nothing to compare\n");
  else
    printf("%zu values, largest error %.3e (limit %g), largest mean %.3e (limit %g), "
           "%zu fault%s\n",
           v->checked, v->largest, c->options->tolerance, v->mean, c->options->mean_tolerance,
           v->faults, v->faults == 1 ? "" : "s");
}

static void print_json_cell(const check *c, const material *m, const cell *in, int light) {
  printf("{\"material\": %d, \"name\": ", m->id);
  json_print_string(stdout, m->name);
  printf(", \"detail\": \"%s\", \"pixels\": %zu, \"tilt\": %.6g, \"light\": %d, \"values\": %zu",
         shade_list_word(SHADE_LIST_DETAIL, (int)m->params.detail), m->pixels, m->tilt * DEGREES,
         light, in->checked);
  if (in->checked)
    printf(", \"largest\": %.17g, \"mean\": %.17g, \"worst\": {\"x\": %d, \"y\": %d, "
           "\"channel\": \"%c\", \"s\": %.9g, \"reference\": %.17g, \"rounding\": %.6g}",
           in->largest, mean_of(in), pixel_x(c, in->worst_pixel), pixel_y(c, in->worst_pixel),
           "RGB"[in->worst_channel], in -> worst_s, in -> worst_reference, in -> worst_rounding);
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
         "\"beyond_rounding\": %.17g, \"excused\": %zu, \"mean\": %.17g,\n \"horizon\": %zu, "
         "\"idle_materials\": %d, \"idle_lights\": %d,\n"
         " \"faults\": [",
         v->pass ? "true" : "false", d->width, d->height, d->lights, c->options->tolerance,
         c->options->mean_tolerance, v->checked, v->largest, v->beyond, v->excused, v->mean,
         c->horizon, v->idle_materials, v->idle_lights);
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
      print_json_cell(c, &c->materials[m], cell_at(c, m, light), light);
      comma = ",";
    }
  printf("]}\n");
}

/* ---- the command ------------------------------------------------------------------ */

static int check_dump(const options *o, const shade_dump *d, const json *header) {
  const size_t pixels = (size_t)d->width * (size_t)d->height;
  const json *renderer = json_member(header, "renderer");
  check c = {.options = o, .dump = d, .pixels = pixels, .progress = -1};
  c.renderer = renderer && renderer->type == JSON_STRING ? renderer->string : "unknown";
  c.materials = read_materials(o->path, header, &c.material_count);
  if (!c.materials)
    return TOOL_BAD_INPUT;
  clock_gettime(CLOCK_MONOTONIC, &c.started);
  c.cells = calloc((size_t)c.material_count * (size_t)d->lights + 1, sizeof *c.cells);
  c.index = malloc(pixels * sizeof *c.index);
  c.reference = malloc(3 * pixels * sizeof *c.reference);
  int status = TOOL_BAD_INPUT;
  if (c.cells && c.index && c.reference) {
    find_hits(&c);
    for (int light = 0; light < d->lights; light++)
      compare_light(&c, light);
    end_progress(&c);
    const verdict v = judge(&c);
    (o->json ? print_json : print_text)(&c, &v);
    status = v.pass ? TOOL_DONE : TOOL_BAD_INPUT;
  } else {
    fputs("shade check: out of memory\n", stderr);
  }
  free(c.cells);
  free(c.index);
  free(c.reference);
  free(c.materials);
  return status;
}

static int check_file(const options *o) {
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

static int read_tolerance(const char *text, double *tolerance) {
  char *end;
  *tolerance = text ? strtod(text, &end) : NAN;
  return text && end != text && *end == 0 && isfinite(*tolerance) && *tolerance >= 0;
}

int shade_cmd_check(int argc, char **argv) {
  options o = {.tolerance = 1e-4, .mean_tolerance = 1e-5};
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
      if (!read_tolerance(argv[++i], number)) {
        fprintf(stderr, "shade check: %s wants a number of at least 0\n", word);
        return TOOL_BAD_USAGE;
      }
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
