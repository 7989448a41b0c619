/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "python/cloths.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "scene/cloth.h"
#include "shade/presets.h"

/* Append a new reference, which is taken over; false on any failure. */
static bool append(PyObject *list, PyObject *item) {
  bool good = item && PyList_Append(list, item) == 0;
  Py_XDECREF(item);
  return good;
}

/* The same of a dictionary. */
static bool put(PyObject *dict, const char *key, PyObject *item) {
  bool good = item && PyDict_SetItemString(dict, key, item) == 0;
  Py_XDECREF(item);
  return good;
}

static PyObject *done(PyObject *made, bool good) {
  if (good)
    return made;
  Py_XDECREF(made);
  return NULL;
}

/* Where the weft is on top, as a share of all crossings; half where that is not known. */
static double weft_share(const shade_draft *d) {
  if (!d)
    return 0.5;
  size_t cells = (size_t)d->ends * (size_t)d->picks, warp = 0;
  for (size_t k = 0; k < cells; k++)
    warp += d->warp_up[k] != 0;
  return 1.0 - (double)warp / (double)cells;
}

static double weft_share_of(const char *weave) {
  shade_draft *d = shade_draft_named(weave);
  double share = weft_share(d);
  shade_draft_free(d);
  return share;
}

PyObject *cloths_rows(void) {
  PyObject *rows = PyList_New(0);
  bool good = rows != NULL;
  shade_preset p;
  for (int row = 0; good && shade_preset_row(row, &p); row++) {
    if (p.kind != SHADE_PRESET_FABRIC)
      continue;
    const shade_yarn *warp = &p.fabric.warp, *weft = &p.fabric.weft;
    double exponent = (warp->along + warp->across + weft->along + weft->across) / 4;
    good = append(rows, Py_BuildValue("{s:s,s:s,s:s,s:(ddd),s:(ddd),s:d,s:d,s:d}", "word", p.word,
                                      "label", p.label, "help", p.help, "warp", warp->kd[0],
                                      warp->kd[1], warp->kd[2], "weft", weft->kd[0], weft->kd[1],
                                      weft->kd[2], "nap", p.fabric.nap, "exponent", exponent,
                                      "weft_share", weft_share_of(p.weave)));
  }
  return done(rows, good);
}

PyObject *cloths_weaves(void) {
  PyObject *rows = PyList_New(0);
  bool good = rows != NULL;
  const char *word, *label, *help;
  for (int row = 0; good && shade_weave_row(row, &word, &label, &help); row++)
    good = append(rows, Py_BuildValue("{s:s,s:s,s:s,s:d}", "word", word, "label", label, "help",
                                      help, "weft_share", weft_share_of(word)));
  return done(rows, good);
}

static PyObject *number_row(const shade_param_info *info) {
  return Py_BuildValue("{s:s,s:s,s:s,s:d,s:d,s:d}", "word", info->word, "unit", info->unit, "help",
                       info->help, "minimum", info->minimum, "maximum", info->maximum, "initial",
                       info->initial);
}

PyObject *cloths_yarns(void) {
  PyObject *rows = PyList_New(0);
  bool good = rows != NULL;
  shade_param_info info;
  shade_yarn yarn = {0};
  for (int row = 0; good && shade_yarn_param_row(row, &info); row++)
    good = append(rows, number_row(&info));
  for (int row = 0; good && shade_fabric_yarn_number(&yarn, row, &info); row++)
    if (info.components == 1)
      good = append(rows, number_row(&info));
  return done(rows, good);
}

static bool find(PyObject *argument, shade_preset *p) {
  const char *word = PyUnicode_AsUTF8AndSize(argument, NULL);
  if (word && (!shade_preset_find(word, p) || p->kind != SHADE_PRESET_FABRIC)) {
    PyErr_Format(PyExc_ValueError, "no cloth '%s'", word);
    return false;
  }
  return word != NULL;
}

/* What shade_weave_params_set_twist makes a slant of: radians to the yarn's axis, S above 0. */
static double twist_of(const shade_yarn_params *yarn, const shade_yarn_params *other, bool warp) {
  double crossing = other->width + other->gap, slant = warp ? -yarn->slant : yarn->slant;
  if (!(yarn->segments > 0) || slant == 0)
    return 0;
  return copysign(atan2(yarn->width, 2 * crossing * fabs(slant)), slant);
}

