/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of scratches by themselves: how large their tile is, and pictures of it. */
#ifndef LIBSHADE_PYTHON_SCRATCHES_H
#define LIBSHADE_PYTHON_SCRATCHES_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

extern const char native_scratches_doc[], native_scratch_images_doc[];
PyObject *native_scratches(PyObject *self, PyObject *description);
PyObject *native_scratch_images(PyObject *self, PyObject *arguments);

#endif
