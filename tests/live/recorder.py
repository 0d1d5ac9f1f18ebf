"""`jausml record` of the system of a test."""

import os
import signal
import subprocess
import sys

import needs
import warm

from jausml.live.systems.playback import indexed

from .bridge_support import wait_for

PATIENCE = 90.0


class Recorder:
    """It records from the beginning of the block until `end`, which returns what it has.

    `environment`: variables that it has besides.
    """

    def __init__(self, folder, model, port, **environment):
        self._environment = {**os.environ, **environment}
        self._path, self._log = folder / "recorded.mcap", folder / "record.log"
        self._words = ("record", str(model), "--output", str(self._path), "--port", str(port))

    def __enter__(self):
        needs.ask("capture")
        line = [*warm.command(), *self._words]
        with self._log.open("wb") as stream:
            self._process = subprocess.Popen(line, stderr=stream, env=self._environment)
        wait_for(lambda: "recording" in self._log.read_text(), "recorder", PATIENCE)
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        sys.stderr.write(self._log.read_text())

    def end(self):
        self._process.send_signal(signal.SIGTERM)
        assert self._process.wait(timeout=PATIENCE) == 0, self._log.read_text()
        return indexed(str(self._path))
