# SPDX-License-Identifier: Apache-2.0
"""What comes after the items: those that failed once more, then frames of their parts, then the movie."""

import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import files
import item
import job as jobs

ROUNDS = 3  # an item is tried once and twice again


def frames_of(job):
    """{frame: its items' numbers}."""
    found = {}
    for number, one in enumerate(job.items):
        found.setdefault(one.get("frame"), []).append(number)
    return found


def merge(job):
    """All frames whose items are whole, and their movie. Returns what is wrong, a line each."""
    missing, wrong, ready = set(job.missing()), [], []
    for frame, numbers in frames_of(job).items():
        if not missing.intersection(numbers):
            ready.append((frame, numbers))

    def one(frame, numbers):
        try:
            if item.is_part(job.items[numbers[0]]):
                item.merge_frame(job, frame, numbers)
            else:
                item.show(job, str(numbers[0]))
        except (files.Refusal, OSError) as error:
            wrong.append(f"merge of {'the picture' if frame is None else f'frame {frame}'}: {error}; on {files.host()}, log {job.log(item.key_of_frame(frame))}")

    with ThreadPoolExecutor(max(1, len(os.sched_getaffinity(0)) // job.said["threads"])) as pool:
        list(pool.map(lambda both: one(*both), ready))
    for number in sorted(missing):
        told = files.read_json(job.path("failed", f"{number}.json"), {})
        wrong.append(f"{job.name_of(number)}: {told.get('message', 'it never began')}; on {told.get('host', 'no machine')}, log {job.log(number)}")
    if not wrong:
        for name in os.listdir(job.path("work")):
            shutil.rmtree(job.path("work", name), ignore_errors=True)
        text = movie(job)
        if text:
            print(text)
    files.write_json(job.path("finished.json"), {"wrong": wrong})
    return wrong


def pictures(job):
    """Of each frame the first picture, in their order."""
    found = []
    for frame, numbers in frames_of(job).items():
        key = item.key_of_frame(frame) if item.is_part(job.items[numbers[0]]) else str(numbers[0])
        found.append(job.path("frames", os.path.basename(job.result(key)[0])))
    return found


def movie(job):
    """What is said of it, or ""."""
    said, found = job.said["movie"], pictures(job)
    if not said or len(found) < 2:
        return ""
    if not shutil.which("ffmpeg"):
        return f"no movie: ffmpeg is not installed here; frames are in {job.path('frames')}"
    place = job.path("frames", job.said["name"] + ".mp4")
    ending = os.path.splitext(found[0])[1].lower()
    with tempfile.TemporaryDirectory(dir=job.path("work"), prefix="movie-") as work:
        for number, path in enumerate(found):
            os.symlink(path, os.path.join(work, f"{number:06}{ending}"))
        made = os.path.join(work, "movie.mp4")
        # numbers in an EXR are light, and its picture may be one of many layers
        light = ["-apply_trc", "iec61966_2_1", *(["-layer", said["layer"]] if said.get("layer") else [])] if ending == ".exr" else []
        done = subprocess.run(["ffmpeg", "-nostdin", "-v", "error", *light, "-framerate", str(said["rate"]), "-i", os.path.join(work, "%06d" + ending),
                               "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", made],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace")
        if done.returncode:
            return f"no movie: ffmpeg says: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else done.returncode}"
        os.replace(made, place)
    return f"movie: {place}"


def after(folder, round_, engine):
    """The dependent job: what is missing is submitted again, until it was tried three times."""
    job = jobs.Job(folder)
    missing = job.missing()
    for number in missing:
        item.note_ended(job, number)
    if missing and round_ + 1 < ROUNDS and not job.is_cancelled():
        print(f"{len(missing)} of {len(job.items)} items failed; they are tried again")
        try:
            engine.submit(job, missing, round_ + 1)
            return 0
        except files.Refusal as error:
            print(f"{error}; go on with: libshade-farm resume {folder}", file=sys.stderr)
    wrong = merge(job)
    for line in wrong:
        print(line)
    return 1 if wrong else 0
