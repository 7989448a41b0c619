/* SPDX-License-Identifier: Apache-2.0 */
/* shade bench: nanoseconds and worst error of every batch entry, side by side. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime, isatty */

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "reference/reference.h"
#include "shade/shade.h"
#include "src/isa.h"
#include "tool/tool.h"

enum { INPUTS = 9, OUTPUTS = 4, CHECKED = 4096 };

/* The same directions as float and as double; the float ones are the rounded doubles. */
typedef struct arrays {
  size_t count;
  float *single[INPUTS + OUTPUTS];
  double *twice[INPUTS + OUTPUTS];
} arrays;

typedef enum what { WHAT_D, WHAT_F } what;
static const char *const what_words[] = {"D", "f"};

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double uniform(uint64_t *state) { /* splitmix64 */
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void release(arrays *a) {
  for (int k = 0; k < INPUTS + OUTPUTS; k++) {
    free(a->single[k]);
    free(a->twice[k]);
  }
}

/* n, wi, wo within 60 degrees of z. Returns 0 when out of memory. */
static int fill(arrays *a, size_t count) {
  const double pi = 3.14159265358979323846;
  memset(a, 0, sizeof *a);
  a->count = count;
  for (int k = 0; k < INPUTS + OUTPUTS; k++) {
    a->single[k] = calloc(count, sizeof *a->single[k]);
    a->twice[k] = calloc(count, sizeof *a->twice[k]);
    if (!a->single[k] || !a->twice[k])
      return 0;
  }
  uint64_t seed = 1;
  for (size_t i = 0; i < count; i++)
    for (int v = 0; v < INPUTS; v += 3) {
      double theta = pi / 3 * uniform(&seed), phi = 2 * pi * uniform(&seed);
      a->twice[v][i] = sin(theta) * cos(phi);
      a->twice[v + 1][i] = sin(theta) * sin(phi);
      a->twice[v + 2][i] = cos(theta);
      for (int c = v; c < v + 3; c++)
        a->single[c][i] = (float)a->twice[c][i];
    }
  return 1;
}

static void evaluate(const shade_isa_table *isa, const shade_bsdf *b, what w, int single,
                     arrays *a) {
  float *const *s = a->single, *const *os = a->single + INPUTS;
  double *const *t = a->twice, *const *ot = a->twice + INPUTS;
  if (w == WHAT_D && single)
    isa->mdf_batchf(b, a->count, s[0], s[1], s[2], s[3], s[4], s[5], os[0]);
  else if (w == WHAT_D)
    isa->mdf_batch(b, a->count, t[0], t[1], t[2], t[3], t[4], t[5], ot[0]);
  else if (single) {
    shade_lanesf in = {s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8], NULL, NULL, NULL};
    shade_resultf out = {os[0], os[1], os[2], os[3]};
    isa->bsdf_batchf(b, a->count, &in, &out);
  } else {
    shade_lanes in = {t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8], NULL, NULL, NULL};
    shade_result out = {ot[0], ot[1], ot[2], ot[3]};
    isa->bsdf_batch(b, a->count, &in, &out);
  }
}

/* Reads every input and writes every output of a query, and does nothing else. */
#define STREAM(name, real)                                                                         \
  static void name(int inputs, int outputs, size_t count, real *const *a) {                        \
    enum { BLOCK = 256 };                                                                          \
    for (size_t start = 0; start < count; start += BLOCK) {                                        \
      size_t size = count - start < BLOCK ? count - start : BLOCK;                                 \
      real sum[BLOCK] = {0};                                                                       \
      for (int k = 0; k < inputs; k++)                                                             \
        for (size_t i = 0; i < size; i++)                                                          \
          sum[i] += a[k][start + i];                                                               \
      for (int k = INPUTS; k < INPUTS + outputs; k++)                                              \
        memcpy(a[k] + start, sum, size * sizeof sum[0]);                                           \
    }                                                                                              \
  }
STREAM(stream_single, float)
STREAM(stream_twice, double)

static void stream(what w, int single, arrays *a) {
  int inputs = w == WHAT_D ? 6 : INPUTS, outputs = w == WHAT_D ? 1 : OUTPUTS;
  if (single)
    stream_single(inputs, outputs, a->count, a->single);
  else
    stream_twice(inputs, outputs, a->count, a->twice);
}

/* Best of many runs, in nanoseconds a query; isa NULL times the bare stream. */
static double nanoseconds(const shade_isa_table *isa, const shade_bsdf *b, what w, int single,
                          arrays *a) {
  double best = 1e30, end = seconds() + (a->count > 65536 ? 0.3 : 0.03);
  size_t repeat = 1 + 16384 / a->count;
  do {
    double begin = seconds();
    for (size_t k = 0; k < repeat; k++)
      if (isa)
        evaluate(isa, b, w, single, a);
      else
        stream(w, single, a);
    best = fmin(best, seconds() - begin);
  } while (seconds() < end);
  return best * 1e9 / (double)(repeat * a->count);
}

