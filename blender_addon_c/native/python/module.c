/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Python module. Only the stable ABI of CPython 3.11: one binary for all newer versions. */
#define Py_LIMITED_API 0x030b0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stage/stage.h"
#include "render/build.h"
#include "render/job.h"
#include "render/relief.h"
#include "system/memory.h"
#include "python/cloths.h"
#include "python/islands.h"
#include "python/reader.h"
#include "python/scratches.h"

#define CAPSULE "libshade.job"

/* What a capsule holds. free() empties it, so that later calls fail instead of crash. */
typedef struct handle {
  job *job;
  reader_buffers buffers;
  int waiters; /* threads inside wait(): free() must not pull the job from under them */
  struct handle *next;
} handle;

/* Jobs that are not freed yet, for the end of the process. Guarded by the GIL. */
static handle *live;

static void handle_clear(handle *h) {
  job *j = h->job;
  h->job = NULL;
  if (!j)
    return;
  job_cancel(j);
  Py_BEGIN_ALLOW_THREADS job_wait(j, -1);
  Py_END_ALLOW_THREADS while (h->waiters) { /* they only need the GIL to leave */
    Py_BEGIN_ALLOW_THREADS job_wait(j, -1);
    Py_END_ALLOW_THREADS
  }
  job_free(j);
  reader_release(&h->buffers);
}

static void handle_destroy(PyObject *capsule) {
  handle *h = PyCapsule_GetPointer(capsule, CAPSULE);
  handle_clear(h);
  for (handle **at = &live; *at; at = &(*at)->next)
    if (*at == h) {
      *at = h->next;
      break;
    }
  free(h);
}

/* Threads that still render must end before the libraries they run in do. */
static void finish_all(void) {
  for (handle *h = live; h; h = h->next)
    if (h->job) {
      job_cancel(h->job);
      job_wait(h->job, -1);
    }
}

static handle *get_handle(PyObject *capsule) {
  handle *h = PyCapsule_GetPointer(capsule, CAPSULE);
  if (h && !h->job) {
    PyErr_SetString(PyExc_ValueError, "this job was freed");
    return NULL;
  }
  return h;
}

/* A capsule of a job for this scene, if it is one; both are taken over. */
static PyObject *begin(scene *s, handle *h) {
  if (s && !(h->job = job_start(s))) {
    PyErr_NoMemory();
    reader_release(&h->buffers);
  }
  PyObject *capsule = h->job ? PyCapsule_New(h, CAPSULE, handle_destroy) : NULL;
  if (!capsule) {
    handle_clear(h);
    free(h);
    return NULL;
  }
  h->next = live;
  live = h;
  return capsule;
}

/* Ends what a job does, without the GIL. */
static void stop(job *j) {
  job_cancel(j);
  Py_BEGIN_ALLOW_THREADS job_wait(j, -1);
  Py_END_ALLOW_THREADS
}

PyDoc_STRVAR(start_doc,
             "start(scene: dict, before=None) -> job\n\n"
             "Begin to render on threads of its own and return at once. Buffers in the\n"
             "scene are read until free(job); do not change them. before: a job that is\n"
             "cancelled; where both scenes say 'apart' the new one uses what it has built:\n"
             "the BVH where all meshes' buffers are the same, textures of the same images.\n"
             "ValueError: the scene is malformed; the message says where.");
static PyObject *native_start(PyObject *self, PyObject *arguments) {
  PyObject *description, *before = Py_None;
  (void)self;
  if (!PyArg_ParseTuple(arguments, "O|O:start", &description, &before))
    return NULL;
  handle *old = before != Py_None ? get_handle(before) : NULL, *h = NULL;
  if (PyErr_Occurred())
    return NULL;
  if (!(h = calloc(1, sizeof *h)))
    return PyErr_NoMemory();
  scene *s = reader_scene(description, &h->buffers);
  if (s && old) {
    stop(old->job);
    scene_take(s, old->job->scene);
  }
  return begin(s, h);
}

PyDoc_STRVAR(look_doc,
             "look(job, view: dict) -> job or None\n\n"
             "Another picture of a job's scene: width, height, region, samples and camera,\n"
             "as of start(), for its own. The job is cancelled, and free from then on; None\n"
             "where its scene was not built: it has to be started again.");
