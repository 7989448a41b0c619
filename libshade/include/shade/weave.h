/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Woven cloth: which yarn is on top at a point, and how its surface is tilted there.
 *
 * Coordinates. u counts warp ends and v weft picks, one unit a crossing, repeating with the
 * draft in both directions. Warp yarns (ends) run along v, side by side in u; weft yarns
 * (picks) run along u. In the surface frame x points along u and y along v.
 *
 * A shade_draft says what lies over what, and each yarn's colour, thickness and spacing; a
 * shade_weave joins a draft and the shape of the yarns, ready for look-ups.
 *
 * Threads. All functions are reentrant. A draft or weave may be read by any number of
 * threads. Only functions that return a draft, a weave or a text allocate; look-ups do not.
 */
#ifndef SHADE_WEAVE_H
#define SHADE_WEAVE_H

#include <stddef.h>
#include <stdint.h>

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One yarn of a draft. */
typedef struct shade_thread {
  double color[3];  /* as a display shows it (sRGB, encoded), [0, 1]; 1 by default */
  double thickness; /* cm, > 0; 0: not stated */
  double spacing;   /* centre to centre, cm, > 0; 0: not stated */
} shade_thread;

/*
 * One repeat of a weave. warp_up[pick * ends + end] is 1 where the warp end lies over the
 * weft pick, 0 where the weft is on top; both counted from 0. The members may be changed
 * until the draft is freed, but not ends and picks.
 */
typedef struct shade_draft {
  int ends, picks;
  unsigned char *warp_up;
  shade_thread *warp; /* one per end */
  shade_thread *weft; /* one per pick */
} shade_draft;

enum {
  SHADE_DRAFT_MAX_SIDE = 16384,    /* ends, picks */
  SHADE_DRAFT_MAX_CELLS = 1 << 24, /* ends times picks */
  SHADE_PATTERN_MAX = 4096,        /* n_w + n_p of a pattern */
  SHADE_WEFT_ONLY = 0x7fffffff     /* n_w: an endless weft float */
};

/*
 * A draft of the given size, all weft, white, thickness and spacing not stated. NULL when a
 * side is not 1 to SHADE_DRAFT_MAX_SIDE, above SHADE_DRAFT_MAX_CELLS, or out of memory.
 */
SHADE_API shade_draft *shade_draft_create(int ends, int picks);
SHADE_API void shade_draft_free(shade_draft *draft); /* NULL is fine */

/* The same with over and under copied from a matrix of that size, pick by pick: not 0 is up. NULL
 * without a matrix, too. */
SHADE_API shade_draft *shade_draft_from_matrix(int ends, int picks, const unsigned char *warp_up);

/*
 * The weave (n_w, n_p, n_s): in each pick n_w ends under the weft, then n_p over it; each
 * next pick shifted by n_s. Weft is on top iff ((end + n_s pick) mod (n_w + n_p)) < n_w, mod
 * being Euclidean. n_w >= 1, n_p >= 0, n_w + n_p <= SHADE_PATTERN_MAX, any n_s;
 * n_w = SHADE_WEFT_ONLY is all weft. NULL for other numbers or out of memory.
 */
SHADE_API shade_draft *shade_draft_from_pattern(int n_w, int n_p, int n_s);

/*
 * Weaves by name (read with - and _ alike and without regard to case): plain, twill_2_1, …
 * Twills are named as weavers do, ends over / ends under: twill_3_1 shows the warp; their
 * diagonal rises to the right (Z). A satin shows the warp, a sateen the weft. NULL for a name that
 * is not in the list, or out of memory. shade_weave_row steps through the list as shade_list_row
 * does; 0 past the end.
 */
SHADE_API shade_draft *shade_draft_named(const char *word);
SHADE_API int shade_weave_row(int row, const char **word, const char **label, const char **help);

/* 1 if size, over and under, colours, thickness and spacing are all the same. */
SHADE_API int shade_draft_equal(const shade_draft *a, const shade_draft *b);

