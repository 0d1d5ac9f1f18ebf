"""State machines of components as values: present states, and times in states (MachineStates)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

MOST_MACHINES = 64  # of one component; further ones are left out


@dataclass(frozen=True, slots=True)
class StateTime:
    """The number of entries to a state, and the seconds in it."""

    state: str
    entries: int
    seconds: float


@dataclass(frozen=True, slots=True)
class MachineState:
    """A state machine as its component reports it; a model need not declare it.

    Attributes:
        service: URN of the service that has it.
        state: Path of the present state, empty before the start.
        seconds: Seconds in the present state when it was reported.
    """

    service: str
    machine: str
    state: str
    seconds: float
    times: tuple[StateTime, ...] = ()

    def later(self, seconds: float) -> MachineState:
        """Returns the machine after it has stayed in its state for further seconds."""
        times = (
            replace(time, seconds=time.seconds + seconds) if time.state == self.state else time
            for time in self.times
        )
        return replace(self, seconds=self.seconds + seconds, times=tuple(times))

    @property
    def total(self) -> float:
        """Seconds in all reported states."""
        return sum(time.seconds for time in self.times)


def machines_as_json(machines: Sequence[MachineState]) -> list[dict[str, Any]]:
    """Returns machines as JSON values."""
    return [
        asdict(machine)
        | {"state": machine.state or None, "times": [asdict(time) for time in machine.times]}
        for machine in machines
    ]
