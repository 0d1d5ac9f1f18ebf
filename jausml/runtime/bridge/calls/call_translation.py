"""Translations of the two halves of a call, its request and its response."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..connections.connection import FILTERED
from ..connections.transcoding import readable, ros_decoder, ros_encoder, uses_ros_classes
from ..reports.diagnostics import Statistics
from ..reports.limiting import Limiting

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...wire.message import Message
    from ..connections.transcoding import Transcode
    from ..ends.ends import Ends
    from ..light_message import LightMessage


class CallFailedError(Exception):
    """A half of a call that could not be translated, which is counted already."""


class CallTranslation(Limiting):
    """Translates requests, or responses."""

    def __init__(
        self,
        name: str,
        translate: Callable[[Any], Any],
        *,
        message: type[Message],
        type: type[LightMessage],  # noqa: A002 - the word of the model
        to_ros: bool,
    ) -> None:
        """Prepares the translation.

        Args:
            translate: Makes the target message, or None to let the call fail.
        """
        super().__init__()
        self.name = name
        self.statistics = Statistics()
        self.message = message
        self.type = type
        self.to_ros = to_ros
        self._translate = translate
        self._transcode: Transcode

    def open(self, ends: Ends) -> None:
        """Finds out how both messages are read and written."""
        self.counters = ends.component.counters
        self._is_open = True
        real = uses_ros_classes(self._translate)
        decode = self.message.decode if self.to_ros else ros_decoder(ends.ros, self.type, real=real)
        encode = ros_encoder(ends.ros, self.type) if self.to_ros else _encode
        self._transcode = readable(
            self._translate, decode, encode, self.note_blocking, ends.loop.stopwatch
        )

    def made(self, data: bytes) -> bytes:
        """Returns the translation of an encoded message.

        Raises:
            CallFailedError: There is none; it says why.
        """
        try:
            target = self._transcode(data)
        except Exception as error:
            self.fail(error)
            raise CallFailedError(str(error) or repr(error)) from error
        self.statistics.arrivals += 1
        if target is None:
            self.drop(FILTERED)
            raise CallFailedError("the message is filtered out")
        self.statistics.passed += 1
        return target

    def describe(self) -> list[tuple[str, str]]:
        """Names and values of its counts, for diagnostics."""
        counts = self.statistics
        half = self.name.rpartition("_")[2]
        return [
            *(
                (f"{half} out of range: {policy} {field}", str(n))
                for (policy, field), n in sorted(counts.out_of_range.items())
            ),
            *((f"{half} dropped: {reason}", str(n)) for reason, n in sorted(counts.drops.items())),
        ]


def _encode(message: Message) -> bytes:
    return message.encode()
