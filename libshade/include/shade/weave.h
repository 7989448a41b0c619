/* SPDX-License-Identifier: Apache-2.0 */
/**
 * Woven cloth: which yarn is on top at a point, and how its surface is tilted there.
 *
 * Coordinates. u counts warp ends and v weft picks, one unit a crossing, repeating with the draft
 * in both directions. Warp yarns (ends) run along v, side by side in u. Weft yarns (picks) run
 * along u. In the surface frame x points along u and y along v.
 *
 * A shade_draft says what lies over what, and the colour, thickness and spacing of each yarn. A
 * shade_weave joins a draft and the shape of the yarns, ready for look-ups.
 *
 * Threads. All functions are reentrant. Any number of threads may read a draft or weave. Only
 * functions that return a draft, a weave or a text allocate. Look-ups do not.
 */
#ifndef SHADE_WEAVE_H /* read once */
#define SHADE_WEAVE_H

#include <stddef.h>
#include <stdint.h>

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/** One yarn of a draft. */
typedef struct shade_thread {
  double color[3];  /* as a display shows it (sRGB, encoded), [0, 1]; 1 by default */
  double thickness; /* cm, > 0; 0: not stated */
  double spacing;   /* centre to centre, cm, > 0; 0: not stated */
} shade_thread;

/**
 * One repeat of a weave.
 *
 * warp_up[pick * ends + end] is 1 where the warp end lies over the weft pick, and 0 where the weft
 * is on top, both counted from 0. The members may be changed until the draft is freed, but not ends
 * and picks.
 */
typedef struct shade_draft {
  int ends, picks;
  unsigned char *warp_up;
  shade_thread *warp; /* one per end */
  shade_thread *weft; /* one per pick */
} shade_draft;

/** Limits of a draft, and the pattern that is all weft. */
enum {
  SHADE_DRAFT_MAX_SIDE = 16384,    /* ends, picks */
  SHADE_DRAFT_MAX_CELLS = 1 << 24, /* ends times picks */
  SHADE_PATTERN_MAX = 4096,        /* n_w + n_p of a pattern */
  SHADE_WEFT_ONLY = 0x7fffffff     /* n_w: an endless weft float */
};

/**
 * A draft of the given size: all weft, white, thickness and spacing not stated.
 *
 * Threads: the call allocates.
 *
 * @param ends, picks  its sides, 1 to SHADE_DRAFT_MAX_SIDE, SHADE_DRAFT_MAX_CELLS in all
 * @return the draft, to be freed with shade_draft_free; NULL for another size or out of memory
 */
SHADE_API shade_draft *shade_draft_create(int ends, int picks);

/**
 * Free a draft.
 *
 * Threads: no thread may use the draft any more.
 *
 * @param draft  the draft, or NULL
 */
SHADE_API void shade_draft_free(shade_draft *draft);

/**
 * shade_draft_create with over and under copied from a matrix.
 *
 * Threads: the call allocates.
 *
 * @param ends, picks  its sides, as for shade_draft_create
 * @param warp_up      ends * picks bytes, pick by pick; not 0 where the warp is up
 * @return the draft; NULL as from shade_draft_create, and without a matrix
 */
SHADE_API shade_draft *shade_draft_from_matrix(int ends, int picks, const unsigned char *warp_up);

/**
 * The weave (n_w, n_p, n_s).
 *
 * In each pick n_w ends lie under the weft, then n_p over it. Each next pick is shifted by n_s.
 * Weft is on top iff ((end + n_s pick) mod (n_w + n_p)) < n_w, mod being Euclidean.
 *
 * Threads: the call allocates.
 *
 * @param n_w  >= 1; SHADE_WEFT_ONLY is all weft
 * @param n_p  >= 0, with n_w + n_p <= SHADE_PATTERN_MAX
 * @param n_s  any number
 * @return the draft, to be freed with shade_draft_free; NULL for other numbers or out of memory
 */
SHADE_API shade_draft *shade_draft_from_pattern(int n_w, int n_p, int n_s);

/**
 * A weave by its name: plain, twill_2_1, ...
 *
 * Twills are named as weavers do, ends over / ends under. twill_3_1 shows the warp. Their diagonal
 * rises to the right (Z). A satin shows the warp, a sateen the weft.
 *
 * Threads: the call allocates.
 *
 * @param word  the name, read with - and _ alike and without regard to case
 * @return the draft, to be freed with shade_draft_free; NULL for a name that is not in the list, or
 *         out of memory
 */
SHADE_API shade_draft *shade_draft_named(const char *word);

