/* SPDX-License-Identifier: GPL-3.0-or-later */
/* COST = 2 */
/*
 * The stages one by one, on every instruction set of this CPU, without Python: against formulas in
 * double precision. COUNT leaves a rest that fills no register; what lies beyond it must stay as it
 * is.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "closure/closure.h"
#include "light/light.h"
#include "node/node.h"
#include "render/state.h"
#include "render/sampling.h"
#include "stage/stage.h"
#include "system/memory.h"
#include "system/message.h"
#include "system/pages.h"
#include "system/parallel.h"

enum { COUNT = 1003, SET = 0x7b };

/* Sanitizers look at memory and are slow: there fewer draws are enough. */
#ifdef __SANITIZE_ADDRESS__
enum { FEWER = 4 };
#else
enum { FEWER = 1 };
#endif

static const stage_table *stages;
static batch *b;
static uint32_t seed;

static double number(void) { /* [0, 1) */
  seed = 1664525u * seed + 1013904223u;
  return (double)(seed >> 8) * 0x1p-24;
}
static float between(double low, double high) {
  return (float)(low + (high - low) * number());
}

/* A direction, even over the sphere. */
static vec3 direction(void) {
  double z = 2 * number() - 1, turns = 6.283185307179586 * number(), r = sqrt(1 - z * z);
  return (vec3){(float)(r * cos(turns)), (float)(r * sin(turns)), (float)z};
}
static double dot_d(vec3 a, vec3 c) {
  return (double)a.x * (double)c.x + (double)a.y * (double)c.y + (double)a.z * (double)c.z;
}
static void near(double found, double wanted, double tolerance) {
  if (!(fabs(found - wanted) <= tolerance))
    fail_msg("%s: %.9g where %.9g is right", stages->name, found, wanted);
}
static void near3(vec3 found, double x, double y, double z, double tolerance) {
  near((double)found.x, x, tolerance);
  near((double)found.y, y, tolerance);
  near((double)found.z, z, tolerance);
}

/* Bytes of an array from lane `from` on are as setup left them. */
static void untouched(const void *array, size_t from) {
  const unsigned char *byte = array;
  for (size_t i = from * sizeof(float); i < sizeof(lane_f); i++)
    assert_int_equal(byte[i], SET);
}

static int setup(void **state) {
  b = memory_aligned(64, sizeof *b);
  assert_non_null(b);
  memset(b, SET, sizeof *b);
  b->input.blurs = false;
  b->surface.leans = LEANS_NOT;
  stages = *state;
  seed = 7;
  return 0;
}
static int teardown(void **state) {
  (void)state;
  free(b);
  return 0;
}

/* Points with a random shading frame at random places. */
static void make_points(void) {
  for (size_t i = 0; i < COUNT; i++) {
    vec3 n = direction(), t, c;
    across(n, &t, &c);
    store(&b->surface.n, i, n);
    store(&b->surface.t, i, t);
    store(&b->surface.b, i, c);
    store(&b->surface.g, i, scaled(n, 1e-4f));
    store(&b->surface.p, i, (vec3){between(-2, 2), between(-2, 2), between(-2, 2)});
    b->surface.u[i] = between(-3, 3);
    b->surface.v[i] = between(-3, 3);
    b->surface.side[i] = number() < 0.5 ? -1.0f : 1.0f;
    b->corner.handed[i] = number() < 0.5 ? -1.0f : 1.0f;
  }
}

static void camera_through_pixels(void **state) {
  (void)state;
  uint32_t middle[COUNT];
  for (size_t i = 0; i < COUNT; i++)
    middle[i] = 0x80000000u;
  camera c = {.axis = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
              .origin = {5, 6, 7},
              .frame = {-1, 1, -1, 1},
              .clip = {0.25f, 50}};
  for (int perspective = 0; perspective < 2; perspective++) {
    c.perspective = perspective;
    camera_view view = {.camera = &c,
                        .region = {0, 0, 32, 30},
                        .samples = 1,
                        .per_sample = 1,
                        .step = {2.0f / 32, 2.0f / 32},
                        .point = {middle, middle}};
    stages->camera(COUNT, &view, &b->path, &b->sample_ray);
    for (uint32_t i = 0; i < COUNT; i++) {
      int x, y;
      pixel_place(&view, i, &x, &y);
      double right = (x + 0.5) / 16 - 1, up = (y + 0.5) / 16 - 1;
      double length = perspective ? sqrt(right * right + up * up + 1) : 1;
      vec3 o = load(&b->sample_ray.o, i), d = load(&b->sample_ray.d, i);
      if (perspective) {
        near3(o, 5, 6, 7, 0);
        near3(d, -1 / length, right / length, up / length, 2e-7);
      } else {
        near3(o, 5, 6 + right, 7 + up, 1e-6);
        near3(d, -1, 0, 0, 0);
      }
      near((double)b->sample_ray.tnear[i], 0.25 * length, 1e-6);
      near((double)b->sample_ray.tfar[i], y < 30 ? 50 * length : -1, 1e-5);
    }
    untouched(b->sample_ray.d.y, COUNT);
  }
}

static void locate_and_move(void **state) {
  (void)state;
  size_t wanted = 0;
  for (size_t i = 0; i < COUNT; i++) {
    b->sample_hit.geometry[i] = i % 3 == 0   ? ACCEL_MISS
                                : i % 3 == 1 ? ACCEL_QUADS
                                             : ACCEL_TRIANGLES;
    b->sample_hit.primitive[i] = (uint32_t)i;
    b->sample_hit.u[i] = 0.75f;
    b->sample_hit.v[i] = i % 2 ? 0.5f : 0.125f;
    wanted += i % 3 != 0;
  }
  assert_int_equal(stages->locate(COUNT, 10000, NULL, &b->sample_hit), wanted);
  for (size_t i = 0; i < COUNT; i++) {
    bool second = i % 3 == 1 && i % 2;
    assert_int_equal(b->sample_hit.record[i], i % 3 == 0   ? RECORD_MISS
                                              : i % 3 == 1 ? 2 * i + second
                                                           : 10000 + i);
    near((double)b->sample_hit.u[i], second ? 0.25 : 0.75, 0);
  }
  untouched(b->sample_hit.record, COUNT);
  stages->cover(COUNT, &b->sample_hit, &b->path);
  for (size_t i = 0; i < COUNT; i++)
    near((double)b->path.alpha[i], i % 3 != 0, 0);
  untouched(b->path.alpha, COUNT);
  for (size_t i = 0; i < COUNT; i++) {
    b->queue.moved[i] = (uint32_t)(i * 7 % COUNT); /* a permutation: 7 does not divide 1003 */
    b->sum.r[i] = b->sum.g[i] = b->sum.b[i] = (float)i;
  }
  stages->scatter(COUNT, b->queue.moved, &b->sum, &b->sample_color);
  stages->gather(COUNT, b->queue.moved, b->sample_color.g, b->surface.u);
  for (size_t i = 0; i < COUNT; i++)
    near((double)b->surface.u[i], (double)i, 0);
  untouched(b->surface.u, COUNT);
}

/* valid: normals as closures take them, else as a dump says them. */
static void frames(bool valid) {
  for (size_t i = 0; i < COUNT; i++) {
    vec3 d = direction(), n = direction(), t = direction();
    store(&b->sample_ray.o, i, (vec3){between(-9, 9), between(-9, 9), between(-9, 9)});
    store(&b->sample_ray.d, i, d);
    b->sample_ray.tfar[i] = between(0.1, 10);
    store(&b->sample_hit.g, i, scaled(direction(), between(0.01, 100)));
    float row[8] = {n.x, n.y, n.z, t.x, t.y, t.z, 0.25f, 0.75f};
    if (i % 5 == 0) /* corner normals that cancel */
      row[0] = row[1] = row[2] = 0.0f;
    if (i % 7 == 0) /* no tangent */
      row[3] = row[4] = row[5] = 0.0f;
    memcpy(b->corner.row + 8 * i, row, sizeof row);
    b->corner.reach[i] = 9.0f;
    b->corner.outward[i] = i % 3 ? 1.0f : -1.0f;
  }
  stages->surface(COUNT, &b->sample_ray, &b->sample_hit, &b->corner, valid, &b->surface);
  int bent = 0, behind = 0;
  for (size_t i = 0; i < COUNT; i++) {
    const float *row = b->corner.row + 8 * i;
    vec3 o = load(&b->sample_ray.o, i), d = load(&b->sample_ray.d, i);
    vec3 p = load(&b->surface.p, i), n = load(&b->surface.n, i), t = load(&b->surface.t, i);
    vec3 c = load(&b->surface.b, i), g = load(&b->surface.g, i), wo = load(&b->surface.wo, i);
    double far = (double)b->sample_ray.tfar[i];
    near3(p, (double)o.x + far * (double)d.x, (double)o.y + far * (double)d.y,
          (double)o.z + far * (double)d.z, 4e-6);
    near(dot_d(n, n), 1, 1e-6);
    near(dot_d(t, t), 1, 1e-6);
    near(dot_d(n, t), 0, 1e-5); /* tangents along the normal lose digits */
    near3(c, (double)n.y * (double)t.z - (double)n.z * (double)t.y,
          (double)n.z * (double)t.x - (double)n.x * (double)t.z,
          (double)n.x * (double)t.y - (double)n.y * (double)t.x, 1e-6);
    assert_true(dot_d(n, d) <= 1e-7 && dot_d(g, d) <= 0);
    vec3 given = {row[0], row[1], row[2]};
    /* the facet's side decides, of a dump that which the given normal is on; what then turns away
       from the eye becomes a mean of both normals that the eye sees at a grazing angle */
    double length = sqrt(dot_d(g, g)), side = i % 5 && dot_d(given, g) < 0 ? -1 : 1;
    if (valid && i % 5)
      side = (dot_d(load(&b->sample_hit.g, i), d) > 0 ? -1 : 1) * (i % 3 ? 1 : -1);
    double facet = -dot_d(g, d) / length, seen = i % 5 ? -side * dot_d(given, d) : facet;
    near((double)b->surface.side[i], side, 0);
    double along = i % 5 ? side * dot_d(given, g) / length : 1, low = fmin(0.9 * facet, 0.01);
    bool kept = valid ? 2 * seen * along - facet >= low : seen >= fmin(0.5 * facet, 0.002);
    double turned = kept && along < 0 ? -1 : 1; /* behind both: the other side is seen */
    behind += turned < 0;
    if (kept) {
      near(dot_d(i % 5 ? given : g, n), i % 5 ? turned * side : length, 1e-6);
    } else {
      double of_facet = dot_d(n, g) / length, image = -2 * dot_d(n, d) * of_facet - facet;
      double between_them = acos(fmin(of_facet, 1)) + acos(fmin(side * dot_d(n, given), 1));
      near(between_them, acos(fmax(side * dot_d(given, g) / length, -1)), 2e-3);
      if (valid) /* the eye's mirror image is as low as may be */
        near(image, low, 1e-4);
      else
        assert_true(-dot_d(n, d) > 0.5 * fmin(0.5 * facet, 0.002) && -dot_d(n, d) < 0.01);
      bent++;
    }
    near3(wo, -dot_d(d, t), -dot_d(d, c), -dot_d(d, n), 1e-6);
    vec3 lean = load(&b->surface.lean, i);
    if (i % 5) /* as it was interpolated, bent or not */
      near3(given,
            side * ((double)lean.x * (double)t.x + (double)lean.y * (double)c.x +
                    (double)lean.z * (double)n.x),
            side * ((double)lean.x * (double)t.y + (double)lean.y * (double)c.y +
                    (double)lean.z * (double)n.y),
            side * ((double)lean.x * (double)t.z + (double)lean.y * (double)c.z +
                    (double)lean.z * (double)n.z),
            2e-6);
    assert_true(sqrt(dot_d(g, g)) > 2e-6 * 9 && sqrt(dot_d(g, g)) < 2e-6 * 60);
    near((double)b->surface.u[i], 0.25, 0);
  }
  assert_true(bent > COUNT / 10 && b->surface.leans);
  assert_true(valid ? behind > COUNT / 10 : !behind);
  untouched(b->surface.n.x, COUNT);
}

static void surface_frames(void **state) {
  (void)state;
  frames(true);
}

static void surface_frames_of_a_dump(void **state) {
  (void)state;
  frames(false);
}

