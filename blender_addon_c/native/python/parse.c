/* SPDX-License-Identifier: GPL-3.0-or-later */
#define Py_LIMITED_API 0x030b0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "python/parse.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system/parallel.h"

enum { MAX_SIZE = 1 << 16, MAX_SAMPLES = 1 << 16, MAX_THREADS = 256 };

typedef struct parser {
  char path[160]; /* where we are, for messages: meshes[2].material */
  parse_buffers *buffers;
} parser;

/* Every function below returns false with a Python exception set; the first word says where. */
__attribute__((format(printf, 2, 3))) static bool fail(const parser *p, const char *format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  PyErr_Format(PyExc_ValueError, "scene%s%s: %s", *p->path ? "." : "", p->path, text);
  return false;
}

/* Replace whatever exception a conversion raised by one that says where and what. */
static bool expected(const parser *p, const char *key, const char *what) {
  PyErr_Clear();
  return fail(p, "%s must be %s", key, what);
}

/* Borrowed; NULL without an exception when it is missing. */
static PyObject *find(PyObject *dict, const char *key) {
  return PyDict_GetItemString(dict, key);
}

static bool require(const parser *p, PyObject *dict, const char *key, PyObject **out) {
  *out = find(dict, key);
  return *out || fail(p, "%s is missing", key);
}

static bool as_number(PyObject *value, double *out) {
  *out = PyFloat_AsDouble(value);
  return !PyErr_Occurred() && isfinite(*out);
}

static bool number(const parser *p, PyObject *dict, const char *key, double *out) {
  PyObject *value;
  if (!require(p, dict, key, &value))
    return false;
  return as_number(value, out) || expected(p, key, "a finite number");
}

static bool number_within(const parser *p, PyObject *dict, const char *key, double low, double high,
                          float *out) {
  double value;
  if (!number(p, dict, key, &value))
    return false;
  if (value < low || value > high) {
    char text[80];
    snprintf(text, sizeof text, "from %g to %g", low, high);
    return expected(p, key, text);
  }
  *out = (float)value;
  return true;
}

static bool integer(const parser *p, PyObject *dict, const char *key, long low, long high,
                    int *out) {
  PyObject *value;
  if (!require(p, dict, key, &value))
    return false;
  long number = PyLong_AsLong(value);
  if (PyErr_Occurred() || number < low || number > high) {
    char text[80];
    snprintf(text, sizeof text, "an integer from %ld to %ld", low, high);
    return expected(p, key, text);
  }
  *out = (int)number;
  return true;
}

static bool flag(const parser *p, PyObject *dict, const char *key, bool *out) {
  PyObject *value;
  if (!require(p, dict, key, &value))
    return false;
  int truth = PyObject_IsTrue(value);
  *out = truth == 1;
  return truth >= 0 || expected(p, key, "True or False");
}

static bool numbers(const parser *p, PyObject *dict, const char *key, int count, double *out) {
  PyObject *value;
  char text[64];
  if (!require(p, dict, key, &value))
    return false;
  snprintf(text, sizeof text, "a sequence of %d finite numbers", count);
  if (!PySequence_Check(value) || PySequence_Size(value) != count)
    return expected(p, key, text);
  for (int i = 0; i < count; i++) {
    PyObject *item = PySequence_GetItem(value, i);
    bool good = item && as_number(item, &out[i]);
    Py_XDECREF(item);
    if (!good)
      return expected(p, key, text);
  }
  return true;
}

static bool floats(const parser *p, PyObject *dict, const char *key, int count, float *out) {
  double value[16];
  if (!numbers(p, dict, key, count, value))
    return false;
  for (int i = 0; i < count; i++)
    out[i] = (float)value[i];
  return true;
}

/* A copy of a string; `missing` stands for a missing key, NULL means that it is required. */
static bool text(const parser *p, PyObject *dict, const char *key, const char *missing,
                 char **out) {
  PyObject *value = find(dict, key);
  const char *utf8 = missing;
  if (!value && !missing)
    return fail(p, "%s is missing", key);
  if (value) {
    utf8 = PyUnicode_AsUTF8AndSize(value, NULL);
    if (!utf8)
      return expected(p, key, "a string");
  }
  *out = malloc(strlen(utf8) + 1);
  if (!*out) {
    PyErr_NoMemory();
    return false;
  }
  memcpy(*out, utf8, strlen(utf8) + 1);
  return true;
}