/**
 * A row of the list of weaves.
 *
 * @param row    0, 1, ...
 * @param word   out, or NULL: its name
 * @param label  out, or NULL: its name for people
 * @param help   out, or NULL: a sentence about it
 * @return 1, or 0 past the end
 */
SHADE_API int shade_weave_row(int row, const char **word, const char **label, const char **help);

/**
 * Whether two drafts are the same.
 *
 * @param a, b  drafts
 * @return 1 if size, over and under, colours, thickness and spacing are all the same, else 0
 */
SHADE_API int shade_draft_equal(const shade_draft *a, const shade_draft *b);

/**
 * Read a draft from the text of a Weaving Information File, version 1.1. [Wif1997]
 *
 * It is the exchange format of weaving programs. These are read: threading; tie-up and treadling,
 * or the liftplan where one of these is missing; rising or sinking shed; colours, thickness and
 * spacing. What a file leaves out has the defaults of WIF: colour, thickness and spacing of [WARP]
 * and [WEFT], and a rising shed. An end without a shaft stays down. Sections and lines may come in
 * any order. Names may be in capitals. Lines end in LF, CRLF or CR. Numbers may be followed by a
 * comment. Text may be UTF-16. Of lines given twice the last holds. Lengths without units count as
 * cm.
 *
 * These are mended, with a warning:
 *
 * - what numbers from 0 instead of 1;
 * - rows beyond the ends and picks that the file announces, which are left out, and shafts and
 *   treadles beyond it, which are read as they are;
 * - a [CONTENTS] that is not so;
 * - a liftplan without a threading, where end n is on shaft n, and a treadling without a tie-up,
 *   where treadle n lifts shaft n;
 * - a liftplan that contradicts the tie-up, which is left out, unless [CONTENTS] denies the tie-up;
 * - colours as CMYK or beyond their Range, without a Range, not in the table, or as #rrggbb; those
 *   that are no colours are left out; and the like.
 *
 * Not accepted are other numbers that are none, no threading or plan at all, and sizes beyond those
 * of a shade_draft.
 *
 * Threads: the call allocates.
 *
 * @param text          the file's bytes
 * @param length        how many
 * @param name          what messages call the file
 * @param message       out: empty where nothing was mended; "NAME: mended: line N: what; line M:
 *                      what (and 3 more)", the first of each kind in the order of lines; or on
 *                      failure "NAME, line N: what is wrong; what was expected"
 * @param message_size  bytes there; a longer message is cut
 * @return the draft, to be freed with shade_draft_free; NULL on failure
 */
SHADE_API shade_draft *shade_wif_parse(const char *text, size_t length, const char *name,
                                       char *message, size_t message_size);

/**
 * shade_wif_parse of a file.
 *
 * Threads: the call allocates, and reads the file.
 *
 * @param path          the file
 * @param message       out: as shade_wif_parse has it
 * @param message_size  bytes there
 * @return the draft, to be freed with shade_draft_free; NULL on failure
 */
SHADE_API shade_draft *shade_wif_read(const char *path, char *message, size_t message_size);

/**
 * A draft as the text of a WIF.
 *
 * Shafts and treadles are as few as the weave needs. Above 64 treadles it is a liftplan. Reading it
 * gives an equal draft, but for colours that are not a whole number of 1/N, N <= 65535. Those are
 * rounded to 1/16777215.
 *
 * Threads: the call allocates.
 *
 * @param draft  the draft
 * @return the text, to be freed with free(); NULL when out of memory
 */
SHADE_API char *shade_wif_text(const shade_draft *draft);

/** What a look-up finds on top. */
typedef enum shade_top { SHADE_TOP_WEFT, SHADE_TOP_WARP, SHADE_TOP_GAP } shade_top;

#define SHADE_OCCLUSION_ROW_(NAME, word, value, label, help)                                       \
  SHADE_ENUM_ROW_(SHADE_OCCLUSION_, NAME, value)
/** How a yarn is darkened by its neighbours and by itself. */
typedef enum shade_occlusion {
  SHADE_TABLE_OCCLUSION(SHADE_OCCLUSION_ROW_) SHADE_OCCLUSION_COUNT
} shade_occlusion;

