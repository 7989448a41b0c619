# SPDX-License-Identifier: Apache-2.0
"""Debian's Chromium without a window, driven by its DevTools protocol over a pair of pipes."""
import base64
import json
import os
import select
import shutil
import subprocess
import time


class Page:
    """A page in a browser of its own: `with Page(path, width) as page:`."""

    def __init__(self, path, folder, width=1280, height=900, dark=False):
        self.path, self.width, self.height, self.dark, self.folder = path, width, height, dark, folder
        self.number, self.buffer, self.said = 0, b"", []

    def __enter__(self):
        ours_in, theirs_out = os.pipe()
        theirs_in, ours_out = os.pipe()

        def place():  # the protocol's pipes are descriptors 3 and 4
            high_in, high_out = os.dup(theirs_in), os.dup(theirs_out)
            os.dup2(high_in, 3)
            os.dup2(high_out, 4)

        program = shutil.which("chromium") or "chromium"
        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
             "--disable-dev-shm-usage", "--disable-background-networking", "--disable-extensions",
             f"--user-data-dir={self.folder}", "--remote-debugging-pipe"],
            preexec_fn=place, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(theirs_in)
        os.close(theirs_out)
        self.reader, self.writer, self.session = ours_in, ours_out, None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.size(self.width, self.height)
        self.call("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": "dark" if self.dark else "light"},
            {"name": "prefers-reduced-motion", "value": "reduce"}])  # links jump at once
        self.call("Page.navigate", url=self.path.as_uri())
        self.until("document.readyState === 'complete'")
        return self

    def __exit__(self, *_error):
        self.process.kill()
        self.process.wait()
        os.close(self.reader)
        os.close(self.writer)

    def receive(self, seconds=60):
        """The next message; TimeoutError if none comes."""
        end = time.monotonic() + seconds
        while b"\0" not in self.buffer:
            if not select.select([self.reader], [], [], max(end - time.monotonic(), 0))[0]:
                raise TimeoutError("no word from chromium")
            chunk = os.read(self.reader, 1 << 16)
            if not chunk:
                raise RuntimeError(f"chromium ended: exit status {self.process.poll()}")
            self.buffer += chunk
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.writer, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            kind = answer.get("method")
            if kind == "Runtime.exceptionThrown":
                self.said.append(answer["params"]["exceptionDetails"]["text"])
            if kind == "Runtime.consoleAPICalled" and answer["params"]["type"] in ("error", "warning", "assert"):
                self.said.append(str(answer["params"]["args"]))
            if kind == "Log.entryAdded" and answer["params"]["entry"]["level"] in ("error", "warning"):
                self.said.append(answer["params"]["entry"]["text"])

    def size(self, width, height):
        """Of the window, in pixels; narrow ones are a phone's."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)

    def run(self, script):
        """The value of an expression in the page."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{script}: {answer['exceptionDetails']['exception']['description']}")
        return answer["result"].get("value")

    def until(self, script, seconds=30):
        end = time.monotonic() + seconds
        while not self.run(script):
            if time.monotonic() > end:
                raise TimeoutError(f"never true: {script}")
            time.sleep(0.02)

    def key(self, name, code, text=""):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code,
                      **({"text": text} if text and kind == "keyDown" else {}))

    def picture(self, path):
        """The whole page as PNG."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        shot = self.call("Page.captureScreenshot", captureBeyondViewport=True,
                         clip={"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1})
        path.write_bytes(base64.b64decode(shot["data"]))
