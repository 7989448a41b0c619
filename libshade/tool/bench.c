/* SPDX-License-Identifier: Apache-2.0 */
/* shade bench: nanoseconds and worst error of every entry, side by side. */

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "port/memory.h"
#include "port/process.h"
#include "reference/reference.h"
#include "shade/shade.h"
#include "model/bsdf.h"
#include "batch/isa.h"
#include "batch/arrays.h"
#include "tool/bench_parts.h"
#include "tool/literal.h"
#include "tool/text.h"
#include "tool/tool.h"

enum { INPUTS = 9, OUTPUTS = 4, CHECKED = 4096 };

/* The same directions as float and as double; the float ones are the rounded doubles. */
typedef struct arrays {
  size_t count;
  void *room[2];
  float *single[INPUTS + OUTPUTS];
  double *twice[INPUTS + OUTPUTS];
} arrays;

/*
 * The distribution and the BRDF over arrays, the same in one call a sample, and the BRDF under
 * the horizons other than `hard`, whose rows are named f_ and the horizon.
 */
typedef enum what { WHAT_D, WHAT_F, WHAT_D_CALL, WHAT_F_CALL, WHAT_F_HORIZON, WHATS } what;
static const char *const what_words[] = {"D", "f", "D_call", "f_call", "f_horizon"};

typedef enum precision { SINGLE, TWICE, PRECISIONS } precision;
static const char *const precision_words[] = {"float", "double"};

static int asks_d(what w) {
  return w == WHAT_D || w == WHAT_D_CALL;
}
static int is_call(what w) {
  return w == WHAT_D_CALL || w == WHAT_F_CALL;
}
/* Calls never wait for memory, and what a horizon costs is arithmetic. */
static int in_cache_only(what w) {
  return is_call(w) || w == WHAT_F_HORIZON;
}

static void release(arrays *a) {
  shade_port_aligned_free(a->room[0]);
  shade_port_aligned_free(a->room[1]);
}

/*
 * Each array starts a cache line, as a renderer's scratch does, and none at the same place
 * of a page: stores and loads 4096 bytes apart wait for each other. NULL when out of memory.
 */
static void *make_room(size_t size, char *starts[INPUTS + OUTPUTS]) {
  const size_t line = SHADE_PORT_LINE, step = (size + line - 1) / line * line + 5 * line;
  char *room = shade_port_aligned_new(step * (INPUTS + OUTPUTS));
  if (!room)
    return NULL;
  memset(room, 0, step * (INPUTS + OUTPUTS));
  for (int k = 0; k < INPUTS + OUTPUTS; k++)
    starts[k] = room + (size_t)k * step;
  return room;
}

/* n, wi, wo within 60 degrees of z. Returns 0 when out of memory. */
static int fill(arrays *a, size_t count) {
  const double pi = 3.14159265358979323846;
  memset(a, 0, sizeof *a);
  a->count = count;
  char *starts[INPUTS + OUTPUTS];
  a->room[0] = make_room(count * sizeof(float), starts);
  for (int k = 0; a->room[0] && k < INPUTS + OUTPUTS; k++)
    a->single[k] = (float *)starts[k];
  a->room[1] = make_room(count * sizeof(double), starts);
  for (int k = 0; a->room[1] && k < INPUTS + OUTPUTS; k++)
    a->twice[k] = (double *)starts[k];
  if (!a->room[0] || !a->room[1])
    return 0;
  uint64_t seed = 1;
  for (size_t i = 0; i < count; i++)
    for (int v = 0; v < INPUTS; v += 3) {
      double theta = pi / 3 * bench_uniform(&seed), phi = 2 * pi * bench_uniform(&seed);
      a->twice[v][i] = sin(theta) * cos(phi);
      a->twice[v + 1][i] = sin(theta) * sin(phi);
      a->twice[v + 2][i] = cos(theta);
      for (int c = v; c < v + 3; c++)
        a->single[c][i] = (float)a->twice[c][i];
    }
  return 1;
}