static PyObject *native_look(PyObject *self, PyObject *arguments) {
  PyObject *before, *view;
  (void)self;
  if (!PyArg_ParseTuple(arguments, "OO:look", &before, &view))
    return NULL;
  handle *old = get_handle(before), *h = NULL;
  if (!old)
    return NULL;
  stop(old->job);
  if (!old->job->scene->built || old->waiters)
    return Py_NewRef(Py_None);
  if (!reader_look(view, old->job->scene))
    return NULL;
  if (!(h = calloc(1, sizeof *h)))
    return PyErr_NoMemory();
  h->buffers = old->buffers;
  old->buffers = (reader_buffers){0};
  scene *s = job_leave(old->job);
  old->job = NULL;
  return begin(s, h);
}

PyDoc_STRVAR(poll_doc,
             "poll(job) -> dict\n\n"
             "state (running, done, cancelled, failed), progress (0 to 1), sample\n"
             "(how many of the samples all pixels have, in the mean), samples, stage\n"
             "(build, render, denoise, dump), message (of a failure), warnings (list of str),\n"
             "memory, memory_peak (bytes that the module holds, for all jobs, and the most since\n"
             "the last one was started).");
static PyObject *native_poll(PyObject *self, PyObject *capsule) {
  static const char *const states[] = {"running", "done", "cancelled", "failed"};
  static const char *const stages[] = {"build", "render", "denoise", "dump"};
  (void)self;
  handle *h = get_handle(capsule);
  if (!h)
    return NULL;
  job *j = h->job;
  PyObject *warnings = PyList_New(0);
  if (!warnings)
    return NULL;
  pthread_mutex_lock(&j->log.lock);
  for (size_t i = 0; i < j->log.warnings && i < MESSAGE_WARNINGS; i++) {
    const char *utf8 = j->log.warning[i] ? j->log.warning[i] : "out of memory";
    PyObject *text = PyUnicode_DecodeUTF8(utf8, (Py_ssize_t)strlen(utf8), "replace");
    if (text)
      PyList_Append(warnings, text);
    Py_XDECREF(text);
  }
  char message[MESSAGE_SIZE];
  memcpy(message, j->log.error, sizeof message);
  pthread_mutex_unlock(&j->log.lock);
  double progress = job_progress(j);
  return Py_BuildValue("{s:s,s:d,s:i,s:i,s:s,s:s,s:N,s:L,s:L}", "state", states[job_get_state(j)],
                       "progress", progress, "sample", (int)(progress * j->scene->samples),
                       "samples", j->scene->samples, "stage", stages[atomic_load(&j->stage)],
                       "message", message, "warnings", warnings, "memory", memory_used(),
                       "memory_peak", memory_peak());
}

PyDoc_STRVAR(wait_doc, "wait(job, seconds: float) -> bool\n\n"
                       "True when the job has finished, at the latest after this time. Other\n"
                       "Python threads run meanwhile.");
static PyObject *native_wait(PyObject *self, PyObject *arguments) {
  PyObject *capsule;
  double seconds;
  (void)self;
  if (!PyArg_ParseTuple(arguments, "Od:wait", &capsule, &seconds))
    return NULL;
  handle *h = get_handle(capsule);
  if (!h)
    return NULL;
  job *j = h->job;
  bool finished;
  h->waiters++;
  Py_BEGIN_ALLOW_THREADS finished = job_wait(j, seconds > 0 ? seconds : 0);
  Py_END_ALLOW_THREADS h->waiters--;
  return PyBool_FromLong(finished);
}

PyDoc_STRVAR(cancel_doc, "cancel(job)\n\nAsk the job to stop; returns at once.");
static PyObject *native_cancel(PyObject *self, PyObject *capsule) {
  (void)self;
  handle *h = get_handle(capsule);
  if (!h)
    return NULL;
  job_cancel(h->job);
  Py_RETURN_NONE;
}

