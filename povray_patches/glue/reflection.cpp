// SPDX-License-Identifier: AGPL-3.0-or-later
// The rays of `reflection { }`: where they go, and how wide they are then.

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/surface.h"

#include <cmath>
#include <cstdint>
#include <cstring>

#include "backend/mdf/dither.h"
#include "backend/mdf/tangents.h"
#include "backend/mdf/vectors.h"
#include "backend/scene/objects.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

using namespace glue;

namespace {

uint64_t splitmix64(uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

void split_hash(uint64_t hash, unsigned int seed[2]) {
  seed[0] = (uint32_t)hash;
  seed[1] = (uint32_t)(hash >> 32);
}

// Owen's nested uniform scrambling [Owen1995] of bits in reverse: what a bit is flipped by must
// come from those below it then, as sums and products have it [LaineKarras2011].
uint32_t owen_scrambled(uint32_t reversed, uint32_t seed) {
  reversed += seed;
  reversed ^= reversed * 0xb63c2d6cu; // an even factor: no bit moves by itself
  reversed *= (seed >> 15) | 1u;
  reversed ^= reversed * 0x2f0a9f52u;
  reversed += seed ^ 0x9e3779b9u;
  reversed *= 0x5c61ddb5u;
  reversed ^= reversed * 0xd1b54a32u;
  return reversed;
}

uint32_t reversed_bits(uint32_t x) {
  x = __builtin_bswap32(x);
  x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

// One coordinate of a Morton code, and back: 16 bits at every other one.
uint32_t morton_spread(uint32_t x) {
  x &= 0xffffu;
  x = (x | x << 8) & 0x00ff00ffu;
  x = (x | x << 4) & 0x0f0f0f0fu;
  x = (x | x << 2) & 0x33333333u;
  return (x | x << 1) & 0x55555555u;
}

uint32_t morton_compact(uint32_t x) {
  x &= 0x55555555u;
  x = (x | x >> 1) & 0x33333333u;
  x = (x | x >> 2) & 0x0f0f0f0fu;
  x = (x | x >> 4) & 0x00ff00ffu;
  return (x | x >> 8) & 0xffffu;
}

// Blue noise: the numbers that pixels around have are far from those of this one
// [GeorgievFajardo2016].
const uint8_t *blue_noise(uint32_t x, uint32_t y) {
  return DITHER[y % DITHER_SIDE * DITHER_SIDE + x % DITHER_SIDE];
}

double fraction(double x) {
  return x - std::floor(x);
}

// Sobol's second and third dimensions: what each byte of an index turns about in a point, bits in
// reverse. (The first dimension is the index itself.)
struct SobolTable {
  uint32_t turned[2][4][256];

  SobolTable() {
    // of the polynomials x + 1 and x^2 + x + 1, the latter of which goes back by two
    uint32_t direction[2] = {0x80000000u, 0x80000000u}, next = 0xc0000000u;

    for (int bit = 0; bit < 32; bit++) {
      for (int dimension = 0; dimension < 2; dimension++) {
        uint32_t *const byte = turned[dimension][bit / 8];
        const int from = 1 << bit % 8;
        byte[0] = 0;
        for (int i = 0; i < from; i++)
          byte[from + i] = byte[i] ^ reversed_bits(direction[dimension]);
      }
      const uint32_t after = next ^ direction[1] ^ direction[1] >> 2;
      direction[0] ^= direction[0] >> 1;
      direction[1] = next;
      next = after;
    }
  }

  uint32_t of(int dimension, uint32_t index) const {
    const uint32_t(*const byte)[256] = turned[dimension];

    return byte[0][index & 0xff] ^ byte[1][index >> 8 & 0xff] ^ byte[2][index >> 16 & 0xff] ^
           byte[3][index >> 24];
  }
};

const SobolTable SOBOL;

// Points of Sobol's first three dimensions, Owen-scrambled. Any run of 2^k from a multiple of 2^k
// on meets each cell of every grid of 2^k equal cells of the first two once, and so does each of
// the wholes that four such runs make.
void owen_sobol(uint32_t index, const uint32_t seed[2], double point[3]) {
  // the order is another one for each seed: numbers of two seeds have nothing in common
  index = reversed_bits(owen_scrambled(reversed_bits(index), seed[0] ^ seed[1]));
  point[0] = reversed_bits(owen_scrambled(index, seed[0])) * 0x1p-32;
  point[1] = reversed_bits(owen_scrambled(SOBOL.of(0, index), seed[1])) * 0x1p-32;
  point[2] = reversed_bits(owen_scrambled(SOBOL.of(1, index), seed[0] + seed[1])) * 0x1p-32;
}

} // namespace

void MdfHit::Seed(const VECTOR point, const VECTOR direction, int layer, unsigned int seed[2]) {
  uint64_t hash = splitmix64((uint64_t)layer);

  for (int i = X; i <= Z; i++) {
    uint64_t bits[2];
    std::memcpy(&bits[0], &point[i], sizeof bits[0]);
    std::memcpy(&bits[1], &direction[i], sizeof bits[1]);
    hash = splitmix64(splitmix64(hash ^ bits[0]) ^ bits[1]);
  }
  split_hash(hash, seed);
}

unsigned int MdfHit::PixelSeed(double x, double y, unsigned int seed[2]) {
  const double left = std::floor(x), top = std::floor(y);
  const double within[3] = {x - left, y - top, 0.0};

  Seed(within, within, 0, seed);
  seed[0] |= 1u; // never none
  return morton_spread((uint32_t)(int)left) | morton_spread((uint32_t)(int)top) << 1;
}

void MdfHit::PathSeed(const unsigned int pixel[2], unsigned int level, const Ray &ray, int layer,
                      unsigned int seed[2]) {
  const uint64_t kind = (ray.IsReflectionRay() ? 1u : 0u) | (ray.IsRefractionRay() ? 2u : 0u);

  split_hash(splitmix64(((uint64_t)pixel[1] << 32 | pixel[0]) ^
                        splitmix64((uint64_t)level << 32 | (uint64_t)(uint32_t)layer << 2 | kind)),
             seed);
}

double MdfHit::Chance(const unsigned int seed[2], unsigned int index, unsigned int rays) {
  unsigned int of[2];

  // of no point's numbers; over paths by the two dimensions of Roberts' sequence
  split_hash(splitmix64(splitmix64((uint64_t)seed[1] << 32 | seed[0])), of);
  return fraction(of[0] * 0x1p-32 + index * 0.7548776662466927) +
         std::floor(fraction(of[1] * 0x1p-32 + index * 0.5698402909980532) * rays);
}

bool MdfHit::Sample(unsigned int index, const unsigned int seed[2], Vector3d &direction,
                    RGBColour &throughput) const {
  double u[3];

  owen_sobol(index, seed, u);
  return SampleBy(u, direction, throughput);
}

bool MdfHit::SampleAlone(const unsigned int seed[2], Vector3d &direction,
                         RGBColour &throughput) const {
  const double u[3] = {seed[0] * 0x1p-32, seed[1] * 0x1p-32, (seed[0] ^ seed[1]) * 0x1p-32};

  return SampleBy(u, direction, throughput);
}

bool MdfHit::SampleLattice(unsigned int index, unsigned int pixel, const unsigned int seed[2],
                           Vector3d &direction, RGBColour &throughput) const {
  const mdf::Lattice &lattice = shaded.of().lattice;
  const uint32_t x = morton_compact(pixel) + seed[0] % DITHER_SIDE;
  const uint32_t y = morton_compact(pixel >> 1) + seed[1] % DITHER_SIDE;
  const uint8_t *const moved = blue_noise(x, y);
  double part[2], u[3];

  for (int i = 0; i < 2; i++)
    part[i] = fraction((moved[i] + 0.5) / 256.0 + (seed[i] >> 16) / 65536.0);
  for (int i = 0; i < 2; i++)
    u[i] = fraction((double)(index * lattice.step[i] % lattice.count) / lattice.count +
                    lattice.side[0][i] * part[0] + lattice.side[1][i] * part[1]);
  // which yarn of a cloth, by multiples of the golden ratio. Which lobe is for the second number to
  // tell: by a third one the points of a lobe would lie unevenly
  u[2] = !shaded.of().cloth ? -1.0
                            : fraction(index * 0.61803398874989485 +
                                       (blue_noise(x + DITHER_SIDE / 2, y)[0] + 0.5) / 256.0);
  return SampleBy(u, direction, throughput);
}

bool MdfHit::SampleBy(const double u[3], Vector3d &direction, RGBColour &throughput) const {
  double L[3], share[3];

  if (!shaded.sample(level, u, L, share))
    return false;
  direction = Vector3d(L);
  throughput = rgb_colour(share);
  return true;
}

void MdfHit::Clamp(RGBColour &colour) const {
  const double most = shaded.of().clamp;
  const double brightest = max(max(colour.red(), colour.green()), colour.blue());

  if (most > 0.0 && brightest > most)
    colour *= most / brightest;
}

double Mdf_Mirror_Spread(const Intersection &isect, const Vector3d &raw_normal, double width,
                         TraceThreadData *thread) {
  // The mean curvature is half of how much normals around the point lean away from it. Objects
  // tell a normal beside a surface as well as on it; those without bounds have no size to go by.
  const double across =
      std::abs(isect.IPoint[X]) + std::abs(isect.IPoint[Y]) + std::abs(isect.IPoint[Z]);
  const double step = min(max(width, 1e-7 * across + 1e-9), 1e3 * difference_step(isect.Object));
  Vector3d side[2] = {any_tangent(raw_normal), Vector3d()};
  double lean = 0.0, facing = 0.0;

  side[1] = cross(raw_normal, side[0]);
  for (int i = 0; i < 4; i++) {
    const Vector3d way = i % 2 ? -side[i / 2] : side[i / 2];
    Intersection probe(isect);
    Vector3d beside;
    Assign_Vector(probe.IPoint, *(Vector3d(isect.IPoint) + step * way));
    probe.haveLocalIPoint = false;
    isect.Object->Normal(*beside, &probe, thread);
    lean += dot(beside, way);
    facing += dot(beside, raw_normal);
  }
  const double spread =
      2.0 * width * lean / (4.0 * step); // a mirror turns twice as far as its normal
  return !std::isfinite(spread) ? 0.0 : facing < 0.0 ? -spread : spread;
}

void Mark_Mdf_Lamp(ObjectBase *object) {
  object->Mdf_Lamp = true;
  if (object->Type & IS_COMPOUND_OBJECT) {
    std::vector<ObjectPtr> &parts = static_cast<CompoundObject *>(object)->children;
    for (size_t i = 0; i < parts.size(); i++)
      Mark_Mdf_Lamp(parts[i]);
  }
}

} // namespace pov
