"""A bridge that stood still obeys no command that waited longer than its silence timeout.

Halts around the timeout are the ones that matter: nothing has been lost by then, so that all that
was commanded meanwhile still waits, in sockets and in the queues of ROS.
"""

import signal
import time

import needs
import pytest

needs.ask("rclpy")

from .rover_system import COMMANDS

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(240)]

SILENCE = {"drive": 0.4, "cruise": 0.5}
"""Silence timeouts of the model in seconds."""

ON_THE_WAY = 0.15
"""Seconds that a command may be on its way besides, on a busy computer."""

TRIALS = 3
"""What waits in a bridge is late after each halt; what others hold up on its way, after one."""

HALTS = (0.6, 0.7, 0.85, 1.0, 1.5, 2.5, 10.0)
QUICK = (0.6, 0.85, 1.5)


def halt(system, seconds):
    """Halts the bridge; returns the ages of what was obeyed since, by connection."""
    system.flows(time.monotonic())
    system.signal("bridge", signal.SIGSTOP)
    time.sleep(seconds)
    ended_at = time.monotonic()
    system.signal("bridge", signal.SIGCONT)
    system.flows(ended_at)
    return {command: system.oldest(command, ended_at) for command in COMMANDS}


@pytest.mark.parametrize(
    "seconds",
    [
        pytest.param(duration, marks=() if duration in QUICK else pytest.mark.faults)
        for duration in HALTS
    ],
)
def test_what_waited_while_the_bridge_was_halted_is_not_obeyed(system, seconds, record):
    for _ in range(TRIALS):
        ages = halt(system, seconds)
        late = {
            connection: age
            for connection, age in ages.items()
            if age > SILENCE[connection] + ON_THE_WAY
        }
        if not late:
            break
    record(
        "halts", f"{seconds:g} s", {connection: round(age, 2) for connection, age in ages.items()}
    )
    assert not late, late
