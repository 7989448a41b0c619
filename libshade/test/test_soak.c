/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 14 */
/*
 * Stability: every entry of every instruction set, on random and structured materials and
 * directions. No NaN, infinity or negative value may come out, the status must say what was
 * mended, and finite input must raise no floating-point exception (invalid, division by zero,
 * overflow): where the hardware can, they are trapped.
 *
 * A case is one normal and two directions in one material; all entries shade it. Without
 * arguments this is a cmocka test of every combination of choices, a million cases (fewer of each
 * under sanitizers); `make soak` runs a hundred million and prints a table. See --help.
 */
#define _GNU_SOURCE /* feenableexcept, sysconf, siginfo_t */
#include <fenv.h>
#include <float.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "support.h"

#include "soak_maps.h"

#if defined(__GLIBC__) && defined(__x86_64__)
#define CAN_TRAP 1
#else
#define CAN_TRAP 0
#endif

/* Inputs: directions, f0, u, then what a lane may have of its own from ax on, as in shade_lanes. */
enum { LANES = 300, DIRECTIONS = 9, U = 12, OWN = 14, OWNS = 18, INPUTS = OWN + OWNS };
enum { OUTPUTS = 8, ISAS = 4 };
/* a whole pass of batches, and up to seven lanes beyond */
enum { FEW = 48 / FEWER };
enum { OWN_F82 = 4, OWN_ETA = 7, OWN_K = 10, OWN_KD = 13, OWN_GROOVE = 16 };
enum { EXCEPTIONS = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW };

/* The entries: what is asked for, one sample a call or all at once, in which precision. */
typedef enum what {
  D_ONE,
  D_BATCH,
  F_ONE,
  F_BATCH,
  PDF_ONE,
  PDF_BATCH,
  DRAW_ONE,
  DRAW_BATCH,
  PHI,
  WHATS
} what;
typedef enum form { DOUBLE, FLOAT, FORMS } form;
static const char *const what_names[WHATS] = {
    "D", "D batch", "f", "f batch", "pdf", "pdf batch", "sample", "sample batch", "diffuse"};

static int is_batch(what q) {
  return q == D_BATCH || q == F_BATCH || q == PDF_BATCH || q == DRAW_BATCH;
}

static int is_draw(what q) {
  return q == DRAW_ONE || q == DRAW_BATCH;
}
static const char *const form_names[FORMS] = {"double", "float"};

/* What was seen of one entry of one instruction set. */
typedef struct finding {
  uint64_t values, not_finite, negative, too_large, wrong_status, raised;
  double largest; /* D / peak, f / peak, pdf, Phi */
} finding;

static uint64_t failures(const finding *f) {
  return f->not_finite + f->negative + f->too_large + f->wrong_status + f->raised;
}

/* A block of cases of one material, and where its results go. */
typedef struct worker {
  pthread_t thread;
  uint64_t seed, block;
  shade_params params;
  shade_bsdf bsdf;
  size_t count;
  int finite; /* all input of this block is */
  int textured;
  unsigned given;           /* bit k: input OWN + k is */
  size_t volatile lane;     /* where a trap found the single calls */
  unsigned facts[2][LANES]; /* what is wrong with each lane, in double and in float */
  double v[LANES][DIRECTIONS], in[INPUTS][LANES], out[OUTPUTS][LANES];
  float vf[LANES][DIRECTIONS], inf[INPUTS][LANES], outf[OUTPUTS][LANES];
  unsigned status[LANES];
  finding found[ISAS][WHATS][FORMS];
  uint64_t cases;
} worker;

/* One run, of as many threads as asked for. */
static struct {
  uint64_t seed, first, blocks, told, tell; /* failures told, and to tell at most */
  atomic_uint_fast64_t next, done;
  atomic_int stop;
  pthread_mutex_t lock;
} run = {.tell = 12, .lock = PTHREAD_MUTEX_INITIALIZER};

/* ---- input ---- */

static double pick(worker *w, const double *list, size_t size) {
  return list[(size_t)(uniform(&w->seed) * (double)size)];
}
#define PICK(w, list) pick(w, list, sizeof list / sizeof list[0])

static int chance(worker *w, double p) {
  return uniform(&w->seed) < p;
}

/* A number of any size below 1, down to the denormals of either precision. */
static double small(worker *w) {
  static const double depth[] = {20, 60, 149, 1074};
  return ldexp(1 + uniform(&w->seed), -1 - (int)(uniform(&w->seed) * PICK(w, depth)));
}

static double either_sign(worker *w, double x) {
  return chance(w, .5) ? x : -x;
}

static void set(double v[3], double x, double y, double z) {
  v[0] = x, v[1] = y, v[2] = z;
}

static void make_unit(double v[3]) {
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (length > 0 && length < 1e150)
    for (int c = 0; c < 3; c++)
      v[c] /= length;
}

static void on_sphere(worker *w, double v[3]) {
  double r2;
  do {
    for (int c = 0; c < 3; c++)
      v[c] = 2 * uniform(&w->seed) - 1;
    r2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  } while (r2 > 1 || r2 < 1e-4);
  make_unit(v);
}

