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
#define TEXTS_32(rest) TEXTS_16(rest), TEXTS_16(", unknown bits" rest)
static const char *const texts[] = {TEXTS_32("")};
enum { TEXTS = sizeof texts / sizeof texts[0], COMMA = 2, UNKNOWN = 2 * SHADE_NO_SAMPLE };
_Static_assert(TEXTS == 2 * UNKNOWN, "a text for each bit, and for those that are none");

const char *shade_status_text(unsigned status) {
  if (status == SHADE_OK)
    return "ok";
  return texts[status < UNKNOWN ? status : status % UNKNOWN + UNKNOWN] + COMMA;
}
