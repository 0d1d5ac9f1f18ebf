"""The process that translates recorded JAUS messages to ROS, by generated code.

It answers each line of JSON on its input with one on its output; `jausml/live/workers` runs it. The
bridges are not opened: no rate is limited, and the time is that of the recording.
"""

from __future__ import annotations

import json
import sys
import time
import typing
from importlib import import_module

from jausml_runtime.bridge.connections.translations import transcoder
from jausml_runtime.bridge.messages.limits import StaleJoinError
from jausml_runtime.conversions import Time

_NANO = 10**9

Answer = typing.Any  # hexadecimal digits of what was made; or kind and text of what is wrong


class RecordingClock:
    """The time of the message that is translated."""

    def __init__(self) -> None:
        self.nanoseconds = 0

    def now(self) -> Time:
        """Returns the time as bridges have it."""
        return Time(*divmod(self.nanoseconds, _NANO))


class LatestReports:
    """The latest reports of a join, by subsystem."""

    def __init__(self, plan: dict[str, typing.Any], kind: typing.Any) -> None:
        self._plan, self._kind = plan, kind
        self.parameter: str = plan["parameter"]
        self._latest: dict[int, tuple[int, bytes]] = {}

    def keep(self, subsystem: int, at: int, data: bytes) -> None:
        """Stores a report; if the model names its sender, for all subsystems."""
        self._latest[self._key(subsystem)] = at, data

    def fresh(self, subsystem: int, at: int) -> typing.Any:
        """Returns the latest fresh report; without one, None or a `StaleJoinError` by the map."""
        report = self._latest.get(self._key(subsystem))
        if report is not None and 0 <= at - report[0] <= self._plan["freshness"] * _NANO:
            return _decoder(self._kind)(report[1])
        if self._plan["drop"]:
            raise StaleJoinError(self._plan["name"], "there is no fresh report")
        return None

    def _key(self, subsystem: int) -> int:
        return 0 if self._plan["senders"] else subsystem


class ConnectionTranslation:
    """The translation of one connection."""

    def __init__(self, plan: dict[str, typing.Any], clock: RecordingClock) -> None:
        package, name = plan["package"], plan["connection"]
        bridge = getattr(import_module(f"{package}.{package}"), plan["bridge"])()
        bridge.now = clock.now
        base = import_module(f"{package}.{package}_base")
        method = getattr(getattr(base, plan["base"]), f"translate_{name}")
        hints = typing.get_type_hints(method, vars(base))
        kinds = {key: _class_of(hint) for key, hint in hints.items()}
        translate = getattr(bridge, f"translate_{name}")
        self.connection = getattr(bridge, name)
        self.joins = {
            join["name"]: LatestReports(join, kinds[join["parameter"]]) for join in plan["joins"]
        }
        decode = _decoder(kinds["source"])
        self._run = transcoder(translate, decode, _encode, _ignore, time.monotonic)
        self._clock = clock

    def run(self, subsystem: int, at: int, data: bytes) -> Answer:
        """Returns the translation of a message (`at`: nanoseconds since 1970)."""
        self._clock.nanoseconds = at
        try:
            joins = {join.parameter: join.fresh(subsystem, at) for join in self.joins.values()}
            target = self._run(data, **joins)
        except Exception as error:
            return [type(error).__name__, str(error)]
        return ["dropped", ""] if target is None else bytes(target).hex()


def _class_of(hint: typing.Any) -> typing.Any:
    """Returns the class of a type hint, also of `X | None`."""
    inner = [argument for argument in typing.get_args(hint) if argument is not type(None)]
    return inner[0] if inner else hint


def _decoder(kind: typing.Any) -> typing.Any:
    """Returns the decoder of a message class, of JAUS or ROS."""
    return kind.from_cdr if hasattr(kind, "from_cdr") else kind.decode


def _encode(target: typing.Any) -> bytes:
    return bytes(target.to_cdr() if hasattr(target, "to_cdr") else target.encode())


def _ignore(_seconds: float) -> None:
    """Takes the time of a translation, which does not matter here."""


class Work:
    """The translations of all routes."""

    def __init__(self) -> None:
        self._translations: list[ConnectionTranslation] = []

    def answer(self, request: dict[str, typing.Any]) -> Answer:
        """Returns the answer to a request."""
        if "routes" in request:
            clock = RecordingClock()
            self._translations = [
                ConnectionTranslation(route, clock) for route in request["routes"]
            ]
            return len(self._translations)
        if "messages" in request:
            return [self._one(*message) for message in request["messages"]]
        return [_counts(translation.connection) for translation in self._translations]

    def _one(self, route: int, join: str, subsystem: int, at: int, payload: str) -> Answer:
        translation, data = self._translations[route], bytes.fromhex(payload)
        if join:
            translation.joins[join].keep(subsystem, at, data)
            return None
        return translation.run(subsystem, at, data)


def _counts(connection: typing.Any) -> dict[str, int]:
    """Returns the numbers of values that did not fit their field, by policy."""
    counts = connection.statistics.out_of_range
    return {f"{field}: {policy}": number for (policy, field), number in counts.items()}


def main() -> None:
    """Answers requests until the input ends."""
    work = Work()
    for line in sys.stdin:
        sys.stdout.write(json.dumps(work.answer(json.loads(line))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
