# SPDX-License-Identifier: Apache-2.0
"""Colours of metals from their spectra: published complex indices of refraction, by wavelength, under the light D65 as the observer
of 1931 sees it, in linear Rec. 709.

    build/venv/bin/python libshade/test/metal_spectra.py

prints the rows of SHADE_TABLE_METALS (libshade/include/shade/table.h): for red, green and blue the index of which Fresnel's formula is
nearest to the colour's reflectance from head-on to grazing.
"""
import numpy as np

# [JohnsonChristy1972], [JohnsonChristy1974], [Rakic1995], [Karlsson1982] (ferritic), [Querry1985] (70 % copper): nm, n, k
TABLES = {
    "silver": """
        367.9 0.07 1.657; 381.5 0.05 1.864; 397.4 0.05 2.07; 413.3 0.05 2.275; 430.5 0.04 2.462; 450.9 0.04 2.657;
        471.4 0.05 2.869; 495.9 0.05 3.093; 520.9 0.05 3.324; 548.6 0.06 3.586; 582.1 0.05 3.858; 616.8 0.06 4.152;
        659.5 0.05 4.483; 704.5 0.04 4.838; 756 0.03 5.242""",
    "gold": """
        367.9 1.48 1.895; 381.5 1.46 1.933; 397.4 1.47 1.952; 413.3 1.46 1.958; 430.5 1.45 1.948; 450.9 1.38 1.914;
        471.4 1.31 1.849; 495.9 1.04 1.833; 520.9 0.62 2.081; 548.6 0.43 2.455; 582.1 0.29 2.863; 616.8 0.21 3.272;
        659.5 0.14 3.697; 704.5 0.13 4.103; 756 0.14 4.542""",
    "copper": """
        367.9 1.36 1.975; 381.5 1.33 2.045; 397.4 1.32 2.116; 413.3 1.28 2.207; 430.5 1.25 2.305; 450.9 1.24 2.397;
        471.4 1.25 2.483; 495.9 1.22 2.564; 520.9 1.18 2.608; 548.6 1.02 2.577; 582.1 0.7 2.704; 616.8 0.3 3.205;
        659.5 0.22 3.747; 704.5 0.21 4.205; 756 0.24 4.665""",
    "aluminium": """
        364.7 0.39877 4.3957; 413.3 0.52135 5.0008; 442.8 0.6079 5.3676; 476.9 0.7278 5.7781; 516.6 0.8734 6.2418;
        563.6 1.0728 6.7839; 619.9 1.366 7.4052; 652.2 1.5724 7.7354; 688.8 1.8301 8.0601; 729.3 2.1606 8.3565""",
    "iron": """
        368 2.02 2.43; 381 2.12 2.5; 397 2.24 2.58; 413 2.35 2.65; 431 2.48 2.71; 451 2.59 2.77; 471 2.67 2.82; 496
        2.74 2.88; 521 2.86 2.91; 549 2.95 2.93; 582 2.94 2.99; 617 2.88 3.05; 659 2.92 3.1; 704 2.86 3.19; 756 2.87
        3.28""",
    "chromium": """
        368 1.87 2.69; 381 1.92 2.74; 397 2 2.83; 413 2.08 2.93; 431 2.19 3.04; 451 2.33 3.14; 471 2.51 3.24; 496 2.75
        3.3; 521 2.94 3.33; 549 3.18 3.33; 582 3.22 3.3; 617 3.17 3.3; 659 3.09 3.34; 704 3.05 3.39; 756 3.08 3.42""",
    "titanium": """
        368 1.9 2.9; 381 1.99 2.93; 397 2.08 2.95; 413 2.14 2.98; 431 2.21 3.01; 451 2.27 3.04; 471 2.32 3.1; 496 2.36
        3.19; 521 2.44 3.3; 549 2.54 3.43; 582 2.6 3.58; 617 2.67 3.72; 659 2.76 3.84; 704 2.86 3.96; 756 3 4.01""",
    "stainless_steel": """
        360 1.1694 2.2971; 380 1.2344 2.4214; 400 1.3075 2.534; 420 1.3766 2.6334; 440 1.4517 2.7256; 460 1.5372
        2.8162; 480 1.6307 2.9055; 500 1.7244 2.9919; 520 1.8059 3.0721; 540 1.873 3.1404; 560 1.9355 3.2004; 580
        1.9969 3.2617; 600 2.0565 3.3248; 620 2.1139 3.3881; 640 2.1685 3.4507; 660 2.2199 3.5118; 680 2.2679 3.5707;
        700 2.3124 3.6273; 720 2.3536 3.6821; 740 2.3917 3.7354; 760 2.4268 3.7877""",
    "brass": """
        360 1.503 1.815; 370 1.497 1.818; 380 1.487 1.818; 390 1.471 1.813; 400 1.445 1.805; 410 1.405 1.794; 420 1.35
        1.786; 430 1.278 1.784; 440 1.191 1.797; 450 1.094 1.829; 460 0.994 1.883; 470 0.9 1.957; 480 0.816 2.046; 490
        0.745 2.145; 500 0.686 2.25; 510 0.639 2.358; 520 0.602 2.464; 530 0.573 2.568; 540 0.549 2.668; 550 0.527
        2.765; 560 0.505 2.86; 570 0.484 2.958; 580 0.468 3.059; 590 0.46 3.159; 600 0.45 3.253; 610 0.452 3.345; 620
        0.449 3.434; 630 0.445 3.522; 640 0.444 3.609; 650 0.444 3.695; 660 0.445 3.778; 670 0.444 3.86; 680 0.444
        3.943; 690 0.445 4.025; 700 0.446 4.106; 710 0.448 4.186; 720 0.45 4.266; 730 0.452 4.346; 740 0.455 4.424;
        750 0.457 4.501; 760 0.458 4.579""",
}
# The observer of 1931 and D65 [CIE 15], 380 to 720 nm by 10.
NM = np.arange(380.0, 721.0, 10.0)
X_BAR = np.array([.0014, .0042, .0143, .0435, .1344, .2839, .3483, .3362, .2908, .1954, .0956, .032, .0049, .0093,
    .0633, .1655, .2904, .4334, .5945, .7621, .9163, 1.0263, 1.0622, 1.0026, .8544, .6424, .4479, .2835, .1649, .0874,
    .0468, .0227, .0114, .0058, .0029])
