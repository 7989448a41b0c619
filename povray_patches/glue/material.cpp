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
    : stated(0), tangent(TANGENT_DEFAULT), axis(), centre(), strength(1.0), filtered(true),
      bump_once(false), bump_scale(), bump_move(), reflects(false), notes(false), preset(false),
      samples(0), clamp(0.0), told_slopes(false), specular_pigment(false), kd_pigment(false),
      id(-1), bsdf(), specular(), diffuse(), has_diffuse(false), diffuse_only(false),
      lambert(false), rejects(false), bends(false), black(), linear(true), regularized(),
      regularized_black(), roughness(0.0), rays(1), lattice(Lattice::of(1)) {
  bump_scale[0] = bump_scale[1] = 1.0;
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

// The specular part, no narrower than a level.
shade_params regularized(const shade_params &params, int level) {
  shade_params p = specular_of(params);

  if (level >= 0) {
    const double least = LEVEL_ALPHA[level], most = 2.0 / (least * least) - 2.0;
    p.ax = std::max(p.ax, least);
    p.ay = std::max(p.ay, least);
    p.ex = std::min(p.ex, most);
    p.ey = std::min(p.ey, most);
  }
  return p;
}

double squared(const double v[2]) {
  return v[0] * v[0] + v[1] * v[1];
}

// The two shortest sides of the cells that two of them span, the shorter one first: as Gauss does
// with quadratic forms.
void reduce(double side[2][2]) {
  for (int turn = 0; turn < 64; turn++) {
    if (squared(side[1]) < squared(side[0]))
      std::swap_ranges(side[0], side[0] + 2, side[1]);
    const double along = (side[0][0] * side[1][0] + side[0][1] * side[1][1]) / squared(side[0]);
    if (std::abs(along) <= 0.5)
      return;
    for (int i = 0; i < 2; i++)
      side[1][i] -= std::round(along) * side[0][i];
  }
}

// What reflections need of a block.
void prepare_reflection(Material &m) {
  if (m.cloth) { // its light comes from all sides
    m.roughness = 0.5;
    m.rays = m.samples > 0 ? m.samples : 32;
    m.lattice = Lattice::of((unsigned int)m.rays);
    return;
  }
  const double ax = alpha_of(m.params, m.params.ax, m.params.ex);
  const double ay = alpha_of(m.params, m.params.ay, m.params.ey);

  m.roughness = 0.5 * std::sqrt(ax * ay);
  // the noise of n draws goes with the root of what they are spread over: by the plate, and where
  // there are scratches by their slopes as well
  double spread = std::sqrt(std::max(ax, ay));
  if (m.scratches) {
    double share, square;
    m.scratches->estimate(&share, &square);
    const double wider = std::sqrt(std::sqrt(std::max(ax, ay) * std::max(ax, ay) + square));
    spread += share * (wider - spread);
  }
  const double rays = std::ceil(64.0 * spread);
  m.rays = m.samples > 0 ? m.samples : rays < 64.0 ? (int)std::max(rays, 4.0) : 64;
  m.lattice = Lattice::of((unsigned int)m.rays);
  for (int level = 0; level < Material::LEVELS; level++) {
    shade_params p = regularized(m.params, level);
    shade_bsdf_setup(&m.regularized[level], &p);
    for (int c = 0; c < 3; c++)
      p.f0[c] = 0.0;
    shade_bsdf_setup(&m.regularized_black[level], &p);
  }
}

// The specular part is the material without kd; the diffuse part is the one without a Fresnel
// term, with what Ashikhmin and Shirley's model leaves of kd beside f0.
void split(Material &m) {
  shade_params diffuse, black;

  for (int c = 0; c < 3; c++) {
    m.params.f0[c] = m.specular_pigment ? 1.0 : m.params.f0[c];
    m.params.kd[c] = m.kd_pigment ? 1.0 : m.params.kd[c];
  }
  diffuse = m.params;
  const shade_params specular = black = specular_of(m.params);
  for (int c = 0; c < 3; c++)
    black.f0[c] = 0.0;
  shade_bsdf_setup(&m.black, &black);
  m.linear =
      m.params.multiscatter != SHADE_MULTISCATTER_ON && m.params.horizon != SHADE_HORIZON_MUTUAL;

  m.has_diffuse = false;
  for (int c = 0; c < 3; c++) {
    if (m.params.diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY && !m.specular_pigment)
      diffuse.kd[c] *= 1.0 - m.params.f0[c];
    diffuse.f0[c] = 0.0;
    m.has_diffuse = m.has_diffuse || diffuse.kd[c] > 0.0;
  }
  diffuse.fresnel = SHADE_FRESNEL_NONE;
  if (diffuse.diffuse == SHADE_DIFFUSE_LAMBERT) { // the shape of what is black is the cheapest
    diffuse.mdf = SHADE_MDF_GGX;
    shade_params_set_alphas(&diffuse, 1.0, 1.0);
  }
  m.diffuse_only = m.params.fresnel == SHADE_FRESNEL_NONE && !m.specular_pigment &&
                   m.params.f0[0] == 0.0 && m.params.f0[1] == 0.0 && m.params.f0[2] == 0.0;
  m.lambert = m.diffuse_only && m.params.diffuse == SHADE_DIFFUSE_LAMBERT && !m.cloth && !m.bump &&
              !m.scratches && !m.reflects;
  m.rejects = m.params.detail != SHADE_DETAIL_NONE &&
              m.params.horizon != SHADE_HORIZON_SCHUESSLER &&
              m.params.horizon != SHADE_HORIZON_MUTUAL;
  m.bends = m.params.horizon == SHADE_HORIZON_VALID_REFLECTION ||
            m.params.horizon == SHADE_HORIZON_VALID_ESTEVEZ;
  shade_bsdf_setup(&m.bsdf, m.diffuse_only ? &diffuse : &m.params);
  shade_bsdf_setup(&m.specular, &specular);
  shade_bsdf_setup(&m.diffuse, &diffuse);

  m.albedo.reset();
  if (m.has_diffuse && m.params.diffuse != SHADE_DIFFUSE_LAMBERT)
    m.albedo.reset(new LazyAlbedo(diffuse));
}

} // namespace

