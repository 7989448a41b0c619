/* SPDX-License-Identifier: GPL-3.0-or-later */
#define Py_LIMITED_API 0x030b0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "python/reader.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/read.h"

struct reader {
  PyObject *dict;
  char path[160]; /* where it is, for messages: meshes[2] */
  reader_buffers *buffers;
};

/* Every function below returns false with a Python exception set; its text says where. */
bool reader_fail(reader *r, const char *format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  PyErr_Format(PyExc_ValueError, "scene%s%s: %s", *r->path ? "." : "", r->path, text);
  return false;
}

/* Replace whatever exception a conversion raised by one that says where and what. */
bool reader_expected(reader *r, const char *key, const char *what) {
  PyErr_Clear();
  return reader_fail(r, "%s must be %s", key, what);
}

bool reader_out_of_memory(reader *r) {
  (void)r;
  PyErr_NoMemory();
  return false;
}

/* Borrowed; NULL without an exception when it is missing. */
static PyObject *find(reader *r, const char *key) {
  return PyDict_GetItemString(r->dict, key);
}

static bool require(reader *r, const char *key, PyObject **out) {
  *out = find(r, key);
  return *out || reader_fail(r, "%s is missing", key);
}

bool reader_has(reader *r, const char *key) {
  PyObject *value = find(r, key);
  return value && value != Py_None;
}

static bool as_number(PyObject *value, double *out) {
  *out = PyFloat_AsDouble(value);
  return !PyErr_Occurred() && isfinite(*out);
}

bool reader_number(reader *r, const char *key, double *out) {
  PyObject *value;
  if (!require(r, key, &value))
    return false;
  return as_number(value, out) || reader_expected(r, key, "a finite number");
}

bool reader_integer(reader *r, const char *key, long low, long high, int *out) {
  PyObject *value;
  if (!require(r, key, &value))
    return false;
  long number = PyLong_AsLong(value);
  if (PyErr_Occurred() || number < low || number > high) {
    char text[80];
    snprintf(text, sizeof text, "an integer from %ld to %ld", low, high);
    return reader_expected(r, key, text);
  }
  *out = (int)number;
  return true;
}

bool reader_flag(reader *r, const char *key, bool *out) {
  PyObject *value;
  if (!require(r, key, &value))
    return false;
  int truth = PyObject_IsTrue(value);
  *out = truth == 1;
  return truth >= 0 || reader_expected(r, key, "True or False");
}

bool reader_numbers(reader *r, const char *key, int count, double *out) {
  PyObject *value;
  char text[64];
  if (!require(r, key, &value))
    return false;
  snprintf(text, sizeof text, "a sequence of %d finite numbers", count);
  if (!PySequence_Check(value) || PySequence_Size(value) != count)
    return reader_expected(r, key, text);
  for (int i = 0; i < count; i++) {
    PyObject *item = PySequence_GetItem(value, i);
    bool good = item && as_number(item, &out[i]);
    Py_XDECREF(item);
    if (!good)
      return reader_expected(r, key, text);
  }
  return true;
}

static bool as_operand(PyObject *value, operand *out) {
  double number = 0;
  *out = (operand){.at = OPERAND_NUMBER};
  if (!PyTuple_Check(value) && !PyList_Check(value)) {
    if (!as_number(value, &number))
      return false;
    out->number = (float)number;
    return isfinite(out->number);
  }
  PyObject *index = PySequence_Size(value) == 1 ? PySequence_GetItem(value, 0) : NULL;
  long at = index ? PyLong_AsLong(index) : -1;
  Py_XDECREF(index);
  out->at = (int)at;
  return !PyErr_Occurred() && at >= 0 && at < REGISTERS;
}

bool reader_operands(reader *r, const char *key, int count, operand *out) {
  PyObject *value;
  char text[96];
  if (!require(r, key, &value))
    return false;
  snprintf(text, sizeof text, "%d operands: finite numbers, or registers (0) to (%d)", count,
           REGISTERS - 1);
  if (!PySequence_Check(value) || PySequence_Size(value) != count)
    return reader_expected(r, key, text);
  for (int i = 0; i < count; i++) {
    PyObject *item = PySequence_GetItem(value, i);
    bool good = item && as_operand(item, &out[i]);
    Py_XDECREF(item);
    if (!good)
      return reader_expected(r, key, text);
  }
  return true;
}

/* A copy of a string; `missing` stands for a missing key, NULL means that it is required. */
bool reader_text(reader *r, const char *key, const char *missing, char **out) {
  PyObject *value = find(r, key);
  const char *utf8 = missing;
  if (!value && !missing)
    return reader_fail(r, "%s is missing", key);
  if (value) {
    utf8 = PyUnicode_AsUTF8AndSize(value, NULL);
    if (!utf8)
      return reader_expected(r, key, "a string");
  }
  *out = malloc(strlen(utf8) + 1);
  if (!*out)
    return reader_out_of_memory(r);
  memcpy(*out, utf8, strlen(utf8) + 1);
  return true;
}

