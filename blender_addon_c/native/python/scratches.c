/* SPDX-License-Identifier: GPL-3.0-or-later */
#define Py_LIMITED_API 0x030b0000
#include "python/scratches.h"

#include <string.h>

#include "python/reader.h"

enum { MOST_TEXELS = 16384, MOST_SAMPLES = 16, IMAGES = 3 };

const char native_scratches_doc[] =
    "scratches(description) -> {\"tile\": float, \"density\": float, \"fewer\": bool}\n\n"
    "Of a field of scratches as a scene has it: the side of the square that repeats, in metres;\n"
    "how many there are on a square centimetre; whether more were asked for.";
PyObject *native_scratches(PyObject *self, PyObject *description) {
  (void)self;
  scratches s = {0};
  if (!reader_scratches(description, &s))
    return NULL;
  return Py_BuildValue("{s:d,s:d,s:N}", "tile", s.tile, "density", s.density, "fewer",
                       PyBool_FromLong(s.fewer));
}

const char native_scratch_images_doc[] =
    "scratch_images(description, size, samples) -> (normal, height, mask)\n\n"
    "Pictures of a field's tile, size x size texels of four floats, rows from the bottom, each\n"
    "the mean of samples x samples points: normals, 0 to 1 for -1 to 1; heights in metres, 0 at\n"
    "the plate; how much is scratched, 0 to 1.";
PyObject *native_scratch_images(PyObject *self, PyObject *arguments) {
  (void)self;
  PyObject *description, *image[IMAGES] = {NULL};
  int size, samples;
  scratches s = {0};
  float *to[IMAGES];
  if (!PyArg_ParseTuple(arguments, "Oii", &description, &size, &samples))
    return NULL;
  if (size < 1 || size > MOST_TEXELS || samples < 1 || samples > MOST_SAMPLES)
    return PyErr_Format(PyExc_ValueError,
                        "scratch_images: a size of 1 to %d and 1 to %d samples are expected",
                        (int)MOST_TEXELS, (int)MOST_SAMPLES);
  if (!reader_scratches(description, &s))
    return NULL;
  bool good = true;
  for (int k = 0; good && k < IMAGES; k++) {
    image[k] = PyByteArray_FromStringAndSize(NULL, (Py_ssize_t)size * size * 16);
    good = image[k] != NULL;
    if (good)
      to[k] = (float *)(void *)PyByteArray_AsString(image[k]);
  }
  if (good) {
    Py_BEGIN_ALLOW_THREADS good = scratches_build(&s);
    if (good)
      scratches_picture(&s, size, samples, to[0], to[1], to[2]);
    scratches_free(&s);
    Py_END_ALLOW_THREADS if (!good) PyErr_NoMemory();
  }
  if (good)
    return Py_BuildValue("(NNN)", image[0], image[1], image[2]);
  for (int k = 0; k < IMAGES; k++)
    Py_XDECREF(image[k]);
  return NULL;
}
