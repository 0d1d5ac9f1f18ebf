"""Completion of what is typed in a session of `jausml ocu`."""

import pytest
from click.shell_completion import ShellComplete

from jausml.cli import main
from jausml.live.peers.console import Console
from jausml.live.peers.operator import running_operator

pytestmark = pytest.mark.ports


@pytest.fixture
def console(network, catalogue, vehicle):
    vehicle()
    with running_operator(network, catalogue, 10.0) as operator:
        made = Console(operator, lambda _: None)
        made.execute("services", "100.1.1")
        yield made


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("que", ["query"]),
        ("query ", ["100.1.1"]),
        ("query 100.1.1 VelocitySt", ["VelocityState"]),
        ("query VelocityS", ["VelocityState"]),
        # Of a driver that it does not provide.
        ("request 100.1.1 SetGlobalW", []),
        ("send SetWrench", ["SetWrenchEffort"]),
        (
            "send SetWrenchEffort propulsivelinear",
            [f"PropulsiveLinearEffort{axis}=" for axis in "XYZ"],
        ),
        (
            "request 100.1.1 SetWrenchEffort PropulsiveLinearEffortX=1 PropulsiveL",
            ["PropulsiveLinearEffortY=", "PropulsiveLinearEffortZ="],
        ),
        ("release 100", ["100.1.1"]),
        ("wait ", []),
        ("nothing ", []),
    ],
)
def test_words_that_may_stand_next(console, line, words):
    found = console.completions(line)
    assert set(words) <= set(found)
    if not line.endswith(" ") or not words:
        assert found == words


def test_a_shell_offers_the_messages_of_the_component_that_is_named(vehicle, free_port):
    vehicle()
    shell = ShellComplete(main, {}, "jausml", "_JAUSML_COMPLETE")

    def offered(begun, *words):
        arguments = ["ocu", words[0], "--port", str(free_port), *words[1:]]
        return [completion.value for completion in shell.get_completions(arguments, begun)]

    assert offered("Velocity", "query", "100.1.1") == ["VelocityState"]
    assert offered("SetW", "request", "100.1.1") == ["SetWrenchEffort"]
    assert offered("SetGlobalW", "request", "100.1.1") == []
    # Of one that does not answer nothing is known.
    assert "SetGlobalWaypoint" in offered("SetGlobalW", "request", "100.1.9")
    fields = offered("PropulsiveLinear", "request", "100.1.1", "SetWrenchEffort")
    assert fields == [f"PropulsiveLinearEffort{axis}=" for axis in "XYZ"]
