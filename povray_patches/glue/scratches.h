// SPDX-License-Identifier: AGPL-3.0-or-later
// `scratches { }`: a field of scratches in the (u, v) plane. No type of POV-Ray's appears here.
#ifndef POVRAY_BACKEND_MDF_SCRATCHES_H
#define POVRAY_BACKEND_MDF_SCRATCHES_H

#include <memory>
#include <utility>
#include <vector>

#include "shade/maps.h"
#include "shade/presets.h"

namespace mdf {

struct Scratches {
  Scratches(); // fine ones along u

  shade_scratch_params params; // lengths in tiles
  double tile_mm;              // width of the tile that repeats
  double mm_per_unit;          // what one unit of u or v spans

  void take(const shade_preset &preset);
  // Another tile with scratches of the same size in it: those of a preset as dense as they were,
  // those of a scene's own layers as many. False: so many there cannot be, they have grown.
  bool set_tile(double mm);
  // Before the first of a scene's own layers, and after each.
  void begin_layers();
  void end_layer();
  double per_unit() const { return mm_per_unit / tile_mm; }
  // About what share of the surface they cover, and the mean square of their slopes: without a
  // field, which takes a while to make.
  void estimate(double *share, double *square) const;

private:
  bool own_layers;
  shade_scratch_params made; // as a preset has them, on a tile of made_mm
  double made_mm;
};

// A field, and what tells how much of a footprint is scratched.
class ScratchField {
public:
  // Throws std::bad_alloc.
  explicit ScratchField(const shade_scratch_params &params);

  unsigned slopes(double u, double v, const double footprint[4], shade_slopes *found) const {
    return shade_scratch_eval(field.get(), u, v, footprint, NULL, found);
  }
  // Of a footprint's slopes those in scratches, in place of all: the rest is the plate, whose
  // slopes are 0. Returns the share of the footprint that they are of.
  double scratched(shade_slopes *of) const;

private:
  std::unique_ptr<shade_scratch_field, void (*)(shade_scratch_field *)> field;
  double deep; // mean square of the slopes in scratches
};

// Fields are made once for equal numbers: scenes copy blocks in loops.
class ScratchFieldCache {
public:
  // Throws std::bad_alloc.
  std::shared_ptr<const ScratchField> field(const shade_scratch_params &params);

private:
  std::vector<std::pair<shade_scratch_params, std::shared_ptr<const ScratchField>>> made;
};

} // namespace mdf

#endif
