// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/scratches.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

namespace mdf {

Scratches::Scratches() : tile_mm(20.0), mm_per_unit(200.0), own_layers(false), made_mm(tile_mm) {
  // equal numbers are to be equal bytes
  std::memset(static_cast<void *>(&params), 0, sizeof params);
  shade_scratch_params_init(&params);
  made = params;
}

void Scratches::take(const shade_preset &preset) {
  params = made = preset.scratches;
  tile_mm = made_mm = 10.0 * preset.scratch_cm;
  own_layers = false;
}

bool Scratches::set_tile(double mm) {
  const double MOST = 1e6; // pits: a second or two to lay out
  double times = mm / made_mm, pits = 0.0;
  bool kept = true;

  if (!own_layers) {
    for (int i = 0; i < made.layers; i++)
      pits += made.layer[i].pits;
    if (pits * times * times > MOST) {
      times = std::sqrt(MOST / pits);
      kept = false;
    }
  }
  for (int i = 0; i < made.layers; i++) {
    shade_scratch_layer &layer = params.layer[i];
    layer = made.layer[i];
    layer.radius.low /= times;
    layer.radius.high /= times;
    if (!own_layers && layer.pits > 0)
      layer.pits = (uint32_t)std::max(std::floor(layer.pits * times * times + 0.5), 1.0);
  }
  tile_mm = mm;
  return kept;
}

void Scratches::begin_layers() {
  params.layers = made.layers = 0;
  own_layers = true;
}

void Scratches::end_layer() {
  made = params;
  made_mm = tile_mm;
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
