"""The MachineStates service: the states of modelled state machines, and the time in each.

The service is one of this project. A component that does not provide it measures no times.
"""

from __future__ import annotations

from collections.abc import Callable

from ..base.address import JausAddress
from ..messages.machine_states import MACHINE_STATES, QueryMachineStates, ReportMachineStates
from ..wire.message import Message
from .host import Host

MAX_MACHINES = 255
MAX_STATES = 255  # in one report, for all machines: the states with most time
MAX_ENTRIES = 0xFFFF_FFFF  # greatest number of entries of a state
_LONGEST_NAME = 255


class _Times:
    """Entries and seconds of the states of one machine."""

    def __init__(self, service: str, machine: str, clock: Callable[[], float]) -> None:
        self._names = _jaus_string(service), _jaus_string(machine)
        self._clock = clock
        self._state = ""
        self._since = 0.0
        self._entries: dict[str, int] = {}
        self._seconds: dict[str, float] = {}

    def enter(self, state: str) -> None:
        now = self._clock()
        if self._state:
            self._seconds[self._state] += now - self._since
        self._state, self._since = state, now
        self._entries[state] = min(self._entries.get(state, 0) + 1, MAX_ENTRIES)
        self._seconds.setdefault(state, 0.0)

    def report(self, most: int) -> ReportMachineStates.MachineSeq:
        present = self._clock() - self._since if self._state else 0.0
        seconds = dict(self._seconds)
        if self._state:
            seconds[self._state] += present
        longest = sorted(seconds, key=lambda state: -seconds[state])[:most]
        return ReportMachineStates.MachineSeq(
            ReportMachineStates.MachineRec(
                *self._names, _jaus_string(self._state), _milliseconds(present)
            ),
            [
                ReportMachineStates.TimeRec(
                    _jaus_string(state), self._entries[state], _milliseconds(seconds[state])
                )
                for state in longest
            ],
        )


class MachineStatesService:
    """Answers queries of any component, and sends events when a machine enters a state."""

    urns = frozenset([MACHINE_STATES])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._is_provided = False
        self._machines: list[_Times] = []

    def attach(self) -> None:
        """Measures times from now on; answers the query unless the component does so itself."""
        self._is_provided = True
        self._component.when_started(self._provide)

    def _provide(self) -> None:
        component = self._component
        if component.provision(QueryMachineStates.CODE) is None:
            component.provide(QueryMachineStates, ReportMachineStates, self._report)

    def watch(self, service: str, machine: str) -> Callable[[str], None] | None:
        """Returns the function to call with each entered state; None if that is not reported."""
        if not self._is_provided:
            return None
        times = _Times(service, machine, self._component.loop.now)
        self._machines.append(times)

        def entered(state: str) -> None:
            times.enter(state)
            self._component.report_changed(ReportMachineStates)

        return entered

    def _report(self, _query: Message, _sender: JausAddress) -> ReportMachineStates:
        machines = self._machines[:MAX_MACHINES]
        # In equal parts for each machine.
        most = MAX_STATES // max(1, len(machines))
        return ReportMachineStates([machine.report(most) for machine in machines])


def _milliseconds(seconds: float) -> int:
    return max(0, round(seconds * 1000))


def _jaus_string(name: str) -> str:
    """Returns a name as a JAUS string: Latin-1, and not too long."""
    return name.encode("latin-1", "replace").decode("latin-1")[:_LONGEST_NAME]