namespace {

// How far waves that all points of a lattice meet at the same height are from the slowest ones:
// the least product of their numbers along both axes [Zaremba1966], or none above `least`.
unsigned int merit(unsigned int count, unsigned int g, unsigned int least) {
  unsigned int most = count;

  for (unsigned int across = 1; 2 * across <= count && most > least; across++) {
    const unsigned int along = (unsigned int)((uint64_t)g * across % count);
    most = std::min(most, across * std::max(std::min(along, count - along), 1u));
  }
  return most;
}

} // namespace

// Of those whose points have all coordinates apart: the lights and edges that a lobe meets often
// run along one of them.
Lattice Lattice::of(unsigned int count) {
  Lattice best = {count, {1, 0}, {{1.0, 0.0}, {0.0, 1.0}}};
  unsigned int most = 0;
  double widest = 0.0;

  for (unsigned int g = 1; g < count; g++) {
    unsigned int a = count, b = g;
    while (b != 0) {
      const unsigned int rest = a % b;
      a = b;
      b = rest;
    }
    if (a != 1)
      continue;
    const unsigned int found = merit(count, g, most > 0 ? most - 1 : 0);
    double side[2][2] = {{1.0 / count, (double)g / count}, {0.0, 1.0}};
    reduce(side);
    if (found > most || (found == most && squared(side[0]) > widest)) {
      most = found;
      widest = squared(side[0]);
      best.step[1] = g;
      std::copy(side[0], side[0] + 4, best.side[0]);
    }
  }
  return best;
}

const shade_bsdf_albedo *LazyAlbedo::make() const {
  const std::lock_guard<std::mutex> one(making);
  shade_bsdf_albedo *made = table.load(std::memory_order_relaxed);

  if (made == NULL) {
    made = shade_bsdf_albedo_create(&params, NULL);
    if (made == NULL)
      throw std::bad_alloc();
    table.store(made, std::memory_order_release);
  }
  return made;
}

