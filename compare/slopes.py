# SPDX-License-Identifier: Apache-2.0
"""Slope pyramid against supersampling: is a normal map seen from afar the right roughness?

Each map is cut into patches. The library gives, for the footprint of each patch, the mean
normal, the covariance of the slopes and the lobes that stand for them, one and more; the truth
shades every one of the patch's texels, supersampled between them, with the material's own
lobe. Both are evaluated here, from the definitions, for 20 pairs of light and view, and the
mean colour over all patches is compared; so are the second moments of the slopes, patch by
patch, and how the mean colour moves as the footprint grows (a slow zoom out of the map).

Leaves in the output folder: slopes.csv, slopes.png. Exit status 0 if every map keeps the
limit on second moments, and with six lobes the random maps and the scratches keep that on
colour, whatever the distribution. The even ripples are measured, not judged: two moments do
not tell their slopes, which are most frequent at their ends, from a random map's.
"""
import argparse
from pathlib import Path

import numpy as np

import programs
import report
import shade
import truth
import whole

COLOUR_LIMIT, MOMENT_LIMIT = 0.03, 0.10
SIZE, OVER = 256, 2  # texels of a map; samples a texel and axis
FOOTPRINTS = (2, 4, 8, 16, 32, 64)  # texels along a side
LOBES = {  # distribution: parameters along and across
    "ashikhmin_shirley": (60.0, 12.0),
    "beckmann": (0.18, 0.36),
    "ward": (0.18, 0.36),
    "ggx": (0.18, 0.36),
}
LOBE_COUNTS, JUDGED_COUNT = (1, 4, 6, 8), 6
RIPPLES = "ripples 0.15, 0.10"


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "slopes",
                        help="folder for results (default build/compare/slopes)")
    return parser.parse_args(argv)


# ---- maps ----------------------------------------------------------------------------------

def gaussian_map(sigma_x, sigma_y, seed):
    """Slopes of a smooth random height field, as normals; it repeats. Rows from the top."""
    random = np.random.default_rng(seed)
    frequency = np.fft.fftfreq(SIZE)
    fx, fy = np.meshgrid(frequency, frequency)
    spectrum = np.fft.fft2(random.standard_normal((SIZE, SIZE)))
    spectrum *= np.exp(-((fx**2 + fy**2) * 6.0**2))
    # two fields of their own: the gradient of one field could not have any two variances
    x = np.real(np.fft.ifft2(spectrum * 2j * np.pi * fx))
    y = np.real(np.fft.ifft2(spectrum.T * 2j * np.pi * fy))
    x *= sigma_x / x.std()
    y *= sigma_y / y.std()
    return from_slopes(np.stack([x, 0.4 * x * sigma_y / sigma_x + y], -1))


def ripple_map(sigma_x, sigma_y):
    """Slopes of even ripples along x and y."""
    x, y = np.meshgrid(np.arange(SIZE), np.arange(SIZE))
    return from_slopes(np.stack([np.sqrt(2) * sigma_x * np.sin(2 * np.pi * 8 * x / SIZE),
                                 np.sqrt(2) * sigma_y * np.sin(2 * np.pi * 12 * y / SIZE)], -1))


