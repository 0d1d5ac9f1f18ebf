"""A generated bridge and a peer that is not found by multicast and says nothing by itself."""

import sys
from pathlib import Path

import needs
import pytest
from ports import free_domain, free_port

needs.ask("rclpy")

from .bridge_support import Process, RosPeer, generate_text, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live]

JUDGE = str(Path(__file__).with_name("silent_judge.py"))
ENTRY = "155.1.1"
MODEL = """
import mappings.velocity_state_sensor
component judge {{ address: 42.1.1 type: ocu external: true endpoint: "127.0.0.1:{port}" {greet} }}
bridge entry {{
    address: 155.1.1
    type: vehicle
    provides: VelocityStateSensor
    connection velocity {{
        map: velocity_state direction: rosToJaus exchange: everyChangeEvent topic odom
    }}
}}
"""


@pytest.fixture
def system(tmp_path, monkeypatch):
    """Starts the judge, and the bridge of a model that says whether it is to be greeted."""
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    processes, peers = [], []

    def start(*, greet):
        place = free_port()
        text = MODEL.format(port=place, greet="greet: true" if greet else "")
        path = generate_text(tmp_path, "entry", text)

        def judge():
            processes.append(Process([JUDGE, str(place)], path, tmp_path / "judge.log"))
            wait_for(lambda: processes[-1].of_kind("ready"), "start of the judge")
            return processes[-1]

        def bridge():
            line = ["-m", "entry.main", "--jaus-port", str(free_port())]
            processes.append(Process(line, path, tmp_path / "entry.log"))
            return processes[-1]

        return judge, bridge

    def greetings():
        from diagnostic_msgs.msg import DiagnosticArray

        peers.append(RosPeer())
        arrays = peers[-1].listen(DiagnosticArray, "/diagnostics")

        def told():
            statuses = [status for array in list(arrays) for status in array.status]
            found = [status for status in statuses if status.name.endswith(": jaus greetings")]
            return [(status.message, status.values[0].value) for status in found]

        return arrays, told

    yield start, greetings
    for process in processes:
        process.close()
        sys.stderr.write(process.log.read_text())
    for peer in peers:
        peer.close()


def test_a_judge_that_must_be_greeted_is_so_until_it_answers(system):
    start, greetings = system
    judge, bridge = start(greet=True)
    _, told = greetings()
    entry = bridge()
    wait_for(lambda: ("running", "1") in told(), "greeting into the void")
    unit = judge()
    (services, *_) = wait_for(lambda: unit.of_kind("services"), "services, asked for")
    assert services["of"] == ENTRY
    assert "urn:jaus:jss:mobility:VelocityStateSensor" in services["urns"]
    wait_for(lambda: told()[-1] == ("running", "0"), "answer in the diagnostics")
    assert [(fact["by"], fact["scope"]) for fact in unit.of_kind("greeted")] == [(ENTRY, 2)]
    assert "42.1.1 speaks, and is greeted no more" in entry.log.read_text()


@pytest.mark.slow
def test_without_the_word_nobody_speaks(system):
    start, greetings = system
    judge, bridge = start(greet=False)
    unit = judge()
    arrays, told = greetings()
    bridge()
    wait_for(lambda: len(arrays) > 3, "diagnostics of a bridge at work")
    assert told() == []
    assert unit.of_kind("got") == []
