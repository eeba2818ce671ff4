"""A headless Chromium that tests drive by its DevTools protocol, over a pair of pipes: no package
and no network is needed.
"""

import json
import os
import select
import shutil
import subprocess
import time

PROGRAM = (
    shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
)

_SECONDS_MAX = 60.0
"""Longest wait for an answer: a machine that is busy with other tests takes seconds."""

_OPTIONS = (
    "--headless", "--no-sandbox", "--no-first-run", "--disable-extensions", "--disable-background-networking", "--hide-scrollbars",
    "--remote-debugging-pipe", "--host-resolver-rules=MAP * ~NOTFOUND", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--webgl-antialiasing-mode=none", "--disable-gpu",
)  # fmt: skip
"""No name resolves, so that nothing is loaded from a network. The processor draws three dimensions
as a graphics processor would, with edges that are not smoothed, and the rest of the page in another
way: both are faster."""


class Browser:
    """A browser with one page.

    Parameters
    ----------
    profile : an empty directory that it may write to
    """

    def __init__(self, profile):
        to_read, self._write = os.pipe()
        self._read, to_write = os.pipe()
        # The browser reads commands from file 3 and writes answers to file 4.
        shell = f'exec "$0" "$@" 3<&{to_read} 4>&{to_write}'
        command = [
            "bash",
            "-c",
            shell,
            PROGRAM,
            *_OPTIONS,
            f"--user-data-dir={profile}",
            "about:blank",
        ]
        self._process = subprocess.Popen(
            command, pass_fds=(to_read, to_write), stderr=subprocess.DEVNULL
        )
        os.close(to_read)
        os.close(to_write)
        self._number, self._rest, self._session = 0, b"", None
        self.errors = []
        page = next(
            target
            for target in self.send("Target.getTargets")["targetInfos"]
            if target["type"] == "page"
        )
        self._session = self.send("Target.attachToTarget", targetId=page["targetId"], flatten=True)[
            "sessionId"
        ]
        for domain in ("Page", "Runtime", "Log"):
            self.send(f"{domain}.enable")

    def send(self, method, **parameters):
        """Send a command and return its answer; what the page complains of meanwhile is kept in
        ``errors``.
        """
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while (answer := self._next()).get("id") != self._number:
            self._note(answer)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def _next(self):
        while b"\0" not in self._rest:
            if not select.select([self._read], [], [], _SECONDS_MAX)[0]:
                raise TimeoutError(f"the browser has said nothing for {_SECONDS_MAX:g} s")
            piece = os.read(self._read, 1 << 16)
            if not piece:
                raise RuntimeError("the browser has ended")
            self._rest += piece
        message, self._rest = self._rest.split(b"\0", 1)
        return json.loads(message)

    def _note(self, event):
        of = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            details = of["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif event.get("method") == "Runtime.consoleAPICalled" and of["type"] in (
            "error",
            "warning",
            "assert",
        ):
            self.errors.append(
                " ".join(
                    str(argument.get("value", argument.get("description")))
                    for argument in of["args"]
                )
            )
        elif event.get("method") == "Log.entryAdded" and of["entry"]["level"] == "error":
            # Warnings are those of the driver about its speed.
            self.errors.append(of["entry"]["text"])

    def open(self, path, width=800, height=600):
        """Open a page from disk in a window of a size [px] and wait until it has run its scripts."""
        self.errors.clear()
        self.resize(width, height)
        self.send("Page.navigate", url=path.as_uri())
        address = json.dumps(path.as_uri())
        deadline = time.monotonic() + _SECONDS_MAX
        while not self.run(f"document.readyState === 'complete' && location.href === {address}"):
            if time.monotonic() > deadline:
                raise TimeoutError(f"{path.name} was not loaded within {_SECONDS_MAX:g} s")
            time.sleep(0.05)
        self.settle()

    def resize(self, width, height=600):
        """Give the window a size [px]."""
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        self.settle()

    def settle(self):
        """Wait until the page has drawn what it is to draw."""
        self.run(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))"
        )

    def run(self, script):
        """Return what an expression of JavaScript is in the page, once it is settled."""
        answer = self.send(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in answer:
            raise RuntimeError(
                answer["exceptionDetails"].get("exception", {}).get("description", script)
            )
        return answer["result"].get("value")

    def press(self, key):
        """Press a key and let it go."""
        names = {"key": key, "code": key}
        text = {"text": key} if len(key) == 1 else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", **names, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **names)

    def close(self):
        """End the browser."""
        os.close(self._write)
        os.close(self._read)
        try:
            self._process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