static void direction(worker *w, double v[3]) {
  static const double odd[] = {0,       -0.0,     1,       -1,      .5,           -.5,
                               1e-20,   1e-38,    -1e-40,  1e-45,   1e9,          -1e18,
                               1e19,    1.8e19,   2e19,    -1e30,   FLT_MAX,      -FLT_MAX,
                               1e40,    1.3e154,  1e155,   -1e300,  1e-155,       1e-160,
                               DBL_MAX, -DBL_MAX, DBL_MIN, FLT_MIN, DBL_TRUE_MIN, FLT_TRUE_MIN};
  static const double none[] = {NAN, INFINITY, -INFINITY};
  on_sphere(w, v);
  switch ((int)(uniform(&w->seed) * 16)) {
  default: /* over the horizon */
    v[2] = fabs(v[2]);
    break;
  case 0: /* anywhere */
    break;
  case 1: /* along an axis */
    set(v, 0, 0, 0);
    v[(int)(uniform(&w->seed) * 3)] = either_sign(w, 1);
    break;
  case 2: /* grazing */
    v[2] = 0;
    make_unit(v);
    v[2] = small(w);
    break;
  case 3: /* along y, where groove transport ends, or x */
    set(v, either_sign(w, small(w)), either_sign(w, 1), small(w));
    if (chance(w, .3))
      set(v, v[1], v[0], v[2]);
    break;
  case 4: /* along z */
    set(v, either_sign(w, small(w)), either_sign(w, small(w)), 1);
    break;
  case 5: /* in the plane of a tangent */
    v[chance(w, .5)] = 0;
    make_unit(v);
    v[2] = fabs(v[2]);
    break;
  case 6: /* of any length */
    for (int c = 0,
             k = (int)((uniform(&w->seed) * 2 - 1) * PICK(w, ((double[]){1, 60, 127, 1023})));
         c < 3; c++)
      v[c] = ldexp(v[c], k);
    break;
  case 7: /* any three numbers */
    for (int c = 0; c < 3; c++)
      v[c] = chance(w, .3) ? v[c] : PICK(w, odd);
    break;
  case 8: /* not quite unit */
    for (int c = 0, k = (int)(uniform(&w->seed) * 50); c < 3; c++)
      v[c] *= 1 + ldexp(1, -k);
  }
  if (!w->finite && chance(w, .1))
    v[(int)(uniform(&w->seed) * 3)] = PICK(w, none);
}

static void mirror(const double n[3], const double from[3], double to[3]) {
  double d = n[0] * from[0] + n[1] * from[1] + n[2] * from[2];
  for (int c = 0; c < 3; c++)
    to[c] = 2 * d * n[c] - from[c];
}

static void near(worker *w, const double centre[3], double v[3]) {
  for (int c = 0; c < 3; c++)
    v[c] = centre[c] + either_sign(w, small(w));
  make_unit(v);
}

/* n, wi, wo: on their own, or where something coincides. wi also stands for h. */
static void directions(worker *w, double v[DIRECTIONS]) {
  double *n = v, *wi = v + 3, *wo = v + 6;
  const double z[3] = {0, 0, 1};
  direction(w, n);
  direction(w, wi);
  direction(w, wo);
  double *const longest[] = {n, wi, wo};
  for (int k = 0; k < 3; k++)
    if (!(fabs(longest[k][0]) + fabs(longest[k][1]) + fabs(longest[k][2]) < 1e100))
      return; /* what follows would overflow */
  if (chance(w, .5))
    return;
  switch ((int)(uniform(&w->seed) * 12)) {
  case 0:
    memcpy(wo, wi, 3 * sizeof *wo);
    break;
  case 1:
    set(wo, -wi[0], -wi[1], -wi[2]);
    break;
  case 2: /* nearly opposite */
    set(wo, -wi[0], -wi[1], -wi[2]);
    near(w, wo, wo);
    break;
  case 3: /* half vector along n */
    mirror(n, wi, wo);
    break;
  case 4: /* ... and along z */
    mirror(z, wi, wo);
    break;
  case 5:
    memcpy(wi, n, 3 * sizeof *wi);
    break;
  case 6:
    near(w, n, wi);
    break;
  case 7:
    set(wi, -n[0], -n[1], -n[2]);
    break;
  case 8:
    memcpy(n, z, sizeof z);
    break;
  case 9:
    near(w, z, n);
    break;
  case 10: /* all one */
    memcpy(wi, n, 3 * sizeof *wi);
    memcpy(wo, n, 3 * sizeof *wo);
    break;
  default: /* half vector along the tangent, and its like */
    set(wo, wi[0], -wi[1], -wi[2]);
  }
}

static float narrow(double x) {
  return isfinite(x) ? (float)fmin(fmax(x, -(double)FLT_MAX), (double)FLT_MAX) : (float)x;
}

/* Choice `k` of `count`, and what remains of a number that counts through all combinations. */
static int digit(uint64_t *rest, int count) {
  int k = (int)(*rest % (uint64_t)count);
  *rest /= (uint64_t)count;
  return k;
}

