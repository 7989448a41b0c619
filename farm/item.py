# SPDX-License-Identifier: Apache-2.0
"""One item, on whatever machine; and one frame, merged of its items."""

import os
import resource
import shlex
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import files
import renderers

_TOUCH_SECONDS = 10


class Ended(BaseException):
    """By a signal."""


def _on_signal(number, _frame):
    raise Ended(number)


class Log:
    """What an item and its renderer say, appended to its file."""

    def __init__(self, path):
        self.path, self.file = path, open(path, "ab")  # noqa: SIM115

    def say(self, text):
        self.file.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} {files.host()} {os.getpid()}: {text}\n".encode("utf-8", "surrogateescape"))
        self.file.flush()

    def run(self, words, folder=None, environment=None):
        """A renderer. Returns what it said; an error names its last line."""
        self.say((f"in {folder}: " if folder else "") + shlex.join(map(str, words)))
        begun = self.file.tell()
        try:
            child = subprocess.Popen(list(map(str, words)), stdin=subprocess.DEVNULL, stdout=self.file, stderr=subprocess.STDOUT, cwd=folder,
                                     env={**os.environ, **(environment or {})})
        except OSError as error:
            raise files.Refusal(f"{words[0]}: cannot be run: {error.strerror}; --program says where it is") from error
        try:
            status = child.wait()
        except BaseException:
            child.terminate()
            try:
                child.wait(20)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
            raise
        with open(self.path, "rb") as file:
            file.seek(begun)
            said = file.read().decode("utf-8", "replace")
        if status:
            lines = [line for line in said.splitlines() if line.strip()]
            raise files.Refusal(f"{os.path.basename(str(words[0]))} ended with {status}: {lines[-1].strip() if lines else 'it said nothing'}")
        if "LIBSHADE_ISA '" in said:  # the library's warning that this machine has no such
            raise files.Refusal(f"this machine has no {os.environ.get('LIBSHADE_ISA')}, to which items are held")
        return said


class _Touched:
    """A file that is touched while something runs."""

    def __init__(self, path):
        self.path, self.ended = path, threading.Event()

    def _touch(self):
        while not self.ended.wait(_TOUCH_SECONDS):
            try:
                os.utime(self.path)
            except OSError:
                pass

    def __enter__(self):
        try:
            files.write_json(self.path, {"host": files.host(), "pid": os.getpid()})
        except OSError:
            pass
        threading.Thread(target=self._touch, daemon=True).start()

    def __exit__(self, *_):
        self.ended.set()
        files.remove(self.path)


def _make(job, key, log, render):
    """The result `key`, of what render(folder) leaves there: [(its file, the name in frames/ or None)]."""
    work = tempfile.mkdtemp(dir=job.path("work"), prefix=f"{key}-{files.host()}-")
    os.chmod(work, 0o755)
    begun = time.time()
    try:
        if job.said.get("isa"):
            os.environ["LIBSHADE_ISA"] = job.said["isa"]
        os.environ.update(job.said.get("environment", {}))
        names = render(work)
        for name in set(os.listdir(work)) - set(names):
            files.remove(os.path.join(work, name))
        memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024
        job.take(key, work, names, seconds=round(time.time() - begun, 3), ended=round(time.time(), 3), megabytes=memory)
    finally:
        shutil.rmtree(work, ignore_errors=True)


def show(job, key):
    """The pictures of a whole result, in frames/."""
    for path in job.result(key) if job.said["pictures"] else []:
        place = job.path("frames", os.path.basename(path))
        if not (os.path.exists(place) and os.path.samefile(place, path)):
            files.publish(path, place)


def run(job, number):
    """0: its result is whole; 1: it failed, and is named. What is whole is not made again."""
    for name in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(name, _on_signal)
    key = str(number)
    whole = not is_part(job.items[number])
    if job.is_whole(key, thorough=True):
        if whole:
            show(job, key)
        print(f"{job.name_of(number)} is whole already")
        return 0
    log = None
    try:
        log = Log(job.log(number))
        with _Touched(job.path("running", number)):
            log.say(job.name_of(number))
            job.check_inputs()
            renderer = renderers.of(job.said["scene"])
            _make(job, key, log, lambda work: renderer.render(job, job.items[number], work, log))
            if whole:
                show(job, key)
            files.remove(job.path("failed", f"{number}.json"))
            log.say("done")
        return 0
    except (files.Refusal, OSError) as error:
        failed(job, number, log, str(error))
        return 1
    except Ended as ended:
        failed(job, number, log, f"ended by {signal.Signals(ended.args[0]).name}")
        return 128 + ended.args[0]


def failed(job, number, log, text):
    print(f"{job.name_of(number)}: {text}; on {files.host()}, log {job.log(number)}", flush=True)
    try:
        if log:
            log.say(text)
        files.write_json(job.path("failed", f"{number}.json"), {"host": files.host(), "message": text, "log": job.log(number), "time": time.time()})
    except OSError:
        pass  # a full disk: it is missing all the same


def note_ended(job, number):
    """Of an item that no longer runs and is not whole: where it ran, unless it has said itself why it failed."""
    ran = files.read_json(job.path("running", number))
    if ran:
        told = {"host": ran["host"], "message": "it was killed, or its machine failed", "log": job.log(number), "time": time.time()}
        files.write_json(job.path("failed", f"{number}.json"), told)
        files.remove(job.path("running", number))


def is_part(item):
    return bool(item.get("tile") or item.get("share"))


def key_of_frame(frame):
    return "f" if frame is None else f"f{frame}"


def merge_frame(job, frame, numbers):
    """The picture of a frame, of its tiles and shares, which are whole."""
    key = key_of_frame(frame)
    if not job.is_whole(key, thorough=True):
        log = Log(job.log(key))
        for number in numbers:
            if not job.is_whole(str(number), thorough=True):
                raise files.Refusal(f"{job.name_of(number)}: its result is not whole")
        renderer = renderers.of(job.said["scene"])
        job.check_inputs()
        _make(job, key, log, lambda work: renderer.merge(job, frame, [(job.items[number], job.result(str(number))) for number in numbers], work, log))
    show(job, key)
