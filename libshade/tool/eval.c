/* SPDX-License-Identifier: Apache-2.0 */
/* shade eval: one query a line in, one answer a line out. */
#include <stdio.h>
#include <string.h>

#include "reference/reference.h"
#include "shade/shade.h"
#include "model/bsdf.h"
#include "tool/numbers.h"
#include "tool/parse.h"
#include "tool/text.h"
#include "tool/tool.h"

typedef enum precision {
  PRECISION_FAST,
  PRECISION_FLOAT,
  PRECISION_DOUBLE,
  PRECISION_REFERENCE
} precision;
typedef enum what { WHAT_D, WHAT_F, WHAT_DIFFUSE, WHAT_PDF, WHAT_SAMPLE } what;

static const char *const precision_words[] = {"fast", "float", "double", "reference", NULL};
static const char *const what_words[] = {"D", "f", "diffuse", "pdf", "sample", NULL};

typedef struct query {
  shade_params params;
  precision precision;
  what what;
} query;

/* How many numbers a line holds, and their names for a message. */
static int line_form(const query *q, const char **form) {
  static const char *const forms[] = {"nx ny nz hx hy hz", "nx ny nz wix wiy wiz wox woy woz",
                                      "lx ly lz", "nx ny nz wix wiy wiz wox woy woz",
                                      "nx ny nz wox woy woz u1 u2"};
  static const int counts[] = {6, 9, 3, 9, 8};
  if (q->what == WHAT_DIFFUSE && shade_diffuse_is(q->params.diffuse).sees) {
    *form = "lx ly lz vx vy vz";
    return 6;
  }
  *form = forms[q->what];
  return counts[q->what];
}

static void print_words(FILE *to, shade_list list) {
  const char *word;
  for (int row = 0; shade_list_row(list, row, NULL, &word, NULL, NULL); row++)
    fprintf(to, "%s%s", row ? " | " : "", word);
}

/* The plain formula: neither Fresnel nor a kinder horizon but on request. */
static shade_params initial_params(int defaults) {
  shade_params p;
  shade_params_init_as(&p, defaults);
  p.fresnel = SHADE_FRESNEL_NONE;
  p.horizon = SHADE_HORIZON_HARD;
  return p;
}

/* Which Fresnel they make. */
static void print_fresnel(FILE *to) {
  const shade_list list = SHADE_LIST_FRESNEL;
  const char *word;
  int value;
  for (int k = 0; shade_list_row(list, k, &value, &word, NULL, NULL); k++)
    if (tool_choice_stated(list, tool_numbers_of(list, value)) == value) {
      fputs("; with ", to);
      tool_print_numbers(to, tool_numbers_of(list, value));
      fprintf(to, " %s", word);
    }
}

static void print_initial_lobe(FILE *to, const shade_params *initial) {
  shade_param_info info;
  double v[3];
  const unsigned rows = tool_numbers_of(SHADE_LIST_MDF, (int)initial->mdf);
  for (int row = 0; shade_param_row(row, &info); row++)
    if (rows >> row & 1 && shade_params_get(initial, row, v) == SHADE_OK)
      fprintf(to, " --%s %g", info.word, *v);
}

/* What they differ in. */
static void print_older_defaults(FILE *to) {
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    for (int defaults = SHADE_DEFAULTS - 1; defaults >= 0; defaults--) {
      const int was = shade_list_default((shade_list)list, defaults);
      if (was != shade_list_default((shade_list)list, defaults + 1))
        fprintf(to, "; to %d: %s %s", defaults, shade_list_name((shade_list)list),
                shade_list_word((shade_list)list, was));
    }
}