/*
 * Weaving Information Files, version 1.1 [Wif1997], the exchange format of weaving programs.
 *
 * Read: threading; tie-up and treadling, or the liftplan where one of these is missing; rising
 * or sinking shed; colours, thickness and spacing. What a file leaves out has WIF's defaults
 * (colour, thickness and spacing of [WARP] and [WEFT]; an end without a shaft stays down), and
 * a rising shed. Sections and lines may come in any order, names in capitals or not, lines end
 * in LF, CRLF or CR, numbers may be followed by a comment, text may be UTF-16. Of lines given
 * twice the last holds. Lengths without units count as cm.
 *
 * Mended, with a warning: what numbers from 0 instead of 1; rows beyond the ends and picks that
 * the file announces (left out), shafts and treadles beyond it (read as they are); a [CONTENTS]
 * that is not so; a liftplan without a threading (end n is on shaft n); a treadling without a
 * tie-up (treadle n lifts shaft n); a liftplan that contradicts the tie-up (left out, unless
 * [CONTENTS] denies the tie-up); colours as CMYK or beyond their Range, without a Range, or not in
 * the table; and the like. Not accepted: numbers that are none, no threading or plan at all,
 * sizes beyond a shade_draft's.
 *
 * shade_wif_parse takes `length` bytes and a name for messages. On success both write to
 * message[message_size] one line, "NAME: mended: line N: what; line M: what (and 3 more)", the
 * first of each kind in the order of lines, or an empty text when nothing was mended. On failure
 * they return NULL and write "NAME, line N: what is wrong; what was expected". A longer message
 * is cut. Free the draft with shade_draft_free.
 */
SHADE_API shade_draft *shade_wif_parse(const char *text, size_t length, const char *name,
                                       char *message, size_t message_size);
SHADE_API shade_draft *shade_wif_read(const char *path, char *message, size_t message_size);

/*
 * A draft as the text of a WIF, to be freed with free(); NULL when out of memory. Shafts and
 * treadles are as few as the weave needs; above 64 treadles it is a liftplan. Reading it gives
 * an equal draft, but for colours that are not a whole number of 1/N, N <= 65535: those are
 * rounded to 1/16777215.
 */
SHADE_API char *shade_wif_text(const shade_draft *draft);

/* What a look-up finds on top. */
typedef enum shade_top { SHADE_TOP_WEFT, SHADE_TOP_WARP, SHADE_TOP_GAP } shade_top;

/* How a yarn is darkened by its neighbours and by itself. */
#define SHADE_OCCLUSION_ROW_(NAME, word, value, label, help)                                       \
  SHADE_ENUM_ROW_(SHADE_OCCLUSION_, NAME, value)
typedef enum shade_occlusion {
  SHADE_TABLE_OCCLUSION(SHADE_OCCLUSION_ROW_) SHADE_OCCLUSION_COUNT
} shade_occlusion;

/*
 * The shape of the yarns of one direction. Lengths are in any unit, the same for warp and
 * weft; a crossing is width + gap, and is 1 in u or v. Where the draft states thickness or
 * spacing, a yarn's share of its crossing, width / (width + gap), is multiplied by its
 * thickness and divided by its spacing, each relative to its mean, and is at most 1.
 *
 * With s the distance along the yarn in crossings, sigma in [-1, 1] that across it, and
 * r, r(s) noise in [-1, 1] per yarn and along it, the tilt is
 *   along:  ridge (2 fract(segments (fract(s) - slant sigma)) - 1) + crimp(s) + noise
 *   across: curve sigma + noise
 * and its length is clamped to .98. The ridges stand at the angle theta to the line straight
 * across the yarn: tan theta = 2 slant l_w / width, l_w being the crossing along the yarn.
 *
 * Crimp: a yarn dives where it passes under another. With d+ and d- the distances to the end
 * of the float before and behind, w(d) = (1 - t)^2 (1 + 2t), t = min(d / length, 1), length
 * the smaller of crimp_length and the whole float:
 *   crimp(s) = +-crimp (w(d+) - w(d-)), + above, - below the other yarns:
 * the slope is steepest where the yarn changes sides, continuous there, and flat in the
 * middle of long floats.
 * [KangFabric, corrected: its modulus, slant and twist term; crimp: in place of the arcs and
 * straight lines of Peirce1937 a smooth profile]
 */
