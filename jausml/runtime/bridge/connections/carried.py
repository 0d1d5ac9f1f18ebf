"""What a bridge asks of whatever it carries: connections of topics, services and actions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from ..ends.ends import Ends
    from ..reports.diagnostics import ConnectionStatus, Statistics
    from ..reports.stops import Standing, StopReason
    from .transcoding import Form


class Carried(Protocol):
    """A connection as its bridge sees it. All of it runs on the loop, or with its lock."""

    name: str
    statistics: Statistics
    is_command: bool
    form: Form

    @property
    def when_lost(self) -> str:
        """What happens when the source of a command is lost."""

    def open(self, ends: Ends) -> None:
        """Opens both ends, before the first message."""

    def watch(self) -> None:
        """Starts to mind the source."""

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Stops what must not go on; whether something was stopped."""

    def lose(self, reason: StopReason) -> bool:
        """Stops what is watched for silence; whether something was stopped."""

    def end(self) -> bool:
        """Stops for good; whether something was stopped."""

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Measures the latency from now on, or no more."""

    def status(self) -> ConnectionStatus:
        """Returns the state since the last call."""

    def close_account(self) -> list[tuple[str, int]]:
        """Counts what was lost since the last status; returns what became of all messages."""
