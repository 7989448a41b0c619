/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The one table of presets. Words are what scenes hold: they are never changed.
 *
 * Exponents along the fibres are 1/gamma^2 of the Gaussian widths gamma that
 * [SadeghiJensen2013 Table II] fitted to gonioreflectometer measurements of threads: 12 degrees
 * (linen) is 23, 5 degrees (silk crepe) 131, 4 degrees (shot silk) 205, 2.5 degrees (polyester
 * satin) 525, 18 degrees (twisted silk) 10. Their tangent offsets, up to 25 degrees for linen, 35
 * for silk and 32 for satin, are the crimp: its sine. Reflectances at normal incidence begin with
 * ((n-1)/(n+1))^2 from the mean refractive index of the fibre [MortonHearle2008 Table 24.1]: cotton
 * and wool .046, flax .048, silk .047, polyester .053; lustrous yarns have more, for the light that
 * fibres scatter forwards and back within, tinted by the dye. Across a yarn of many round fibres
 * the lobe is broad. Dyes, and the variation from yarn to yarn, are by eye.
 */
#include <string.h>

#include "names.h"
#include "shade/presets.h"

/* Numbers of one direction; what is left out is 0. */
typedef struct yarn_row {
  shade_yarn_params shape;
  double along, across, f0[3], kd[3];
} yarn_row;

typedef struct fabric_row {
  const char *word, *label, *help, *source, *weave;
  double ends, picks; /* per cm */
  yarn_row warp, weft;
  double backing[3], nap, nap_color[3];
} fabric_row;