enum {
  COMBINATIONS = SHADE_MDF_COUNT * SHADE_BRDF_COUNT * SHADE_DETAIL_COUNT * SHADE_GROOVE_COUNT *
                 SHADE_FRESNEL_COUNT * SHADE_DIFFUSE_COUNT,
  STRIDE = 7919 /* a prime that divides no count: neighbours differ, all are met */
};

static double exponent(worker *w) {
  return chance(w, .2) ? 0 : chance(w, .2) ? 1e6 : pow(10, 9 * uniform(&w->seed) - 3);
}

static double alpha(worker *w) {
  return chance(w, .2) ? 1e-4 : chance(w, .2) ? 10 : pow(10, 5 * uniform(&w->seed) - 4);
}

static double share(worker *w) {
  return chance(w, .2) ? 0 : chance(w, .2) ? 1 : uniform(&w->seed);
}

/* Returns the status that setup must give; *finite: no parameter is NaN or infinite. */
static unsigned material(worker *w, int *finite) {
  static const double beyond[] = {-1, -1e-300, 2e6, DBL_MAX, -DBL_MAX, NAN, INFINITY, -INFINITY};
  shade_params *p = &w->params;
  uint64_t k = w->block * STRIDE % COMBINATIONS;
  shade_params_init(p);
  p->mdf = (shade_mdf)digit(&k, SHADE_MDF_COUNT);
  p->detail = (shade_detail)digit(&k, SHADE_DETAIL_COUNT);
  p->brdf = (shade_brdf)digit(&k, SHADE_BRDF_COUNT);
  p->groove = (shade_groove)digit(&k, SHADE_GROOVE_COUNT);
  p->fresnel = (shade_fresnel)digit(&k, SHADE_FRESNEL_COUNT);
  p->diffuse = (shade_diffuse)digit(&k, SHADE_DIFFUSE_COUNT);
  p->horizon = SHADE_HORIZON_HARD;
  if (chance(w, .5)) /* as often as all others: the one that the others build upon */
    p->horizon = (shade_horizon)(uniform(&w->seed) * SHADE_HORIZON_COUNT);
  p->ex = fmin(exponent(w), 1e6);
  p->ey = chance(w, .2) ? p->ex : fmin(exponent(w), 1e6);
  p->ax = fmin(alpha(w), 10);
  p->ay = chance(w, .2) ? p->ax : fmin(alpha(w), 10);
  for (int c = 0; c < 3; c++) {
    p->f0[c] = share(w);
    p->f82[c] = share(w);
    p->kd[c] = w->block & 1 ? share(w) : 0;
    p->eta[c] = pow(10, 5 * share(w) - 3);
    p->k[c] = chance(w, .2) ? 0 : pow(10, 4 * share(w) - 2);
  }
  *finite = 1;
  if (!chance(w, .1))
    return SHADE_OK;
  double *any[] = {&p->ex, &p->ey, &p->ax, &p->ay, p->f0, p->f82 + 1, p->kd + 2, p->eta, p->k + 1};
  double x = PICK(w, beyond);
  *any[(int)(uniform(&w->seed) * (double)(sizeof any / sizeof any[0]))] = x;
  *finite = isfinite(x);
  return SHADE_CLAMPED_PARAMETER;
}

static void fill(worker *w) {
  static const double beyond[] = {-1, 2, 1e30, -1e300, DBL_MAX, 1e-310};
  w->count = w->block % 64 == 63 ? LANES : FEW + (size_t)(w->block % 8);
  w->finite = w->block % 4 != 0;
  w->textured = w->block % 3 == 0;
  w->given = w->textured ? (unsigned)(uniform(&w->seed) * (1 << OWNS)) : 0;
  if ((w->given >> OWN_GROOVE) % 3) /* both components, or neither */
    w->given |= 3u << OWN_GROOVE;
  for (size_t i = 0; i < w->count; i++) {
    directions(w, w->v[i]);
    for (int c = 0; c < INPUTS; c++) {
      /* v, f0, u */
      double x = c < DIRECTIONS ? w->v[i][c] : chance(w, .2) ? PICK(w, beyond) : share(w);
      if (c >= OWN && chance(w, .5))
        x = c < OWN + 2         ? alpha(w)
            : c < OWN + OWN_F82 ? exponent(w)
                                : 10 * share(w) - chance(w, .5);
      if (c >= DIRECTIONS && !w->finite && chance(w, .1))
        x = chance(w, .5) ? NAN : INFINITY;
      w->in[c][i] = x;
      w->inf[c][i] = narrow(x);
      if (c < DIRECTIONS)
        w->vf[i][c] = narrow(x);
    }
  }
}

/* ---- what comes out ---- */

static void tell(worker *w, const shade_isa_table *isa, const char *entry, const char *precision,
                 size_t i, const char *wrong) {
  pthread_mutex_lock(&run.lock);
  if (run.told++ < run.tell) {
    char json[2048];
    shade_params_json(&w->params, 0, NULL, json, sizeof json);
    fprintf(stderr, "%s, %s, %s: %s (--seed %llu --block %llu, lane %zu)\n  %s\n ", entry,
            precision, isa ? isa->name : "", wrong, (unsigned long long)run.seed,
            (unsigned long long)w->block, i, json);
    for (int c = 0; c < INPUTS && i < w->count; c++)
      fprintf(stderr, " %.17g", w->in[c][i]);
    fputs("\n", stderr);
  }
  pthread_mutex_unlock(&run.lock);
}

