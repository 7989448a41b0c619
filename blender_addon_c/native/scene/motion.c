/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double dot3(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Takes its part along q from v, which becomes a unit vector; `along` and `length` say how much. */
static bool straighten(double *v, size_t before, double axis[3][3], double along[2],
                       double *length) {
  double whole = sqrt(dot3(v, v));
  for (size_t k = 0; k < before; k++) {
    along[k] = dot3(axis[k], v);
    for (size_t i = 0; i < 3; i++)
      v[i] -= along[k] * axis[k][i];
  }
  *length = sqrt(dot3(v, v));
  if (!(*length > 1e-6 * whole && *length > 1e-9 && *length < 1e18)) /* false for NaN */
    return false;
  for (size_t i = 0; i < 3; i++)
    v[i] /= *length;
  return true;
}

/* Quaternion of three axes, the columns of a turn. */
static void quaternion_of(double axis[3][3], float out[4]) {
  double q[4] = {1 + axis[0][0] + axis[1][1] + axis[2][2], 1 + axis[0][0] - axis[1][1] - axis[2][2],
                 1 - axis[0][0] + axis[1][1] - axis[2][2],
                 1 - axis[0][0] - axis[1][1] + axis[2][2]};
  int largest = 0;
  for (int k = 1; k < 4; k++)
    largest = q[k] > q[largest] ? k : largest;
  double size = 0.5 * sqrt(fmax(q[largest], 0)), by = size > 0 ? 0.25 / size : 0;
  /* differences and sums of the entries across the diagonal; axis[c][r] */
  double x = axis[1][2] - axis[2][1], y = axis[2][0] - axis[0][2], z = axis[0][1] - axis[1][0];
  double xy = axis[0][1] + axis[1][0], xz = axis[0][2] + axis[2][0], yz = axis[1][2] + axis[2][1];
  double rows[4][4] = {{0, x, y, z}, {x, 0, xy, xz}, {y, xy, 0, yz}, {z, xz, yz, 0}};
  for (int k = 0; k < 4; k++)
    out[k] = (float)(k == largest ? size : rows[largest][k] * by);
}

static bool pose_of(const float m[12], pose *out) {
  double axis[3][3], along[2], length;
  for (int column = 0; column < 3; column++) {
    for (int row = 0; row < 3; row++)
      axis[column][row] = (double)m[4 * row + column];
    out->place[column] = m[4 * column + 3];
    if (!isfinite(out->place[column]))
      return false;
  }
  static const int at[3][3] = {{0, 0, 0}, {1, 3, 0}, {2, 4, 5}};
  for (size_t column = 0; column < 3; column++) {
    if (!straighten(axis[column], column, axis, along, &length))
      return false;
    for (size_t k = 0; k < column; k++)
      out->shape[at[column][k]] = (float)along[k];
    out->shape[at[column][column]] = (float)length;
  }
  double normal[3] = {axis[0][1] * axis[1][2] - axis[0][2] * axis[1][1],
                      axis[0][2] * axis[1][0] - axis[0][0] * axis[1][2],
                      axis[0][0] * axis[1][1] - axis[0][1] * axis[1][0]};
  if (dot3(normal, axis[2]) < 0) { /* it mirrors: no turn does */
    for (int k = 0; k < 3; k++)
      axis[2][k] = -axis[2][k];
    out->shape[5] = -out->shape[5];
  }
  quaternion_of(axis, out->turn);
  return true;
}

static float dot4(const float a[4], const float b[4]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

bool motion_make(const float *matrices, int steps, motion *out) {
  *out = (motion){.steps = steps, .pose = calloc((size_t)steps, sizeof *out->pose)};
  for (int k = 0; out->pose && k < steps; k++) {
    if (!pose_of(matrices + 12 * k, &out->pose[k])) {
      motion_free(out);
      return false;
    }
    float *turn = out->pose[k].turn;
    bool other = k > 0 && dot4(turn, out->pose[k - 1].turn) < 0.0f;
    for (int i = 0; other && i < 4; i++) /* the shorter way */
      turn[i] = -turn[i];
  }
  return out->pose != NULL;
}

void motion_free(motion *m) {
  free(m->pose);
  *m = (motion){.pose = NULL};
}

int motion_step(int steps, float time, float *part) {
  float at = time * (float)(steps - 1);
  int step = (int)at;
  step = step < 0 ? 0 : step > steps - 2 ? steps - 2 : step;
  *part = at - (float)step;
  return step;
}

/* Along the great circle between two turns; between near ones straight on. */
static void turn_between(const float a[4], const float b[4], float part, float out[4]) {
  float cosine = dot4(a, b), left = 1.0f - part, right = part;
  if (cosine < 0.9995f) {
    float angle = acosf(fmaxf(cosine, -1.0f)), sine = sinf(angle);
    left = sinf(left * angle) / sine;
    right = sinf(right * angle) / sine;
  }
  for (int k = 0; k < 4; k++)
    out[k] = left * a[k] + right * b[k];
  float length = sqrtf(dot4(out, out));
  for (int k = 0; k < 4; k++)
    out[k] /= length;
}

void motion_at(const motion *m, float time, float out[12]) {
  float part, q[4], s[6];
  const pose *a = m->pose + motion_step(m->steps, time, &part), *b = a + 1;
  turn_between(a->turn, b->turn, part, q);
  for (int k = 0; k < 6; k++)
    s[k] = a->shape[k] + part * (b->shape[k] - a->shape[k]);
  float w = q[0], x = q[1], y = q[2], z = q[3];
  const float r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                         {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                         {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  for (int row = 0; row < 3; row++) {
    out[4 * row] = r[row][0] * s[0];
    out[4 * row + 1] = r[row][0] * s[1] + r[row][1] * s[3];
    out[4 * row + 2] = r[row][0] * s[2] + r[row][1] * s[4] + r[row][2] * s[5];
    out[4 * row + 3] = a->place[row] + part * (b->place[row] - a->place[row]);
  }
}
