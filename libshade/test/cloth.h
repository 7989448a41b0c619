/* SPDX-License-Identifier: Apache-2.0 */
/* Cloths of the presets, altered, for the tests of hits. */
#ifndef SHADE_TEST_CLOTH_H
#define SHADE_TEST_CLOTH_H

#include "support.h"

#include <string.h>

#include "shade/presets.h"

typedef struct cloth {
  shade_preset preset;
  shade_weave *weave;
  shade_fabric *fabric;
} cloth;

static inline cloth open_cloth(const char *name, void (*change)(shade_fabric_params *)) {
  cloth c;
  unsigned status = SHADE_OK;
  assert_true(shade_preset_find(name, &c.preset));
  if (change)
    change(&c.preset.fabric);
  c.fabric = shade_preset_fabric(&c.preset, &c.weave, &status);
  assert_non_null(c.fabric);
  assert_int_equal(status, SHADE_OK);
  return c;
}

static inline void close_cloth(cloth *c) {
  shade_fabric_free(c->fabric);
  shade_weave_free(c->weave);
}

static inline void any_direction(uint64_t *seed, double least, double w[3]) {
  spherical(acos(least + (1 - least) * uniform(seed)), 2 * PI * uniform(seed), w);
}

static const double FOLD[3] = {-0.36, 0.48, 0.8};

static inline void s_of(const cloth *c, const shade_fabric_point *point, const double wi[3],
                        const double wo[3], shade_fabric_tier tier, double s[3]) {
  shade_fabric_hit hit;
  shade_fabric_prepare(c->fabric, point, wo, tier, &hit, NULL);
  assert_int_equal(shade_fabric_hit_eval(c->fabric, &hit, wi, s) & SHADE_BAD_INPUT, 0);
}

static inline double n_dot(const double n[3], const double w[3]) {
  return n[0] * w[0] + n[1] * w[1] + n[2] * w[2];
}

static inline void transmits(shade_fabric_params *p) {
  for (int a = 0; a < 3; a++)
    p->warp_transmit[a] = p->weft_transmit[a] = 0.3;
}

#endif
