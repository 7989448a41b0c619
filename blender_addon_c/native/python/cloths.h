/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What Python may ask of libshade's cloths, weaves and yarns. New references; NULL, and Python's
 * error set, on failure. */
#ifndef LIBSHADE_PYTHON_CLOTHS_H
#define LIBSHADE_PYTHON_CLOTHS_H

#define Py_LIMITED_API 0x030b0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

/* Lists of dictionaries, for table(): cloths, weaves by name, and the numbers of a yarn, those of
 * its shape, then those of its material. */
PyObject *cloths_rows(void);
PyObject *cloths_weaves(void);
PyObject *cloths_yarns(void);

PyObject *native_cloth(PyObject *self, PyObject *word);
PyObject *native_cloth_albedo(PyObject *self, PyObject *word);
PyObject *native_cloth_images(PyObject *self, PyObject *description);
PyObject *native_wif(PyObject *self, PyObject *arguments);
extern const char cloth_doc[], cloth_albedo_doc[], cloth_images_doc[], wif_doc[];

#endif
