/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a Weaving Information File: a draft that comes back the same, or a message. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shade/weave.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char message[200] = "?"; /* as short as it is: warnings are cut */
  shade_draft *d = shade_wif_parse((const char *)data, size, "fuzz", message, sizeof message);
  const int warned = strncmp(message, "fuzz: mended: ", 14) == 0;
  if (d ? *message && !warned : warned || strncmp(message, "fuzz", 4) != 0)
    abort();
  if (!d)
    return 0;
  const size_t cells = (size_t)d->ends * (size_t)d->picks;
  /* large ones in the first round only: speed */
  if (cells <= 1 << 14) {
    char *text = shade_wif_text(d);
    shade_draft *again =
        text ? shade_wif_parse(text, strlen(text), "fuzz", message, sizeof message) : NULL;
    /* what is written needs no mending */
    if (!again || *message || again->ends != d->ends || again->picks != d->picks ||
        memcmp(again->warp_up, d->warp_up, cells) != 0)
      abort();
    shade_draft_free(again);
    free(text);
    shade_weave *w = shade_weave_create(d, NULL, NULL);
    for (int i = 0; w && i < 16; i++) {
      shade_crossing c;
      shade_weave_lookup(w, i * .37 - 2, i * -1.7, &c);
      if (!(isfinite(c.dx + c.dy + c.sigma + c.occlusion + c.color[0]) && c.occlusion >= 0))
        abort();
    }
    shade_weave_free(w);
  }
  shade_draft_free(d);
  return 0;
}