bool *Material::pigment_for(int row) {
  shade_param_info info;

  shade_param_row(row, &info);
  return std::strcmp(info.word, "f0") == 0   ? &specular_pigment
         : std::strcmp(info.word, "kd") == 0 ? &kd_pigment
                                             : NULL;
}

void Material::colour_metal() {
  if (params.fresnel == SHADE_FRESNEL_CONDUCTOR)
    params.fresnel = SHADE_FRESNEL_SCHLICK;
}

int Material::level_of(double alpha) {
  int level = -1;

  while (level + 1 < LEVELS && LEVEL_ALPHA[level + 1] <= alpha)
    level++;
  return level;
}

const Material *Scene::add(const Material &material) {
  const std::shared_ptr<Material> kept(new Material(material));

  kept->id = (int)materials.size();
  kept->prepared_cloth.reset();
  kept->slopes.reset();
  kept->field.reset();
  prepare(*kept);
  materials.push_back(kept);
  reflecting = reflecting || kept->reflects;
  by_width = by_width || kept->cloth || kept->spreads_bumps();
  return kept.get();
}

// All that only depends on the block.
void Scene::prepare(Material &m) {
  m.specular_albedo.reset();
  m.black_albedo.reset();
  split(m);
  prepare_reflection(m);
  if (m.cloth || m.diffuse_only)
    return;
  shade_params p = specular_of(m.params);
  m.specular_albedo = albedo_of(p);
  for (int c = 0; c < 3; c++)
    p.f0[c] = 0.0;
  if (m.specular_pigment)
    m.black_albedo = albedo_of(p);
}

namespace {

// The nearest of those whose spreads are a fiftieth apart, and all else accordingly: as near as
// some thousand points say what they are. So a thousand pebbles are not a thousand blocks.
void round_slopes(const double found[5], double slopes[5]) {
  const double STEP = 0.02;
  double spread[2];

  for (int axis = 0; axis < 2; axis++) {
    const double own = std::sqrt(found[2 + 2 * axis]);
    spread[axis] = own > 0.0 ? std::exp(STEP * std::round(std::log(own) / STEP)) : 0.0;
    slopes[2 + 2 * axis] = spread[axis] * spread[axis];
  }
  const double most = std::sqrt(found[2] * found[4]);
  const double turn = most > 0.0 ? std::asin(std::min(std::max(found[3] / most, -1.0), 1.0)) : 0.0;
  slopes[3] = std::sin(STEP * std::round(turn / STEP)) * spread[0] * spread[1];
  const double step = STEP * std::max(spread[0], spread[1]);
  for (int axis = 0; axis < 2; axis++)
    slopes[axis] = step * std::round(found[axis] / step);
}

} // namespace

const Material *Scene::on_bumps(const Material *material,
                                const std::shared_ptr<const shade_relief> &bumps) {
  std::vector<const Material *> &made = bumped[material->id];
  Material copy(*material);
  double found[5], slopes[5];

  if (shade_relief_whole(bumps.get(), found) > SHADE_RELIEF_EVEN && copy.may_be_uneven())
    copy.relief = bumps;
  round_slopes(found, slopes);
  shade_params_set_slopes(&copy.params, slopes);
  for (size_t i = 0; i < made.size() && !copy.relief; i++)
    if (!made[i]->relief &&
        std::equal(copy.params.slopes, copy.params.slopes + 5, made[i]->params.slopes))
      return made[i];
  const Material *own = material;
  if (made.empty()) {
    Material &m = *materials[(size_t)material->id];
    m.params = copy.params;
    m.relief = copy.relief;
    prepare(m);
  } else {
    own = add(copy);
    use(own);
  }
  made.push_back(own);
  return own;
}

std::shared_ptr<const LazyAlbedo> Scene::albedo_of(const shade_params &params) {
  for (size_t i = albedos.size(); i-- > 0;)
    if (std::memcmp(&albedos[i]->params, &params, sizeof params) == 0)
      return albedos[i];
  albedos.push_back(std::make_shared<const LazyAlbedo>(params));
  return albedos.back();
}

