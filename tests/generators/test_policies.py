"""SROS 2 policies: of the form that `ros2 security` takes, and no more than a bridge needs."""

from pathlib import Path

import needs
import pytest
from generated import model_of, texts_of
from lxml import etree
from sweeps import sweep

from jausml_generators.bringup.target import TARGET as BRINGUP

ROOT = Path(__file__).resolve().parents[2]
LISTS = ROOT / "tests" / "live" / "waypoint_lists.ros2jaus"
MODELS = [
    *sorted((ROOT / "models" / "examples").glob("*/*.ros2jaus")),
    ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi",
    LISTS,
]

# Attributes and children of each element, by the schema of policies of version 0.2.0.
FORM = {
    "policy": ({"version"}, {"enclaves"}),
    "enclaves": (set(), {"enclave"}),
    "enclave": ({"path"}, {"profiles"}),
    "profiles": (set(), {"profile"}),
    "profile": ({"ns", "node"}, {"topics", "services", "actions"}),
    "topics": ({"publish", "subscribe"}, {"topic"}),
    "services": ({"reply", "request"}, {"service"}),
    "actions": ({"call", "execute"}, {"action"}),
    "topic": (set(), set()),
    "service": (set(), set()),
    "action": (set(), set()),
}
ONE_USE = {"topics", "services", "actions"}
OWN = {
    *("change_state", "describe_parameters", "get_available_states", "get_available_transitions"),
    *("get_parameter_types", "get_parameters", "get_state", "get_transition_graph"),
    *("get_type_description", "list_parameters", "set_parameters", "set_parameters_atomically"),
}


def policies(path: Path) -> dict[str, str]:
    files = texts_of(model_of(path), [BRINGUP])
    return {name: text for name, text in files.items() if name.endswith(".policy.xml")}


def names(text: str, element: str, use: str) -> set[str | None]:
    root = etree.fromstring(text.encode())
    return {match.text for match in root.findall(f".//{element}s[@{use}='ALLOW']/{element}")}


def check_form(element: etree._Element) -> None:
    attributes, children = FORM[element.tag]
    if element.tag in ONE_USE:
        assert len(element.attrib) == 1
        assert set(element.attrib) <= attributes
        assert set(element.attrib.values()) == {"ALLOW"}
    else:
        assert set(element.attrib) == attributes
    assert {child.tag for child in element.iterchildren(etree.Element)} <= children
    if children:
        assert len(element)
    else:
        assert element.text
        assert element.text.startswith("/")
    for child in element.iterchildren(etree.Element):
        check_form(child)


@pytest.mark.parametrize("path", sweep(MODELS, every=4), ids=lambda path: path.stem)
def test_policies_have_the_form_of_their_schema(path):
    made = policies(path)
    assert made == policies(path)
    for name, text in made.items():
        root = etree.fromstring(text.encode())
        check_form(root)
        assert root.get("version") == "0.2.0"
        assert len(list(root.iter("profile"))) == 1
        assert "/security/" in name


def test_a_bridge_may_use_its_topics_and_no_others():
    (text,) = policies(ROOT / "models" / "examples" / "waypoints" / "waypoints.ros2jaus").values()
    own = "/vehicle/waypoint_vehicle"
    assert f'<enclave path="{own}">' in text
    assert '<profile ns="/vehicle" node="waypoint_vehicle">' in text
    assert names(text, "topic", "publish") == {
        *("/diagnostics", "/parameter_events", "/rosout", f"{own}/transition_event"),
        *("/vehicle/cmd_fix", "/vehicle/local_goal", "/vehicle/speed"),
    }
    assert names(text, "topic", "subscribe") == {
        f"/vehicle/{name}" for name in ("current_goal", "fix", "imu", "odom")
    }
    assert names(text, "service", "reply") == {f"{own}/{name}" for name in OWN}
    assert not names(text, "service", "request")


def test_actions_are_called_or_executed():
    made = {Path(name).name: text for name, text in policies(LISTS).items()}
    uses = {
        name: (names(text, "action", "call"), names(text, "action", "execute"))
        for name, text in made.items()
    }
    assert uses == {
        "robot.policy.xml": ({"/robot/follow_waypoints"}, set()),
        "station.policy.xml": (set(), {"/station/navigate_through_poses"}),
        "tracker.policy.xml": ({"/robot/follow_path"}, set()),
        "spooler.policy.xml": ({"/robot/follow_waypoints"}, set()),
        "dispatcher.policy.xml": (set(), {"/station/navigate_through_poses"}),
    }


def test_services_are_called_or_served():
    (text,) = policies(ROOT / "tests/cases/rules/JML466-something-carried/good.xmi").values()
    assert names(text, "service", "reply") == {"/stop", *(f"/bridge/{name}" for name in OWN)}


def test_a_node_of_the_model_may_use_what_it_has():
    made = policies(ROOT / "tests" / "cases" / "ros_node" / "talk.xmi")
    (text,) = (text for name, text in made.items() if name.endswith("/talker.policy.xml"))
    assert names(text, "topic", "publish") == {
        *("/parameter_events", "/rosout", "/team/state", "/team/word")
    }
    assert not names(text, "topic", "subscribe")
    assert names(text, "service", "request") == {"/listener/double"}
    served = names(text, "service", "reply")
    assert "/team/talker/get_parameters" in served
    assert "/team/talker/change_state" not in served


def test_sros2_itself_takes_them(tmp_path, monkeypatch):
    needs.ask("sros2")
    from sros2 import keystore

    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    store = tmp_path / "keys"
    keystore.create_keystore(store)
    for number, path in enumerate(MODELS):
        for name, text in policies(path).items():
            file = tmp_path / f"{number}-{Path(name).name}"
            file.write_text(text, encoding="utf-8")
            enclave = etree.fromstring(text.encode()).find("enclaves/enclave")
            assert enclave is not None
            identity = enclave.get("path", "")
            if not (store / "enclaves" / identity.lstrip("/")).exists():
                keystore.create_enclave(store, identity)
            keystore.create_permission(store, identity, file)
            permissions = etree.parse(store / "enclaves" / identity.lstrip("/") / "permissions.xml")
            published = {match.text for match in permissions.findall(".//publish/topics/topic")}
            assert {f"rt{topic}" for topic in names(text, "topic", "publish")} <= published
            subscribed = {match.text for match in permissions.findall(".//subscribe/topics/topic")}
            assert {f"rt{topic}" for topic in names(text, "topic", "subscribe")} <= subscribed
            assert not any("*" in str(topic_name) for topic_name in published | subscribed)
