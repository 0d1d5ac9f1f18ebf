# ruff: noqa: ARG002 - methods of skeletons have the parameters that the base gives them
"""Runs two generated components on loopback; not a test itself, see test_jaus_component.py.

Usage: exchange.py PORT, with the generated packages on the path; leaves with 0 when everything was
exchanged.
"""

from __future__ import annotations

import queue
import sys
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

import operator_jaus.operator_jaus_base as operator_base
from jausml_runtime import Status, TransportSettings, running_transport
from operator_jaus.messages import ReportWrenchEffort, SetWrenchEffort
from operator_jaus.operator_jaus import OperatorJaus
from wrench_driver import wrench_driver_base
from wrench_driver.messages import ReportLocalPose
from wrench_driver.messages import ReportWrenchEffort as DriverReport
from wrench_driver.wrench_driver import WrenchDriver

if TYPE_CHECKING:
    from jausml_runtime.messages import ReportTime

LIMIT = 20.0
events: queue.SimpleQueue[tuple[Any, ...]] = queue.SimpleQueue()
seen: list[tuple[Any, ...]] = []
all_seen: list[tuple[Any, ...]] = []


class Driver(WrenchDriver):
    def on_set_wrench_effort(self, message: Any, sender: Any) -> None:
        events.put(("effort", message.propulsive_linear_effort_x, self.status))

    def report_wrench_effort(self, query: Any, sender: Any) -> DriverReport:
        assert query.presence_vector == 0xFFF
        return DriverReport(resistive_linear_effort_x=100.0)

    def report_local_pose(self, query: Any, sender: Any) -> ReportLocalPose:
        return ReportLocalPose(x=1.0)

    def host_time(self) -> datetime:
        return datetime(2026, 3, 7, tzinfo=timezone.utc)

    def on_not_ready(self) -> None:
        events.put(("not ready",))


class Operator(OperatorJaus):
    def on_effort(self, report: ReportWrenchEffort, provider: Any) -> None:
        events.put(("report", report.resistive_linear_effort_x, provider == self.WRENCH_DRIVER))

    def on_effort_silent(self, provider: Any) -> None:
        events.put(("silent", provider == self.WRENCH_DRIVER))

    def on_pose(self, report: Any, provider: Any) -> None:
        events.put(("pose", round(report.x, 3)))

    def on_clock(self, report: ReportTime, provider: Any) -> None:
        events.put(("day", report.time_stamp.day if report.time_stamp else None))


def wait_for(*event: Any) -> None:
    while event not in seen:
        seen.append(events.get(timeout=LIMIT))
        all_seen.append(seen[-1])
    seen.clear()


def main() -> None:
    settings = TransportSettings(port=int(sys.argv[1]))
    with running_transport(settings) as first, running_transport(settings) as second:
        driver = Driver(first, wrench_driver_base.ADDRESS, wrench_driver_base.SETTINGS)
        operator = Operator(second, operator_base.ADDRESS, operator_base.SETTINGS)
        command = SetWrenchEffort(propulsive_linear_effort_x=100.0)
        driver.start()
        # Nobody has control: the command is not obeyed.
        driver.transport.send(operator.address, driver.address, command.encode())
        operator.start()
        wait_for("report", 100.0, True)
        wait_for("pose", 1.0)
        wait_for("day", 7)
        assert not any(event[0] == "effort" for event in all_seen)
        while driver.status is not Status.READY:
            wait_for("report", 100.0, True)
        operator.send(command, operator.WRENCH_DRIVER)
        wait_for("effort", 100.0, Status.READY)
        operator.control_of_wrench_driver.release()
        wait_for("not ready")
        driver.stop()
        wait_for("silent", True)
        operator.stop()


if __name__ == "__main__":
    main()
