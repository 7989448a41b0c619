// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/material.h"

#include <cstdlib>
#include <new>

#include "dump/dump.h"

namespace mdf {

Material::Material() : bsdf(), tangent(TANGENT_DEFAULT), axis(), strength(1.0), id(-1) {
  shade_params_init(&params);
  // `specular` alone is the colour at every angle, as elsewhere in a finish
  params.fresnel = SHADE_FRESNEL_NONE;
}

const Material *Scene::add(const Material &material) {
  const std::shared_ptr<Material> kept(new Material(material));

  kept->id = (int)materials.size();
  shade_bsdf_setup(&kept->bsdf, &kept->params);
  materials.push_back(kept);
  return kept.get();
}

std::string Scene::json(const std::string &renderer) const {
  std::vector<shade_dump_material> all;

  for (size_t i = 0; i < materials.size(); i++) {
    const shade_dump_material m = {materials[i]->name.c_str(), &materials[i]->params, NULL};
    all.push_back(m);
  }
  char *const header = shade_dump_header(renderer.c_str(), all.data(), all.size());
  if (header == NULL)
    throw std::bad_alloc();
  const std::string text(header);
  std::free(header);
  return text;
}

bool Scene::first_warning(const Material *material, const char *subject) {
  return warned.insert(std::make_pair(std::make_pair(material, std::string(subject)), true)).second;
}

ShadedPoint::ShadedPoint(const Material *m, const double N[3], const double T[3],
                         const double Ns[3], const double V[3])
    : material(m) {
  for (int c = 0; c < 3; c++) {
    frame[0][c] = T[c];
    frame[1][c] = N[(c + 1) % 3] * T[(c + 2) % 3] - N[(c + 2) % 3] * T[(c + 1) % 3];
    frame[2][c] = N[c];
  }
  to_local(V, eye);
  to_local(Ns, normal);
}

void ShadedPoint::to_local(const double world[3], double local[3]) const {
  for (int row = 0; row < 3; row++)
    local[row] = frame[row][0] * world[0] + frame[row][1] * world[1] + frame[row][2] * world[2];
}

void ShadedPoint::light(const double L[3], const double E[3], double S[3]) const {
  double wi[3], f[3], cosine;

  to_local(L, wi);
  shade_bsdf_eval(&material->bsdf, normal, wi, eye, f, &cosine);
  for (int c = 0; c < 3; c++)
    S[c] = f[c] * cosine * E[c];
}

} // namespace mdf
