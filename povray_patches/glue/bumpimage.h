// SPDX-License-Identifier: AGPL-3.0-or-later
// A tangent-space normal map: red along dP/du, green along dP/dv (the green
// of OpenGL, Blender and MikkTSpace), blue along the normal; 0..1 stands for -1..1.
#ifndef POVRAY_BACKEND_MDF_BUMPIMAGE_H
#define POVRAY_BACKEND_MDF_BUMPIMAGE_H

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shade/maps.h"

namespace mdf {

class BumpImage {
public:
  // Black, of the given size; fill it with set(). Sizes are at least 1.
  BumpImage(size_t width, size_t height);

  size_t width() const { return columns; }
  size_t height() const { return rows; }
  void set(size_t column, size_t row, float red, float green, float blue);

  // The picture amid a flat one of twice its size. within: of a place in the picture, the place
  // there. Returns false where that is flat, and neither does the other picture reach.
  BumpImage *once() const;
  bool within(double uv[2]) const;

  // The stored colour at (u, v), bilinear, repeating. As in Blender: u to
  // the right, v up, row 0 is the top of the picture, the centre of texel
  // (i, j) at u = (i + .5)/width, v = 1 - (j + .5)/height.
  void colour(double u, double v, double rgb[3]) const;

  // The unit normal at (u, v), in the frame (dP/du, dP/dv, normal);
  // `strength` draws it away from the normal (0: flat, 1: as stored).
  // Flat where u or v is not finite or the map holds no direction.
  void normal(double u, double v, double strength, double n[3]) const;

  // The same over a footprint, which shade_slope_lookup explains; *covariance (xx, xy, yy) is what
  // the slopes do about their mean. slopes: of slopes(strength). A footprint of less than a texel
  // is a point, and from two texels on the map's pyramid answers.
  void normal(double u, double v, double strength, const double footprint[4],
              const shade_slope_map *slopes, double n[3], double covariance[3]) const;

  // The pyramid; not while others may ask. Throws std::bad_alloc.
  std::shared_ptr<const shade_slope_map> slopes(double strength) const;

private:
  size_t columns, rows;
  mutable std::map<double, std::shared_ptr<const shade_slope_map>> pyramids; // by strength
  std::vector<float> texels;

  const float *texel(size_t column, size_t row) const {
    return &texels[3 * (row * columns + column)];
  }
};

// Reads the R, G and B channels of an OpenEXR file as float32, as they are.
// Throws std::exception with a message.
BumpImage *read_exr(const std::string &path);

} // namespace mdf

#endif
