# SPDX-License-Identifier: Apache-2.0
"""What runs items. Each engine is a module with

    check()                        an error where it cannot be had here
    commands(job, numbers)         what `--dry-run` shows, a line each
    submit(job, numbers, round_)   begins them; returns the exit status of what is known by then
    state(job)                     (numbers that run or wait by its own word or None, [lines of what hangs, with the cure])
    cancel(job)                    ends what runs
"""

import files

from . import local, slurm

BY_NAME = {"local": local, "slurm": slurm}


def of(job):
    """That of a submission's last start."""
    return BY_NAME[files.read_json(job.path("engine.json"), {}).get("engine", job.said["engine"])]
