/* SPDX-License-Identifier: Apache-2.0 */
/* Points of a texture on standard input, for `scratch --eval` and `slopes`. */
#ifndef SHADE_TOOL_POINTS_H
#define SHADE_TOOL_POINTS_H

/* One line's answer, printed by the callback. footprint is NULL for a point. */
typedef void tool_point(void *context, double u, double v, const double footprint[4]);

/*
 * Lines of 'u v' or 'u v du1 dv1 du2 dv2' until the end; those of tool_next_line.
 * TOOL_DONE, or TOOL_BAD_INPUT after a message "shade TITLE: standard input, line N: …".
 */
int tool_read_points(const char *title, tool_point *answer, void *context);

#endif