/* Hands a dictionary to `one`; `more` is its place within r's. */
static bool inside(reader *r, PyObject *dict, const char *more, reader_one *one, void *out,
                   void *context) {
  reader inner = {.dict = dict, .buffers = r->buffers};
  snprintf(inner.path, sizeof inner.path, "%.90s%s%.60s", r->path, *r->path ? "." : "", more);
  return PyDict_Check(dict) ? one(&inner, out, context) : reader_fail(&inner, "a dict is expected");
}

bool reader_dict(reader *r, const char *key, reader_one *one, void *out, void *context) {
  PyObject *dict;
  if (!require(r, key, &dict))
    return false;
  if (!PyDict_Check(dict))
    return reader_expected(r, key, "a dict");
  return inside(r, dict, key, one, out, context);
}

bool reader_each(reader *r, const char *key, size_t size, size_t *count, void *array_out,
                 reader_one *one, void *context) {
  PyObject *list;
  char place[64];
  if (!require(r, key, &list))
    return false;
  if (!PyList_Check(list) && !PyTuple_Check(list))
    return reader_expected(r, key, "a list");
  size_t length = (size_t)PySequence_Size(list);
  char *array = calloc(length + 1, size);
  if (!array)
    return reader_out_of_memory(r);
  memcpy(array_out, &array, sizeof array);
  for (*count = 0; *count < length;) {
    PyObject *item = PySequence_GetItem(list, (Py_ssize_t)*count);
    snprintf(place, sizeof place, "%s[%zu]", key, *count);
    /* counted first: what `one` allocates before it fails is freed with the scene */
    void *at = array + size * (*count)++;
    bool good = item && inside(r, item, place, one, at, context);
    Py_XDECREF(item); /* the list, or the buffer's owner, keeps what we read */
    if (!good)
      return false;
  }
  return true;
}

bool reader_items(reader *r, const char *key, size_t count, const char *formats, size_t item_size,
                  reader_buffer *out) {
  PyObject *value;
  if (!require(r, key, &value))
    return false;
  Py_buffer *view = realloc(r->buffers->view, (r->buffers->count + 1) * sizeof *view);
  if (!view)
    return reader_out_of_memory(r);
  r->buffers->view = view;
  view += r->buffers->count;
  if (PyObject_GetBuffer(value, view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0)
    return reader_expected(r, key, "a contiguous buffer");
  r->buffers->count++;
  const char *format = view->format ? view->format : "B";
  format += *format && strchr("@=<", *format) ? 1 : 0;
  size_t size = (size_t)view->itemsize;
  if (strlen(format) != 1 || !strchr(formats, *format) || (item_size && size != item_size))
    return reader_fail(r, "%s has items of format '%s'; one of '%s' with %zu bytes is expected",
                       key, view->format ? view->format : "B", formats, item_size);
  *out = (reader_buffer){.data = view->buf, .size = (size_t)view->len, .item_size = size};
  if (count != SIZE_MAX && out->size != count * size)
    return reader_fail(r, "%s has %zu items; %zu are expected", key, out->size / size, count);
  return true;
}

scene *reader_scene(void *description, reader_buffers *buffers) {
  reader r = {.dict = description, .buffers = buffers};
  if (!PyDict_Check(r.dict)) {
    reader_fail(&r, "a dict is expected");
    return NULL;
  }
  scene *s = scene_read(&r);
  if (!s)
    reader_release(buffers);
  return s;
}

bool reader_look(void *description, scene *s) {
  reader_buffers none = {0};
  reader r = {.dict = description, .buffers = &none};
  bool good = PyDict_Check(r.dict) ? scene_look(&r, s) : reader_fail(&r, "a dict is expected");
  reader_release(&none);
  return good;
}

bool reader_scratches(void *description, scratches *out) {
  reader r = {.dict = description};
  return PyDict_Check(r.dict) ? scratches_read(&r, out, NULL)
                              : reader_fail(&r, "a dict is expected");
}

bool reader_cloth(void *description, cloth *out) {
  reader r = {.dict = description};
  return PyDict_Check(r.dict) ? cloth_read(&r, out, NULL) : reader_fail(&r, "a dict is expected");
}

void reader_release(reader_buffers *buffers) {
  Py_buffer *view = buffers->view;
  while (buffers->count)
    PyBuffer_Release(&view[--buffers->count]);
  free(buffers->view);
  buffers->view = NULL;
}
