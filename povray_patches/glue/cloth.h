// SPDX-License-Identifier: AGPL-3.0-or-later
// `fabric { }`: a woven cloth. No type of POV-Ray's appears here.
#ifndef POVRAY_BACKEND_MDF_CLOTH_H
#define POVRAY_BACKEND_MDF_CLOTH_H

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "shade/fabric.h"
#include "shade/presets.h"

namespace mdf {

// As its author states it. Begins as a plain weave, ten crossings to the centimetre.
struct Cloth {
  Cloth();

  std::string weave;                        // a name that shade_draft_named takes, or
  std::shared_ptr<const shade_draft> draft; // its own
  shade_weave_params yarns;
  shade_fabric_params material;
  unsigned int stated; // as Material::stated
  double per_cm[2];    // crossings along u and v
  bool counted[2];     // whether its author says so many, and no preset
  double crossings[2]; // in one unit of u and v; 0: by per_cm
  double mm_per_unit;  // cloth that one unit of u or v spans
  bool mirrored;       // on a mirrored object, as a picture is; else it keeps its hand
  bool pigment[2];     // whether warp, weft take the colour of the layer's pigment

  void take(const shade_preset &preset);
  // A draft of the author's: its colours, and what it states of its yarns.
  void take(const std::shared_ptr<const shade_draft> &own);
  // How dense it is with that draft, where the author has not said it: a note, or nothing.
  std::string settle();
  double per_unit(int axis) const;
  bool transmits() const;
  // Whether some of a ray may pass between the yarns: gaps in both directions, and nothing behind.
  bool open() const;

  // As the header of a dump has it. Throws std::bad_alloc.
  std::string json(int id, const char *name) const;
};

// One that is ready for light. Threads may share it.
class PreparedCloth {
public:
  // Throws std::bad_alloc.
  explicit PreparedCloth(const Cloth &cloth);

  const shade_fabric *fabric() const { return ready.get(); }
  // The share of even light that leaves towards wo (local), where the pigment has this colour.
  // Found when it is first asked for.
  void albedo(const double wo[3], const double pigment[3], double rgb[3]) const;

private:
  std::shared_ptr<shade_weave> weave;
  std::shared_ptr<shade_fabric> ready;
  mutable std::once_flag asked;
  shade_fabric_params material;
  bool pigment[2]; // of Cloth
  // With yarns of the pigment's colour in white, and in black: what is reflected is linear in it.
  mutable std::shared_ptr<shade_fabric_albedo> white, black;

  bool painted() const;
  std::shared_ptr<shade_fabric_albedo> table(double paint) const;

  PreparedCloth(const PreparedCloth &);
  PreparedCloth &operator=(const PreparedCloth &);
};

// Equal cloths are prepared once: scenes copy them in loops.
class ClothCache {
public:
  std::shared_ptr<const PreparedCloth> prepared(const Cloth &cloth);

private:
  std::map<std::string, std::shared_ptr<const PreparedCloth>> by_text;
};

// Where on the cloth a ray meets it, in crossings.
struct ClothPlace {
  double uv[2], footprint[2];
  bool far; // as what is out of the eye's sight needs it
};

} // namespace mdf

#endif