static void evaluate_batch(const shade_isa_table *isa, const shade_bsdf *b, what w, int single,
                           const arrays *a) {
  float *const *s = a->single, *const *os = a->single + INPUTS;
  double *const *t = a->twice, *const *ot = a->twice + INPUTS;
  if (asks_d(w) && single)
    isa->entriesf->mdf_batch(b, a->count, s[0], s[1], s[2], s[3], s[4], s[5], os[0]);
  else if (asks_d(w))
    isa->entries->mdf_batch(b, a->count, t[0], t[1], t[2], t[3], t[4], t[5], ot[0]);
  else if (single) {
    shade_lanesf in = {.size = sizeof in, SHADE_DIRECTIONS(s)};
    shade_resultf out = {sizeof out, os[0], os[1], os[2], os[3]};
    isa->entriesf->bsdf_batch(b, a->count, &in, &out);
  } else {
    shade_lanes in = {.size = sizeof in, SHADE_DIRECTIONS(t)};
    shade_result out = {sizeof out, ot[0], ot[1], ot[2], ot[3]};
    isa->entries->bsdf_batch(b, a->count, &in, &out);
  }
}

/* One call a sample, as a renderer does that shades hit by hit. */
#define CALLS(name, real, member, entries)                                                         \
  static void name(const shade_isa_table *isa, const shade_bsdf *b, what w, const arrays *a) {     \
    real *const *v = a->member, *const *out = v + INPUTS;                                          \
    for (size_t i = 0; i < a->count; i++) {                                                        \
      real n[3] = {v[0][i], v[1][i], v[2][i]}, wi[3] = {v[3][i], v[4][i], v[5][i]};                \
      if (asks_d(w)) {                                                                             \
        isa->entries->mdf(b, n, wi, &out[0][i]);                                                   \
      } else {                                                                                     \
        real wo[3] = {v[6][i], v[7][i], v[8][i]}, f[3];                                            \
        isa->entries->bsdf(b, n, wi, wo, f, &out[3][i]);                                           \
        for (int c = 0; c < 3; c++)                                                                \
          out[c][i] = f[c];                                                                        \
      }                                                                                            \
    }                                                                                              \
  }
CALLS(calls_single, float, single, entriesf)
CALLS(calls_twice, double, twice, entries)

/* What is timed beside an instruction set. */
typedef struct beside {
  literal_batch *literal;
  stream_single_batch *single;
  stream_twice_batch *twice;
} beside;

static beside beside_of(const shade_isa_table *isa) {
#if defined(__x86_64__)
  if (isa == &shade_isa_avx512)
    return (beside){literal_avx512, stream_single_avx512, stream_twice_avx512};
  if (isa == &shade_isa_avx2)
    return (beside){literal_avx2, stream_single_avx2, stream_twice_avx2};
  if (isa == &shade_isa_sse2)
    return (beside){literal_sse2, stream_single_sse2, stream_twice_sse2};
#elif defined(__aarch64__)
  if (isa != &shade_isa_scalar)
    return (beside){literal_neon, stream_single_neon, stream_twice_neon};
#endif
  (void)isa;
  return (beside){literal_scalar, stream_single_scalar, stream_twice_scalar};
}

/* One row: a material in one precision, the literal transcription, or the bare stream. */
typedef enum kind { KIND_METHOD, KIND_LITERAL, KIND_STREAM } kind;
typedef struct row {
  kind kind;
  shade_params params;
  shade_bsdf bsdf;
  double ns, error;
} row;

static void evaluate(const shade_isa_table *isa, const row *r, what w, int single,
                     const arrays *a) {
  float *const *s = a->single;
  const beside other = beside_of(isa);
  if (r->kind == KIND_STREAM && single)
    other.single(!asks_d(w), a->count, a->single);
  else if (r->kind == KIND_STREAM)
    other.twice(!asks_d(w), a->count, a->twice);
  else if (r->kind == KIND_LITERAL)
    other.literal(a->count, bsdf_of(&r->bsdf)->numbersf.kx, bsdf_of(&r->bsdf)->numbersf.ky, s[0],
                  s[1], s[2], s[3], s[4], s[5], s[INPUTS]);
  else if (is_call(w))
    (single ? calls_single : calls_twice)(isa, &r->bsdf, w, a);
  else
    evaluate_batch(isa, &r->bsdf, w, single, a);
}

