// SPDX-License-Identifier: Apache-2.0
// The public headers as C++17 sees them: every one, all warnings on; shades one sample and a
// batch of one.
#include "shade/fabric.h"
#include "shade/maps.h"
#include "shade/mesh.h"
#include "shade/presets.h"
#include "shade/shade.h"
#include "shade/weave.h"

#include <cmath>
#include <cstdio>

int main() {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, 3, 15);
  shade_bsdf b;
  const double z[3] = {0, 0, 1};
  double f[3] = {0, 0, 0}, cosine = 0;
  if (shade_bsdf_setup(&b, &p) != SHADE_OK || shade_bsdf_eval(&b, z, z, z, f, &cosine) != SHADE_OK)
    return 1;
  double r[4];
  shade_lanes in = {};
  in.size = sizeof in;
  in.nx = in.ny = in.wix = in.wiy = in.wox = in.woy = z;
  in.nz = in.wiz = in.woz = z + 2;
  const shade_result out = {sizeof out, r, r + 1, r + 2, r + 3};
  if (shade_bsdf_eval_batch(&b, 1, &in, &out) != SHADE_OK)
    return 1;
  // exponents 3 and 15, all along z: D/4 = 8/(2 pi)/4 = 1/pi
  const double want = 0.31830988618379067;
  if (std::fabs(f[1] - want) > 1e-14 || std::fabs(r[1] - want) > 1e-14 || cosine != 1) {
    std::fprintf(stderr, "f = %.17g, %.17g; expected 1/pi\n", f[1], r[1]);
    return 1;
  }
  return 0;
}