typedef struct answer {
  double value[3], cosine, pdf, wi[3];
} answer;

static answer answer_of(const worker *w, what q, form p, size_t i) {
  answer a = {{0, 0, 0}, 0, 0, {0, 0, 0}};
  double out[OUTPUTS];
  int colours = q == F_ONE || q == F_BATCH || is_draw(q);
  for (int k = 0; k < OUTPUTS; k++)
    out[k] = p == DOUBLE ? w->out[k][i] : (double)w->outf[k][i];
  for (int c = 0; c < 3; c++) {
    a.value[c] = !c || colours ? out[c] : 0;
    a.wi[c] = is_draw(q) ? out[5 + c] : 0;
  }
  a.cosine = colours ? out[3] : 0;
  a.pdf = is_draw(q) ? out[4] : 0;
  return a;
}

static int is_direction(const double *v, const float *vf, form p) {
  int finite = 1, zero = 1;
  for (int c = 0; c < 3; c++) {
    double x = p == DOUBLE ? v[c] : (double)vf[c];
    finite &= isfinite(x) != 0;
    zero &= x == 0;
  }
  return finite && !zero;
}

static double own_number(const worker *w, form p, int k, size_t i) {
  return p == DOUBLE ? w->in[OWN + k][i] : (double)w->inf[OWN + k][i];
}

/* Of the parameters that lane i has of its own, and that are read. */
static unsigned status_of_own(const worker *w, form p, size_t i) {
  const int exponents = w->params.mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY;
  const double least_alpha = p == DOUBLE ? 1e-4 : (double)1e-4F;
  const double least_eta = p == DOUBLE ? 1e-3 : (double)1e-3F;
  unsigned status = SHADE_OK;
  for (int k = 0; k < OWN_GROOVE; k++) {
    const double v = own_number(w, p, k, i);
    const int other = k < 2 ? k + 2 : k - 2; /* the exponent of an alpha, and the other way */
    double low = 0, high = 1;
    int read = w->given >> k & 1;
    if (k < OWN_F82) {
      read &= (k >= 2) == exponents || !(w->given >> other & 1);
      low = k < 2 ? least_alpha : 0;
      high = k < 2 ? 10 : 1e6;
    } else if (k < OWN_ETA) {
      read &= w->params.fresnel == SHADE_FRESNEL_F82;
    } else if (k < OWN_KD) {
      read &= w->params.fresnel == SHADE_FRESNEL_CONDUCTOR;
      low = k < OWN_K ? least_eta : 0;
      high = 100;
    }
    if (read && !(v >= low && v <= high))
      status |= SHADE_CLAMPED_PARAMETER;
  }
  if (w->given >> OWN_GROOVE) {
    const double x = own_number(w, p, OWN_GROOVE, i), y = own_number(w, p, OWN_GROOVE + 1, i);
    const double least = p == DOUBLE ? DBL_MIN : (double)FLT_MIN;
    if (!isfinite(x) || !isfinite(y) || !(fmax(fabs(x), fabs(y)) >= least))
      status |= SHADE_CLAMPED_PARAMETER;
  }
  return status;
}

/* Within some roundings: whether wi + wo is 0 then depends on them. */
static int nearly_opposite(const worker *w, form p, size_t i) {
  long double v[6], length[2], sum = 0; /* whose range holds any square */
  for (int c = 0; c < 6; c++)
    v[c] = p == DOUBLE ? (long double)w->v[i][3 + c] : (long double)w->vf[i][3 + c];
  for (int k = 0; k < 2; k++)
    length[k] =
        sqrtl(v[3 * k] * v[3 * k] + v[3 * k + 1] * v[3 * k + 1] + v[3 * k + 2] * v[3 * k + 2]);
  for (int c = 0; c < 3; c++)
    sum += fabsl(v[c] / length[0] + v[3 + c] / length[1]);
  return sum < 1e-5L;
}

