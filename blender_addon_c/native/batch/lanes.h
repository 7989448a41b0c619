/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the stages read and write: structures of embedded arrays, one number a lane. With
 * `#pragma omp simd` on the loop and the structures as restrict parameters these vectorise on every
 * instruction set. Structures of pointers would not.
 *
 * A lane is one sample of one pixel up to `locate`, and from there on one hit (queue.h).
 */
#ifndef LIBSHADE_LANES_H
#define LIBSHADE_LANES_H

#include <stdbool.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BATCH = 1024 };

/*
 * Whole cache lines, and one more, so that the same lane of different arrays does not fall into
 * the same set of the cache.
 */
typedef __attribute__((aligned(64))) float lane_f[BATCH + 16];
typedef __attribute__((aligned(64))) uint32_t lane_u[BATCH + 16];
typedef struct lane_v {
  lane_f x, y, z;
} lane_v;
typedef struct lane_c {
  lane_f r, g, b;
} lane_c;

/* What a path keeps from its camera ray to the film, by sample. */
typedef struct paths {
  lane_u hash;  /* of its pixel: scrambles the points it draws */
  lane_f alpha; /* 1 where it meets something */
  lane_f time;  /* where something moves: that of all its rays */
} paths;

/* What a path does at a surface. Passing straight on is no bounce, but counted. Beside it bits:
 * BOUNCE_MATT: through a matt surface; BOUNCE_SHARP: as by a mirror; BOUNCE_CLEAR: through glass
 * that hides nothing from a transparent film. */
typedef enum bounce_kind {
  BOUNCE_DIFFUSE,
  BOUNCE_GLOSSY,
  BOUNCE_TRANSMISSION,
  BOUNCE_TRANSPARENT,
  BOUNCE_KINDS
} bounce_kind;
enum { BOUNCE_MASK = 3, BOUNCE_SHARP = 4, BOUNCE_MATT = 8, BOUNCE_CLEAR = 32 };

/* Rays by what they come from: bits, 2 << the bounce_kind. Lights and objects may be hidden from
 * some. */
typedef enum ray_kind {
  RAY_CAMERA = 1,
  RAY_DIFFUSE = 2,
  RAY_GLOSSY = 4,
  RAY_TRANSMISSION = 8,
  RAY_SHADOW = 16,
  RAY_SINGULAR = 32, /* beside one of the others: by a mirror, or clear glass */
  RAY_FILM = 64,     /* of a hit: the film may be seen through all before it */
  RAY_BOUNCED = RAY_DIFFUSE | RAY_GLOSSY | RAY_TRANSMISSION
} ray_kind;

/* How often a path may do what. */
typedef struct bounce_limits {
  uint32_t kind[BOUNCE_KINDS], all; /* all: of those that are bounces */
  uint32_t shadows;                 /* surfaces that a path and a shadow ray at its end pass */
} bounce_limits;

/* Paths under way, by ray: of which sample, and how much of what the ray meets that sample gets.
 * What a light that the ray meets weighs against its own samples goes by how the ray was drawn. */
typedef struct path_states {
  lane_u sample;
  lane_c throughput;
  lane_v from;   /* the point at which its direction was drawn */
  lane_f pdf;    /* with which density, 1/sr */
  lane_f least;  /* the least density of the path so far */
  lane_f width;  /* where the scene has cones: of what the ray stands for, across it, there, */
  lane_f spread; /* and how much wider that gets in a unit of its length */
  lane_f pixel;  /* where heights are: a pixel's width there by the length of the way, */
  lane_f widen;  /* and how much wider that gets in a unit of it */
  lane_f length; /* where nodes ask: from there to where it went straight on last */
  lane_f lights; /* what all lights may give there, by their weights (light/light.h); 0: each one
                    gave a sample */
  lane_u bounces[BOUNCE_KINDS]; /* of each kind so far */
  lane_u ray;                   /* ray_kind of its direction: passing straight on is no kind */
  lane_u ends;  /* not 0: no surface counts any more, only lights, behind transparent ones too */
  lane_u unlit; /* where instances that shine are for some alone: bits of those that are not for the
                   surface at which its direction was drawn */
  lane_u clear; /* where the scene `clears`: not 0 while the film may be seen through all before */
} path_states;