static const fabric_row fabrics[] = {
    {
        .word = "silk_charmeuse",
        .label = "Silk charmeuse",
        .help = "Satin of silk: long warp floats, a streaked highlight across them",
        .source = "[SadeghiJensen2013] silk crepe de chine: exponents, crimp; [MortonHearle2008]",
        .weave = "satin_8",
        .ends = 120,
        .picks = 45,
        .warp = {.shape = {.width = 0.97,
                           .gap = 0.03,
                           .curve = 0.3,
                           .crimp = 0.53,
                           .crimp_length = 0.9,
                           .vary_brightness = 0.05,
                           .vary_tilt = 0.04,
                           .along_tilt = 0.02,
                           .along_length = 12},
                 .along = 131,
                 .across = 6,
                 .f0 = {0.15, 0.11, 0.075},
                 .kd = {0.42, 0.27, 0.15}},
        .weft = {.shape = {.width = 0.9,
                           .gap = 0.1,
                           .curve = 0.6,
                           .ridge = 0.15,
                           .slant = 0.3,
                           .segments = 1,
                           .crimp = 0.3,
                           .crimp_length = 0.5,
                           .along_length = 4},
                 .along = 10,
                 .across = 6,
                 .f0 = {0.1, 0.075, 0.055},
                 .kd = {0.40, 0.25, 0.14}},
        .backing = {0.08, 0.05, 0.03},
    },
    {
        .word = "silk_shantung",
        .label = "Silk shantung",
        .help = "Plain weave of fine warp and thick, uneven weft: slubs run across the cloth",
        .source = "[SadeghiJensen2013] silk: exponents, crimp; [MortonHearle2008]",
        .weave = "plain",
        .ends = 50,
        .picks = 24,
        .warp = {.shape = {.width = 0.8,
                           .gap = 0.2,
                           .curve = 0.45,
                           .crimp = 0.5,
                           .crimp_length = 0.6,
                           .vary_brightness = 0.06,
                           .along_length = 6},
                 .along = 131,
                 .across = 5,
                 .f0 = {0.06, 0.10, 0.10},
                 .kd = {0.05, 0.22, 0.24}},
        .weft = {.shape = {.width = 0.9,
                           .gap = 0.1,
                           .curve = 0.6,
                           .crimp = 0.25,
                           .crimp_length = 0.6,
                           .vary_brightness = 0.15,
                           .vary_tilt = 0.08,
                           .along_brightness = 0.1,
                           .along_tilt = 0.1,
                           .slub = 0.5,
                           .along_length = 14},
                 .along = 60,
                 .across = 4,
                 .f0 = {0.06, 0.11, 0.11},
                 .kd = {0.06, 0.27, 0.29}},
        .backing = {0.01, 0.05, 0.05},
    },
    {
        .word = "denim",
        .label = "Cotton denim",
        .help = "Twill 3/1, indigo warp over a white weft: a diagonal with white flecks",
        .source = "[SadeghiJensen2013] linen, the one cellulose there: exponents, crimp; "
                  "[MortonHearle2008]",
        .weave = "twill_3_1",
        .ends = 26,
        .picks = 17,
        .warp = {.shape = {.width = 0.94,
                           .gap = 0.06,
                           .curve = 0.6,
                           .ridge = 0.2,
                           .slant = 0.35,
                           .segments = 3,
                           .crimp = 0.42,
                           .crimp_length = 0.7,
                           .vary_brightness = 0.22,
                           .vary_tilt = 0.04,
                           .along_brightness = 0.2,
                           .along_tilt = 0.04,
                           .slub = 0.12,
                           .along_length = 9,
                           .fuzz = 0.3},
                 .along = 23,
                 .across = 4,
                 .f0 = {0.046, 0.046, 0.046},
                 .kd = {0.012, 0.032, 0.11}},
        .weft = {.shape = {.width = 0.54,
                           .gap = 0.46,
                           .curve = 0.6,
                           .ridge = 0.2,
                           .slant = 0.35,
                           .segments = 3,
                           .crimp = 0.42,
                           .crimp_length = 0.7,
                           .vary_brightness = 0.06,
                           .along_brightness = 0.05,
                           .slub = 0.15,
                           .along_length = 9,
                           .fuzz = 0.3},
                 .along = 23,
                 .across = 4,
                 .f0 = {0.046, 0.046, 0.046},
                 .kd = {0.58, 0.55, 0.48}},
        .backing = {0.02, 0.03, 0.06},
        .nap = 0.03,
        .nap_color = {0.22, 0.27, 0.4},
    },
    {
        .word = "gabardine",
        .label = "Gabardine",
        .help = "Dense worsted twill with a steep, fine diagonal",
        .source = "[MortonHearle2008] wool; exponents between linen and silk by eye",
        .weave = "twill_3_1",
        .ends = 44,
        .picks = 22,
        .warp = {.shape = {.width = 0.97,
                           .gap = 0.03,
                           .curve = 0.55,
                           .ridge = 0.15,
                           .slant = 0.3,
                           .segments = 2,
                           .crimp = 0.4,
                           .crimp_length = 0.7,
                           .vary_brightness = 0.06,
                           .along_brightness = 0.04,
                           .along_length = 10},
                 .along = 40,
                 .across = 5,
                 .f0 = {0.05, 0.048, 0.045},
                 .kd = {0.34, 0.24, 0.13}},
        .weft = {.shape = {.width = 0.95,
                           .gap = 0.05,
                           .curve = 0.55,
                           .ridge = 0.15,
                           .slant = 0.3,
                           .segments = 2,
                           .crimp = 0.3,
                           .crimp_length = 0.7,
                           .vary_brightness = 0.06,
                           .along_brightness = 0.04,
                           .along_length = 10},
                 .along = 40,
                 .across = 5,
                 .f0 = {0.05, 0.048, 0.045},
                 .kd = {0.30, 0.21, 0.115}},
        .backing = {0.06, 0.04, 0.02},
        .nap = 0.02,
        .nap_color = {0.45, 0.38, 0.28},
    },
    {
        .word = "linen",
        .label = "Linen",
        .help = "Open plain weave of flax with slubs in both directions",
        .source = "[SadeghiJensen2013] linen plain: exponents, crimp, the gap; [MortonHearle2008]",
        .weave = "plain",
        .ends = 15,
        .picks = 15,
        .warp = {.shape = {.width = 0.82,
                           .gap = 0.18,
                           .curve = 0.6,
                           .ridge = 0.12,
                           .slant = 0.3,
                           .segments = 2,
                           .crimp = 0.42,
                           .crimp_length = 0.6,
                           .vary_brightness = 0.18,
                           .vary_tilt = 0.04,
                           .along_brightness = 0.2,
                           .along_tilt = 0.05,
                           .slub = 0.5,
                           .along_length = 16,
                           .fuzz = 0.1},
                 .along = 23,
                 .across = 4,
                 .f0 = {0.05, 0.048, 0.045},
                 .kd = {0.60, 0.51, 0.37}},
        .weft = {.shape = {.width = 0.82,
                           .gap = 0.18,
                           .curve = 0.6,
                           .ridge = 0.12,
                           .slant = 0.3,
                           .segments = 2,
                           .crimp = 0.42,
                           .crimp_length = 0.6,
                           .vary_brightness = 0.2,
                           .vary_tilt = 0.04,
                           .along_brightness = 0.2,
                           .along_tilt = 0.05,
                           .slub = 0.55,
                           .along_length = 16,
                           .fuzz = 0.1},
                 .along = 23,
                 .across = 4,
                 .f0 = {0.05, 0.048, 0.045},
                 .kd = {0.62, 0.53, 0.38}},
        .backing = {0.10, 0.08, 0.06},
        .nap = 0.01,
        .nap_color = {0.7, 0.65, 0.55},
    },
    {
        .word = "wool_flannel",
        .label = "Wool flannel",
        .help = "Milled twill 2/2 of mixed grey wool, its weave softened by a nap",
        .source = "[MortonHearle2008] wool; [KoenderinkPont2003] nap; the rest by eye",
        .weave = "twill_2_2",
        .ends = 20,
        .picks = 18,
        .warp = {.shape = {.width = 0.96,
                           .gap = 0.04,
                           .curve = 0.5,
                           .ridge = 0.2,
                           .slant = 0.4,
                           .segments = 2,
                           .crimp = 0.3,
                           .crimp_length = 0.8,
                           .vary_brightness = 0.12,
                           .vary_tilt = 0.08,
                           .along_brightness = 0.3,
                           .along_tilt = 0.12,
                           .slub = 0.2,
                           .along_length = 3,
                           .fuzz = 0.9},
                 .along = 10,
                 .across = 3,
                 .f0 = {0.046, 0.046, 0.046},
                 .kd = {0.14, 0.145, 0.16}},
        .weft = {.shape = {.width = 0.96,
                           .gap = 0.04,
                           .curve = 0.5,
                           .ridge = 0.2,
                           .slant = 0.4,
                           .segments = 2,
                           .crimp = 0.3,
                           .crimp_length = 0.8,
                           .vary_brightness = 0.12,
                           .vary_tilt = 0.08,
                           .along_brightness = 0.3,
                           .along_tilt = 0.12,
                           .slub = 0.2,
                           .along_length = 3,
                           .fuzz = 0.9},
                 .along = 10,
                 .across = 3,
                 .f0 = {0.046, 0.046, 0.046},
                 .kd = {0.15, 0.155, 0.17}},
        .backing = {0.06, 0.06, 0.07},
        .nap = 0.35,
        .nap_color = {0.36, 0.37, 0.40},
    },
    {
        .word = "polyester_lining",
        .label = "Polyester lining",
        .help = "Smooth filaments in a light satin: hard, narrow highlights",
        .source = "[SadeghiJensen2013] polyester satin charmeuse: exponents, crimp; "
                  "[MortonHearle2008]",
        .weave = "satin_5",
        .ends = 60,
        .picks = 34,
        .warp = {.shape = {.width = 0.97,
                           .gap = 0.03,
                           .curve = 0.35,
                           .crimp = 0.5,
                           .crimp_length = 0.6,
                           .vary_brightness = 0.03,
                           .vary_tilt = 0.02,
                           .along_length = 20},
                 .along = 525,
                 .across = 8,
                 .f0 = {0.075, 0.055, 0.06},
                 .kd = {0.09, 0.012, 0.02}},
        .weft = {.shape = {.width = 0.95,
                           .gap = 0.05,
                           .curve = 0.45,
                           .crimp = 0.3,
                           .crimp_length = 0.5,
                           .vary_brightness = 0.03,
                           .along_length = 20},
                 .along = 200,
                 .across = 8,
                 .f0 = {0.075, 0.055, 0.06},
                 .kd = {0.10, 0.014, 0.022}},
        .backing = {0.03, 0.005, 0.008},
    },
    {
        .word = "shot_taffeta",
        .label = "Shot taffeta",
        .help = "Crisp plain weave, green one way and crimson the other: the colour turns with it",
        .source = "[SadeghiJensen2013] silk shot fabric: exponents, crimp, colours; "
                  "[MortonHearle2008]",
        .weave = "plain",
        .ends = 46,
        .picks = 34,
        .warp = {.shape = {.width = 0.95,
                           .gap = 0.05,
                           .curve = 0.35,
                           .crimp = 0.42,
                           .crimp_length = 0.5,
                           .vary_brightness = 0.04,
                           .along_length = 10},
                 .along = 205,
                 .across = 5,
                 .f0 = {0.03, 0.26, 0.11},
                 .kd = {0.008, 0.11, 0.042}},
        .weft = {.shape = {.width = 0.95,
                           .gap = 0.05,
                           .curve = 0.4,
                           .crimp = 0.42,
                           .crimp_length = 0.5,
                           .vary_brightness = 0.05,
                           .slub = 0.1,
                           .along_length = 10},
                 .along = 131,
                 .across = 5,
                 .f0 = {0.32, 0.03, 0.045},
                 .kd = {0.20, 0.005, 0.02}},
        .backing = {0.02, 0.01, 0.01},
    },
    {
        .word = "herringbone_tweed",
        .label = "Herringbone tweed",
        .help = "Twill 2/2 that turns every eight ends, dark warp and oatmeal weft of rough wool",
        .source = "[MortonHearle2008] wool; [KoenderinkPont2003] nap; the rest by eye",
        .weave = "herringbone",
        .ends = 9,
        .picks = 8.5,
        .warp = {.shape = {.width = 0.95,
                           .gap = 0.05,
                           .curve = 0.62,
                           .ridge = 0.25,
                           .slant = 0.45,
                           .segments = 2,
                           .crimp = 0.4,
                           .crimp_length = 0.7,
                           .vary_brightness = 0.15,
                           .vary_tilt = 0.06,
                           .along_brightness = 0.35,
                           .along_tilt = 0.1,
                           .slub = 0.25,
                           .along_length = 2.5,
                           .fuzz = 0.6},
                 .along = 10,
                 .across = 3,
                 .f0 = {0.046, 0.046, 0.046},
                 .kd = {0.075, 0.05, 0.033}},
        .weft = {.shape = {.width = 0.95,
                           .gap = 0.05,
                           .curve = 0.62,
                           .ridge = 0.25,
                           .slant = 0.45,
                           .segments = 2,
                           .crimp = 0.4,
                           .crimp_length = 0.7,
                           .vary_brightness = 0.1,
                           .vary_tilt = 0.06,
                           .along_brightness = 0.2,
                           .along_tilt = 0.1,
                           .slub = 0.25,
                           .along_length = 2.5,
                           .fuzz = 0.6},
                 .along = 10,
                 .across = 3,
                 .f0 = {0.046, 0.046, 0.046},
                 .kd = {0.48, 0.40, 0.29}},
        .backing = {0.05, 0.04, 0.03},
        .nap = 0.08,
        .nap_color = {0.5, 0.42, 0.33},
    },
};
enum { FABRICS = sizeof fabrics / sizeof fabrics[0] };

