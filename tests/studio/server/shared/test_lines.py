"""Lines in the views of machines and services, and maps that are filled, over a real socket."""

import pytest

pytestmark = pytest.mark.ports

FILE = "service.xmi"
MACHINE = {"file": FILE, "view": "machine:Winch.ReceiveFSM"}
SERVICE = {"file": FILE, "view": "service:Winch"}


def test_a_transition_is_drawn_from_state_to_state(page):
    graph = page.ask("view", **MACHINE)["graph"]
    assert page.ask("form", element=graph["element"])["class"] == "state machine"
    boxes = {node["title"]: {"node": node["id"], "port": ""} for node in graph["nodes"]}
    ends = page.ask("ends", **MACHINE, **boxes["Idle"])["ends"]
    assert {"Locked", "PayingIn", "Idle"} <= {end["label"] for end in ends}
    found = page.ask("connect", **MACHINE, source=boxes["Idle"], target=boxes["Locked"])
    option = next(
        offered for offered in found["options"] if offered["label"] == "transition on EndStop"
    )
    page.ask("edit", commands=option["commands"], label=option["label"])
    after = page.ask("view", **MACHINE)["graph"]["edges"]
    assert len(after) == len(graph["edges"]) + 1


def test_what_a_service_inherits_is_picked_and_taken_away(page):
    graph = page.ask("view", **SERVICE)["graph"]
    own = next(node for node in graph["nodes"] if node["element"] == graph["element"])
    ends = page.ask("ends", **SERVICE, node=own["id"], port="")["ends"]
    events = next(end for end in ends if end["label"].startswith("Events"))
    source = {"node": own["id"], "port": ""}
    target = {"node": events["node"], "port": events["port"]}
    [option] = page.ask("connect", **SERVICE, source=source, target=target)["options"]
    page.ask("edit", commands=option["commands"], label=option["label"])
    edges = page.ask("view", **SERVICE)["graph"]["edges"]
    line = next(edge["id"] for edge in edges if edge["kind"] == "inherits")
    [option] = page.ask("unlink", file=FILE, line=line)["options"]
    page.ask("edit", commands=option["commands"], label=option["label"])
    kinds = {edge["kind"] for edge in page.ask("view", **SERVICE)["graph"]["edges"]}
    assert kinds <= {"owns", "answers"}


def test_a_line_that_follows_from_its_ends_is_not_taken_away(page):
    asked = {"file": "catvehicle.xmi", "line": "any"}
    assert "follows" in page.ask("unlink", **asked)["refusal"]


def test_a_map_is_filled_by_what_is_offered(page):
    asked = {"file": "catvehicle.xmi", "view": "map:velocity_state"}
    found = page.ask("fill_map", **asked)
    assert (
        "Velocity_Z -> twist.twist.linear.z : negate { whenAbsent: dropMessage }"
        in found["statements"]
    )
    assert (
        "Velocity_RMS -> twist.covariance[7] : square { whenAbsent: leave }" in found["statements"]
    )
    assert found["left"]["to_ros"] == ["pose"]
    done = page.ask("edit", commands=found["commands"], label=found["label"])
    assert len(done["created"]) == len(found["statements"])
    assert page.ask("fill_map", **asked)["refusal"]
