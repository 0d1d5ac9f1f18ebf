"""States of both connections of an action, as `/diagnostics` tells them: the table of the docs."""

from itertools import takewhile
from pathlib import Path

import needs
import pytest

needs.ask("rclpy")

from ..bridge_support import wait_for
from .list_system import PATIENCE, facts, order, wait_goal
from .test_goals_to_lists import Client

pytestmark = [pytest.mark.slow, pytest.mark.live]

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "top.md"
CONNECTIONS = {"through": "goal to list", "follow": "list to goal"}
DEACTIVATE, ACTIVATE = 4, 3
"""Transitions of lifecycle_msgs."""


def table():
    """Returns the states of the page by what happens and connection."""
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    (start,) = (n for n, line in enumerate(lines) if line.startswith("| with an action |"))
    whole = takewhile(lambda line: line.startswith("|"), lines[start:])
    rows = [line.strip("|").split("|") for line in whole]
    head, _, *body = [[cell.strip() for cell in row] for row in rows]
    names = [next(n for n, kind in CONNECTIONS.items() if kind == heading) for heading in head[1:]]
    return {
        happens: {name: told for name, told in zip(names, row, strict=True) if told}
        for happens, *row in body
    }


class Watched:
    """What the table says must be, held against what the bridges say."""

    def __init__(self, peer):
        from diagnostic_msgs.msg import DiagnosticArray

        self.peer = peer
        self.table = table()
        self.arrays = peer.listen(DiagnosticArray, "/diagnostics")

    def states(self, since):
        """Yields each state that a connection had since then."""
        for array in self.arrays[since:]:
            for status in array.status:
                name = status.name.rpartition(": ")[2]
                if name in CONNECTIONS:
                    yield name, status.values[0].value

    def expect(self, happens, since=None):
        """Waits until each connection has the state of a row."""
        told = self.table.pop(happens)
        begin = len(self.arrays) if since is None else since
        for name, state in told.items():
            wait_for(
                lambda name=name, state=state: (name, state) in self.states(begin),
                f"{name} {state}: {happens}",
                PATIENCE,
            )

    def change(self, name, transition):
        """Has a bridge change its state of life."""
        from lifecycle_msgs.srv import ChangeState

        request = ChangeState.Request()
        request.transition.id = transition
        assert self.peer.call(ChangeState, f"/{name}/{name}/change_state", request).success


def test_states_of_the_table(system, peer):
    watched = Watched(peer)
    system.start_bridge("station")
    client = Client(peer)
    system.start_bridge("robot")
    watched.expect("nobody serves the action, nothing came yet")
    system.start_ros_robot()
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    watched.expect("the action is served, nothing came yet")
    goal = client.send_accepted(1, 2)
    wait_goal(system)
    watched.expect("a goal is executed")
    order(system, "next", "next")
    goal.ended()
    watched.expect("it has succeeded")
    goal = client.send_accepted(1, 2)
    wait_goal(system, 2)
    before = len(watched.arrays)
    order(system, "abort")
    goal.ended()
    watched.expect("it is aborted", before)
    watched.change("robot", DEACTIVATE)
    watched.expect("the node of the robot is deactivated")
    watched.change("robot", ACTIVATE)
    watched.expect("it is activated again")
    watched.change("station", DEACTIVATE)
    watched.expect("the node of the station is deactivated")
    watched.change("station", ACTIVATE)
    wait_for(lambda: client.send(1).handle.accepted, "acceptance", PATIENCE)
    system.processes["robot"].kill()
    watched.expect("the peer is gone")
    assert not watched.table
