// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/dump.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "dump/dump.h"
#include "dump/whole.h"

namespace mdf {

std::string Dump::wanted() {
  const char *name = std::getenv("LIBSHADE_DUMP");
  return (name != NULL) ? name : "";
}

Dump::Dump(const std::string &file, int width, int height, int lights, bool cloth, bool painted,
           bool bumps, bool scratches, bool reliefs)
    : path(file), data(shade_dump_create(width, height, lights)) {
  if (data == NULL)
    throw std::runtime_error("LIBSHADE_DUMP: out of memory");
  if ((cloth && (shade_dump_add(data, SHADE_DUMP_FOOT) == NULL ||
                 shade_dump_add(data, SHADE_DUMP_COVERAGE) == NULL)) ||
      (painted && shade_dump_add(data, SHADE_DUMP_KD) == NULL) ||
      (bumps && (shade_dump_add(data, SHADE_DUMP_ALPHA) == NULL ||
                 shade_dump_add(data, SHADE_DUMP_GROOVE) == NULL)) ||
      (scratches && (shade_dump_add(data, SHADE_DUMP_LOBE2) == NULL ||
                     shade_dump_add(data, SHADE_DUMP_LOBE3) == NULL)) ||
      (reliefs && shade_dump_add(data, SHADE_DUMP_SLOPES) == NULL)) {
    shade_dump_free(data);
    throw std::runtime_error("LIBSHADE_DUMP: out of memory");
  }
  // Better now than after the last pixel.
  const size_t slash = path.rfind('/');
  const std::string folder = (slash == std::string::npos) ? "." : path.substr(0, slash + 1);
  char wrong[256];
  if (shade_whole_write(path.c_str(), NULL, 0, wrong, sizeof wrong) != 0) { // only tried
    shade_dump_free(data);
    throw std::runtime_error("LIBSHADE_DUMP: " + path + ", in the folder " + folder + ": " + wrong);
  }
}

Dump::~Dump() {
  shade_dump_free(data);
}

int Dump::start(double x, double y) {
  if (x != std::floor(x) || y != std::floor(y) || x < 0 || y < 0 || x >= data->width ||
      y >= data->height)
    return -1;

  const int pixel = (int)y * data->width + (int)x;
  const size_t planes = SHADE_DUMP_BASE + (size_t)SHADE_DUMP_PER_LIGHT * (size_t)data->lights;
  const size_t size = (size_t)data->width * (size_t)data->height;

  for (size_t plane = 0; plane < planes; plane++)
    data->data[plane * size + (size_t)pixel] = 0.0f;
  shade_dump_plane(data, SHADE_DUMP_MATERIAL)[pixel] = -1.0f;
  return pixel;
}

void Dump::put(float *plane, int pixel, const double *values, int count) {
  const size_t size = (size_t)data->width * (size_t)data->height;

  for (int c = 0; c < count; c++)
    plane[(size_t)c * size + (size_t)pixel] = (float)values[c];
}

void Dump::put_vector(float *plane, int pixel, const double v[3], bool mirrored) {
  const double seen[3] = {mirrored ? -v[0] : v[0], v[1], v[2]};

  put(plane, pixel, seen, 3);
}

bool Dump::hit(int pixel, const Material *material, const double P[3], const double uv[2],
               const double N[3], const double T[3], const double V[3], const double pigment[3],
               const ClothPlace *cloth, double gaps, const LobeSeen *lobes, int count,
               const double slopes[5], bool mirrored) {
  float *const id = &shade_dump_plane(data, SHADE_DUMP_MATERIAL)[pixel];
  const shade_params &params = material->params;

  if (*id >= 0.0f)
    return false;
  *id = (float)material->id;
  put_vector(shade_dump_plane(data, SHADE_DUMP_P), pixel, P, mirrored);
  put_vector(shade_dump_plane(data, SHADE_DUMP_N), pixel, N, mirrored);
  put_vector(shade_dump_plane(data, SHADE_DUMP_T), pixel, T, mirrored);
  put_vector(shade_dump_plane(data, SHADE_DUMP_NS), pixel, lobes[0].normal, mirrored);
  put_vector(shade_dump_plane(data, SHADE_DUMP_V), pixel, V, mirrored);
  put(shade_dump_plane(data, SHADE_DUMP_UV), pixel, cloth ? cloth->uv : uv, 2);
  put(shade_dump_plane(data, SHADE_DUMP_COLOR), pixel,
      material->specular_pigment ? pigment : params.f0, 3);
  if (shade_dump_has(data, SHADE_DUMP_KD))
    put(shade_dump_plane(data, SHADE_DUMP_KD), pixel, material->kd_pigment ? pigment : params.kd,
        3);
  if (shade_dump_has(data, SHADE_DUMP_ALPHA)) {
    put(shade_dump_plane(data, SHADE_DUMP_ALPHA), pixel, lobes[0].alpha, 2);
    put(shade_dump_plane(data, SHADE_DUMP_GROOVE), pixel, &lobes[0].angle, 1);
  }
  for (int i = 1; i < ShadedPoint::MOST_LOBES && shade_dump_has(data, SHADE_DUMP_LOBE2); i++) {
    static const LobeSeen none = {0.0, {0.0, 0.0, 0.0}, {0.0, 0.0}, 0.0};
    const LobeSeen &lobe = i < count ? lobes[i] : none;
    const int plane = SHADE_DUMP_LOBE2 + (i - 1) * SHADE_DUMP_PER_LOBE;
    put(shade_dump_plane(data, plane + SHADE_DUMP_LOBE_SHARE), pixel, &lobe.share, 1);
    put_vector(shade_dump_plane(data, plane + SHADE_DUMP_LOBE_NS), pixel, lobe.normal, mirrored);
    put(shade_dump_plane(data, plane + SHADE_DUMP_LOBE_ALPHA), pixel, lobe.alpha, 2);
    put(shade_dump_plane(data, plane + SHADE_DUMP_LOBE_GROOVE), pixel, &lobe.angle, 1);
  }
  if (shade_dump_has(data, SHADE_DUMP_SLOPES))
    put(shade_dump_plane(data, SHADE_DUMP_SLOPES), pixel, slopes, 5);
  if (shade_dump_has(data, SHADE_DUMP_FOOT)) {
    static const double none[2] = {0.0, 0.0};
    const double coverage = 1.0 - gaps;
    put(shade_dump_plane(data, SHADE_DUMP_FOOT), pixel, cloth ? cloth->footprint : none, 2);
    put(shade_dump_plane(data, SHADE_DUMP_COVERAGE), pixel, &coverage, 1);
  }
  // A light that sends nothing here is never reported; L must still be a direction.
  for (int number = 0; number < data->lights; number++)
    put_vector(shade_dump_light_plane(data, number, SHADE_DUMP_L), pixel, N, mirrored);
  return true;
}

void Dump::light(int pixel, int number, const double L[3], const double E[3], const double S[3],
                 bool mirrored) {
  if (number < 0 || number >= data->lights)
    return;
  put_vector(shade_dump_light_plane(data, number, SHADE_DUMP_L), pixel, L, mirrored);
  put(shade_dump_light_plane(data, number, SHADE_DUMP_E), pixel, E, 3);
  put(shade_dump_light_plane(data, number, SHADE_DUMP_S), pixel, S, 3);
}

void Dump::write(const std::string &json) {
  char error[1024];

  if (shade_dump_set_json(data, json.c_str()) != 0)
    throw std::runtime_error("LIBSHADE_DUMP: out of memory");
  if (shade_dump_write(shade_exr_api_linked(), path.c_str(), data, error, sizeof(error)) != 0)
    throw std::runtime_error(std::string("LIBSHADE_DUMP: ") + error);
}

} // namespace mdf