Y_BAR = np.array([0, .0001, .0004, .0012, .004, .0116, .023, .038, .06, .091, .139, .208, .323, .503, .71, .862, .954,
    .995, .995, .952, .87, .757, .631, .503, .381, .265, .175, .107, .061, .032, .017, .0082, .0041, .0021, .001])
Z_BAR = np.array([.0065, .0201, .0679, .2074, .6456, 1.3856, 1.7471, 1.7721, 1.6692, 1.2876, .813, .4652, .272, .1582,
    .0782, .0422, .0203, .0087, .0039, .0021, .0017, .0011, .0008, .0003, .0002, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
D65 = np.array([49.98, 54.65, 82.75, 91.49, 93.43, 86.68, 104.86, 117.01, 117.81, 114.86, 115.92, 108.81, 109.35,
    107.80, 104.79, 107.69, 104.41, 104.05, 100.00, 96.33, 95.79, 88.69, 90.01, 89.60, 87.70, 83.29, 83.70, 80.03,
    80.21, 82.28, 78.28, 69.72, 71.61, 74.35, 61.60])
XYZ_TO_RGB = np.array([[3.2404542, -1.5371385, -.4985314], [-.9692660, 1.8760108, .0415560], [.0556434, -.2040259, 1.0572252]])
ANGLES = np.arange(0, 88, 3)  # degrees


def weights():
    """(3, wavelengths): what of a reflectance is red, green and blue; of a white one 1 each."""
    rgb = XYZ_TO_RGB @ (np.array([X_BAR, Y_BAR, Z_BAR]) * D65)
    return rgb / rgb.sum(axis=1, keepdims=True)


def fresnel(n, k, cosine):
    """Of what conducts: the mean of both polarisations, by the complex formula."""
    index = np.asarray(n) + 1j * np.asarray(k)
    inside = np.sqrt(index ** 2 - 1 + cosine ** 2)
    across, along = (cosine - inside) / (cosine + inside), (index ** 2 * cosine - inside) / (index ** 2 * cosine + inside)
    return (abs(across) ** 2 + abs(along) ** 2) / 2


def spectrum(metal):
    """n, k at NM, linear between the table's places."""
    nm, n, k = np.array([[float(number) for number in row.split()] for row in TABLES[metal].split(";")]).T
    return np.interp(NM, nm, n), np.interp(NM, nm, k)


def reflectance(metal):
    """(3, angles): linear Rec. 709; may leave 0 to 1, as what is purer than its primaries does."""
    n, k = spectrum(metal)
    return weights() @ fresnel(n[:, None], k[:, None], np.cos(np.radians(ANGLES)))


def fit(wanted):
    """The pair n, k whose curve is nearest, weighted by the cosine, head-on eightfold: a search, finer each time."""
    cosine = np.cos(np.radians(ANGLES))
    weight = np.where(ANGLES == 0, 8.0, cosine)
    low, high = np.log([.02, .3]), np.log([6.0, 9.0])
    for _ in range(9):
        n, k = np.exp(np.linspace(low, high, 61)).T
        error = ((fresnel(n[:, None, None], k[:, None], cosine) - wanted) ** 2 * weight).sum(axis=-1)
        i, j = np.unravel_index(error.argmin(), error.shape)
        middle, part = np.log([n[i], k[j]]), (high - low) / 10
        low, high = middle - part, middle + part
    return n[i], k[j]


if __name__ == "__main__":
    for name in TABLES:
        pairs = np.array([fit(channel) for channel in np.clip(reflectance(name), 0, 1)])
        print(name, *(f"{number:.4g}" for number in (*pairs[:, 0], *pairs[:, 1])))