/* n.z is above 0, but perhaps not after a division by the length of n. */
static int nearly_below(const worker *w, form p, size_t i) {
  long double n[3];
  for (int c = 0; c < 3; c++)
    n[c] = p == DOUBLE ? (long double)w->v[i][c] : (long double)w->vf[i][c];
  long double least = p == DOUBLE ? (long double)DBL_TRUE_MIN : (long double)FLT_TRUE_MIN;
  return n[2] > 0 && n[2] < 8 * least * sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Of a lane, whatever is asked of it: found once for all entries of all instruction sets. */
enum {
  NO_NORMAL = 1, /* no direction, as the two that follow */
  NO_WI = 2,
  NO_WO = 4,
  NO_NUMBER = 8,         /* u1 or u2 */
  NORMAL_BELOW = 16,     /* a normal that is no direction counts as z */
  F0_OUTSIDE = 32,       /* of [0, 1] */
  OWN_MENDED = 64,       /* of the lane's own parameters */
  NEARLY_OPPOSITE = 128, /* wi and wo */
  NEARLY_BELOW = 256     /* n */
};

static unsigned facts_of(const worker *w, form p, size_t i) {
  const double nz = p == DOUBLE ? w->v[i][2] : (double)w->vf[i][2];
  unsigned facts = 0;
  for (int k = 0; k < 3; k++)
    if (!is_direction(w->v[i] + 3 * k, w->vf[i] + 3 * k, p))
      facts |= (unsigned)NO_NORMAL << k;
  if (isnan(w->in[U][i]) || isnan(w->in[U + 1][i]))
    facts |= NO_NUMBER;
  for (int c = 9; c < 12; c++) {
    const double f0 = p == DOUBLE ? w->in[c][i] : (double)w->inf[c][i];
    if (!(f0 >= 0 && f0 <= 1))
      facts |= F0_OUTSIDE;
  }
  if (!(facts & NO_NORMAL) && !(nz > 0))
    facts |= NORMAL_BELOW;
  if (status_of_own(w, p, i) != SHADE_OK)
    facts |= OWN_MENDED;
  if (nearly_opposite(w, p, i))
    facts |= NEARLY_OPPOSITE;
  if (nearly_below(w, p, i))
    facts |= NEARLY_BELOW;
  return facts;
}

/* The status bits that lane i must have, but for the luck of a draw; bad lanes are also 0. */
static unsigned wanted_status(const worker *w, what q, form p, size_t i) {
  const unsigned facts = w->facts[p != DOUBLE][i];
  const unsigned read = q == D_ONE || q == D_BATCH ? NO_NORMAL | NO_WI
                        : is_draw(q)               ? NO_NORMAL | NO_WO | NO_NUMBER
                                                   : NO_NORMAL | NO_WI | NO_WO;
  const int varies = is_batch(q) && q != D_BATCH;
  unsigned status = facts & read ? SHADE_BAD_INPUT : SHADE_OK;
  if (varies && ((facts & OWN_MENDED) || (w->textured && (facts & F0_OUTSIDE))))
    status |= SHADE_CLAMPED_PARAMETER;
  if (facts & NORMAL_BELOW)
    status |= SHADE_CLAMPED_NORMAL;
  return status;
}

/* What is wrong with a draw, NULL if nothing is. */
static const char *wrong_draw(const answer *a, unsigned want, double slack) {
  double length2 = 0;
  int all_finite = isfinite(a->pdf);
  for (int c = 0; c < 3; c++) {
    length2 += a->wi[c] * a->wi[c];
    all_finite &= isfinite(a->wi[c]);
  }
  if (!all_finite)
    return "wi or pdf not finite";
  if (a->pdf < 0)
    return "pdf negative";
  if (a->pdf == 0)
    return length2 + a->cosine + a->value[0] + a->value[1] + a->value[2] == 0
               ? NULL
               : "no sample, and not 0";
  if (want & SHADE_BAD_INPUT)
    return "a sample from bad input";
  return fabs(length2 - 1) <= 2 * slack && a->wi[2] > 0 ? NULL : "wi not unit, or below";
}

/* What is wrong with a pdf: it must be 0 where light or eye are below the surface. */
static const char *wrong_pdf(const worker *w, form p, size_t i, double pdf) {
  double wiz = p == DOUBLE ? w->v[i][5] : (double)w->vf[i][5];
  double woz = p == DOUBLE ? w->v[i][8] : (double)w->vf[i][8];
  return (wiz <= 0 || woz <= 0) && pdf != 0 ? "pdf below the surface" : NULL;
}

static void inspect(worker *w, const shade_isa_table *isa, int row, what q, form p) {
  finding *found = &w->found[row][q][p];
  const double slack = p == DOUBLE ? 1.2e-14 : 2.4e-6; /* as libshade takes vectors for unit */
  unsigned all = SHADE_OK, unsure = 0;                 /* unsure: bits that roundings decide */
  for (size_t i = 0; i < w->count; i++) {
    answer a = answer_of(w, q, p, i);
    const char *wrong = NULL;
    const unsigned want = wanted_status(w, q, p, i), facts = w->facts[p != DOUBLE][i];
    for (int c = 0; c < 3; c++) {
      if (!isfinite(a.value[c]))
        wrong = "not finite", found->not_finite++;
      else if (a.value[c] < 0)
        wrong = "negative", found->negative++;
      else if ((want & SHADE_BAD_INPUT) && q != PHI && a.value[c] != 0)
        wrong = "not 0 for bad input", found->wrong_status++;
      double scale =
          q == PHI || q == PDF_ONE || q == PDF_BATCH ? 1 : bsdf_of(&w->bsdf)->numbers.peak;
      if (a.value[c] / scale > found->largest)
        found->largest = a.value[c] / scale;
    }
    if (!(a.cosine >= 0 && a.cosine <= 1 + slack))
      wrong = "cosine out of [0, 1]", found->too_large++;
    if (q == PHI && a.value[0] > PI / 2 + slack)
      wrong = "Phi above pi/2", found->too_large++;
    const char *other = is_draw(q)                       ? wrong_draw(&a, want, slack)
                        : q == PDF_ONE || q == PDF_BATCH ? wrong_pdf(w, p, i, a.value[0])
                                                         : NULL;
    if (other)
      wrong = other, found->not_finite++;
    unsigned luck = is_draw(q) && a.pdf == 0 ? SHADE_NO_SAMPLE : 0;
    int pair = q == F_ONE || q == F_BATCH || q == PDF_ONE || q == PDF_BATCH;
    unsigned open =
        pair && !(want & SHADE_BAD_INPUT) && (facts & NEARLY_OPPOSITE) ? SHADE_BAD_INPUT : 0;
    if (facts & NEARLY_BELOW)
      open |= SHADE_CLAMPED_NORMAL;
    if (q != PHI && !is_batch(q)) {
      if ((w->status[i] ^ (want | luck)) & ~open)
        wrong = "wrong status", found->wrong_status++;
      if ((w->status[i] & SHADE_BAD_INPUT) && a.value[0] + a.value[1] + a.value[2] != 0)
        wrong = "not 0 for bad input", found->wrong_status++;
    }
    all |= want | luck;
    unsure |= open;
    found->values++;
    if (wrong)
      tell(w, isa, what_names[q], form_names[p], i, wrong);
  }
  /* what one lane has for certain, the batch has */
  if (is_batch(q) && (w->status[0] ^ all) & ~unsure) {
    found->wrong_status++;
    tell(w, isa, what_names[q], form_names[p], w->count, "status is not that of its lanes");
  }
}

/* ---- calls, with exceptions trapped ---- */

#define CALLS(real, f, p_form)                                                                     \
  static void call_##real(worker *w, const shade_isa_table *isa, what q) {                         \
    const shade_bsdf *b = &w->bsdf;                                                                \
    shade_lanes##f in = {.size = sizeof in, SHADE_DIRECTIONS(w->in##f)};                           \
    shade_result##f out = {sizeof out, w->out##f[0], w->out##f[1], w->out##f[2], w->out##f[3]};    \
    shade_sample_lanes##f from = {.size = sizeof from,                                             \
                                  .nx = in.nx,                                                     \
                                  .ny = in.ny,                                                     \
                                  .nz = in.nz,                                                     \
                                  .wox = in.wox,                                                   \
                                  .woy = in.woy,                                                   \
                                  .woz = in.woz,                                                   \
                                  .u1 = w->in##f[U],                                               \
                                  .u2 = w->in##f[U + 1]};                                          \
    shade_sample_result##f to = {sizeof to, w->out##f[5], w->out##f[6], w->out##f[7], out.r,       \
                                 out.g,     out.b,        w->out##f[4], out.cosine};               \
    if (w->textured) {                                                                             \
      in.f0r = from.f0r = w->in##f[9];                                                             \
      in.f0g = from.f0g = w->in##f[10];                                                            \
      in.f0b = from.f0b = w->in##f[11];                                                            \
    }                                                                                              \
    const real *own[OWNS];                                                                         \
    for (int k = 0; k < OWNS; k++)                                                                 \
      own[k] = w->given >> k & 1 ? w->in##f[OWN + k] : NULL;                                       \
    memcpy(&in.ax, own, sizeof own);                                                               \
    memcpy(&from.ax, own, sizeof own);                                                             \
    if (q == D_BATCH)                                                                              \
      w->status[0] = isa->entries##f->mdf_batch(b, w->count, in.nx, in.ny, in.nz, in.wix, in.wiy,  \
                                                in.wiz, out.r);                                    \
    if (q == F_BATCH)                                                                              \
      w->status[0] = isa->entries##f->bsdf_batch(b, w->count, &in, &out);                          \
    if (q == PDF_BATCH)                                                                            \
      w->status[0] = isa->entries##f->pdf_batch(b, w->count, &in, out.r);                          \
    if (q == DRAW_BATCH)                                                                           \
      w->status[0] = isa->entries##f->sample_batch(b, w->count, &from, &to);                       \
    for (w->lane = 0; !is_batch(q) && w->lane < w->count; w->lane++) {                             \
      size_t i = w->lane;                                                                          \
      const real *v = w->v##f[i], u[2] = {from.u1[i], from.u2[i]};                                 \
      real c[3] = {0, 0, 0}, wi[3];                                                                \
      if (q == D_ONE)                                                                              \
        w->status[i] = isa->entries##f->mdf(b, v, v + 3, c);                                       \
      else if (q == F_ONE)                                                                         \
        w->status[i] = isa->entries##f->bsdf(b, v, v + 3, v + 6, c, &out.cosine[i]);               \
      else if (q == PDF_ONE)                                                                       \
        w->status[i] = isa->entries##f->pdf(b, v, v + 3, v + 6, c);                                \
      else if (q == DRAW_ONE)                                                                      \
        w->status[i] = isa->entries##f->sample(b, v, v + 6, u, wi, c, &to.pdf[i], &out.cosine[i]); \
      else                                                                                         \
        c[0] = isa->entries##f->diffuse(bsdf_of(b)->diffuse, v + 3, v + 6);                        \
      out.r[i] = c[0], out.g[i] = c[1], out.b[i] = c[2];                                           \
      for (int k = 0; q == DRAW_ONE && k < 3; k++)                                                 \
        w->out##f[5 + k][i] = wi[k];                                                               \
    }                                                                                              \
  }
