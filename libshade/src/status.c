/* SPDX-License-Identifier: Apache-2.0 */
/* What the library says of itself, and of a status, in words. */
#include "shade/shade.h"

const char *shade_version(void) {
  return SHADE_VERSION;
}

/* Every sum of bits, the lowest said first. */
#define TEXTS_1(rest) rest, ", parameter clamped" rest
#define TEXTS_2(rest) TEXTS_1(rest), TEXTS_1(", normal clamped" rest)
#define TEXTS_4(rest) TEXTS_2(rest), TEXTS_2(", bad input" rest)
#define TEXTS_8(rest) TEXTS_4(rest), TEXTS_4(", unknown choice" rest)
#define TEXTS_16(rest) TEXTS_8(rest), TEXTS_8(", no sample found" rest)
static const char *const texts[] = {TEXTS_16("")};
enum { TEXTS = sizeof texts / sizeof texts[0], COMMA = 2 };
_Static_assert(TEXTS == 2 * SHADE_NO_SAMPLE, "a text for each bit");

const char *shade_status_text(unsigned status) {
  if (status == SHADE_OK)
    return "ok";
  return status < TEXTS ? texts[status] + COMMA : "unknown status";
}
