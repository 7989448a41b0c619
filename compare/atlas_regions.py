# SPDX-License-Identifier: Apache-2.0
"""Where forms fail in the stability atlas: what counts as failing, the name and the reason of each region."""
from dataclasses import dataclass

from atlas_forms import FORMS

# failure: (map, what a row fails by, what is measured, in its unit)
FAILS = {
    "nan": ("half", lambda r: r["nan"] * 1.0, 0.5, "NaN"),
    "off": ("half", lambda r: r["off"] * 1.0, 0.5, "|p| > 1"),
    "wrong": ("half", lambda r: r["error"], 0.1, "off, of the peak"),
    "jump": ("half", lambda r: r["jump"], 1e-3, "jump, of the peak"),
    "energy": ("normal", lambda r: abs(r["energy"] - r["true_energy"]), 0.03, "∫D′ off by"),
    "displaced": ("normal", lambda r: r["displaced"], 1.0, "peak displaced, degrees"),
    "lobe": ("lobe", lambda r: abs(r["energy"] - r["true_energy"]), 0.03, "∫D′ off by"),
    "rounding": ("float", lambda r: r["error"], 1e-3, "relative error"),
    "furnace": ("grazing", lambda r: r["albedo"], 1.01, "albedo"),
    "weights": ("grazing", lambda r: r["spread"], 1.0, "deviation over mean"),
    "asymmetry": ("pairs", lambda r: r["asymmetry"], 1e-6, "|f − f′|/f"),
    "wide jump": ("wide", lambda r: r["jump"], 1e-3, "jump, of the peak"),
    "wide nan": ("wide", lambda r: r["nan"] * 1.0, 0.5, "NaN"),
    "peak": ("lobe", lambda r: r["displaced"], 1.0, "peak displaced, degrees"),
    "narrow furnace": ("narrow", lambda r: r["albedo"], 1.01, "albedo"),
    "narrow weights": ("narrow", lambda r: r["spread"], 1.0, "deviation over mean"),
    "narrow asymmetry": ("narrow", lambda r: r["asymmetry"], 1e-6, "|f − f′|/f"),
    "light furnace": ("light", lambda r: r.get("albedo", 0.0), 1.01, "of a beam given back"),
    "light asymmetry": ("light", lambda r: r["asymmetry"], 1e-6, "|f − f′|/f"),
    "light jump": ("light", lambda r: r["jump"], 1e-3, "jump of f cos"),
    "eye asymmetry": ("eye", lambda r: r["asymmetry"], 1e-6, "|f − f′|/f"),
    "eye jump": ("eye", lambda r: r["jump"], 1e-3, "jump of f cos"),
    "fibre": ("fibre", lambda r: r["error"], 1e-3, "Φ off by"),
    "fibre nan": ("fibre", lambda r: r["nan"] * 1.0, 0.5, "NaN"),
}
NANS = ("nan", "off", "fibre nan", "wide nan")  # failures whose rows have no number
# what is there from the start, in forms and in its rounding
DEFAULTS, HORIZON = ("rotate", "ward_half_rotate", "beckmann_rotate", "ggx_rotate", "float"), "valid_estevez"
# columns of a row that say where it fails most begin so, where it has several worst places
PREFIX = {"weights": "spread_", "narrow weights": "spread_", "peak": "displaced_", "wide nan": "nan_",
          **{f"{which} {what}": f"{what}_" for which in ("light", "eye", "narrow") for what in ("asymmetry", "jump")}}
# failures that have another's reason, where they have none of their own
ALIAS = {"wide nan": "nan", "peak": "displaced", "narrow furnace": "furnace", "narrow weights": "weights",
         "light furnace": "furnace"}
AXES = {  # of each map: columns across and upwards, in degrees where there is no unit
    "half": ("theta", "tilt"), "normal": ("azimuth", "tilt"), "lobe": ("size", "tilt"), "float": ("size", "tilt"),
    "grazing": ("eye", "tilt"), "pairs": ("eye", "light"), "wide": ("size", "tilt"),
    "narrow": ("size", "tilt"), "light": ("light", "tilt"), "eye": ("eye", "tilt"), "fibre": ("azimuth", "theta")}

