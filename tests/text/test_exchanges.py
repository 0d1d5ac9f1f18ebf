"""Direction and exchange follow from services, peers and maps where they leave one way."""

import pytest

from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.notation import NOTATIONS
from jausml.language.text.writing.unparsing import to_text
from jausml.language.validation.engine import check

FRAME = """\
import mappings.velocity_state_sensor
import mappings.velocity_state_driver
import mappings.primitive_driver
import mappings.global_pose_sensor

component vehicle {{ address: 100.1.1  provides: VelocityStateSensor, PrimitiveDriver }}

bridge front {{
    address: 100.1.2
    {bridge}
    connection it {{ {connection} }}
}}
"""

SENSOR, DRIVER = "provides: VelocityStateSensor", "provides: PrimitiveDriver"
WAYS = {
    "report of its own": (SENSOR, "map: velocity_state topic odom", "rosToJaus periodicEvent"),
    "report of a peer": (
        "",
        "map: velocity_state peers: vehicle topic odom",
        "jausToRos periodicEvent",
    ),
    "command for itself": (DRIVER, "map: wrench_effort topic effort", "jausToRos message"),
    "command for a peer": (
        "",
        "map: wrench_effort peers: vehicle topic effort",
        "rosToJaus message",
    ),
    "exchange stated": (
        SENSOR,
        "map: velocity_state exchange: query topic odom",
        "rosToJaus query",
    ),
    "peers send unasked": (
        "",
        "map: velocity_state peers: vehicle exchange: message topic odom",
        "jausToRos message",
    ),
    "direction stated": (
        SENSOR,
        "map: velocity_state peers: vehicle direction: jausToRos topic odom",
        "jausToRos periodicEvent",
    ),
    "all stated": (
        DRIVER,
        "map: wrench_effort direction: jausToRos exchange: message topic effort",
        "jausToRos message",
    ),
}


def way(model) -> str:
    [connection] = model.instances(bridge.Connection)
    return f"{connection.direction.name} {connection.exchange.name}"


def braced(text: str) -> str:
    return text.replace("topic odom", "topic odom { }").replace("topic effort", "topic effort { }")


@pytest.mark.parametrize("case", WAYS)
def test_way_is_inferred_and_survives_xmi_and_text(case, texts):
    of_bridge, of_connection, expected = WAYS[case]
    text = FRAME.format(bridge=of_bridge, connection=braced(of_connection))
    model = texts.good(text)
    assert way(model) == expected

    document = model.documents[0]
    xmi = texts.write("there.xmi", to_xmi(document.roots, model, texts.folder / "there.xmi"))
    there = read_models([xmi], project_root=texts.folder, notations=NOTATIONS)
    assert way(there.model) == expected

    path = texts.folder / "back.ros2jaus"
    texts.write("back.ros2jaus", to_text(there.model.documents[0].roots, there.model, path))
    back = texts.read("back.ros2jaus")
    assert back.diagnostics == []
    assert way(back.model) == expected


def test_text_leaves_out_what_follows_and_says_what_does_not(texts):
    for case, needed in {
        "report of its own": [],
        "exchange stated": ["exchange: query"],
        "peers send unasked": ["exchange: message"],
        "direction stated": ["direction: jausToRos"],
    }.items():
        of_bridge, of_connection, _ = WAYS[case]
        text = FRAME.format(bridge=of_bridge, connection=braced(of_connection))
        model = texts.good(text)
        written = to_text(model.documents[0].roots, model, texts.folder / "demo.ros2jaus")
        lines = [line.strip() for line in written.splitlines()]
        said = [line for line in lines if line.startswith(("direction:", "exchange:"))]
        assert said == needed, case


def test_several_ways_are_named_with_what_they_mean(texts):
    text = FRAME.format(
        bridge="provides: VelocityStateSensor",
        connection="map: velocity_state peers: vehicle topic odom { }",
    )
    text = text.replace("connection it", "⟦JML715⟧connection it")
    [finding] = texts.check(text).diagnostics
    assert finding.message == "'it' may carry ReportVelocityState in several ways"
    assert finding.hint == (
        "write direction: jausToRos (front asks vehicle for it), "
        "or direction: rosToJaus (front reports it to whoever asks)"
    )


def hints(texts, of_bridge: str, of_connection: str) -> list[tuple[str, str]]:
    result = texts.one(FRAME.format(bridge=of_bridge, connection=braced(of_connection)))
    return [(diagnostic.rule, diagnostic.hint) for diagnostic in check(result).diagnostics]


def test_wrong_way_is_answered_with_what_to_write(texts):
    reports = "front reports it to whoever asks"
    assert hints(
        texts,
        "provides: VelocityStateSensor",
        "map: velocity_state direction: rosToJaus exchange: message topic odom",
    ) == [
        ("JML423", f"name peers or search for them, or write exchange: periodicEvent ({reports})")
    ]
    assert hints(
        texts,
        "provides: VelocityStateSensor",
        "map: velocity_state direction: jausToRos topic odom",
    ) == [("JML423", f"name peers or search for them, or write direction: rosToJaus ({reports})")]
    assert hints(
        texts, "provides: PrimitiveDriver", "map: wrench_effort direction: rosToJaus topic effort"
    ) == [
        (
            "JML423",
            "name peers or search for them, "
            "or write direction: jausToRos (front takes it from whoever sends it)",
        )
    ]


def test_xmi_keeps_its_defaults_and_is_told_the_attributes(texts):
    """Where XMI says nothing, it says the default; Eclipse shows it so."""
    text = FRAME.format(
        bridge="provides: VelocityStateSensor", connection=braced("map: velocity_state topic odom")
    )
    model = texts.good(text)
    xmi = to_xmi(model.documents[0].roots, model, texts.folder / "demo.xmi")
    plain = xmi.replace(' direction="rosToJaus" exchange="periodicEvent"', "")
    assert plain != xmi
    texts.write("demo.xmi", plain)
    result = texts.read("demo.xmi")
    assert way(result.model) == "jausToRos message"
    [finding] = check(result).diagnostics
    assert finding.rule == "JML422"
    assert 'write direction="rosToJaus" exchange="periodicEvent"' in finding.hint


def test_missing_service_is_the_one_error(texts):
    """The topic of a join has no error of its own, and the report is none that is sent to peers."""
    of_connection = "map: global_pose topic fix { } topic imu { join: imu }"
    assert hints(texts, "", of_connection) == [
        ("JML422", "add GlobalPoseSensor to what it provides")
    ]


def test_services_that_are_not_known_are_not_judged(texts):
    text = FRAME.format(
        bridge="provides: VelocityStateSensr", connection=braced("map: velocity_state topic odom")
    )
    assert [diagnostic.rule for diagnostic in check(texts.one(text)).diagnostics] == ["JML215"]