void Scene::use(const Material *material) {
  Material &m = *materials[(size_t)material->id];

  if (m.bump && !m.slopes)
    m.slopes = m.bump->slopes(m.strength);
  if (m.scratches && !m.field)
    m.field = scratch_fields.field(m.scratches->params);
  if (m.cloth && !m.prepared_cloth)
    m.prepared_cloth = cloths.prepared(*m.cloth);
}

bool Scene::has_cloth() const {
  for (size_t i = 0; i < materials.size(); i++)
    if (materials[i]->cloth)
      return true;
  return false;
}

bool Scene::has_painted() const {
  for (size_t i = 0; i < materials.size(); i++)
    if (materials[i]->kd_pigment)
      return true;
  return false;
}

bool Scene::has_scratches() const {
  for (size_t i = 0; i < materials.size(); i++)
    if (materials[i]->scratches)
      return true;
  return false;
}

bool Scene::has_reliefs() const {
  for (size_t i = 0; i < materials.size(); i++)
    if (materials[i]->relief)
      return true;
  return false;
}

bool Scene::has_bumps() const {
  for (size_t i = 0; i < materials.size(); i++)
    if (materials[i]->spreads_bumps())
      return true;
  return false;
}

std::string Scene::json(const std::string &renderer) const {
  std::vector<shade_dump_material> all;
  std::vector<std::string> cloths(materials.size());
  std::vector<shade_params> bumped(materials.size());

  for (size_t i = 0; i < materials.size(); i++) {
    const Material &of = *materials[i];
    if (of.cloth)
      cloths[i] = of.cloth->json(of.id, of.name.c_str());
    const bool bumps = of.spreads_bumps();
    if (bumps) { // where bumps widen a lobe its grooves stay where they were
      static const double none[3] = {0.0, 0.0, 0.0};
      double angle;
      shade_params_widen(&of.params, NULL, none, &bumped[i], &angle);
    }
    const shade_dump_material m = {of.name.c_str(), bumps ? &bumped[i] : &of.params,
                                   of.cloth ? cloths[i].c_str() : NULL};
    all.push_back(m);
  }
  char *const header = shade_dump_header(renderer.c_str(), all.data(), all.size());
  if (header == NULL)
    throw std::bad_alloc();
  const std::string text(header);
  std::free(header);
  return text;
}

void Bumps::add(const double uv[2], const double normal[3], double share) {
  const double STEEPEST = 50.0;
  if (!(normal[2] * STEEPEST > 1.0))
    return;
  u.push_back((float)uv[0]);
  v.push_back((float)uv[1]);
  x.push_back((float)(-normal[0] / normal[2]));
  y.push_back((float)(-normal[1] / normal[2]));
  weight.push_back((float)share);
}

void Bumps::add(const Bumps &other, double scale) {
  u.insert(u.end(), other.u.begin(), other.u.end());
  v.insert(v.end(), other.v.begin(), other.v.end());
  x.insert(x.end(), other.x.begin(), other.x.end());
  y.insert(y.end(), other.y.begin(), other.y.end());
  for (size_t i = 0; i < other.weight.size(); i++)
    weight.push_back((float)(scale * other.weight[i]));
}

bool Bumps::any() const {
  for (size_t i = 0; i < weight.size(); i++)
    if (weight[i] > 0.0f)
      return true;
  return false;
}

std::shared_ptr<const shade_relief> Bumps::relief() const {
  shade_relief *const made =
      shade_relief_create(u.size(), u.data(), v.data(), x.data(), y.data(), weight.data(), 0);
  if (made == NULL)
    throw std::bad_alloc();
  return std::shared_ptr<const shade_relief>(
      made, [](const shade_relief *r) { shade_relief_free(const_cast<shade_relief *>(r)); });
}

