# SPDX-License-Identifier: Apache-2.0
"""build/displaced from Python: displaced surfaces ray-cast beside the same bumps as normals."""
import csv
import subprocess

import numpy as np

import programs
import report

PROGRAM = programs.BUILD / "displaced"
METHODS = ("none", "perturb", "deform_linear", "deform_smooth", "gram_schmidt", "shortest_arc",
           "rotate_approximate", "rotate")
BASES, BUMPS = ("plate", "cylinder", "sphere"), ("waves", "scratches")
# label: (distribution, BRDF, along x, along y)
MATERIALS = {
    "Ashikhmin-Shirley 200, 10": ("ashikhmin_shirley", "ashikhmin_shirley", 200, 10),
    "Ashikhmin-Shirley 10, 200": ("ashikhmin_shirley", "ashikhmin_shirley", 10, 200),
    "Ashikhmin-Shirley 20, 20": ("ashikhmin_shirley", "ashikhmin_shirley", 20, 20),
    "Ward .1, .5": ("ward", "ward_1992", 0.1, 0.5),
    "GGX .1, .4": ("ggx", "microfacet", 0.1, 0.4),
}
GROOVED, ROUND = "Ashikhmin-Shirley 200, 10", "Ashikhmin-Shirley 20, 20"


def options(material):
    mdf, brdf, first, second = MATERIALS[material]
    return ["--mdf", mdf, "--brdf", brdf, "--first", str(first), "--second", str(second)]


def run(command, *arguments):
    try:
        done = subprocess.run([PROGRAM, command, *map(str, arguments)], capture_output=True, text=True,
                              check=False)
    except OSError as error:
        raise report.StepFailed(f"{PROGRAM}: {error.strerror}: make {PROGRAM.name}") from error
    if done.returncode:
        raise report.StepFailed(f"{PROGRAM.name}: {done.stderr.strip()}")


def read(path):
    """Rows of one of its CSV files, numbers as such."""
    words = ("base", "bumps", "distribution", "method")
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: text if key in words else float(text) for key, text in row.items()}
                for row in csv.DictReader(file)]


def read_pfm(path):
    """One channel, rows from the top."""
    with open(path, "rb") as file:
        kind, size, scale = (file.readline().strip() for _ in range(3))
        if kind != b"Pf":
            raise ValueError(f"{path}: expected a PFM of one channel")
        width, height = map(int, size.split())
        values = np.frombuffer(file.read(), "<f4" if float(scale) < 0 else ">f4")
    return values.reshape(height, width)[::-1].astype(float)


def pictures(folder, base, bumps, slope, material, methods=METHODS, size=128, over=1, lights=1,
             picture=False, seed=3):
    """(rows, {method: picture}) of one surface; "displaced" is the truth. Without `picture`, no pictures."""
    csv_file, pfm = folder / "pictures.csv", folder / "pictures.pfm"
    run("pictures", csv_file, *options(material), "--base", base, "--bumps", bumps, "--slope", slope,
        "--methods", ",".join(methods), "--size", size, "--over", over, "--lights", lights,
        "--seed", seed, *(["--picture", pfm] if picture else []))
    rows = [{"kind": "picture", "material": material, **row} for row in read(csv_file)]
    csv_file.unlink()
    shown = {}
    if picture:
        shown = dict(zip(("displaced", *methods), np.split(read_pfm(pfm), len(methods) + 1, axis=1)))
        pfm.unlink()
    return rows, shown


def lobes(folder, tilt, material, methods=METHODS, azimuths=45):
    """Rows of total variation."""
    file = folder / "lobes.csv"
    run("lobes", file, *options(material), "--tilt", tilt, "--methods", ",".join(methods),
        "--azimuths", azimuths)
    rows = [{"kind": "lobe", "material": material, **row} for row in read(file)]
    file.unlink()
    return rows
