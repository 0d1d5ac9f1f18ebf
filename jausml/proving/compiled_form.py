"""Runs the compiled and the Python form of a map in processes of their own, to prove the map."""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jausml.generation import native
from jausml.generation.rendering import render
from jausml.language.model import Model
from jausml.live.workers.worker import BridgeCode, Worker, bridge_code, bridge_of_maps
from jausml.proving.layout import FLOAT, NOW, SIGNED, UNSIGNED, Number
from jausml.proving.round_trips import RoundTrip
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bridge.views import bridge_views
from jausml_generators.cpp.proof import PROOF, proof_program
from jausml_generators.cpp.types import support
from jausml_generators.messages.target import TARGET as MESSAGES

NAME = "proof"
TO_ROS_NAME, TO_JAUS_NAME = "to_ros", "to_jaus"
_CORE = f"{NAME}/{native.SOURCE.parent.as_posix()}/"


@dataclass(frozen=True)
class ProofCode:
    """The code of a map by `jausml generate`, and the program of its proof.

    Attributes:
        directions: Those that are compiled, by whether they make messages of ROS.
        shortcuts: Paths of the numbers that the program sweeps without the rest of the message.
    """

    python: BridgeCode
    core: str
    headers: Mapping[str, str]
    directions: tuple[bool, ...]
    reasons: tuple[str, ...]
    program: str
    shortcuts: tuple[str, ...]


def proof_code(model: Model, trip: RoundTrip) -> ProofCode:
    """Returns the code of a map, with the policies and quantities of the bridge that has it."""
    bridge_model = _model(model, trip)
    files = {artifact.path: artifact.text for artifact in render(bridge_model, (BRIDGE, MESSAGES))}
    beside = {
        path.removeprefix(_CORE): text for path, text in files.items() if path.startswith(_CORE)
    }
    (view,) = bridge_model.derived(bridge_views)
    translations, core = view.translations, view.core
    functions = {
        connection.name == TO_ROS_NAME: connection.compiled
        for connection in translations.connections
        if connection.compiled is not None
    }
    uses = translations.uses
    settings: dict[str, float | str] = {
        quantity.name: quantity.value for quantity in uses.quantities.values()
    }
    settings |= {frame.name: frame.value for frame in uses.frames.values()}
    now = int(NOW.timestamp()), NOW.microsecond * 1000
    program, shortcuts = proof_program(core, functions, settings, now)
    return ProofCode(
        bridge_code(bridge_model),
        beside.pop(native.SOURCE.name, ""),
        beside,
        tuple(functions),
        tuple(f"{name}: {reason}" for name, reason in core.left.items()),
        program,
        tuple(shortcuts),
    )


def _model(model: Model, trip: RoundTrip) -> Model:
    """Makes a bridge with each direction, with its own policies and quantities."""
    directions = {TO_ROS_NAME: (trip.to_ros, True), TO_JAUS_NAME: (trip.to_jaus, False)}
    connections = {
        name: (map_, to_ros)
        for name, (map_, to_ros) in directions.items()
        if (map_.toRos if to_ros else map_.toJaus)
    }
    return bridge_of_maps(model.metamodels, NAME, connections, trip.connections)


_LONGEST = 600.0
_FASTER = ("-pthread", *(("-march=native",) if platform.machine() in {"x86_64", "AMD64"} else ()))
"""Billions of values are worth it. Without contractions the bits are those of bridges."""

_WITHOUT_LOOP = {"fastpath.hpp": '#pragma once\n#include "core.hpp"\n'}
"""Translations use nothing of the loop of a bridge, whose headers take a second to compile."""

_KINDS = {UNSIGNED: 0, SIGNED: 1, FLOAT: 2}
_NO_WAY = 2
_NONE = "-"


class ProgramError(Exception):
    """A program that cannot be built of the generated code, or that ends; the text says why."""


def compiled(code: ProofCode, folder: Path, program: str) -> Path:
    """Returns the program of a map."""
    files = {**code.headers, **_WITHOUT_LOOP, native.SOURCE.name: code.core, PROOF: support(PROOF)}
    files["proof.cpp"] = code.program
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    executable = folder / "proof"
    # The flags make a library; here a program is wanted, with the same bits.
    flags = [flag for flag in native.FLAGS if flag != "-shared"]
    command = [program, *flags, *_FASTER, "-o", str(executable), str(folder / "proof.cpp")]
    try:
        subprocess.run(  # noqa: S603 - the compiler of the user, on generated text
            command, check=True, capture_output=True, timeout=_LONGEST
        )
    except subprocess.CalledProcessError as error:
        said = error.stderr.decode(errors="replace").strip()
        raise ProgramError(said or str(error)) from error
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ProgramError(str(error)) from error
    return executable


@dataclass(frozen=True)
class Sweep:
    """Values of one number that go through a translation, and back where there is a way.

    Attributes:
        turn: What makes a full turn where the number is an angle, else 0.
        message: What the translation takes, with what is joined to it.
        size: Bytes of the message without that.
        joins_back: What is joined to the message between both ways.
        shortcut: Number of the function that does without the rest of the message; 0 for none.
        varied: Numbers of the message that take random values meanwhile.
    """

    to_ros: bool
    has_back: bool
    message: bytes
    size: int
    joins_back: bytes
    number: Number
    turn: float
    between: int
    watched: Sequence[Number]
    shortcut: int = 0
    varied: Sequence[Number] = ()

    def words(self) -> Iterator[object]:
        """Yields the words of the sweep for the program."""
        yield self.message.hex()
        yield self.joins_back.hex() or _NONE
        yield self.between
        yield from _words(self.number, self.turn)
        for numbers in (self.watched, self.varied):
            yield len(numbers)
            for number in numbers:
                yield from _words(number, 0.0)


