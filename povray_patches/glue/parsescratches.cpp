// SPDX-License-Identifier: AGPL-3.0-or-later
// Parser's part of `mdf { scratches { … } }`.

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "backend/mdf/material.h"
#include "backend/mdf/words.h"
#include "backend/parser/parse.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

// `scratches { … }`, `scratches off`.
void Parser::Parse_Mdf_Scratches(mdf::Material &material) {
  if (Parse_Mdf_Off("scratches", "brushed_steel")) {
    material.scratches.reset();
    return;
  }

  const std::shared_ptr<mdf::Scratches> scratches(
      material.scratches ? new mdf::Scratches(*material.scratches) : new mdf::Scratches);
  const mdf::WordScope words(Mdf_Words, mdf::WORDS_SCRATCHES);
  shade_preset preset;
  std::string last;
  bool first = true;
  double number;

  Parse_Begin();
  while (Next_Mdf_Word(mdf::WORDS_SCRATCHES, last)) {
    switch (Token.Function_Id) {
    case mdf::SCRATCH_PRESET:
      Parse_Mdf_Preset_Named(false, true, preset);
      scratches->take(preset);
      break;
    case mdf::SCRATCH_TILE_MM:
      number = Parse_Mdf_Size("tile_mm");
      if (!scratches->set_tile(number))
        Warn_Mdf("a tile_mm of " + mdf::text_of(number) +
                 " would hold more than a million scratches; they have grown instead.");
      break;
    case mdf::SCRATCH_MM_PER_UNIT:
      scratches->mm_per_unit = Parse_Mdf_Size("mm_per_unit");
      break;
    case mdf::SCRATCH_SEED:
      Parse_Mdf_Numbers("seed", 1, &number);
      scratches->params.seed = (uint64_t)(int64_t)std::min(std::max(number, -1e15), 1e15);
      break;
    default:
      if (first) // the first layer takes the place of those that were there
        scratches->begin_layers();
      else if (scratches->params.layers == SHADE_SCRATCH_LAYERS)
        Error("mdf: scratches have %d layers at most.", (int)SHADE_SCRATCH_LAYERS);
      first = false;
      Parse_Mdf_Layer(*scratches);
    }
  }
  Parse_End();
  material.scratches = scratches;
}

// `a, b`, within limits: the ends of a range, which the library puts in order.
void Parser::Parse_Mdf_Range(const std::string &what, double least, double most, double unit,
                             shade_range &range) {
  double *const ends[2] = {&range.low, &range.high};

  for (int i = 0; i < 2; i++) {
    double number;
    if (i > 0)
      Parse_Comma();
    Parse_Mdf_Numbers(i == 0 ? what : "the other end of " + what, 1, &number);
    *ends[i] = std::min(std::max(number / unit, least), most);
    if (*ends[i] != number / unit)
      Warn_Mdf_Number(what, number, *ends[i] * unit);
  }
}

void Parser::Parse_Mdf_Layer(mdf::Scratches &scratches) {
  const mdf::WordScope words(Mdf_Words, mdf::WORDS_LAYER);
  mdf::Scratches plain;
  shade_scratch_layer &layer = scratches.params.layer[scratches.params.layers];
  const double degree = M_PI / 180.0;
  std::string last;
  double number;

  plain.set_tile(scratches.tile_mm);
  layer = plain.params.layer[0];
  Begin_Mdf("layer");
  while (Next_Mdf_Word(mdf::WORDS_LAYER, last)) {
    switch (Token.Function_Id) {
    case mdf::LAYER_PITS: {
      Parse_Mdf_Numbers("pits", 1, &number);
      const double taken = floor(std::min(std::max(number, 0.0), (double)SHADE_SCRATCH_MAX_PITS));
      if (taken != number)
        Warn_Mdf_Number("pits", number, taken);
      layer.pits = (uint32_t)taken;
      break;
    }
    case mdf::LAYER_RADIUS:
      Parse_Mdf_Range("radius", 1e-6, 0.5, scratches.tile_mm, layer.radius);
      break;
    case mdf::LAYER_STRETCH:
      Parse_Mdf_Range("stretch", 1.0, 1e5, 1.0, layer.stretch);
      break;
    case mdf::LAYER_DEPTH:
      Parse_Mdf_Range("depth", 0.0, 0.99, 1.0, layer.depth);
      break;
    case mdf::LAYER_DIRECTION:
      Parse_Mdf_Numbers("direction", 1, &number);
      layer.direction = degree * number;
      break;
    default:
      Parse_Mdf_Numbers("spread", 1, &number);
      layer.spread = degree * std::min(std::max(number, 0.0), 90.0);
      if (number < 0.0 || number > 90.0)
        Warn_Mdf_Number("spread", number, layer.spread / degree);
    }
  }
  Parse_End();
  scratches.params.layers++;
  scratches.end_layer();
}

} // namespace pov
