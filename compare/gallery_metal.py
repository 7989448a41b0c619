# SPDX-License-Identifier: Apache-2.0
"""Figures of the two papers on metal, made by us: lobes on the disc of half vectors, bumps, scratches.

[KangCho] is "Approximate MDF Rotation", [KangChoKim2011] "Deforming MDF" (REFERENCES.bib).
"""
import numpy as np

import displacement
import programs
import sheet

import shade  # noqa: E402  (programs has said where it is)

PEAKS = (0.0, 0.3, 0.6)  # of nx and ny, as the papers' crosses stand

assert programs  # imported for its paths


def material(label, detail, **values):
    mdf, _brdf, first, second = displacement.MATERIALS[label]
    return lobe(mdf, first, second, detail, **values)


def lobe(mdf, first, second, detail, **values):
    pair = {"ex": first, "ey": second} if mdf == "ashikhmin_shirley" else {"ax": first, "ay": second}
    return shade.Material(mdf=mdf, detail=detail, fresnel="none", **pair, **values)


def normal_of(x, y):
    return np.array([x, y, np.sqrt(1 - x * x - y * y)])


def disc(metal, n, size):
    """D' over the disc of h as RGBA, white where it is largest at n = z; a cross marks n."""
    size *= 2  # its rim is sharp
    side = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(side, -side)
    left = 1 - x * x - y * y
    h = np.stack([x, y, np.sqrt(np.maximum(left, 0))], -1)
    up = np.array([0, 0, 1.0])
    value = sheet.grey(shade.D(metal, n, h), float(shade.D(metal, up, up)), 1.6)
    pixels = np.stack([value] * 3 + [np.where(left > 0, 255, 0).astype(np.uint8)], -1)
    across, down = (int(round((c + 1) / 2 * size - 0.5)) for c in (n[0], -n[1]))
    for k in range(-size // 20, size // 20 + 1):
        for row, column in ((down + k, across), (down + k, across + 1), (down, across + k), (down + 1, across + k)):
            if 0 <= row < size and 0 <= column < size:
                pixels[row, column] = (213, 94, 0, 255)
    return pixels


def discs(metal, size, words):
    """The lobe for three normals."""
    return [(f"{words}|n = ({p:g}, {p / 2:g})", disc(metal, normal_of(p, p / 2), size)) for p in PEAKS]


def perturbed_lobes(folder, size):
    """KangCho Fig. 2 and 3, KangChoKim2011 Fig. 6."""
    return [*discs(lobe("ashikhmin_shirley", 20, 20, "perturb"), size, "round"),
            *discs(lobe("ashikhmin_shirley", 1, 40, "perturb"), size, "A.-S. 1, 40"),
            *discs(lobe("ward", 0.1, 0.5, "perturb"), size, "Ward .1, .5")]


def rotated_lobes(folder, size):
    """KangCho Fig. 5."""
    return [*discs(lobe("ashikhmin_shirley", 1, 40, "rotate"), size, "A.-S. 1, 40"),
            *discs(lobe("ward", 0.1, 0.5, "rotate"), size, "Ward .1, .5")]


def warped_lobes(folder, size):
    """KangChoKim2011 Fig. 7 and 8; the last row is what they should be."""
    words = {"deform_linear": "linear", "deform_smooth": "smooth", "rotate": "displaced"}
    return [tile for detail, word in words.items()
            for tile in discs(lobe("ashikhmin_shirley", 200, 10, detail), size, word)]


def three_metals(folder, size):
    """KangChoKim2011 Fig. 2 and 3: spheres without bumps."""
    made = []
    for label in (displacement.ROUND, displacement.GROOVED, "Ashikhmin-Shirley 10, 200"):
        _rows, shown = displacement.pictures(folder, "sphere", "smooth", 0, label, ("none",), size, 3, 4, True)
        made.append((label.replace(" ", "|", 1), tone(shown)["displaced"]))
    return made + [(label, disc(material(label.replace("|", " "), "none"), normal_of(0, 0), size)) for label, _ in made]


def tone(shown):
    """All by one exposure, that of the truth."""
    truth = shown["displaced"]
    white = float(np.percentile(truth[truth > 0], 97)) if (truth > 0).any() else 1.0
    return {name: sheet.grey(image, white) for name, image in shown.items()}


WORDS = {"displaced": "displaced", "none": "normal ignored", "perturb": "normal map", "rotate": "rotation",
         "rotate_approximate": "approximate rotation", "deform_linear": "linear deformation",
         "deform_smooth": "smooth deformation", "gram_schmidt": "Gram-Schmidt"}
AS_SEEN = "error {}"


def strip(folder, size, base, bumps, slope, label, methods, words="", lights=4, seed=3):
    """Pictures of one surface, the truth last, each with its error as the eye sees it."""
    rows, shown = displacement.pictures(folder, base, bumps, slope, label, methods, size, 3, lights, True, seed)
    error, image = {row["method"]: row["error"] for row in rows}, tone(shown)
    return [*((f"{words}{WORDS[m]}", image[m], AS_SEEN, error[m]) for m in methods),
            (f"{words}displaced", image["displaced"])]


def bumps_rotated(folder, size):
    """KangCho Fig. 1 and 6."""
    return [tile for label, word in (("Ward .1, .5", "Ward, "), (displacement.GROOVED, "A.-S., "))
            for tile in strip(folder, size, "plate", "waves", 0.6, label, ("perturb", "rotate"), word)]


def exact_and_approximate(folder, size):
    """KangCho Fig. 8: the approximation leaves out a length that Ashikhmin-Shirley does not see."""
    made = []
    for label, word in ((displacement.GROOVED, "A.-S., "), ("Ward .1, .5", "Ward, ")):
        made += strip(folder, size, "plate", "waves", 1.0, label, ("rotate", "rotate_approximate"), word)
    return made


def objects(folder, size):
    """KangCho Fig. 9."""
    return [tile for base, label, word in (("sphere", "Ward .1, .5", "Ward, "),
                                           ("cylinder", displacement.GROOVED, "A.-S., "))
            for tile in strip(folder, size, base, "waves", 0.4, label, ("perturb", "rotate"), word)]


def bumps_deformed(folder, size):
    """KangChoKim2011 Fig. 5 and 9."""
    return strip(folder, size, "plate", "waves", 0.6, displacement.GROOVED,
                 ("perturb", "deform_linear", "deform_smooth", "gram_schmidt", "rotate"))


def scratched(folder, size):
    """KangChoKim2011 Fig. 12 to 15, without their environments."""
    return [tile for base, label, word, slope in (
        ("sphere", displacement.GROOVED, "A.-S., ", 0.6), ("cylinder", "Ward .1, .5", "Ward, ", 0.6),
        ("plate", displacement.GROOVED, "close, ", 0.9))
        for tile in strip(folder, size, base, "scratches", slope, label, ("perturb", "deform_smooth"), word)]


def scratch_maps(folder, size):
    """KangChoKim2011 Fig. 4 and 10: caps in place of hemispheres."""
    maps = (("one pit", {"pits": 1, "radius": (0.3, 0.3), "stretch": (1, 1), "depth": 0.5}),
            ("one, stretched", {"pits": 1, "radius": (0.1, 0.1), "stretch": (4, 4), "depth": 0.5}),
            ("pits", {"pits": 150, "radius": (0.02, 0.06), "stretch": (1, 1), "depth": 0.3}),
            ("any direction", {"pits": 400, "radius": (0.004, 0.012), "stretch": (4, 16), "depth": 0.3,
                               "spread": np.pi / 2}),
            ("within 30°", {"pits": 400, "radius": (0.004, 0.012), "stretch": (4, 16), "depth": 0.3, "spread": np.radians(30)}),
            ("deeper", {"pits": 400, "radius": (0.004, 0.012), "stretch": (4, 16), "depth": 0.8, "spread": np.radians(30)}))
    made = []
    for word, values in maps:
        _height, normals = shade.Scratches(values).picture(size, size)
        made.append((word, np.round(127.5 + 127.5 * normals).astype(np.uint8)))
    return made