WARP = "the warp moves the lobe over the disc and does not turn it: it is squeezed towards the rim"
BELOW = "much of the lobe lies below the surface's horizon; such draws count as 0"
KEPT = "the same; SHADE_NO_SAMPLE says so, and the mean stays right"

# form, or (form, failure): name on the map, the formula's reason, what the library does there
REASONS = {
    "rotate_row_two": ("other azimuth", "row 2 adds ny·nz·hz: T⁻¹n = (0, 2ny·nz², 1), so the exponent is another's",
                       "row 2 is hy − ny·(n·h)"),
    ("rotate_row_two", "jump"): ("no azimuth", "x̃ = ỹ = 0 away from h = n: the exponent has no limit there",
                                 "x̃ = ỹ = 0 at h = n alone, where D′ is the peak whatever the exponent"),
    "rotate_row_three": ("peak everywhere", "row 3 is nx² + ny² + nz² = 1 for every h", "row 3 is n·h"),
    "rotate_axis_v": ("skew axis", "v′ = (0, −nz, ny) is not w′ × u′: at no right angle to u′, nor as long",
                      "v′ = (−nx·ny, 1 − ny², −ny·nz)"),
    "rotate_denominator": ("exponent too small", "x̃² + ỹ² is L²(1 − d²), L² = 1 − ny², and 1 − d² is divided by",
                           "divides by x̃² + ỹ², which does not see L"),
    "rotate_always_x": ("strokes turned", "strokes along y stay where x′ = dP/du leaves them, not along dP/dv",
                        "groove auto: y′ along dP/dv"),
    "deform_linear_printed": ("squeezed", WARP, "`rotate`; or …_conserving"),
    ("deform_linear_printed", "nan"): ("0/0, rim", "|p′ − Δ| is divided by, 0 at h = n; at the rim 1 − |p|² rounds "
                                       "below 0", "w = 1 − (b + √(b² + ac))/c and z̃² = 1 − u²: neither"),
    "deform_smooth_printed": ("squeezed", WARP, "`rotate`; or …_conserving"),
    ("deform_smooth_printed", "nan"): ("NaN", "z̃ = √(1 − |p|²) where |p| > 1, and 0/0 at h = n", "D′ = 0, no root"),
    ("deform_smooth_printed", "off"): ("off the disc", "p′ − √w·Δ passes the rim: not the inverse of Eq. 4",
                                       "D′ = 0 there"),
    "deform_linear": ("squeezed", WARP, "as printed; `rotate` is the default, …_conserving keeps the energy"),
    "deform_smooth": ("squeezed", WARP, "as printed; `rotate` is the default, …_conserving keeps the energy"),
    ("deform_smooth", "off"): ("off the disc", "p′ − √w·Δ passes the rim", "D′ = 0: black, not NaN"),
    "deform_linear_conserving": ("squeezed", WARP + "; and none of it turns below the horizon, as some of the truth",
                                 "`rotate`"),
    "deform_smooth_conserving": ("squeezed", WARP + "; and none of it turns below the horizon, as some of the truth",
                                 "`rotate`"),
    ("deform_linear_conserving", "jump"): ("step at h = n", "the stretch of the linear warp has two limits at h = n",
                                           "the same: D′ is finite on either side"),
    ("deform_smooth_conserving", "jump"): ("step at h = n", "the stretch of the smooth warp has two limits at h = n",
                                           "the same: D′ is finite on either side"),
    ("deform_smooth_conserving", "off"): ("off the disc", "p′ − √w·Δ passes the rim", "D′ = 0: black, not NaN"),
    "none": ("normal ignored", "the lobe stays about z", "`rotate`; `none` is for comparison"),
    "perturb": ("azimuth of h", "the exponent is that of h's azimuth about z, which is not the lobe's about n",
                "`auto`: perturb for round lobes alone, where it is exact"),
    ("perturb", "jump"): ("no azimuth", "at h = z the azimuth of (hx, hy) has no limit", "cos²φ = ½ at h = z: finite"),
    ("perturb", "weights"): ("three lobes drawn", "D′ is no lobe that can be drawn; much of it lies below the horizon",
                             "a mixture of three lobes, the widest of which bounds the weight"),
    "gram_schmidt": ("strokes turned", "x made orthogonal to n is not dP/du: strokes leave the surface's own",
                     "`rotate`"),
    "shortest_arc": ("strokes twisted", "the smallest turn from z to n turns strokes about n, too", "`rotate`"),
    "ward_no_squares": ("grows", "exp(−2(hx/αx + hy/αy)/(1 + hz)) grows where hx or hy < 0", "(hx/αx)² + (hy/αy)²"),
    ("ward_no_squares", "jump"): ("cut at the horizon", "it is largest where z̃ = 0 cuts it", "the square falls to 0"),
    "ward_of_h": ("stays about z", "x and y are those of h, z alone is rotated", "all three of T⁻¹h"),
    ("ward_of_h", "jump"): ("cut at the horizon", "x and y of h do not fall to 0 where n·h does", "all three of T⁻¹h"),
    "beckmann_unnormalised": ("not a unit vector", "(hx, hy, n·h): tan θ is taken of sin about z and cos about n",
                              "tan²θ from n × h"),
    "ggx_unnormalised": ("not a unit vector", "(hx, hy, n·h): tan θ is taken of sin about z and cos about n",
                         "tan²θ from n × h"),
    "beckmann_short_of_l": ("too wide", "x̃, ỹ are short by L = √(1 − ny²), and slopes see it",
                            "`rotate` divides their squares by L²"),
    "ggx_short_of_l": ("too wide", "x̃, ỹ are short by L = √(1 − ny²), and slopes see it",
                       "`rotate` divides their squares by L²"),
    ("ggx_rotate", "jump"): ("tail ends", "GGX has not come to 0 at the carried horizon, z̃ = 0", "the same"),
    "literal": ("pow of a cosine", "(n·h)^e multiplies the rounding of n·h by e",
                "log1p of the sine's square: cross products, no cancellation"),
    "valid_reflection": ("n bent by the eye", "n is bent until the eye's mirror image is above the surface",
                         "by choice: `hard` and `schuessler` are reciprocal"),
    "valid_estevez": ("n bent by the eye", "n is bent by the eye, and light alone is faded",
                      "by choice, nearest to displaced bumps: `hard` and `schuessler` are reciprocal"),
    "estevez": ("light faded", "light is faded towards the horizon, the eye is not",
                "by choice: `hard` and `schuessler` are reciprocal"),
    "chiang": ("light faded", "light is faded towards the horizon, the eye is not",
               "by choice: `hard` and `schuessler` are reciprocal"),
    ("", "wide jump"): ("cut where z̃ = 0", "a lobe this wide has not come to 0 at the carried horizon, z̃ = 0",
                        "the same: what lies below is the surface's other side"),
    ("ward_no_squares", "wide jump"): ("cut where z̃ = 0", "it is largest where z̃ = 0 cuts it", "the square falls to 0"),
    ("ward_no_squares", "wide nan"): ("overflows", "exp(…) grows where hx or hy < 0, beyond any number where α is small",
                                      "the square falls to 0"),
    ("", "eye jump"): ("cut at n's horizon", "f cos is black below n·wo = 0 and has not come to 0 there",
                       "by choice: `valid_estevez`, the default, and `schuessler` do not jump"),
    ("", "light jump"): ("cut at the horizon", "f cos is black below wi.z = 0 and has not come to 0 there",
                         "by choice: `valid_estevez`, the default, fades it"),
    ("valid_reflection", "light jump"): ("cut at the horizon", "f cos is black below wi.z = 0 and has not come to 0 there",
                                         "by choice: `valid_estevez`, the default, fades it"),
    ("valid_reflection", "light furnace"): ("n bent to the light", "n bent for the eye takes more light than the facet "
                                            "meets", "by choice: `valid_estevez`, the default, keeps below 1"),
    ("estevez", "eye jump"): ("cut at n's horizon", "f cos is black below n·wo = 0 and has not come to 0 there",
                       "by choice: `valid_estevez`, the default, and `schuessler` do not jump"),
    ("chiang", "eye jump"): ("cut at n's horizon", "f cos is black below n·wo = 0 and has not come to 0 there",
                       "by choice: `valid_estevez`, the default, and `schuessler` do not jump"),
    ("none", "weights"): ("draws lost", BELOW, KEPT),
    ("fibre_printed", "fibre"): ("n_min turned round", "n_min along l × n_max changes sign with l·t",
                                 "Φ = (√(1 − (l·t)²) + n·l)/π"),
    ("fibre_printed", "fibre nan"): ("0/0", "l × n_max has no direction at l·t = 0", "Φ = (√(1 − (l·t)²) + n·l)/π"),
}
for _word in ("rotate", "deform_linear", "deform_smooth", "deform_linear_conserving", "deform_smooth_conserving",
              "gram_schmidt", "shortest_arc", "beckmann_rotate", "ggx_rotate", "valid_estevez"):
    REASONS[_word, "weights"] = ("draws lost", BELOW, KEPT)
