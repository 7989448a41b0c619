/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.4 */
/*
 * What stack a single call takes, as shade.h states it: each in a thread of 64 KiB whose stack is
 * painted before, with every choice of a material, prepared hits of cloth, and every instruction
 * set.
 */
#define _XOPEN_SOURCE 700 /* pthread_attr_setstack */
#include <pthread.h>
#include <string.h>

#include "cloth.h"
#include "model/fabric.h"

#ifdef SANITIZED /* which puts room around everything */
enum { STATED = 256 * 1024, THREAD = 1024 * 1024 };
#else
enum { STATED = 16 * 1024, THREAD = 64 * 1024 };
#endif
enum { PAINT = 0xa5, LEAST = 64 };

static shade_bsdf metal;
static const double n[3] = {.3, -.2, .932737905}, wi[3] = {.1, .4, .911043358}, u[2] = {.3, .6};
static const double wo[3] = {-.5, .2, .842614977};
static const float nf[3] = {.3f, -.2f, .9327379f}, wif[3] = {.1f, .4f, .91104336f};
static const float wof[3] = {-.5f, .2f, .842615f}, uf[2] = {.3f, .6f};

static const shade_lanes own = {
    .size = sizeof own, .kdr = u, .ax = u, .groove_x = n, .groove_y = n};
static const shade_lanesf ownf = {
    .size = sizeof ownf, .kdr = uf, .ax = uf, .groove_x = nf, .groove_y = nf};

/* The thread's body: with nothing but a row's call in it. */
#define CALL(name, ...)                                                                            \
  static void *name(void *status) {                                                                \
    unsigned *const s = status;                                                                    \
    double f[3], w[3], pdf, cosine;                                                                \
    float ff[3], wf[3], pdff, cosinef;                                                             \
    (void)s, (void)f, (void)w, (void)pdf, (void)cosine;                                            \
    (void)ff, (void)wf, (void)pdff, (void)cosinef;                                                 \
    __VA_ARGS__;                                                                                   \
    return NULL;                                                                                   \
  }
CALL(nothing, (void)0)
CALL(mdf, pdf = shade_mdf_eval(&metal, n, wi, s))
CALL(mdff, pdff = shade_mdf_evalf(&metal, nf, wif, s))
CALL(eval, *s = shade_bsdf_eval(&metal, n, wi, wo, f, &cosine))
CALL(evalf, *s = shade_bsdf_evalf(&metal, nf, wif, wof, ff, &cosinef))
CALL(hit, shade_bsdf_hit h; *s = shade_bsdf_prepare(&metal, n, wo, &h);
     *s |= shade_bsdf_hit_eval(&metal, &h, wi, f, &cosine))
CALL(hitf, shade_bsdf_hitf h; *s = shade_bsdf_preparef(&metal, nf, wof, &h);
     *s |= shade_bsdf_hit_evalf(&metal, &h, wif, ff, &cosinef))
CALL(density, pdf = shade_bsdf_pdf(&metal, n, wi, wo, s))
CALL(densityf, pdff = shade_bsdf_pdff(&metal, nf, wif, wof, s))
CALL(draw, *s = shade_bsdf_sample(&metal, n, wo, u, w, f, &pdf, &cosine))
CALL(drawf, *s = shade_bsdf_samplef(&metal, nf, wof, uf, wf, ff, &pdff, &cosinef))
CALL(vary, shade_bsdf one; *s = shade_bsdf_vary(&metal, &own, 0, &one);
     *s |= shade_bsdf_sample(&one, n, wo, u, w, f, &pdf, &cosine))
CALL(varyf, shade_bsdf one; *s = shade_bsdf_varyf(&metal, &ownf, 0, &one);
     *s |= shade_bsdf_samplef(&one, nf, wof, uf, wf, ff, &pdff, &cosinef))
CALL(diffuse, pdf = shade_diffuse_eval(SHADE_DIFFUSE_FIBRE_VIEW, wi, wo))
CALL(diffusef, pdff = shade_diffuse_evalf(SHADE_DIFFUSE_FIBRE_VIEW, wif, wof))

/* What is made before: where a hit is prepared, there are arrays as for many. */
static cloth made;
static shade_fabric_hit on_cloth;
static shade_fabric_hitf on_clothf;
static const double u3[3] = {.3, .6, .8};
static const float u3f[3] = {.3f, .6f, .8f};
CALL(cloth_eval, *s = shade_fabric_hit_eval(made.fabric, &on_cloth, wi, f))
CALL(cloth_evalf, *s = shade_fabric_hit_evalf(made.fabric, &on_clothf, wif, ff))
CALL(cloth_density, pdf = shade_fabric_hit_pdf(made.fabric, &on_cloth, wi, s))
CALL(cloth_densityf, pdff = shade_fabric_hit_pdff(made.fabric, &on_clothf, wif, s))
CALL(cloth_sample, *s = shade_fabric_hit_sample(made.fabric, &on_cloth, u3, w, f, &pdf))
CALL(cloth_samplef, *s = shade_fabric_hit_samplef(made.fabric, &on_clothf, u3f, wf, ff, &pdff))