static PyObject *yarn_numbers(shade_preset *p, bool warp) {
  shade_yarn_params *shape = warp ? &p->yarns.warp : &p->yarns.weft;
  const shade_yarn_params *other = warp ? &p->yarns.weft : &p->yarns.warp;
  PyObject *made = PyDict_New();
  bool good = made != NULL;
  shade_param_info info;
  for (int row = 0; good && shade_yarn_param_row(row, &info); row++)
    good = put(made, info.word, PyFloat_FromDouble(*shade_yarn_param(shape, info.word)));
  double *number;
  for (int row = 0;
       good &&
       (number = shade_fabric_yarn_number(warp ? &p->fabric.warp : &p->fabric.weft, row, &info));
       row++)
    if (info.components == 1)
      good = put(made, info.word, PyFloat_FromDouble(*number));
  good = good && put(made, "twist", PyFloat_FromDouble(twist_of(shape, other, warp)));
  return done(made, good);
}

const char cloth_doc[] =
    "cloth(word) -> dict\n\n"
    "The numbers of a cloth of libshade's: weave, counts (ends and picks per cm), and of its\n"
    "warp and weft the numbers of table()['yarns'] and twist, the angle of the strands to the\n"
    "yarn's axis in radians, S above 0, Z below.";
PyObject *native_cloth(PyObject *self, PyObject *argument) {
  shade_preset p;
  (void)self;
  if (!find(argument, &p))
    return NULL;
  PyObject *warp = yarn_numbers(&p, true), *weft = yarn_numbers(&p, false);
  if (warp && weft)
    return Py_BuildValue("{s:s,s:(dd),s:N,s:N}", "weave", p.weave, "counts", p.ends_per_cm,
                         p.picks_per_cm, "warp", warp, "weft", weft);
  Py_XDECREF(warp);
  Py_XDECREF(weft);
  return NULL;
}

const char cloth_albedo_doc[] =
    "cloth_albedo(word) -> (r, g, b)\n\n"
    "How much of even light a cloth of libshade's reflects towards an eye above it, seen\n"
    "from afar.";
PyObject *native_cloth_albedo(PyObject *self, PyObject *argument) {
  shade_preset p;
  const double above[3] = {0, 0, 1};
  double rgb[3];
  (void)self;
  if (!find(argument, &p))
    return NULL;
  shade_weave *weave = NULL;
  shade_fabric *fabric = shade_preset_fabric(&p, &weave, NULL);
  const bool good = fabric && shade_fabric_albedo_towards(fabric, above, rgb) == SHADE_OK;
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  return !good ? PyErr_NoMemory() : Py_BuildValue("(ddd)", rgb[0], rgb[1], rgb[2]);
}

const char wif_doc[] =
    "wif(bytes, name, counts=(1, 1)) -> dict\n\n"
    "What a Weaving Information File says: ends, picks (of a repeat), weft_share, colored,\n"
    "mended (a message, or empty), counts (per cm, of a cloth that has had those of `counts`),\n"
    "sett (what they follow: spacing, thickness or even), and widths ((width, gap) of warp and of\n"
    "weft) where it states them, else None. ValueError: it is none; the message has the name, the\n"
    "line and what was expected.";
PyObject *native_wif(PyObject *self, PyObject *arguments) {
  const char *text, *name;
  Py_ssize_t length;
  char message[512];
  (void)self;
  static const char *const by[] = {"spacing", "thickness", "even"};
  double counts[2] = {1, 1};
  if (!PyArg_ParseTuple(arguments, "y#s|(dd):wif", &text, &length, &name, &counts[0], &counts[1]))
    return NULL;
  shade_draft *d = shade_wif_parse(text, (size_t)length, name, message, sizeof message);
  PyObject *told = PyUnicode_DecodeUTF8(message, (Py_ssize_t)strlen(message), "replace");
  if (!d || !told) {
    if (told && !d)
      PyErr_SetObject(PyExc_ValueError, told);
    Py_XDECREF(told);
    shade_draft_free(d);
    return NULL;
  }
  shade_weave_params p;
  shade_weave_params_init(&p);
  const shade_sett sett = shade_draft_sett(d, counts);
  PyObject *widths =
      shade_weave_params_from_draft(&p, d)
          ? Py_BuildValue("((dd)(dd))", p.warp.width, p.warp.gap, p.weft.width, p.weft.gap)
          : Py_NewRef(Py_None);
  PyObject *made =
      widths ? Py_BuildValue("{s:i,s:i,s:d,s:O,s:O,s:(dd),s:s,s:O}", "ends", d->ends, "picks",
                             d->picks, "weft_share", weft_share(d), "colored",
                             cloth_draft_tinted(d) ? Py_True : Py_False, "mended", told, "counts",
                             counts[0], counts[1], "sett", by[sett], "widths", widths)
             : NULL;
  Py_XDECREF(widths);
  Py_DECREF(told);
  shade_draft_free(d);
  return made;
}