static void pairs_of_numbers(void **state) {
  (void)state;
  uint32_t x[COUNT], y[COUNT];
  for (uint32_t i = 0; i < COUNT; i++) {
    x[i] = i << 22; /* in order and, of 1024, even */
    y[i] = 0xc0000000u;
    b->path.hash[i] = i * 0x9e3779b9u;
    b->queue.moved[i] = COUNT - 1 - i;
  }
  points plain = {.x = x, .y = y}, mixed = {.x = x, .y = y, .salt = 5, .scramble = UINT32_MAX};
  stages->pair(COUNT, &plain, b->queue.moved, &b->path, &b->light);
  for (size_t i = 0; i < COUNT; i++) {
    near((double)b->light.x[i], (double)(COUNT - 1 - i) / 1024, 0);
    near((double)b->light.y[i], 0.75, 0);
  }
  stages->pair(COUNT, &mixed, b->queue.moved, &b->path, &b->light);
  double sum = 0, square = 0;
  for (size_t i = 0; i < COUNT; i++) {
    double one = (double)b->light.y[i];
    assert_true(one >= 0 && one < 1);
    sum += one;
    square += one * one;
  }
  near(sum / COUNT, 0.5, 4 * sqrt(1.0 / 12 / COUNT)); /* four standard deviations */
  near(square / COUNT, 1.0 / 3, 4 * sqrt(4.0 / 45 / COUNT));
  untouched(b->light.x, COUNT);
}

/* A grid over the unit square, in the middles of its cells; returns how many. */
static size_t make_grid(void) {
  enum { SIDE = 31 };
  for (size_t i = 0; i < SIDE * SIDE; i++) {
    b->light.x[i] = ((float)(i % SIDE) + 0.5f) / SIDE;
    b->light.y[i] = ((float)(i / SIDE) + 0.5f) / SIDE;
    store(&b->surface.p, i, (vec3){1, 2, 3});
  }
  return SIDE * SIDE;
}

static void sun_light(void **state) {
  (void)state;
  const double radius = 0.5; /* tan(angle / 2) */
  light sun = {.type = LIGHT_SUN,
               .common = {.soft = true},
               .of.sun = {.to = {0.6f, 0, 0.8f}, .radius = 0.5f, .cosine = 0.894427191f}};
  sun.of.sun.axis[0] = (vec3){0, 1, 0};
  sun.of.sun.axis[1] = (vec3){-0.8f, 0, 0.6f};
  size_t count = make_grid();
  stages->light[LIGHT_SUN](COUNT, &sun, false, &b->surface, &b->light);
  for (size_t i = 0; i < COUNT; i++)
    near3(load(&b->light.ray.d, i), 0.6, 0, 0.8, 1e-7);
  for (int even = 0; even < 2; even++) {
    sun.of.sun.even = even ? UINT32_MAX : 0;
    stages->light[LIGHT_SUN](count, &sun, true, &b->surface, &b->light);
    double across_squared = 0, facing = 0;
    for (size_t i = 0; i < count; i++) {
      vec3 d = load(&b->light.ray.d, i);
      double along = dot_d(d, sun.of.sun.to);
      near(dot_d(d, d), 1, 1e-6);
      assert_true(along > 1 / sqrt(1 + radius * radius) - 1e-6);
      across_squared += 1 / (along * along) - 1;
      facing += along * (double)b->light.e[i];
      near((double)b->light.pdf[i], 0, 0); /* no ray meets it */
      assert_true(isinf(b->light.ray.tfar[i]));
    }
    if (even) /* what it gives to a surface that faces it */
      near(facing / (double)count, 1, 1e-4);
    else /* of an evenly lit disc */
      near(across_squared / (double)count, radius * radius / 2, 1e-4);
  }
}

static void point_light(void **state) {
  (void)state;
  const double radius = 0.25;
  light bulb = {.type = LIGHT_POINT, .of.point.bulb = {.position = {1, 2, 5}}};
  make_points();
  store(&b->surface.p, 3, (vec3){1, 2, 5}); /* the light itself */
  stages->light[LIGHT_POINT](COUNT, &bulb, false, &b->surface, &b->light);
  for (size_t i = 0; i < COUNT; i++) {
    vec3 p = load(&b->surface.p, i);
    double x = 1 - (double)p.x, y = 2 - (double)p.y, z = 5 - (double)p.z;
    double square = x * x + y * y + z * z, far = sqrt(square);
    near((double)b->light.e[i], i == 3 ? 0 : 1 / square, 1e-6);
    if (i != 3)
      near3(load(&b->light.ray.d, i), x / far, y / far, z / far, 1e-6);
  }
  untouched(b->light.e, COUNT);
  bulb.of.point.bulb.radius = (float)radius;
  size_t count = make_grid();
  stages->light[LIGHT_POINT](count, &bulb, true, &b->surface, &b->light);
  double height = 2, across_squared = 0;
  for (size_t i = 0; i < count; i++) {
    vec3 d = load(&b->light.ray.d, i);
    double far = (double)b->light.ray.tfar[i];
    near((double)d.z * far, height, 1e-6); /* on the disc that faces the point */
    across_squared += far * far - height * height;
    assert_true(far * far <= height * height + radius * radius + 1e-5);
    near((double)b->light.e[i] * far * far * far, height, 1e-5);
  }
  near(across_squared / (double)count, radius * radius / 2, 1e-4);
}

/* Lights with an extent, and what they give to a surface at (1, 2, 3) that faces (0, 0, 1). */
enum { SOFT_LIGHTS = 9 };
static void soft_lights(light l[SOFT_LIGHTS], double irradiance[SOFT_LIGHTS]) {
  const float pi = 3.14159265f;
  light_bulb disc = {.position = {1, 2, 5}, .radius = 1}, ball = disc;
  ball.ball = UINT32_MAX;
  memset(l, 0, SOFT_LIGHTS * sizeof *l);
  l[0] = (light){.type = LIGHT_POINT, .of.point.bulb = disc};
  irradiance[0] = 1.0 / (4 + 1);
  l[1] = (light){.type = LIGHT_POINT, .of.point.bulb = ball};
  irradiance[1] = 1.0 / 4;
  l[2] = (light){.type = LIGHT_SPOT,
                 .of.spot = {.bulb = disc,
                             .axis = {0, 0, -1},
                             .across = {{1, 0, 0}, {0, 1, 0}},
                             .cosine = 0.5f,
                             .rim = 1e7f}};
  irradiance[2] = 1.0 / (4 + 1); /* all of it is within the cone */
  l[3] = l[2];
  l[3].of.spot.cosine_law = UINT32_MAX; /* 2 pi integral cos^2 sin / (pi radius^2) */
  irradiance[3] = 2.0 / 3 * (1 - pow(0.8, 1.5));
  l[4] =
      (light){.type = LIGHT_SUN,
              .of.sun = {.to = {0, 0, 1}, .radius = 1, .cosine = 0.70710678f, .even = UINT32_MAX}};
  irradiance[4] = 1;
  l[5] = l[4];
  l[5].of.sun.even = 0; /* mean of the cosine over a disc */
  irradiance[5] = 2 * (sqrt(2.0) - 1);
  for (int k = 4; k < 6; k++)
    across(l[k].of.sun.to, &l[k].of.sun.axis[0], &l[k].of.sun.axis[1]);
  l[6] = (light){.type = LIGHT_AREA,
                 .of.area = {.center = {1, 2, 5},
                             .axis = {{1, 0, 0}, {0, 1, 0}},
                             .across = {{1, 0, 0}, {0, 1, 0}},
                             .normal = {0, 0, -1},
                             .area = 4,
                             .gain = 1}};
  /* a square of half side 1 at height 2, by the corner's form factor, times 4: over pi */
  double t = 0.5, q = t / sqrt(1 + t * t);
  irradiance[6] = 4 * (q * atan(q)) / 4;
  l[7] = l[6];
  l[7].of.area.round = UINT32_MAX;
  l[7].of.area.area = pi;
  irradiance[7] = 1.0 / (4 + 1);
  l[8] = l[7]; /* an ellipse, askew: its draws and its density are still each other's */
  l[8].of.area.axis[0] = (vec3){0.5f, 0, 0};
  l[8].of.area.across[0] = (vec3){2, 0, 0};
  l[8].of.area.center = (vec3){1.5f, 1.5f, 4.5f};
  l[8].of.area.area = 0.5f * pi;
  l[8].of.area.slope = 0.3f;
  irradiance[8] = 0; /* not known */
  for (int k = 0; k < SOFT_LIGHTS; k++)
    l[k].common =
        (light_common){.color = {1, 2, 4}, .power = 1, .soft = true, .shadow = true, .mis = true};
}

/*
 * Draws of each light against what a ray meets of it: the same radiance, distance and density;
 * densities that add up to 1 over the sphere, and cells of it that are found as often as that says
 * (chi-square of up to 255 cells: 340 is beyond 1 in 1000).
 */
static void lights_drawn_and_met(void **state) {
  (void)state;
  enum { LINES = 16, COLUMNS = 16, FINE = FEWER > 1 ? 23 : 63, DRAWS = 64 / FEWER * COUNT };
  light all[SOFT_LIGHTS];
  double irradiance[SOFT_LIGHTS];
  soft_lights(all, irradiance);
  b->state = &b->path_states[0];
  for (int n = 0; n < SOFT_LIGHTS; n++) {
    const light *l = &all[n];
    /* cells about the axis (0, 0, 1), within the angle that the light may fill */
    const double lowest = 0.55, line_height = (1 - lowest) / LINES;
    double expected[LINES * COLUMNS] = {0}, sum = 0, seen[LINES * COLUMNS] = {0};
    for (int line = 0; line < LINES * FINE; line++) {
      size_t count = COLUMNS * FINE;
      double z = lowest + (line + 0.5) * line_height / FINE, flat = sqrt(1 - z * z);
      assert_true(count <= BATCH);
      for (size_t i = 0; i < count; i++) {
        double a = 6.283185307179586 * ((double)i + 0.5) / (double)count;
        store(&b->state->from, i, (vec3){1, 2, 3});
        store(&b->sample_ray.o, i, (vec3){1, 2, 3});
        store(&b->sample_ray.d, i,
              (vec3){(float)(flat * cos(a)), (float)(flat * sin(a)), (float)z});
        b->sample_ray.tfar[i] = INFINITY;
        b->state->ray[i] = RAY_DIFFUSE;
        b->state->pdf[i] = 1e-12f; /* the light's samples have all but nothing of the share */
        b->emitted.r[i] = b->emitted.g[i] = b->emitted.b[i] = 0;
      }
      stages->hit_light[l->type](count, l, b->state, &b->sample_ray, NULL, &b->emitted);
      for (size_t i = 0; i < count; i++) {
        light_intersection m;
        vec3 o = {1, 2, 3}, d = load(&b->sample_ray.d, i);
        m = l->type == LIGHT_POINT  ? light_point_intersect(&l->of.point, o, d)
            : l->type == LIGHT_SPOT ? light_spot_intersect(&l->of.spot, o, d)
            : l->type == LIGHT_SUN  ? light_sun_intersect(&l->of.sun, o, d)
                                    : light_area_intersect(&l->of.area, o, d);
        bool hit_lights = m.distance > 0;
        double cell = line_height / FINE * 6.283185307179586 / (double)count;
        double pdf = hit_lights ? (double)m.pdf : 0;
        expected[line / FINE * COLUMNS + (int)(i / FINE)] += pdf * cell;
        sum += pdf * cell;
        double share = hit_lights ? (double)m.radiance * 1e-12 / (pdf + 1e-12) : 0;
        near((double)b->emitted.b[i] * 1e12, 4 * share * 1e12, 1e-4 * (1 + 4 * share * 1e12));
      }
    }
    near(sum, 1, 0.01);
    double facing = 0;
    for (int draw = 0; draw < DRAWS; draw += COUNT) {
      for (size_t i = 0; i < COUNT; i++) {
        b->light.x[i] = between(0, 1);
        b->light.y[i] = between(0, 1);
        store(&b->surface.p, i, (vec3){1, 2, 3});
      }
      stages->light[l->type](COUNT, l, true, &b->surface, &b->light);
      for (size_t i = 0; i < COUNT; i++) {
        vec3 d = load(&b->light.ray.d, i);
        double z = (double)d.z, a = atan2((double)d.y, (double)d.x) / 6.283185307179586;
        near(dot_d(d, d), 1, 3e-6);
        assert_true(z > lowest);
        int line = (int)((z - lowest) / line_height), column = (int)((a < 0 ? a + 1 : a) * COLUMNS);
        seen[(line < LINES ? line : LINES - 1) * COLUMNS + (column < COLUMNS ? column : 0)]++;
        facing += z * (double)b->light.e[i];
        /* a ray the same way, a hair towards the middle of the light, whose rim is sharp */
        if (draw == 0) {
          store(&b->state->from, i, (vec3){1, 2, 3});
          store(&b->sample_ray.o, i, (vec3){1, 2, 3});
          store(&b->sample_ray.d, i, d);
          b->sample_ray.tfar[i] = i % 2 ? INFINITY : 0.999f * b->light.ray.tfar[i];
          b->state->ray[i] = RAY_GLOSSY;
          b->state->pdf[i] = b->light.pdf[i];
          b->emitted.r[i] = b->emitted.g[i] = b->emitted.b[i] = 0;
        }
      }
      if (draw)
        continue;
      stages->hit_light[l->type](COUNT, l, b->state, &b->sample_ray, NULL, &b->emitted);
      int rim = 0;
      for (size_t i = 0; i < COUNT; i++) {
        double radiance = (double)b->light.e[i] * (double)b->light.pdf[i];
        bool stopped = i % 2 == 0 && l->type != LIGHT_SUN;
        if (!stopped && b->emitted.r[i] == 0.0f && ++rim < 5)
          continue;
        near((double)b->emitted.r[i], stopped ? 0 : radiance / 2, 2e-4 * radiance);
      }
    }
    if (irradiance[n] > 0) /* four deviations of what varies by half */
      near(facing / DRAWS, irradiance[n], irradiance[n] * 2 / sqrt(DRAWS));
    double chi2 = 0;
    int cells = 0;
    for (int k = 0; k < LINES * COLUMNS; k++)
      if (expected[k] * DRAWS > 20) {
        double error = seen[k] - expected[k] / sum * DRAWS;
        /* a rim that crosses a cell is known to the fine grid only */
        double spread = expected[k] * DRAWS + pow(0.02 * expected[k] * DRAWS, 2);
        chi2 += error * error / spread;
        cells++;
      }
    assert_true(cells >= 16);
    if (!(chi2 < cells + 4.5 * sqrt(2.0 * cells)))
      fail_msg("%s: light %d: chi-square %g of %d cells", stages->name, n, chi2, cells);
  }
}

