"""A headless Chromium on a pipe: opens a page from disk, hears of every error and request, runs expressions, takes screenshots. No library, no port."""

import base64
import contextlib
import json
import os
import shutil
import subprocess
from pathlib import Path

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
FOUND = next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """One page. `errors`: console errors, exceptions and violations of the policy; `requests`: addresses that were asked for."""

    def __init__(self, folder):
        down, up = os.pipe(), os.pipe()  # we write to 3, and read from 4

        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", f"--user-data-dir={folder}", "--no-first-run"]
        shell = ["bash", "-c", f'exec "$@" 3<&{down[0]} 4>&{up[1]}', "browser", FOUND, *flags, "about:blank"]
        self.process = subprocess.Popen(shell, pass_fds=(down[0], up[1]), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(down[0])
        os.close(up[1])
        self.out, self.into, self.number, self.session, self.left = down[1], up[0], 0, None, b""
        self.errors, self.requests, self.events = [], [], []
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")

    def read(self):
        while b"\0" not in self.left:
            data = os.read(self.into, 2**20)
            assert data, "the browser ended"
            self.left += data
        text, _, self.left = self.left.partition(b"\0")
        return json.loads(text)

    def ask(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters} | ({"sessionId": self.session} if self.session else {})
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            got = self.read()
            if got.get("id") == self.number:
                assert "error" not in got, got
                return got["result"]
            self.hear(got)

    def hear(self, event):
        what, about = event.get("method"), event.get("params", {})
        self.events.append(what)
        if what == "Runtime.exceptionThrown" or (what == "Log.entryAdded" and about["entry"]["level"] in ("error", "warning")):
            self.errors.append(about)
        if what == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning"):
            self.errors.append(about)
        if what == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])

    def open(self, path, width=1100, height=1600, dark=False):
        self.errors, self.requests, self.events = [], [], []
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.ask("Page.navigate", url=Path(path).resolve().as_uri())
        while "Page.loadEventFired" not in self.events:
            self.hear(self.read())
        return self

    def value(self, expression):
        got = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in got, got
        return got["result"].get("value")

    def mouse(self, kind, x, y):
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="none" if kind == "mouseMoved" else "left", buttons=1, clickCount=1)

    def screenshot(self, path):
        Path(path).write_bytes(base64.b64decode(self.ask("Page.captureScreenshot", captureBeyondViewport=True)["data"]))

    def close(self):
        with contextlib.suppress(OSError):
            os.close(self.out)
        self.process.kill()
        self.process.wait()
        os.close(self.into)