void ShadedPoint::set(const Material *m, const double N[3], const double T[3], const double Ns[3],
                      const double V[3], bool mirrored) {
  material = m;
  // Cloth has a hand: a twill rises to the right. POV-Ray's space is left-handed, so what is
  // upwards of a T to the right is the other way.
  turned = m->cloth && !mirrored;
  const double hand = turned ? -1.0 : 1.0;

  for (int c = 0; c < 3; c++) {
    frame[0][c] = T[c];
    frame[1][c] = hand * (N[(c + 1) % 3] * T[(c + 2) % 3] - N[(c + 2) % 3] * T[(c + 1) % 3]);
    frame[2][c] = N[c];
    pigment[c] = 1.0;
  }
  to_local(V, eye);
  to_local(Ns, normal);
  prepared = 0;
  near.reset();
}

void ShadedPoint::set_pigment(const double rgb[3]) {
  for (int c = 0; c < 3; c++)
    pigment[c] = std::min(std::max(rgb[c], 0.0), 1.0);
}

double ShadedPoint::prepare_cloth(const ClothPlace &place) {
  const Cloth &cloth = *material->cloth;
  shade_fabric_point point;
  double coverage = 1.0;

  shade_fabric_point_init(material->prepared_cloth->fabric(), &point);
  for (int i = 0; i < 2; i++) {
    point.uv[i] = place.uv[i];
    point.footprint[i] = place.footprint[i];
  }
  for (int c = 0; c < 3; c++) {
    point.n[c] = normal[c];
    if (cloth.pigment[0])
      point.warp_kd[c] = pigment[c];
    if (cloth.pigment[1])
      point.weft_kd[c] = pigment[c];
  }
  hit.reset(new shade_fabric_hit);
  shade_fabric_prepare(material->prepared_cloth->fabric(), &point, eye,
                       place.far ? SHADE_TIER_FAR : SHADE_TIER_AUTO, hit.get(), &coverage);
  return coverage;
}

void ShadedPoint::Wider::turn(const double v[3], double turned[3]) const {
  turned[0] = c * v[0] + s * v[1];
  turned[1] = c * v[1] - s * v[0];
  turned[2] = v[2];
}

void ShadedPoint::Wider::back(const double turned[3], double v[3]) const {
  v[0] = c * turned[0] - s * turned[1];
  v[1] = c * turned[1] + s * turned[0];
  v[2] = turned[2];
}

// Those of the map, which are along the frame's own axes.
void ShadedPoint::Wider::turn_slopes() {
  double *const v = params.slopes;
  const double x = v[0], y = v[1], xx = v[2], xy = v[3], yy = v[4];

  v[0] = c * x + s * y;
  v[1] = c * y - s * x;
  v[2] = c * c * xx + 2.0 * c * s * xy + s * s * yy;
  v[3] = c * s * (yy - xx) + (c * c - s * s) * xy;
  v[4] = s * s * xx - 2.0 * c * s * xy + c * c * yy;
}

void ShadedPoint::roughen(double share, const double mean[3], const double covariance[3], int most,
                          int level) {
  const bool wider = covariance[0] + covariance[2] > 1e-9; // else less than any lobe's own

  if (!wider && share == 1.0) {
    to_local(mean, normal);
    return;
  }
  if (rough == NULL)
    rough.reset(new Rough);
  prepared = 0;
  Wider &part = rough->part[rough->parts++];
  double local[3];
  shade_slope_lobes lobes = {1, {0.0}, {0.0}, {1.0}, {1.0}};
  to_local(mean, local);
  part.params = regularized(material->params, level);
  part.angle = 0.0;
  if (wider)
    shade_params_split(&part.params, local, covariance, most, &part.params, &part.angle, &lobes);
  part.c = std::cos(part.angle);
  part.s = std::sin(part.angle);
  part.turn_slopes();
  const bool painted = material->specular_pigment && !material->linear;
  for (int black = 0; black < (material->specular_pigment && !painted ? 2 : 1); black++) {
    shade_params p = part.params;
    for (int c = 0; c < 3; c++)
      p.f0[c] = black ? 0.0 : painted ? pigment[c] : p.f0[c];
    part.bsdf[black] = wider || painted ? &part.own[black]
                       : level >= 0
                           ? &(black ? material->regularized_black : material->regularized)[level]
                           : &(black ? material->black : material->specular);
    if (wider || painted)
      shade_bsdf_setup(&part.own[black], &p);
  }
  for (int i = 0; i < lobes.count && rough->count < MOST_LOBES; i++) {
    RoughLobe &lobe = rough->lobe[rough->count++];
    const double turned[3] = {lobes.nx[i], lobes.ny[i], lobes.nz[i]};
    lobe.of = &part;
    lobe.share = share * lobes.weight[i];
    lobe.prepared = 0;
    if (wider)
      part.back(turned, lobe.flat);
    else
      std::copy(local, local + 3, lobe.flat);
    part.turn(lobe.flat, lobe.normal);
    part.turn(eye, lobe.eye);
  }
}