/* Each lane takes a light by its weight, and its sample is that of the light alone over the
 * chance. */
static void one_light_a_lane(void **state) {
  (void)state;
  enum { USED = 3 };
  static const uint32_t used[USED] = {0, 4, 7};
  light all[SOFT_LIGHTS];
  double irradiance[SOFT_LIGHTS], below[COUNT] = {0};
  soft_lights(all, irradiance);
  all[0].common.power = all[7].common.power = 20;
  make_points();
  for (size_t i = 0; i < COUNT; i++) {
    b->choice.random[i] = between(0, 1);
    b->light.x[i] = between(0, 1);
    b->light.y[i] = between(0, 1);
    b->weight.sum[i] = b->weight.total[i] = 0;
  }
  for (size_t k = 0; k < USED; k++) {
    const light *l = &all[used[k]];
    stages->weigh[l->type](COUNT, l, &b->surface.p, b->weight.one[k]);
    stages->add(COUNT, b->weight.one[k], b->weight.total);
  }
  memset(b->choice.number, 0xff, sizeof b->choice.number);
  for (uint32_t k = 0; k < USED; k++) {
    stages->choose(COUNT, k, b->weight.one[k], &b->weight, &b->choice);
    for (size_t i = 0; i < COUNT; i++) {
      double total = (double)b->weight.total[i], random = (double)b->choice.random[i];
      double share = (double)b->weight.one[k][i] / total, above = below[i] + share;
      if (fabs(random - below[i]) > 1e-5 && fabs(random - above) > 1e-5) {
        bool takes = random >= below[i] && random < above;
        assert_int_equal(b->choice.number[i] == k, takes);
        if (takes)
          near((double)b->choice.chance[i], share, 1e-5);
      }
      below[i] = above;
    }
  }
  near(below[5], 1, 1e-5);
  light_samples *alone = memory_aligned(64, sizeof *alone);
  assert_non_null(alone);
  memcpy(alone, &b->light, sizeof *alone);
  for (uint32_t k = 0, begin = 0, end = 0; k < USED; k++, begin = end) {
    for (uint32_t i = 0; i < COUNT; i++)
      if (b->choice.number[i] == k) {
        b->choice.place[i] = end;
        b->choice.lane[end++] = i;
      }
    assert_true(end > begin + 20);
    const light *l = &all[used[k]];
    stages->chosen[l->type](begin, end, &b->choice, l, &b->surface, &b->light, &b->drawn);
  }
  untouched(b->drawn.e, COUNT);
  stages->place_samples(COUNT, &b->choice, &b->drawn, &b->light);
  untouched(b->light.e, COUNT);
  for (uint32_t k = 0; k < USED; k++) {
    const light *l = &all[used[k]];
    stages->light[l->type](COUNT, l, true, &b->surface, alone);
    for (size_t i = 0; i < COUNT; i++)
      if (b->choice.number[i] == k) {
        double chance = (double)b->choice.chance[i], e = (double)alone->e[i] / chance;
        near((double)b->light.e[i], e, 1e-4 * e);
        near((double)b->light.pdf[i], (double)alone->pdf[i] * chance, 1e-4 * (double)alone->pdf[i]);
        near((double)b->light.color.g[i], 2, 0);
        near((double)b->light.ray.tnear[i], 0, 0);
        near((double)b->light.ray.d.x[i], (double)alone->ray.d.x[i], 1e-6);
      }
  }
  free(alone);
}

/* The sky's image as its formulas say, in double precision: latitude by longitude, linear. */
static double sky_at(const float *data, int width, int height, int channel, vec3 d) {
  const double pi = 3.141592653589793;
  double x = (0.5 - atan2((double)d.y, (double)d.x) / (2 * pi)) * width - 0.5;
  double y = (1 - acos(fmax(-1, fmin(1, (double)d.z))) / pi) * height - 0.5;
  int column = (int)floor(x), line = (int)floor(y);
  double u = x - column, v = y - line, sum = 0;
  for (int k = 0; k < 4; k++) {
    int at_x = (column + k % 2 + width) % width, at_y = (line + k / 2 + height) % height;
    double part = (k % 2 ? u : 1 - u) * (k / 2 ? v : 1 - v);
    sum += part * (double)data[4 * (at_y * width + at_x) + channel];
  }
  return sum;
}

/* An image with a small sun: what is seen, where draws go, and with which density. */
static void sky_seen_and_drawn(void **state) {
  (void)state;
  enum { WIDTH = 40, HEIGHT = 20, CELLS_Z = 12, CELLS_A = 16, DRAWS = 200 * COUNT };
  static float data[4 * WIDTH * HEIGHT];
  for (size_t k = 0; k < sizeof data / sizeof *data; k++)
    data[k] = between(0, 1);
  for (int k = 0; k < 3; k++)
    data[4 * (13 * WIDTH + 9) + k] = 500;
  image source = {.width = WIDTH, .height = HEIGHT, .channels = 4, .data = data};
  atomic_bool cancel = false;
  sky s = {.strength = {1, 2, 3}};
  /* x to y, y to z, z to x: the image is turned against the world */
  s.matrix[1] = s.matrix[6] = s.matrix[8] = 1;
  assert_true(sky_build(&s, &source, stages->sky, 1, &cancel));
  for (size_t i = 0; i < COUNT; i++)
    store(&b->toward, i, direction());
  stages->sky(COUNT, &s, &b->toward, &b->sky);
  for (size_t i = 0; i < COUNT; i++) {
    vec3 d = load(&b->toward, i), turned = {d.y, d.z, d.x};
    for (int k = 0; k < 3; k++) {
      const lane_f *out[3] = {&b->sky.r, &b->sky.g, &b->sky.b};
      double wanted = (k + 1) * sky_at(data, WIDTH, HEIGHT, k, turned);
      near((double)(*out[k])[i], wanted, 2e-3 + 1e-4 * wanted);
    }
  }
  untouched(b->sky.r, COUNT);
  /* the density's integral, by cells of a grid that is not the map's, and the brightness' */
  double expected[CELLS_Z * CELLS_A] = {0}, sum = 0, light = 0;
  const int lines = 12 * 60, columns = 960;
  for (int line = 0; line < lines; line++) {
    double z = -1 + (line + 0.5) * 2 / lines, flat = sqrt(1 - z * z);
    for (int k = 0; k < columns; k++) {
      double a = 6.283185307179586 * (k + 0.5) / columns;
      store(&b->toward, (size_t)k,
            (vec3){(float)(flat * cos(a)), (float)(flat * sin(a)), (float)z});
    }
    stages->sky_pdf((size_t)columns, &s, &b->toward, b->sky_pdf);
    stages->sky((size_t)columns, &s, &b->toward, &b->sky);
    for (int k = 0; k < columns; k++) {
      double cell = 12.566370614359172 / (lines * columns) * (double)b->sky_pdf[k];
      expected[line / 60 * CELLS_A + k / 60] += cell;
      sum += cell;
      light += 0.25 / (lines * columns) * 12.566370614359172 *
               (0.2126 * (double)b->sky.r[k] + 0.7152 * (double)b->sky.g[k] +
                0.0722 * (double)b->sky.b[k]);
    }
  }
  near(sum, 1, 2e-3);
  near((double)s.power, light, 5e-3 * light);
  double seen[CELLS_Z * CELLS_A] = {0}, radiance = 0;
  for (uint32_t i = 0; i < COUNT; i++)
    b->queue.moved[i] = i;
  for (int draw = 0; draw < DRAWS; draw += COUNT) {
    for (size_t i = 0; i < COUNT; i++) {
      b->light.x[i] = between(0, 1);
      b->light.y[i] = between(0, 1);
    }
    stages->sky_draw(COUNT, &s, b->queue.moved, &b->light, &b->toward, b->sky_pdf);
    stages->sky(COUNT, &s, &b->toward, &b->sky);
    for (size_t i = 0; i < COUNT; i++) {
      vec3 d = load(&b->toward, i);
      near(dot_d(d, d), 1, 1e-5);
      double a = atan2((double)d.y, (double)d.x) / 6.283185307179586;
      int line = (int)(((double)d.z + 1) / 2 * CELLS_Z);
      int column = (int)((a < 0 ? a + 1 : a) * CELLS_A);
      seen[(line < CELLS_Z ? line : CELLS_Z - 1) * CELLS_A + column % CELLS_A]++;
      radiance += (double)b->sky.g[i] / (double)b->sky_pdf[i];
    }
  }
  double chi2 = 0, all_light = 0;
  for (int k = 0; k < CELLS_Z * CELLS_A; k++) {
    double error = seen[k] - expected[k] * DRAWS;
    chi2 += error * error / (expected[k] * DRAWS + pow(5e-3 * expected[k] * DRAWS, 2));
  }
  if (!(chi2 < CELLS_Z * CELLS_A + 4.5 * sqrt(2.0 * CELLS_Z * CELLS_A)))
    fail_msg("%s: chi-square %g of %d cells", stages->name, chi2, CELLS_Z * CELLS_A);
  for (int line = 0; line < 400; line++) /* of the image itself, green, times its strength */
    for (int k = 0; k < 800; k++) {
      double z = -1 + (line + 0.5) / 200, a = 6.283185307179586 * (k + 0.5) / 800;
      double flat = sqrt(1 - z * z);
      vec3 d = {(float)(flat * cos(a)), (float)(flat * sin(a)), (float)z};
      all_light += 2 * sky_at(data, WIDTH, HEIGHT, 1, d) * 12.566370614359172 / (400.0 * 800);
    }
  near(radiance / DRAWS, all_light, 0.01 * all_light);
  sky_free(&s);
}

/* Irradiance at the origin, facing +z, of a triangle of radiance 1: by small ones. */
static double irradiance_of(const double corner[3][3]) {
  enum { FINE = 60 };
  double u[3], v[3], sum = 0;
  for (int k = 0; k < 3; k++) {
    u[k] = corner[1][k] - corner[0][k];
    v[k] = corner[2][k] - corner[0][k];
  }
  double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  for (int i = 0; i < FINE; i++)
    for (int j = 0; j < 2 * (FINE - i) - 1; j++) {
      double a = (i + (j % 2 ? 2.0 : 1.0) / 3) / FINE, c = (j / 2 + (j % 2 ? 2.0 : 1.0) / 3) / FINE;
      double p[3], d2 = 0, facing = 0;
      for (int k = 0; k < 3; k++) {
        p[k] = corner[0][k] + a * u[k] + c * v[k];
        d2 += p[k] * p[k];
        facing += p[k] * n[k] / 2 / (FINE * FINE);
      }
      sum += p[2] > 0 ? p[2] * fabs(facing) / (d2 * d2) : 0;
    }
  return sum;
}