static void take_yarn(const yarn_row *row, shade_yarn *yarn) {
  yarn->along = row->along;
  yarn->across = row->across;
  memcpy(yarn->f0, row->f0, sizeof row->f0);
  memcpy(yarn->kd, row->kd, sizeof row->kd);
}

static void take_fabric(const fabric_row *row, shade_preset *p) {
  p->kind = SHADE_PRESET_FABRIC;
  p->word = row->word;
  p->label = row->label;
  p->help = row->help;
  p->source = row->source;
  p->color_source = "dye by eye";
  p->weave = row->weave;
  p->ends_per_cm = row->ends;
  p->picks_per_cm = row->picks;
  p->yarns.warp = row->warp.shape;
  p->yarns.weft = row->weft.shape;
  take_yarn(&row->warp, &p->fabric.warp);
  take_yarn(&row->weft, &p->fabric.weft);
  memcpy(p->fabric.backing, row->backing, sizeof row->backing);
  p->fabric.nap = row->nap;
  if (row->nap > 0)
    memcpy(p->fabric.nap_color, row->nap_color, sizeof row->nap_color);
}

/* What the machine leaves on the metal. */
typedef struct finish_row {
  const char *word, *label, *help, *source;
  double along, across; /* exponents between the strokes that can be seen */
  int turned;
  double cm; /* of the tile of scratches */
  shade_scratch_layer layer;
} finish_row;

