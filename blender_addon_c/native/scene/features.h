/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a scene uses of the renderer: what it does not use costs nothing. */
#ifndef LIBSHADE_FEATURES_H
#define LIBSHADE_FEATURES_H

#include <stdbool.h>

typedef struct features {
  /* the film */
  bool transparent_film;
  bool transparent_glass; /* and glass no rougher than scene.clear_alpha hides nothing from it */
  bool denoise;
  /* light */
  bool hit_lights;       /* rays that closures draw may meet light */
  bool shadow_linking;   /* some light is shaded by some instances alone */
  bool emitter_linking;  /* or of some that may shine the light is for some alone */
  bool light_visibility; /* some light is hidden from some kinds of ray */
  bool reflective_caustics, refractive_caustics; /* of matt surfaces by mirrors, by glass */
  /* surfaces */
  bool transparency;         /* some material lets rays pass on, */
  bool holdout;              /* or leaves a hole in the picture */
  bool shadow_terminator;    /* smooth surfaces cast no shadows of their facets on themselves, */
  bool curved;               /* and some triangle is one of such a surface */
  bool interpolated_diffuse; /* where normals were bent: LEANS_AWAY, not LEANS_FADING */
  /* what nodes ask for */
  bool object_info;      /* layers or objects */
  bool occlusion;        /* rays that they cast themselves */
  bool light_path;       /* by which way a point is seen */
  bool pixel_size;       /* how wide a pixel is there */
  bool ray_cones;        /* how much a ray stands for: cloth, images or scratches */
  bool derivatives;      /* position by u and v, */
  bool fine_derivatives; /* and not only where footprints are wider than texels */
  /* time */
  bool motion;          /* something moves while the shutter is open, */
  bool object_motion;   /* and not the camera alone; */
  bool motion_vectors;  /* nothing does, but a plane says where it was and will be */
  bool rolling_shutter; /* lines see one after another, from the top */
} features;

#endif