#define ROW(name)                                                                                  \
  { #name, name }
typedef struct row {
  const char *name;
  void *(*call)(void *);
} row;
static const row of_cloth[] = {ROW(cloth_eval),     ROW(cloth_evalf),  ROW(cloth_density),
                               ROW(cloth_densityf), ROW(cloth_sample), ROW(cloth_samplef)};
enum { CLOTHS = sizeof of_cloth / sizeof of_cloth[0] };
static const row rows[] = {ROW(mdf),     ROW(mdff),     ROW(eval),     ROW(evalf), ROW(hit),
                           ROW(hitf),    ROW(density),  ROW(densityf), ROW(draw),  ROW(drawf),
                           ROW(diffuse), ROW(diffusef), ROW(vary),     ROW(varyf)};

/* Bytes from the top of a thread's stack down to the lowest that was written. */
static long touched(void *(*call)(void *)) {
  static _Alignas(4096) unsigned char stack[THREAD];
  pthread_attr_t attributes;
  pthread_t thread;
  unsigned status = SHADE_OK;
  long clean = 0;
  memset(stack, PAINT, sizeof stack);
  assert_int_equal(pthread_attr_init(&attributes), 0);
  assert_int_equal(pthread_attr_setstack(&attributes, stack, sizeof stack), 0);
  assert_int_equal(pthread_create(&thread, &attributes, call, &status), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
  pthread_attr_destroy(&attributes);
  while (stack[clean] == PAINT && clean < THREAD - 1)
    clean++;
  return THREAD - clean;
}

static void light_through(shade_fabric_params *p) {
  p->warp_transmit[0] = p->weft_transmit[0] = .2;
}

static void calls_on_cloth_are_lean(void **state) {
  (void)state;
  static const char *const names[] = {"denim", "linen", "silk_charmeuse"};
  long most[CLOTHS] = {0};
  const long own = touched(nothing);
  for (int k = 0; k < 3 * SHADE_HORIZON_COUNT; k++) {
    made = open_cloth(names[k % 3], light_through);
    made.fabric->horizon = (shade_horizon)(k / 3);
    for (int at = 0; at < 4 * (shade_isa_chosen() + 1); at++) {
      shade_fabric_point point;
      shade_fabric_pointf pointf;
      made.fabric->isa = at / 4;
      shade_fabric_point_init(made.fabric, &point);
      shade_fabric_point_initf(made.fabric, &pointf);
      for (int a = 0; a < 3; a++) {
        point.n[a] = n[a];
        pointf.n[a] = nf[a];
      }
      for (int a = 0; a < 2; a++)
        point.footprint[a] = pointf.footprint[a] = .75; /* near and far terms */
      const shade_fabric_tier tier = (shade_fabric_tier)(at % 4);
      shade_fabric_prepare(made.fabric, &point, wo, tier, &on_cloth, NULL);
      shade_fabric_preparef(made.fabric, &pointf, wof, tier, &on_clothf, NULL);
      for (int which = 0; which < CLOTHS; which++) {
        const long bytes = touched(of_cloth[which].call) - own;
        most[which] = bytes > most[which] ? bytes : most[which];
      }
    }
    close_cloth(&made);
  }
  for (int which = 0; which < CLOTHS; which++) {
    print_message("%-14s %6ld bytes\n", of_cloth[which].name, most[which]);
    assert_in_range(most[which], LEAST, STATED);
  }
}

static void single_calls_are_lean(void **state) {
  (void)state;
  long most[sizeof rows / sizeof rows[0]] = {0};
  touched(nothing); /* the first thread also looks functions up */
  const long own = touched(nothing);
  for (int isa = 0; isa <= shade_isa_chosen(); isa++)
    for (int k = 0; k < SHADE_MDF_COUNT * SHADE_DETAIL_COUNT * SHADE_HORIZON_COUNT; k++) {
      shade_params p;
      shade_params_init(&p);
      p.mdf = (shade_mdf)(k % SHADE_MDF_COUNT);
      p.brdf = k % 2 ? SHADE_BRDF_MICROFACET : SHADE_BRDF_ASHIKHMIN_SHIRLEY;
      p.detail = (shade_detail)(k / SHADE_MDF_COUNT % SHADE_DETAIL_COUNT);
      p.horizon = (shade_horizon)(k / SHADE_MDF_COUNT / SHADE_DETAIL_COUNT);
      p.fresnel = (shade_fresnel)(k % SHADE_FRESNEL_COUNT);
      p.diffuse = (shade_diffuse)(k % SHADE_DIFFUSE_COUNT);
      p.kd[0] = p.kd[1] = p.kd[2] = k % 3 ? .3 : 0;
      shade_bsdf_setup(&metal, &p);
      bsdf_in(&metal)->isa = isa;
      for (size_t row = 0; row < sizeof rows / sizeof rows[0]; row++) {
        const long bytes = touched(rows[row].call) - own;
        if (bytes > most[row])
          most[row] = bytes;
      }
    }
  long large = 0;
  for (size_t row = 0; row < sizeof rows / sizeof rows[0]; row++) {
    print_message("%-10s %6ld bytes\n", rows[row].name, most[row]);
    assert_true(most[row] <= STATED);
    large = most[row] > large ? most[row] : large;
  }
  assert_true(large > LEAST); /* paint that nobody touches would say nothing */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(single_calls_are_lean),
                                     cmocka_unit_test(calls_on_cloth_are_lean)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