PyDoc_STRVAR(image_doc, "image(job, out, plane='', over=False)\n\n"
                        "Copy the picture so far into a writable float32 buffer of 4 floats a\n"
                        "pixel of the region: linear, alpha premultiplied, bottom row first. Or a\n"
                        "plane that the scene asked for, of as many floats a pixel as it has; or\n"
                        "NOISY, the picture as it was before it was denoised; or OBJECT_MATTE00,\n"
                        "…, MATERIAL_MATTE00, …, ASSET_MATTE00, …: two slots of names each.\n"
                        "over: what the picture does not show yet stays as it is in the buffer.");

static PyObject *native_image(PyObject *self, PyObject *arguments) {
  PyObject *capsule, *out;
  const char *word = "";
  Py_buffer view;
  (void)self;
  int over = 0;
  if (!PyArg_ParseTuple(arguments, "OO|sp:image", &capsule, &out, &word, &over))
    return NULL;
  handle *h = get_handle(capsule);
  if (!h)
    return NULL;
  render *r = &h->job->render;
  int channels = render_channels(r, word);
  if (!channels)
    return PyErr_Format(PyExc_ValueError, "image: the scene did not ask for a plane '%s'", word);
  Py_ssize_t width = r->region[2] - r->region[0], height = r->region[3] - r->region[1];
  Py_ssize_t count = width * height * channels;
  if (PyObject_GetBuffer(out, &view, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE | PyBUF_FORMAT) != 0)
    return NULL;
  const char *format = view.format ? view.format : "B";
  format += *format && strchr("@=<", *format) ? 1 : 0;
  if (strcmp(format, "f") != 0 || view.len != count * (Py_ssize_t)sizeof(float)) {
    PyErr_Format(PyExc_ValueError, "image: a buffer of %zd float32 is expected", count);
    PyBuffer_Release(&view);
    return NULL;
  }
  if (over && !*word)
    render_copy_over(r, view.buf);
  else
    render_copy_word(r, word, view.buf);
  PyBuffer_Release(&view);
  Py_RETURN_NONE;
}

PyDoc_STRVAR(timings_doc,
             "timings(job) -> dict\n\n"
             "Seconds: wall, image (packing), mesh (tangents, world space), bvh; and summed over\n"
             "threads camera, hit, surface, shadow, reflect, film and, for each type, a\n"
             "node_, a light_ and a closure_, sky, emitters and choice. samples: their number. "
             "Complete once the "
             "job has finished.");
static PyObject *native_timings(PyObject *self, PyObject *capsule) {
  (void)self;
  handle *h = get_handle(capsule);
  if (!h)
    return NULL;
  const job *j = h->job;
  bool finished = job_get_state(h->job) != JOB_RUNNING;
  const render *r = &j->render;
  double pixels = (double)(r->region[2] - r->region[0]) * (double)(r->region[3] - r->region[1]);
  PyObject *result = PyDict_New();
  if (!result)
    return NULL;
  const char *name[4 + CLOCKS + 1] = {"wall", "image", "mesh", "bvh", CLOCK_WORDS};
  double value[4 + CLOCKS + 1] = {0};
  if (finished) {
    value[0] = j->wall;
    value[1] = j->times.image;
    value[2] = j->times.mesh;
    value[3] = j->times.bvh;
  }
  for (int k = 0; k < CLOCKS; k++)
    value[4 + k] = finished ? r->seconds[k] : 0.0;
  name[4 + CLOCKS] = "samples";
  value[4 + CLOCKS] = pixels * (double)j->scene->samples - (double)atomic_load(&r->spared);
  for (int k = 0; k < 4 + CLOCKS + 1; k++) {
    PyObject *number = PyFloat_FromDouble(value[k]);
    if (!number || PyDict_SetItemString(result, name[k], number) != 0) {
      Py_XDECREF(number);
      Py_DECREF(result);
      return NULL;
    }
    Py_DECREF(number);
  }
  return result;
}

/* Append a new reference, which is taken over; false on any failure. */
static bool append(PyObject *list, PyObject *item) {
  bool good = item && PyList_Append(list, item) == 0;
  Py_XDECREF(item);
  return good;
}

PyDoc_STRVAR(slopes_doc,
             "slopes(job) -> list of (material, x, y, xx, xy, yy)\n\n"
             "How steep the bumps of each material are that shade and light each other: the\n"
             "mean slope, and the second moment about it. Empty until the job has finished.");
