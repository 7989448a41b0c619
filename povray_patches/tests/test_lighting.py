# SPDX-License-Identifier: AGPL-3.0-or-later
"""How libshade's term sits among POV-Ray's own."""
import re

import numpy as np
import pytest

from scenes import HEADER, SUN, finish, scene

COST = 4.3

SPHERE = "sphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} {normal} {finish} }} {more} }}\n"


def sphere(words="", detail="rotate", normal="", more="", **replace):
    text = finish(words, detail)
    for word, value in replace.items():
        text = text.replace(f"{word} 0", f"{word} {value}")
    return SPHERE.format(normal=normal, finish=text, more=more)


def test_adds_to_the_other_terms(render):
    plain = "sphere { 0, 1 texture { pigment { rgb .5 } finish { ambient .1 diffuse .6 specular .3 } } }\n"
    others = render(scene(plain)).image
    ours = render(scene(sphere(ambient=".1").replace("rgb .5", "rgb 0"))).image  # it takes its share of the ambient light too
    both = render(scene(plain.replace("specular .3", "specular .3 mdf { ashikhmin_shirley 200, 10 }"))).image
    np.testing.assert_allclose(both, others + ours, rtol=3e-3, atol=1e-4)


def test_unperturbed_block_ignores_the_normal_even_where_it_turns_from_the_light(render):
    flat = render(scene(sphere(detail="none"))).image
    bumped = render(scene(sphere(detail="none", normal="normal { bumps 3 scale .1 }"))).image
    np.testing.assert_array_equal(flat, bumped)


def test_no_diffuse_from_behind_because_of_the_block(render):
    # taking a rejected light for one from behind must leave POV-Ray's diffuse term out.
    # no_shadow: how near an object may be to shadow itself depends on what POV-Ray traced just before (its shadow cache)
    plain = "sphere { 0, 1 no_shadow texture { pigment { rgb .5 } normal { bumps 2 scale .2 } finish { ambient 0 diffuse .6 FINISH } } }\n"
    without = render(scene(plain.replace("FINISH", ""))).image
    black = render(scene(plain.replace("FINISH", "mdf { specular 0 }"))).image
    np.testing.assert_array_equal(without, black)


def test_fill_light_gives_no_highlight(render):
    result = render(scene(sphere(), SUN.replace("parallel", "shadowless parallel")))
    assert result.image.max() == 0 and result.dump.S.max() == 0
    area = render(scene(sphere(), SUN.replace("parallel point_at 0", "shadowless area_light 9*x, 9*y, 2, 2 area_illumination")), (16, 12), dump=False)
    assert area.image.max() == 0


def test_light_from_behind_gives_nothing_even_to_double_illuminate(render):
    result = render(scene(sphere(more="double_illuminate"), "light_source { <-10, -20, 50>, rgb 1 }\n"))
    assert result.dump.hit.any() and result.image.max() == 0


def test_low_quality_leaves_reflections_out(render):
    """As POV-Ray's own: from +Q8 on."""
    ball = "background { rgb 1 } " + sphere("reflection { samples 2 }")
    seen = [render(scene(ball, ""), (8, 6), [f"+Q{q}"], dump=False).image[3, 4].max() for q in (7, 8)]
    assert seen[0] == 0 and seen[1] > .1


def test_irid_tints_a_reflection_as_it_does_a_mirrors(render):
    ball = "background { rgb 1 } sphere { 0, 1 pigment { rgb 0 } finish { ambient 0 diffuse 0 irid { .5 thickness .7 } %s } }"
    mirror, block = (render(scene(ball % words, ""), (16, 12), dump=False).image for words in
                     ("reflection .5", "mdf { ggx 1e-3, 1e-3 brdf microfacet specular .5 reflection { samples 1 } }"))
    there = np.s_[4:8, 7:9]
    assert np.ptp(mirror[there], axis=-1).min() > .05 and block[there] == pytest.approx(mirror[there], abs=.01)