def from_slopes(slopes):
    n = np.concatenate([-slopes, np.ones_like(slopes[..., :1])], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def scratch_map(**layer):
    return shade.Scratches(layer, cells=0).picture(SIZE, SIZE)[1].astype(float)


def supersampled(normals):
    """Slopes at 2 x 2 points a texel, interpolated bilinearly round the map's edges.

    The points are Gauss's between the texels' centres, so second moments are exact.
    """
    slopes = -normals[..., :2] / normals[..., 2:]
    gauss = 0.5 - 0.5 / np.sqrt(3.0)
    for axis in range(2):
        place = (np.arange(SIZE)[:, None] + [-gauss, gauss]).ravel()
        low = np.floor(place).astype(int)
        t = (place - low).reshape([-1 if k == axis else 1 for k in range(3)])
        slopes = ((1 - t) * np.take(slopes, low % SIZE, axis)
                  + t * np.take(slopes, (low + 1) % SIZE, axis))
    return slopes


# ---- the lobe, from its definition -----------------------------------------------------------

def distribution(mdf, first, second, x, y, z):
    """D at h = (x, y, z) in the lobe's own frame."""
    sin2 = np.maximum(x * x + y * y, 1e-300)
    z = np.maximum(z, 1e-12)
    if mdf == "ashikhmin_shirley":
        exponent = (first * x * x + second * y * y) / sin2
        return np.sqrt((first + 1) * (second + 1)) / (2 * np.pi) * z**exponent
    slope2 = (x * x / first**2 + y * y / second**2) / z**2
    scale = np.pi * first * second
    if mdf == "ggx":
        return 1 / (scale * z**4 * (1 + slope2) ** 2)
    return np.exp(-slope2) / (scale * (z**4 if mdf == "beckmann" else 1))


def shaded(mdf, first, second, slopes, wi, wo, turn=0.0):
    """f times the cosine of Ashikhmin and Shirley's BRDF without Fresnel; detail `rotate`.

    The lobe's x axis lies in the surface above (cos turn, sin turn).
    """
    h = (wi + wo) / np.linalg.norm(wi + wo)
    n = from_slopes(slopes)
    c, s = np.cos(turn), np.sin(turn)
    climb = c * slopes[..., 0] + s * slopes[..., 1]
    x = np.stack([c + 0 * climb, s + 0 * climb, climb], -1)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    y = np.cross(n, x)
    d = distribution(mdf, first, second, x @ h, y @ h, n @ h)
    ni, no = n @ wi, n @ wo
    seen = (ni > 0) & (no > 0) & (n @ h > 0)
    return np.where(seen, d * ni / (4 * (h @ wo) * np.maximum(np.maximum(ni, no), 1e-9)), 0.0)


def directions():
    """20 pairs, the half vectors at 0 to 35 degrees, lights and eyes to 60 from the normal."""
    random = np.random.default_rng(5)
    pairs = []
    while len(pairs) < 20:
        v = random.standard_normal((2, 3))
        v /= np.linalg.norm(v, axis=-1, keepdims=True)
        half = v.sum(0) / np.linalg.norm(v.sum(0))
        if v[:, 2].min() > 0.5 and half[2] > np.cos(np.radians(35)):
            pairs.append(v)
    return pairs


# ---- comparison --------------------------------------------------------------------------------

def look_up(slopes, footprint, mdf, parameters, lobes):
    """For every patch of footprint x footprint texels, what a shade.SlopeMap finds and makes of the
    lobe: normal, covariance, parameters along and across, degrees they are turned by; then weight
    and normal of each lobe, where fewer were needed the weight is 0.
    """
    side = footprint / SIZE
    centre = (np.arange(SIZE // footprint) + 0.5) * side
    u, v = np.meshgrid(centre, 1 - centre)
    seen = slopes.look_up(np.stack([u, v], -1).reshape(-1, 2), (side, 0, 0, side))
    names = ("ex", "ey") if mdf == "ashikhmin_shirley" else ("ax", "ay")
    material = shade.Material(mdf=mdf, brdf="ashikhmin_shirley", **dict(zip(names, parameters)))
    made = shade.split(material, seen.normal, seen.covariance, lobes)
    each = np.concatenate([made.weight[..., None], made.n], -1).reshape(len(made.x), -1)
    return np.column_stack([*seen, made.x, made.y, np.degrees(made.angle), each])


def mean_colours(mdf, got, lobes):
    """Over all patches, for each pair of directions."""
    turn = np.radians(got[:, 8])
    total = np.zeros(len(directions()))
    for weight, *n in got[:, 9:].reshape(-1, lobes, 4).transpose(1, 2, 0):
        if not weight.any():
            continue
        slopes = np.stack([-n[0] / n[2], -n[1] / n[2]], -1)
        total += [(weight * shaded(mdf, got[:, 6], got[:, 7], slopes, *pair, turn)).mean()
                  for pair in directions()]
    return total


def moments(slopes, footprint):
    """Second moments about zero of each patch: xx, xy, yy."""
    n = SIZE // footprint
    products = slopes[..., [0, 0, 1]] * slopes[..., [0, 1, 1]]
    return products.reshape(n, footprint * OVER, n, footprint * OVER, 3).mean((1, 3)).reshape(-1, 3)


def compare_map(name, normals):
    slopes, pyramid = supersampled(normals), shade.SlopeMap(normals, normals="signed")
    rows = []
    for mdf, (first, second) in LOBES.items():
        true = np.array([shaded(mdf, first, second, slopes, *pair).mean() for pair in directions()])
        for footprint in FOOTPRINTS:
            want = moments(slopes, footprint)
            size = want[:, [0, 2]].sum()
            for lobes in LOBE_COUNTS:
                got = look_up(pyramid, footprint, mdf, (first, second), lobes)
                mean = -got[:, :2] / got[:, 2:3]
                far = mean_colours(mdf, got, lobes)
                second_moments = got[:, 3:6] + mean[:, [0, 0, 1]] * mean[:, [0, 1, 1]]
                # as mean colours are: the difference of each pair over the mean of the truth
                rows.append({
                    "map": name, "distribution": mdf, "footprint": footprint, "lobes": lobes,
                    "colour": np.abs(far - true).mean() / true.mean(),
                    "worst": np.abs(far - true).max() / true.mean(),
                    "bias": (far.mean() - true.mean()) / true.mean(),
                    "moments": np.abs(second_moments.mean(0) - want.mean(0)).max()
                    / want.mean(0)[[0, 2]].sum(),
                    "patches": np.abs(second_moments - want)[:, [0, 2]].sum() / size,
                })
    return rows


def write_chart(rows, maps, path):
    plt = truth.pyplot(path.parent)
    figure, axes = plt.subplots(3, len(maps), figsize=(4 * len(maps), 9), layout="constrained",
                                squeeze=False)
    for column, name in enumerate(maps):
        for mdf in LOBES:
            mine = [r for r in rows if r["map"] == name and r["distribution"] == mdf]
            judged = [r for r in mine if r["lobes"] == JUDGED_COUNT]
            x = [r["footprint"] for r in judged]
            axes[0, column].plot(LOBE_COUNTS, [100 * worst(mine, lobes) for lobes in LOBE_COUNTS],
                                 marker="o", label=mdf)
            axes[1, column].plot(x, [100 * r["colour"] for r in judged], marker="o", label=mdf)
        axes[2, column].plot(x, [100 * r["moments"] for r in judged], marker="o", color="black",
                             label="all patches together")
        axes[2, column].plot(x, [100 * r["patches"] for r in judged], marker="o", color="grey",
                             label="patch by patch")
        for row, limit in enumerate((COLOUR_LIMIT, COLOUR_LIMIT, MOMENT_LIMIT)):
            axes[row, column].axhline(100 * limit, color="black", linestyle=":", linewidth=1)
            axes[row, column].set_ylim(bottom=0)
        axes[0, column].set_title(name)
        axes[0, column].set_xlabel("lobes")
        for row in (1, 2):
            axes[row, column].set_xlabel("footprint, texels a side")
            axes[row, column].set_xscale("log", base=2)
    axes[0, 0].set_ylabel("mean colour, worst footprint, % off")
    axes[1, 0].set_ylabel(f"mean colour, {JUDGED_COUNT} lobes, % off")
    axes[2, 0].set_ylabel("second moments of slopes, % off")
    for row in range(3):
        axes[row, 0].legend()
    with whole.place(path) as part:
        figure.savefig(part, dpi=100)


def worst(rows, lobes):
    return np.max([r["colour"] for r in rows if r["lobes"] == lobes])  # NaN stays NaN


def main(argv=None):
    options = arguments(argv)
    folder = options.output.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    maps = {
        "waves 0.05, 0.10": gaussian_map(0.05, 0.10, 1),
        "waves 0.15, 0.10": gaussian_map(0.15, 0.10, 2),
        RIPPLES: ripple_map(0.15, 0.10),
        "scratches": scratch_map(pits=3000, radius=(0.004, 0.012), stretch=(2, 8),
                                 spread=np.radians(20), depth=(0.03, 0.12)),
    }
    rows = [row for name, normals in maps.items() for row in compare_map(name, normals)]
    whole.write_csv(folder / "slopes.csv", (
        {k: f"{v:.5g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows))
    write_chart(rows, list(maps), folder / "slopes.png")
    table, ok = [], True
    for name in maps:
        for mdf in LOBES:
            mine = [r for r in rows if r["map"] == name and r["distribution"] == mdf]
            moment, judged = np.max([r["moments"] for r in mine]), name != RIPPLES
            good = moment <= MOMENT_LIMIT and (
                not judged or worst(mine, JUDGED_COUNT) <= COLOUR_LIMIT)
            ok = ok and good
            table.append([name, mdf, *(f"{100 * worst(mine, k):.2f}" for k in LOBE_COUNTS),
                          f"{100 * COLOUR_LIMIT:g} with {JUDGED_COUNT}" if judged else "",
                          f"{100 * moment:.2f}", f"{100 * MOMENT_LIMIT:g}",
                          "ok" if good else "MISSED"])
    print(report.table(["map", "distribution", *(f"{k} lobes" if k > 1 else "colour, %: 1 lobe"
                                                 for k in LOBE_COUNTS),
                        "limit", "moments, %", "limit", ""], table))
    print(f"\nFigures: {folder}")
    return 0 if ok else 1


if __name__ == "__main__":
    report.run(main)