CALLS(double, , DOUBLE)
CALLS(float, f, FLOAT)

static _Thread_local sigjmp_buf trapped;

static void on_exception(int number, siginfo_t *info, void *context) {
  (void)number, (void)context;
#ifdef SOAK_WHERE /* for bisecting: link with -no-pie, then addr2line -ie */
  fprintf(stderr, "SIGFPE at %p\n", info->si_addr);
#else
  (void)info;
#endif
  siglongjmp(trapped, 1);
}

static void arm(int on) {
  feclearexcept(FE_ALL_EXCEPT);
#if CAN_TRAP
  (on ? feenableexcept : fedisableexcept)(EXCEPTIONS);
#else
  (void)on;
#endif
}

/* Returns 1 if finite input raised an exception. */
static int raises(worker *w, const shade_isa_table *isa, what q, form p) {
  if (sigsetjmp(trapped, 1)) {
    arm(0);
    return 1;
  }
  if (w->finite)
    arm(1);
  if (p == DOUBLE)
    call_double(w, isa, q);
  else
    call_float(w, isa, q);
  int raised = w->finite && fetestexcept(EXCEPTIONS);
  arm(0);
  return raised;
}

/* Returns 1 if setting up a finite material raised an exception. */
static int setup_raises(worker *w, int finite, unsigned *status) {
  if (sigsetjmp(trapped, 1)) {
    arm(0);
    return 1;
  }
  if (finite)
    arm(1);
  *status = shade_bsdf_setup(&w->bsdf, &w->params);
  int raised = finite && fetestexcept(EXCEPTIONS);
  arm(0);
  return raised;
}

