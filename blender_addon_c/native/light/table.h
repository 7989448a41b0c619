/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kinds of light, by number. */
#ifndef LIBSHADE_LIGHT_TABLE_H
#define LIBSHADE_LIGHT_TABLE_H

#define LIGHT_TABLE(ROW)                                                                           \
  ROW(SUN, sun)                                                                                    \
  ROW(POINT, point)                                                                                \
  ROW(SPOT, spot)                                                                                  \
  ROW(AREA, area)

#define LIGHT_TYPE(TYPE, name) LIGHT_##TYPE,
typedef enum light_type { LIGHT_TABLE(LIGHT_TYPE) LIGHT_TYPES } light_type;

#endif