/* (wi + wo).n over its length, w (one of them) mirrored at the upright facet of n. */
static double by_mirror(const double n[3], const double w[3], const double other[3]) {
  const double side2 = n[0] * n[0] + n[1] * n[1];
  const double step = side2 > 0 ? 2 * (n[0] * w[0] + n[1] * w[1]) / side2 : 0;
  const double h[3] = {w[0] - step * n[0] + other[0], w[1] - step * n[1] + other[1],
                       w[2] + other[2]};
  return (n[0] * h[0] + n[1] * h[1] + n[2] * h[2]) / sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
}

/* The smallest of the cosines that f depends on, about the normal that it is shaded with. */
static double least_cosine(const shade_params *p, const double v[INPUTS]) {
  const double *wi = v + 3, *wo = v + 6;
  double n[3] = {0, 0, 1};
  if (p->detail != SHADE_DETAIL_NONE)
    shade_ref_normal(p, v, wo, n);
  const double cosi = fabs(n[0] * wi[0] + n[1] * wi[1] + n[2] * wi[2]);
  const double coso = fabs(n[0] * wo[0] + n[1] * wo[1] + n[2] * wo[2]);
  const double least = fmin(cosi, coso);
  if (p->horizon != SHADE_HORIZON_SCHUESSLER)
    return least;
  return fmin(least, fmin(by_mirror(n, wi, wo), by_mirror(n, wo, wi)));
}

/*
 * Worst relative error against the reference on the same inputs, where D > 1e-12 of its peak; of
 * f where both cosines are above 0.05, for below them every float cosine loses its digits.
 */
static double worst_error(const shade_isa_table *isa, const row *r, what w, int single,
                          const arrays *a) {
  double worst = 0;
  evaluate(isa, r, w, single, a);
  for (size_t i = 0; i < a->count && i < CHECKED; i++) {
    double v[INPUTS], want[3], least = 1;
    for (int c = 0; c < INPUTS; c++)
      v[c] = single ? (double)a->single[c][i] : a->twice[c][i];
    if (asks_d(w)) {
      want[0] = shade_ref_mdf(&r->params, v, v + 3);
    } else {
      shade_ref_f(&r->params, v, v + 3, v + 6, want, NULL);
      least = least_cosine(&r->params, v);
    }
    double got = single ? (double)a->single[INPUTS][i] : a->twice[INPUTS][i];
    if (want[0] > 1e-12 * bsdf_of(&r->bsdf)->numbers.peak && least > 0.05)
      worst = fmax(worst, fabs(got / want[0] - 1));
  }
  return worst;
}

/*
 * Times in nanoseconds a query, the best of many runs. The rows take turns, so that what else
 * the machine does falls on all of them and their ratios stay what they are.
 */
static void time_rows(const shade_isa_table *isa, row *rows, int count, what w, int single,
                      const arrays *a) {
  const size_t repeat = 1 + 8192 / a->count;
  const int rounds = a->count > 65536 ? 12 : 60;
  for (int r = 0; r < count; r++)
    rows[r].ns = 1e30;
  for (int round = 0; round < rounds; round++)
    for (int r = 0; r < count; r++) {
      double begin = bench_seconds();
      for (size_t k = 0; k < repeat; k++)
        evaluate(isa, &rows[r], w, single, a);
      rows[r].ns = fmin(rows[r].ns, (bench_seconds() - begin) * 1e9 / (double)(repeat * a->count));
    }
}

