// SPDX-License-Identifier: AGPL-3.0-or-later
// What POV-Ray's vectors, transformations and colours lack for the glue.
#ifndef POVRAY_BACKEND_MDF_VECTORS_H
#define POVRAY_BACKEND_MDF_VECTORS_H

#include <cmath>

#include "backend/frame.h"
#include "backend/colour/colour.h"
#include "backend/math/matrices.h"
#include "backend/math/vector.h"

namespace pov {
namespace glue {

inline Vector3d axis_vector(int axis) {
  return Vector3d(axis == X, axis == Y, axis == Z);
}

// A vector of unit length, which what POV-Ray hands over mostly has already. Further off than a few
// roundings libshade would mend what is seen of it, for each light anew.
inline Vector3d unit(const Vector3d &v) {
  const double square = v.lengthSqr();
  return fabs(square - 1.0) < 4e-15 ? v : v * (1.0 / std::sqrt(square));
}

inline bool is_finite(const Vector3d &v) {
  return std::isfinite(dot(v, v));
}

// v without its part along the unit vector n, normalised. False if nothing is left.
inline bool orthogonalise(Vector3d &v, const Vector3d &n) {
  const double before = v.lengthSqr();
  v -= n * dot(v, n);
  const double after = v.lengthSqr();

  if (!(after > 1e-18 * before) || !std::isfinite(after))
    return false;
  v *= 1.0 / std::sqrt(after);
  if (after < 1e-2 * before) { // v was almost along n: what rounding left of it counts
    v -= n * dot(v, n);
    v.normalize();
  }
  return true;
}

// Any unit vector orthogonal to a normal: z where that can be.
inline Vector3d any_tangent(const Vector3d &normal) {
  Vector3d tangent;

  for (int i = Z; i >= X; i--) {
    tangent = axis_vector(i);
    if (orthogonalise(tangent, normal))
      break;
  }
  return tangent;
}

// A direction, or a point, transformed; NULL is the identity.
inline Vector3d transformed(const Vector3d &direction, const TRANSFORM *transform) {
  Vector3d result(direction);

  if (transform != NULL)
    MTransDirection(*result, *direction, transform);
  return result;
}

inline Vector3d transformed(const Vector3d &direction, const MATRIX m) {
  Vector3d result(0.0);

  for (int i = X; i <= Z; i++)
    result += direction[i] * Vector3d(m[i][X], m[i][Y], m[i][Z]);
  return result;
}

inline Vector3d inverse_point(const Vector3d &p, const TRANSFORM *transform) {
  Vector3d result(p);

  if (transform != NULL)
    MInvTransPoint(*result, *p, transform);
  return result;
}

// The point that a matrix moves to p.
inline Vector3d inverse_point(const Vector3d &p, const MATRIX m) {
  const Vector3d rows[4] = {Vector3d(m[0]), Vector3d(m[1]), Vector3d(m[2]), Vector3d(m[3])};
  const Vector3d offset = p - rows[3], yz = cross(rows[1], rows[2]);

  return Vector3d(dot(offset, yz), dot(offset, cross(rows[2], rows[0])),
                  dot(offset, cross(rows[0], rows[1]))) /
         dot(rows[0], yz);
}

inline RGBColour rgb_colour(const double v[3]) {
  return RGBColour((COLC)v[0], (COLC)v[1], (COLC)v[2]);
}

inline double determinant(const MATRIX m) {
  double sum = 0.0;

  for (int i = 0; i < 3; i++)
    sum +=
        m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]);
  return sum;
}

} // namespace glue
} // namespace pov

#endif