/**
 * The shape of the yarns of one direction.
 *
 * Lengths are in any unit, the same for warp and weft. A crossing is width + gap, and is 1 in u or
 * v. Where the draft states thickness or spacing, a yarn's share of its crossing, width / (width +
 * gap), is multiplied by its thickness and divided by its spacing, each relative to its mean, and
 * is at most 1.
 *
 * Let s be the distance along the yarn in crossings, and sigma in [-1, 1] that across it. r and
 * r(s) are noise in [-1, 1], per yarn and along it. The tilt along the yarn is
 * ridge (2 fract(segments (fract(s) - slant sigma)) - 1) + crimp(s) + noise. Across it is
 * curve sigma + noise. Its length is clamped to .98. The ridges stand at the angle theta to the
 * line straight across the yarn: tan theta = 2 slant l_w / width, where l_w is the crossing along
 * the yarn.
 *
 * Crimp. A yarn dives where it passes under another. Let d+ and d- be the distances to the end of
 * the float before and behind, and w(d) = (1 - t)^2 (1 + 2t) with t = min(d / length, 1), length
 * being the smaller of crimp_length and the whole float. Then crimp(s) = +-crimp (w(d+) - w(d-)),
 * + above and - below the other yarns. So the slope is steepest where the yarn changes sides,
 * continuous there, and flat in the middle of long floats.
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

/** The shape of all yarns. */
typedef struct shade_weave_params {
  size_t size; /* sizeof(shade_weave_params), set by shade_weave_params_init */
  shade_yarn_params warp, weft;
  shade_occlusion occlusion;
  uint32_t seed; /* of all noise */
} shade_weave_params;

/**
 * Set every member to its default in the table (table.h): width 1, no gap, crimp or noise.
 *
 * @param p  the numbers to fill
 */
SHADE_API void shade_weave_params_init(shade_weave_params *p);

/**
 * Take width and gap of warp and weft, in cm, from the thickness and spacing of a draft.
 *
 * They are the means. A yarn thicker than its spacing fills it. Where the draft states both for one
 * of the two directions only, the other direction takes the same numbers. Without any spacing
 * crossings are square, as wide as the thicker yarns.
 *
 * @param p      the numbers to change
 * @param draft  the draft
 * @return 1; or 0, and nothing changes, where that leaves neither direction with both
 */
SHADE_API int shade_weave_params_from_draft(shade_weave_params *p, const shade_draft *draft);

/** What tells how dense a cloth of a draft is. */
typedef enum shade_sett { SHADE_SETT_SPACING, SHADE_SETT_THICKNESS, SHADE_SETT_EVEN } shade_sett;

/**
 * Ends and picks per cm of a draft.
 *
 * They go by its spacing, where it states that of one of the two directions at least; the other
 * takes the same. Else crossings are square, as wide as the thicker yarns. Where it states no
 * thickness either, there are as many as before, sqrt(ends x picks) both ways.
 *
 * @param draft   the draft
 * @param per_cm  in: ends and picks per cm of the cloth that it is made into, above 0, else counted
 *                as 1; out: its own, above 0
 * @return by what
 */
SHADE_API shade_sett shade_draft_sett(const shade_draft *draft, double per_cm[2]);

/**
 * A row of the table of a yarn's numbers.
 *
 * @param row   0, 1, ...
 * @param info  out, or NULL: about it; `components` is 1
 * @return 1, or 0 past the end
 */
SHADE_API int shade_yarn_param_row(int row, shade_param_info *info);

/**
 * Where a number of a yarn is kept.
 *
 * @param yarn  the yarn
 * @param word  the name of the number
 * @return its place in *yarn; NULL for a name that is not in the table
 */
SHADE_API double *shade_yarn_param(shade_yarn_params *yarn, const char *word);

/**
 * A row of the list of occlusions, as shade_list_row has it for the lists of a material.
 *
 * @param row    0, 1, ...
 * @param value  out, or NULL: a shade_occlusion
 * @param word   out, or NULL: its name
 * @param label  out, or NULL: its name for people
 * @param help   out, or NULL: a sentence about it
 * @return 1, or 0 past the end
 */
SHADE_API int shade_occlusion_row(int row, int *value, const char **word, const char **label,
                                  const char **help);

/**
 * Set slant, segments and fibre of the warp or the weft from the twist. Set the widths first.
 *
 * @param p        the numbers to change
 * @param yarns    SHADE_TOP_WARP or SHADE_TOP_WEFT
 * @param hand     'S', 'Z', or 0 for none (segments = fibre = 0)
 * @param angle    of the strands to the yarn's axis, radians, [.01, pi/2]; tan(theta) is
 *                 1 / tan(angle)
 * @param strands  how many pass along one crossing: turns per crossing times plies; a whole number
 *                 continues from cell to cell
 * @param plied    not 0: the fibres run along the axis, as in plied yarn; 0: along the strands
 * @return status bits; SHADE_BAD_INPUT, and nothing is set, without p->size
 */
SHADE_API unsigned shade_weave_params_set_twist(shade_weave_params *p, shade_top yarns, int hand,
                                                double angle, double strands, int plied);