def _words(number: Number, turn: float) -> Iterator[object]:
    yield from (number.at, number.size, number.bits, number.shift, _KINDS[number.kind])
    # Hexadecimal floats lose nothing as text.
    yield from (number.lower.hex(), float(number.step).hex(), turn.hex())


@dataclass(frozen=True)
class Course:
    """How a number goes while another one rises."""

    least: float
    greatest: float
    seen: int
    rises: int
    falls: int


@dataclass(frozen=True, slots=True)
class Tally:
    """The outcome for values; positions are those in the order of values.

    Attributes:
        left_out: Values that are not there any more.
        others: Values with which something else in the message has changed.
        drifting: Values that a second trip changes again.
        left: Values that the compiled form leaves to Python.
        examples: Positions of these; of some that lie far apart where there are many.
        bins: The largest error in each part of the range.
    """

    count: int
    unchanged: int
    changed: int
    left_out: int
    others: int
    drifting: int
    left: int
    largest_at: int
    largest_back: int
    drift_at: int
    largest: float
    largest_drift: float
    result: Course
    watched: list[Course]
    examples: list[int]
    bins: list[float]


class CompiledForm:
    """The process of a program; close it at the end."""

    def __init__(self, program: Path) -> None:
        try:
            self._process = subprocess.Popen(  # noqa: S603 - compiled of generated text
                [str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
            )
        except OSError as error:
            raise ProgramError(str(error)) from error

    def __enter__(self) -> CompiledForm:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.communicate()

    def translate(self, data: bytes, *, to_ros: bool) -> bytes | None:
        """Returns the translation of a message; None where it is left to Python."""
        answer = self._ask(["translate", int(not to_ros), data.hex()])
        return None if answer == _NONE else bytes.fromhex(answer)

    def run(
        self, sweep: Sweep, indices: range | Sequence[int], most: int, threads: int = 1
    ) -> Tally:
        """Returns the tally of the values at some positions, in their order.

        Args:
            most: Of how many values that are left to Python it is told which they are.
        """
        back = int(sweep.to_ros) if sweep.has_back else _NO_WAY
        words = ["sweep", int(not sweep.to_ros), back, sweep.shortcut, threads, most]
        listed = () if isinstance(indices, range) else indices
        count = [indices[0], len(indices), len(listed), *listed]
        return _tally(iter(self._ask([*words, *sweep.words(), *count]).split()))

    def _ask(self, words: Sequence[object]) -> str:
        pipes = self._process.stdin, self._process.stdout
        try:
            if pipes[0] is not None and pipes[1] is not None:
                pipes[0].write(" ".join(map(str, words)) + "\n")
                pipes[0].flush()
                line = pipes[1].readline()
                if line:
                    return line.strip()
        except OSError:
            pass  # it has ended
        raise ProgramError("the program of the proof has ended")


def _tally(words: Iterator[str]) -> Tally:
    counts = [int(next(words)) for _ in range(10)]
    errors = [float(next(words)) for _ in range(2)]
    result = _course(words)
    watched = [_course(words) for _ in range(int(next(words)))]
    examples = [int(next(words)) for _ in range(int(next(words)))]
    bins = [float(next(words)) for _ in range(int(next(words)))]
    plain: dict[str, Any] = dict(zip(Tally.__slots__, [*counts, *errors], strict=False))
    return Tally(**plain, result=result, watched=watched, examples=examples, bins=bins)


def _course(words: Iterator[str]) -> Course:
    least, greatest = float(next(words)), float(next(words))
    return Course(least, greatest, *(int(next(words)) for _ in range(3)))


_SCRIPT = Path(__file__).with_name("python_worker.py")
_SECONDS = 300.0
_AT_ONCE = 4096


@dataclass(frozen=True)
class Trip:
    """The outcome for a message.

    Attributes:
        notes: Policy and field of each value that was limited or left out.
        is_refused: Whether the error is one by which bridges drop messages.
    """

    between: bytes | None
    back: bytes | None
    notes: tuple[str, ...]
    error: str
    is_refused: bool


class PythonForm(Worker):
    """The process with the Python form of a map; close it at the end."""

    def __init__(self, code: BridgeCode, name: str) -> None:
        now = str(int(NOW.timestamp())), str(NOW.microsecond * 1000)
        super().__init__(code, _SCRIPT, name, name.capitalize(), *now)

    def trips(
        self, messages: Sequence[bytes], joins_back: bytes, *, to_ros: bool, has_back: bool
    ) -> list[Trip]:
        """Returns the trips of messages through a translation, and through its opposite."""
        trips: list[Trip] = []
        way = "to_ros" if to_ros else "to_jaus"
        for start in range(0, len(messages), _AT_ONCE):
            part = [message.hex() for message in messages[start : start + _AT_ONCE]]
            request = {"way": way, "back": has_back, "joins": joins_back.hex(), "messages": part}
            trips += map(_trip, self.ask(request, _SECONDS))
        return trips


def _trip(answer: list[Any]) -> Trip:
    between, back, notes, error, is_refused = answer
    return Trip(_bytes(between), _bytes(back), tuple(notes), error, is_refused)


def _bytes(text: str | None) -> bytes | None:
    return None if text is None else bytes.fromhex(text)