/* Two instances of a mesh, of whose triangles one shines, one does a little, and one not at all. */
static void triangles_that_shine(void **state) {
  (void)state;
  enum { DRAWS = 100 * COUNT };
  const float position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0.5f, 1, 1, 0};
  const uint32_t corner[] = {0, 1, 2, 1, 3, 2, 0, 1, 3};
  const int32_t of[] = {0, 1, 2};
  material m[3] = {{.shines = true, .radiance = {3, 2, 1}},
                   {.shines = true, .radiance = {0.25f, 0.25f, 0.25f}},
                   {.shines = false, .radiance = {9, 9, 9}}};
  mesh one = {.positions = 4,
              .triangles = 3,
              .position = position,
              .corner_position = corner,
              .material = of};
  instance in[2] = {{.matrix = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 2}},
                    {.matrix = {0, 0, 2, -2, 0, 1, 0, 0.25, -1, 0, 0, 1.5}}};
  const geometry s = {
      .instances = 2, .meshes = 1, .materials = 3, .material = m, .mesh = &one, .instance = in};
  emitters e = {.count = 0};
  assert_true(emitters_build(&s, &e));
  assert_int_equal(e.count, 4);
  double wanted[3] = {0, 0, 0}, found[3] = {0, 0, 0}, square = 0;
  for (int k = 0; k < 2; k++)
    for (size_t t = 0; t < 2; t++) {
      double place[3][3];
      for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++) {
          const float *p = position + 3 * corner[3 * t + (size_t)c];
          const double *row = in[k].matrix + 4 * axis;
          place[c][axis] =
              row[0] * (double)p[0] + row[1] * (double)p[1] + row[2] * (double)p[2] + row[3];
        }
      double irradiance = irradiance_of(place);
      for (int c = 0; c < 3; c++)
        wanted[c] += irradiance * (double)m[t].radiance[c];
    }
  b->state = &b->path_states[0];
  for (uint32_t i = 0; i < COUNT; i++) {
    b->choice.lane[i] = i;
    b->choice.chance[i] = i % 2 ? 1.0f : 0.5f;
    store(&b->surface.p, i, (vec3){0, 0, 0});
    store(&b->surface.g, i, (vec3){0, 0, 1e-6f});
  }
  for (int draw = 0; draw < DRAWS; draw += COUNT) {
    for (size_t i = 0; i < COUNT; i++) {
      b->light.x[i] = between(0, 1);
      b->light.y[i] = between(0, 1);
    }
    stages->lit_by_emitters(0, COUNT, &b->choice, false, &e, &b->surface, &b->light, &b->drawn);
    for (size_t i = 0; i < COUNT; i++) {
      vec3 d = load(&b->drawn.d, i);
      double part = (double)b->choice.chance[i] * (double)b->drawn.e[i] * fmax(0, (double)d.z);
      near(dot_d(d, d), 1, 1e-5);
      near((double)b->drawn.e[i] * (double)b->drawn.pdf[i], 1, 1e-5);
      found[0] += part * (double)b->drawn.color.r[i];
      found[1] += part * (double)b->drawn.color.g[i];
      found[2] += part * (double)b->drawn.color.b[i];
      square += pow(part * (double)b->drawn.color.r[i], 2);
    }
  }
  double deviation = sqrt(square / DRAWS - pow(found[0] / DRAWS, 2)) / sqrt(DRAWS);
  for (int c = 0; c < 3; c++)
    near(found[c] / DRAWS, wanted[c], 4 * deviation + 2e-3 * wanted[c]);
  /* rays to the same places, drawn with another density: what is left to them */
  float *weight = memory_aligned(64, sizeof(lane_f));
  triangle *triangles = memory_aligned(128, 3 * sizeof *triangles);
  assert_true(weight && triangles);
  for (uint32_t t = 0; t < 3; t++)
    triangles[t].material = t;
  for (uint32_t i = 0; i < COUNT; i++) {
    bool strong = b->drawn.color.r[i] == m[0].radiance[0];
    vec3 d = load(&b->drawn.d, i), p = scaled(d, b->drawn.tfar[i]);
    store(&b->sample_ray.o, i, scaled(d, 0.25f)); /* it passed something on its way */
    store(&b->sample_ray.d, i, d);
    b->sample_ray.tfar[i] = b->drawn.tfar[i] - 0.25f;
    store(&b->state->from, i, (vec3){0, 0, 0});
    b->state->pdf[i] = 0.3f;
    b->state->lights[i] = 2.0f;
    weight[i] = i % 2 ? 2.0f : 1.0f;
    b->emitted.r[i] = b->emitted.g[i] = b->emitted.b[i] = 1.0f;
    b->sample_hit.record[i] = i % 7 == 0 ? RECORD_MISS : i % 7 == 1 ? 2 : strong ? 0 : 1;
    for (int t = 0; t < 4; t++) {
      const float *row = e.row + EMITTER_ROW * t;
      vec3 n = cross((vec3){row[3], row[4], row[5]}, (vec3){row[6], row[7], row[8]});
      vec3 off = {p.x - row[0], p.y - row[1], p.z - row[2]};
      if (fabs(dot_d(off, n)) < 1e-4) /* it lies on this one */
        store(&b->sample_hit.g, i, scaled(n, i % 3 ? 0.5f : -0.25f));
    }
  }
  stages->hit_emitters(COUNT, &e, triangles, NULL, &b->sample_hit, &b->sample_ray, b->state, weight,
                       NULL, &b->emitted);
  for (size_t i = 0; i < COUNT; i++) {
    double part = i % 7 < 2 ? 0 : 0.3 / (0.3 + (double)b->drawn.pdf[i]);
    near((double)b->emitted.g[i], 1 + part * (double)b->drawn.color.g[i], 2e-3 * (1 + part));
  }
  untouched(b->emitted.g, COUNT);
  free(triangles);
  free(weight);
  emitters_free(&e);
}

static void shadow_rays_from(bool lifted) {
  size_t wanted = 0;
  make_points();
  for (size_t i = 0; i < COUNT; i++) {
    store(&b->light.ray.d, i, direction());
    b->light.ray.tfar[i] = 5;
    b->light.e[i] = 0.5f;
    if (i % 2) /* a facet that is turned away */
      store(&b->surface.g, i, scaled(load(&b->surface.n, i), -1e-4f));
    store(&b->surface.lift, i, (vec3){between(-2, 2), between(-2, 2), between(-2, 2)});
    b->surface.slack[i] = i % 3 ? 0.0f : INFINITY; /* a facet whose own shadow does not count */
  }
  stages->lit((lane_run){.begin = 0, .end = COUNT}, false, lifted, &b->surface, &b->light);
  for (size_t i = 0; i < COUNT; i++) {
    vec3 l = load(&b->light.ray.d, i), n = load(&b->surface.n, i);
    vec3 p = load(&b->surface.p, i), g = load(&b->surface.g, i), wi = load(&b->light.wi, i);
    vec3 o = load(&b->light.ray.o, i), start = {p.x + g.x, p.y + g.y, p.z + g.z};
    if (lifted) {
      vec3 lift = load(&b->surface.lift, i);
      start = (vec3){start.x + lift.x, start.y + lift.y, start.z + lift.z};
    }
    near3(wi, dot_d(l, load(&b->surface.t, i)), dot_d(l, load(&b->surface.b, i)), dot_d(l, n),
          1e-6);
    near3(o, (double)start.x, (double)start.y, (double)start.z, 1e-6);
    bool sees = (i % 2 == 0 || (lifted && i % 3 == 0)) && dot_d(l, n) > 0;
    near((double)b->light.ray.tfar[i], sees ? 5 : -1, 0);
    wanted += sees;
  }
  b->light.ray.tfar[0] = -INFINITY; /* stopped on its way */
  wanted -= dot_d(load(&b->light.ray.d, 0), load(&b->surface.n, 0)) > 0;
  assert_int_equal(stages->shadow(COUNT, &b->light), wanted);
  near((double)b->light.e[0], 0, 0);
  untouched(b->light.e, COUNT);
}

static void shadow_rays(void **state) {
  (void)state;
  shadow_rays_from(false);
  shadow_rays_from(true);
}

/* A texture of 2 x 2 texels with its rim, as texture.c packs it; a and b by column and row. */
static void pack(uint32_t texel[25], const double a[2][2], const double c[2][2]) {
  for (int y = 0; y < 5; y++)
    for (int x = 0; x < 5; x++) {
      int k = (x + 1) % 2, line = (y + 1) % 2; /* it repeats */
      uint32_t low = (uint32_t)(int32_t)lrint(32767 * a[line][k]) & 0xffffu;
      texel[5 * y + x] = low | (uint32_t)(int32_t)lrint(32767 * c[line][k]) << 16;
    }
}

/* Bilinear over the repeated texels, by definition. */
static double bilinear(const double a[2][2], double u, double v) {
  double x = 2 * u - 0.5, y = 2 * v - 0.5, s = x - floor(x), t = y - floor(y);
  int k = (int)fabs(fmod(floor(x), 2)), line = (int)fabs(fmod(floor(y), 2));
  double low = (1 - s) * a[line][k] + s * a[line][1 - k];
  double high = (1 - s) * a[1 - line][k] + s * a[1 - line][1 - k];
  return (1 - t) * low + t * high;
}

static void nodes(void **state) {
  (void)state;
  const double a[2][2] = {{-1, 0.5}, {0.25, 1}}, c[2][2] = {{0.75, -0.5}, {0, 0.125}};
  const double x[2][2] = {{-0.5, 0.5}, {0.25, 0.5}}, y[2][2] = {{0.5, -0.5}, {0, 0.125}};
  uint32_t color_texel[25], normal_texel[25];
  pack(color_texel, a, c);
  pack(normal_texel, x, y);
  texture two = {.width = 2, .height = 2, .stride = 5, .wrap = WRAP_REPEAT, .linear = 1};
  texture color = two, normal = two;
  color.texel = color_texel;
  normal.texel = normal_texel;
  node image = {
      .type = NODE_IMAGE,
      .of.image = {.out = {3, 4, 5}, .alpha = 6, .red_green = &color, .blue_alpha = &color}};
  node bump = {.type = NODE_NORMAL_MAP, .of.normal_map = {.out = {7, 8, 9}, .normal = &normal}};
  node placed = image;
  placed.of.image.placed = true;
  placed.of.image.at[0] = (operand){.at = 12};
  placed.of.image.at[1] = (operand){.at = OPERAND_NUMBER, .number = 0.3f};
  placed.of.image.out[0] = 10;
  placed.of.image.out[1] = 11;
  segment g = {.run = {.begin = 5, .end = COUNT}};
  make_points();
  b->surface.u[6] = NAN;
  b->surface.v[7] = INFINITY;
  b->surface.u[8] = -1e30f;
  for (size_t i = 0; i < COUNT; i++)
    b->input.at[12][i] = (float)i * 0.01f - 4.0f;
  stages->flat(&g, &b->input);
  assert_true(b->input.at[0][9] == 0 && b->input.at[1][9] == 0 && b->input.at[2][9] == 1);
  stages->node[NODE_IMAGE](&g, &placed, &b->corner, &b->surface, &b->input);
  stages->node[NODE_IMAGE](&g, &image, &b->corner, &b->surface, &b->input);
  stages->node[NODE_NORMAL_MAP](&g, &bump, &b->corner, &b->surface, &b->input);
  for (size_t i = g.run.begin; i < g.run.end; i++) {
    double u = (double)b->surface.u[i], v = (double)b->surface.v[i],
           elsewhere = 0.01 * (double)i - 4;
    vec3 n = {b->input.at[7][i], b->input.at[8][i], b->input.at[9][i]};
    near(dot_d(n, n), 1, 1e-6); /* also where there is no place to look */
    near((double)b->input.at[10][i], 0.5 + 0.5 * bilinear(a, elsewhere, 0.3), 3e-5);
    near((double)b->input.at[11][i], 0.5 + 0.5 * bilinear(c, elsewhere, 0.3), 3e-5);
    if (i >= 6 && i <= 8)
      continue;
    near((double)b->input.at[3][i], 0.5 + 0.5 * bilinear(a, u, v), 3e-5);
    near((double)b->input.at[4][i], 0.5 + 0.5 * bilinear(c, u, v), 3e-5);
    near((double)b->input.at[5][i], 0.5 + 0.5 * bilinear(a, u, v), 3e-5);
    near((double)b->input.at[6][i], 0.5 + 0.5 * bilinear(c, u, v), 3e-5);
    double nx = bilinear(x, u, v), ny = bilinear(y, u, v);
    near3(n, nx * (double)b->surface.side[i], ny * (double)b->corner.handed[i],
          sqrt(1 - nx * nx - ny * ny), 8e-5);
  }
  untouched(b->input.at[7], COUNT);
  const unsigned char *before = (const unsigned char *)b->input.at[3];
  assert_int_equal(before[4 * g.run.begin - 1], SET);
}