for _word in ("deform_linear_conserving", "deform_smooth_conserving"):
    for _failure in ("wide jump", "eye jump", "light jump"):
        REASONS[_word, _failure] = REASONS[_word, "jump"]
for _failure in ("eye jump", "light jump"):
    REASONS["perturb", _failure] = ("horizon; no azimuth", "black below a horizon; and at h = z the azimuth of h has no "
                                    "limit", "`valid_estevez` and `rotate`")
for _word in ("ward_of_h", "beckmann_short_of_l", "ggx_short_of_l", "beckmann_unnormalised", "ggx_unnormalised"):
    REASONS.setdefault((_word, "jump"), ("cut at the horizon", "D′ has not come to 0 where n·h does",
                                         "`rotate`: the distribution's own tail"))


def reason(word, failure):
    """(name, reason, instead) of a region, or None: nobody has explained it."""
    for key in ((word, failure), (word, ALIAS.get(failure)), ("", failure), word):
        if key in REASONS:
            return REASONS[key]
    return None


@dataclass(frozen=True)
class Region:
    """Rows of one form that fail in one way. `worst`: the row that fails most."""

    form: str
    failure: str
    rows: tuple
    worst: dict

    @property
    def default(self):
        """Whether what is set from the start meets it: rotate, of any distribution, under valid_estevez where a horizon counts."""
        return any(row["form"] in DEFAULTS and row.get("horizon", HORIZON) == HORIZON for row in self.rows)

    @property
    def map(self):
        return FAILS[self.failure][0]

    @property
    def value(self):
        return FAILS[self.failure][1](self.worst)

    @property
    def explained(self):
        return reason(self.form, self.failure)

    @property
    def name(self):
        return self.explained[0] if self.explained else "unexplained"

    @property
    def label(self):
        return FORMS[self.form].label if self.form in FORMS else self.form.replace("_", " ")

    def where(self):
        """Extents of the region in the map's columns, in words."""
        said = []
        for column in AXES[self.map]:
            values = sorted({row[column] for row in self.rows})
            unit = "" if column == "size" else "°"
            said.append(f"{column} {values[0]:g}" + (f" … {values[-1]:g}" if values[1:] else "") + unit)
        return ", ".join(said).replace("-", "−")

    def place(self):
        """What `study_atlas.py --at` takes to print the sample that fails most."""
        row = self.worst
        said = [f"form={self.form if self.map == 'pairs' else row['form']}"]
        for column in ("horizon", "tilt", "azimuth", "theta", "size", "n_theta", "n_phi", "h_theta", "h_phi", "eye",
                       "eye_azimuth", "light", "light_azimuth"):
            key = f"{PREFIX.get(self.failure, '')}{column}"
            key = key if key in row else column
            if key in row and row[key] != "":
                said.append(f"{column}={row[key]:.9g}" if isinstance(row[key], float) else f"{column}={row[key]}")
        return " ".join(said)


def key_of(row):
    """What a region is of: the form; where `rotate` has several horizons, the horizon but for `hard`."""
    if row["map"] == "pairs":
        return row["horizon"]
    several = row["map"] in ("light", "eye", "narrow") and row["form"] == "rotate" and row["horizon"] != "hard"
    return row["horizon"] if several else row["form"]


def regions(rows):
    """All regions that fail, in the order of FAILS and of the rows."""
    found = {}
    for failure, (which, measure, limit, _what) in FAILS.items():
        for row in rows:
            if row["map"] == which and measure(row) > limit:
                found.setdefault((failure, key_of(row)), []).append(row)
    return [Region(form, failure, tuple(listed), max(listed, key=FAILS[failure][1]))
            for (failure, form), listed in found.items()]
