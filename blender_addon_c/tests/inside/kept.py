# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene edited at random: is what a viewport keeps of it what a fresh read finds?

arguments: SEED STEPS. Prints "STEP n edit ... READ meshes" each, "DIFFERENT where", at the end "SAME".
"""

import importlib
import os
import sys

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common
import edits

seed, steps = (int(word) for word in common.arguments())
edits.chance.seed(seed)


# ---- are they the same?


def differences(a, b, at="scene"):
    if isinstance(a, dict) and isinstance(b, dict):
        if a.keys() != b.keys():
            yield f"{at}: {sorted(a.keys() ^ b.keys())}"
        for key in a.keys() & b.keys() - {"apart"}:
            yield from differences(a[key], b[key], f"{at}.{key}")
    elif isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        if len(a) != len(b):
            yield f"{at}: {len(a)} and {len(b)}"
        for k, (one, other) in enumerate(zip(a, b)):
            yield from differences(one, other, f"{at}[{k}]")
    elif isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        same = a is not None and b is not None and np.shape(a) == np.shape(b) and np.asarray(a).dtype == np.asarray(b).dtype
        if not same or np.asarray(a).tobytes() != np.asarray(b).tobytes():
            yield f"{at}: arrays"
    elif repr(a) != repr(b):
        yield f"{at}: {a!r:.60} and {b!r:.60}"


def read(depsgraph, kept=None):
    messages = export.Messages()
    camera = export.camera_by(Matrix.Identity(4), Matrix.Identity(4), (0.1, 100))
    while True:
        try:
            made = export.read(depsgraph, camera, (8, 8), (0, 0, 8, 8), 1, messages, kept=kept)
            return {**made, "warnings": sorted(messages.warnings), "errors": sorted(messages.errors)}
        except export.Later:
            messages = export.Messages()


common.enable()
export = importlib.import_module(common.MODULE + ".export")
# Before there is a scene that updates anyhow.
wrong = 0
told = []
hear = lambda _scene, depsgraph: told.extend(update.id.original for update in depsgraph.updates)
bpy.app.handlers.depsgraph_update_post.append(hear)
scene, layer = bpy.context.scene, bpy.context.view_layer
for owner, name in ((None, ""), (scene, "samples"), (scene, "caustics_reflective"), (scene, "pixel_filter_type"),
                    (layer, "use_pass_shadow_catcher")):
    layer.update()
    told.clear()
    if owner:
        was = getattr(owner.libshade, name)
        setattr(owner.libshade, name, "BOX" if isinstance(was, str) else not was if isinstance(was, bool) else was + 1)
    layer.update()
    if (scene in told) != (owner is not None):
        print("DIFFERENT: what a viewport is told of", name)
        wrong += 1
    if owner:
        setattr(owner.libshade, name, was)
bpy.app.handlers.depsgraph_update_post.remove(hear)

edits.build()
kept = export.Kept()
for updated in (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post):
    updated.append(lambda _scene, depsgraph: kept.changed(depsgraph))
graph = bpy.context.evaluated_depsgraph_get()
for _ in range(2):
    assert not list(differences(read(graph, kept), read(graph)))
assert kept.meshes_read == len(read(graph, kept)["meshes"]) > 6
was = read(graph, kept)["meshes"]
for step in range(steps):
    names = edits.some_names()
    if bpy.context.mode != "OBJECT":  # others could not be done there
        names = edits.chance.choice([["edit_mode"], ["edit_lamp", "edit_move"]])
    for name in names:
        edits.EDITS[name]()
    graph = bpy.context.evaluated_depsgraph_get()
    before = kept.meshes_read
    again = read(graph, kept)
    print("STEP", step, *names, "READ", kept.meshes_read - before, "of", len(again["meshes"]), flush=True)
    for where in differences(again, read(graph)):
        print("DIFFERENT", where)
        wrong += 1
    known = {id(mesh["positions"]) for mesh in was}
    kinds = {f"object '{ob.name}'": ob.type for ob in bpy.data.objects}
    news = [mesh["name"] for mesh in again["meshes"] if id(mesh["positions"]) not in known]
    # what is keyed may ask for another map
    keyed = "edit_frame" in names and any(m.node_tree and m.node_tree.animation_data for m in bpy.data.materials)
    if set(names) <= edits.CHEAP and not keyed and bpy.context.mode == "OBJECT":
        for name in news:  # 5.0 makes curves, texts and metaballs again where a material changes
            if kinds[name] == "MESH":
                print("DIFFERENT: read again:", name)
                wrong += 1
    was = again["meshes"]
print("WRONG" if wrong else "SAME")
common.finish()