/* Worst relative error against the reference on the same inputs, where D > 1e-12 of its peak. */
static double worst_error(const shade_isa_table *isa, const shade_params *p, const shade_bsdf *b,
                          what w, int single, arrays *a) {
  double worst = 0;
  evaluate(isa, b, w, single, a);
  for (size_t i = 0; i < a->count && i < CHECKED; i++) {
    double v[INPUTS], want[3], cosine = 1;
    for (int c = 0; c < INPUTS; c++)
      v[c] = single ? (double)a->single[c][i] : a->twice[c][i];
    if (w == WHAT_D)
      want[0] = shade_ref_mdf(p, v, v + 3);
    else
      shade_ref_f(p, v, v + 3, v + 6, want, &cosine);
    double got = single ? (double)a->single[INPUTS][i] : a->twice[INPUTS][i];
    if (want[0] > 1e-12 * b->peak && cosine > 1e-3)
      worst = fmax(worst, fabs(got / want[0] - 1));
  }
  return worst;
}

static void usage(FILE *to) {
  fputs("usage: shade bench [--csv] [--all] [--ex E] [--ey E]\n\n"
        "Times every detail method, in both precisions, on arrays in cache and in memory,\n"
        "single-threaded, beside a bare pass over the same arrays; with the worst relative\n"
        "error against the reference. Times are the best of many runs.\n\n"
        "  --csv            what,method,distribution,precision,isa,set,ns,ratio_perturb,\n"
        "                   ratio_stream,max_error\n"
        "  --all            every instruction set of this CPU, not only the widest\n"
        "  --ex E --ey E    exponents (default 200, 10)\n",
        to);
}

static void print_row(int csv, const char *w, const char *method, const char *mdf,
                      const char *precision, const char *isa, const char *set, double ns,
                      double perturb, double bare, double error) {
  printf(csv ? "%s,%s,%s,%s,%s,%s,%.4g,%.4g,%.4g,%.2e\n"
             : "%-2s %-24s %-18s %-7s %-7s %-7s %8.3g %8.3g %8.3g %10.1e\n",
         w, method, mdf, precision, isa, set, ns, ns / perturb, ns / bare, error);
  fflush(stdout);
}

/* All methods of one instruction set, precision and question; arrays of one size. */
static void bench_group(int csv, const shade_isa_table *isa, const shade_params *material, what w,
                        int single, const char *set, arrays *a) {
  double bare = nanoseconds(NULL, NULL, w, single, a);
  shade_params p = *material;
  shade_bsdf b;
  p.detail = SHADE_DETAIL_PERTURB;
  shade_bsdf_setup(&b, &p);
  double perturb = nanoseconds(isa, &b, w, single, a);
  for (int d = 0; d < SHADE_DETAIL_COUNT; d++) {
    p.detail = (shade_detail)d;
    shade_bsdf_setup(&b, &p);
    double ns = d == SHADE_DETAIL_PERTURB ? perturb : nanoseconds(isa, &b, w, single, a);
    print_row(csv, what_words[w], shade_list_word(SHADE_LIST_DETAIL, d),
              shade_list_word(SHADE_LIST_MDF, (int)p.mdf), single ? "float" : "double", isa->name,
              set, ns, perturb, bare, worst_error(isa, &p, &b, w, single, a));
  }
}

static int read_exponent(const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  return end != text && !*end && *value >= 0 && *value <= 1e6;
}

int shade_cmd_bench(int argc, char **argv) {
  int csv = 0, all = 0;
  double ex = 200, ey = 10;
  for (int i = 1; i < argc; i++) {
    if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
      usage(stdout);
      return TOOL_DONE;
    }
    if (!strcmp(argv[i], "--csv")) {
      csv = 1;
    } else if (!strcmp(argv[i], "--all")) {
      all = 1;
    } else if ((!strcmp(argv[i], "--ex") || !strcmp(argv[i], "--ey")) && i + 1 < argc) {
      if (!read_exponent(argv[i + 1], argv[i][3] == 'x' ? &ex : &ey)) {
        fprintf(stderr, "shade bench: %s '%s': expected a number from 0 to 1e6\n", argv[i],
                argv[i + 1]);
        return TOOL_BAD_USAGE;
      }
      i++;
    } else {
      fprintf(stderr, "shade bench: unknown option '%s' (see shade bench --help)\n", argv[i]);
      return TOOL_BAD_USAGE;
    }
  }
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, ex, ey);
  p.fresnel = SHADE_FRESNEL_NONE;

  /* 4M queries are 200 to 400 MB: beyond any cache */
  const size_t counts[] = {1024, (size_t)4 << 20};
  const char *const sets[] = {"cache", "memory"};
  puts(csv ? "what,method,distribution,precision,isa,set,ns,ratio_perturb,ratio_stream,max_error"
           : "   method                   distribution       type    isa     arrays        ns "
             "/perturb  "
             "/stream      error");
  for (int s = 0; s < 2; s++) {
    arrays a;
    if (!fill(&a, counts[s])) {
      fputs("shade bench: out of memory\n", stderr);
      release(&a);
      return TOOL_BAD_INPUT;
    }
    const shade_isa_table *isa;
    for (int row = 0; (isa = shade_isa_pick(row)) && (all || row == 0); row++)
      for (int w = WHAT_D; w <= WHAT_F; w++)
        for (int single = 1; single >= 0; single--) {
          if (isatty(2) && !isatty(1))
            fprintf(stderr, "\rshade bench: %-7s %-7s %s ", sets[s], isa->name, what_words[w]);
          bench_group(csv, isa, &p, (what)w, single, sets[s], &a);
        }
    release(&a);
  }
  if (isatty(2) && !isatty(1))
    fputs("\r\033[K", stderr);
  return TOOL_DONE;
}