typedef struct rays {
  lane_v o; /* origin; a ray with tnear > tfar is not cast */
  lane_f tnear;
  lane_v d;
  lane_f tfar; /* becomes the distance of the hit; of a shadow ray -infinity where it is stopped */
  lane_f time; /* where something moves: 0 to 1 while the shutter is open */
} rays;

typedef struct hits {
  lane_v g; /* geometric normal, any length */
  lane_f u, v;
  lane_u geometry, primitive; /* Embree's; `locate` makes them a record */
  lane_u instance;            /* number in scene.placed, where there are any */
  lane_u record;              /* number of the triangle, or RECORD_MISS */
} hits;

/* Corners of the triangles that are hit, interpolated. */
typedef struct corners {
  __attribute__((aligned(64))) float row[8 * BATCH]; /* normal, tangent, uv of a hit */
  lane_f handed, reach;                              /* as of struct triangle */
  lane_f outward; /* -1 where the geometric normal points inwards */
} corners;

/* What matt surfaces do where normals were bent to the eye: that of the interpolated ones, as
 * Cycles does from some version on, or, until then, of the bent ones, faded by these [Chiang2019].
 */
typedef enum leaning { LEANS_NOT, LEANS_AWAY, LEANS_FADING } leaning;

/* Points of surfaces. */
typedef struct surfaces {
  lane_v p; /* position, world */
  lane_v g; /* geometric normal towards the eye, as long as a shadow ray is to start off */
  /* where the scene has curved triangles: */
  lane_v lift;    /* how much farther off shadow rays start to lights on the eye's side */
  lane_f slack;   /* infinite where such lights may also be below the facet */
  lane_v n, t, b; /* shading frame, world: normal facing the eye, tangent, cross(n, t) */
  lane_v wo;      /* to the eye, in the shading frame */
  lane_v lean; /* where some normal `leans`: the interpolated one, in the frame of the bent one */
  lane_f u, v;
  lane_f width;   /* where the scene has cones: across the ray, of what the hit stands for */
  float uv_width; /* where it has `stretch`: that much of u and v at most, of all hits, */
  lane_v du, dv;  /* and position by u and v, unless nothing asks where all are so fine; */
  bool edges;     /* some of them are edges, */
  lane_v u_along, v_along; /* and how far u (x) and v (y) go along each: 1, 0 and 0, 1 of others */
  lane_f pixel;            /* where it is `stepped`: a pixel's width, 0 where it is not known */
  /* where the scene is `identified`: which triangle and object, and the second and third corner's
   * weights */
  lane_u record, instance, object;
  const struct placed *placed; /* that these are numbers in */
  const struct object *objects;
  lane_f w1, w2;
  lane_f side; /* -1 where the normals had to be turned to the eye's side */
  leaning leans;
  /* where the scene is `routed`: the ray_kind that met the point, how long it was, and the path's
   * bounces so far */
  lane_u ray;
  lane_f length;
  lane_u depth[BOUNCE_KINDS];
} surfaces;

/*
 * What the nodes of a material's graph write and its closures read: registers. The first three are
 * never written by a node: the unperturbed normal, in the shading frame.
 */
enum { REGISTERS = 256, REGISTER_NORMAL = 0, REGISTER_FIRST = 3, CONSTANTS = 12, BLURRED = 2 };
typedef struct inputs {
  lane_f at[REGISTERS];
  bool blurs;                 /* lobes are no sharper than: */
  lane_f blur;                /* this alpha */
  lane_f blurred[BLURRED];    /* alphas of the closure at hand, none of them less */
  lane_f constant[CONSTANTS]; /* operands of the node or closure at hand that are no registers */
  float texture_blur;         /* colours of images are averaged over this part of a ray's width, */
  float normal_blur;          /* and normals over this one */
  /* where the scene has cloth: */
  lane_f term; /* a random number, which term of its footprint a hit is, if `single`; */
  bool single; /* else it is all of them */
  bool beside; /* hits lie side by side: many of each pixel, of the camera's rays */
  struct cloth_room *cloth; /* hits that are prepared, or NULL */
  /* where the scene is `occluded`, of each point, else NULL: */
  const float *stopped; /* how many of its rays met something, */
  const lane_v *around; /* and a sum of normals about it */
} inputs;