static void usage(FILE *to) {
  fputs(
      "usage: shade bench [options]\n\n"
      "Times every detail method and distribution in every precision on one thread, on arrays\n"
      "in cache and in memory, beside a bare pass over the same arrays; with the worst\n"
      "relative error against the reference. Times are the best of many runs, in ns.\n"
      "About a minute for one instruction set.\n\n"
      "  D, f             the distribution; the whole BRDF: that of Ashikhmin and Shirley,\n"
      "                   ward_bounded for both Wards, microfacet for Beckmann and GGX\n"
      "  D_call, f_call   the same in one call a sample\n"
      "  f_valid_estevez  f of rotate under that horizon, its ratio to perturb's f; likewise\n"
      "                   all other horizons of shade eval --help but hard, which f has\n"
      "  rotate_literal   rotate as the papers write it, with atan2 and powf of libm\n"
      "  cloth_near, cloth_far, cloth_far_nodes, cloth_single  with --what cloth: every cloth of\n"
      "                   shade presets, near, far by tables and by all lobes in turn, and by one\n"
      "                   lobe; _gloss: with the gloss of each lane, no error is taken far and\n"
      "                   single; _prepared, _pdf and _sample: after preparing; _call: the same "
      "in\n"
      "                   one call a light;\n"
      "                   the first ratio is to cloth_near, errors are against double (near) and\n"
      "                   the mean of near over many points (footprints of 20 crossings)\n"
      "  f, pdf, sample   with --what lanes: GGX with the material's own parameters; _alphas: "
      "with\n"
      "                   alphas of each sample, _all: colours, diffuse and groove too; the first\n"
      "                   ratio is to the material's own\n"
      "  slopes, widen    with --what maps: normal maps over footprints of so many texels, one "
      "call\n"
      "                   a lookup; the first ratio is to a point; no error is taken\n"
      "  diffuse          with --what diffuse: the diffuse part alone, each model about bumped\n"
      "                   normals; errors of Phi against the reference; the first ratio is to "
      "lambert\n"
      "  lobes_1 to 8     with --what lobes: a lookup of a filtered map by so many lobes, whole, "
      "one\n"
      "                   call a lobe; the first ratio is to one lobe; no error is taken\n"
      "  D_reference      with --what reference: D of rotate by the reference, in long double\n\n"
      "  --csv            what,method,distribution,precision,isa,set,ns,ratio_perturb,\n"
      "                   ratio_stream,max_error\n"
      "  --output FILE    these columns into a file, beside what is printed\n"
      "  --isa NAME       avx512, avx2, sse2, neon or scalar (default: that of shade --version)\n"
      "  --all            every instruction set of this CPU\n"
      "  --mdf NAME       one distribution only\n"
      "  --what NAME      D, f, D_call, f_call, cloth, lanes, maps, diffuse or lobes only, or f_ "
      "and\n"
      "                   a horizon\n"
      "  --set NAME       cache or memory only\n"
      "  --ex E --ey E    exponents (default 200, 10)\n",
      to);
}

/* Rows for a file, kept until all is measured: it appears whole or not at all. */
typedef struct kept {
  char *text; /* NULL when out of memory */
  size_t length, room;
} kept;

static void keep(kept *k, const char *format, ...) {
  enum { MOST = 256 }; /* of a row */
  if (k->text && k->room - k->length < MOST) {
    char *more = realloc(k->text, k->room *= 2);
    if (!more)
      free(k->text);
    k->text = more;
  }
  if (!k->text)
    return;
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(k->text + k->length, MOST, format, arguments);
  va_end(arguments);
  k->length += length < MOST ? (size_t)length : MOST - 1;
}

typedef struct options {
  int csv, all, mdf, what, set; /* -1: every one */
  int apart;                    /* one of apart_words alone, counted from 1 */
  int horizon;                  /* of WHAT_F_HORIZON; -1: every one */
  const char *isa, *output;
  kept *file; /* NULL: none */
  double ex, ey;
} options;

static const char columns[] =
    "what,method,distribution,precision,isa,set,ns,ratio_perturb,ratio_stream,max_error\n";

static void print_row(const options *o, const row *r, what asked, const char *precision,
                      const char *isa, const char *set, double perturb, double bare) {
  char w[32];
  snprintf(w, sizeof w, "%s", what_words[asked]);
  if (asked == WHAT_F_HORIZON)
    snprintf(w, sizeof w, "f_%s", shade_list_word(SHADE_LIST_HORIZON, (int)r->params.horizon));
  static const char csv[] = "%s,%s,%s,%s,%s,%s,%.4g,%.4g,%.4g,%.2e\n";
  const char *method = r->kind == KIND_LITERAL
                           ? "rotate_literal"
                           : shade_list_word(SHADE_LIST_DETAIL, (int)r->params.detail);
  const char *mdf = shade_list_word(SHADE_LIST_MDF, (int)r->params.mdf);
  printf(o->csv ? csv : "%-18s %-24s %-18s %-7s %-7s %-7s %8.3g %8.3g %8.3g %10.1e\n", w, method,
         mdf, precision, isa, set, r->ns, r->ns / perturb, r->ns / bare, r->error);
  fflush(stdout);
  if (o->file)
    keep(o->file, csv, w, method, mdf, precision, isa, set, r->ns, r->ns / perturb, r->ns / bare,
         r->error);
}

