"""Inputs of translations as bytes: a message, and those that are joined to it."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

from jausml.language import wire
from jausml.language.metamodel.classes import jaus, ros
from jausml.proving.layout import (
    USUAL,
    Layout,
    LayoutError,
    Number,
    Usual,
    jaus_layout,
    ros_layout,
)
from jausml.proving.round_trips import RoundTrip

Making: TypeAlias = "Callable[[bytes | None, Usual], Layout]"
"""Makes a message of usual values where it is given none, or finds the numbers in one."""

_SIZE = 4  # bytes of the size of a joined message, which stands behind all of them


@dataclass(frozen=True)
class Input:
    """The inputs of a translation.

    Attributes:
        joins: The joined messages, by the names with which paths of their numbers begin.
    """

    message: Making
    joins: Mapping[str, Making]

    def layout(self, data: bytes | None, usual: Usual = USUAL) -> Layout:
        """Returns messages of usual values, or finds the numbers in some.

        Args:
            data: The message and the joined ones, one behind the other, then the size of each
                joined one; None for messages of usual values.
            usual: The values that numbers have without data.

        Raises:
            LayoutError: Data are cut off.
        """
        makings = {"": self.message, **self.joins}
        parts = [None] * len(makings) if data is None else self._split(data)
        octets, numbers, sizes = b"", list[Number](), b""
        for (name, making), part in zip(makings.items(), parts, strict=True):
            layout = making(part, usual)
            before = f"{name}." if name else ""
            numbers += [
                replace(number, path=f"{before}{number.path}", at=len(octets) + number.at)
                for number in layout.numbers
            ]
            octets += layout.data
            sizes += len(layout.data).to_bytes(_SIZE, "little") if name else b""
        return Layout(octets + sizes, numbers)

    def main(self, data: bytes) -> bytes:
        """Returns the message without the joined ones."""
        return self._split(data)[0]

    @functools.cached_property
    def usual_joins(self) -> bytes:
        """Joined messages of usual values, which stand behind a message."""
        octets = self.layout(None).data
        return octets[len(self.main(octets)) :]

    def _split(self, data: bytes) -> list[bytes]:
        """Returns the message and the joined ones."""
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


def inputs(trip: RoundTrip) -> dict[bool, Input]:
    """Returns the inputs of the translations, by whether they make messages of ROS."""
    return {
        True: Input(
            _jaus(trip.to_ros.message),
            {
                str(report_join.name): _jaus(report_join.message)
                for report_join in trip.to_ros.reportJoins
            },
        ),
        False: Input(
            _ros(trip.to_jaus.type),
            {str(join.name): _ros(join.type) for join in trip.to_jaus.joins},
        ),
    }


def _jaus(message: jaus.MessageDef) -> Making:
    return functools.partial(jaus_layout, wire.resolve(message))


def _ros(type_: ros.MessageType) -> Making:
    return functools.partial(ros_layout, type_)