static void usage(FILE *to) {
  const shade_params initial = initial_params(SHADE_DEFAULTS);
  fputs(
      "usage: shade eval [options] < queries\n\n"
      "  --what D|f|diffuse|pdf|sample   (default D)\n"
      "                           D: lines of nx ny nz hx hy hz -> D' in 1/sr\n"
      "                           f: lines of nx ny nz wix wiy wiz wox woy woz -> f in 1/sr\n"
      "                           diffuse: lines of lx ly lz (and vx vy vz, for the models that\n"
      "                           depend on the eye) -> Phi; fibre along x, normal z\n"
      "                           pdf: lines as for f -> density of drawing wi, in 1/sr\n"
      "                           sample: lines of nx ny nz wox woy woz u1 u2 -> wi, pdf and f;\n"
      "                           all 0 where the draw finds no direction. --precision\n"
      "                           reference: the draw of double, its pdf and f by the reference\n",
      to);
  for (int list = 0; list < SHADE_LIST_COUNT; list++) {
    if (list == SHADE_LIST_FRESNEL)
      continue;
    fprintf(to, "  --%-8s ", shade_list_name((shade_list)list));
    print_words(to, (shade_list)list);
    fprintf(to, "   (default %s)\n",
            shade_list_word((shade_list)list, shade_params_get_choice(&initial, (shade_list)list)));
  }
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    fprintf(to, "  --%-8s %s, %g to %g%s\n", info.word, info.help, info.minimum, info.maximum,
            info.components > 1 ? ", in every channel" : "");
  fputs("  --slopes   x,y,xx,xy,yy: of the map, for --horizon mutual: its mean slope, and the "
        "second\n"
        "             moment of slopes about it (default 0,0,0,0,0)\n",
        to);
  fputs("  (default", to);
  print_initial_lobe(to, &initial);
  fprintf(to, ")\n  --defaults 0 to %d, the version of the defaults (default %d)", SHADE_DEFAULTS,
          SHADE_DEFAULTS);
  print_older_defaults(to);
  fputs("\n\nThe lobe is stated by ", to);
  tool_print_statements(to, SHADE_LIST_MDF);
  fputs(".\nFresnel is 1", to);
  print_fresnel(to);
  fputs(".\nf includes the diffuse part with --kd.\n\n"
        "  --precision float|double|reference   (default double; fast, of older versions, is "
        "float)\n\n"
        "Frame: x tangent, z unperturbed normal, n perturbed normal; unit vectors, wi to\n"
        "the light, wo to the eye. Blank lines and lines that begin with # are skipped.\n"
        "Answers are in %.17g (float: %.9g). Words read - and _ alike.\n",
        to);
}

static int bad_usage(const char *option, const char *value, const char *expected) {
  fprintf(stderr, "shade eval: %s '%s': expected %s\n", option, value, expected);
  return TOOL_BAD_USAGE;
}

static int find_word(const char *const *words, const char *word) {
  for (int i = 0; words[i]; i++)
    if (!strcmp(words[i], word))
      return i;
  return -1;
}

static int set_choice(query *q, shade_list list, const char *word) {
  const int value = shade_list_find(list, word);
  if (value >= 0) {
    shade_params_set_choice(&q->params, list, value);
    return TOOL_DONE;
  }
  fprintf(stderr, "shade eval: --%s '%s': expected ", shade_list_name(list), word);
  print_words(stderr, list);
  fputs("\n", stderr);
  return TOOL_BAD_USAGE;
}

/* One number for all components of a row. */
static int set_number(query *q, int row, const char *option, const char *value) {
  enum { MOST = 3 };
  shade_param_info info;
  double number, v[MOST];
  char range[80];
  if (!tool_parse_number(value, &number))
    return bad_usage(option, value, "a number");
  shade_param_row(row, &info);
  for (int i = 0; i < MOST; i++)
    v[i] = number;
  if (shade_params_set(&q->params, row, v) == SHADE_OK)
    return TOOL_DONE;
  snprintf(range, sizeof range, "a number from %g to %g: this one is out of range", info.minimum,
           info.maximum);
  return bad_usage(option, value, range);
}

/* Five numbers with commas between them. */
static int set_slopes(query *q, const char *option, const char *value) {
  static const char *const expected =
      "x,y,xx,xy,yy: mean slope from -1e3 to 1e3, moments from 0 to 1e6, |xy| at most sqrt(xx yy)";
  char text[200];
  double v[5];
  if (strlen(value) >= sizeof text)
    return bad_usage(option, value, expected);
  strcpy(text, value);
  char *at = text;
  for (int i = 0; i < 5; i++) {
    char *comma = strchr(at, ',');
    if (!comma != (i == 4))
      return bad_usage(option, value, expected);
    if (comma)
      *comma = 0;
    if (!tool_parse_number(at, &v[i]))
      return bad_usage(option, value, expected);
    at = comma ? comma + 1 : at;
  }
  return shade_params_set_slopes(&q->params, v) == SHADE_OK ? TOOL_DONE
                                                            : bad_usage(option, value, expected);
}