/* One of several words, as its index. */
static bool word(const parser *p, PyObject *dict, const char *key, const char *const *words,
                 int *out) {
  char *value, list[96] = "";
  if (!text(p, dict, key, NULL, &value))
    return false;
  for (*out = 0; words[*out] && strcmp(words[*out], value) != 0; ++*out)
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", *out ? ", " : "",
             words[*out]);
  free(value);
  return words[*out] || fail(p, "%s must be one of %s", key, list);
}

/* A list of dicts, each handed to `one` with p->path set to key[i]. */
static bool each(parser *p, PyObject *description, const char *key, size_t size, size_t *count,
                 void *array_out, bool (*one)(parser *, PyObject *, void *, scene *), scene *s) {
  PyObject *list;
  if (!require(p, description, key, &list))
    return false;
  if (!PyList_Check(list) && !PyTuple_Check(list))
    return expected(p, key, "a list");
  size_t length = (size_t)PySequence_Size(list);
  char *array = calloc(length + 1, size);
  if (!array) {
    PyErr_NoMemory();
    return false;
  }
  memcpy(array_out, &array, sizeof array);
  for (*count = 0; *count < length;) {
    PyObject *item = PySequence_GetItem(list, (Py_ssize_t)*count);
    snprintf(p->path, sizeof p->path, "%s[%zu]", key, *count);
    /* counted first: what `one` allocates before it fails is freed with the scene */
    void *at = array + size * (*count)++;
    bool good = item && (PyDict_Check(item) ? one(p, item, at, s) : fail(p, "a dict is expected"));
    Py_XDECREF(item); /* the list, or the buffer's owner, keeps what we read */
    if (!good)
      return false;
    p->path[0] = 0;
  }
  return true;
}

/* A C-contiguous buffer of `count` items whose format is one of `formats`; kept until release. */
static bool buffer(parser *p, PyObject *dict, const char *key, size_t count, const char *formats,
                   size_t item_size, const Py_buffer **out) {
  PyObject *value;
  if (!require(p, dict, key, &value))
    return false;
  Py_buffer *view = realloc(p->buffers->view, (p->buffers->count + 1) * sizeof *view);
  if (!view) {
    PyErr_NoMemory();
    return false;
  }
  p->buffers->view = view;
  view += p->buffers->count;
  if (PyObject_GetBuffer(value, view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0)
    return expected(p, key, "a contiguous buffer");
  p->buffers->count++;
  const char *format = view->format ? view->format : "B";
  format += *format && strchr("@=<", *format) ? 1 : 0;
  if (strlen(format) != 1 || !strchr(formats, *format) ||
      (item_size && (size_t)view->itemsize != item_size))
    return fail(p, "%s has items of format '%s'; one of '%s' with %zu bytes is expected", key,
                view->format ? view->format : "B", formats, item_size);
  if (count != SIZE_MAX && (size_t)view->len != count * (size_t)view->itemsize)
    return fail(p, "%s has %zu items; %zu are expected", key,
                (size_t)view->len / (size_t)view->itemsize, count);
  *out = view;
  return true;
}

void parse_release(parse_buffers *buffers) {
  Py_buffer *view = buffers->view;
  while (buffers->count)
    PyBuffer_Release(&view[--buffers->count]);
  free(buffers->view);
  buffers->view = NULL;
}

static bool unit(float v[3]) {
  float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int k = 0; k < 3; k++)
    v[k] /= length;
  return length > 1e-20f && length < 1e20f;
}

