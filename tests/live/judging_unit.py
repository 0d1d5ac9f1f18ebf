"""The judges' unit of a competition as a process: `judging_unit.py PORT`.

Each line on stdin begins a test; one line of JSON for each answer, and one at the end of the test.
"""

from __future__ import annotations

import sys

from jausml_runtime.messages import (
    QueryIdentification,
    QueryStatus,
    QueryTimeout,
    ReleaseControl,
    RequestControl,
    Resume,
)
from judges_unit import Unit
from roles import say
from tolerant.messages import QueryVelocityState, SetWrenchEffort

SYSTEM = 1
PAUSE_S = 0.3


def test(unit: Unit, effort: float) -> None:
    """Runs one test."""
    unit.begin()
    for message in (
        QueryIdentification(SYSTEM),
        RequestControl(authority_code=255),
        QueryTimeout(),
        Resume(),
        QueryStatus(),
        SetWrenchEffort(propulsive_linear_effort_x=effort),
        QueryVelocityState(presence_vector=0xFFFF),
        ReleaseControl(),
    ):
        unit.send(message.encode())
        for packet in unit.answers(PAUSE_S):
            code = int.from_bytes(packet.payload[:2], "little")
            say("answer", code=code, source=str(packet.source), to=str(packet.destination))
    say("tested", effort=effort)


def main() -> None:
    """Tests as often as it is told to."""
    unit = Unit(int(sys.argv[1]))
    say("ready")
    for line in sys.stdin:
        test(unit, float(line))


if __name__ == "__main__":
    main()