/* Cycles' conventions, long-hand: quotients by 0 are 0, and so on. */
static double math_truth(int operation, double a, double c, double d) {
  double h;
  switch (operation) {
  case MATH_ADD:
    return a + c;
  case MATH_SUBTRACT:
    return a - c;
  case MATH_MULTIPLY:
    return a * c;
  case MATH_DIVIDE:
    return c == 0 ? 0 : a / c;
  case MATH_MULTIPLY_ADD:
    return a * c + d;
  case MATH_POWER:
    return a < 0 && c != rint(c) ? 0 : a == 0 && c < 0 ? 0 : pow(a, c);
  case MATH_LOGARITHM:
    return a <= 0 || c <= 0 || c == 1 ? 0 : log(a) / log(c);
  case MATH_SQRT:
    return sqrt(fmax(a, 0));
  case MATH_INVERSE_SQRT:
    return a > 0 ? 1 / sqrt(a) : 0;
  case MATH_ABSOLUTE:
    return fabs(a);
  case MATH_EXPONENT:
    return exp(a);
  case MATH_MINIMUM:
    return fmin(a, c);
  case MATH_MAXIMUM:
    return fmax(a, c);
  case MATH_LESS_THAN:
    return a < c;
  case MATH_GREATER_THAN:
    return a > c;
  case MATH_SIGN:
    return (a > 0) - (a < 0);
  case MATH_COMPARE:
    return fabs(a - c) <= fmax(d, 1.1920929e-7);
  case MATH_SMOOTH_MIN:
    h = d == 0 ? 0 : fmax(d - fabs(a - c), 0) / d;
    return fmin(a, c) - pow(h, 3) * d / 6;
  case MATH_SMOOTH_MAX:
    h = d == 0 ? 0 : fmax(d - fabs(a - c), 0) / d;
    return fmax(a, c) + pow(h, 3) * d / 6;
  case MATH_ROUND:
    return floor(a + 0.5);
  case MATH_FLOOR:
    return floor(a);
  case MATH_CEIL:
    return ceil(a);
  case MATH_TRUNC:
    return trunc(a);
  case MATH_FRACT:
    return a - floor(a);
  case MATH_MODULO:
    return c == 0 ? 0 : fmod(a, c);
  case MATH_FLOORED_MODULO:
    return c == 0 ? 0 : a - c * floor(a / c);
  case MATH_WRAP:
    return c == d ? d : a - (c - d) * floor((a - d) / (c - d));
  case MATH_SNAP:
    return c == 0 ? 0 : floor(a / c) * c;
  case MATH_PINGPONG:
    h = c == 0 ? 0 : (a - c) / (2 * c);
    return c == 0 ? 0 : fabs((h - floor(h)) * 2 * c - c);
  case MATH_SINE:
    return sin(a);
  case MATH_COSINE:
    return cos(a);
  case MATH_TANGENT:
    return tan(a);
  case MATH_ARCSINE:
    return asin(fmax(-1, fmin(1, a)));
  case MATH_ARCCOSINE:
    return acos(fmax(-1, fmin(1, a)));
  case MATH_ARCTANGENT:
    return atan(a);
  case MATH_ARCTAN2:
    return atan2(a, c);
  case MATH_SINH:
    return sinh(a);
  case MATH_COSH:
    return cosh(a);
  case MATH_TANH:
    return tanh(a);
  case MATH_RADIANS:
    return a * 0.017453292519943295;
  case MATH_DEGREES:
    return a * 57.29577951308232;
  case MATH_MIX:
    return (1 - d) * a + d * c;
  case MATH_CLAMP:
    return fmin(fmax(a, c), d);
  }
  fail_msg("operation %d has no truth", operation);
  return 0;
}

/* Every operation on a lattice with its awkward places: 0, whole numbers, equal operands. */
static void math_node(void **state) {
  (void)state;
  static const float step[10] = {-2.5f, -1, -0.75f, -0.3f, 0, 0.2f, 0.6f, 1, 1.75f, 3};
  segment g = {.run = {.begin = 3, .end = 1000}};
  for (size_t i = 0; i < 1000; i++)
    for (size_t k = 0, d = 1; k < 3; k++, d *= 10)
      b->input.at[3 + k][i] = step[i / d % 10];
  for (int operation = 0; operation <= MATH_CLAMP; operation++)
    for (int fixed = 0; fixed < 2; fixed++) {
      node n = {.type = NODE_MATH,
                .of.math = {.operation = operation, .out = 6, .a = {.at = 3}, .b = {.at = 4}}};
      n.of.math.c = fixed ? (operand){.at = OPERAND_NUMBER, .number = 0.2f} : (operand){.at = 5};
      stages->node[NODE_MATH](&g, &n, &b->corner, &b->surface, &b->input);
      for (size_t i = g.run.begin; i < g.run.end; i++) {
        double a = (double)b->input.at[3][i], c = (double)b->input.at[4][i];
        double d = fixed ? (double)0.2f : (double)b->input.at[5][i];
        if (operation == MATH_CLAMP && c > d)
          continue;
        double steps = c == 0 ? 0.5 : a / c, range = c == d ? 0.5 : (a - d) / (c - d);
        double half = c == 0 ? 0.25 : (a - c) / (2 * c);
        bool jumps = operation == MATH_WRAP       ? fabs(range - rint(range)) < 1e-5
                     : operation == MATH_PINGPONG ? fabs(half - rint(half)) < 1e-5
                     : operation == MATH_COMPARE
                         ? fabs(fabs(a - c) - d) < 1e-6 && a != c
                         : fabs(steps - rint(steps)) < 1e-5 && a != 0 &&
                               (operation == MATH_MODULO || operation == MATH_SNAP ||
                                operation == MATH_FLOORED_MODULO);
        double wanted = math_truth(operation, a, c, d), found = (double)b->input.at[6][i];
        if (!jumps && !(fabs(found - wanted) <= 2e-6 * (1 + fabs(wanted))))
          fail_msg("%s: operation %d of %g, %g, %g is %.9g where %.9g is right", stages->name,
                   operation, a, c, d, found, wanted);
      }
    }
  untouched(b->input.at[6], 1000);
}

static double mix_truth(int mode, double t, double a, double c) {
  double h;
  switch (mode) {
  case MIX_MIX:
    return a * (1 - t) + c * t;
  case MIX_DARKEN:
    return a * (1 - t) + fmin(a, c) * t;
  case MIX_MULTIPLY:
    return a * (1 - t + t * c);
  case MIX_BURN:
    h = 1 - t + t * c;
    return h <= 0 ? 0 : fmin(fmax(1 - (1 - a) / h, 0), 1);
  case MIX_LIGHTEN:
    return a * (1 - t) + fmax(a, c) * t;
  case MIX_SCREEN:
    return 1 - (1 - t + t * (1 - c)) * (1 - a);
  case MIX_DODGE:
    h = 1 - t * c;
    return a == 0 ? 0 : h <= 0 ? 1 : fmin(a / h, 1);
  case MIX_ADD:
    return a + t * c;
  case MIX_OVERLAY:
    return a < 0.5 ? a * (1 - t + 2 * t * c) : 1 - (1 - t + 2 * t * (1 - c)) * (1 - a);
  case MIX_SOFT_LIGHT:
    return (1 - t) * a + t * ((1 - a) * c * a + a * (1 - (1 - c) * (1 - a)));
  case MIX_LINEAR_LIGHT:
    return a + t * (2 * c - 1);
  case MIX_DIFFERENCE:
    return a * (1 - t) + t * fabs(a - c);
  case MIX_EXCLUSION:
    return fmax(a * (1 - t) + t * (a + c - 2 * a * c), 0);
  case MIX_SUBTRACT:
    return a - t * c;
  case MIX_DIVIDE:
    return c == 0 ? a : a * (1 - t) + t * a / c;
  }
  fail_msg("mode %d has no truth", mode);
  return 0;
}

static void mix_node(void **state) {
  (void)state;
  static const float step[10] = {-0.5f, 0, 0.125f, 0.25f, 0.375f, 0.5f, 0.75f, 0.875f, 1, 2.5f};
  segment g = {.run = {.begin = 3, .end = 1000}};
  for (size_t i = 0; i < 1000; i++)
    for (size_t k = 0, d = 1; k < 3; k++, d *= 10)
      b->input.at[3 + k][i] = k ? step[i / d % 10] : (float)(i % 10) / 9;
  for (int mode = 0; mode <= MIX_DIVIDE; mode++) {
    node n = {
        .type = NODE_MIX,
        .of.mix = {.mode = mode, .out = 3, .factor = {.at = 3}, .a = {.at = 4}, .b = {.at = 5}}};
    lane_f factor;
    memcpy(factor, b->input.at[3], sizeof factor);
    stages->node[NODE_MIX](&g, &n, &b->corner, &b->surface, &b->input); /* in place */
    for (size_t i = g.run.begin; i < g.run.end; i++)
      near((double)b->input.at[3][i],
           mix_truth(mode, (double)factor[i], (double)b->input.at[4][i], (double)b->input.at[5][i]),
           1e-5);
    memcpy(b->input.at[3], factor, sizeof factor);
  }
}

static void metal_and_reflection(void **state) {
  (void)state;
  closure m = {.type = CLOSURE_METAL};
  closure_metal *metal = &m.of.metal;
  shade_params_init(&metal->params);
  metal->params.ex = 40;
  metal->params.ey = 5;
  shade_bsdf_setup(&metal->bsdf, &metal->params);
  for (int k = 0; k < 3; k++) {
    metal->f0[k] = metal->kd[k] = metal->f82[k] = metal->eta[k] = (operand){.at = OPERAND_NUMBER};
    metal->normal[k] = 3 + k;
  }
  metal->ax = metal->ay = (operand){.at = OPERAND_NUMBER};
  segment g = {.run = {.begin = 17, .end = COUNT}};
  for (size_t i = 0; i < COUNT; i++) {
    vec3 up[3];
    for (int k = 0; k < 3; k++) {
      up[k] = direction();
      up[k].z = fabsf(up[k].z);
    }
    b->input.at[3][i] = up[0].x;
    b->input.at[4][i] = up[0].y;
    b->input.at[5][i] = up[0].z;
    store(&b->light.wi, i, up[1]);
    store(&b->surface.wo, i, up[2]);
    b->light.e[i] = 0.5f;
    b->sum.r[i] = b->sum.g[i] = b->sum.b[i] = 1;
  }
  assert_int_equal(stages->closure[CLOSURE_METAL](&m, g.run, &b->surface, &b->input, &b->light.wi,
                                                  false, &b->reflection),
                   0);
  untouched(b->reflection.pdf, 0); /* not asked for */
  assert_int_equal(stages->closure[CLOSURE_METAL](&m, g.run, &b->surface, &b->input, &b->light.wi,
                                                  true, &b->reflection),
                   0);
  stages->reflect(COUNT, (const float[]){1, 2, 4}, false, &b->light, &b->reflection, &b->sum);
  for (size_t i = g.run.begin; i < COUNT; i++) {
    double dir[3][3], f[3], cosine;
    const lane_v *from[3] = {NULL, &b->light.wi, &b->surface.wo};
    for (int k = 0; k < 3; k++) {
      dir[0][k] = (double)b->input.at[3 + k][i];
      if (k) {
        dir[k][0] = (double)from[k]->x[i];
        dir[k][1] = (double)from[k]->y[i];
        dir[k][2] = (double)from[k]->z[i];
      }
    }
    shade_bsdf_eval(&metal->bsdf, dir[0], dir[1], dir[2], f, &cosine);
    double pdf = shade_bsdf_pdf(&metal->bsdf, dir[0], dir[1], dir[2], NULL);
    near((double)b->reflection.pdf[i], pdf, 1e-6 + 1e-3 * pdf);
    for (int k = 0; k < 3; k++) {
      const lane_f *part[3] = {&b->sum.r, &b->sum.g, &b->sum.b};
      double wanted = f[k] * cosine * 0.5 * (1 << k);
      near((double)(*part[k])[i], 1 + wanted, 1e-6 + 1e-3 * wanted);
    }
  }
  untouched(b->reflection.f.r, COUNT);
  untouched(b->reflection.pdf, COUNT);

  /* a matt body alone, by the shorter way; a register of its colour */
  shade_params_init(&metal->params);
  metal->params.fresnel = SHADE_FRESNEL_NONE;
  for (int k = 0; k < 3; k++) {
    metal->params.kd[k] = 0.3 * k;
    metal->params.f0[k] = 0;
  }
  shade_bsdf_setup(&metal->bsdf, &metal->params);
  metal->kd[1] = (operand){.at = 6};
  metal->matt = true;
  for (size_t i = 0; i < COUNT; i++) {
    store(&b->light.wi, i, direction());
    b->input.at[6][i] = i % 5 ? between(-0.2, 1.2) : NAN;
  }
  stages->closure[CLOSURE_METAL](&m, g.run, &b->surface, &b->input, &b->light.wi, true,
                                 &b->reflection);
  for (size_t i = g.run.begin; i < COUNT; i++) {
    const double z[3] = {0, 0, 1};
    vec3 v = load(&b->surface.wo, i), l = load(&b->light.wi, i);
    double wi[3] = {(double)l.x, (double)l.y, (double)l.z}, f[3], cosine;
    double wo[3] = {(double)v.x, (double)v.y, (double)v.z};
    double green = i % 5 ? fmin(fmax((double)b->input.at[6][i], 0), 1) : 0.3;
    shade_bsdf_eval(&metal->bsdf, z, wi, wo, f, &cosine);
    double pdf = shade_bsdf_pdf(&metal->bsdf, z, wi, wo, NULL);
    const lane_c *found = &b->reflection.f;
    near((double)b->reflection.pdf[i], pdf, 1e-5);
    near((double)(found->r[i] * b->reflection.cosine[i]), f[0] * cosine, 1e-6);
    near((double)(found->g[i] * b->reflection.cosine[i]), f[1] * cosine * green / 0.3, 1e-5);
    near((double)(found->b[i] * b->reflection.cosine[i]), f[2] * cosine, 1e-6);
  }
}