def test_light_below_the_surface_comes_once(render):
    """A lamp's diffuse part is what subsurface scatters, whether it is lit by points of the lamp or not."""
    head = HEADER.replace("assumed_gamma 1", "assumed_gamma 1 mm_per_unit 20 subsurface { samples 8, 2 }")
    ball = "sphere { 0, 1 pigment { rgb .8 } finish { ambient 0 diffuse .6 subsurface { translucency 9 } %s } interior { ior 1.4 } }"
    for lamp in ("", "area_light x, y, 2, 2 area_illumination"):
        lit = [render(scene(ball % words, f"light_source {{ <40, 60, -50>, rgb 1 {lamp} }}", head), (8, 6), dump=False).image.mean()
               for words in ("", "mdf { specular 0 diffuse lambert .6 }")]
        assert lit[0] > 1e-3 and lit[1] == pytest.approx(lit[0], rel=.1), lamp


def test_light_from_behind_casts_no_shadow_rays(render):
    """As many as with the word `diffuse`: of a ball, half of it lit; bumps may add those that face the light, no more."""
    def rays(finish, normal=""):
        result = render(scene(SPHERE.format(normal=normal, finish=finish, more=""), "light_source { <50, 0, 10>, rgb 1 }"), options=["+WT1"])
        return int(re.search(r"Shadow Ray Tests:\s+(\d+)", result.log).group(1))
    stock, block = "finish { ambient 0 diffuse .5 }", "finish { ambient 0 diffuse 0 mdf { } }"
    assert rays(block) == rays(stock) > 100
    assert rays(stock, "normal { bumps 2 scale .1 }") <= rays(block, "normal { bumps 2 scale .1 }") < 1.35 * rays(stock)


@pytest.mark.parametrize("horizon", ["hard", "estevez", "chiang", "valid_reflection", "valid_estevez", "schuessler"])
def test_light_below_bumps_casts_shadow_rays_only_where_it_may_count(render, horizon):
    """double_illuminate asks every light: nothing may come of those that are left out without it. Horizons that leave
    the normal alone ask as many as the word `diffuse`."""
    def picture(finish, more=""):
        floor = f"plane {{ y, 0 texture {{ pigment {{ rgb .5 }} normal {{ bumps 1.5 scale .3 }} {finish} }} no_shadow {more} }}\n"
        result = render(scene(floor, "light_source { <-30, 6, 4>, rgb 1 } light_source { <9, 3, 20>, rgb .7 }"), options=["+WT1"])
        return result.image, int(re.search(r"Shadow Ray Tests:\s+(\d+)", result.log).group(1))
    block = f"finish {{ ambient 0 diffuse 0 mdf {{ ashikhmin_shirley 40, 5 specular .6 diffuse lambert .3 horizon {horizon} }} }}"
    seen, rays = picture(block)
    np.testing.assert_allclose(seen, picture(block, "double_illuminate")[0], rtol=2e-3, atol=1e-6)
    stock, all_of_them = picture("finish { ambient 0 diffuse .5 }")[1], 2 * seen.shape[0] * seen.shape[1]
    assert .2 * all_of_them < stock < .8 * all_of_them and seen.max() > .1
    if horizon in ("hard", "estevez", "chiang"):
        assert abs(rays - stock) < .01 * stock


def test_seen_in_a_mirror(render):
    mirror = "plane { -z, -2 pigment { rgb 1 } finish { ambient 0 diffuse 0 reflection 1 } }\n"
    hidden = sphere(more="no_image translate <.5, .5, 0>")
    result = render(scene(hidden + mirror, "light_source { <3, 4, 1.8>, rgb 1 }"), (96, 72))
    assert result.image.max() > .05 and not result.dump.hit.any()


