"""What is seen of a drive in virtual time: the truth, the messages of the vehicle, and delays."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Any

from catvehicle.metrics import Sample, latency_summary

from experiments.right_turn.data import HOPS, Event, Step

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

PERIOD = 0.01
"""Seconds between two samples of the truth."""

STANDSTILL = 0.02
"""Speed in m/s below which the vehicle stands."""

REST = 1.0
"""Seconds of standing after which a drive is over."""

LONGEST = 1.0
"""Longest way of a command (s) that is matched; a straight drive repeats its angles."""

QUANTUM = 2e-5
"""Tolerance (rad) when commands are matched; one step of the effort field is 1.6e-5 rad."""


class Record:
    """What is seen of a drive.

    Attributes:
        samples: True states from the first motion on.
        events: Reports that the vehicle sent and commands that it took.
        steps: Steps of the steering controller.
        begun: When the first motion was, s of the world.
        is_over: Whether the vehicle came to rest after it had moved.
    """

    def __init__(self, world: Any) -> None:
        """Begin empty."""
        self.samples: list[Sample] = []
        self.events: list[Event] = []
        self.steps: list[Step] = []
        self.is_over = False
        self.begun = math.inf
        self._world = world
        self._stood = 0

    def watch(self, sample: Callable[[], Sample]) -> None:
        """Sample from now on; `sample` returns the state of the present."""
        start = self.begun = self._world.now()

        def take(number: int) -> None:
            self._take(replace(sample(), t=number * PERIOD))
            # From the first one, so that no rounding adds up.
            self._world.call_at(start + (number + 1) * PERIOD, partial(take, number + 1))

        take(0)

    def _take(self, sample: Sample) -> None:
        self.samples.append(sample)
        stands = sample.v < STANDSTILL and math.hypot(sample.x, sample.y) > 1.0
        self._stood = self._stood + 1 if stands else 0
        self.is_over = self.is_over or self._stood * PERIOD >= REST


class VehicleLog:
    """Stands for the event log of the vehicle."""

    def __init__(self, record: Record) -> None:
        """Note what is written in a record."""
        self._events = record.events

    def write(self, kind: str, time: float, value: float) -> None:
        """Note a report or a command."""
        self._events.append(Event(kind, time, float(value)))


class ControllerLog:
    """Stands for the log of the JAUS controller."""

    def __init__(self, record: Record) -> None:
        """Note what is written in a record."""
        self._steps = record.steps

    def write(self, *cells: Any) -> None:
        """Note a step."""
        self._steps.append(Step(*cells))


def hops(steps: Sequence[Step], events: Sequence[Event]) -> dict[str, list[float]]:
    """Returns the seconds that messages took, for each of `data.HOPS`.

    Reports are matched by their time stamp, commands by their angle. A step whose angle another
    one repeats within `LONGEST` is left out: the command of one that got lost, or that a newer
    one replaced, would be taken for its own.
    """
    sensed = {int(event.value): event.time for event in events if event.kind == "report"}
    commands = [event for event in events if event.kind == "command"]
    found: dict[str, list[float]] = {hop: [] for hop in HOPS}
    repeated = _repeated(steps)
    place = 0
    for number, step in enumerate(steps):
        report = sensed.get(step.stamp_ms)
        if report is not None:
            found["to_controller"].append(step.received - report)
        while place < len(commands) and commands[place].time < step.sent:
            place += 1
        if number in repeated:
            continue
        for command in islice(commands, place, None):
            if command.time - step.sent >= LONGEST:
                break
            if abs(command.value - step.delta_cmd) <= QUANTUM:
                found["to_vehicle"].append(command.time - step.sent)
                if report is not None:
                    found["sense_act"].append(command.time - report)
                break
    return found


def _repeated(steps: Sequence[Step]) -> set[int]:
    """Returns the numbers of steps with an angle that another one near in time has too."""
    ordered = sorted(range(len(steps)), key=lambda number: steps[number].delta_cmd)
    found = set()
    for place, one in enumerate(ordered):
        for other in islice(ordered, place + 1, None):
            if steps[other].delta_cmd - steps[one].delta_cmd > 2 * QUANTUM:
                break
            if abs(steps[other].sent - steps[one].sent) < LONGEST:
                found |= {one, other}
    return found


def percentiles(latencies: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Returns the median and the 99th percentile (s) of each hop, by name."""
    found = {}
    for hop, times in latencies.items():
        if times:
            summary = latency_summary(times)
            found |= {f"{hop}_p50": summary.p50, f"{hop}_p99": summary.p99}
    return found