/* A cloth that lets light through, from near (one term of its footprint) and from afar. */
static void make_cloth(bool far, closure *c) {
  static cloth denim;
  if (!denim.fabric) {
    assert_int_equal(shade_preset_find("denim", &denim.preset), 1);
    for (int k = 0; k < 3; k++)
      denim.preset.fabric.warp_transmit[k] = denim.preset.fabric.weft_transmit[k] = 0.2;
    denim.through = true;
    denim.fabric = shade_preset_fabric(&denim.preset, &denim.weave, NULL);
    assert_non_null(denim.fabric);
  }
  *c = (closure){.type = CLOSURE_FABRIC};
  c->of.fabric.use = (cloth_use){.cloth = &denim, .normal = {3, 4, 5}};
  for (int k = 0; k < 4; k++)
    c->of.fabric.use.place[k] = (operand){.at = 6 + k};
  for (int k = 0; k < 3; k++)
    c->of.fabric.use.warp[k] = c->of.fabric.use.weft[k] = (operand){.at = OPERAND_NUMBER};
  b->input.single = true;
  b->input.beside = false;
  b->input.cloth = NULL;
  for (size_t i = 0; i < BATCH; i++) {
    b->input.at[6][i] = 3.3f;
    b->input.at[7][i] = 5.4f;
    b->input.at[8][i] = b->input.at[9][i] = far ? 20.0f : 0.3f;
    b->input.term[i] = 0.6f;
  }
}

/* The closures that are no metals, by number; false past their end. */
static bool closure_by(int number, closure *c) {
  const operand half = {.at = OPERAND_NUMBER, .number = 0.5f};
  memset(c, 0, sizeof *c);
  if (number == 11 || number == 12) {
    make_cloth(number == 12, c);
    return true;
  }
  if (number == 22) {
    c->type = CLOSURE_METAL;
    c->of.metal.matt = true;
    for (int k = 0; k < 3; k++)
      c->of.metal.kd[k] = half;
    return true;
  }
  if (number == 23 || number == 24) { /* about the normal; about the mirror image */
    c->type = CLOSURE_TOON;
    c->of.toon =
        (closure_toon){.mirrors = number == 24, .normal = {3, 4, 5}, .size = half, .smooth = half};
    return true;
  }
  if (number == 14) {
    c->type = CLOSURE_COAT;
    c->of.coat = (closure_coat){.normal = {3, 4, 5}, .alpha = half};
    return true;
  }
  if (number == 25) { /* on through a pane */
    closure_by(7, c);
    c->of.glass.straight = true;
    return true;
  }
  if (number > 17) { /* as those of GGX */
    closure_by(number - 13, c);
    c->of.glass.beckmann = true;
    return number < 22;
  }
  if (number > 14) {
    c->type = CLOSURE_SHEEN;
    c->of.sheen = (closure_sheen){.model = number - 15,
                                  .normal = {3, 4, 5},
                                  .sigma = half,
                                  .a = half,
                                  .b = {.at = OPERAND_NUMBER, .number = -0.7f}};
    return number < 18;
  }
  if (number < 4) {
    c->type = CLOSURE_DIFFUSE;
    c->of.diffuse = (closure_diffuse){
        .model = number, .normal = {3, 4, 5}, .color = {half, half, half}, .roughness = half};
  } else if (number == 4) {
    c->type = CLOSURE_TRANSLUCENT;
    c->of.translucent = (closure_translucent){.normal = {3, 4, 5}};
  } else {
    c->type = CLOSURE_GLASS;
    c->of.glass = (closure_glass){.normal = {3, 4, 5},
                                  .ior = {.at = OPERAND_NUMBER, .number = 1.5f},
                                  .alpha = half,
                                  .tint = {half, half, half},
                                  .reflects = number % 3 != 0 || number == 13,
                                  .refracts = number % 3 != 1 || number == 13,
                                  .joint = number % 2,
                                  .flat = number == 13};
  }
  return number < 14;
}

/* The same light, eye and normal for all points. */
static void make_meeting(vec3 n, vec3 wo, float side) {
  for (size_t i = 0; i < BATCH; i++) {
    b->input.at[3][i] = n.x;
    b->input.at[4][i] = n.y;
    b->input.at[5][i] = n.z;
    store(&b->surface.wo, i, wo);
    b->surface.side[i] = side;
  }
}

enum { RINGS = 8, SECTORS = 8, CELLS = 2 * RINGS * SECTORS };
static size_t cell_of(vec3 d) {
  double around = (atan2((double)d.y, (double)d.x) / 6.283185307179586 + 1) * SECTORS;
  size_t ring = (size_t)fmin(((double)d.z + 1) * RINGS, 2 * RINGS - 1);
  return ring * SECTORS + (size_t)around % SECTORS;
}

/* Draws fill the sphere as their density says (chi-square over cells of equal area), f and density
 * of a draw are those of its direction, and no more leaves than came. */
static void closures_draw_by_their_density(void **state) {
  (void)state;
  enum { ROUNDS = 60 / FEWER, FINE = 12 };
#define TRAITS_OF(TYPE, name, always) [CLOSURE_##TYPE] = (always),
  const unsigned traits[CLOSURE_TYPES] = {CLOSURE_TABLE(TRAITS_OF)};
  const lane_run run = {.begin = 0, .end = 1000};
  bool met[CLOSURE_TYPES] = {false};
  closure c;
  for (int number = 0; closure_by(number, &c); number++)
    met[c.type] = true;
  for (int type = 0; type < CLOSURE_TYPES; type++)
    if ((traits[type] & CLOSURE_SCATTERS) && !met[type])
      fail_msg("closure %d of closure/table.h is not in closure_by", type);
  for (int number = 0; closure_by(number, &c); number++)
    for (int tilted = 0; tilted < 2; tilted++) {
      vec3 n = tilted ? (vec3){0.28f, -0.1f, 0} : (vec3){0, 0, 1}, wo = {0.6f, 0, 0.8f};
      n.z = sqrtf(1 - n.x * n.x - n.y * n.y);
      make_meeting(n, wo, tilted ? -1.0f : 1.0f);
      double found[CELLS + 1] = {0}, wanted[CELLS + 1] = {0}, chi2 = 0, albedo = 0;
      for (int round = 0; round < ROUNDS; round++) {
        for (size_t i = 0; i < run.end; i++) {
          b->draw.x[i] = between(0, 1);
          b->draw.y[i] = between(0, 1);
          b->draw.choice[i] = between(0, 1);
        }
        stages->draw[c.type](&c, run, &b->surface, &b->input, &b->draw);
        stages->closure[c.type](&c, run, &b->surface, &b->input, &b->draw.wi, true, &b->reflection);
        for (size_t i = 0; i < run.end; i++) {
          double pdf = (double)b->draw.pdf[i], cosine = (double)b->draw.cosine[i];
          found[pdf > 0 ? cell_of(load(&b->draw.wi, i)) : CELLS] += 1;
          if (!(pdf > 0))
            continue;
          double f = (double)b->draw.f.g[i] * cosine;
          double same = (double)b->reflection.f.g[i] * (double)b->reflection.cosine[i];
          near(f, same, 2e-3 * f + 1e-6);
          near(pdf, (double)b->reflection.pdf[i], 2e-3 * pdf + 1e-6);
          albedo += f / pdf / (ROUNDS * (double)run.end);
        }
      }
      for (size_t cell = 0; cell < CELLS; cell++) {
        for (size_t k = 0; k < FINE * FINE; k++) {
          double z = -1 + ((double)(cell / SECTORS) + ((double)(k % FINE) + 0.5) / FINE) / RINGS;
          double turns = ((double)(cell % SECTORS) + ((double)(k / FINE) + 0.5) / FINE) / SECTORS;
          double r = sqrt(1 - z * z);
          store(&b->light.wi, k,
                (vec3){(float)(r * cos(6.283185307179586 * turns)),
                       (float)(r * sin(6.283185307179586 * turns)), (float)z});
        }
        stages->closure[c.type](&c, (lane_run){.end = FINE * FINE}, &b->surface, &b->input,
                                &b->light.wi, true, &b->reflection);
        for (size_t k = 0; k < FINE * FINE; k++)
          wanted[cell] += (double)b->reflection.pdf[k] * 12.566370614359172 / CELLS / FINE / FINE;
        wanted[CELLS] += wanted[cell];
      }
      assert_true(wanted[CELLS] < 1.01 && albedo < 1.02);
      wanted[CELLS] = 1 - wanted[CELLS]; /* nothing is drawn */
      double all = ROUNDS * (double)run.end, rest_found = 0, rest_wanted = 0;
      int cells = 0;
      for (size_t cell = 0; cell <= CELLS; cell++) {
        double expected = all * wanted[cell];
        if (expected < 50) { /* rare ones together */
          rest_found += found[cell];
          rest_wanted += expected;
          continue;
        }
        chi2 += pow(found[cell] - expected, 2) / (expected + 1e-5 * expected * expected);
        cells++;
      }
      near(rest_found, rest_wanted, 6 * sqrt(fmax(rest_wanted, 0) + 1) + 2e-3 * all);
      if (!(chi2 < cells + 4 * sqrt(2.0 * cells) + 10))
        fail_msg("%s: closure %d, tilted %d: chi-square %g over %d cells", stages->name, number,
                 tilted, chi2, cells);
    }
}

/* Draws that are aimed at balls fill the sphere as their density says, which lets none get lost;
 * whatever they are worth, they add up to the integral. Of the balls one is high, one half sunk,
 * one around the point and one too small. */
static void matt_draws_are_aimed(void **state) {
  (void)state;
  enum { ROUNDS = 80, FINE = 31 };
  const aims aims = {
      .count = 4,
      .ball = {{{5, 4, 3}, 9.0f}, {{0, 1, 3}, 0.7f}, {{3, 0, 0.2f}, 1.2f}, {{1, 1, 4}, 1e-2f}}};
  const lane_run run = {.begin = 0, .end = 1000}, fine = {.begin = 0, .end = FINE * FINE};
  const vec3 wo = {0.6f, 0, 0.8f};
  closure c;
  closure_by(0, &c);
  make_meeting((vec3){0, 0, 1}, wo, 1.0f);
  for (size_t i = 0; i < BATCH; i++) {
    store(&b->surface.p, i, (vec3){0, 0, 0});
    store(&b->surface.t, i, (vec3){1, 0, 0});
    store(&b->surface.b, i, (vec3){0, 1, 0});
    store(&b->surface.n, i, (vec3){0, 0, 1});
  }
  stages->aim((lane_run){.end = BATCH}, &aims, &b->surface, &b->cones);
  near((double)b->cones.density[0][7], 0, 0);
  near((double)b->cones.density[3][7], 0, 0);
  assert_true(b->cones.density[1][7] > 1 && b->cones.density[2][7] > 0.1f);
  assert_true(b->cones.rest[7] > 0.7f && b->cones.rest[7] < 0.95f);
  double found[CELLS] = {0}, wanted[CELLS] = {0}, all = ROUNDS * (double)run.end, sum[3] = {0},
         chi2 = 0;
  size_t aimed = 0;
  for (int round = 0; round < ROUNDS; round++) {
    for (size_t i = 0; i < run.end; i++) {
      b->draw.x[i] = between(0, 1);
      b->draw.y[i] = between(0, 1);
    }
    stages->aim_pick(run, aims.count, &b->cones, &b->draw);
    stages->draw[c.type](&c, run, &b->surface, &b->input, &b->draw);
    stages->aim_turn(run, aims.count, &b->cones, &b->draw);
    stages->closure[c.type](&c, run, &b->surface, &b->input, &b->draw.wi, true, &b->part);
    stages->aim_take(run, &b->part, &b->draw);
    stages->aim_mix(run, aims.count, &b->cones, &b->draw.wi, b->draw.pdf);
    for (size_t i = 0; i < run.end; i++) {
      vec3 wi = load(&b->draw.wi, i), toward = {0, 0.316227766f, 0.948683298f};
      double f = (double)b->draw.f.g[i] * (double)b->draw.cosine[i];
      bool inside = acos(fmin(dot_d(wi, toward), 1)) < asin(0.7 / sqrt(10));
      near(dot_d(wi, wi), 1, 1e-5);
      near(f, wi.z > 0 ? 0.5 / 3.141592653589793 * (double)wi.z : 0, 1e-6);
      near((double)b->draw.own[i], 2 * f, 1e-5);
      assert_true(b->draw.pdf[i] > 0);
      found[cell_of(wi)] += 1;
      aimed += b->cones.drawn[i] != CONE_NONE;
      sum[0] += f / (double)b->draw.pdf[i] / all;
      sum[1] += (double)wi.z * f / (double)b->draw.pdf[i] / all;
      sum[2] += inside ? f / (double)b->draw.pdf[i] / all : 0;
    }
  }
  near((double)aimed / all, 1 - (double)b->cones.rest[7], 0.006);
  near(sum[0], 0.5, 0.005); /* of the hemisphere; times the cosine; of the ball: sine² cosine */
  near(sum[1], 1.0 / 3, 0.004);
  near(sum[2], 0.5 * 0.049 * 0.948683298, 0.001);
  for (size_t cell = 0; cell < CELLS; cell++) {
    for (size_t k = 0; k < fine.end; k++) {
      double z = -1 + ((double)(cell / SECTORS) + ((double)(k % FINE) + 0.5) / FINE) / RINGS;
      double turns = ((double)(cell % SECTORS) + ((double)(k / FINE) + 0.5) / FINE) / SECTORS;
      double r = sqrt(1 - z * z), around = 6.283185307179586 * turns;
      store(&b->light.wi, k, (vec3){(float)(r * cos(around)), (float)(r * sin(around)), (float)z});
      b->reflection.pdf[k] = (float)(fmax(z, 0) / 3.141592653589793);
    }
    stages->aim_mix(fine, aims.count, &b->cones, &b->light.wi, b->reflection.pdf);
    for (size_t k = 0; k < fine.end; k++)
      wanted[cell] += (double)b->reflection.pdf[k] * 12.566370614359172 / CELLS / FINE / FINE;
  }
  double whole = 0;
  int cells = 0;
  for (size_t cell = 0; cell < CELLS; cell++) {
    double expected = all * wanted[cell];
    whole += wanted[cell];
    if (expected < 50)
      continue;
    chi2 += pow(found[cell] - expected, 2) / (expected + 1e-4 * expected * expected);
    cells++;
  }
  near(whole, 1, 0.005);
  if (!(chi2 < cells + 4 * sqrt(2.0 * cells) + 10))
    fail_msg("%s: chi-square %g over %d cells", stages->name, chi2, cells);
}

