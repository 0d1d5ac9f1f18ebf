"""What an operator says about a drive: where the vehicle is, and that it has arrived."""

from __future__ import annotations

import math

PROGRESS_EVERY = 10
"""Reports of the vehicle's pose for each line of progress."""

REPORT_PERIOD = 0.1
"""Seconds between two reports of the vehicle's pose."""

STANDSTILL = 0.01
"""Metres between two reports below which the vehicle stands."""

UNDER_WAY = 1.0
"""Metres from the start from which on a standstill is an arrival."""


class Progress:
    """Follows the poses that the vehicle reports and those that the controller estimates.

    Positions are metres, in the JAUS axes in which they are reported.
    """

    def __init__(self) -> None:
        """Begin before the first report."""
        self._position: tuple[float, float] | None = None
        self._estimate: tuple[float, float] | None = None
        self._reports = 0
        self._moved = False
        self._arrived = False

    def take_estimate(self, x: float, y: float) -> None:
        """Keep the position that the controller has integrated."""
        self._estimate = x, y

    def take_position(self, x: float, y: float) -> list[str]:
        """Take the true position; return the lines that are to be said."""
        last, self._position = self._position, (x, y)
        travelled = math.dist(last, self._position) if last is not None else 0.0
        self._moved = self._moved or math.hypot(x, y) > UNDER_WAY
        self._reports += 1
        lines = []
        if self._reports % PROGRESS_EVERY == 0:
            lines.append(self._said(x, y, travelled / REPORT_PERIOD))
        if self._moved and not self._arrived and travelled < STANDSTILL:
            self._arrived = True
            lines.append(f"arrived at x {x:.2f} m, y {y:.2f} m")
        return lines

    def _said(self, x: float, y: float, speed: float) -> str:
        off = math.nan if self._estimate is None else math.dist((x, y), self._estimate)
        return (
            f"vehicle at x {x:6.2f} m, y {y:6.2f} m (JAUS axes), {speed:4.1f} m/s; "
            f"estimate off by {off:.2f} m"
        )