static void one_block(worker *w) {
  w->seed = run.seed * 0x9e3779b97f4a7c15u + w->block * 0xd1342543de82ef95u;
  int finite;
  unsigned want = material(w, &finite), status = SHADE_OK;
  finding *first = &w->found[0][D_ONE][DOUBLE];
  if (setup_raises(w, finite, &status)) {
    first->raised++;
    tell(w, NULL, "setup", "", LANES, "exception");
    return;
  }
  if (status != want) {
    first->wrong_status++;
    tell(w, NULL, "setup", "", LANES, "wrong status");
  }
  fill(w);
  for (size_t i = 0; i < w->count; i++) {
    w->facts[0][i] = facts_of(w, DOUBLE, i);
    w->facts[1][i] = facts_of(w, FLOAT, i);
  }
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (int p = 0; p < FORMS; p++)
      for (int q = 0; q < WHATS; q++) {
        if ((q == PDF_ONE || q == DRAW_ONE) && w->block / 8 % 8 != (uint64_t)(2 * row + p))
          continue; /* batches of one, which take long: one in eight */
        if (!raises(w, isa, (what)q, (form)p))
          inspect(w, isa, row, (what)q, (form)p);
        else {
          w->found[row][q][p].raised++;
          tell(w, isa, what_names[q], form_names[p], is_batch((what)q) ? LANES : w->lane,
               "exception");
        }
      }
  w->cases += w->count;
}

static void *work(void *context) {
  worker *w = context;
  while (!atomic_load(&run.stop)) {
    uint64_t k = atomic_fetch_add(&run.next, 1);
    if (k >= run.blocks)
      break;
    w->block = run.first + k;
    one_block(w);
    atomic_fetch_add(&run.done, 1);
  }
  return NULL;
}

static worker *start(size_t threads) {
  worker *team = calloc(threads, sizeof *team);
  if (!team) {
    fputs("soak: out of memory\n", stderr);
    exit(1);
  }
  struct sigaction action = {.sa_flags = SA_SIGINFO};
  action.sa_sigaction = on_exception;
  sigaction(SIGFPE, &action, NULL);
  for (size_t t = 0; t < threads; t++)
    if (pthread_create(&team[t].thread, NULL, work, &team[t])) {
      fputs("soak: no thread to run on\n", stderr);
      exit(1);
    }
  return team;
}

/* All threads' findings in the first one's. */
static void join(worker *team, size_t threads) {
  for (size_t t = 0; t < threads; t++) {
    pthread_join(team[t].thread, NULL);
    if (!t)
      continue;
    team->cases += team[t].cases;
    for (int k = 0; k < ISAS * WHATS * FORMS; k++) {
      finding *sum = &team->found[0][0][0] + k;
      const finding *f = &team[t].found[0][0][0] + k;
      sum->values += f->values;
      sum->not_finite += f->not_finite;
      sum->negative += f->negative;
      sum->too_large += f->too_large;
      sum->wrong_status += f->wrong_status;
      sum->raised += f->raised;
      sum->largest = fmax(sum->largest, f->largest);
    }
  }
}

static uint64_t all_failures(const worker *w) {
  uint64_t sum = 0;
  for (int k = 0; k < ISAS * WHATS * FORMS; k++)
    sum += failures(&w->found[0][0][0] + k);
  return sum;
}

static void every_combination(void **state) {
  (void)state;
  run.seed = 1;
  run.blocks = COMBINATIONS;
  worker *team = start(1);
  join(team, 1);
  assert_true(team->cases >= 1000000 / FEWER);
  assert_int_equal(all_failures(team), 0);
  free(team);
}

/* ---- make soak ---- */

