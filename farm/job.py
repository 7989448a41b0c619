# SPDX-License-Identifier: Apache-2.0
"""A submission: a folder that holds all that is known of it.

    job.json       what was submitted, never changed: the scene, its inputs with their hashes, the items
    farm.pyz       this program, so that an item needs nothing but Python and the renderer
    results/N/     of item N, with item.json: appears by one rename, once all of it is whole
    results/fN/    of frame N, merged of its items
    failed/N.json  how item N failed last
    running/N      touched while it runs
    log/N.log      what it said
    work/          of items at work
    frames/        the pictures, and the movie
    engine.json    what the engine needs to know
    cancelled      there after `cancel`
"""

import os
import shutil
import time

import files

VERSION = 1
_ALIVE_SECONDS = 60  # a running item touches its file more often
_FOLDERS = ("results", "failed", "running", "log", "work", "frames", "checked")


class Job:
    def __init__(self, folder):
        self.folder = os.path.abspath(folder)
        self.said = files.read_json(self.path("job.json"))
        if not isinstance(self.said, dict) or self.said.get("version") != VERSION:
            raise files.Refusal(f"{folder}: no submission: job.json of version {VERSION} is missing there")

    @classmethod
    def planned(cls, folder, said):
        """One that is not there."""
        job = cls.__new__(cls)
        job.folder, job.said = folder, said
        return job

    @classmethod
    def create(cls, folder, said):
        """A folder of its own, or an error where it is there."""
        for name in _FOLDERS:
            os.makedirs(os.path.join(folder, name), exist_ok=True)
        files.write_json(os.path.join(folder, "job.json"), {"version": VERSION, **said})
        return cls(folder)

    def path(self, *parts):
        return os.path.join(self.folder, *map(str, parts))

    @property
    def items(self):
        return self.said["items"]

    def name_of(self, number):
        return name_of(number, self.items[number])

    def program(self):
        """What runs an item anywhere."""
        return self.path("farm.pyz")

    def shown(self):
        """Where a user looks for what was made."""
        return self.path("frames" if self.said["pictures"] else "results")

    def log(self, number):
        return self.path("log", f"{number}.log")

    # ---- results

    def is_whole(self, key, thorough=False):
        told = files.read_json(self.path("results", key, "item.json"))
        return bool(told) and all(files.is_as_told(self.path("results", key, one["path"]), one, thorough) for one in told["files"])

    def result(self, key):
        """The files of a whole result."""
        return [self.path("results", key, one["path"]) for one in files.read_json(self.path("results", key, "item.json"))["files"]]

    def take(self, key, work, names, **more):
        """A folder with files becomes the result, unless another copy was quicker."""
        for name in names:
            files.synced(os.path.join(work, name))
        said = [files.told(os.path.join(work, name), name) for name in names]
        files.write_json(os.path.join(work, "item.json"), {"files": said, "host": files.host(), **more})
        for _ in range(3):
            try:
                os.rename(work, self.path("results", key))
                break
            except OSError:
                if self.is_whole(key, thorough=True):
                    break
                broken = self.path("work", f"broken-{key}-{files.host()}-{os.getpid()}")
                shutil.rmtree(broken, ignore_errors=True)
                try:
                    os.rename(self.path("results", key), broken)
                except FileNotFoundError:
                    pass
        else:
            raise files.Refusal(f"{self.path('results', key)}: cannot be put there")

    def missing(self):
        return [number for number in range(len(self.items)) if not self.is_whole(str(number))]

    def is_alive(self, number, now):
        try:
            return now - os.path.getmtime(self.path("running", number)) < _ALIVE_SECONDS
        except OSError:
            return False

    def now(self):
        """By the clock of whoever keeps the folder."""
        probe = self.path("running", f".now-{files.host()}-{os.getpid()}")
        try:
            with open(probe, "w"):
                pass
            return os.path.getmtime(probe)
        except OSError:
            return time.time()
        finally:
            files.remove(probe)

    def is_cancelled(self):
        return os.path.exists(self.path("cancelled"))

    # ---- inputs

    def check_inputs(self):
        """Those that were submitted; a hash is not made again on a machine where size, place and time of a file stay."""
        cache = self.path("checked", f"{files.host()}.json")
        known = files.read_json(cache, {})
        before = dict(known)
        for said in self.said["inputs"]:
            path = self.path(said["path"])  # which may be absolute
            try:
                there = os.stat(path)
            except OSError as error:
                raise files.Refusal(f"{path}: an input is not there: {error.strerror}") from error
            stamp = [there.st_size, there.st_mtime_ns, there.st_ino, there.st_dev, said["sha256"]]
            if known.get(path) == stamp:
                continue
            if not files.is_as_told(path, said):
                raise files.Refusal(f"{path}: an input is another than was submitted; put the old one back, or submit again")
            known[path] = stamp
        if known != before:
            try:
                files.write_json(cache, known)
            except OSError:
                pass  # then it is made again


def name_of(number, item):
    if item.get("name"):
        return f"item {number} ({item['name']})"
    parts = [f"frame {item['frame']}"] if item.get("frame") is not None else []
    parts += [f"tile {','.join(map(str, item['tile']))}"] if item.get("tile") else []
    parts += ["samples {} to {}".format(item["share"][0], item["share"][1] - 1)] if item.get("share") else []
    return f"item {number}" + (f" ({', '.join(parts)})" if parts else "")