static const finish_row finishes[] = {
    {
        .word = "brushed",
        .label = "Brushed",
        .help = "a straight grain, as an abrasive belt leaves it",
        .source = "rolled brass of [Ward1992]: alphas .05 and .16; grain by eye",
        .along = 798,
        .across = 76,
        .cm = 5,
        .layer = {.pits = 24000,
                  .radius = {0.0003, 0.0014},
                  .stretch = {60, 400},
                  .depth = {0.03, 0.16},
                  .direction = 0,
                  .spread = 0.03},
    },
    {
        .word = "turned",
        .label = "Turned",
        .help = "faced on a lathe: circles about the middle, with the marks of the tool's feed",
        .source = "rolled aluminium of [Ward1992]: alphas .04 and .09; grain by eye",
        .along = 1248,
        .across = 245,
        .turned = 1,
        .cm = 4,
        .layer = {.pits = 9000,
                  .radius = {0.0012, 0.0022},
                  .stretch = {150, 400},
                  .depth = {0.06, 0.14},
                  .direction = 0,
                  .spread = 0.002},
    },
    {
        .word = "scratched",
        .label = "Scratched",
        .help = "polished once, then used: scratches any way",
        .source = "polish of alpha .035 and scratches by eye",
        .along = 1600,
        .across = 1600,
        .cm = 5,
        .layer = {.pits = 2600,
                  .radius = {0.0003, 0.0016},
                  .stretch = {20, 300},
                  .depth = {0.1, 0.5},
                  .direction = 0,
                  .spread = 1.5707963267948966},
    },
};
enum { FINISHES = sizeof finishes / sizeof finishes[0] };

