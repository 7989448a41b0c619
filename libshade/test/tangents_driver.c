/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shade_mesh_tangents as a filter, for test_tangents_blender.py.
 * stdin, native: uint32 triangles; positions, 3 floats a corner; normals, 3 floats
 * a corner; UVs, 2 floats a corner. stdout: tangents, 4 floats a corner.
 */
#include "shade/mesh.h"

#include <stdio.h>
#include <stdlib.h>

static float *read_floats(size_t count) {
  float *values = malloc(count * sizeof *values);
  if (!values || fread(values, sizeof *values, count, stdin) != count) {
    fprintf(stderr, "tangents_driver: input too short\n");
    exit(1);
  }
  return values;
}

int main(void) {
  uint32_t triangles;
  if (fread(&triangles, sizeof triangles, 1, stdin) != 1 || triangles == 0)
    return 1;
  const size_t corners = 3 * (size_t)triangles;
  float *position = read_floats(3 * corners);
  float *normal = read_floats(3 * corners);
  float *uv = read_floats(2 * corners);
  uint32_t *index = malloc(corners * sizeof *index);
  float *tangent = malloc(4 * corners * sizeof *tangent);
  if (!index || !tangent)
    return 1;
  for (size_t c = 0; c < corners; ++c)
    index[c] = (uint32_t)c;
  const long without = shade_mesh_tangents(triangles, position, index, normal, uv, tangent);
  fprintf(stderr, "%ld corners without a UV direction\n", without);
  int failed = without < 0 || fwrite(tangent, 4 * sizeof *tangent, corners, stdout) != corners;
  free(position);
  free(normal);
  free(uv);
  free(index);
  free(tangent);
  return failed;
}
