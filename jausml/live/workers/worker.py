"""The process of a worker: generated code, the runtime, and a script that has nothing of jausml.

The script answers each line of JSON on its input with one on its output.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import tempfile
import threading
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jausml

if TYPE_CHECKING:
    from jausml.live.workers.bridge_code import BridgeCode

_BOOTSTRAP = Path(__file__).with_name("bootstrap.py")
_RUNTIME = Path(jausml.__file__).parent / "runtime"
_MOST_WORDS = 100


class WorkerError(Exception):
    """A worker that has no answer; the text says why."""


class Worker:
    """A process with the generated code of bridges; close it at the end."""

    def __init__(self, code: BridgeCode, script: Path, *arguments: str) -> None:
        """Starts it."""
        self._lock = threading.Lock()
        self._folder = tempfile.TemporaryDirectory(prefix="jausml_worker_")
        workspace = Path(self._folder.name)
        for path, text in code.files.items():
            file = workspace / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        line = [str(_BOOTSTRAP), str(_RUNTIME), str(workspace), str(script), *arguments]
        self._process = subprocess.Popen(  # noqa: S603 - our own script
            [sys.executable, "-I", "-B", *line],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
        )
        self._words: deque[str] = deque(maxlen=_MOST_WORDS)
        # Whoever fills a pipe that nobody reads waits forever.
        self._listener = threading.Thread(target=self._listen, name="worker", daemon=True)
        self._listener.start()

    def _listen(self) -> None:
        if self._process.stderr is not None:
            with contextlib.suppress(ValueError):  # it was closed meanwhile
                self._words.extend(self._process.stderr)

    @property
    def is_alive(self) -> bool:
        """Whether it can be asked."""
        return self._process.poll() is None

    def ask(self, request: Any, seconds: float) -> Any:
        """Returns its answer.

        Args:
            seconds: How long it may take; then it is ended.
        """
        late = threading.Event()

        def end() -> None:
            late.set()
            self._process.kill()

        with self._lock:
            timer = threading.Timer(seconds, end)
            timer.start()
            try:
                line = self._told(request)
            finally:
                timer.cancel()
        if line:
            return json.loads(line)
        if late.is_set():
            raise WorkerError(f"the translation took longer than {seconds:g} s")
        raise WorkerError(f"the translation failed: {self._last_words()}")

    def _told(self, request: Any) -> str:
        """Returns the line that answers a request, nothing when the process has ended."""
        if self._process.stdin is None or self._process.stdout is None:
            return ""
        try:
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
            return self._process.stdout.readline()
        except (OSError, ValueError):  # its pipes were closed meanwhile
            return ""

    def _last_words(self) -> str:
        self._process.wait()
        self._listener.join()
        return next(reversed(self._words), "").strip() or "its process has ended"

    def close(self) -> None:
        """Ends it."""
        self._process.kill()
        self._process.wait()
        self._listener.join()
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            if pipe is not None:
                with contextlib.suppress(OSError):  # of what was not read any more
                    pipe.close()
        self._folder.cleanup()