typedef struct shade_yarn_params {
  double width, gap; /* (0, 1e6], [0, 1e6] */
  double curve;      /* c_y: tilt across at the yarn's edge, [0, .98] */
  double ridge;      /* c_f: tilt along, of the twisted strands, [0, .98] */
  double slant;      /* s_f, [-100, 100] */
  double segments;   /* N_s, strands per crossing, [0, 1000]; 0: no ridges */
  double fibre;      /* fibres to the yarn's axis, radians, anticlockwise (S) > 0, [-pi/2, pi/2] */
  double crimp;      /* tilt along where the yarn dives, [0, .98] */
  double crimp_length;                 /* crossings until it lies flat, [.01, 16] */
  double vary_brightness, vary_tilt;   /* per yarn: amplitudes, [0, 1] */
  double along_brightness, along_tilt; /* along the yarn: amplitudes, [0, 1] */
  double slub;                         /* along the yarn: relative variation of width, [0, 1] */
  double along_length;                 /* crossings between knots of that noise, [.01, 1e6] */
  double fuzz; /* share of the gap beside it that loose fibres fill, [0, 1] */
} shade_yarn_params;

typedef struct shade_weave_params {
  size_t size; /* sizeof(shade_weave_params), set by shade_weave_params_init */
  shade_yarn_params warp, weft;
  shade_occlusion occlusion;
  uint32_t seed; /* of all noise */
} shade_weave_params;

/* Set every member to the table's default (table.h): width 1, no gap, crimp or noise. */
SHADE_API void shade_weave_params_init(shade_weave_params *p);

/*
 * Width and gap of warp and weft in cm from the draft's thickness and spacing, where it states
 * both for one of the two directions at least (the other direction takes the same numbers):
 * their means, a yarn thicker than its spacing filling it. Returns 1, or 0 and changes nothing.
 */
SHADE_API int shade_weave_params_from_draft(shade_weave_params *p, const shade_draft *draft);

/* One number of shade_yarn_params: components is 1; returns 0 past the end. */
SHADE_API int shade_yarn_param_row(int row, shade_param_info *info);
/* Where that number is kept in *yarn; NULL for a name that is not in the table. */
SHADE_API double *shade_yarn_param(shade_yarn_params *yarn, const char *word);
SHADE_API int shade_occlusion_row(int row, int *value, const char **word, const char **label,
                                  const char **help);

/*
 * Set slant, segments and fibre of the warp or the weft from the twist.
 * hand: 'S', 'Z', or 0 for none (segments = fibre = 0). angle: of the strands to the yarn's
 * axis, radians, [.01, pi/2], so that tan(theta) = 1 / tan(angle); strands: how many pass
 * along one crossing (turns per crossing times plies; a whole number continues from cell to
 * cell). Plied yarn (plied != 0) has its fibres along the axis, single yarn along its
 * strands. Set the widths first. Returns status bits; SHADE_BAD_INPUT, nothing is set, without
 * p->size.
 */
SHADE_API unsigned shade_weave_params_set_twist(shade_weave_params *p, shade_top yarns, int hand,
                                                double angle, double strands, int plied);

/* A draft and yarns made ready for look-ups. */
typedef struct shade_weave shade_weave;

/*
 * A weave with its own copy of the draft. Numbers out of range are clamped
 * (SHADE_CLAMPED_PARAMETER; NaN becomes the default), an unknown occlusion is the first
 * (SHADE_BAD_CHOICE); the bits are or-ed into *status unless it is NULL. `p` may be NULL: the
 * defaults. Returns NULL if the draft is NULL or out of memory.
 */