/* A register, or a number. */
typedef struct operand {
  int at; /* OPERAND_NUMBER: the number */
  float number;
} operand;
enum { OPERAND_NUMBER = -1 };

/* A run of the hits of one material. */
typedef struct lane_run {
  size_t begin, end;
} lane_run;

/* One sample of a light for each point. */
typedef struct light_samples {
  lane_f x, y;   /* where on it: a point of the unit square */
  rays ray;      /* d: to the light, unit, world */
  lane_f e;      /* irradiance as a part of the light's colour; shadows make it 0 */
  lane_f pdf;    /* density of its direction, 1/sr; 0 where no drawn ray meets the light */
  lane_v wi;     /* to the light, in the shading frame */
  lane_c color;  /* its light's, where each lane chooses a light of its own */
  lane_u hidden; /* from surfaces that draw rays of these kinds, where some light is */
  lane_u shade;  /* where the scene has such: the bit of instances that do not shade it */
} light_samples;

/* Light samples' rays that something stops, on their way through transparent surfaces. */
typedef struct passages {
  lane_f tfar; /* by light sample: how far its ray was to go */
  lane_c tint; /* what is left of its light */
  lane_u hit;  /* by ray under way: its light sample, */
  lane_u left; /* how many surfaces it may still go through, */
  lane_u free; /* whether it met an instance that does not shade its light, */
  lane_f rest; /* and how far it still has to go; */
  lane_f gone; /* how far it went before, where nodes ask */
  lane_u next_hit, next_left;
  lane_f next_gone;
} passages;

/* No light gives a point anything. */
#define LIGHT_NONE UINT32_MAX

/* A light for each point. */
typedef struct light_choices {
  lane_f random; /* uniform in [0, 1) */
  lane_u number; /* of the light, or LIGHT_NONE */
  lane_f chance; /* with which it was chosen */
  lane_u lane;   /* the points, those of each light one after the other, */
  lane_u place;  /* and where among them each point is */
} light_choices;

/* Samples of lights in the order of light_choices.lane, for light_samples. */
typedef struct light_draws {
  lane_v d;
  lane_f tnear, tfar, e, pdf;
  lane_c color;
  lane_u triangle; /* of those that shine (scene/emitters.h) */
} light_draws;

/* The lights as points see them, for the choice among them (light/light.h). The first ones are
 * kept, each is weighed twice. */
enum { LIGHT_WEIGHTS = 8 };
typedef struct light_weights {
  lane_f one[LIGHT_WEIGHTS], sum, total;
} light_weights;

/* Balls that matt surfaces aim draws at (scene/aims.h), from points of surfaces. */
enum { CONES = 4, CONE_NONE = CONES };
typedef struct cones {
  lane_v axis[CONES];    /* in the shading frame */
  lane_f narrow[CONES];  /* 1 less the cosine of its half angle */
  lane_f density[CONES]; /* of draws that go there, within it; 0: none do */
  lane_f rest;           /* share of the draws that the surface makes itself */
  lane_u drawn;          /* which a draw goes to, or CONE_NONE */
} cones;

/* Where a path goes on from each point. */
typedef struct draws {
  lane_f x, y;     /* the closure's two numbers, uniform in [0, 1) */
  lane_f roulette; /* roulette's */
  lane_f choice;   /* among closures, and then the drawn closure's third number, as even */
  lane_u kind;     /* bounce_kind of what was drawn */
  lane_v wi;       /* drawn, in the shading frame; 0 where there is none */
  lane_c f;        /* 1/sr; `next_paths` makes it the weight of the ray that goes there */
  lane_f pdf, cosine;
  lane_f own; /* the density without what it aims at */
} draws;

/* What a closure makes of it. */
typedef struct reflections {
  lane_c f; /* 1/sr; `reflect` makes it f cos E */
  lane_f cosine;
  lane_f pdf; /* if asked for: the density of the closure's own draws there, 1/sr */
} reflections;

/* A material's closures at each point: with which probability each draws, and which one did. */
enum { CLOSURES_MOST = 8 };
typedef struct choices {
  lane_f chance[CLOSURES_MOST];
  lane_u drawn;
  lane_f albedo, sum;
} choices;

#endif
