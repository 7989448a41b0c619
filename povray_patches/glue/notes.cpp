// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/notes.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "backend/colour/colour.h"
#include "backend/mdf/words.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

namespace {

std::string colour(const double rgb[3]) {
  std::ostringstream text;

  if (rgb[0] == rgb[1] && rgb[1] == rgb[2])
    text << "rgb " << rgb[0];
  else
    text << "rgb <" << rgb[0] << ", " << rgb[1] << ", " << rgb[2] << ">";
  return text.str();
}

std::string colour(const RGBColour &of) {
  const double rgb[3] = {of.red(), of.green(), of.blue()};

  return colour(rgb);
}

std::string vector(const double v[3]) {
  std::ostringstream text;

  text << "<" << v[0] << ", " << v[1] << ", " << v[2] << ">";
  return text.str();
}

// "ggx .06, .3": a choice as the block states it.
std::string choice(const shade_params &params, shade_list list) {
  const int value = shade_params_get_choice(&params, list);
  const std::vector<int> rows = mdf::rows_of_choice(list, value);
  std::ostringstream text;

  text << shade_list_word(list, value);
  for (size_t i = 0; i < rows.size(); i++) {
    shade_param_info info;
    double v[3];
    shade_param_row(rows[i], &info);
    shade_params_get(&params, rows[i], v);
    text << (i > 0 ? ", " : " ");
    if (info.components == 3)
      text << colour(v);
    else
      text << v[0];
  }
  return text.str();
}

void metal(const mdf::Material &m, std::ostream &text) {
  const shade_params &p = m.params;

  text << "  lobe: " << choice(p, SHADE_LIST_MDF) << "; brdf "
       << shade_list_word(SHADE_LIST_BRDF, shade_params_brdf(&p)) << ", detail "
       << choice(p, SHADE_LIST_DETAIL) << ", horizon " << choice(p, SHADE_LIST_HORIZON)
       << (p.multiscatter == SHADE_MULTISCATTER_ON ? ", multiscatter on" : "")
       << "\n  colour: fresnel " << choice(p, SHADE_LIST_FRESNEL);
  if (p.fresnel != SHADE_FRESNEL_CONDUCTOR)
    text << ", specular " << (m.specular_pigment ? "pigment" : colour(p.f0));
  text << "\n";
  if (m.kd_pigment)
    text << "  diffuse: " << shade_list_word(SHADE_LIST_DIFFUSE, p.diffuse) << " pigment\n";
  else if (m.has_diffuse)
    text << "  diffuse: " << choice(p, SHADE_LIST_DIFFUSE) << "\n";
  text << "  strokes: ";
  if (m.tangent == mdf::Material::TANGENT_AXIS)
    text << "along " << vector(m.axis) << " of the texture's space\n";
  else if (m.tangent == mdf::Material::TANGENT_RADIAL)
    text << "round " << vector(m.axis) << " at " << vector(m.centre) << " of the texture's space\n";
  else
    text << "along u of each object\n";
  if (m.bump)
    text << "  bumps: an image of " << m.bump->width() << " x " << m.bump->height() << ", strength "
         << m.strength
         << (m.filtered && m.spreads_bumps() ? "; below a pixel they are roughness"
                                             : ", unfiltered")
         << (m.bump_once ? ", once\n" : "\n");
  if (p.horizon == SHADE_HORIZON_MUTUAL && m.told_slopes)
    text << Mdf_Slopes_Note(m);
  if (m.scratches)
    text << "  scratches: a unit of u and v is " << m.scratches->mm_per_unit << " mm\n";
}

void cloth(const mdf::Cloth &c, std::ostream &text) {
  if (c.draft)
    text << "  cloth: a draft of " << c.draft->ends << " ends and " << c.draft->picks << " picks"
         << (c.material.draft_colors ? " in its own colours" : "") << ", ";
  else
    text << "  cloth: weave " << c.weave << ", ";
  text << c.per_unit(0) << " x " << c.per_unit(1) << " crossings on a unit of u and v\n"
       << "  warp: diffuse " << (c.pigment[0] ? "pigment" : colour(c.material.warp.kd))
       << "; weft: diffuse " << (c.pigment[1] ? "pigment" : colour(c.material.weft.kd)) << "\n";
  if (c.transmits())
    text << "  light from behind shines through its yarns\n";
  if (c.open())
    text << "  rays pass between its yarns\n";
}

// What is not the block's and shines as well.
void beside(const FINISH &f, const mdf::Material &m, std::ostream &text) {
  std::ostringstream adds;
  const struct {
    const char *word;
    double value;
  } items[] = {{"diffuse", f.RawDiffuse}, {"specular", f.Specular}, {"phong", f.Phong}};

  for (size_t i = 0; i < sizeof items / sizeof *items; i++)
    if (items[i].value != 0.0)
      adds << ", " << items[i].word << " " << items[i].value;
  if (!f.Emission.isZero())
    adds << ", emission " << colour(f.Emission);
  if (!f.Reflection_Max.isZero())
    adds << ", reflection " << colour(f.Reflection_Max);
  if (!adds.str().empty())
    text << "  the finish adds to it: " << adds.str().substr(2) << "\n";
  if (m.reflects) {
    text << "  reflection: " << m.rays << " rays at a hit";
    if (m.clamp > 0.0)
      text << ", none brighter than " << m.clamp;
    text << "; +A0.3 +AM2 takes most of their noise\n";
    if (!f.Ambient.isZero())
      text << "  ambient " << colour(f.Ambient) << " gives the pigment's colour alone\n";
  } else if (!f.Ambient.isZero())
    text << "  ambient " << colour(f.Ambient)
         << " gives the pigment's colour, and the block's albedo\n";
}

} // namespace

std::string Mdf_Slopes_Note(const mdf::Material &m) {
  const double *const v = m.params.slopes, most = std::sqrt(v[2] * v[4]);
  const bool leans = v[0] * v[0] + v[1] * v[1] > 0.05 * 0.05 * (v[2] + v[4]);
  const bool askew = std::fabs(v[3]) > 0.05 * most;
  std::ostringstream text;

  text.precision(3); // as a block takes them; + 0.0: no -0
  text << "  slopes " << (leans ? v[0] + 0.0 : 0.0) << ", " << (leans ? v[1] + 0.0 : 0.0) << ", "
       << v[2] << ", " << (askew ? std::min(std::max(v[3], -0.99 * most), 0.99 * most) : 0.0)
       << ", " << v[4]; // rounded, xy may not be beyond the others
  text.precision(2);
  text << " (deviations " << std::sqrt(v[2]) << " along the strokes, " << std::sqrt(v[4])
       << " across)\n";
  if (m.relief)
    text << "  its bump image is uneven: each hit has the slopes near it\n";
  return text.str();
}

std::string Mdf_Notes(const FINISH *finish) {
  const mdf::Material &m = *finish->Mdf;
  std::ostringstream text;

  text.precision(4);
  text << "mdf block at " << m.name << "\n";
  if (m.cloth)
    cloth(*m.cloth, text);
  else
    metal(m, text);
  beside(*finish, m, text);
  return text.str();
}

} // namespace pov
