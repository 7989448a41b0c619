/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Images as the stages read them: planes of two signed 16-bit numbers a texel, each in [-1, 1].
 *
 * A normal map is one plane: x and y of the unit normal, with its strength applied. z is the
 * positive root. A colour is two planes: 2 red - 1 and 2 green - 1, then 2 blue - 1 and
 * 2 alpha - 1. 16 bits do as well as float for the displaced plate.
 *
 * A colour of bytes is one plane of four bytes a texel as they are in the file. They are mixed
 * before they are decoded, as in Cycles. A wide colour, of which something is beyond [0, 1], is a
 * plane of floats for each channel, without coarser levels.
 *
 * A colour may have coarser levels, each half as large as the one before, down to one texel. They
 * take a third more memory in all. A texel there is the mean of those that it covers, in linear
 * light.
 */
#ifndef LIBSHADE_TEXTURE_H
#define LIBSHADE_TEXTURE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum image_type { IMAGE_FLOAT32, IMAGE_UINT16, IMAGE_UINT8 } image_type;
typedef enum image_wrap { WRAP_REPEAT, WRAP_EXTEND, WRAP_CLIP, WRAP_MIRROR } image_wrap;

typedef struct image {
  int width, height, channels;
  image_type type;
  const void *data; /* rows from the bottom */
  bool srgb;        /* to be decoded to linear */
  image_wrap wrap;
  bool closest; /* nearest texel instead of bilinear */
  bool wide;    /* floats, some of them beyond [0, 1] */
  bool paged;   /* data is of a file's pages, all of them */
} image;

/* A texture's width and height are those of its image and this. */
enum { TEXTURE_RIM = 3, TEXTURE_LEVELS = 24 };

/* So many texels, squared, are still seen one by one. */
#define TEXTURE_FINE 3.0f

/* Is what goes this far over a UV map seen coarser, where that counts so many texels? */
static inline bool texture_is_coarse(float width, float texels) {
  return width * texels * (width * texels) > 0.999f * TEXTURE_FINE;
}

typedef enum texture_kind {
  TEXTURE_NORMAL,
  TEXTURE_RED_GREEN,
  TEXTURE_BLUE_ALPHA,
  TEXTURE_RED, /* one float, bit by bit; these four in the order of channels */
  TEXTURE_GREEN,
  TEXTURE_BLUE,
  TEXTURE_ALPHA,
  TEXTURE_BYTES,  /* red in the lowest, alpha in the highest */
  TEXTURE_SQUARES /* of a normal map's x and y, means over texels of its coarser levels, from 1 on
                   */
} texture_kind;

/* WEIGHTED: means of colours go by their alpha, as what is behind them sees them. */
typedef enum texture_coarse { COARSE_NONE, COARSE_EVEN, COARSE_WEIGHTED } texture_coarse;

/*
 * How many levels above that of the means the spread about them is taken. Of few bumps it goes up
 * and down by itself, and lobes of many widths about means that spread, too, are in sum brighter in
 * the middle and darker beside it than the bumps: by 8 and 7 % where a texel covers about one.
 */
enum { TEXTURE_WIDER = 3 };

/* Level 0 is the image, of this width and height; each other is half as large, rounded down, but a
 * texel at least. Where the texels of each begin. */
typedef struct texture_levels {
  int count, at[TEXTURE_LEVELS];
  float width, height;
} texture_levels;

typedef struct texture {
  /*
   * Low half: first number, high half: second. A rim of one texel before and two after each
   * axis holds what lies beyond the edge, so that looking up needs no case distinctions.
   */
  uint32_t *texel;
  int width, height, stride; /* texel (x, y) is number (y + 1) * stride + x + 1 */
  image_wrap wrap;
  float linear; /* 1: bilinear, 0: nearest */
  size_t paged; /* bytes, of a large one: in pages.h's file */
  bool filled;  /* before */
  /* what it is made from */
  const image *source;
  texture_kind kind;
  float strength;
  texture_coarse coarse;
  texture_levels level;
  const struct texture *normal; /* of squares */
  /* Of a normal map with coarser levels, by level and for x and y: what the level's means do not
   * say of the squares, over what those of the level TEXTURE_WIDER above do not. */
  float part[2][TEXTURE_LEVELS];
} texture;

typedef struct texture_set {
  size_t count;
  texture **item;
  size_t paged; /* bytes of all */
  size_t other; /* pages of files that were in memory without them */
} texture_set;

/* What of paged textures may stay in memory while a picture is made, about. */
enum { TEXTURE_RESIDENT = 1 << 30 };

/* The texture for an image, the same one for the same request. NULL when out of memory. Coarser
 * levels of normals are means of their x and y: what these do not say, their squares do. */
const texture *texture_request(texture_set *set, const image *source, texture_kind kind,
                               float strength, texture_coarse coarse);

/* Its level k stands beside level k + 1 of the normals. NULL when out of memory. */
const texture *texture_squares(texture_set *set, const texture *normal);

/* Fill all requested textures. False when out of memory; stops early when *cancel is true. */
bool texture_pack(texture_set *set, int threads, const atomic_bool *cancel);

/* Sends paged textures to their files when more bytes of them than that are in memory. Any thread,
 * while others look them up: what these need comes back. */
void texture_relieve(const texture_set *set, size_t most);

/*
 * True when the image has no more than 8 bits a channel, whatever its type: too
 * coarse for the normals of a sharp lobe (error .033 at exponent 6170).
 */
bool texture_is_8bit(const image *source);

/* One channel of a row of an image, linear; a channel that is missing repeats the first one. */
void image_row(const image *source, int y, int channel, float *out);

/* Textures that are requested and not filled take what the same request was filled with before; of
 * these nothing is left. */
void texture_take(texture_set *set, texture_set *before);

void texture_free(texture_set *set);

#endif