int ShadedPoint::lobes(LobeSeen seen[MOST_LOBES]) const {
  const int count = rough ? rough->count : 1;

  for (int i = 0; i < count; i++) {
    const RoughLobe *const lobe = rough ? &rough->lobe[count - 1 - i] : NULL;
    const shade_params &p = lobe ? lobe->of->params : material->params;
    seen[i].share = lobe ? lobe->share : 1.0;
    to_world(lobe ? lobe->flat : normal, seen[i].normal);
    seen[i].alpha[0] = alpha_of(p, p.ax, p.ex);
    seen[i].alpha[1] = alpha_of(p, p.ay, p.ey);
    seen[i].angle = lobe ? lobe->of->angle : 0.0;
  }
  return count;
}

void ShadedPoint::look(const double uv[2], double share, Bumps &to) const {
  static const double flat[3] = {0.0, 0.0, 1.0};

  if (!rough)
    to.add(uv, lambert ? flat : normal, share);
  for (int i = 0; rough && i < rough->count; i++)
    to.add(uv, rough->lobe[i].flat, share * rough->lobe[i].share);
}

void ShadedPoint::set_slopes(const double uv[2]) {
  const float u = (float)uv[0], v = (float)uv[1];
  float found[5];
  float *const to[5] = {found, found + 1, found + 2, found + 3, found + 4};

  near.reset(new Near);
  near->made = 0;
  shade_relief_lookup_batchf(material->relief.get(), 1, &u, &v, to);
  std::copy(found, found + 5, near->slopes);
}

void ShadedPoint::slopes(double found[5]) const {
  if (near)
    std::copy(near->slopes, near->slopes + 5, found);
  else
    shade_params_get_slopes(&material->params, found);
}

const shade_bsdf *ShadedPoint::near_bsdf(Lobe of, const shade_bsdf *b) const {
  shade_bsdf *const made = &near->lobe[of];

  if (!(near->made >> of & 1)) {
    const double *const s = near->slopes;
    shade_lanes in = shade_lanes();
    in.size = sizeof in;
    in.slope_x = s;
    in.slope_y = s + 1;
    in.slope_xx = s + 2;
    in.slope_xy = s + 3;
    in.slope_yy = s + 4;
    shade_bsdf_vary(b, &in, 0, made);
    near->made |= 1u << of;
  }
  return made;
}

// f cos of one of the material's lobes.
void ShadedPoint::eval_lobe(Lobe of, const shade_bsdf *given, const double wi[3],
                            double f[3]) const {
  const shade_bsdf *const b = here(of, given);
  shade_bsdf_hit *const at = &prepared_hit[of];
  double cosine;

  if (!(prepared >> of & 1)) {
    shade_bsdf_prepare(b, normal, eye, at);
    prepared |= 1u << of;
  }
  shade_bsdf_hit_eval(b, at, wi, f, &cosine);
  for (int c = 0; c < 3; c++)
    f[c] *= cosine;
}