static bool parse_camera(parser *p, PyObject *description, scene *s) {
  static const char *const types[] = {"ORTHO", "PERSP", NULL};
  PyObject *dict;
  camera *c = &s->camera;
  double matrix[16];
  int type;
  if (!require(p, description, "camera", &dict))
    return false;
  if (!PyDict_Check(dict))
    return expected(p, "camera", "a dict");
  snprintf(p->path, sizeof p->path, "camera");
  if (!word(p, dict, "type", types, &type) || !numbers(p, dict, "matrix", 16, matrix) ||
      !floats(p, dict, "frame", 4, c->frame) || !floats(p, dict, "clip", 2, c->clip))
    return false;
  c->perspective = type == 1;
  for (int column = 0; column < 3; column++) {
    for (int row = 0; row < 3; row++)
      c->axis[column][row] = (float)matrix[4 * row + column];
    if (!unit(c->axis[column]))
      return expected(p, "matrix", "invertible");
  }
  for (int row = 0; row < 3; row++)
    c->origin[row] = (float)matrix[4 * row + 3];
  if (!(c->clip[0] >= 0 && c->clip[0] < c->clip[1])) /* Embree's rays begin at 0 or later */
    return expected(p, "clip", "two distances from 0 on, near before far");
  p->path[0] = 0;
  return true;
}

/* Two axes across v. */
static void across(const float v[3], float length, float axis[2][3]) {
  float sign = v[2] < 0 ? -1.0f : 1.0f, q = -1.0f / (sign + v[2]);
  const float a[3] = {1 + sign * v[0] * v[0] * q, sign * v[0] * v[1] * q, -sign * v[0]};
  const float b[3] = {v[0] * v[1] * q, sign + v[1] * v[1] * q, -v[1]};
  for (int k = 0; k < 3; k++) {
    axis[0][k] = length * a[k];
    axis[1][k] = length * b[k];
  }
}

static bool parse_point(parser *p, PyObject *dict, light *l) {
  return floats(p, dict, "intensity", 3, l->color) && floats(p, dict, "position", 3, l->vector) &&
         number_within(p, dict, "radius", 0, 1e18, &l->radius);
}

static bool parse_sun(parser *p, PyObject *dict, light *l) {
  float angle = 0;
  if (!floats(p, dict, "irradiance", 3, l->color) || !floats(p, dict, "direction", 3, l->vector) ||
      !number_within(p, dict, "angle", 0, 3.141592654, &angle))
    return false;
  if (!unit(l->vector))
    return expected(p, "direction", "a direction");
  l->radius = tanf(fminf(angle, 3.14f) / 2);
  across(l->vector, l->radius, l->axis);
  return true;
}

#define LIGHT_WORD(TYPE, name) #TYPE,
#define LIGHT_PARSER(TYPE, name) parse_##name,
static bool parse_light(parser *p, PyObject *dict, void *out, scene *s) {
  static const char *const types[] = {LIGHT_TABLE(LIGHT_WORD) NULL};
  static bool (*const parse[])(parser *, PyObject *, light *) = {LIGHT_TABLE(LIGHT_PARSER)};
  light *l = out;
  int type;
  (void)s;
  if (!word(p, dict, "type", types, &type) || !flag(p, dict, "shadow", &l->shadow))
    return false;
  l->type = (light_type)type;
  return parse[type](p, dict, l);
}

static bool parse_image(parser *p, PyObject *dict, void *out, scene *s) {
  static const char *const wraps[] = {"REPEAT", "EXTEND", "CLIP", NULL};
  static const char *const filters[] = {"LINEAR", "CLOSEST", NULL};
  image *m = out;
  int wrap, filter;
  const Py_buffer *data;
  (void)s;
  if (!integer(p, dict, "width", 1, MAX_SIZE, &m->width) ||
      !integer(p, dict, "height", 1, MAX_SIZE, &m->height) ||
      !integer(p, dict, "channels", 1, 4, &m->channels) || !flag(p, dict, "srgb", &m->srgb) ||
      !word(p, dict, "wrap", wraps, &wrap) || !word(p, dict, "filter", filters, &filter))
    return false;
  if ((size_t)(m->width + TEXTURE_RIM) * (size_t)(m->height + TEXTURE_RIM) > INT32_MAX)
    return fail(p, "the image has too many pixels");
  size_t count = (size_t)m->width * (size_t)m->height * (size_t)m->channels;
  if (!buffer(p, dict, "data", count, "fHB", 0, &data))
    return false;
  m->type = data->itemsize == 4 ? IMAGE_FLOAT32 : data->itemsize == 2 ? IMAGE_UINT16 : IMAGE_UINT8;
  m->data = data->buf;
  m->wrap = wrap == 0 ? WRAP_REPEAT : wrap == 1 ? WRAP_EXTEND : WRAP_CLIP;
  m->closest = filter == 1;
  return true;
}