/** A draft and yarns made ready for look-ups. */
typedef struct shade_weave shade_weave;

/**
 * A weave with its own copy of the draft.
 *
 * Threads: the call allocates, and reads the environment as shade_bsdf_setup does.
 *
 * @param draft   what lies over what
 * @param p       the shape of the yarns; NULL: the defaults
 * @param status  NULL, or where status bits are or-ed into: SHADE_CLAMPED_PARAMETER for numbers out
 *                of range, where NaN becomes the default, SHADE_BAD_CHOICE for an unknown
 *                occlusion, which is taken as the first
 * @return the weave, to be freed with shade_weave_free; NULL without a draft or out of memory
 */
SHADE_API shade_weave *shade_weave_create(const shade_draft *draft, const shade_weave_params *p,
                                          unsigned *status);

/**
 * Free a weave. Fabrics made of it go on.
 *
 * Threads: no thread may use the weave itself any more.
 *
 * @param weave  the weave, or NULL
 */
SHADE_API void shade_weave_free(shade_weave *weave);

/**
 * The draft of a weave.
 *
 * @param weave  the weave
 * @return its draft, which lives as long as it
 */
SHADE_API const shade_draft *shade_weave_draft(const shade_weave *weave);

/**
 * The shape of the yarns of a weave, within their ranges.
 *
 * @param weave  the weave
 * @return its numbers, which live as long as it
 */
SHADE_API const shade_weave_params *shade_weave_get_params(const shade_weave *weave);

/**
 * What a look-up finds at one point. Frame: x along u, y along v, z out of the cloth.
 *
 * In a gap the backing shows. yarn and sigma are then those of the yarn that the draft has on top.
 * The tilt is 0, the tangent the axis of that yarn, the colour black, and brightness 1.
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

/** In float: shade_crossing. */
typedef struct shade_crossingf {
  shade_top top;
  int swap, below, yarn;
  float sigma, along, dx, dy, tx, ty, occlusion, brightness, fuzz, color[3];
} shade_crossingf;

/**
 * What is at a point of the cloth.
 *
 * Near whole numbers float rounds sooner. Above |u| = 1e5 use double.
 *
 * @param weave  the weave
 * @param u, v   where, in crossings; what is not finite counts as 0 (SHADE_BAD_INPUT)
 * @param out    out: what is there
 * @return status bits
 */
SHADE_API unsigned shade_weave_lookup(const shade_weave *weave, double u, double v,
                                      shade_crossing *out);

/** In float: shade_weave_lookup. */
SHADE_API unsigned shade_weave_lookupf(const shade_weave *weave, float u, float v,
                                       shade_crossingf *out);

/**
 * Outputs of a batch: one array per member, `count` long. Any may be NULL.
 *
 * Set size to sizeof of the structure. Members beyond it count as NULL. The arrays must not overlap
 * each other or u and v.
 */
typedef struct shade_crossings {
  size_t size;
  int *top, *swap, *below, *yarn;
  double *sigma, *along, *dx, *dy, *tx, *ty, *occlusion, *brightness, *fuzz, *r, *g, *b;
} shade_crossings;

/** In float: shade_crossings. */
typedef struct shade_crossingsf {
  size_t size;
  int *top, *swap, *below, *yarn;
  float *sigma, *along, *dx, *dy, *tx, *ty, *occlusion, *brightness, *fuzz, *r, *g, *b;
} shade_crossingsf;

/**
 * shade_weave_lookup over arrays. It gives the same bits as one call for each.
 *
 * Threads: any number at once, as long as their outputs lie apart.
 *
 * @param weave  the weave
 * @param count  number of points
 * @param u, v   where, in crossings
 * @param out    outputs
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, where out->size is below
 *         sizeof(size_t)
 */
SHADE_API unsigned shade_weave_lookup_batch(const shade_weave *weave, size_t count, const double *u,
                                            const double *v, const shade_crossings *out);

/** In float: shade_weave_lookup_batch. */
SHADE_API unsigned shade_weave_lookup_batchf(const shade_weave *weave, size_t count, const float *u,
                                             const float *v, const shade_crossingsf *out);

/**
 * Where a point of the cloth is, in crossings.
 *
 * @param draft    the draft
 * @param spacing  cm, > 0, else 0.1: what spacing that no yarn states counts as
 * @param x, y     cm from the outer edges of the first end and pick
 * @param u, v     out: crossings
 */
SHADE_API void shade_draft_cells(const shade_draft *draft, double spacing, double x, double y,
                                 double *u, double *v);

#ifdef __cplusplus
}
#endif
#endif
