"""The judges' unit of a competition as a process: `judging_unit.py PORT`.

Each line on stdin begins a test; one line of JSON for each answer, and one at the end of the test.
"""

import sys
import time

from jausml_runtime.messages import (
    ConfirmControl,
    QueryIdentification,
    QueryStatus,
    QueryTimeout,
    RejectControl,
    ReleaseControl,
    ReportIdentification,
    ReportStatus,
    ReportTimeout,
    RequestControl,
    Resume,
)
from judges_unit import Unit
from roles import say
from tolerant.messages import QueryVelocityState, ReportVelocityState, SetWrenchEffort

SYSTEM = 1
PAUSE_S = 0.3
"""Seconds from an answer to the next message, at least."""
PATIENCE_S = 20.0


def test(unit: Unit, effort: float) -> None:
    """Runs one test."""
    unit.begin()
    for message, answer in (
        (QueryIdentification(SYSTEM), ReportIdentification),
        (RequestControl(authority_code=255), ConfirmControl),
        (QueryTimeout(), ReportTimeout),
        (Resume(), None),
        (QueryStatus(), ReportStatus),
        (SetWrenchEffort(propulsive_linear_effort_x=effort), None),
        (QueryVelocityState(presence_vector=0xFFFF), ReportVelocityState),
        (ReleaseControl(), RejectControl),
    ):
        unit.send(message.encode())
        answered, end = answer is None, time.monotonic() + PATIENCE_S
        while True:
            for packet in unit.answers(PAUSE_S):
                code = int.from_bytes(packet.payload[:2], "little")
                answered = answered or code == answer.CODE
                say("answer", code=code, source=str(packet.source), to=str(packet.destination))
            if answered or time.monotonic() > end:
                break
    say("tested", effort=effort)


def main() -> None:
    """Tests as often as it is told to."""
    unit = Unit(int(sys.argv[1]))
    say("ready")
    for line in sys.stdin:
        test(unit, float(line))


if __name__ == "__main__":
    main()