/*
 * Whether a question has the row d: the methods, past them the literal transcription, then rotate
 * under each horizon but hard. perturb is always there, for ratios.
 */
static int has_row(const options *o, what w, int d) {
  const int horizon = d - SHADE_DETAIL_COUNT;
  if (w != WHAT_F_HORIZON)
    return horizon <= 0;
  return d == SHADE_DETAIL_PERTURB || (horizon > 0 && (o->horizon < 0 || o->horizon == horizon));
}

/* All methods of one distribution, instruction set, precision and question. */
static void bench_group(const options *o, const shade_isa_table *isa, shade_mdf mdf, what w,
                        precision kind, const char *set, const arrays *a) {
  const shade_brdf brdfs[SHADE_MDF_COUNT] = {SHADE_BRDF_ASHIKHMIN_SHIRLEY, SHADE_BRDF_WARD_BOUNDED,
                                             SHADE_BRDF_WARD_BOUNDED, SHADE_BRDF_MICROFACET,
                                             SHADE_BRDF_MICROFACET};
  row rows[SHADE_DETAIL_COUNT + SHADE_HORIZON_COUNT + 2];
  int count = 1, perturb = 0;
  for (int d = 0; d < SHADE_DETAIL_COUNT + SHADE_HORIZON_COUNT; d++) {
    row *r = &rows[count];
    const int literal = d == SHADE_DETAIL_COUNT, horizon = d - SHADE_DETAIL_COUNT;
    if (!has_row(o, w, d))
      continue;
    if (literal && !(w == WHAT_D && kind == SINGLE && mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY))
      continue;
    r->kind = literal ? KIND_LITERAL : KIND_METHOD;
    shade_params_init(&r->params);
    shade_params_set_exponents(&r->params, o->ex, o->ey);
    r->params.mdf = mdf;
    r->params.brdf = brdfs[mdf];
    r->params.f0[0] = r->params.f0[1] = r->params.f0[2] = .5;
    r->params.horizon = horizon > 0 ? (shade_horizon)horizon : SHADE_HORIZON_HARD;
    r->params.detail = horizon >= 0 ? SHADE_DETAIL_ROTATE : (shade_detail)d;
    r->params.groove = literal ? SHADE_GROOVE_X : SHADE_GROOVE_AUTO;
    shade_bsdf_setup(&r->bsdf, &r->params);
    if (d == SHADE_DETAIL_PERTURB)
      perturb = count;
    count++;
  }
  if (!perturb)
    return;
  rows[0] = rows[perturb];
  rows[0].kind = KIND_STREAM;
  const int single = kind != TWICE;
  for (int r = 1; r < count; r++) /* first, which also warms up */
    rows[r].error = worst_error(isa, &rows[r], w, single, a);
  time_rows(isa, rows, count, w, single, a);
  for (int r = 1 + (w == WHAT_F_HORIZON); r < count; r++)
    print_row(o, &rows[r], w, precision_words[kind], isa->name, set, rows[perturb].ns, rows[0].ns);
}

static int read_exponent(const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  return end != text && !*end && *value >= 0 && *value <= 1e6;
}

static int find_word(const char *const *words, int count, const char *word) {
  for (int i = 0; i < count; i++)
    if (!strcmp(words[i], word))
      return i;
  return -1;
}

static const char *const sets[] = {"cache", "memory"};
static const char *const apart_words[] = {"cloth",   "lanes", "maps",
                                          "diffuse", "lobes", "reference"};
enum { APART = sizeof apart_words / sizeof apart_words[0] };
/* 4M queries are 200 to 400 MB: beyond any cache */
static const size_t counts[] = {1024, (size_t)4 << 20};