static PyObject *native_slopes(PyObject *self, PyObject *capsule) {
  (void)self;
  handle *h = get_handle(capsule);
  if (!h)
    return NULL;
  const scene *s = h->job->scene;
  const size_t materials = job_get_state(h->job) != JOB_RUNNING && s->built ? s->materials : 0;
  PyObject *all = PyList_New(0);
  double v[5];
  for (size_t k = 0; all && k < materials; k++)
    if (relief_told(&s->material[k], v) &&
        !append(all, Py_BuildValue("(nddddd)", (Py_ssize_t)k, v[0], v[1], v[2], v[3], v[4])))
      Py_CLEAR(all);
  return all;
}

PyDoc_STRVAR(free_doc, "free(job)\n\n"
                       "Cancel, wait for the threads, release all memory. Later calls with this\n"
                       "job raise ValueError. Dropping the job does the same.");
static PyObject *native_free(PyObject *self, PyObject *capsule) {
  (void)self;
  handle *h = PyCapsule_GetPointer(capsule, CAPSULE);
  if (!h)
    return NULL;
  handle_clear(h);
  Py_RETURN_NONE;
}

/* A new list of words; NULL on failure. */
static PyObject *words_of(const char *const *word, size_t count) {
  PyObject *words = PyList_New(0);
  bool good = words != NULL;
  for (size_t k = 0; good && k < count; k++)
    good = append(words, PyUnicode_FromString(word[k]));
  if (good)
    return words;
  Py_XDECREF(words);
  return NULL;
}

#define LIGHT_WORD(TYPE, name) #TYPE,
#define CLOSURE_WORD(TYPE, name, always) #TYPE,
#define NODE_WORD(TYPE, name) #TYPE,
PyDoc_STRVAR(
    table_doc,
    "table() -> dict\n\n"
    "lists: the choices by name; about: what each list chooses, and its default;\n"
    "params: the numbers of a material, and by which choices they are read: None, or\n"
    "(list, words). All as in libshade's table. lights, closures, nodes: the types of\n"
    "each that a scene may have. cloths: libshade's, with the mean exponent of their yarns\n"
    "and the share of crossings where the weft is on top; weaves: by name, with that share;\n"
    "yarns: the numbers of a yarn. metals: libshade's; the strokes of\n"
    "turned ones lie round the middle of the part. measured: metals by eta and k at red, green\n"
    "and blue.");

/* A new reference: None where every choice reads the number. */
static PyObject *read_by(const shade_param_info *info) {
  PyObject *words = PyList_New(0);
  const char *word;
  int value;
  bool good = words && info->list != SHADE_LIST_COUNT;
  for (int row = 0; good && shade_list_row(info->list, row, &value, &word, NULL, NULL); row++)
    if (info->choices >> value & 1)
      good = append(words, PyUnicode_FromString(word));
  if (good)
    return Py_BuildValue("(sN)", shade_list_name(info->list), words);
  Py_XDECREF(words);
  return info->list == SHADE_LIST_COUNT ? Py_NewRef(Py_None) : NULL;
}

/* A new reference. */
static PyObject *metal_rows(void) {
  PyObject *rows = PyList_New(0);
  bool good = rows != NULL;
  shade_preset p;
  for (int row = 0; good && shade_preset_row(row, &p); row++)
    if (p.kind == SHADE_PRESET_METAL)
      good = append(rows, Py_BuildValue("{s:s,s:s,s:s,s:N}", "word", p.word, "label", p.label,
                                        "help", p.help, "turned", PyBool_FromLong(p.turned)));
  if (good)
    return rows;
  Py_XDECREF(rows);
  return NULL;
}

/* A metal's lobe with the slopes of all its scratches in it, as it is seen from afar. */
static bool metal_from_afar(const shade_preset *p, shade_params *to) {
  shade_scratch_params fewer = p->scratches;
  shade_slopes slopes;
  double angle;
  fewer.cells = 64; /* their mean over the tile is all that is asked */
  shade_scratch_field *field = shade_scratch_create(&fewer, NULL);
  if (!field)
    return false;
  shade_scratch_eval(field, 0.5, 0.5, (double[]){1, 0, 0, 1}, NULL, &slopes);
  shade_scratch_free(field);
  /* strokes lie along the tangent, or any way: no lobe is turned */
  slopes.covariance[1] = 0;
  shade_params_widen(&p->metal, (double[]){0, 0, 1}, slopes.covariance, to, &angle);
  return true;
}

