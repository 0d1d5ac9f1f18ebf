"""Reports of components as attributes of `ComponentAnswer`."""

from __future__ import annotations

from typing import Any

from jausml.live.peers.discovery import controller_of
from jausml.live.peers.query_client import status_of
from jausml.live.systems.machines import MOST_MACHINES, MachineState, StateTime
from jausml.runtime.messages import ReportControl, ReportStatus, ReportTimeout
from jausml.runtime.messages.machine_states import ReportMachineStates


def state_in(report: ReportStatus, _client: str = "") -> dict[str, Any]:
    """Returns the name of the state that a component reports."""
    state = status_of(report)
    return {"state": state.name if state is not None else f"state {report.status}"}


def control_in(report: ReportControl, _client: str = "") -> dict[str, Any]:
    """Returns the reported controller (an empty text for none) and its authority code."""
    controller = controller_of(report) if report.subsystem_id else ""
    return {"controller": controller, "authority": report.authority_code}


def timeout_in(report: ReportTimeout, _client: str = "") -> dict[str, Any]:
    """Returns the reported seconds after which control of a component lapses."""
    return {"control_timeout": int(report.timeout)}


def machines_in(report: ReportMachineStates, _client: str = "") -> dict[str, Any]:
    """Returns the reported state machines."""
    machines = tuple(
        MachineState(
            machine.machine_rec.service,
            machine.machine_rec.machine,
            machine.machine_rec.state,
            machine.machine_rec.milliseconds / 1000,
            tuple(
                StateTime(time.state, time.entries, time.milliseconds / 1000)
                for time in machine.time_list
            ),
        )
        for machine in report.machine_list[:MOST_MACHINES]
    )
    return {"machines": machines}
