# SPDX-License-Identifier: Apache-2.0
"""The plate and the sphere of study_frames.py in POV-Ray, under the sun."""
import re
import time

import paths
import pictures
import plate
import programs
import report
import sphere
import whole

# x and y are the picture's; z points into it. The library's pi f cos is multiplied by the light's colour:
# a light of irradiance 1, as Blender's sun has, is rgb 1/pi.
SCENE = """#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level 2 }}
camera {{ orthographic location <0, 0, -2> right x up y direction z }}
light_source {{ <{0:.9f}, {1:.9f}, {2:.9f}> * 100 rgb 1/pi parallel point_at 0 }}
mesh2 {{
  #include "mesh.inc"
  uv_mapping
  texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{
    ggx {3:.9g}, {4:.9g} brdf microfacet specular rgb 1 detail rotate fresnel none horizon hard tangent uv
    bump_image {{ exr "normals.exr" }} }} }} }}
}}
"""


def mesh_text(shape):
    """Lists of mesh2: the flat plate, or the round sphere, without relief."""
    if shape == "plate":
        positions, normals, faces, uv = plate.mesh(1)
        positions = positions * (1, 1, 0)
    else:
        positions, normals, faces, uv = sphere.mesh(sphere.FLAT, False)
    blocks = [("vertex_vectors", "<{:.9g}, {:.9g}, {:.9g}>", positions * (1, 1, -1))]
    if shape != "plate":
        blocks.append(("normal_vectors", "<{:.9g}, {:.9g}, {:.9g}>", normals * (1, 1, -1)))
    blocks.append(("uv_vectors", "<{:.9g}, {:.9g}>", uv))
    blocks.append(("face_indices", "<{}, {}, {}>", [t for a, b, c, d in faces.tolist() for t in ((a, b, c), (a, c, d))]))
    return "\n".join(f"{name} {{ {len(rows)},\n" + ",\n".join(form.format(*row) for row in rows) + "\n}"
                     for name, form, rows in blocks)


def run(folder, shape, size, alphas, sides, repeat):
    """{side: (picture, seconds of each turn, version)}. Samples are a larger picture's, averaged: POV-Ray's own
    anti-aliasing is not the box that the others filter by."""
    sun = plate.SUN
    whole.write_text(folder / "mesh.inc", mesh_text(shape))
    whole.write_text(folder / "frame.pov", SCENE.format(sun[0], sun[1], -sun[2], *alphas))
    found = {}
    for side in sides:
        seconds = []
        for _turn in range(repeat):
            begun = time.perf_counter()
            said = report.step("in POV-Ray", [programs.POVRAY, "frame.pov", "+Opovray.exr", "+FE", f"+W{size * side}",
                                              f"+H{size * side}", "-D", "-A"], folder / "povray.log", folder=folder)
            seconds.append(time.perf_counter() - begun)
        version = re.search(r"POV-Ray \d\S*", said or "")
        found[side] = (paths.blocks(pictures.read(folder / "povray.exr"), side), seconds,
                       version[0] if version else "POV-Ray")
    return found