/* What goes one way goes the other: matt models, and reflection at glass. */
static void closures_are_reciprocal(void **state) {
  (void)state;
  closure c;
  const lane_run run = {.begin = 0, .end = 500};
  for (int number = 0; closure_by(number, &c); number++) {
    if (number == 4 || (number > 10 && number < 18) || c.type == CLOSURE_TOON)
      continue;
    make_meeting((vec3){0, 0, 1}, (vec3){0, 0, 1}, 1.0f);
    for (size_t i = 0; i < run.end; i++) {
      vec3 one = direction(), other = direction();
      one.z = fabsf(one.z) + 1e-3f;
      other.z = fabsf(other.z) + 1e-3f;
      store(&b->surface.wo, i, scaled(one, 1 / sqrtf(dot(one, one))));
      store(&b->light.wi, i, scaled(other, 1 / sqrtf(dot(other, other))));
    }
    stages->closure[c.type](&c, run, &b->surface, &b->input, &b->light.wi, true, &b->reflection);
    lane_f forward;
    for (size_t i = 0; i < run.end; i++) {
      bool in_f = c.type == CLOSURE_GLASS; /* its f holds the cosine */
      forward[i] = b->reflection.f.r[i] / (in_f ? b->light.wi.z[i] : 1.0f);
      vec3 swapped = load(&b->surface.wo, i);
      store(&b->surface.wo, i, load(&b->light.wi, i));
      store(&b->light.wi, i, swapped);
    }
    stages->closure[c.type](&c, run, &b->surface, &b->input, &b->light.wi, true, &b->reflection);
    for (size_t i = 0; i < run.end; i++) {
      bool in_f = c.type == CLOSURE_GLASS;
      double back = (double)(b->reflection.f.r[i] / (in_f ? b->light.wi.z[i] : 1.0f));
      near(back, (double)forward[i], 1e-3 * fabs(back) + 1e-5);
    }
  }
}

static void film(void **state) {
  (void)state;
  enum { FEWEST = 4 };
  static const uint32_t cases[][2] = {{7, 3}, {4, 0}, {4, 2}, {12, 5}, {12, 24}, {64, 10}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const uint32_t samples = cases[c][0], first = cases[c][1];
    float pixels[4 * (COUNT / FEWEST + 8)] = {0}, half[3 * (COUNT / FEWEST + 8)] = {0};
    camera_view view = {.first = first, .samples = samples};
    double wanted[4 * (COUNT / FEWEST + 8)] = {0}, early[3 * (COUNT / FEWEST + 8)] = {0};
    for (size_t i = 0; i < COUNT; i++) {
      float value[4] = {between(0, 1), between(0, 9), between(-1, 1), (float)(i % 2)};
      b->sum.r[i] = value[0];
      b->sum.g[i] = value[1];
      b->sum.b[i] = value[2];
      b->path.alpha[i] = value[3];
      for (size_t k = 0; k < 4; k++)
        wanted[4 * ((first + i) / samples) + k] += (double)value[k];
      for (size_t k = 0; k < 3; k++)
        early[3 * ((first + i) / samples) + k] +=
            (first + i) % samples < samples / 2 ? (double)value[k] : 0;
    }
    stages->film(COUNT, &view, &b->sum, &b->path, pixels, half);
    for (size_t k = 0; k < sizeof pixels / sizeof *pixels; k++)
      near((double)pixels[k], wanted[k], 1e-6 * fabs(wanted[k]) + 1e-5);
    for (size_t k = 0; k < sizeof half / sizeof *half; k++)
      near((double)half[k], early[k], 1e-6 * fabs(early[k]) + 1e-5);
  }
}

/*
 * 1024 samples of one pixel: each purpose alone fills every elementary square of a (0, 2)-net, and
 * no two purposes have to do with each other (chi-square, 225 degrees of freedom: 300 is beyond
 * 1 in 1000, and points that share their order give 15 000).
 */
static void shuffled_points(void **state) {
  (void)state;
  enum { POINTS = BATCH, BITS = 10, SIDE = 16, PURPOSES = 3 };
  sampling_plan plan;
  assert_true(sampling_init(&plan, POINTS, NULL, BATCH, FILTER_BLACKMAN_HARRIS, 0.0f));
  static uint32_t number[POINTS]; /* as the passes give them, one after the other */
  uint32_t *next = number;
  for (const sampling *pass = plan.pass; pass < plan.pass + plan.passes; next += pass++->period)
    memcpy(next, pass->point[0], pass->period * sizeof *next);
  assert_ptr_equal(next, number + POINTS);
  const sampling p = plan.pass[plan.passes - 1];
  assert_int_equal(p.mask, POINTS - 1);
  static lane_f x[PURPOSES], y[PURPOSES];
  b->state = &b->path_states[0];
  for (uint32_t i = 0; i < POINTS; i++) {
    b->path.hash[i] = 0x1234567u;
    b->state->sample[i] = i;
    b->queue.moved[i] = i;
  }
  for (uint32_t k = 0; k < PURPOSES; k++) {
    shuffle points = {
        .index = number, .reverse = p.reverse, .mask = p.mask, .salt = 77u + 0x9e3779b9u * k};
    stages->shuffled(POINTS, &points, b->queue.moved, b->state, &b->path, x[k], y[k]);
    for (int wide = 0; wide <= BITS; wide++) {
      static unsigned char seen[POINTS];
      memset(seen, 0, sizeof seen);
      for (int i = 0; i < POINTS; i++) {
        assert_true(x[k][i] >= 0 && x[k][i] < 1 && y[k][i] >= 0 && y[k][i] < 1);
        int column = (int)(x[k][i] * (float)(1 << wide));
        int line = (int)(y[k][i] * (float)(1 << (BITS - wide)));
        seen[(line << wide) + column]++;
      }
      for (int i = 0; i < POINTS; i++)
        assert_int_equal(seen[i], 1);
    }
  }
  for (int k = 0; k < PURPOSES; k++)
    for (int axis = 0; axis < 2; axis++) {
      const float *other = axis ? y[(k + 1) % PURPOSES] : x[(k + 1) % PURPOSES];
      int cell[SIDE * SIDE] = {0};
      double chi2 = 0;
      for (int i = 0; i < POINTS; i++)
        cell[(int)(x[k][i] * SIDE) * SIDE + (int)(other[i] * SIDE)]++;
      for (int c = 0; c < SIDE * SIDE; c++)
        chi2 += pow(cell[c] - POINTS / (double)(SIDE * SIDE), 2) / (POINTS / (double)(SIDE * SIDE));
      assert_true(chi2 < 300);
    }
  sampling_free(&plan);
}