/* Returns 0 and a message for a value that does not fit. */
static int read_value(options *o, const char *option, const char *text) {
  const char *expected = NULL;
  if (!strcmp(option, "--isa")) {
    int row = 0;
    const shade_isa_table *isa;
    while ((isa = shade_isa_pick(row)) && strcmp(isa->name, text))
      row++;
    o->isa = text;
    expected = isa ? NULL : "an instruction set of shade bench --help that this CPU has";
  } else if (!strcmp(option, "--mdf")) {
    o->mdf = shade_list_find(SHADE_LIST_MDF, text);
    expected = o->mdf < 0 ? "a distribution (see shade eval --help)" : NULL;
  } else if (!strcmp(option, "--what")) {
    o->apart = find_word(apart_words, APART, text) + 1;
    o->what = o->apart ? WHATS : find_word(what_words, WHAT_F_HORIZON, text);
    o->horizon = strncmp(text, "f_", 2) ? -1 : shade_list_find(SHADE_LIST_HORIZON, text + 2);
    if (o->what < 0 && o->horizon > 0)
      o->what = WHAT_F_HORIZON;
    expected =
        o->what < 0
            ? "D, f, D_call, f_call, cloth, lanes, maps, diffuse, lobes, reference, or f_ and a "
              "horizon (not hard)"
            : NULL;
  } else if (!strcmp(option, "--set")) {
    o->set = find_word(sets, 2, text);
    expected = o->set < 0 ? "cache or memory" : NULL;
  } else if (!strcmp(option, "--output")) {
    o->output = text;
  } else if (!read_exponent(text, option[3] == 'x' ? &o->ex : &o->ey)) {
    expected = "a number from 0 to 1e6";
  }
  if (expected)
    fprintf(stderr, "shade bench: %s '%s': expected %s\n", option, text, expected);
  return !expected;
}

static int read_options(options *o, int argc, char **argv, int *help) {
  static const char *const with_value[] = {"--isa",    "--mdf", "--what", "--set",
                                           "--output", "--ex",  "--ey"};
  for (int i = 1; i < argc; i++) {
    if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
      *help = 1;
      return TOOL_DONE;
    }
    if (!strcmp(argv[i], "--csv")) {
      o->csv = 1;
    } else if (!strcmp(argv[i], "--all")) {
      o->all = 1;
    } else if (find_word(with_value, 7, argv[i]) < 0) {
      fprintf(stderr, "shade bench: unknown option '%s' (see shade bench --help)\n", argv[i]);
      return TOOL_BAD_USAGE;
    } else if (i + 1 == argc) {
      fprintf(stderr, "shade bench: %s needs a value (see shade bench --help)\n", argv[i]);
      return TOOL_BAD_USAGE;
    } else if (!read_value(o, argv[i], argv[i + 1])) {
      return TOOL_BAD_USAGE;
    } else {
      i++;
    }
  }
  if (o->set == 1 && o->what >= 0 && (o->apart || in_cache_only((what)o->what))) {
    fputs("shade bench: calls and horizons are timed in cache only (see shade bench --help)\n",
          stderr);
    return TOOL_BAD_USAGE;
  }
  return TOOL_DONE;
}

static int wanted(const options *o, const shade_isa_table *isa) {
  return o->isa ? !strcmp(o->isa, isa->name) : o->all;
}

static void progress(int done, int total, const char *what) {
  if (!shade_port_is_terminal(2) ||
      shade_port_is_terminal(1)) /* rows on a terminal are progress enough */
    return;
  int filled = total ? 30 * done / total : 0;
  fprintf(stderr, "\rshade bench [%.*s%*s] %-40s", filled, "##############################",
          30 - filled, "", what);
}

static int bench_set(const options *o, int s, int *done, int total) {
  arrays a;
  if (!fill(&a, counts[s])) {
    fputs("shade bench: out of memory\n", stderr);
    release(&a);
    return TOOL_BAD_INPUT;
  }
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (int w = 0; w < WHATS; w++)
      for (int m = 0; m < SHADE_MDF_COUNT; m++) {
        if (!wanted(o, isa) || (o->what >= 0 && w != o->what) || (o->mdf >= 0 && m != o->mdf))
          continue;
        if (s == 1 && in_cache_only((what)w))
          continue;
        char title[64];
        snprintf(title, sizeof title, "%s %s %s %s", sets[s], isa->name, what_words[w],
                 shade_list_word(SHADE_LIST_MDF, m));
        progress((*done)++, total, title);
        for (int kind = 0; kind < PRECISIONS; kind++)
          bench_group(o, isa, (shade_mdf)m, (what)w, (precision)kind, sets[s], &a);
      }
  release(&a);
  return TOOL_DONE;
}