// The same of all that slopes make of it: the specular ones each in a frame of its own.
void ShadedPoint::eval_rough(Lobe of, const double wi[3], double f[3]) const {
  const bool turned = of != OF_DIFFUSE;
  double i[3], one[3], cosine;

  for (int c = 0; c < 3; c++)
    f[c] = 0.0;
  for (int k = 0; k < rough->count; k++) {
    const RoughLobe &lobe = rough->lobe[k];
    const shade_bsdf *const b = turned ? lobe.of->bsdf[of == OF_BLACK] : &material->diffuse;
    if (!(lobe.prepared >> of & 1)) {
      shade_bsdf_prepare(b, turned ? lobe.normal : lobe.flat, turned ? lobe.eye : eye,
                         &lobe.prepared_hit[of]);
      lobe.prepared |= 1u << of;
    }
    if (turned)
      lobe.of->turn(wi, i);
    shade_bsdf_hit_eval(b, &lobe.prepared_hit[of], turned ? i : wi, one, &cosine);
    for (int c = 0; c < 3; c++)
      f[c] += lobe.share * one[c] * cosine;
  }
}

// f cos of the specular lobe, or the same in black, with what its bumps make of it.
void ShadedPoint::specular(bool in_black, int level, const double wi[3], double f[3]) const {
  const Material &m = *material;

  if (rough)
    eval_rough(in_black ? OF_BLACK : OF_SPECULAR, wi, f);
  else if (level < 0)
    eval_lobe(in_black ? OF_BLACK : OF_SPECULAR, in_black ? &m.black : &m.specular, wi, f);
  else
    eval_lobe(in_black ? OF_REGULARIZED_BLACK : OF_REGULARIZED,
              in_black ? &m.regularized_black[level] : &m.regularized[level], wi, f);
}

void ShadedPoint::eval_painted(int of_level, const double wi[3], double f[3]) const {
  double cosine;

  if (!painted || painted->level != of_level) {
    shade_params p = mdf::regularized(material->params, of_level);
    std::copy(pigment, pigment + 3, p.f0);
    if (near)
      shade_params_set_slopes(&p, near->slopes);
    painted.reset(new Painted);
    painted->level = of_level;
    shade_bsdf_setup(&painted->bsdf, &p);
    shade_bsdf_prepare(&painted->bsdf, normal, eye, &painted->hit);
  }
  shade_bsdf_hit_eval(&painted->bsdf, &painted->hit, wi, f, &cosine);
  for (int c = 0; c < 3; c++)
    f[c] *= cosine;
}

void ShadedPoint::to_world(const double local[3], double world[3]) const {
  for (int c = 0; c < 3; c++)
    world[c] = frame[0][c] * local[0] + frame[1][c] * local[1] + frame[2][c] * local[2];
}

// The specular part in the pigment's colour, from what is reflected in white and in black.
void ShadedPoint::tint(const double black[3], double white[3]) const {
  for (int c = 0; c < 3; c++)
    white[c] = black[c] + pigment[c] * (white[c] - black[c]);
}

void ShadedPoint::eval(Part part, int level, const double L[3], const double E[3],
                       double S[3]) const {
  const Material &m = *material;
  double wi[3], f[3];

  if (lambert) {
    eval_lambert(L, E, S);
    paint_diffuse(S);
    for (int c = 0; c < 3 && part == SPECULAR; c++)
      S[c] = 0.0;
    return;
  }
  to_local(L, wi);
  if (m.cloth)
    shade_fabric_hit_eval(m.prepared_cloth->fabric(), hit.get(), wi, f);
  else if (part == DIFFUSE) {
    if (rough)
      eval_rough(OF_DIFFUSE, wi, f);
    else
      eval_lobe(OF_DIFFUSE, &m.diffuse, wi, f);
    paint_diffuse(f);
  } else if (part == ALL)
    eval_lobe(OF_ALL, &m.bsdf, wi, f);
  else {
    if (m.specular_pigment && !m.linear && !rough)
      eval_painted(level, wi, f);
    else
      specular(false, level, wi, f);
    if (m.specular_pigment && m.linear) {
      double black[3] = {0.0, 0.0, 0.0};
      if (m.params.fresnel != SHADE_FRESNEL_NONE)
        specular(true, level, wi, black);
      tint(black, f);
    }
  }
  for (int c = 0; c < 3; c++)
    S[c] = f[c] * E[c];
}

