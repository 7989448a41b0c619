// SPDX-License-Identifier: AGPL-3.0-or-later
// LIBSHADE_DUMP=file.exr: what was shaded at the primary hit of every pixel,
// as `shade check` reads it. Filled by the shading itself.
#ifndef POVRAY_BACKEND_MDF_DUMP_H
#define POVRAY_BACKEND_MDF_DUMP_H

#include <string>

#include "backend/mdf/material.h"

struct shade_dump;

namespace mdf {

// Threads: each pixel belongs to the thread that traces it; nothing is shared
// between pixels.
class Dump {
public:
  // The file named by the environment, or "" when no dump is wanted.
  static std::string wanted();

  // Throws std::runtime_error when memory is short or the folder cannot be written to.
  // cloth, painted, bumps, scratches: whether the scene has any, diffuse parts in a pigment's
  // colours, bumps that turn into roughness from afar, such as do so in parts, and such as are
  // uneven.
  Dump(const std::string &path, int width, int height, int lights, bool cloth, bool painted,
       bool bumps, bool scratches, bool reliefs);
  ~Dump();

  // A ray through the position (x, y) begins; whole numbers are the pixels'
  // centres. Forgets what the pixel held. Returns the pixel's number, or
  // -1 where nothing is to be recorded.
  int start(double x, double y);

  // What the eye sees at `pixel`. False if the pixel already holds a
  // hit: the first (top) layer with an mdf { } block counts.
  // pigment: the layer's colour. cloth: where on it, else NULL; gaps: what it leaves of the ray.
  // lobes: its normals and widths. slopes: of bumps near there. mirrored: x is recorded the other
  // way, of cloth, which has a hand: POV-Ray's space has the left.
  bool hit(int pixel, const Material *material, const double P[3], const double uv[2],
           const double N[3], const double T[3], const double V[3], const double pigment[3],
           const ClothPlace *cloth, double gaps, const LobeSeen *lobes, int count,
           const double slopes[5], bool mirrored);

  // One light on that hit; mirrored: as the hit was.
  void light(int pixel, int number, const double L[3], const double E[3], const double S[3],
             bool mirrored);

  // Throws std::runtime_error naming the file.
  void write(const std::string &json);

private:
  const std::string path;
  shade_dump *const data;

  void put(float *plane, int pixel, const double *values, int count);
  void put_vector(float *plane, int pixel, const double v[3], bool mirrored);

  Dump(const Dump &);
  Dump &operator=(const Dump &);
};

} // namespace mdf

#endif
