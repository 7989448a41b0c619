// SPDX-License-Identifier: Apache-2.0
// The module shade_image_oiio.so: OpenImageIO behind one C function.
#include "image/read.h"

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>

using namespace OIIO;

namespace {

constexpr std::int64_t most_texels = std::int64_t(1) << 30;
constexpr int most_side = 65536;

std::string read(const char *path, int most, shade_picture &picture) {
  std::unique_ptr<ImageInput> file = ImageInput::open(path);
  if (!file)
    return geterror();
  const ImageSpec &spec = file->spec();
  if (spec.deep || spec.depth > 1)
    return "expected a flat picture, not a deep or solid one";
  if (spec.width < 1 || spec.height < 1 || spec.width > most_side || spec.height > most_side ||
      std::int64_t(spec.width) * spec.height > most_texels || spec.nchannels < 1)
    return "expected 1 to 65536 texels a side and 2^30 at most, found " +
           std::to_string(spec.width) + " x " + std::to_string(spec.height);
  const int channels = spec.nchannels < most ? spec.nchannels : most;
  const std::size_t count =
      std::size_t(spec.width) * std::size_t(spec.height) * std::size_t(channels);
  // a header that promises what is not there would leave rows unset
  picture.pixels = static_cast<float *>(std::calloc(count, sizeof(float)));
  if (!picture.pixels)
    return "out of memory";
  if (!file->read_image(0, 0, 0, channels, TypeDesc::FLOAT, picture.pixels))
    return file->geterror();
  picture.width = spec.width;
  picture.height = spec.height;
  picture.channels = channels;
  picture.bits = int(spec.format.basesize()) * 8;
  return "";
}

} // namespace

extern "C" __attribute__((visibility("default"))) int shade_oiio_read(const char *path, int most,
                                                                      shade_picture *picture,
                                                                      char *error,
                                                                      std::size_t error_size) {
  std::string message;
  *picture = shade_picture();
  try {
    message = read(path, most, *picture);
  } catch (const std::exception &e) {
    message = e.what();
  } catch (...) {
    message = "unknown failure of OpenImageIO";
  }
  if (picture->width)
    return 0;
  std::free(picture->pixels);
  picture->pixels = nullptr;
  while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
    message.pop_back();
  std::snprintf(error, error_size, "%s: cannot read: %s", path,
                message.empty() ? "no reason given" : message.c_str());
  return -1;
}