PyDoc_STRVAR(metal_doc,
             "metal(word) -> dict\n\n"
             "The settings of a metal of libshade's, by the words of table(): choices as\n"
             "words, numbers as floats or triples. Its scratches are in its roughness, as\n"
             "they are from afar. Takes some milliseconds.");
static PyObject *native_metal(PyObject *self, PyObject *argument) {
  (void)self;
  const char *word = PyUnicode_AsUTF8AndSize(argument, NULL);
  shade_preset p;
  shade_params metal;
  if (!word)
    return NULL;
  if (!shade_preset_find(word, &p) || p.kind != SHADE_PRESET_METAL)
    return PyErr_Format(PyExc_ValueError, "no metal '%s'", word);
  if (!metal_from_afar(&p, &metal))
    return PyErr_NoMemory();
  PyObject *all = PyDict_New();
  bool good = all != NULL;
  shade_list_info list;
  for (int k = 0; good && shade_list_about((shade_list)k, &list); k++) {
    const int value = shade_params_get_choice(&metal, (shade_list)k);
    PyObject *chosen = PyUnicode_FromString(shade_list_word((shade_list)k, value));
    good = chosen && PyDict_SetItemString(all, list.word, chosen) == 0;
    Py_XDECREF(chosen);
  }
  shade_param_info info;
  for (int row = 0; good && shade_param_row(row, &info); row++) {
    double v[3] = {0, 0, 0};
    shade_params_get(&metal, row, v);
    PyObject *number =
        info.components == 1 ? PyFloat_FromDouble(v[0]) : Py_BuildValue("(ddd)", v[0], v[1], v[2]);
    good = number && PyDict_SetItemString(all, info.word, number) == 0;
    Py_XDECREF(number);
  }
  if (good)
    return all;
  Py_XDECREF(all);
  return NULL;
}

static PyObject *measured_rows(void) {
  PyObject *rows = PyList_New(0);
  bool good = rows != NULL;
  shade_metal m;
  for (int row = 0; good && shade_metal_row(row, &m); row++)
    good = append(rows,
                  Py_BuildValue("{s:s,s:s,s:(ddd),s:(ddd)}", "word", m.word, "label", m.label,
                                "eta", m.eta[0], m.eta[1], m.eta[2], "k", m.k[0], m.k[1], m.k[2]));
  if (good)
    return rows;
  Py_XDECREF(rows);
  return NULL;
}

static PyObject *native_table(PyObject *self, PyObject *unused) {
  (void)self, (void)unused;
  PyObject *lists = PyDict_New(), *about = PyDict_New(), *params = PyList_New(0);
  bool good = lists && about && params;
  shade_list_info list_info;
  for (int list = 0; good && shade_list_about((shade_list)list, &list_info); list++) {
    PyObject *rows = PyList_New(0);
    int value;
    const char *name, *label, *help;
    good = rows != NULL;
    for (int row = 0; good && shade_list_row((shade_list)list, row, &value, &name, &label, &help);
         row++)
      good = append(rows, Py_BuildValue("{s:i,s:s,s:s,s:s}", "value", value, "word", name, "label",
                                        label, "help", help));
    good = good && PyDict_SetItemString(lists, list_info.word, rows) == 0;
    Py_XDECREF(rows);
    PyObject *told =
        Py_BuildValue("{s:s,s:s,s:s}", "help", list_info.help, "initial",
                      shade_list_word((shade_list)list, list_info.initial), "first",
                      shade_list_word((shade_list)list, shade_list_default((shade_list)list, 0)));
    good = good && told && PyDict_SetItemString(about, list_info.word, told) == 0;
    Py_XDECREF(told);
  }
  shade_param_info info;
  for (int row = 0; good && shade_param_row(row, &info); row++)
    good =
        append(params, Py_BuildValue("{s:s,s:s,s:s,s:i,s:d,s:d,s:d,s:N}", "word", info.word, "unit",
                                     info.unit, "help", info.help, "components", info.components,
                                     "minimum", info.minimum, "maximum", info.maximum, "initial",
                                     info.initial, "read_by", read_by(&info)));
  static const char *const light_words[] = {LIGHT_TABLE(LIGHT_WORD)};
  static const char *const closure_words[] = {CLOSURE_TABLE(CLOSURE_WORD)};
  static const char *const node_words[] = {NODE_TABLE(NODE_WORD)};
  PyObject *lights = words_of(light_words, LIGHT_TYPES);
  PyObject *closures = words_of(closure_words, CLOSURE_TYPES);
  PyObject *nodes = words_of(node_words, NODE_TYPES);
  PyObject *cloths = cloths_rows(), *weaves = cloths_weaves(), *yarns = cloths_yarns();
  PyObject *metals = metal_rows(), *measured = measured_rows();
  if (good && lights && closures && nodes && cloths && weaves && yarns && metals && measured)
    return Py_BuildValue("{s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N}", "lists", lists, "about",
                         about, "params", params, "lights", lights, "closures", closures, "nodes",
                         nodes, "cloths", cloths, "weaves", weaves, "yarns", yarns, "metals",
                         metals, "measured", measured);
  Py_XDECREF(weaves);
  Py_XDECREF(yarns);
  Py_XDECREF(measured);
  Py_XDECREF(metals);
  Py_XDECREF(cloths);
  Py_XDECREF(nodes);
  Py_XDECREF(closures);
  Py_XDECREF(lights);
  Py_XDECREF(lists);
  Py_XDECREF(about);
  Py_XDECREF(params);
  return NULL;
}

