"""What the toolchain takes: generating, validating, starting, and a keystroke in an editor.

Times of processors are those of whole processes, start included; the starts themselves are measured
by the clock, by turns with an empty Python.
"""

from __future__ import annotations

import json
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import growth
import read_models
from figures import Blocks, rounded
from systems import MAPS, Measured, system_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scale import Scale

ROOT = Path(__file__).resolve().parent.parent
MODEL = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
SIZES = (100, 1000, 3000)
SHAPES = {
    "one map": {"own_maps": False},
    "own maps": {"own_maps": True},
    "own maps and frames": {"own_maps": True, "own_frames": True},
}
ELEMENTS = (1_000, 10_000, 100_000)
LINES = 1000
EMPTY = "python -c pass"
VERBS: dict[str, Sequence[str]] = {
    EMPTY: ("-c", "pass"),
    "jausml --version": ("-m", "jausml", "--version"),
    "jausml explain": ("-m", "jausml", "explain", "JML701"),
    "jausml validate": ("-m", "jausml", "validate", str(MODEL)),
    "jausml generate": ("-m", "jausml", "generate", "-q", str(MODEL), "-o", "out"),
}
"""The example system is validated and generated."""

_RUNS = 7
_LETTERS, _PAUSES = 40, 4
_BETWEEN_LETTERS = 0.08
_TYPED_AT = "/** A point"
_COMPLETED_AT = "nanoseconds -> "
_LONGEST = 300.0
"""Seconds after which a process is given up."""


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures all.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        `generate` by shape and size, `again` of the last shape by size for a model that has not
        changed, and `validate` by elements, in seconds of processor time;
        `verbs`, in seconds; `editor`, in milliseconds of processor time for each letter
        (`letter_ms`), for one whose completions are asked for (`completion_ms`), and for the check
        when typing pauses (`pause_ms`).
    """
    found: dict[str, Any] = {"generate": {}, "again": {}, "validate": {}}
    for name, shape in SHAPES.items():
        found["generate"][name] = {
            str(size): rounded(growth.seconds_to_generate(growth.connections(size, **shape)))
            for size in scale.cases(SIZES, 1)
        }
        print(f"  generate, {name}: {found['generate'][name]}", flush=True)
    for size in scale.cases(SIZES, 1):
        model = growth.connections(size, own_maps=True, own_frames=True)
        found["again"][str(size)] = rounded(growth.seconds_to_generate(model, again=True))
    print(f"  generate again: {found['again']}", flush=True)
    for elements in scale.cases(ELEMENTS, 1):
        with tempfile.TemporaryDirectory(dir=folder) as models:
            read_models.write_models(Path(models), elements)
            seconds = processor_seconds(["-m", "jausml", "validate", "-q", models])
        found["validate"][str(elements)] = rounded(seconds)
        print(f"  validate {elements} elements: {found['validate'][str(elements)]} s", flush=True)
    found["verbs"] = _starts(scale, folder)
    found["editor"] = _keystrokes(scale, folder)
    return found


def processor_seconds(arguments: Sequence[str]) -> float:
    """Returns the processor time of `python ARGUMENTS`, whatever its exit code."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], capture_output=True, timeout=_LONGEST, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def _starts(scale: Scale, folder: Path) -> dict[str, Any]:
    blocks = Blocks()
    order = list(VERBS.items())
    for _ in range(scale.count(_RUNS, 1)):
        blocks.begin()
        random.shuffle(order)
        for name, arguments in order:
            started = time.perf_counter()
            subprocess.run(
                [sys.executable, *arguments],
                check=True,
                capture_output=True,
                cwd=folder,
                timeout=_LONGEST,
            )
            blocks.add(name, time.perf_counter() - started)
    found = blocks.summary(against=EMPTY)
    told = ", ".join(f"{name} {found[name]['median']} s" for name in VERBS)
    print(f"  {told}", flush=True)
    return found


# ------------------------------------------------------------------ the editor