static bool choice(const parser *p, PyObject *dict, shade_list list, int *out) {
  const char *key = shade_list_name(list);
  char *value, words[512] = "";
  const char *row_word;
  if (!text(p, dict, key, NULL, &value))
    return false;
  *out = shade_list_find(list, value);
  free(value);
  if (*out >= 0)
    return true;
  for (int row = 0; shade_list_row(list, row, NULL, &row_word, NULL, NULL); row++)
    snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", row ? ", " : "",
             row_word);
  return fail(p, "%s must be one of %s", key, words);
}

static bool image_index(const parser *p, PyObject *dict, const char *key, const scene *s,
                        int *out) {
  return integer(p, dict, key, -1, (long)s->images - 1, out);
}

/* The choices of the table. What came later than the first dumps may be
 * missing, and means what it does there. */
static bool parse_choices(const parser *p, PyObject *dict, shade_params *q) {
  shade_list_info info;
  for (int list = 0; shade_list_about((shade_list)list, &info); list++) {
    int value = info.older;
    if ((info.in_every_dump || find(dict, info.word)) && !choice(p, dict, (shade_list)list, &value))
      return false;
    shade_params_set_choice(q, (shade_list)list, value);
  }
  return true;
}

/* The numbers of the table, brought into their ranges: the dump shall say what is shaded. Of
 * exponents and alphas those count that the distribution reads; they set the others. */
static bool parse_numbers(const parser *p, PyObject *dict, shade_params *q, unsigned *status) {
  const unsigned mdf = (unsigned)q->mdf;
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++) {
    double v[3] = {0, 0, 0};
    if (!info.in_every_dump && !find(dict, info.word))
      continue;
    if (!(info.components == 1 ? number(p, dict, info.word, v)
                               : numbers(p, dict, info.word, info.components, v)))
      return false;
    if (info.list != SHADE_LIST_MDF || info.choices >> mdf & 1)
      *status |= shade_params_set(q, row, v);
  }
  return true;
}

static bool parse_material(parser *p, PyObject *dict, void *out, scene *s) {
  material *m = out;
  double strength;
  shade_params_init(&m->params);
  m->number = (int)(m - s->material);
  if (!text(p, dict, "name", NULL, &m->name) || !parse_choices(p, dict, &m->params) ||
      !parse_numbers(p, dict, &m->params, &m->status) ||
      !image_index(p, dict, "color_image", s, &m->color_image) ||
      !image_index(p, dict, "normal_image", s, &m->normal_image) ||
      !number(p, dict, "normal_strength", &strength))
    return false;
  m->normal_strength = (float)fmin(fmax(strength, 0.0), 1e6);
  m->status |= shade_bsdf_setup(&m->bsdf, &m->params);
  return true;
}

static bool all_below(size_t count, const uint32_t *index, size_t limit) {
  uint32_t largest = 0;
  for (size_t i = 0; i < count; i++)
    largest = index[i] > largest ? index[i] : largest;
  return count == 0 || largest < limit;
}

