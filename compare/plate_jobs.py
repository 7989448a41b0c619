# SPDX-License-Identifier: Apache-2.0
"""plate_render.py's jobs from outside: in Blender, or in a Python that has Blender as a module."""
import json

import pictures
import plate
import programs
import report
import whole


def run(folder, jobs, python=None, normals=None):
    """({name: picture}, {name: seconds of each repeat}, Blender's version) of {name: job}. `normals`: the normal
    map, the plate's if there is none."""
    order = {"normal_map": str(folder / "normals.exr"), "result": str(folder / "seconds.json"),
             "jobs": list(jobs.values())}
    pictures.write_float(order["normal_map"], plate.normal_map(2048) if normals is None else normals)
    whole.write_text(folder / "jobs.json", json.dumps(order))
    script = programs.HERE / "plate_render.py"
    command = [str(python), str(script), "--", str(folder / "jobs.json")] if python else \
        programs.blender(script, folder / "jobs.json")
    report.step(f"Rendering the plate {len(jobs)} times", command, folder / "blender.log", programs.ADD_ON)
    result = json.loads((folder / "seconds.json").read_text(encoding="utf-8"))
    made = {name: pictures.read(job["output"]) for name, job in jobs.items()}
    return made, dict(zip(jobs, result["seconds"])), result["blender"]