/* Names that a finish goes before; the metals are rows of shade_metal_row. */
static const struct {
  const char *metal, *words[FINISHES], *labels[FINISHES], *source;
} metals[] = {
#define METAL_ROW(metal, word, label, source)                                                      \
  {                                                                                                \
    metal, {"brushed_" word, "turned_" word, "scratched_" word},                                   \
        {"Brushed " label, "Turned " label, "Scratched " label}, source                            \
  }
    METAL_ROW("stainless_steel", "steel", "stainless steel", "[Karlsson1982]"),
    METAL_ROW("aluminium", "aluminium", "aluminium", "[Rakic1995]"),
    METAL_ROW("brass", "brass", "brass", "[Querry1985]"),
    METAL_ROW("copper", "copper", "copper", "[JohnsonChristy1972]"),
    METAL_ROW("gold", "gold", "gold", "[JohnsonChristy1972]"),
    METAL_ROW("titanium", "titanium", "titanium", "[JohnsonChristy1974]"),
#undef METAL_ROW
};
enum { METALS = sizeof metals / sizeof metals[0] };

static void take_metal(int row, shade_preset *p) {
  const int m = row / FINISHES, f = row % FINISHES;
  const finish_row *finish = &finishes[f];
  p->kind = SHADE_PRESET_METAL;
  p->word = metals[m].words[f];
  p->label = metals[m].labels[f];
  p->help = finish->help;
  p->source = finish->source;
  p->color_source = metals[m].source;
  p->turned = finish->turned;
  p->scratch_cm = finish->cm;
  p->scratches.layers = 1;
  p->scratches.layer[0] = finish->layer;
  shade_params_set_exponents(&p->metal, finish->along, finish->across);
  shade_params_set_metal(&p->metal, metals[m].metal);
}

int shade_preset_row(int row, shade_preset *preset) {
  if (row < 0 || row >= FABRICS + FINISHES * METALS)
    return 0;
  memset(preset, 0, sizeof *preset);
  shade_weave_params_init(&preset->yarns);
  shade_fabric_params_init(&preset->fabric);
  shade_params_init(&preset->metal);
  shade_scratch_params_init(&preset->scratches);
  if (row < FABRICS)
    take_fabric(&fabrics[row], preset);
  else
    take_metal(row - FABRICS, preset);
  return 1;
}

int shade_preset_find(const char *word, shade_preset *preset) {
  shade_preset p;
  for (int row = 0; word && shade_preset_row(row, &p); row++)
    if (same_word(word, p.word)) {
      if (preset)
        *preset = p;
      return 1;
    }
  return 0;
}

shade_fabric *shade_preset_fabric(const shade_preset *preset, shade_weave **weave,
                                  unsigned *status) {
  if (weave)
    *weave = NULL;
  if (!preset || preset->kind != SHADE_PRESET_FABRIC)
    return NULL;
  shade_draft *draft = shade_draft_named(preset->weave);
  shade_weave *made = draft ? shade_weave_create(draft, &preset->yarns, status) : NULL;
  shade_draft_free(draft);
  shade_fabric *fabric = shade_fabric_create(made, &preset->fabric, status);
  if (weave && fabric)
    *weave = made;
  else
    shade_weave_free(made);
  return fabric;
}
