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

void Scratches::estimate(double *share, double *square) const {
  double covered = 0.0, slopes = 0.0;

  for (int i = 0; i < params.layers; i++) {
    const shade_scratch_layer &layer = params.layer[i];
    const double a = layer.radius.low, b = layer.radius.high;
    const double area = layer.pits * M_PI * (a * a + a * b + b * b) / 3.0 *
                        (layer.stretch.low + layer.stretch.high) / 2.0;
    const double depth = (layer.depth.low + layer.depth.high) / 2.0;
    const double curved = 2.0 * depth / (1.0 + depth * depth); // of the sphere, for pits of 1
    const double square_curved = curved * curved;
    covered += area;
    // the mean of r^2 / (R^2 - r^2) over the cap, of which shallow ones leave the first term;
    // lengthwise there is next to nothing of it
    slopes += area * (depth > 1e-3 ? -0.5 * (std::log1p(-square_curved) / square_curved + 1.0)
                                   : 0.25 * square_curved);
  }
  *share = 1.0 - std::exp(-covered);
  *square = slopes < covered * 1e6 && covered < HUGE_VAL ? slopes / covered : 0.0;
}

ScratchField::ScratchField(const shade_scratch_params &params)
    : field(shade_scratch_create(&params, NULL), shade_scratch_free), deep(0.0) {
  if (!field)
    throw std::bad_alloc();
  // looks until enough are in scratches, at points that lie evenly (of Roberts's sequence R2)
  const double STEP_U = 0.7548776662466927, STEP_V = 0.5698402909980532;
  double in = 0.0, square = 0.0;
  for (int i = 0; i < 65536 && in < 2048.0; i++) {
    shade_slopes found;
    double height, u = i * STEP_U, v = i * STEP_V;
    shade_scratch_eval(field.get(), u - std::floor(u), v - std::floor(v), NULL, &height, &found);
    if (height < 0.0) {
      in += 1.0;
      square += found.mean[0] * found.mean[0] + found.mean[1] * found.mean[1];
    }
  }
  deep = in > 0.0 ? square / in : 0.0;
}

// Slopes squared are in the scratches of a footprint what they are in those of the whole field: how
// much of it is scratched follows from their mean.
double ScratchField::scratched(shade_slopes *of) const {
  double *const m = of->mean, *const k = of->covariance;
  const double xx = k[0] + m[0] * m[0], xy = k[1] + m[0] * m[1], yy = k[2] + m[1] * m[1];
  const double square = xx + yy;

  if (!(square > 0.0))
    return 0.0;
  if (!(k[0] + k[2] > 1e-9)) // a point
    return 1.0;
  // Fewer could not have that mean and spread along it: m' S^-1 m, of the mean m and squares S.
  // Padded: strokes may all lie one way.
  const double pad = 1e-9 * square, area = (xx + pad) * (yy + pad) - xy * xy;
  const double of_mean =
      (yy + pad) * m[0] * m[0] - 2.0 * xy * m[0] * m[1] + (xx + pad) * m[1] * m[1];
  const double least = area > 0.0 ? of_mean / area : 1.0;
  const double share = deep > 0.0 ? std::min(std::max(square / deep, least), 1.0) : 1.0;
  if (share > 0.999)
    return 1.0;
  const double more = 1.0 / share - 1.0;
  k[0] = std::max(k[0] - more * m[0] * m[0], 0.0) / share;
  k[1] = (k[1] - more * m[0] * m[1]) / share;
  k[2] = std::max(k[2] - more * m[1] * m[1], 0.0) / share;
  m[0] /= share;
  m[1] /= share;
  return share;
}

std::shared_ptr<const ScratchField> ScratchFieldCache::field(const shade_scratch_params &params) {
  for (size_t i = 0; i < made.size(); i++)
    if (std::memcmp(&made[i].first, &params, sizeof params) == 0)
      return made[i].second;
  made.push_back(std::make_pair(params, std::make_shared<const ScratchField>(params)));
  return made.back().second;
}

} // namespace mdf
