// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/material.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

#include "dump/dump.h"

namespace mdf {

Material::Material()
    : tangent(TANGENT_DEFAULT), axis(), centre(), strength(1.0), reflects(false), samples(0),
      clamp(0.0), id(-1), bsdf(), specular(), diffuse(), has_diffuse(false), widened(), width(0.0),
      rays(1) {
  shade_params_init(&params);
  // `specular` alone is the colour at every angle, as elsewhere in a finish
  params.fresnel = SHADE_FRESNEL_NONE;
}

namespace {

const double LEVEL_ALPHA[Material::LEVELS] = {0.05, 0.1, 0.2, 0.4};

double alpha_of(const shade_params &p, double alpha, double exponent) {
  return p.mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? std::sqrt(2.0 / (exponent + 2.0)) : alpha;
}

shade_params specular_of(const shade_params &p) {
  shade_params specular = p;

  for (int c = 0; c < 3; c++)
    specular.kd[c] = 0.0;
  return specular;
}

// What reflections need of a block.
void widen(Material &m) {
  const double ax = alpha_of(m.params, m.params.ax, m.params.ex);
  const double ay = alpha_of(m.params, m.params.ay, m.params.ey);

  m.width = 0.5 * std::sqrt(ax * ay);
  // the noise of n draws goes with the root of what they are spread over
  const double spread = 64.0 * std::sqrt(std::max(ax, ay));
  m.rays = m.samples > 0 ? m.samples : (int)std::min(std::max(std::ceil(spread), 4.0), 64.0);
  for (int level = 0; level < Material::LEVELS; level++) {
    const double least = LEVEL_ALPHA[level], most = 2.0 / (least * least) - 2.0;
    shade_params p = specular_of(m.params);
    p.ax = std::max(p.ax, least);
    p.ay = std::max(p.ay, least);
    p.ex = std::min(p.ex, most);
    p.ey = std::min(p.ey, most);
    shade_bsdf_setup(&m.widened[level], &p);
  }
}

// The specular part is the material without kd; the diffuse part is the one without a Fresnel
// term, with what Ashikhmin and Shirley's model leaves of kd beside f0.
void split(Material &m) {
  shade_params diffuse = m.params;
  const shade_params specular = specular_of(m.params);

  m.has_diffuse = false;
  for (int c = 0; c < 3; c++) {
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

int Material::level_of(double alpha) {
  int level = -1;

  while (level + 1 < LEVELS && LEVEL_ALPHA[level + 1] <= alpha)
    level++;
  return level;
}

const Material *Scene::add(const Material &material) {
  const std::shared_ptr<Material> kept(new Material(material));

  kept->id = (int)materials.size();
  kept->specular_albedo.reset();
  split(*kept);
  widen(*kept);
  materials.push_back(kept);
  return kept.get();
}

void Scene::use(const Material *material) {
  Material &m = *materials[(size_t)material->id];

  if (m.specular_albedo)
    return;
  const shade_params p = specular_of(m.params);
  for (size_t i = albedos.size(); i-- > 0 && !m.specular_albedo;)
    if (std::memcmp(&albedos[i].first, &p, sizeof p) == 0)
      m.specular_albedo = albedos[i].second;
  if (m.specular_albedo)
    return;
  shade_bsdf_albedo *const table = shade_bsdf_albedo_create(&p, NULL);
  if (table == NULL)
    throw std::bad_alloc();
  m.specular_albedo.reset(table, shade_bsdf_albedo_free);
  albedos.push_back(std::make_pair(p, m.specular_albedo));
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

void ShadedPoint::specular_albedo(double albedo[3]) const {
  for (int c = 0; c < 3; c++) // what nobody announced: the colour alone
    albedo[c] = material->params.f0[c];
  if (material->specular_albedo)
    shade_bsdf_albedo_eval(material->specular_albedo.get(), normal, eye, albedo, NULL);
}

bool ShadedPoint::draw(const shade_bsdf &part, const double u[2], double L[3],
                       double reflectance[3]) const {
  double wi[3], f[3], pdf, cosine;

  shade_bsdf_sample(&part, normal, eye, u, wi, f, &pdf, &cosine);
  if (!(pdf > 0.0) || !(wi[2] > 0.0))
    return false;
  for (int c = 0; c < 3; c++) {
    reflectance[c] = f[c] * cosine / pdf;
    L[c] = frame[0][c] * wi[0] + frame[1][c] * wi[1] + frame[2][c] * wi[2];
  }
  return reflectance[0] > 0.0 || reflectance[1] > 0.0 || reflectance[2] > 0.0;
}

} // namespace mdf