def text_of(lines: int) -> str:
    """Returns a text of about so many lines: the measured maps, and as many others as it takes."""
    idle = 0
    while (text := system_text({"edited": Measured(MAPS, idle)})).count("\n") < lines:
        idle += 5
    return text


def _keystrokes(scale: Scale, folder: Path) -> dict[str, float]:
    """Returns the processor time of a letter while typing goes on, and of the check at a pause."""
    path = folder / "edited.ros2jaus"
    text = text_of(LINES)
    path.write_text(text, encoding="utf-8")
    server = _Server(folder)
    try:
        uri = path.as_uri()
        document = {"uri": uri, "languageId": "ros2jaus", "version": 1, "text": text}
        server.tell("textDocument/didOpen", textDocument=document)
        server.until_published(1)
        version = 1

        def type_letters(count: int, place: str = _TYPED_AT, *, complete: bool = False) -> float:
            nonlocal version
            before, after = text.split(place, 1)
            line, column = before.count("\n"), len(before.rpartition("\n")[2]) + len(place)
            began = server.processor_time()
            for number in range(1, count + 1):
                version += 1
                server.tell(
                    "textDocument/didChange",
                    textDocument={"uri": uri, "version": version},
                    contentChanges=[{"text": f"{before}{place}{'a' * number}{after}"}],
                )
                if complete:
                    position = {"line": line, "character": column + number}
                    server.ask(
                        "textDocument/completion", textDocument={"uri": uri}, position=position
                    )
                time.sleep(_BETWEEN_LETTERS)
            server.until_published(version)
            time.sleep(0.1)
            return server.processor_time() - began

        single = statistics.mean(type_letters(1) for _ in range(scale.count(_PAUSES, 1)))
        letters = scale.count(_LETTERS, 3)
        typing = (type_letters(letters) - single) / (letters - 1)
        # The first one reads the library.
        once = type_letters(1, _COMPLETED_AT, complete=True)
        once = type_letters(1, _COMPLETED_AT, complete=True)
        completing = (type_letters(letters, _COMPLETED_AT, complete=True) - once) / (letters - 1)
    finally:
        server.end()
    found = {
        "letter_ms": rounded(1e3 * typing),
        "completion_ms": rounded(1e3 * completing),
        "pause_ms": rounded(1e3 * (single - typing)),
    }
    print(f"  {text.count(chr(10))} lines: {found}", flush=True)
    return found


class _Server:
    """A language server, and just enough of a client for it."""

    def __init__(self, folder: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "jausml", "language-server"],
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        params = {"processId": None, "rootUri": None, "capabilities": {}}
        self._asked = 0
        self._published: int | None = None
        self.ask("initialize", **params)
        self.tell("initialized")

    def tell(self, method: str, **params: Any) -> None:
        """Sends a notification."""
        self._send(method=method, params=params)

    def ask(self, method: str, **params: Any) -> None:
        """Sends a request and waits for its answer."""
        self._asked += 1
        self._send(id=self._asked, method=method, params=params)
        while self._receive().get("id") != self._asked:
            pass

    def until_published(self, version: int) -> None:
        """Waits for the problems of a version of the text."""
        while self._published != version:
            self._receive()

    def processor_time(self) -> float:
        """Returns its processor time in seconds, threads that have ended included."""
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / 100

    def end(self) -> None:
        """Ends it."""
        self._process.kill()
        self._process.communicate()

    def _send(self, **message: Any) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self._process.stdin is not None
        self._process.stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
        self._process.stdin.flush()

    def _receive(self) -> Any:
        assert self._process.stdout is not None
        size = 0
        while line := self._process.stdout.readline().strip():
            name, _, value = line.partition(b":")
            size = int(value) if name.lower() == b"content-length" else size
        if not size:
            raise RuntimeError("the language server has ended")
        message = json.loads(self._process.stdout.read(size))
        # Also while something else is waited for: it is told only once.
        if message.get("method") == "textDocument/publishDiagnostics":
            self._published = message["params"].get("version") or self._published
        return message
