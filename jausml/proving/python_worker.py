"""The process in which messages go through the Python form of a map, there and back.

It answers each line of JSON on its input with one on its output; `jausml/live/workers` runs it.
"""

from __future__ import annotations

import json
import sys
import typing
from importlib import import_module

from jausml_runtime.base.errors import JausError
from jausml_runtime.conversions import Time

_BACK = {"to_ros": "to_jaus", "to_jaus": "to_ros"}


class Forms:
    """The translations of a bridge that is not opened."""

    def __init__(self, package: str, class_name: str, now: tuple[int, int]) -> None:
        self._bridge = getattr(import_module(f"{package}.{package}"), class_name)()
        self._bridge.now = lambda: Time(*now)
        self._base = import_module(f"{package}.{package}_base")
        self._readers = {
            name: self._reader(class_name, name)
            for name in _BACK
            if hasattr(self._bridge, f"translate_{name}")
        }

    def _reader(self, class_name: str, name: str) -> typing.Any:
        method = getattr(getattr(self._base, f"{class_name}Base"), f"translate_{name}")
        hints = typing.get_type_hints(getattr(method, "__wrapped__", method), vars(self._base))
        kind = hints["source"]
        return getattr(kind, "from_cdr", None) or kind.decode

    def translate(self, name: str, data: bytes) -> tuple[bytes | None, list[str]]:
        """Returns what becomes of a message, and what was limited or left out on the way."""
        counts = getattr(self._bridge, name).statistics.out_of_range
        counts.clear()
        target = getattr(self._bridge, f"translate_{name}")(self._readers[name](data))
        notes = [f"{policy} {field}" for policy, field in counts]
        if target is None:
            return None, notes
        made = target.to_cdr() if hasattr(target, "to_cdr") else target.encode()
        return bytes(made), notes

    def answer(self, request: dict[str, typing.Any]) -> list[list[typing.Any]]:
        """Returns for each message what it becomes, what comes back, the notes and the error."""
        return [self._trip(request, bytes.fromhex(each)) for each in request["messages"]]

    def _trip(self, request: dict[str, typing.Any], data: bytes) -> list[typing.Any]:
        made: list[str | None] = [None, None]
        notes: list[str] = []
        ways = [request["way"], *([_BACK[request["way"]]] if request["back"] else [])]
        given: bytes | None = data
        try:
            for at, way in enumerate(ways):
                if given is None:
                    break
                given, more = self.translate(way, given)
                notes += more
                made[at] = None if given is None else given.hex()
        except Exception as error:
            # Bridges drop messages by these, and count them; any other error is a fault.
            is_refused = isinstance(error, JausError)
            return [*made, notes, f"{type(error).__name__}: {error}", is_refused]
        return [*made, notes, "", True]


def main() -> None:
    """Answers until the input ends."""
    package, class_name, sec, nanosec = sys.argv[1:5]
    forms = Forms(package, class_name, (int(sec), int(nanosec)))
    for line in sys.stdin:
        sys.stdout.write(json.dumps(forms.answer(json.loads(line))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
