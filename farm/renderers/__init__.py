# SPDX-License-Identifier: Apache-2.0
"""What renders a scene, by the ending of its name. Each has

    examine(scene, options)           what a submission must know: a dict, of which
                                          frames    [a frame or None] where none are asked for
                                          size      (width, height), for tiles
                                          samples   of a pixel, for shares
                                          cloth     whether its samples are shaded together
                                          inputs    paths of all files that it reads
                                          no_tiles, no_shares   why there are none, or ""
                                          programs  which it needs
                                          and more that it wants to find again in job.said
    render(job, item, work, log)      the names of the files that it has made in the folder work
    merge(job, frame, parts, work, log)   likewise, of parts [(item, its files)]
    pack(scene, inputs, folder, options)  the scene in a folder with all that it reads
"""

import os

import files

from . import blender, commands, povray, saved

_BY_ENDING = {".shscene": saved, ".blend": blender, ".pov": povray, ".items": commands}


def of(scene):
    ending = os.path.splitext(scene)[1].lower()
    if ending not in _BY_ENDING:
        raise files.Refusal(f"{scene}: its name must end in {', '.join(_BY_ENDING)}")
    return _BY_ENDING[ending]


def cut(length, parts, grid=1):
    """Bounds of so many parts of about the same length, at multiples of a grid."""
    if parts > -(-length // grid):
        raise files.Refusal(f"{length} pixels cannot be cut into {parts} tiles" + (f" at multiples of {grid}" if grid > 1 else ""))
    cells = -(-length // grid)
    at = [min(length, cells * k // parts * grid) for k in range(parts + 1)]
    return list(zip(at, at[1:]))


def cuts_of_samples(samples, parts, together):
    """Bounds of shares: whole passes of the renderer where these are many, for cloth in any case."""
    if parts > samples:
        raise files.Refusal(f"{samples} samples cannot be cut into {parts} shares")
    ends = sorted({0, 4, 16, *range(64, samples, 64), samples} - set(range(samples + 1, 65)))
    if together and parts > len(ends) - 1:
        raise files.Refusal(f"the scene has cloth, whose samples are shaded together: of {samples} samples there are {len(ends) - 1} shares at most")
    at = [samples * k // parts for k in range(parts + 1)]
    if together or samples >= 64 * parts:
        for k in range(1, parts):
            left = [end for end in ends if at[k - 1] < end <= ends[len(ends) - 1 - (parts - k)]]
            at[k] = min(left, key=lambda end: abs(end - samples * k / parts))
    return list(zip(at, at[1:]))
