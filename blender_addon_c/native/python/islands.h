/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which parts of a mesh hang together. */
#ifndef LIBSHADE_PYTHON_ISLANDS_H
#define LIBSHADE_PYTHON_ISLANDS_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

extern const char native_roots_doc[];
PyObject *native_roots(PyObject *self, PyObject *arguments);

#endif
