"""`jausml new partition`: what it shows, what it writes, and what goes along."""

import json
from collections import Counter

import pytest

from jausml.authoring.projects.places import opened, place_of
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.partition import taken_over
from jausml.language.model import Severity, read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check
from jausml.views.analysis.partition.plans import Planner
from jausml.views.analysis.sizes import Assumptions

MODEL = """\
import `jaus.core-1.1`
import mappings.velocity_state_sensor
import mappings.primitive_driver

system rover {
    host base { }
    host arm { interface: "10.0.0.2" }
    component motion { address: 100.1.1  provides: VelocityStateSensor, PrimitiveDriver }
    component station { address: 100.1.2  uses: Lamp
        service_connection lamp { provider: main  message: ReportLamp }
    }
    service_set lamps {
        service Lamp { urn: "urn:example:Lamp"  version: "1.0"  inherits: Events
            inputs: new message_def QueryLamp { code: 0xD201 }
            outputs: new message_def ReportLamp { code: 0xD401
                record LampRec { fixed_field Level { type: uint8 } } }
        }
    }
    // A comment that stays.
    bridge main {
        address: 100.1.3
        namespace: robot
        frequency: 7
        uses: VelocityStateSensor, PrimitiveDriver
        provides: Lamp
        authority: 12
        own_map { JAUS ReportVelocityState  ROS std_msgs/Float64  JAUS->ROS ( Velocity_X -> data ) }
        lamp_map { JAUS ReportLamp  ROS std_msgs/UInt8  ROS->JAUS ( data -> Level ) }
        connection speed { map: own_map  exchange: periodicEvent  peers: motion  topic speed }
        connection twist {
            map: velocity_state_twist  exchange: periodicEvent  peers: motion  topic `~/twist`
        }
        connection lamp {
            map: lamp_map  direction: rosToJaus  exchange: periodicEvent  topic lamp
        }
        connection go {
            map: wrench_effort_stamped  direction: rosToJaus  peers: motion  silenceTimeout: 1
            topic go
        }
        connection steer {
            map: wrench_effort  direction: rosToJaus  peers: motion  silenceTimeout: 1
            topic steer
        }
    }
    bridge other { address: 100.1.4  authority: 12
        uses: VelocityStateSensor
        own_map { JAUS ReportVelocityState  ROS std_msgs/Float64  JAUS->ROS ( YawRate -> data ) }
        connection speed { map: own_map  exchange: periodicEvent  peers: motion  topic yaw }
    }
    placement { host: arm  components: other }
}
"""


