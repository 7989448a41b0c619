# SPDX-License-Identifier: Apache-2.0
"""Slurm: an array of jobs, and one that depends on it.

The array's tasks are items. The dependent job comes after all of them, however they ended: it submits what is missing again, twice
at most, then merges. So nothing needs Slurm's accounting, and it never waits for an item that failed.
"""

import os
import re
import shlex
import shutil
import subprocess
import time

import files

_TOO_LARGE = 1001  # MaxArraySize as Slurm is shipped


def check():
    if not shutil.which("sbatch"):
        raise files.Refusal("sbatch is not installed: this machine is no client of a Slurm cluster. On Debian install slurm-client (and munge), with "
                            "the cluster's slurm.conf and munge key; --engine local needs no scheduler")


def _call(*words):
    try:
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=120)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise files.Refusal(f"{words[0]}: {error}") from error
    if done.returncode:
        lines = (done.stderr or done.stdout).strip().splitlines()
        raise files.Refusal(f"{words[0]}: {lines[-1] if lines else f'ended with {done.returncode}'}")
    return done.stdout


def _largest_array():
    found = re.search(r"^MaxArraySize\s*=\s*(\d+)", _call("scontrol", "show", "config"), re.M)
    return int(found[1]) if found else _TOO_LARGE


def _spec(numbers):
    """1,3-5,9"""
    parts, numbers = [], sorted(numbers)
    for number in numbers:
        if parts and parts[-1][1] == number - 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ",".join(f"{a}" if a == b else f"{a}-{b}" for a, b in parts)


def _common(job, name):
    return ["sbatch", "--parsable", f"--job-name={name}", f"--chdir={job.folder}", "--output=log/slurm.out", "--open-mode=append"]


def _arrays(job, numbers, most):
    """(its words, the items that it has) of each: indices end below what Slurm takes."""
    groups = {}
    for number in numbers:
        groups.setdefault(number // most, []).append(number)
    for group, own in groups.items():
        index = "$SLURM_ARRAY_TASK_ID" if not group else f"$(({group * most} + SLURM_ARRAY_TASK_ID))"
        command = f"exec python3 {shlex.quote(job.program())} item {shlex.quote(job.folder)} {index}"
        yield [*_common(job, job.said["name"]), f"--array={_spec([number - group * most for number in own])}", "--requeue",
               f"--cpus-per-task={job.said['threads']}", *job.said["sbatch"], f"--wrap={command}"], own


def _dependent(job, ids, round_):
    command = f"exec python3 {shlex.quote(job.program())} merge {shlex.quote(job.folder)} --round {round_}"
    return [*_common(job, job.said["name"] + "-merge"), f"--dependency=afterany:{':'.join(ids)}", "--kill-on-invalid-dep=yes", "--requeue",
            f"--cpus-per-task={job.said['threads']}", *job.said["sbatch"], f"--wrap={command}"]


def commands(job, numbers):
    try:
        most = _largest_array()
    except files.Refusal:
        most = _TOO_LARGE
    arrays = [shlex.join(words) for words, _ in _arrays(job, numbers, most)]
    return [*arrays, shlex.join(_dependent(job, [f"ARRAY{k + 1}" for k in range(len(arrays))], 0))]


def submit(job, numbers, round_=0):
    check()
    ids = [_call(*words).strip().split(";")[0] for words, _ in _arrays(job, numbers, _largest_array())]
    files.write_json(job.path("engine.json"), {"engine": "slurm", "ids": ids, "round": round_})
    last = _call(*_dependent(job, ids, round_)).strip().split(";")[0]
    files.write_json(job.path("engine.json"), {"engine": "slurm", "ids": [*ids, last], "round": round_})
    print(f"submitted {len(numbers)} items as {', '.join(ids)}, the merge as {last}; see: libshade-farm status {shlex.quote(job.folder)}")
    return 0


def _ids(job):
    return files.read_json(job.path("engine.json"), {}).get("ids", [])


def _queue(job):
    """[(id, state, reason, node)] of what Slurm knows of."""
    ids = _ids(job)
    if not ids:
        return []
    try:
        lines = _call("squeue", "-h", "-r", "-j", ",".join(ids), "-o", "%i|%T|%r|%N").splitlines()
    except files.Refusal as error:
        if "Invalid job id" in str(error):  # all of them have ended long ago
            return []
        raise
    return [line.strip().split("|") for line in lines if line.count("|") == 3]


def state(job):
    """By its queue: how many wait or run; held ones and drained nodes."""
    try:
        queue = _queue(job)
        hangs = [f"{one} is held ({reason}); free it with: scontrol release {one}" for one, what, reason, _ in queue
                 if what == "PENDING" and ("held" in reason.lower() or reason.startswith("JobHeld"))]
        if any(what == "PENDING" for _, what, _, _ in queue):
            for line in _call("sinfo", "-h", "-N", "-o", "%N|%T|%E").splitlines():
                node, what, reason = (line.split("|", 2) + ["", ""])[:3]
                if re.match(r"drain|down", what) and f"node {node} " not in " ".join(hangs):
                    hangs.append(f"node {node} is {what} ({reason.strip()}); free it with: scontrol update nodename={node} state=resume")
    except files.Refusal as error:
        return None, [f"{error}; what follows is known by markers alone"]
    if not queue and not os.path.exists(job.path("finished.json")):
        hangs.append(f"Slurm knows no more of it; go on with: libshade-farm resume {shlex.quote(job.folder)}")
    return len([one for one in queue if "_" in one[0]]), hangs


def cancel(job):
    ids = _ids(job)
    if not ids:
        return
    try:
        _call("scancel", *ids)
    except files.Refusal as error:
        if "Invalid job id" not in str(error):
            raise
    end = time.time() + 20
    while time.time() < end and _queue(job):
        time.sleep(0.3)
