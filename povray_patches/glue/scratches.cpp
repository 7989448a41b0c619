// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/scratches.h"

#include <cstring>
#include <new>

namespace mdf {

Scratches::Scratches() : tile_mm(20.0), mm_per_unit(200.0) {
  // equal numbers are to be equal bytes
  std::memset(static_cast<void *>(&params), 0, sizeof params);
  shade_scratch_params_init(&params);
}

void Scratches::take(const shade_preset &preset) {
  params = preset.scratches;
  tile_mm = 10.0 * preset.scratch_cm;
}

std::shared_ptr<const shade_scratch_field> Scratcher::field(const shade_scratch_params &params) {
  for (size_t i = 0; i < made.size(); i++)
    if (std::memcmp(&made[i].first, &params, sizeof params) == 0)
      return made[i].second;
  shade_scratch_field *const f = shade_scratch_create(&params, NULL);
  if (f == NULL)
    throw std::bad_alloc();
  const std::shared_ptr<const shade_scratch_field> kept(f, [](const shade_scratch_field *field) {
    shade_scratch_free(const_cast<shade_scratch_field *>(field));
  });
  made.push_back(std::make_pair(params, kept));
  return kept;
}

} // namespace mdf
