"""A record goes onto a message, an array onto an array: members of one type in Figure 5."""

import importlib

import needs
import pytest
from efforts import EFFORTS
from generated import text_of

from jausml.generation.target import system_of
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.reports import requested_fields
from jausml.language.semantics.names import snake_case
from jausml.language.validation.engine import check_project
from jausml.proving.layout import ROS
from jausml.proving.round_trips import RoundTrip, assignment_of
from jausml_generators.bridge.target import TARGET
from tests.generators.assignment_support import generated

MODEL = """
struct [ float64 x  float64 top_speed  uint8[4] flags ] vel
struct [ vel inner  string<=20 note ] outer
float64 [3] triple
int16 [<=5] few

whole {
  JAUS SetWhole (
    outer membername  triple second  few third  struct [ uint8 A ] [2] last
    float32 [] free
  ) { code: 0xD201 }
  ROS Whole (
    outer membername2  triple second2  few third2  struct [ uint8 a ] [2] last2
    float32 [] free2
  )
  JAUS->ROS (
    membername -> membername2
    second -> second2  third -> third2  last -> last2  free -> free2
  )
  ROS->JAUS (
    membername2 -> membername { outOfRange: dropMessage }
    second2 -> second  third2 -> third  last2 -> last  free2 -> free
  )
}
bridge wholes {
  address: 1.1.2
  connection up { map: whole topic a {} }
  connection down { map: whole direction: rosToJaus topic a {} }
}
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return generated(MODEL, tmp_path_factory.mktemp("wholes"), "wholes")


def filled():
    """A ROS message with values that all differ."""
    types = importlib.import_module("wholes.ros_types")
    message = types.Whole()
    inner = message.membername2.inner
    inner.x, inner.top_speed, inner.flags = 1.5, -2.5, [1, 2, 3, 255]
    message.membername2.note = "note"
    message.second2, message.third2 = [0.5, 1.0, -1.0], [-7, 8]
    message.free2 = [0.25, 0.5]
    for number, element in enumerate(message.last2, 3):
        element.a = number
    return message


def test_members_go_over_by_names_and_elements_by_positions(made):
    message = filled()
    sent = made.bridge.translate_down(message)
    inner = sent.membername.inner
    assert (inner.x, inner.top_speed, list(inner.flags)) == (1.5, -2.5, [1, 2, 3, 255])
    assert sent.membername.note == "note"
    assert list(sent.second) == [0.5, 1.0, -1.0]
    again = made.bridge.translate_up(type(sent).decode(sent.encode()))
    assert again.to_cdr() == message.to_cdr()


def test_policies_hold_for_each_member(made):
    message = filled()
    message.membername2.inner.x = float("nan")
    with pytest.raises(made.error("OutOfRangeError"), match=r"membername2\.inner\.x|membername"):
        made.bridge.translate_down(message)


def test_the_compiled_core_makes_the_same(made):
    needs.ask("compiler")
    made.build()
    message = filled()
    command = made.bridge.translate_down(message).encode()
    for name, data, wanted in (
        ("down", message.to_cdr(), command),
        ("up", command, message.to_cdr()),
    ):
        assert made.compiled(name)(data) == wanted


def findings(text, tmp_path, name="model.ros2jaus"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    found = check_project([tmp_path / name]).diagnostics
    return [diagnostic for diagnostic in found if diagnostic.severity.name != "INFO"]


@pytest.mark.parametrize(
    ("jaus", "ros", "said"),
    [
        ("struct [ float64 x  float64 y ] m", "struct [ float64 x ] m",
            "'y' of 'm' has no counterpart in"),
        ("struct [ float64 x ] m", "struct [ float64 x  float64 y ] m", "'y' of "),
        ("struct [ float64 x ] m", "struct [ string x ] m", "'m.x' is a number, but 'm.x' is text"),
        ("float64[3] m", "float64[4] m", "'m' has 3 elements, 'm' has 4"),
        ("float64[3] m", "float64[] m", "'m' has 3 elements, 'm' has any number of"),
        ("struct [ uint8[2] a ] m", "struct [ uint8[3] a ] m", "'m.a' -> 'm.a' is of wholes"),
        ("float64[3] m", "string[3] m", "'.' is a number, but '.' is text"),
        ("float64[3] m", "float64 m", "'m' is an array"),
    ],
)  # fmt: skip
def test_what_does_not_correspond_is_told_where_it_is_written(jaus, ros, said, tmp_path):
    ends = f"JAUS SetA ( {jaus} ) {{ code: 0xD201 }}\n  ROS A ( {ros} )"
    text = f"a {{\n  {ends}\n  JAUS->ROS (\n    m -> m\n  )\n}}\n"
    found = [finding for finding in findings(text, tmp_path) if finding.rule == "JML412"]
    assert [finding.location.line for finding in found] == [5], found
    assert said in found[0].message


def test_all_of_a_whole_is_assigned_and_part_of_it_not_again(tmp_path):
    text = MODEL[: MODEL.index("bridge wholes")]
    assert findings(text, tmp_path) == []
    again = text.replace(
        "second2 -> second ", "second2 -> second  membername2.inner.x -> membername.inner.x "
    )
    (found,) = findings(again, tmp_path)
    assert found.message == "'membername.inner.x' is assigned already"
    missing = text.replace("    membername2 -> membername { outOfRange: dropMessage }\n", "")
    assert {finding.rule for finding in findings(missing, tmp_path)} == {"JML416"}


WHOLE_REPORT = f"""
effort {{
  JAUS ReportWrenchEffort
  ROS Effort ( {"  ".join(f"float64 {name}" for name in EFFORTS)} )
  JAUS->ROS ( . -> . {{ whenAbsent: leave }} )
}}
component vehicle {{ address: 1.1.1 provides: PrimitiveDriver }}
bridge wholes {{
  address: 1.1.2
  connection up {{ map: effort peers: vehicle topic a {{}} }}
}}
"""


def test_a_report_that_goes_over_as_a_whole_is_asked_for_all_of_its_fields(tmp_path):
    """What a query does not name in its presence vector, the peer leaves out of the report."""
    path = tmp_path / "wholes.ros2jaus"
    path.write_text(WHOLE_REPORT, encoding="utf-8")
    report = check_project([path])
    assert not report.has_errors
    (asked,) = requested_fields(system_of(report.model).bridges[0]).values()
    assert sorted(map(snake_case, asked)) == sorted(EFFORTS)


VELOCITIES = ["velocity_x", "velocity_y", "velocity_z", "roll_rate", "pitch_rate", "yaw_rate"]
OTHER_WHOLES = f"""
velocity {{
  JAUS SetVelocityCommand
  ROS Velocity ( uint8 command_type  {"  ".join(f"float64 {name}" for name in VELOCITIES)} )
  JAUS->ROS ( . -> . {{ whenAbsent: leave }} )
}}
switched {{
  JAUS ReportSwitched ( uint8 Success  string<=20 Message ) {{ code: 0xD402 }}
  ROS std_srvs/SetBool.response
  JAUS->ROS ( . -> . )
}}
bridge more_wholes {{
  address: 1.1.2
  provides: VelocityStateDriver
  connection up {{
    map: velocity exchange: message onSilence: hold holdReason: "the rig stands on blocks"
    topic a {{}}
  }}
  ros_service_connection switch {{
    direction: rosToJaus service: switch type: std_srvs/SetBool successMember: success
    message: QueryWrenchEffort response: switched peers: vehicle
  }}
}}
component vehicle {{ address: 1.1.1 provides: PrimitiveDriver }}
"""


@pytest.fixture
def other_wholes(tmp_path):
    path = tmp_path / "more_wholes.ros2jaus"
    path.write_text(OTHER_WHOLES, encoding="utf-8")
    return check_project([path]).model


def test_a_limit_passes_where_the_whole_says_what_it_is(other_wholes):
    assert "a limit" not in text_of(other_wholes, [TARGET])


def test_a_whole_response_fills_the_member_that_tells_success(other_wholes):
    (call,) = other_wholes.instances(bridge.RosServiceConnection)
    assert calls.maps_success(call)


def test_a_proof_knows_which_whole_gives_a_number_its_value(other_wholes):
    used = other_wholes.instances(bridge.Connection)[0].map
    found = assignment_of(RoundTrip("one", used, used), ROS, "velocity_x")
    assert found is not None
    assert found.source == "Velocity_X"
