/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "python/cloths.h"

#include <stdbool.h>

#include "python/reader.h"

enum { IMAGES = 3 };

/* Numbers of one direction that other renderers need beside the pictures. */
static PyObject *yarn_numbers(const shade_yarn_params *y, const shade_yarn *made) {
  return Py_BuildValue("{s:d,s:d,s:(ddd),s:(ddd),s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:d}", "along",
                       made->along, "across", made->across, "f0", made->f0[0], made->f0[1],
                       made->f0[2], "kd", made->kd[0], made->kd[1], made->kd[2], "fibre", y->fibre,
                       "share", y->width / (y->width + y->gap), "vary_brightness",
                       y->vary_brightness, "vary_tilt", y->vary_tilt, "along_brightness",
                       y->along_brightness, "along_tilt", y->along_tilt, "slub", y->slub,
                       "along_length", y->along_length, "fuzz", y->fuzz);
}

static PyObject *told(const cloth *c, int width, int height, PyObject *const image[IMAGES]) {
  const shade_fabric_params *p = &c->preset.fabric;
  shade_draft *own = c->draft ? NULL : shade_draft_named(c->preset.weave);
  const shade_draft *d = c->draft ? c->draft : own;
  PyObject *warp = yarn_numbers(&c->preset.yarns.warp, &p->warp);
  PyObject *weft = yarn_numbers(&c->preset.yarns.weft, &p->weft), *made = NULL;
  if (d && warp && weft)
    made = Py_BuildValue("{s:(ii),s:(ii),s:d,s:(dd),s:O,s:O,s:(ddd),s:(ddd),s:O,s:O,s:O}", "repeat",
                         d->ends, d->picks, "size", width, height, "lit", cloth_lit(c), "per_unit",
                         (double)c->per_u, (double)c->per_v, "warp", warp, "weft", weft, "backing",
                         p->backing[0], p->backing[1], p->backing[2], "nap_color", p->nap_color[0],
                         p->nap_color[1], p->nap_color[2], "tilt", image[0], "yarns", image[1],
                         "tint", image[2]);
  else if (!PyErr_Occurred())
    PyErr_NoMemory();
  Py_XDECREF(warp);
  Py_XDECREF(weft);
  shade_draft_free(own);
  return made;
}

const char cloth_images_doc[] =
    "cloth_images(description) -> dict\n\n"
    "Of a cloth as a scene has it, for renderers that know no yarns: pictures of one repeat\n"
    "(tilt, yarns, tint or None: bytearrays of four floats a texel, rows from the bottom, as\n"
    "cloth_picture in scene/cloth.h says), their size (width, height), the repeat (ends, picks),\n"
    "crossings per_unit of the UV map (u, v), lit, what yarns leave one another of even light,\n"
    "backing, nap_color, and of warp and weft the\n"
    "numbers of their material and of what varies.";
PyObject *native_cloth_images(PyObject *self, PyObject *description) {
  (void)self;
  PyObject *image[IMAGES] = {NULL}, *made = NULL;
  float *to[IMAGES] = {NULL};
  cloth c = {0};
  int width = 0, height = 0;
  bool tinted = false, good = reader_cloth(description, &c);
  if (good && !cloth_texels(&c, &width, &height, &tinted)) {
    PyErr_NoMemory();
    good = false;
  }
  for (int k = 0; good && k < IMAGES; k++) {
    if (k == IMAGES - 1 && !tinted) {
      image[k] = Py_NewRef(Py_None);
      continue;
    }
    image[k] = PyByteArray_FromStringAndSize(NULL, (Py_ssize_t)width * height * 16);
    good = image[k] != NULL;
    if (good)
      to[k] = (float *)(void *)PyByteArray_AsString(image[k]);
  }
  if (good) {
    Py_BEGIN_ALLOW_THREADS good = cloth_picture(&c, width, height, to[0], to[1], to[2]);
    Py_END_ALLOW_THREADS if (!good) PyErr_NoMemory();
  }
  if (good)
    made = told(&c, width, height, image);
  for (int k = 0; k < IMAGES; k++)
    Py_XDECREF(image[k]);
  cloth_free(&c);
  return made;
}
