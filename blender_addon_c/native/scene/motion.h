/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What moves while the shutter is open: places at times that are evenly spaced from 0 to 1. */
#ifndef LIBSHADE_MOTION_H
#define LIBSHADE_MOTION_H

#include <stdbool.h>
#include <stddef.h>

enum { MOTION_STEPS_MOST = 129 };

/* A matrix as a turn of what is stretched, so that what turns between two places goes round. */
typedef struct pose {
  float turn[4];  /* quaternion, real part first */
  float shape[6]; /* upper triangle: xx xy xz yy yz zz */
  float place[3];
} pose;

typedef struct motion {
  int steps; /* 0: it stays */
  pose *pose;
} motion;

/* Of `steps` matrices, rows of 4; false with no poses where one cannot be inverted or is no
 * number, and with steps where there is no memory. */
bool motion_make(const float *matrices, int steps, motion *out);
void motion_at(const motion *m, float time, float matrix[12]);
void motion_free(motion *m);

/* Between which two steps a time lies: the first of them, and how far towards the next. */
int motion_step(int steps, float time, float *part);

#endif
