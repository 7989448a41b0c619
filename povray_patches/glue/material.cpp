// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/material.h"

#include <cstdlib>
#include <new>

#include "dump/dump.h"

namespace mdf {

Material::Material()
    : tangent(TANGENT_DEFAULT), axis(), centre(), strength(1.0), id(-1), bsdf(), specular(),
      diffuse(), has_diffuse(false) {
  shade_params_init(&params);
  // `specular` alone is the colour at every angle, as elsewhere in a finish
  params.fresnel = SHADE_FRESNEL_NONE;
}

namespace {

// The specular part is the material without kd; the diffuse part is the one without a Fresnel
// term, with what Ashikhmin and Shirley's model leaves of kd beside f0.
void split(Material &m) {
  shade_params specular = m.params, diffuse = m.params;

  m.has_diffuse = false;
  for (int c = 0; c < 3; c++) {
    specular.kd[c] = 0.0;
    if (m.params.diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY)
      diffuse.kd[c] *= 1.0 - m.params.f0[c];
    diffuse.f0[c] = 0.0;
    m.has_diffuse = m.has_diffuse || diffuse.kd[c] > 0.0;
  }
  diffuse.fresnel = SHADE_FRESNEL_NONE;
  shade_bsdf_setup(&m.bsdf, &m.params);
  shade_bsdf_setup(&m.specular, &specular);
  shade_bsdf_setup(&m.diffuse, &diffuse);

  m.albedo.reset();
  if (m.has_diffuse && m.params.diffuse != SHADE_DIFFUSE_LAMBERT) {
    shade_bsdf_albedo *const table = shade_bsdf_albedo_create(&diffuse, NULL);
    if (table == NULL)
      throw std::bad_alloc();
    m.albedo.reset(table, shade_bsdf_albedo_free);
  }
}

} // namespace

const Material *Scene::add(const Material &material) {
  const std::shared_ptr<Material> kept(new Material(material));

  kept->id = (int)materials.size();
  split(*kept);
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

void ShadedPoint::light(const shade_bsdf &part, const double L[3], const double E[3],
                        double S[3]) const {
  double wi[3], f[3], cosine;

  to_local(L, wi);
  shade_bsdf_eval(&part, normal, wi, eye, f, &cosine);
  for (int c = 0; c < 3; c++)
    S[c] = f[c] * cosine * E[c];
}

void ShadedPoint::diffuse_albedo(double albedo[3]) const {
  for (int c = 0; c < 3; c++)
    albedo[c] = material->has_diffuse ? material->params.kd[c] : 0.0;
  if (material->albedo)
    shade_bsdf_albedo_eval(material->albedo.get(), NULL, eye, NULL, albedo);
}

} // namespace mdf
