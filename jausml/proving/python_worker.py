"""The process in which messages go through the Python form of a map, there and back.

It answers each line of JSON on its input with one on its output; `compiled_form.PythonForm` asks,
and `jausml/live/workers` runs it. Messages are in hex, each with its joins behind it (`_split`).

    request   {"way": "to_ros" or "to_jaus", "messages": [...],
               "back": whether they go back too, "joins": those of the way back}
    answer    for each message [translation or null, its way back or null, notes, error, is_refused]
"""

from __future__ import annotations

import json
import sys
import typing
from importlib import import_module

from jausml_runtime.base.api import JausError
from jausml_runtime.conversions import Time

_BACK = {"to_ros": "to_jaus", "to_jaus": "to_ros"}


class Translations:
    """The translations of a bridge that is not opened; its clock stands.

    `now`: seconds and nanoseconds at which it stands.
    """

    def __init__(self, package: str, class_name: str, now: tuple[int, int]) -> None:
        self._bridge = getattr(import_module(f"{package}.{package}"), class_name)()
        self._bridge.now = lambda: Time(*now)
        self._base = import_module(f"{package}.{package}_base")
        self._decoders = {
            name: self._decoders_of(class_name, name)
            for name in _BACK
            if hasattr(self._bridge, f"translate_{name}")
        }

    def _decoders_of(self, class_name: str, name: str) -> list[typing.Any]:
        """Returns the decoders of the message of a translation, and of those joined to it."""
        method = getattr(getattr(self._base, f"{class_name}Base"), f"translate_{name}")
        hints = typing.get_type_hints(method, vars(self._base))
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
        decoders = self._decoders[name]
        parts = zip(decoders, _split(data, len(decoders) - 1), strict=True)
        messages = [decode(part) for decode, part in parts]
        target = getattr(self._bridge, f"translate_{name}")(*messages)
        notes = [f"{policy} {field}" for policy, field in counts]
        if target is None:
            return None, notes
        octets = target.to_cdr() if hasattr(target, "to_cdr") else target.encode()
        return bytes(octets), notes

    def answer(self, request: dict[str, typing.Any]) -> list[list[typing.Any]]:
        """Returns for each message its translation and its way back, the notes and the error.

        The error is empty without one; last is whether bridges drop messages by it.
        """
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
        return [*payloads, notes, "", False]


def _split(data: bytes, count: int) -> list[bytes]:
    """Returns a message and its joins, of which there is a number.

    Behind them stand the sizes of the joins, four bytes little-endian each.
    """
    end = len(data) - 4 * count
    sizes = [int.from_bytes(data[at : at + 4], "little") for at in range(end, len(data), 4)]
    parts = []
    for size in reversed(sizes):
        parts.append(data[end - size : end])
        end -= size
    return [data[:end], *reversed(parts)]


def main() -> None:
    """Answers until the input ends."""
    package, class_name, sec, nanosec = sys.argv[1:5]
    translations = Translations(package, class_name, (int(sec), int(nanosec)))
    for line in sys.stdin:
        sys.stdout.write(json.dumps(translations.answer(json.loads(line))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
