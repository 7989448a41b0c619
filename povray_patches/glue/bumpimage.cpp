// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/bumpimage.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

namespace mdf {

BumpImage::BumpImage(size_t width, size_t height)
    : columns(width), rows(height), texels(3 * width * height) {}

void BumpImage::set(size_t column, size_t row, float red, float green, float blue) {
  float *t = &texels[3 * (row * columns + column)];

  t[0] = red;
  t[1] = green;
  t[2] = blue;
}

BumpImage *BumpImage::once() const {
  BumpImage *const image = new BumpImage(2 * columns, 2 * rows);
  const size_t left = columns / 2, above = rows / 2;

  for (size_t row = 0; row < 2 * rows; row++)
    for (size_t column = 0; column < 2 * columns; column++)
      image->set(column, row, 0.5f, 0.5f, 1.0f);
  for (size_t row = 0; row < rows; row++)
    for (size_t column = 0; column < columns; column++) {
      const float *const t = texel(column, row);
      image->set(left + column, above + row, t[0], t[1], t[2]);
    }
  return image;
}

bool BumpImage::within(double uv[2]) const {
  const double sides[2] = {(double)columns, (double)rows};

  for (int axis = 0; axis < 2; axis++) {
    // what lies before the picture on either axis; rows count from the top
    const double before = std::floor(0.25 * sides[axis]), inner = 0.5 * sides[axis];
    const double from = axis == 0 ? before : sides[axis] - inner - before;
    uv[axis] = (uv[axis] * inner + from) / sides[axis];
    if (!(uv[axis] >= 0.0 && uv[axis] <= 1.0))
      return false;
  }
  return true;
}

namespace {

// The two texels around x (in texels, centres at half) and the weight of the second.
void neighbours(double x, size_t count, size_t &first, size_t &second, double &weight) {
  const double n = (double)count;

  x -= 0.5;
  x -= std::floor(x / n) * n;
  first = (size_t)x;
  weight = x - (double)first;
  if (first >= count) // x was rounded up to n
    first = 0;
  second = (first + 1 < count) ? first + 1 : 0;
}

} // namespace

void BumpImage::colour(double u, double v, double rgb[3]) const {
  size_t i0, i1, j0, j1;
  double s, t;

  neighbours(u * (double)columns, columns, i0, i1, s);
  neighbours((1.0 - v) * (double)rows, rows, j0, j1, t);
  for (int c = 0; c < 3; c++) {
    const double upper = (1.0 - s) * texel(i0, j0)[c] + s * texel(i1, j0)[c];
    const double lower = (1.0 - s) * texel(i0, j1)[c] + s * texel(i1, j1)[c];
    rgb[c] = (1.0 - t) * upper + t * lower;
  }
}

namespace {

bool normalise(double n[3]) {
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

  if (!(length > 1e-12) || !std::isfinite(length))
    return false;
  for (int c = 0; c < 3; c++)
    n[c] /= length;
  return true;
}

} // namespace

void BumpImage::normal(double u, double v, double strength, double n[3]) const {
  static const double flat[3] = {0.0, 0.0, 1.0};
  bool found = false;

  if (std::isfinite(u) && std::isfinite(v)) {
    colour(u, v, n);
    for (int c = 0; c < 3; c++)
      n[c] = 2.0 * n[c] - 1.0;
    found = normalise(n);
    // as Blender's Normal Map node: beyond 1 only the slope grows
    n[0] *= strength;
    n[1] *= strength;
    n[2] = 1.0 + std::min(strength, 1.0) * (n[2] - 1.0);
    found = found && normalise(n);
  }
  for (int c = 0; !found && c < 3; c++)
    n[c] = flat[c];
}

std::shared_ptr<const shade_slope_map> BumpImage::slopes(double strength) const {
  std::shared_ptr<const shade_slope_map> &kept = pyramids[strength];

  if (!kept) {
    shade_slope_options options;
    shade_slope_options_init(&options);
    options.strength = strength;
    shade_slope_map *const made =
        shade_slope_map_create(&texels[0], (int)columns, (int)rows, 3, &options, NULL);
    if (made == NULL)
      throw std::bad_alloc();
    kept.reset(made, [](const shade_slope_map *map) {
      shade_slope_map_free(const_cast<shade_slope_map *>(map));
    });
  }
  return kept;
}

void BumpImage::normal(double u, double v, double strength, const double footprint[4],
                       const shade_slope_map *slopes, double n[3], double covariance[3]) const {
  double texels_long = 0.0;
  shade_slopes over;

  covariance[0] = covariance[1] = covariance[2] = 0.0;
  for (int side = 0; side < 2; side++)
    texels_long = std::max(texels_long, std::hypot(footprint[2 * side] * (double)columns,
                                                   footprint[2 * side + 1] * (double)rows));
  if (slopes == NULL || !(texels_long > 1.0)) {
    normal(u, v, strength, n);
    return;
  }
  if (shade_slope_lookup(slopes, u, v, footprint, &over) & SHADE_BAD_INPUT) {
    normal(u, v, strength, n);
    return;
  }
  const double share = std::min(texels_long - 1.0, 1.0);
  for (int i = 0; i < 3; i++)
    covariance[i] = share * over.covariance[i];
  if (share < 1.0) {
    normal(u, v, strength, n);
    for (int i = 0; i < 3; i++)
      n[i] += share * (over.normal[i] - n[i]);
    normalise(n);
  } else
    std::copy(over.normal, over.normal + 3, n);
}

BumpImage *read_exr(const std::string &path) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  const size_t width = (size_t)(window.max.x - window.min.x + 1);
  const size_t height = (size_t)(window.max.y - window.min.y + 1);
  static const char *const names[3] = {"R", "G", "B"};
  std::vector<float> pixels(3 * width * height);
  Imf::FrameBuffer buffer;

  for (size_t c = 0; c < 3; c++) {
    const Imf::Channel *channel = file.header().channels().findChannel(names[c]);
    if (channel == NULL || channel->xSampling != 1 || channel->ySampling != 1)
      throw std::runtime_error(std::string("no full-size channel ") + names[c]);
    // OpenEXR addresses pixels from (0, 0), wherever the data window begins.
    const ptrdiff_t origin = (ptrdiff_t)window.min.y * (ptrdiff_t)width + window.min.x;
    buffer.insert(names[c],
                  Imf::Slice(Imf::FLOAT,
                             (char *)(&pixels[c]) - origin * (ptrdiff_t)(3 * sizeof(float)),
                             3 * sizeof(float), 3 * sizeof(float) * width));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);

  BumpImage *image = new BumpImage(width, height);
  for (size_t row = 0; row < height; row++)
    for (size_t column = 0; column < width; column++) {
      const float *p = &pixels[3 * (row * width + column)];
      image->set(column, row, p[0], p[1], p[2]);
    }
  return image;
}

} // namespace mdf
