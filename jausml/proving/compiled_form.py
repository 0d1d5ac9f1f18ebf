"""Both forms of a map in processes: the program of its core, and Python, which decides the rest."""

from __future__ import annotations

import platform
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml.generation import native
from jausml.live.workers.worker import Worker
from jausml.proving.layout import FLOAT, NOW, SIGNED, UNSIGNED
from jausml_generators.cpp.proof import PROOF
from jausml_generators.cpp.types import support

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from typing_extensions import Self

    from jausml.live.workers.worker import BridgeCode
    from jausml.proving.layout import Number
    from jausml.proving.proof_bridge import ProofCode

_LONGEST = 600.0
_FASTER = (
    *("-O3", "-pthread"),
    *(("-march=native",) if platform.machine() in {"x86_64", "AMD64"} else ()),
)
"""Billions of values are worth it. Without contractions the bits are those of bridges."""

_WITHOUT_LOOP = {"fastpath.hpp": '#pragma once\n#include "core.hpp"\n'}
"""Translations use nothing of the loop of a bridge, whose headers take a second to compile."""

_KINDS = {UNSIGNED: 0, SIGNED: 1, FLOAT: 2}
_NO_WAY = 2
_NONE = "-"


class ProgramError(Exception):
    """What was generated becomes no program, or the program ends; the text says why."""


def compiled(code: ProofCode, folder: Path, program: str) -> Path:
    """Returns the program of a map."""
    files = {**code.headers, **_WITHOUT_LOOP, native.SOURCE.name: code.core, PROOF: support(PROOF)}
    files["proof.cpp"] = code.program
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    made = folder / "proof"
    flags = [each for each in native.FLAGS if each != "-shared"]
    command = [program, *flags, *_FASTER, "-o", str(made), str(folder / "proof.cpp")]
    try:
        subprocess.run(  # noqa: S603 - the compiler of the user, on generated text
            command, check=True, capture_output=True, timeout=_LONGEST
        )
    except subprocess.CalledProcessError as error:
        said = error.stderr.decode(errors="replace").strip()
        raise ProgramError(said or str(error)) from error
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ProgramError(str(error)) from error
    return made


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
        """Yields it as the program takes it."""
        yield self.message.hex()
        yield self.joins_back.hex() or _NONE
        yield self.between
        yield from _words(self.number, self.turn)
        for numbers in (self.watched, self.varied):
            yield len(numbers)
            for each in numbers:
                yield from _words(each, 0.0)


def _words(number: Number, turn: float) -> Iterator[object]:
    yield from (number.at, number.size, number.bits, number.shift, _KINDS[number.kind])
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
    """What became of values; positions are those in the order of values.

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

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.communicate()

    def translate(self, data: bytes, *, to_ros: bool) -> bytes | None:
        """Returns what a translation makes of what it takes; None where it gives way."""
        made = self._ask(["translate", int(not to_ros), data.hex()])
        return None if made == _NONE else bytes.fromhex(made)

    def run(
        self, sweep: Sweep, indices: range | Sequence[int], most: int, threads: int = 1
    ) -> Tally:
        """Returns what becomes of the values at some positions, in their order.

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
    """What becomes of a message.

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
        """Returns what becomes of messages by a translation, and by its opposite."""
        found: list[Trip] = []
        way = "to_ros" if to_ros else "to_jaus"
        for start in range(0, len(messages), _AT_ONCE):
            part = [each.hex() for each in messages[start : start + _AT_ONCE]]
            request = {"way": way, "back": has_back, "joins": joins_back.hex(), "messages": part}
            found += map(_trip, self.ask(request, _SECONDS))
        return found


def _trip(answer: list[Any]) -> Trip:
    between, back, notes, error, is_refused = answer
    return Trip(_bytes(between), _bytes(back), tuple(notes), error, is_refused)


def _bytes(text: str | None) -> bytes | None:
    return None if text is None else bytes.fromhex(text)