/* Fresnel follows from which of its numbers were given. */
static int choose_fresnel(query *q, unsigned given) {
  const shade_list list = SHADE_LIST_FRESNEL;
  const unsigned stated = given & tool_numbers_of_any(list);
  const int value = tool_choice_stated(list, stated);
  if (value >= 0)
    shade_params_set_choice(&q->params, list, value);
  if (!stated || value >= 0)
    return TOOL_DONE;
  fputs("shade eval: Fresnel is ", stderr);
  tool_print_statements(stderr, list);
  fputs("\n", stderr);
  return TOOL_BAD_USAGE;
}

/* The list that an option is called after, or SHADE_LIST_COUNT. Fresnel follows from numbers. */
static shade_list find_list(const char *name) {
  int list = 0;
  while (list < SHADE_LIST_COUNT &&
         (list == SHADE_LIST_FRESNEL || strcmp(name, shade_list_name((shade_list)list)) != 0))
    list++;
  return (shade_list)list;
}

static int takes_value(const char *option) {
  return find_list(option + 2) != SHADE_LIST_COUNT || shade_param_find(option + 2) >= 0 ||
         !strcmp(option, "--defaults") || !strcmp(option, "--precision") ||
         !strcmp(option, "--slopes") || !strcmp(option, "--what");
}

/* Sets what an option of takes_value says. Numbers that were given are noted in *given, a bit each
 * row. */
static int read_option(query *q, const char *option, const char *value, unsigned *given) {
  const shade_list list = find_list(option + 2);
  const int row = shade_param_find(option + 2);
  if (list != SHADE_LIST_COUNT)
    return set_choice(q, list, value);
  if (row >= 0) {
    *given |= 1u << row;
    return set_number(q, row, option, value);
  }
  if (!strcmp(option, "--defaults")) /* before all others */
    return TOOL_DONE;
  if (!strcmp(option, "--slopes"))
    return set_slopes(q, option, value);
  if (!strcmp(option, "--precision")) {
    const int k = find_word(precision_words, value);
    if (k < 0)
      return bad_usage(option, value, "fast, float, double or reference");
    q->precision = k == PRECISION_FAST ? PRECISION_FLOAT : (precision)k;
    if (k == PRECISION_FAST)
      fputs("shade eval: --precision fast: there is no such form any more; this is float\n",
            stderr);
    return TOOL_DONE;
  }
  const int k = find_word(what_words, value);
  if (k < 0)
    return bad_usage(option, value, "D, f, diffuse, pdf or sample");
  q->what = (what)k;
  return TOOL_DONE;
}

/* What all else is said on top of, wherever it stands. */
static int read_defaults(query *q, int argc, char **argv) {
  int64_t defaults;
  char range[40];
  for (int i = 1; i + 1 < argc; i += 2)
    if (!strcmp(argv[i], "--defaults")) {
      if (!tool_parse_whole(argv[i + 1], 0, SHADE_DEFAULTS, &defaults)) {
        snprintf(range, sizeof range, "a whole number from 0 to %d", SHADE_DEFAULTS);
        return bad_usage(argv[i], argv[i + 1], range);
      }
      q->params = initial_params((int)defaults);
    }
  return TOOL_DONE;
}

/* Returns TOOL_DONE, or the exit status after printing why; *help asks for the usage text. */
static int read_options(query *q, int argc, char **argv, int *help) {
  unsigned given = 0;
  int status = read_defaults(q, argc, argv);
  for (int i = 1; status == TOOL_DONE && i < argc; i += 2) {
    const char *option = argv[i];
    if (!strcmp(option, "--help") || !strcmp(option, "-h")) {
      *help = 1;
      return TOOL_DONE;
    }
    if (strncmp(option, "--", 2)) {
      fprintf(stderr, "shade eval: unexpected argument '%s' (see shade eval --help)\n", option);
      return TOOL_BAD_USAGE;
    }
    if (!takes_value(option)) {
      fprintf(stderr, "shade eval: unknown option '%s' (see shade eval --help)\n", option);
      return TOOL_BAD_USAGE;
    }
    if (i + 1 == argc) {
      fprintf(stderr, "shade eval: option '%s' lacks its value\n", option);
      return TOOL_BAD_USAGE;
    }
    status = read_option(q, option, argv[i + 1], &given);
  }
  if (status == TOOL_DONE)
    status = choose_fresnel(q, given);
  return status == TOOL_DONE ? tool_whole_lobe("eval", given) : status;
}