// What a pigment makes of the diffuse part, which is in white for it.
void ShadedPoint::paint_diffuse(double f[3]) const {
  const Material &m = *material;
  const bool leaves = m.specular_pigment && m.params.diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY;

  for (int c = 0; c < 3; c++) {
    f[c] *= m.kd_pigment ? pigment[c] : 1.0;
    f[c] *= leaves ? 1.0 - pigment[c] : 1.0;
  }
}

void ShadedPoint::diffuse_albedo(double albedo[3]) const {
  for (int c = 0; c < 3; c++)
    albedo[c] = material->has_diffuse ? material->params.kd[c] : 0.0;
  if (material->cloth)
    return;
  if (material->albedo)
    shade_bsdf_albedo_eval(material->albedo->get(), NULL, eye, NULL, albedo);
  paint_diffuse(albedo);
}

void ShadedPoint::specular_albedo(double albedo[3]) const {
  const Material &m = *material;

  if (m.cloth) {
    m.prepared_cloth->albedo(eye, pigment, albedo);
    return;
  }
  for (int c = 0; c < 3; c++)
    albedo[c] = 0.0;
  if (m.specular_albedo)
    shade_bsdf_albedo_eval(m.specular_albedo->get(), normal, eye, albedo, NULL);
  if (m.specular_pigment) {
    double black[3] = {0.0, 0.0, 0.0};
    if (m.black_albedo)
      shade_bsdf_albedo_eval(m.black_albedo->get(), normal, eye, black, NULL);
    tint(black, albedo);
  }
}

// f cos of all the lobes, by a draw of one of them; pdf: of any of them.
bool ShadedPoint::sample_rough(const double u[3], double wi[3], double f[3], double *pdf) const {
  const bool by_second = u[2] < 0.0;
  double rest = u[by_second ? 1 : 2], drawn[3], cosine, at[2] = {u[0], u[1]};
  int k = 0;

  for (; k + 1 < rough->count && rest >= rough->lobe[k].share; k++)
    rest -= rough->lobe[k].share;
  const RoughLobe &lobe = rough->lobe[k];
  if (by_second) // each lobe has a strip of the square, and all of the square's points in it
    at[1] = std::min(rest / lobe.share, 1.0 - 0x1p-53);
  shade_bsdf_sample(lobe.of->bsdf[0], lobe.normal, lobe.eye, at, drawn, f, pdf, &cosine);
  if (!(*pdf > 0.0))
    return false;
  lobe.of->back(drawn, wi);
  for (int c = 0; c < 3; c++)
    f[c] *= cosine;
  if (rough->count == 1)
    return true;
  *pdf *= lobe.share;
  for (int i = 0; i < rough->count; i++) {
    const RoughLobe &other = rough->lobe[i];
    if (i == k)
      continue;
    other.of->turn(wi, drawn);
    *pdf += other.share * shade_bsdf_pdf(other.of->bsdf[0], other.normal, drawn, other.eye, NULL);
  }
  eval_rough(OF_SPECULAR, wi, f);
  return true;
}

bool ShadedPoint::sample(int level, const double u[3], double L[3], double throughput[3]) const {
  const Material &m = *material;
  double wi[3], f[3], pdf, cosine = 1.0;

  if (m.cloth)
    shade_fabric_hit_sample(m.prepared_cloth->fabric(), hit.get(), u, wi, f, &pdf);
  else if (rough) {
    if (!sample_rough(u, wi, f, &pdf))
      return false;
  } else
    shade_bsdf_sample(level < 0 ? here(OF_SPECULAR, &m.specular)
                                : here(OF_REGULARIZED, &m.regularized[level]),
                      normal, eye, u, wi, f, &pdf, &cosine);
  if (!(pdf > 0.0) || !(wi[2] > 0.0 || m.cloth))
    return false;
  to_world(wi, L);
  if (m.specular_pigment && !m.cloth) {
    static const double one[3] = {1.0, 1.0, 1.0};
    eval(SPECULAR, level, L, one, f);
    cosine = 1.0;
  }
  for (int c = 0; c < 3; c++)
    throughput[c] = f[c] * cosine / pdf;
  return throughput[0] > 0.0 || throughput[1] > 0.0 || throughput[2] > 0.0;
}

} // namespace mdf