SHADE_API shade_weave *shade_weave_create(const shade_draft *draft, const shade_weave_params *p,
                                          unsigned *status);
SHADE_API void shade_weave_free(shade_weave *weave); /* NULL is fine; fabrics of it go on */
SHADE_API const shade_draft *shade_weave_draft(const shade_weave *weave);
SHADE_API const shade_weave_params *shade_weave_get_params(const shade_weave *weave);

/*
 * One point. Frame: x along u, y along v, z out of the cloth.
 * For a gap, where the backing shows: yarn and sigma are those of the yarn that the draft has
 * on top, the tilt is 0, the tangent that yarn's axis, the colour black, brightness 1.
 */
typedef struct shade_crossing {
  shade_top top;     /* what is seen */
  int swap;          /* 1: the yarn runs along v, so exponents swap (warp); a gap: as the draft */
  int below;         /* 1: seen beside a narrower yarn that the draft has on top; a gap: 1 */
  int yarn;          /* index of the end or pick in the draft, from 0 */
  double sigma;      /* position across it: -1 to 1, towards +u (warp) or +v (weft) */
  double along;      /* position along it within its crossing, 0 to 1 */
  double dx, dy;     /* tilt: the yarn's normal is (dx, dy, sqrt(1 - dx^2 - dy^2)); |.| <= .98 */
  double tx, ty;     /* direction of its fibres, unit */
  double occlusion;  /* factor, [0, 1] */
  double brightness; /* factor of the noise, >= 0, mean 1 */
  double fuzz;       /* in a gap: share filled by loose fibres; on a yarn 0 */
  double color[3];   /* the draft's, linear RGB */
} shade_crossing;
typedef struct shade_crossingf {
  shade_top top;
  int swap, below, yarn;
  float sigma, along, dx, dy, tx, ty, occlusion, brightness, fuzz, color[3];
} shade_crossingf;

/*
 * What is at (u, v). u or v that is not finite counts as 0 (SHADE_BAD_INPUT). Returns status
 * bits. Near whole numbers float rounds sooner: above |u| = 1e5 use double.
 */
SHADE_API unsigned shade_weave_lookup(const shade_weave *weave, double u, double v,
                                      shade_crossing *out);
SHADE_API unsigned shade_weave_lookupf(const shade_weave *weave, float u, float v,
                                       shade_crossingf *out);

/*
 * Outputs of a batch: one array per member, `count` long; any may be NULL. Set size to sizeof the
 * structure; members beyond it count as NULL. The arrays must not overlap each other or u and v.
 * A batch gives the same bits as one call for each; a size below sizeof(size_t) gives
 * SHADE_BAD_INPUT and writes nothing.
 */
typedef struct shade_crossings {
  size_t size;
  int *top, *swap, *below, *yarn;
  double *sigma, *along, *dx, *dy, *tx, *ty, *occlusion, *brightness, *fuzz, *r, *g, *b;
} shade_crossings;
typedef struct shade_crossingsf {
  size_t size;
  int *top, *swap, *below, *yarn;
  float *sigma, *along, *dx, *dy, *tx, *ty, *occlusion, *brightness, *fuzz, *r, *g, *b;
} shade_crossingsf;
SHADE_API unsigned shade_weave_lookup_batch(const shade_weave *weave, size_t count, const double *u,
                                            const double *v, const shade_crossings *out);
SHADE_API unsigned shade_weave_lookup_batchf(const shade_weave *weave, size_t count, const float *u,
                                             const float *v, const shade_crossingsf *out);

/*
 * Where the point (x, y) of the cloth, in cm from the first end's and pick's outer edges, is
 * in crossings. Spacing that no yarn states counts as `spacing` cm (> 0, else 0.1).
 */
SHADE_API void shade_draft_cells(const shade_draft *draft, double spacing, double x, double y,
                                 double *u, double *v);

#ifdef __cplusplus
}
#endif
#endif