/* The answer; status bits tell what was wrong with the directions. */
static double answer(const query *q, const shade_bsdf *b, const double *v, unsigned *status) {
  float vf[9], ff[3];
  double f[3];
  const char *unused;
  for (int i = 0; i < line_form(q, &unused); i++)
    vf[i] = (float)v[i];
  if (q->what == WHAT_DIFFUSE) {
    shade_diffuse model = q->params.diffuse;
    const int less = shade_diffuse_is(model).less_f0 && q->params.fresnel != SHADE_FRESNEL_NONE;
    const double left = less ? 1 - q->params.f0[0] : 1;
    return left * (q->precision == PRECISION_FLOAT ? (double)shade_diffuse_evalf(model, vf, vf + 3)
                   : q->precision == PRECISION_DOUBLE ? shade_diffuse_eval(model, v, v + 3)
                                                      : shade_ref_diffuse(model, v, v + 3));
  }
  switch (q->precision) {
  case PRECISION_FLOAT:
    if (q->what == WHAT_D)
      return (double)shade_mdf_evalf(b, vf, vf + 3, status);
    if (q->what == WHAT_PDF)
      return (double)shade_bsdf_pdff(b, vf, vf + 3, vf + 6, status);
    *status |= shade_bsdf_evalf(b, vf, vf + 3, vf + 6, ff, NULL);
    return (double)ff[0];
  case PRECISION_DOUBLE:
    if (q->what == WHAT_D)
      return shade_mdf_eval(b, v, v + 3, status);
    if (q->what == WHAT_PDF)
      return shade_bsdf_pdf(b, v, v + 3, v + 6, status);
    *status |= shade_bsdf_eval(b, v, v + 3, v + 6, f, NULL);
    return f[0];
  default:
    if (q->what == WHAT_D)
      return shade_ref_mdf(&q->params, v, v + 3);
    if (q->what == WHAT_PDF)
      return shade_ref_pdf(&q->params, v, v + 3, v + 6);
    *status |= shade_ref_f(&q->params, v, v + 3, v + 6, f, NULL);
    return f[0];
  }
}

/* A draw: wi, pdf and f. Returns status bits. */
static unsigned draw(const query *q, const shade_bsdf *b, const double *v, double out[5]) {
  double f[3], pdf;
  float vf[8], wif[3], ff[3], pdff;
  unsigned status;
  if (q->precision == PRECISION_FLOAT) {
    for (int i = 0; i < 8; i++)
      vf[i] = (float)v[i];
    status = shade_bsdf_samplef(b, vf, vf + 3, vf + 6, wif, ff, &pdff, NULL);
    for (int i = 0; i < 3; i++)
      out[i] = (double)wif[i];
    pdf = (double)pdff;
    f[0] = (double)ff[0];
  } else {
    status = shade_bsdf_sample(b, v, v + 3, v + 6, out, f, &pdf, NULL);
    if (q->precision == PRECISION_REFERENCE && pdf > 0) {
      pdf = shade_ref_pdf(&q->params, v, out, v + 3);
      shade_ref_f(&q->params, v, out, v + 3, f, NULL);
    }
  }
  out[3] = pdf;
  out[4] = f[0];
  return status;
}

int shade_cmd_eval(int argc, char **argv) {
  query q = {
      .precision = PRECISION_DOUBLE, .what = WHAT_D, .params = initial_params(SHADE_DEFAULTS)};
  int help = 0;
  int status = read_options(&q, argc, argv, &help);
  if (help)
    usage(stdout);
  if (status || help)
    return status;
  shade_bsdf b;
  shade_bsdf_setup(&b, &q.params);

  tool_lines in = {.title = "eval"};
  double v[9];
  const int count = line_form(&q, &in.form);
  while (tool_next_line(&in, count, 0, v) > 0) {
    unsigned mended = SHADE_OK;
    const int digits = q.precision == PRECISION_FLOAT ? 9 : 17;
    if (q.what == WHAT_SAMPLE) {
      double drawn[5];
      mended = draw(&q, &b, v, drawn);
      for (int i = 0; i < 5; i++)
        printf("%.*g%c", digits, drawn[i], i < 4 ? ' ' : '\n');
    } else
      printf("%.*g\n", digits, answer(&q, &b, v, &mended));
    if (mended & SHADE_BAD_INPUT)
      fprintf(stderr, "shade eval: standard input, line %ld: warning: no such direction: 0\n",
              in.number);
    else if (mended & SHADE_CLAMPED_NORMAL)
      fprintf(stderr, "shade eval: standard input, line %ld: warning: n lifted to nz = 1e-4\n",
              in.number);
  }
  return tool_end_lines(&in);
}
