"""Processes with the generated code of bridges, and bridges that no file has for them.

The script of a process has nothing of jausml, and answers each line of JSON on its input with one.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import tempfile
import threading
from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import jausml
from jausml.generation.artifact import find_problems, text_digest
from jausml.generation.errors import GenerationError
from jausml.generation.rendering import render
from jausml.language.metamodel import Metamodels
from jausml.language.metamodel.classes import bridge, system
from jausml.language.metamodel.filling import make
from jausml.language.model import Model
from jausml.language.model.model import made_model
from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.messages.target import TARGET as MESSAGES


@dataclass(frozen=True)
class BridgeCode:
    """The generated code of bridges."""

    files: Mapping[str, str]
    digest: str


def bridge_code(model: Model) -> BridgeCode:
    """Returns the generated code of the bridges of a model, without the runtime."""
    artifacts = render(model, (BRIDGE, MESSAGES))
    problems = find_problems(artifacts)
    if problems:
        raise GenerationError(next(iter(problems.values())))
    files = {
        artifact.path: artifact.text
        for artifact in artifacts
        if artifact.path.endswith(".py")
        and artifact.path.count("/") == 2
        and "/test/" not in artifact.path
    }
    digest = text_digest("\n".join(f"{path}\n{text}" for path, text in sorted(files.items())))
    return BridgeCode(files, digest)


Element: TypeAlias = "bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection"


def bridge_of_maps(
    metamodels: Metamodels,
    name: str,
    connections: Mapping[str, tuple[bridge.AttributeMap, bool]],
    like: Iterable[Element] = (),
) -> Model:
    """Makes a system with a bridge of connections by maps.

    Args:
        like: Connections whose policies and quantities count; of several, those of the first.
    """
    bridge_connections = [
        _connection(metamodels, used, connection, to_ros=to_ros)
        for connection, (used, to_ros) in connections.items()
    ]
    quantities: dict[str, bridge.Quantity] = {}
    for example in reversed([*like]):
        for own in bridge_connections:
            if own.direction is example.direction:
                own.outOfRange = example.outOfRange
        quantities |= {str(known.name): known for known in _quantities(example)}
    own_quantities = [
        make(
            metamodels,
            bridge.Quantity,
            name=str(quantity.name),
            units=str(quantity.units or ""),
            value=quantity.value,
        )
        for quantity in quantities.values()
    ]
    owner = make(
        metamodels,
        bridge.Bridge,
        name=name,
        address="1.1.1",
        bridgeConnections=bridge_connections,
        quantities=own_quantities,
    )
    whole = make(metamodels, system.System, name=f"{name}_system", bridges=[owner])
    return made_model(metamodels, whole, owner, *bridge_connections)


def _quantities(connection: Element) -> Iterable[bridge.Quantity]:
    owner = connection.eContainer()
    return owner.quantities if isinstance(owner, bridge.Bridge) else ()


def _connection(
    metamodels: Metamodels, used: bridge.AttributeMap, name: str, *, to_ros: bool
) -> bridge.Connection:
    topics = [make(metamodels, bridge.Topic, name=name)]
    if not to_ros:
        topics += [
            make(metamodels, bridge.Topic, name=str(join.name), join=join) for join in used.joins
        ]
    reports = used.reportJoins if to_ros else ()
    return make(
        metamodels,
        bridge.Connection,
        name=name,
        direction=TO_ROS if to_ros else TO_JAUS,
        topics=topics,
        sources=[make(metamodels, bridge.ReportSource, join=report) for report in reports],
        map=used,
    )


_BOOTSTRAP = Path(__file__).with_name("bootstrap.py")
_RUNTIME = Path(jausml.__file__).parent / "runtime"
_MOST_WORDS = 100


class WorkerError(Exception):
    """A worker that has no answer; the text says why."""


class Worker:
    """A process with the generated code of bridges; close it at the end."""

    def __init__(self, code: BridgeCode, script: Path, *arguments: str) -> None:
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
        """Returns its answer."""
        late = threading.Event()

        def end() -> None:
            late.set()
            self._process.kill()

        with self._lock:
            timer = threading.Timer(seconds, end)
            timer.start()
            try:
                line = self._answer_line(request)
            finally:
                timer.cancel()
        if line.endswith("\n"):  # or it ended in the midst of its answer
            return json.loads(line)
        if late.is_set():
            raise WorkerError(f"the translation took longer than {seconds:g} s")
        raise WorkerError(f"the translation failed: {self._last_words()}")

    def _answer_line(self, request: Any) -> str:
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