@pytest.fixture
def model(tmp_path, monkeypatch):
    path = tmp_path / "rover.ros2jaus"
    path.write_text(MODEL, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return path


def bridges_in(path):
    """Returns the bridges of a model without errors, by name."""
    report = check(read_models([path], notations=NOTATIONS))
    assert [d for d in report.diagnostics if d.severity is Severity.ERROR] == []
    (system,) = report.model.documents[0].roots
    return {bridge.name: bridge for bridge in system.bridges}


def moved(path, names, target):
    """Moves connections of the bridge main to another one; returns the option that did it."""
    at = opened(place_of(path))
    main, _ = at.system.bridges
    carriers = [one for one in main.bridgeConnections if one.name in names]
    option = taken_over(at.scope, Planner(at.system, Assumptions()), carriers, target)
    at.project.do(option.commands, option.label)
    return option, at.project


def test_a_connection_takes_along_what_is_its_own(model):
    before = model.read_bytes()
    option, project = moved(model, ["lamp"], "other")
    main, other = bridges_in(model).values()
    assert option.label == "Move lamp to other"
    assert [one.name for one in other.bridgeConnections] == ["speed", "lamp"]
    assert [one.name for one in other.maps] == ["own_map", "lamp_map"]
    assert [one.name for one in other.provides] == ["Lamp"]
    assert not main.provides
    assert [one.name for one in main.maps] == ["own_map"]
    (asking,) = main.eContainer().components[1].connections
    assert asking.provider is other
    (placement,) = main.eContainer().placements
    assert (placement.host.name, placement.components[0]) == ("arm", other)
    assert "// A comment that stays." in model.read_text("utf-8")
    project.undo()
    assert model.read_bytes() == before


def test_who_asks_for_a_report_asks_who_makes_it(model):
    """A connection that takes the same report of others is not who makes it."""
    text = model.read_text("utf-8")
    head, tail = text.split("        connection twist {", 1)
    more = """\
        connection lamp_of_others {
            map: lamp_back  exchange: periodicEvent  peers: motion  topic lamp_of_others
        }
        lamp_back { JAUS ReportLamp  ROS std_msgs/UInt8  JAUS->ROS ( Level -> data ) }
"""
    text = f"{head}{more}        connection twist {{{tail}"
    text = text.replace("provides: VelocityStateSensor,", "provides: Lamp, VelocityStateSensor,")
    model.write_text(text, encoding="utf-8")
    moved(model, ["lamp_of_others"], "other")
    (asking,) = bridges_in(model)["main"].eContainer().components[1].connections
    assert asking.provider.name == "main"


def test_names_and_rates_mean_what_they_meant(model):
    moved(model, ["speed", "twist"], "other")
    _, speed, twist = bridges_in(model)["other"].bridgeConnections
    assert speed.name == "speed_2"
    assert speed.map.name == "own_map_2"
    assert speed.map.toRos[0].source == "Velocity_X"
    assert speed.topics[0].name == "/robot/speed"
    assert twist.topics[0].name == "/robot/main/twist"
    assert (speed.rate, twist.rate) == (7, 7)


def test_what_stays_together_goes_together(model):
    option, _ = moved(model, ["go"], "other")
    assert option.label == "Move go, steer to other"
    assert option.why == "one bridge alone can hold control of motion, and stop it"
    found = bridges_in(model)
    assert [one.name for one in found["other"].uses] == ["VelocityStateSensor", "PrimitiveDriver"]
    assert [one.name for one in found["main"].uses] == ["VelocityStateSensor"]


def test_safety_is_carried_along_and_never_mixed(model):
    text = model.read_text("utf-8").replace("address: 100.1.4  authority: 12", "address: 100.1.4")
    model.write_text(text, encoding="utf-8")
    with pytest.raises(AnswerError, match="authority is 12 here, 127 there"):
        moved(model, ["go"], "other")
    assert model.read_text("utf-8") == text


def test_what_a_map_says_of_a_quantity_is_not_mixed_with_what_a_bridge_says(model):
    said = 'authority: 12\n        quantity max_speed { value: 8  units: "m/s" }\n        uses'
    text = model.read_text("utf-8").replace("authority: 12\n        uses", said)
    model.write_text(text, encoding="utf-8")
    with pytest.raises(AnswerError, match="quantity max_speed is 8 m/s here, what the map says"):
        moved(model, ["go"], "other")


def test_who_hears_some_hosts_alone_is_not_mixed_with_who_hears_all(model):
    text = model.read_text("utf-8").replace("100.1.4 ", '100.1.4  allowedHosts: "10.0.0.0/24" ')
    model.write_text(text, encoding="utf-8")
    with pytest.raises(AnswerError, match="allowedHosts is"):
        moved(model, ["speed"], "other")


def test_a_map_whose_users_part_is_kept(model, jausml):
    more = "connection yaw { map: own_map  exchange: periodicEvent  peers: motion  topic yaw_2 }"
    text = model.read_text("utf-8").replace("topic yaw }", f"topic yaw }} {more}")
    model.write_text(text, encoding="utf-8")
    jausml("new", "partition", "--in", "one=other.speed", "--in", "two=yaw", "--yes")
    bridges = bridges_in(model)
    assert sorted(bridges) == ["main", "one", "two"]
    (speed,), (yaw,) = bridges["one"].bridgeConnections, bridges["two"].bridgeConnections
    assert speed.map is yaw.map
    assert speed.map.toRos[0].source == "YawRate"


def test_bridges_of_somebody_else_stay(model, jausml):
    text = model.read_text("utf-8")
    for address in ("100.1.3", "100.1.4"):
        text = text.replace(f"address: {address}", f"address: {address}  external: true")
    model.write_text(text, encoding="utf-8")
    jausml("new", "partition", "--yes")
    assert model.read_text("utf-8") == text


def test_a_new_bridge_has_the_settings_of_its_connections(model, jausml):
    jausml("new", "partition", "--in", "wheels=go", "--in", "main=lamp", "--yes")
    wheels = bridges_in(model)["wheels"]
    assert [one.name for one in wheels.bridgeConnections][-2:] == ["go", "steer"]
    assert (wheels.authority, wheels.namespace, wheels.frequency) == (12, "robot", 7)
    assert wheels.address == "100.1.5"
    jausml("format", model, "--check")


def test_it_shows_before_and_after_and_writes_when_told(model, jausml):
    before = model.read_bytes()
    shown = jausml("new", "partition", "--most", "3", "--plan")
    words = [line.split()[0] for line in shown.output.splitlines()[1:4]]
    assert words == ["before", "main", "other"]
    asked = jausml("new", "partition", "--most", "3")
    assert "nothing was written; --yes writes it" in asked.output
    assert model.read_bytes() == before
    output = jausml("new", "partition", "--most", "3", "--format", "json").output
    plan = json.loads(output.split("\nnothing")[0])
    jausml("new", "partition", "--most", "3", "--yes")
    meant = Counter({one["name"]: len(one["connections"]) for one in plan["after"]})
    assert meant == {n: len(one.bridgeConnections) for n, one in bridges_in(model).items()}
    # What is best already stays.
    again = jausml("new", "partition", "--most", "3", "--yes")
    assert "nothing that holds the limits would cost less" in again.output


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--most", "1"), "the limits cannot be held; nothing was written"),
        (("--together", "go,nothing"), "no connection nothing"),
        (("--together", "speed,go"), "more than one connection speed: write BRIDGE.NAME"),
        (("--in", "main"), "should be like"),
        (("--in", "one=go", "--in", "two=main.go"), "main.go cannot be in one and in two"),
        (("--in", "motion=go"), "has something of the name motion already"),
        (("--yes", "--plan"), "exclude each other"),
        (("-m", "nothing.ros2jaus"), "so it has no bridge"),
    ],
)
def test_what_cannot_be_is_told(model, refused, words, told):
    refused(told, model, "new", "partition", *words)


def test_a_model_with_errors_is_not_weighed(model, jausml):
    model.write_text(model.read_text("utf-8").replace("map: own_map", "map: no_map"), "utf-8")
    done = jausml("new", "partition", "--plan", status=1)
    assert "(did you mean 'own_map'?)" in done.output
    assert done.output.endswith("; nothing written\n"), done.output
