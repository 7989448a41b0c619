# SPDX-License-Identifier: Apache-2.0
"""The gallery: the four papers figure by figure, each made anew, with what it is there to show.

`shows` is what the paper says of its figure; `measured` is a sentence with the numbers of rows in it.
"""
from collections.abc import Callable
from dataclasses import dataclass

import displacement
import gallery_cloth
import gallery_metal
import sheet
import study

ROTATION, DEFORMING = "Kang and Cho, Approximate MDF Rotation", "Kang, Cho and Kim, Deforming MDF"
FABRIC, DIFFUSE = "Kang, Fabric Rendering", "Hast, Wesslén and Seipel, Diffuse Anisotropic Shading"


@dataclass(frozen=True)
class Entry:
    """A figure of a paper. make(folder, size): tiles; measured(rows): a sentence."""

    id: str
    paper: str
    number: str
    title: str
    make: Callable
    shows: str
    measured: Callable


def pick(rows, **wanted):
    return [row for row in rows if all(row.get(key) == value for key, value in wanted.items())]


def variation(rows, method, tilt, material=displacement.GROOVED):
    found = pick(rows, kind="lobe", method=method, tilt=tilt, material=material)
    return found[0]["variation"] if found else float("nan")


def errors(rows, figure):
    """Of a figure's tiles: {label: value}."""
    return {row["label"].replace("|", ", "): row["value"] for row in pick(rows, kind="tile", figure=figure)
            if "value" in row}


def told(rows, figure):
    return "Errors beside the displaced surface: " + "; ".join(
        f"{label} {sheet.percent(value)}" for label, value in errors(rows, figure).items()) + "."


def own(figure):
    return lambda rows: told(rows, figure)


