# SPDX-License-Identifier: Apache-2.0
"""As many items at once as this machine's cores allow."""

import contextlib
import os
import shlex
import signal
import subprocess
import sys
import threading
import time

import files
import finish
import item


def check():
    pass


def _words(job, number):
    return [sys.executable, job.program(), "item", job.folder, str(number)]


def commands(job, numbers):
    return [shlex.join(["python3", job.program(), "item", job.folder, str(number)]) for number in numbers]


class _Run:
    """Some items, by a few threads that each wait for one."""

    def __init__(self, job, numbers):
        self.job, self.left = job, list(reversed(numbers))
        self.children, self.lock, self.ended = set(), threading.Lock(), False

    def work(self):
        while True:
            with self.lock:
                if not self.left or self.ended:
                    return
                number = self.left.pop()
                child = subprocess.Popen(_words(self.job, number), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                         start_new_session=True, text=True, errors="replace")
                self.children.add(child)
            said, _ = child.communicate()
            with self.lock:
                self.children.discard(child)
                ended = self.ended
            if child.returncode and not ended:
                if child.returncode < 0:
                    files.remove(self.job.path("running", number))
                    item.failed(self.job, number, None, f"its process was ended by {signal.Signals(-child.returncode).name}")
                else:
                    print(said.strip(), file=sys.stderr)

    def end(self):
        with self.lock:
            self.ended = True
            for child in self.children:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(child.pid, signal.SIGTERM)  # and its renderer, also one that it has just begun


def _progress(job, begun, done_before, slots):
    left = len(job.missing())
    done = len(job.items) - left
    text = f"{done} of {len(job.items)} items are whole"
    if done > done_before and left:
        text += f", {duration((time.time() - begun) / (done - done_before) * left)} remain"
    return text


def duration(seconds):
    minutes, seconds = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes:02}:{seconds:02}"


def _on_signal(_number, _frame):
    raise KeyboardInterrupt


def submit(job, numbers, _round=0):
    """To the end; Ctrl-C stops it, and `resume` goes on."""
    slots = max(1, len(os.sched_getaffinity(0)) // job.said["threads"])
    files.write_json(job.path("engine.json"), {"engine": "local", "pid": os.getpid(), "host": files.host()})
    stop = threading.Event()  # an exception might come anywhere, also where threads are begun and waited for
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, lambda *_: stop.set())
    begun, before = time.time(), len(job.items) - len(job.missing())
    for attempt in range(finish.ROUNDS):
        run = _Run(job, numbers)
        threads = [threading.Thread(target=run.work) for _ in range(min(slots, len(numbers)))]
        for thread in threads:
            thread.start()
        told = time.time()
        while any(thread.is_alive() for thread in threads) and not (stop.is_set() or job.is_cancelled()):
            stop.wait(0.1)
            if time.time() - told > 2:
                told = time.time()
                print(_progress(job, begun, before, slots), file=sys.stderr, flush=True)
        if stop.is_set() or job.is_cancelled():
            run.end()
            for thread in threads:
                thread.join()
            print(f"stopped; go on with: libshade-farm resume {shlex.quote(job.folder)}", file=sys.stderr)
            return 130
        numbers = job.missing()
        if not numbers:
            break
        if attempt + 1 < finish.ROUNDS:
            print(f"{len(numbers)} items failed; they are tried again", file=sys.stderr)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, _on_signal)
    wrong = finish.merge(job)
    for line in wrong:
        print(line, file=sys.stderr)
    print(f"{len(job.items) - len(job.missing())} of {len(job.items)} items are whole; {'frames' if job.said['pictures'] else 'results'} are in {job.shown()}")
    return 1 if wrong else 0


def _runner(job):
    """The process that runs it, if that is on this machine and alive."""
    said = files.read_json(job.path("engine.json"), {})
    if said.get("host") != files.host() or not said.get("pid"):
        return None
    try:
        with open(f"/proc/{said['pid']}/cmdline", "rb") as file:
            words = file.read()
    except OSError:
        return None
    return said["pid"] if b"submit" in words or b"resume" in words else None


def state(job):
    return None, ([] if _runner(job) or os.path.exists(job.path("finished.json")) else [f"nothing runs it on {files.host()}; go on with: libshade-farm resume {shlex.quote(job.folder)}"])


def cancel(job):
    pid = _runner(job)
    if pid:
        os.kill(pid, signal.SIGTERM)
