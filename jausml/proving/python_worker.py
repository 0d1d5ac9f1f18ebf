"""The process in which messages go through the Python form of a map, there and back.

It answers each line of JSON on its input with one on its output; `jausml/live/workers` runs it.
"""

from __future__ import annotations

import json
import sys
import typing
from importlib import import_module

from jausml_runtime.base.api import JausError
from jausml_runtime.conversions import Time

_BACK = {"to_ros": "to_jaus", "to_jaus": "to_ros"}


class Forms:
    """The translations of a bridge that is not opened."""

    def __init__(self, package: str, class_name: str, now: tuple[int, int]) -> None:
        self._bridge = getattr(import_module(f"{package}.{package}"), class_name)()
        self._bridge.now = lambda: Time(*now)
        self._base = import_module(f"{package}.{package}_base")
        self._readers = {
            name: self._takers(class_name, name)
            for name in _BACK
            if hasattr(self._bridge, f"translate_{name}")
        }

    def _takers(self, class_name: str, name: str) -> list[typing.Any]:
        """Returns the decoders of the message of a translation, and of those joined to it."""
        method = getattr(getattr(self._base, f"{class_name}Base"), f"translate_{name}")
        hints = typing.get_type_hints(getattr(method, "__wrapped__", method), vars(self._base))
        kinds = [kind for parameter, kind in hints.items() if parameter != "return"]
        plain = [next(iter(typing.get_args(kind)), kind) for kind in kinds]  # of `Imu | None`, Imu
        return [
            getattr(message_class, "from_cdr", None) or message_class.decode
            for message_class in plain
        ]

    def translate(self, name: str, data: bytes) -> tuple[bytes | None, list[str]]:
        """Returns the translation of a message, and the fields that were limited or left out."""
        counts = getattr(self._bridge, name).statistics.out_of_range
        # The counts are those of this message alone.
        counts.clear()
        readers = self._readers[name]
        taken = [
            read(part) for read, part in zip(readers, _split(data, len(readers) - 1), strict=True)
        ]
        target = getattr(self._bridge, f"translate_{name}")(*taken)
        notes = [f"{policy} {field}" for policy, field in counts]
        if target is None:
            return None, notes
        octets = target.to_cdr() if hasattr(target, "to_cdr") else target.encode()
        return bytes(octets), notes

    def answer(self, request: dict[str, typing.Any]) -> list[list[typing.Any]]:
        """Returns for each message its translation, its way back, the notes and the error."""
        return [self._trip(request, bytes.fromhex(message)) for message in request["messages"]]

    def _trip(self, request: dict[str, typing.Any], data: bytes) -> list[typing.Any]:
        payloads: list[str | None] = [None, None]
        notes: list[str] = []
        directions = [request["way"], *([_BACK[request["way"]]] if request["back"] else [])]
        payload: bytes | None = data
        joins = bytes.fromhex(request["joins"])
        try:
            for at, way in enumerate(directions):
                if payload is None:
                    break
                payload, more = self.translate(way, payload + (joins if at else b""))
                notes += more
                payloads[at] = None if payload is None else payload.hex()
        except Exception as error:
            # Bridges drop messages by these, and count them; any other error is a fault.
            is_refused = isinstance(error, JausError)
            return [*payloads, notes, f"{type(error).__name__}: {error}", is_refused]
        return [*payloads, notes, "", True]


def _split(data: bytes, joins: int) -> list[bytes]:
    """Returns a message and those behind it, whose sizes are at the end."""
    end = len(data) - 4 * joins
    sizes = [int.from_bytes(data[at : at + 4], "little") for at in range(end, len(data), 4)]
    parts = []
    for size in reversed(sizes):
        parts.append(data[end - size : end])
        end -= size
    return [data[:end], *reversed(parts)]


def main() -> None:
    """Answers until the input ends."""
    package, class_name, sec, nanosec = sys.argv[1:5]
    forms = Forms(package, class_name, (int(sec), int(nanosec)))
    for line in sys.stdin:
        sys.stdout.write(json.dumps(forms.answer(json.loads(line))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