/* Which paths go on, where to and with what weight; and what they bring to their samples. */
static void paths_go_on(void **state) {
  (void)state;
  make_points();
  b->state = &b->path_states[0];
  b->next = &b->path_states[1];
  for (uint32_t i = 0; i < COUNT; i++) {
    b->queue.moved[i] = i * 7 % COUNT;
    b->state->sample[i] = COUNT - 1 - i;
    b->state->throughput.r[i] = between(0, 1);
    b->state->throughput.g[i] = b->state->throughput.b[i] = 0.5f;
    vec3 wi = direction();
    store(&b->draw.wi, i, wi);
    b->draw.f.r[i] = b->draw.f.g[i] = b->draw.f.b[i] = between(0, 2);
    b->draw.pdf[i] = i % 5 ? between(0.1, 3) : 0.0f;
    b->draw.own[i] = b->draw.pdf[i] * (i % 4 ? 1.0f : 0.5f);
    b->draw.cosine[i] = fabsf(wi.z);
    b->draw.roulette[i] = between(0, 1);
    b->draw.kind[i] = wi.z < 0 ? BOUNCE_TRANSMISSION | (i % 2 ? BOUNCE_MATT : 0)
                      : i % 3  ? i % 2
                               : BOUNCE_TRANSPARENT;
    for (uint32_t k = 0; k < BOUNCE_KINDS; k++)
      b->state->bounces[k][i] = (i >> k) % 3;
    b->state->ends[i] = i % 11 == 0;
    b->state->ray[i] = i % 2 ? RAY_CAMERA : RAY_GLOSSY;
    b->state->pdf[i] = 7.0f;
    b->state->lights[i] = 8.0f;
    store(&b->state->from, i, (vec3){4, 5, 6});
    b->weight.total[i] = (float)i;
  }
  batch *before = malloc(sizeof *before);
  assert_non_null(before);
  const bounce_limits limits = {.kind = {2, 1, 2, 1}, .all = 4};
  for (int roulette = 0; roulette < 2; roulette++) {
    memcpy(before, b, sizeof *b);
    size_t rays = stages->next_paths(COUNT, roulette, &limits, roulette, b->queue.moved,
                                     &b->surface, b->state, b->weight.total, &b->draw,
                                     &b->moved_ray, b->chosen, b->next, &b->sample_ray);
    size_t k = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
      uint32_t from = before->queue.moved[i];
      vec3 wi = load(&before->draw.wi, i);
      double pdf = (double)before->draw.pdf[i];
      if (pdf <= 0)
        continue;
      uint32_t kind = before->draw.kind[i] & BOUNCE_MASK, made[BOUNCE_KINDS], all = 0;
      bool within = true;
      for (uint32_t c = 0; c < BOUNCE_KINDS; c++) {
        made[c] = before->path_states[0].bounces[c][from] + (c == kind);
        within = within && made[c] <= limits.kind[c];
        all += c == BOUNCE_TRANSPARENT ? 0 : made[c];
      }
      within = within && all <= limits.all;
      bool straight = kind == BOUNCE_TRANSPARENT; /* for lights, through one surface more */
      if (made[BOUNCE_TRANSPARENT] > limits.kind[BOUNCE_TRANSPARENT] + 1 || !(within || roulette) ||
          (before->path_states[0].ends[from] && !straight))
        continue;
      double scale = (double)before->draw.f.r[i] * (double)before->draw.cosine[i] / pdf;
      double red = scale * (double)before->path_states[0].throughput.r[from], green = scale * 0.5;
      double most = fmax(red, green) * (i % 4 ? 1 : 2);
      double chance = roulette && most < 1 ? sqrt(most) : 1;
      if (fabs((double)before->draw.roulette[i] - chance) < 1e-5 || fabsf(wi.z) < 1e-5f)
        fail_msg("choose another seed: rounding decides");
      if ((double)before->draw.roulette[i] >= chance)
        continue;
      assert_int_equal(b->next->sample[k], before->path_states[0].sample[from]);
      near((double)b->next->throughput.r[k], red / chance, 1e-5 * (1 + red / chance));
      near((double)b->next->throughput.b[k], green / chance, 1e-5 * (1 + green / chance));
      near((double)b->next->pdf[k], straight ? 7 : pdf, 0);
      near((double)b->next->lights[k], straight ? 8 : (double)i, 0);
      vec3 from_there = straight ? (vec3){4, 5, 6} : load(&b->surface.p, i);
      near3(load(&b->next->from, k), (double)from_there.x, (double)from_there.y,
            (double)from_there.z, 0);
      uint32_t through = RAY_TRANSMISSION | (i % 2 ? (uint32_t)RAY_DIFFUSE : 0);
      assert_int_equal(b->next->ray[k], straight ? from % 2 ? RAY_CAMERA : RAY_GLOSSY
                                        : kind == BOUNCE_DIFFUSE ? RAY_DIFFUSE
                                        : kind == BOUNCE_GLOSSY  ? RAY_GLOSSY
                                                                 : through);
      vec3 n = load(&b->surface.n, i), p = load(&b->surface.p, i), d = load(&b->sample_ray.d, k);
      near(dot_d(d, n), (double)wi.z, 1e-6);
      near(dot_d(d, load(&b->surface.t, i)), (double)wi.x, 1e-6);
      double off = wi.z < 0 ? -1e-4 : 1e-4; /* make_points: the facet is the surface */
      near((double)b->sample_ray.o.x[k], (double)p.x + off * (double)n.x, 1e-6);
      assert_int_equal(b->next->ends[k] != 0, !within);
      for (uint32_t c = 0; c < BOUNCE_KINDS; c++)
        assert_int_equal(b->next->bounces[c][k], made[c]);
      near((double)b->sample_ray.tnear[k], 0, 0);
      assert_true(b->sample_ray.tfar[k] == INFINITY);
      k++;
    }
    assert_int_equal(rays, k);
    assert_true(rays > 100 && rays < COUNT / 2);
    untouched(b->next->sample, COUNT);
    memcpy(b->draw.f.r, before->draw.f.r, 3 * sizeof(lane_f));
    memcpy(b->draw.kind, before->draw.kind, sizeof(lane_u));
    b->queue = before->queue;
  }
  free(before);
  for (uint32_t i = 0; i < COUNT; i++) {
    b->sum.r[i] = (float)i;
    b->sum.g[i] = b->sum.b[i] = 1.0f;
    b->sample_color.r[i] = b->sample_color.g[i] = b->sample_color.b[i] = 2.0f;
    b->sample_hit.record[i] = i % 2 ? RECORD_MISS : 3;
  }
  b->sum.r[COUNT - 1] = INFINITY; /* becomes as bright as may be */
  b->sum.g[COUNT - 1] = 1;
  const float sky[3] = {1, 2, 3}, most[2] = {INFINITY, 5};
  for (uint32_t i = 0; i < COUNT; i++) /* after two bounces, and many passages */
    for (uint32_t k = 0; k < BOUNCE_KINDS; k++)
      b->state->bounces[k][i] = k < 2 ? 1 : k == BOUNCE_TRANSPARENT ? 9 : 0;
  stages->gain(COUNT, most, 1, b->queue.moved, b->state, &b->sum, &b->sample_color);
  for (uint32_t i = 0; i < COUNT; i++)
    b->state->ray[i] = i % 6 == 1   ? RAY_GLOSSY
                       : i % 6 == 3 ? RAY_CAMERA
                                    : RAY_DIFFUSE | RAY_TRANSMISSION;
  const float backdrop[3] = {2 * sky[0], 3 * sky[1], 4 * sky[2]}; /* what the camera's rays see */
  stages->escape(COUNT, b->sample_hit.record, b->state, RAY_CAMERA | RAY_GLOSSY, sky, backdrop,
                 &b->emitted);
  untouched(b->emitted.r, COUNT);
  for (uint32_t i = 0; i < COUNT; i++)
    b->queue.identity[i] = i;
  stages->gain(COUNT, most, 2, b->queue.identity, b->state, &b->emitted, &b->sample_color);
  for (uint32_t i = 0; i < COUNT; i++) {
    uint32_t ray = b->queue.moved[i];
    double w = (double)b->state->throughput.r[ray], mean = (w * i + 1) / 3,
           dim = mean > 5 ? 5 / mean : 1;
    bool camera = ray % 6 == 3, missed = camera || ray % 6 == 5;
    uint32_t sample = b->state->sample[ray];
    if (i == COUNT - 1) {
      near((double)b->sample_color.r[sample], 2 + 15 + (missed ? (camera ? 2 : 1) * w : 0), 1e-3);
      continue;
    }
    near((double)b->sample_color.r[sample], 2 + dim * w * i + (missed ? (camera ? 2 : 1) * w : 0),
         1e-3);
    near((double)b->sample_color.g[sample], 2 + dim * 0.5 + (missed ? (camera ? 3 : 1) * 1.0 : 0),
         1e-5);
    near((double)b->sample_color.b[sample], 2 + dim * 0.5 + (missed ? (camera ? 4 : 1) * 1.5 : 0),
         1e-5);
  }
}

/* Of a large texture what is in memory, and that it is the same after it was not. */
static void large_textures_leave_memory(void **state) {
  enum { SIDE = 4200, MEGABYTE = 1 << 20 };
  uint8_t *bytes = malloc((size_t)SIDE * SIDE);
  const atomic_bool cancel = false;
  texture_set set = {0};
  (void)state;
  assert_non_null(bytes);
  for (size_t i = 0; i < (size_t)SIDE * SIDE; i++)
    bytes[i] = (uint8_t)(i % 251);
  image grey = {.width = SIDE, .height = SIDE, .channels = 1, .type = IMAGE_UINT8, .data = bytes};
  const texture *t = texture_request(&set, &grey, TEXTURE_BYTES, 1.0f, COARSE_NONE);
  assert_non_null(t);
  assert_true(texture_pack(&set, 2, &cancel));
  if (!t->paged) { /* there is no disk for it */
    texture_free(&set);
    free(bytes);
    skip();
  }
  assert_int_equal(set.paged, t->paged);
  for (int round = 0; round < 2; round++) {
    for (size_t y = 0; y < SIDE; y++)
      for (size_t x = 0; x < SIDE; x += 7)
        assert_int_equal(t->texel[(y + 1) * (size_t)t->stride + x + 1] & 255u, bytes[y * SIDE + x]);
    texture_relieve(&set, t->paged); /* all of it may stay */
    assert_in_range(pages_resident(), set.other + 60 * MEGABYTE, set.other + 80 * MEGABYTE);
    texture_relieve(&set, 32 * MEGABYTE);
    assert_in_range(pages_resident(), 0, set.other + 8 * MEGABYTE);
  }
  texture_free(&set);
  free(bytes);
}

/* Of a footprint: rays of its plate and of its scratches have together the mean of its slopes, and
 * their squares, and slopes of either part spread as something can. */
static void scratches_and_plate(void **state) {
  (void)state;
  enum { LOTS = 4096 };
  scratch_slopes all = {.xx = 0.02f, .yy = 0.03f};
  const scratches field = {.share = 0.25f, .squares.level[0] = &all};
  const double mean[][2] = {{0, 0}, {0.05, -0.04}, {0.3, 0.2}};
  const double spread[][3] = {{0.02, 0.005, 0.03}, {0.002, -0.001, 0.001}, {0.3, 0, 0.2}};
  for (int m = 0; m < 3; m++)
    for (int c = 0; c < 3; c++) {
      double sum[5] = {0, 0, 0, 0, 0};
      int scratched = 0;
      for (int k = 0; k < LOTS; k++) {
        shade_slopes s = {.mean = {mean[m][0], mean[m][1]},
                          .covariance = {spread[c][0], spread[c][1], spread[c][2]}};
        scratched += scratches_part(&field, ((float)k + 0.5f) / LOTS, &s);
        const double half =
            (s.covariance[0] + s.covariance[2]) / 2; /* the least, of any direction */
        const double gap = (s.covariance[0] - s.covariance[2]) / 2;
        assert_true(half - sqrt(gap * gap + s.covariance[1] * s.covariance[1]) >= -1e-6);
        sum[0] += s.mean[0] / LOTS;
        sum[1] += s.mean[1] / LOTS;
        for (int a = 0; a < 3; a++)
          sum[2 + a] += (s.covariance[a] + s.mean[a > 1] * s.mean[a > 0]) / LOTS;
      }
      /* a whole number of roulette is scratched */
      const double near = 2.0 / scratched;
      for (int a = 0; a < 2; a++)
        assert_true(fabs(sum[a] - mean[m][a]) <= near * fabs(mean[m][a]));
      for (int a = 0; a < 3; a++) {
        const double square = spread[c][a] + mean[m][a > 1] * mean[m][a > 0];
        assert_true(fabs(sum[2 + a] - square) <= near * (fabs(square) + 1e-3));
      }
      assert_true(m + c > 0 || abs(scratched - LOTS / 4) <= 1);
    }
}

/* A table is put together of parts. */
static void every_stage_is_there(void **state) {
  (void)state;
  void (*stage[sizeof(stage_table) / sizeof(void (*)(void))])(void);
  memcpy(stage, stages, sizeof stage);
  for (size_t k = 1; k < sizeof stage / sizeof *stage; k++) /* after the name */
    assert_true(stage[k]);
}

static void complain(void *log, size_t i) {
  assert_false(message_error(log, "error %zu", i));
  message_warn(log, "warning %zu", i);
}

/* Of errors the first, of warnings the first so many, from any thread; these once more in
 * another's. */
static void what_is_told_of_a_job(void **state) {
  (void)state;
  message_log log, next;
  message_list kept = {0};
  message_init(&log);
  message_init(&next);
  assert_true(!log.error[0] && message_warnings(&log) == 0);
  complain(&log, 7);
  parallel_for(16, 1000, complain, &log);
  assert_string_equal(log.error, "error 7");
  assert_int_equal(message_warnings(&log), MESSAGE_WARNINGS);
  assert_int_equal(log.warnings, 1001);
  assert_string_equal(log.warning[0], "warning 7");
  for (size_t i = 0; i < MESSAGE_WARNINGS; i++)
    assert_memory_equal(log.warning[i], "warning ", 8);
  message_keep(&log, MESSAGE_WARNINGS - 2, &kept);
  message_keep(&log, 0, &kept);
  assert_int_equal(kept.count, MESSAGE_WARNINGS);
  assert_string_equal(kept.text[2], "warning 7");
  message_repeat(&next, &kept);
  assert_int_equal(message_warnings(&next), MESSAGE_WARNINGS);
  assert_string_equal(next.warning[1], log.warning[MESSAGE_WARNINGS - 1]);
  assert_true(!next.error[0]);
  message_forget(&kept);
  assert_int_equal(kept.count, 0);
  assert_false(message_error(&next, "%*d", 2 * MESSAGE_SIZE, 5)); /* cut */
  assert_int_equal(strlen(next.error), MESSAGE_SIZE - 1);
  message_free(&log);
  message_free(&next);
}

int main(void) {
  const stage_table *const tables[] = {stages_of("scalar"), stages_of("sse2"), stages_of("avx2"),
                                       stages_of("avx512"), stages_of("neon")};
  const stage_table *widest = stages_choose();
  int failed = 0;
  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) {
    if (k > 0 && tables[k] == tables[0]) /* of another machine */
      continue;
    void *table = (void *)(uintptr_t)tables[k];
#define TEST(function)                                                                             \
  { #function, function, setup, teardown, table }
    const struct CMUnitTest tests[] = {TEST(every_stage_is_there),
                                       TEST(camera_through_pixels),
                                       TEST(locate_and_move),
                                       TEST(surface_frames),
                                       TEST(surface_frames_of_a_dump),
                                       TEST(pairs_of_numbers),
                                       TEST(sun_light),
                                       TEST(point_light),
                                       TEST(lights_drawn_and_met),
                                       TEST(one_light_a_lane),
                                       TEST(sky_seen_and_drawn),
                                       TEST(triangles_that_shine),
                                       TEST(shadow_rays),
                                       TEST(nodes),
                                       TEST(math_node),
                                       TEST(mix_node),
                                       TEST(metal_and_reflection),
                                       TEST(closures_draw_by_their_density),
                                       TEST(matt_draws_are_aimed),
                                       TEST(closures_are_reciprocal),
                                       TEST(shuffled_points),
                                       TEST(paths_go_on),
                                       TEST(film)};
    failed += cmocka_run_group_tests_name(tables[k]->name, tests, NULL, NULL);
    if (tables[k] == widest)
      break;
  }
  const struct CMUnitTest apart[] = {cmocka_unit_test(large_textures_leave_memory),
                                     cmocka_unit_test(scratches_and_plate),
                                     cmocka_unit_test(what_is_told_of_a_job)};
  failed += cmocka_run_group_tests_name("apart", apart, NULL, NULL);
  return failed != 0;
}
