/* SPDX-License-Identifier: Apache-2.0 */
/* The OpenEXRCore that this program is linked with. Compile with -lOpenEXRCore. */
#include "dump.h"
#include "dump_exr.h"

const struct shade_exr_api *shade_exr_api_linked(void) {
#define LINKED(name) .name = name,
  static const struct shade_exr_api api = {SHADE_EXR_FUNCTIONS(LINKED)};
  return &api;
}
