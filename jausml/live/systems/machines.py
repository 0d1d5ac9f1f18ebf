"""State machines of components as values: which state each is in, and its times (MachineStates)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

MOST_MACHINES = 64  # machines of one component that are kept


@dataclass(frozen=True, slots=True)
class StateTime:
    """How often a state was entered, and the seconds spent in it."""

    state: str
    entries: int
    seconds: float


@dataclass(frozen=True, slots=True)
class MachineState:
    """A machine, named by its component; the model need not know it.

    Attributes:
        service: URN of the service that has it.
        state: Path of the present state, empty before the start.
        seconds: Seconds in it when that was told.
    """

    service: str
    machine: str
    state: str
    seconds: float
    times: tuple[StateTime, ...] = ()

    def later(self, seconds: float) -> MachineState:
        """Returns the machine after it has stayed in its state for so long."""
        times = (
            replace(time, seconds=time.seconds + seconds) if time.state == self.state else time
            for time in self.times
        )
        return replace(self, seconds=self.seconds + seconds, times=tuple(times))

    @property
    def total(self) -> float:
        """Seconds in all states that were told."""
        return sum(time.seconds for time in self.times)


def machines_as_json(machines: Sequence[MachineState]) -> list[dict[str, Any]]:
    """Returns machines as objects, lists, texts and numbers."""
    return [
        asdict(machine)
        | {"state": machine.state or None, "times": [asdict(time) for time in machine.times]}
        for machine in machines
    ]