static void maps_and_albedo(void **state) {
  (void)state;
  uint64_t seed = 1;
  const char *wrong = soak_maps(100000, &seed);
  if (wrong)
    fail_msg("%s, seed %llu", wrong, (unsigned long long)seed);
}

static void on_interrupt(int number) {
  (void)number;
  atomic_store(&run.stop, 1);
}

static void print_table(const worker *w) {
  puts(
      "entry        precision isa         values  not finite  negative  too large  status  raised  "
      "largest");
  for (int row = 0; shade_isa_pick(row); row++)
    for (int p = 0; p < FORMS; p++)
      for (int q = 0; q < WHATS; q++) {
        const finding *f = &w->found[row][q][p];
        if (f->values + failures(f))
          printf("%-12s %-8s %-7s %11llu %11llu %9llu %10llu %7llu %7llu %8.2g\n", what_names[q],
                 form_names[p], shade_isa_pick(row)->name, (unsigned long long)f->values,
                 (unsigned long long)f->not_finite, (unsigned long long)f->negative,
                 (unsigned long long)f->too_large, (unsigned long long)f->wrong_status,
                 (unsigned long long)f->raised, f->largest);
      }
  puts("largest: D and f over the peak of D, pdf, Phi of a diffuse model");
}

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns the exit status. */
static int soak(size_t threads) {
  signal(SIGINT, on_interrupt);
  double begin = seconds();
  worker *team = start(threads);
  while (!atomic_load(&run.stop) && atomic_load(&run.done) < run.blocks) {
    nanosleep(&(struct timespec){0, 200000000}, NULL);
    if (!isatty(2))
      continue;
    double part = (double)atomic_load(&run.done) / (double)run.blocks;
    fprintf(stderr, "\rsoak [%-40.*s] %3.0f %%", (int)(40 * part),
            "########################################", 100 * part);
  }
  join(team, threads);
  if (isatty(2))
    fputs("\r\033[K", stderr);
  double time = seconds() - begin;
  uint64_t bad = all_failures(team), cases = team->cases;
  print_table(team);
  printf("%llu cases in %.0f s, %.3g a second with %zu threads%s; exceptions %s: %llu failures\n",
         (unsigned long long)cases, time, (double)cases / time, threads,
         atomic_load(&run.stop) ? " (interrupted)" : "", CAN_TRAP ? "trapped" : "tested",
         (unsigned long long)bad);
  free(team);
  uint64_t seed = run.seed;
  const uint64_t lanes = run.first ? 0 : cases / 10;
  const char *wrong = atomic_load(&run.stop) ? NULL : soak_maps(lanes, &seed);
  printf("maps and albedo: %llu lanes: %s%s (seed %llu)\n", (unsigned long long)lanes,
         wrong ? "wrong: " : "as promised", wrong ? wrong : "", (unsigned long long)seed);
  bad += wrong != NULL;
  return bad ? 1 : atomic_load(&run.stop) ? 130 : 0;
}

static int usage(FILE *to, int status) {
  fputs("usage: soak [--cases N] [--threads N] [--seed N] [--tell N] [--block N]\n\n"
        "Shades random and structured cases with every entry of every instruction set.\n"
        "Without options: the test of make check.\n\n"
        "  --cases N    at least so many (default 100000000)\n"
        "  --threads N  default: one a processor\n"
        "  --seed N     another sequence (default 1)\n"
        "  --tell N     describe so many failures (default 12)\n"
        "  --block N    only this block of it, as a failure's report names it\n",
        to);
  return status;
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_combination),
                                     cmocka_unit_test(maps_and_albedo)};
  if (argc == 1)
    return cmocka_run_group_tests_name("soak", tests, NULL, NULL);
  long online = sysconf(_SC_NPROCESSORS_ONLN);
  unsigned long long cases = 100000000, threads = online > 0 ? (unsigned long long)online : 1;
  run.seed = 1;
  for (int i = 1; i < argc; i += 2) {
    if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h"))
      return usage(stdout, 0);
    char *end = NULL;
    unsigned long long value = i + 1 < argc ? strtoull(argv[i + 1], &end, 10) : 0;
    if (!end || end == argv[i + 1] || *end || argv[i + 1][0] == '-') {
      fprintf(stderr, "soak: '%s': expected an option and a number\n", argv[i]);
      return usage(stderr, 2);
    }
    if (!strcmp(argv[i], "--cases"))
      cases = value;
    else if (!strcmp(argv[i], "--threads"))
      threads = value;
    else if (!strcmp(argv[i], "--seed"))
      run.seed = value;
    else if (!strcmp(argv[i], "--block"))
      run.first = value, run.blocks = 1;
    else if (!strcmp(argv[i], "--tell"))
      run.tell = value;
    else {
      fprintf(stderr, "soak: unknown option '%s'\n", argv[i]);
      return usage(stderr, 2);
    }
  }
  if (!run.blocks)
    run.blocks = cases / (FEW + 7) + 1; /* a block holds a little more, since one in 64 is long */
  if (threads < 1 || threads > 1024) {
    fputs("soak: --threads: expected 1 to 1024\n", stderr);
    return 2;
  }
  return soak((size_t)threads);
}