typedef struct apart_rows {
  const options *o;
  double first[2]; /* what ratios are to, in double and float */
} apart_rows;

static void print_apart(void *context, const char *what, const char *preset, const char *mdf,
                        int single, double ns, double error) {
  static const char *const firsts[] = {"cloth_near",   "f",          "pdf", "sample", "lobes_1",
                                       "slopes_point", "D_reference"};
  apart_rows *c = context;
  static const char csv[] = "%s,%s,%s,%s,%s,cache,%.4g,%.4g,0,%.2e\n";
  const char *type = precision_words[single ? SINGLE : TWICE], *isa = shade_isa();
  if (find_word(firsts, 7, what) >= 0 || !strcmp(preset, "lambert"))
    c->first[single] = ns;
  const double ratio = ns / c->first[single];
  if (c->o->csv)
    printf(csv, what, preset, mdf, type, isa, ns, ratio, error);
  else
    printf("%-22s %-20s %-18s %-7s %-7s cache   %8.3g %8.3g %8s %10.1e\n", what, preset, mdf, type,
           isa, ns, ratio, "", error);
  fflush(stdout);
  if (c->o->file)
    keep(c->o->file, csv, what, preset, mdf, type, isa, ns, ratio, error);
}

/* By public calls, which run on what the environment named when a cloth or material was made. */
static int bench_apart(const options *o) {
  int (*const jobs[])(bench_row *, void *) = {bench_cloth,   bench_lanes, bench_maps,
                                              bench_diffuse, bench_lobes, bench_reference};
  const shade_isa_table *isa;
  for (int row = 0; o->apart && (isa = shade_isa_pick(row)); row++) {
    apart_rows rows = {o, {1, 1}};
    if (!wanted(o, isa))
      continue;
    if (shade_port_set_variable(SHADE_ISA_VARIABLE, isa->name) ||
        !jobs[o->apart - 1](print_apart, &rows)) {
      fputs("shade bench: out of memory\n", stderr);
      return TOOL_BAD_INPUT;
    }
  }
  return TOOL_DONE;
}

int shade_cmd_bench(int argc, char **argv) {
  options o = {.mdf = -1, .what = -1, .set = -1, .horizon = -1, .ex = 200, .ey = 10};
  int help = 0, status = read_options(&o, argc, argv, &help);
  if (help)
    usage(stdout);
  if (help || status)
    return status;
  if (!o.isa && !o.all)
    o.isa = shade_isa();

  kept file = {.room = 4096};
  if (o.output) {
    if (tool_save_text("bench", o.output, NULL, 0))
      return TOOL_BAD_INPUT;
    file.text = malloc(file.room);
    keep(&file, "%s", columns);
    o.file = &file;
  }
  if (o.csv)
    fputs(columns, stdout);
  else
    puts("                   method                   distribution       type    isa     arrays    "
         "    ns "
         "/perturb  /stream      error");
  int isas = 0, done = 0, total = 0;
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    isas += wanted(&o, isa);
  for (int s = 0; s < 2; s++)
    for (int w = 0; w < WHATS; w++)
      if ((o.set < 0 || s == o.set) && (o.what < 0 || w == o.what) &&
          !(s && in_cache_only((what)w)))
        total += isas * (o.mdf < 0 ? SHADE_MDF_COUNT : 1);
  for (int s = 0; s < 2 && !status && !o.apart; s++)
    if (o.set < 0 || s == o.set)
      status = bench_set(&o, s, &done, total);
  if (!status)
    status = bench_apart(&o);
  if (shade_port_is_terminal(2) && !shade_port_is_terminal(1))
    fputs("\r\033[K", stderr);
  if (o.file) {
    if (!file.text) {
      fputs("shade bench: out of memory\n", stderr);
      status = TOOL_BAD_INPUT;
    }
    if (!status && tool_save_text("bench", o.output, file.text, file.length))
      status = TOOL_BAD_INPUT;
    free(file.text);
  }
  return status;
}
