/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/matte.h"

#include <string.h>

#define MATTE_WORD(KIND) #KIND,

const char *matte_word(matte_kind kind) {
  static const char *const words[] = {MATTE_TABLE(MATTE_WORD)};
  return words[kind];
}

matte_layout matte_layout_of(unsigned wanted, size_t slots) {
  matte_layout l = {.wanted = wanted, .slots = slots};
  for (int k = 0; k < MATTE_KINDS; k++) {
    l.at[k] = l.all;
    l.all += wanted >> k & 1u ? 2 * slots : 0;
  }
  return l;
}

void matte_add(float *slots, size_t count, float name, float coverage) {
  if (!(coverage > 0.0f))
    return;
  size_t k = 0;
  while (k + 1 < count && slots[2 * k] != name && slots[2 * k + 1] > 0.0f)
    k++;
  if (!(slots[2 * k + 1] > 0.0f))
    slots[2 * k] = name;
  slots[2 * k + 1] += coverage;
}

void matte_merge(const matte_layout *layout, const float *from, float *to) {
  for (int k = 0; k < MATTE_KINDS; k++)
    for (size_t i = 0; layout->wanted >> k & 1u && i < layout->slots; i++) {
      const float *slot = from + layout->at[k] + 2 * i;
      matte_add(to + layout->at[k], layout->slots, slot[0], slot[1]);
    }
}

void matte_layer(const matte_layout *layout, const float *pixel, matte_kind kind, size_t layer,
                 float scale, float out[4]) {
  float sorted[MATTE_SLOTS_MOST][2];
  for (size_t i = 0; i < layout->slots; i++) {
    const float *slot = pixel + layout->at[kind] + 2 * i;
    size_t k = i;
    for (; k > 0 && sorted[k - 1][1] < slot[1]; k--)
      memcpy(sorted[k], sorted[k - 1], sizeof sorted[k]);
    memcpy(sorted[k], slot, sizeof sorted[k]);
  }
  for (size_t i = 0; i < 2; i++) {
    bool there = 2 * layer + i < layout->slots;
    out[2 * i] = there ? sorted[2 * layer + i][0] : 0.0f;
    out[2 * i + 1] = there ? sorted[2 * layer + i][1] * scale : 0.0f;
  }
}
