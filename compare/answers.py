# SPDX-License-Identifier: Apache-2.0
"""What stands first on the report: if your surface … use … costs … fails where, a line each, from rows of the studies."""
from dataclasses import dataclass

import detail_speed_page as speed
import fronts
import study_cloth
import study_diffuse
import study_horizons
import study_lobes
import study_precision
import style


@dataclass(frozen=True)
class Answer:
    """A line of the table. Its last two are measured; `surface` begins with a small letter."""

    surface: str
    use: str
    costs: str
    fails: str


def times(value):
    return f"{value:.1f} ×" if value < 9.95 else f"{value:.0f} ×"


def percent(value):
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def spread(values, form):
    low, high = form(min(values)), form(max(values))
    return low if low == high else f"{low.removesuffix(' %').removesuffix(' ×')} to {high}"


def detail(rows):
    tilts, mdfs = speed.tilts_of(rows), speed.mdfs_of(rows)
    low, steep = tilts[0], tilts[-1]

    def error(method, tilt):
        return speed.error(rows, method, tilt)["error"]

    def cost(method, other):
        return [fronts.ratio(speed.times(rows, method, mdf), speed.times(rows, other, mdf))[0] for mdf in mdfs]

    worst = max(speed.error(rows, "rotate", t, mdf)["error_most"] for t in tilts for mdf in mdfs)
    return [
        Answer("is brushed or grooved, and has bumps", "`rotate`, the default",
               f"{spread(cost('rotate', 'perturb'), times)} `perturb`",
               f"nowhere to {steep}° of tilt: less than {style.power(10 * worst)} off" if worst < 1e-9 else
               f"{percent(worst)} off at its worst"),
        Answer("is as rough along as across", "`auto`, which is `perturb` there", "the least",
               f"once it is longer than wide: {percent(error('perturb', low))} off at {low}°"),
        Answer("must look as other renderers have it", "`gram_schmidt`",
               f"{spread(cost('gram_schmidt', 'rotate'), times)} `rotate`",
               f"on steep bumps: {percent(error('gram_schmidt', low))} off at {low}°, {percent(error('gram_schmidt', 45))} at 45°"),
    ]


def horizons(rows):
    def both(choice, most=90.0):
        return spread([study_horizons.share(rows, mdf, choice, most) for mdf in study_horizons.MDFS], percent)

    def cost(choice):
        return spread([fronts.ratio(*(fronts.times(rows, kind="speed", distribution=mdf, method=c) for c in (choice, "hard")))[0]
                       for mdf in study_horizons.MDFS], times)

    return [
        Answer("is seen or lit at low angles", "`valid_estevez`, the default", f"{cost('valid_estevez')} `hard`",
               f"light below 15° is still {both('valid_estevez', 15.0)} off; light and eye cannot be exchanged"),
        Answer("is traced from the lights, too", "`hard`", "the least",
               f"light below 15°: {both('hard', 15.0)} off"),
    ]


def precision(rows):
    found = {mdf: {p.word: p for p in study_precision.points(rows, mdf)} for mdf in study_precision.mdfs_of(rows)}
    error = {form: max(of[form].error for of in found.values()) for form in study_precision.FORMS}
    cost = [fronts.ratio(of["double"].times, of["float"].times)[0] for of in found.values()]
    return [Answer("is only looked at", "float", "the least", f"values are up to {style.rounded(error['float'])} off"),
            Answer("is measured or compared", "double", f"{spread(cost, times)} float",
                   f"values are up to {style.rounded(error['double'])} off")]


def lobes(rows):
    each = {case: {p.word: p for p in study_lobes.points(rows, *case)} for case in study_lobes.cases(rows)}

    def error(word, *maps):
        return [of[word].error for (key, _mdf), of in each.items() if key in maps]

    cost = [fronts.ratio(of["lobes_6"].times, of["lobes_1"].times)[0] for of in each.values()]
    ripples = error("lobes_6", "ripples")
    return [
        Answer("has a normal map, seen from afar", "with six lobes", f"{spread(cost, times)} one lobe",
               (f"on even ripples: {spread(ripples, percent)} off; else " if ripples else "")
               + f"colours are up to {percent(max(error('lobes_6', 'waves', 'scratches')))} off"),
        Answer("has one, and time is short", "with one lobe", "the least",
               f"up to {percent(max(error('lobes_1', 'waves', 'scratches')))} off on random bumps"),
    ]


def cloth(rows):
    names = study_cloth.names_of(rows)
    points = {form: [study_cloth.point(rows, name, form) for name in names] for form in study_cloth.FORMS[1:]}
    cost = [fronts.ratio(*(fronts.times(rows, kind="speed", cloth=name, method=form) for form in ("far", "near")))[0]
            for name in names]
    return [
        Answer("is cloth, its yarns wider than pixels", "near", "the least", "from afar: it needs a sample for every yarn"),
        Answer("is cloth from afar", "far", f"{spread(cost, times)} near",
               f"colours are up to {percent(max(p.error for p in points['far']))} off; by one lobe a yarn up to "
               f"{percent(max(p.error for p in points['single']))}"),
    ]


def diffuse(rows):
    error = {p.word: p.error for p in study_diffuse.points(rows)}
    cost = fronts.ratio(*(fronts.times(rows, kind="speed", method=m) for m in ("fibre_view", "lambert")))[0]
    return [
        Answer("scatters as fibres or brushed grooves do", "`fibre_view`", f"{times(cost)} `lambert`",
               f"{percent(error['fibre_view'])} off in the mean; `max_normal` {percent(error['max_normal'])}"),
        Answer("is matt, without direction", "`lambert`", "the least", f"on fibres: {percent(error['lambert'])} off"),
    ]


ANSWERS = {"speed": ("detail", detail), "horizons": ("horizon", horizons), "precision": ("precision", precision),
           "lobes": ("normal-map filter", lobes), "cloth": ("cloth", cloth), "diffuse": ("diffuse", diffuse)}


def of(name, rows):
    """(what they are about, lines of a study)."""
    return (ANSWERS[name][0], ANSWERS[name][1](rows)) if name in ANSWERS else ("", ())
