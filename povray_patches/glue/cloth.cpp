// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/cloth.h"
#include "backend/mdf/words.h"

#include <new>
#include <vector>

namespace mdf {

Cloth::Cloth() : weave("plain"), stated(0), mm_per_unit(200.0), mirrored(false) {
  shade_weave_params_init(&yarns);
  shade_fabric_params_init(&material);
  for (int axis = 0; axis < 2; axis++) {
    per_cm[axis] = 10.0;
    crossings[axis] = 0.0;
    counted[axis] = pigment[axis] = false;
  }
}

void Cloth::take(const shade_preset &preset) {
  weave = preset.weave;
  draft.reset();
  yarns = preset.yarns;
  material = preset.fabric;
  stated = 0;
  per_cm[0] = preset.ends_per_cm;
  per_cm[1] = preset.picks_per_cm;
  pigment[0] = pigment[1] = false;
}

namespace {

bool is_coloured(const shade_thread *threads, int count) {
  for (int i = 0; i < count; i++)
    for (int c = 0; c < 3; c++)
      if (threads[i].color[c] != 1.0)
        return true;
  return false;
}

} // namespace

void Cloth::take(const std::shared_ptr<const shade_draft> &own) {
  weave.clear();
  draft = own;
  shade_weave_params_from_draft(&yarns, own.get());
  if (is_coloured(own->warp, own->ends) || is_coloured(own->weft, own->picks)) {
    material.draft_colors = 1;
    for (int c = 0; c < 3; c++) // the draft's colours are all that dyes them
      material.warp.kd[c] = material.weft.kd[c] = 1.0;
  }
}

std::string Cloth::settle() {
  double found[2] = {per_cm[0], per_cm[1]};

  // one that the author counts is that of both, where the draft says nothing
  for (int axis = 0; axis < 2; axis++)
    if (counted[axis] && !counted[!axis])
      found[!axis] = found[axis];
  const shade_sett by = shade_draft_sett(draft.get(), found);
  const bool said = by == SHADE_SETT_SPACING || counted[0] || counted[1] || crossings[0] > 0.0;
  for (int axis = 0; axis < 2; axis++)
    if (!counted[axis])
      per_cm[axis] = found[axis];
  if (said)
    return "";
  return std::string("the draft states no spacing") +
         (by == SHADE_SETT_THICKNESS ? ": square crossings as wide as its yarns are thick, "
                                     : " and no thickness: square crossings, ") +
         text_of(per_cm[0]) + " to the centimetre. ends_per_cm and picks_per_cm state others.";
}

double Cloth::per_unit(int axis) const {
  return crossings[axis] > 0.0 ? crossings[axis] : 0.1 * mm_per_unit * per_cm[axis];
}

bool Cloth::transmits() const {
  for (int c = 0; c < 3; c++)
    if (material.warp_transmit[c] > 0.0 || material.weft_transmit[c] > 0.0)
      return true;
  return false;
}

namespace {

// Whether the yarns of one direction touch each other everywhere.
bool is_tight(const shade_yarn_params &yarn, const shade_thread *threads, int count) {
  for (int i = 1; i < count; i++)
    if (threads[i].thickness != threads[0].thickness || threads[i].spacing != threads[0].spacing)
      return false;
  return yarn.gap == 0.0 && yarn.slub == 0.0;
}

} // namespace

bool Cloth::open() const {
  const bool lit_behind =
      material.backing[0] > 0.0 || material.backing[1] > 0.0 || material.backing[2] > 0.0;

  return !lit_behind &&
         !is_tight(yarns.warp, draft ? draft->warp : NULL, draft ? draft->ends : 0) &&
         !is_tight(yarns.weft, draft ? draft->weft : NULL, draft ? draft->picks : 0);
}

std::string Cloth::json(int id, const char *name) const {
  const char *const word = weave.empty() ? NULL : weave.c_str();
  const int length = shade_fabric_json(id, name, draft.get(), word, &yarns, &material, NULL, 0);
  std::vector<char> text((size_t)(length < 0 ? 0 : length) + 1);

  if (length < 0 ||
      shade_fabric_json(id, name, draft.get(), word, &yarns, &material, &text[0], text.size()) < 0)
    throw std::bad_alloc();
  return std::string(&text[0]);
}

PreparedCloth::PreparedCloth(const Cloth &cloth) : material(cloth.material) {
  pigment[0] = cloth.pigment[0];
  pigment[1] = cloth.pigment[1];
  const std::shared_ptr<shade_draft> named(
      cloth.draft ? NULL : shade_draft_named(cloth.weave.c_str()), shade_draft_free);

  weave.reset(shade_weave_create(cloth.draft ? cloth.draft.get() : named.get(), &cloth.yarns, NULL),
              shade_weave_free);
  if (weave)
    ready.reset(shade_fabric_create(weave.get(), &cloth.material, NULL), shade_fabric_free);
  if (!ready)
    throw std::bad_alloc();
}

bool PreparedCloth::painted() const {
  return pigment[0] || pigment[1];
}

std::shared_ptr<shade_fabric_albedo> PreparedCloth::table(double paint) const {
  std::shared_ptr<shade_fabric> cloth = ready;

  if (painted()) {
    shade_fabric_params in_paint = material;
    for (int c = 0; c < 3; c++) {
      if (pigment[0])
        in_paint.warp.kd[c] = paint;
      if (pigment[1])
        in_paint.weft.kd[c] = paint;
    }
    cloth.reset(shade_fabric_create(weave.get(), &in_paint, NULL), shade_fabric_free);
  }
  const std::shared_ptr<shade_fabric_albedo> made(
      cloth ? shade_fabric_albedo_create(cloth.get()) : NULL, shade_fabric_albedo_free);
  if (!made)
    throw std::bad_alloc();
  return made;
}

void PreparedCloth::albedo(const double wo[3], const double colour[3], double rgb[3]) const {
  std::call_once(asked, [this] {
    white = table(1.0);
    if (painted())
      black = table(0.0);
  });
  shade_fabric_albedo_eval(white.get(), wo, rgb);
  if (!painted())
    return;
  double none[3];
  shade_fabric_albedo_eval(black.get(), wo, none);
  for (int c = 0; c < 3; c++)
    rgb[c] = none[c] + colour[c] * (rgb[c] - none[c]);
}

std::shared_ptr<const PreparedCloth> ClothCache::prepared(const Cloth &cloth) {
  // a dump's words do not say whose colour is the pigment's
  std::shared_ptr<const PreparedCloth> &kept =
      by_text[(cloth.pigment[0] ? "p" : " ") + std::string(cloth.pigment[1] ? "p" : " ") +
              cloth.json(0, "")];

  if (!kept)
    kept.reset(new PreparedCloth(cloth));
  return kept;
}

} // namespace mdf