PyDoc_STRVAR(version_doc, "version() -> str\n\nThe version of libshade.");
static PyObject *native_version(PyObject *self, PyObject *unused) {
  (void)self, (void)unused;
  return PyUnicode_FromString(SHADE_VERSION);
}

PyDoc_STRVAR(isa_doc,
             "isa() -> str\n\n"
             "The instruction set of what is started now: avx512, avx2, sse2, neon or scalar.\n"
             "LIBSHADE_ISA in the environment asks for less than the CPU has.");
static PyObject *native_isa(PyObject *self, PyObject *unused) {
  (void)self, (void)unused;
  return PyUnicode_FromString(stages_choose()->name);
}

static int native_exec(PyObject *module) {
  (void)module;
  return Py_AtExit(finish_all);
}

PyMODINIT_FUNC PyInit__native(void) {
  static PyMethodDef methods[] = {
      {"start", native_start, METH_VARARGS, start_doc},
      {"look", native_look, METH_VARARGS, look_doc},
      {"poll", native_poll, METH_O, poll_doc},
      {"wait", native_wait, METH_VARARGS, wait_doc},
      {"cancel", native_cancel, METH_O, cancel_doc},
      {"image", native_image, METH_VARARGS, image_doc},
      {"timings", native_timings, METH_O, timings_doc},
      {"slopes", native_slopes, METH_O, slopes_doc},
      {"free", native_free, METH_O, free_doc},
      {"table", native_table, METH_NOARGS, table_doc},
      {"metal", native_metal, METH_O, metal_doc},
      {"cloth", native_cloth, METH_O, cloth_doc},
      {"cloth_albedo", native_cloth_albedo, METH_O, cloth_albedo_doc},
      {"cloth_images", native_cloth_images, METH_O, cloth_images_doc},
      {"wif", native_wif, METH_VARARGS, wif_doc},
      {"roots", native_roots, METH_VARARGS, native_roots_doc},
      {"scratches", native_scratches, METH_O, native_scratches_doc},
      {"scratch_images", native_scratch_images, METH_VARARGS, native_scratch_images_doc},
      {"version", native_version, METH_NOARGS, version_doc},
      {"isa", native_isa, METH_NOARGS, isa_doc},
      {NULL, NULL, 0, NULL}};
  static PyModuleDef_Slot slots[] = {{Py_mod_exec, (void *)native_exec}, {0, NULL}};
  static PyModuleDef definition = {.m_base = PyModuleDef_HEAD_INIT,
                                   .m_name = "_native",
                                   .m_doc = "libshade's renderer: jobs that run on all cores.",
                                   .m_methods = methods,
                                   .m_slots = slots};
  return PyModuleDef_Init(&definition);
}
