"""What translations take: a message, and the latest ones that are joined to it.

As bytes, the joined messages follow the one that they are joined to, and their sizes follow them.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

from jausml.language import wire
from jausml.proving.layout import (
    USUAL,
    Layout,
    LayoutError,
    Number,
    Usual,
    jaus_layout,
    ros_layout,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jausml.language.metamodel.classes import jaus, ros
    from jausml.proving.round_trips import RoundTrip

Making: TypeAlias = "Callable[[bytes | None, Usual], Layout]"
"""Makes a message of usual values, or finds the numbers in one."""

_SIZE = 4


@dataclass(frozen=True)
class Input:
    """What a translation takes.

    Attributes:
        joins: The joined messages, by the names with which paths of their numbers begin.
    """

    message: Making
    joins: Mapping[str, Making]

    def layout(self, data: bytes | None, usual: Usual = USUAL) -> Layout:
        """Returns messages of usual values, or the numbers in some."""
        makings = {"": self.message, **self.joins}
        given = [None] * len(makings) if data is None else self._split(data)
        made, numbers, sizes = b"", list[Number](), b""
        for (name, making), part in zip(makings.items(), given, strict=True):
            layout = making(part, usual)
            numbers += [_behind(made, name, each) for each in layout.numbers]
            made += layout.data
            sizes += len(layout.data).to_bytes(_SIZE, "little") if name else b""
        return Layout(made + sizes, numbers)

    def main(self, data: bytes) -> bytes:
        """Returns the message without the joined ones."""
        return self._split(data)[0]

    @functools.cached_property
    def usual_joins(self) -> bytes:
        """Joined messages of usual values, which stand behind a message."""
        made = self.layout(None).data
        return made[len(self.main(made)) :]

    def _split(self, data: bytes) -> list[bytes]:
        count, parts = len(self.joins), list[bytes]()
        end = len(data) - _SIZE * count
        sizes = data[max(0, end) :]
        for at in reversed(range(0, _SIZE * count, _SIZE)):
            begin = end - int.from_bytes(sizes[at : at + _SIZE], "little")
            if begin < 0:
                raise LayoutError("joined messages are cut off")
            parts.append(data[begin:end])
            end = begin
        return [data[:end], *reversed(parts)]


def _behind(made: bytes, name: str, number: Number) -> Number:
    path = f"{name}.{number.path}" if name else number.path
    return replace(number, path=path, at=len(made) + number.at)


def inputs(trip: RoundTrip) -> dict[bool, Input]:
    """Returns what the translations of a round trip take, by whether they make messages of ROS."""
    return {
        True: Input(
            _jaus(trip.to_ros.message),
            {str(each.name): _jaus(each.message) for each in trip.to_ros.reportJoins},
        ),
        False: Input(
            _ros(trip.to_jaus.type),
            {str(each.name): _ros(each.type) for each in trip.to_jaus.joins},
        ),
    }


def _jaus(message: jaus.MessageDef) -> Making:
    return functools.partial(jaus_layout, wire.resolve(message))


def _ros(type_: ros.MessageType) -> Making:
    return functools.partial(ros_layout, type_)