static bool parse_mesh(parser *p, PyObject *dict, void *out, scene *s) {
  mesh *m = out;
  char fallback[32];
  const Py_buffer *position, *corner, *normal, *uv = NULL, *material;
  snprintf(fallback, sizeof fallback, "mesh %td", m - s->mesh);
  if (!text(p, dict, "name", fallback, &m->name) ||
      !buffer(p, dict, "positions", SIZE_MAX, "f", 4, &position))
    return false;
  /* p->buffers->view may move with each call: take what is needed at once */
  m->position = position->buf;
  m->positions = (size_t)position->len / 12;
  if ((size_t)position->len != 12 * m->positions)
    return expected(p, "positions", "3 floats per position");
  if (!buffer(p, dict, "corner_position", SIZE_MAX, "iIlL", 4, &corner))
    return false;
  m->corner_position = corner->buf;
  m->triangles = (size_t)corner->len / 12;
  if ((size_t)corner->len != 12 * m->triangles)
    return expected(p, "corner_position", "3 indices per triangle");
  if (m->triangles > UINT32_MAX / 4 || m->positions > UINT32_MAX / 4)
    return fail(p, "the mesh has too many triangles");
  if (!buffer(p, dict, "corner_normals", 9 * m->triangles, "f", 4, &normal))
    return false;
  m->corner_normal = normal->buf;
  if (!buffer(p, dict, "material", m->triangles, "iIlL", 4, &material))
    return false;
  m->material = material->buf;
  PyObject *has_uv = find(dict, "corner_uvs");
  if (has_uv && has_uv != Py_None) {
    if (!buffer(p, dict, "corner_uvs", 6 * m->triangles, "f", 4, &uv))
      return false;
    m->corner_uv = uv->buf;
  }
  if (!all_below(3 * m->triangles, m->corner_position, m->positions))
    return fail(p, "corner_position has an index outside of the %zu positions", m->positions);
  if (!all_below(m->triangles, (const uint32_t *)m->material, s->materials))
    return fail(p, "material has an index outside of the %zu materials", s->materials);
  return true;
}

static bool parse_instance(parser *p, PyObject *dict, void *out, scene *s) {
  instance *in = out;
  double matrix[16];
  int index = 0;
  if (!integer(p, dict, "mesh", 0, (long)s->meshes - 1, &index) ||
      !numbers(p, dict, "matrix", 16, matrix))
    return false;
  in->mesh = (size_t)index;
  memcpy(in->matrix, matrix, sizeof in->matrix);
  return true;
}

static bool parse_picture(parser *p, PyObject *d, scene *s) {
  double region[4], seed;
  char *dump;
  if (!integer(p, d, "width", 1, MAX_SIZE, &s->width) ||
      !integer(p, d, "height", 1, MAX_SIZE, &s->height) || !numbers(p, d, "region", 4, region) ||
      !integer(p, d, "samples", 1, MAX_SAMPLES, &s->samples) || !number(p, d, "seed", &seed) ||
      !integer(p, d, "threads", 0, MAX_THREADS, &s->threads) ||
      !flag(p, d, "transparent", &s->transparent) ||
      !floats(p, d, "background", 3, s->background) || !text(p, d, "dump", "", &dump))
    return false;
  if (*dump)
    s->dump = dump;
  else
    free(dump);
  if (!text(p, d, "renderer", "libshade", &s->renderer))
    return false;
  if (find(d, "filter_width") && !number_within(p, d, "filter_width", 0, 100, &s->filter_width))
    return false;
  s->seed = (uint32_t)(int64_t)fmod(seed, 0x1p32);
  if (!s->threads)
    s->threads = parallel_cores();
  for (int k = 0; k < 4; k++) {
    int limit = k % 2 ? s->height : s->width;
    if (!(region[k] >= 0 && region[k] <= limit))
      return expected(p, "region", "x0, y0, x1, y1 inside of the picture");
    s->region[k] = (int)region[k];
  }
  if (s->region[0] >= s->region[2] || s->region[1] >= s->region[3])
    return fail(p, "region is empty");
  return true;
}

scene *parse_scene(void *description, parse_buffers *buffers) {
  PyObject *d = description;
  parser p = {.buffers = buffers};
  if (!PyDict_Check(d)) {
    fail(&p, "a dict is expected");
    return NULL;
  }
  scene *s = calloc(1, sizeof *s);
  if (!s) {
    PyErr_NoMemory();
    return NULL;
  }
  bool good = parse_picture(&p, d, s) && parse_camera(&p, d, s) &&
              each(&p, d, "lights", sizeof(light), &s->lights, &s->light, parse_light, s) &&
              each(&p, d, "images", sizeof(image), &s->images, &s->image, parse_image, s);
  /* indices into a list are checked against its full length */
  good =
      good &&
      each(&p, d, "materials", sizeof(material), &s->materials, &s->material, parse_material, s) &&
      each(&p, d, "meshes", sizeof(mesh), &s->meshes, &s->mesh, parse_mesh, s) &&
      each(&p, d, "instances", sizeof(instance), &s->instances, &s->instance, parse_instance, s);
  if (good)
    return s;
  scene_free(s);
  parse_release(buffers);
  return NULL;
}