ENTRIES = (
    Entry("rotation-2", ROTATION, "Fig. 2 and 3 (and Deforming MDF, Fig. 6)", "Lobes under plain normal mapping",
          gallery_metal.perturbed_lobes,
          "A round lobe follows the perturbed normal (cross), an anisotropic one is torn apart, Ward's even more.",
          lambda rows: f"At 30° the total variation against the displaced lobe is "
          f"{variation(rows, 'perturb', 30.0, displacement.ROUND):.3f} for the round lobe and "
          f"{variation(rows, 'perturb', 30.0):.3f} for exponents (200, 10)."),
    Entry("rotation-5", ROTATION, "Fig. 5", "Rotated lobes", gallery_metal.rotated_lobes,
          "Rotation carries the lobe to the perturbed normal and keeps its shape.",
          lambda rows: f"With row 2 of the matrix mended: total variation {variation(rows, 'rotate', 30.0):.0e} at 30° "
          "for grooves along the tangent. For the wide axis along it (1, 40) libshade turns about the other axis than "
          "the paper does."),
    Entry("rotation-6", ROTATION, "Fig. 1 and 6", "Bumps by normal map and by rotation", gallery_metal.bumps_rotated,
          "Normal mapping distorts the highlights of bumps, rotation keeps their anisotropy.", own("rotation-6")),
    Entry("rotation-8", ROTATION, "Fig. 7 and 8", "Exact and approximate rotation",
          gallery_metal.exact_and_approximate,
          "The approximation looks almost as the exact rotation, for a fifth of its time.",
          lambda rows: told(rows, "rotation-8") + " Ashikhmin-Shirley does not see what is left out; Ward, Beckmann and GGX do."),
    Entry("rotation-9", ROTATION, "Fig. 9", "Objects", gallery_metal.objects,
          "On curved objects, too, the bumps read more clearly.",
          lambda rows: told(rows, "rotation-9") + " What is left of rotation's error is parallax: the normal map's "
          "bumps have no height."),
    Entry("rotation-10", ROTATION, "Fig. 10", "Cloth: alternating lobes, normal map, rotation",
          gallery_cloth.three_cloths,
          "Alternating exponents alone are flat, a normal map looks too metallic, rotation is smooth.",
          lambda rows: "The normal map tears the yarns' highlights apart, as it does on metal."),
    Entry("deforming-3", DEFORMING, "Fig. 2 and 3", "Three pairs of exponents", gallery_metal.three_metals,
          "The exponents give round, upright and lying highlights.",
          lambda rows: "So they do: the larger exponent is the narrower direction."),
    Entry("deforming-8", DEFORMING, "Fig. 7 and 8", "Lobes by linear and by smooth deformation",
          gallery_metal.warped_lobes,
          "The linear shift bends the lobe sharply at its middle; the smooth one looks more natural.",
          lambda rows: f"It is nearer, too: total variation {variation(rows, 'deform_linear', 30.0):.3f} (linear) and "
          f"{variation(rows, 'deform_smooth', 30.0):.3f} (smooth) at 30°. The displaced lobe, in the last row, has no bend at all."),
    Entry("deforming-9", DEFORMING, "Fig. 5 and 9", "Bumps by deformation", gallery_metal.bumps_deformed,
          "Deformation brings back the anisotropic highlights that the normal map loses.", own("deforming-9")),
    Entry("deforming-10", DEFORMING, "Fig. 4 and 10", "Maps of scratches", gallery_metal.scratch_maps,
          "Hemispheres, stretched and repeated, make seamless maps of scratches.",
          lambda rows: "Spherical caps here, since a hemisphere's rim is vertical."),
    Entry("deforming-12", DEFORMING, "Fig. 12 to 15", "Scratched metal", gallery_metal.scratched,
          "Scratches by normal map scatter light implausibly, by deformation plausibly; Ward gains more.",
          lambda rows: told(rows, "deforming-12") + " Environments were not made again."),
    Entry("fabric-2", FABRIC, "Fig. 2", "Alternating anisotropy", gallery_cloth.alternating,
          "Weft and warp have the same lobe turned by a right angle.",
          lambda rows: "Without a tilt of the yarns one direction of them shines at a time."),
    Entry("fabric-3", FABRIC, "Fig. 3", "What lies on top in a 2/1 twill", gallery_cloth.elements,
          "Three numbers say which yarn is on top.",
          lambda rows: "Of the twill " + ", ".join(f"{sheet.percent(value)} is weft {word}" for word, value in zip(
              ("by the formula as printed", "by the mended one", "in libshade's cloth, its gaps left out"),
              errors(rows, "fabric-3").values())) + "."),
    Entry("fabric-6", FABRIC, "Fig. 4 to 6", "Lobes on a yarn", gallery_cloth.yarn_lobes,
          "The yarn's tilt moves the lobe and, as a stand-in for occlusion, darkens it.",
          lambda rows: "Rotated here, where the paper shifts."),
    Entry("fabric-7", FABRIC, "Fig. 7", "Filament, twist, darkening, noise", gallery_cloth.yarns,
          "Each step makes the yarn more real.", lambda rows: "The same four steps with libshade's parameters."),
    Entry("fabric-8", FABRIC, "Fig. 8", "The light moves", gallery_cloth.lights,
          "The reflection changes with the light's place.",
          lambda rows: "The twist's slant lets one side shine before the other."),
    Entry("fabric-9", FABRIC, "Fig. 1 and 9", "Near and far", gallery_cloth.distances,
          "Cloth looks right from any distance.",
          lambda rows: "From afar only where the pixel's footprint is known: a point's lobe flickers there. The far model "
          "is within " + f"{max((r['colour_far'] for r in pick(rows, kind='cloth')), default=float('nan')):.1%}"
          " of the near model's mean colour."),
    Entry("fabric-10", FABRIC, "Fig. 10", "Satin and twill", gallery_cloth.weaves,
          "The weave rules the reflection.",
          lambda rows: "Satin of five ends, whose floats show the weft, beside twill."),
    Entry("diffuse-1", DIFFUSE, "Fig. 1", "Maximum normal and integral", gallery_cloth.diffuse_spheres,
          "The integral over the fibre is far more accurate than the maximum normal.",
          lambda rows: told(rows, "diffuse-1").replace("the displaced surface", "real fibres")),
)


def make(entries, folder, size, say):
    """Rows of tiles."""
    rows = []
    for place, entry in enumerate(entries):
        say(f"{place + 1} of {len(entries)}")
        rows += sheet.tiles(folder, entry.id, entry.make(folder, size))
    return rows


def figure(entry, rows, command):
    mine = sorted(pick(rows, kind="tile", figure=entry.id), key=lambda row: row["place"])
    return study.Figure(
        entry.id, f"{entry.paper}, {entry.number}: {entry.title}",
        f"The paper: {entry.shows} Here: {entry.measured(rows)} {command}",
        sheet.panels(mine), f"{entry.title}: " + "; ".join(row["label"].replace("|", ", ") for row in mine))