def test_glass_in_front_and_transparent_metal(render):
    metal = sphere().replace("rgb .5", "rgbt <1, 1, 1, .5>")
    result = render(scene(metal + "plane { -z, -2 pigment { checker rgb 1 rgb 0 } finish { ambient 1 diffuse 0 } }"))
    assert np.isfinite(result.image).all() and result.dump.hit.any()


def test_texture_maps_and_csg(render, shade_check):
    metal = f"texture {{ pigment {{ rgb .5 }} {finish('specular rgb <.9, .8, .6>')} }}"
    other = f"texture {{ pigment {{ rgb .5 }} {finish('specular rgb .3', 'perturb')} }}"
    objects = f"""intersection {{ box {{ -1, 1 {metal} }} sphere {{ 0, 1.2 texture {{ gradient y texture_map {{ [0 {metal.replace('texture', '', 1).strip()[1:-1]}] [1 {other.replace('texture', '', 1).strip()[1:-1]}] }} }} }} rotate 20*y }}
union {{ sphere {{ 1.6*x, .3 }} torus {{ .3, .1 translate -1.6*x }} texture {{ average texture_map {{ [1 {metal.replace('texture', '', 1).strip()[1:-1]}] [1 {other.replace('texture', '', 1).strip()[1:-1]}] }} }} }}
merge {{ sphere {{ 1.5*y, .3 }} sphere {{ 1.5*y + .2*x, .3 }} {metal} }}"""
    dump = render(scene(objects), (96, 72)).dump
    assert len(np.unique(dump.id[dump.hit])) >= 3
    shade_check(dump, everything=False)


def test_radiosity_and_photons(render, shade_check):
    header = HEADER.replace("assumed_gamma 1", "assumed_gamma 1 photons { count 20000 } radiosity { pretrace_end .04 count 20 }")
    objects = (sphere(diffuse=".2", more="translate -.8*x") + "plane { y, -1.2 pigment { rgb .6 } }\n" +
               "sphere { <1, 0, -.5>, .5 pigment { rgbt 1 } interior { ior 1.5 } photons { target refraction on reflection on } }\n")
    result = render(scene(objects, header=header), (64, 48))
    assert np.isfinite(result.image).all()
    shade_check(result.dump)


def test_photons_reach_the_metal(render):
    # the lamp lights the wall only by way of the mirror: with photons it becomes brighter
    objects = """box { <-2, -1, 1>, <2, 2, 1.1> texture { pigment { rgb .5 } FINISH } }
box { <-1, -1.2, -1>, <1, -1.1, 1> pigment { rgb 1 } finish { ambient 0 diffuse 0 reflection 1 } photons { target reflection on } }
""".replace("FINISH", finish("tangent <1, 0, 0>", exponents="5, 5"))
    lamp = "light_source { <0, 3, -2.5>, rgb 1 }"
    dark = render(scene(objects, lamp)).image
    lit = render(scene(objects, lamp, HEADER.replace("assumed_gamma 1", "assumed_gamma 1 photons { count 50000 }"))).image
    assert np.isfinite(lit).all()
    assert lit.sum() > 1.02 * dark.sum()


def test_finite_at_awkward_places(render, shade_check):
    # the sphere's poles, a needle of light along the surface, the eye inside, a mirrored and squashed object
    objects = sphere(more="scale <-1, 1e-3, 1>") + sphere(more="scale 2 translate <1, 2, -5>")
    result = render(scene(objects, "light_source { <100, 0, 0>, rgb 1 } light_source { <0, 0, 0>, rgb 1 }"))
    assert np.isfinite(result.image).all()
    assert all(np.isfinite(plane).all() for plane in result.dump.channels.values())
    from_above = HEADER.replace("<1, 2, -5>", "<0, 5, 0>")
    dump = render(scene(sphere("tangent <0, 1, 0>"), header=from_above), (63, 47)).dump
    assert all(np.isfinite(plane).all() for plane in dump.channels.values())
    shade_check(dump, everything=False)
