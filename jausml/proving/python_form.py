"""The Python form of a map, which decides what the compiled one leaves to it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml.live.workers.worker import Worker
from jausml.proving.layout import NOW

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.live.workers.bridge_code import BridgeCode

_SCRIPT = Path(__file__).with_name("python_worker.py")
_SECONDS = 300.0
_AT_ONCE = 4096


@dataclass(frozen=True)
class Trip:
    """What becomes of a message.

    Attributes:
        between: The message of the other side; None where none is made.
        back: The message that comes back.
        notes: Policy and field of each value that was limited or left out.
        error: The error that ended it; empty for none.
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
        """Returns what becomes of messages by a translation, and by its opposite.

        Args:
            joins_back: What is joined to the messages that the opposite takes.

        Raises:
            WorkerError: The process has ended.
        """
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
