"""Proofs find what becomes of values, and every fault that is planted in one direction of a map."""

import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from jausml.generation.native import compiler
from jausml.language.model import Model
from jausml.language.validation.engine import check_project
from jausml.language.validation.rule import Report
from jausml.proving.compiled_form import CompiledForm, ProofCode, Tally, compiled, proof_code
from jausml.proving.plan import plan
from jausml.proving.results import FieldResult, with_proofs
from jausml.proving.round_trips import RoundTrip, round_trips
from jausml.proving.running import Settings, prove
from tests.generators.assignment_support import generated

GUARDS = ("generators/jausml_generators/cpp",)

pytestmark = pytest.mark.needs("compiler")

MESSAGE = """
service_set small {
  service Small {
    urn: "urn:example:Small"
    inputs: new message_def SetSmall {
      code: "0xD301"
      body: new record SmallRec {
        presenceVector: uint8
        fixed_field Speed { type: uint16 scale: { lower: -327.68 upper: 327.67 } }
        fixed_field Turn { type: uint16 optional: true scale: { lower: -1 upper: 1 } }
        fixed_field Gear { type: uint8 optional: true }
        fixed_field Wide { type: uint32 optional: true scale: { lower: -327.68 upper: 327.67 } }
        fixed_field Real { type: float32 optional: true }
        fixed_field Yaw {
          type: uint16 optional: true units: radian scale: { lower: -3.1415927 upper: 3.1415927 }
        }
      }
    }
  }
}
"""

BRIDGE = """
bridge proof_small {
  address: 1.1.2
  connection up { map: small topic a {} }
  connection down { map: small direction: rosToJaus topic a {} }
}
"""


def small(name: str = "small", type_: str = "geometry_msgs/Twist", **changed: str) -> str:
    """A map; `up` and `down` are its assignments, `more` is what else it has."""
    up = """
      Speed -> linear.x : negate
      Turn -> linear.y : scale(0.5)
      Gear -> angular.x
      Wide -> linear.z
      Yaw -> angular.y : expression("if(value > 3.14159265, value - 6.2831854, value)")
      Turn, Yaw -> angular.z : expression("value1 + value2")
    """
    down = """
      linear.x -> Speed : negate
      linear.y -> Turn : scale(2)
      angular.x -> Gear
      linear.z -> Wide
      angular.y -> Yaw : expression("value")
    """
    ways = f"JAUS->ROS ({changed.get('up', up)}) ROS->JAUS ({changed.get('down', down)})"
    return f"{name} {{ JAUS SetSmall ROS {type_} {changed.get('more', '')} {ways} }}\n"


class Proofs:
    """The results of the maps of a text."""

    def __init__(self, text: str, folder: Path, names: Sequence[str] = ()) -> None:
        self.path = folder / "proved.ros2jaus"
        self.path.write_text(text, encoding="utf-8")
        report = check_project([self.path])
        errors = {error.rule for error in report.diagnostics if error.severity.name == "ERROR"}
        assert errors <= {"JML422", "JML423"}, report.diagnostics  # nobody to talk to
        settings = Settings(str(compiler()), 0.01, 1)
        maps = [trip for trip in round_trips(report.model) if not names or trip.name in names]
        results = list(prove(report.model, maps, settings))
        self.maps = {result.name: result for result in results}
        self.report: Report = with_proofs(report, maps, results)

    def field(self, path: str, side: str = "JAUS", name: str = "small") -> FieldResult:
        found = self.maps[name].find(side, path)
        assert found is not None, path
        return found

    def rules(self, name: str) -> set[str]:
        return {
            diagnostic.rule
            for diagnostic in self.report.diagnostics
            if diagnostic.element == name and diagnostic.rule.startswith("JML92")
        }


@pytest.fixture(scope="module")
def proofs(tmp_path_factory: pytest.TempPathFactory) -> Proofs:
    return Proofs(MESSAGE + small(), tmp_path_factory.mktemp("proofs"))


def test_all_values_of_16_bits_are_unchanged(proofs):
    for path, total in {"Speed": 65536, "Turn": 65536, "Gear": 256}.items():
        found = proofs.field(path)
        assert (found.tried, found.unchanged, found.changed) == (total, total, 0), path
        assert found.has_way_back
        assert found.is_monotonic
        assert found.compared > 100
        assert not found.differing
    assert not proofs.rules("small")


def test_numbers_that_share_a_member_are_tried_together(proofs):
    for path in ("Turn", "Yaw"):
        found = proofs.field(path)
        assert found.mixed is not None, path
        assert (found.mixed.tried, found.mixed.changed) == (65536, 0), path
    # An angle that goes around: both its ends are the same one.
    assert proofs.field("Yaw").changed == 0
    assert proofs.field("Speed").mixed is None


def test_wide_numbers_are_never_claimed_as_all(proofs):
    found = proofs.field("Wide")
    assert not found.is_complete
    assert found.tried == 65536 == found.unchanged
    assert found.needs > 0.01
    assert not proofs.field("linear.x", "ROS").is_complete


def test_rounding_on_the_wire_is_told_from_the_side_of_ros(proofs):
    found = proofs.field("linear.z", "ROS")
    assert found.largest is not None
    step = 655.35 / (2**32 - 1)
    assert 0.49 * step < found.largest.error <= 0.5 * step * (1 + 1e-6)
    assert found.largest.between["Wide"] == pytest.approx(found.largest.back)


def test_what_does_not_fit_is_told_by_the_python_form(proofs):
    found = proofs.field("angular.x", "ROS")  # to a field of 8 bits, whose policy refuses
    assert found.refused == found.sampled > 0
    assert found.limited == 0
    assert proofs.field("linear.x", "ROS").limited > 0


@pytest.mark.slow
def test_every_count_is_that_of_a_loop_over_the_python_form(tmp_path):
    """The reference is a bridge that is generated and imported, without anything of proofs."""
    text = MESSAGE + small(
        up='Speed -> linear.x : expression("value * abs(value)") Gear -> linear.y : scale(3)',
        down='linear.x -> Speed : expression("value / 100") linear.y -> Gear',
    )
    proofs = Proofs(text, tmp_path)
    made = generated(text + BRIDGE, tmp_path, "proof_small")
    for path, name, others in (("Speed", "speed", {}), ("Gear", "gear", {"speed": 20.0})):
        found = proofs.field(path)
        counts = {"unchanged": 0, "changed": 0, "limited": 0, "refused": 0}
        largest = 0.0
        for raw in range(found.total):
            value = -327.68 + raw * (655.35 / 65535) if path == "Speed" else raw
            message = made.messages.SetSmall(**{"speed": 0.0, **others, name: value})
            counted = [made.bridge.up.statistics, made.bridge.down.statistics]
            for tally in counted:
                tally.out_of_range.clear()
            try:
                there = made.bridge.translate_up(made.messages.SetSmall.decode(message.encode()))
                back = made.bridge.translate_down(there).encode()
            except ValueError:
                counts["refused"] += 1
                continue
            if any(tally.out_of_range for tally in counted):
                counts["limited"] += 1
                continue
            error = abs(getattr(made.messages.SetSmall.decode(back), name) - value)
            counts["changed" if error > 1e-9 else "unchanged"] += 1
            largest = max(largest, error)
        assert {count: getattr(found, count) for count in counts} == counts, path
        assert sum(counts.values()) == found.total
        assert (found.largest.error if found.largest else 0.0) == pytest.approx(largest)
    assert proofs.rules("small") == {"JML922"}


SHORT = MESSAGE + small(
    type_="geometry_msgs/Point32",
    up="Speed -> x Wide -> y Real -> z : negate",
    down="x -> Speed y -> Wide z -> Real : negate",
)


@pytest.mark.slow
def test_single_precision_is_found_by_itself(tmp_path):
    proofs = Proofs(SHORT, tmp_path)
    narrow = proofs.field("Speed")
    # In single precision the greatest value is more than the field carries.
    assert (narrow.unchanged, narrow.limited, narrow.changed) == (65535, 1, 0)
    found = proofs.field("Wide")
    assert found.changed > 0.8 * found.tried
    assert found.largest is not None
    assert found.largest.error == pytest.approx(2.0**-16, rel=0.02)  # half an ulp at 256 and more
    assert abs(found.largest.value) >= 256
    assert not found.drifting
    assert not proofs.rules("small")


@pytest.mark.slow
def test_a_shortcut_counts_as_whole_messages_and_as_python_do(tmp_path):
    path = tmp_path / "short.ros2jaus"
    path.write_text(SHORT)
    model = check_project([path]).model
    (used,) = round_trips(model)
    code = proof_code(model, used)
    values = range(2**31 + 2**29, 2**31 + 2**29 + 20_000)
    found: dict[str, Tally] = {}
    with CompiledForm(compiled(code, tmp_path, str(compiler()))) as form:
        for planned in plan(code, form, used).fields:
            if not planned.shortcut:
                continue
            short = form.run(replace(planned.sweep, shortcut=planned.shortcut), values, 64)
            whole = form.run(planned.sweep, values, 64, threads=3)
            names = ("count", "unchanged", "changed", "largest", "drifting", "left", "result")
            for name in names:
                assert getattr(short, name) == getattr(whole, name), (planned.path, name)
            found[planned.path] = short
    assert found["Real"].unchanged == len(values)
    step = 655.35 / (2**32 - 1)
    unchanged = 0
    for raw in values:
        (single,) = struct.unpack("<f", struct.pack("<f", raw * step - 327.68))
        unchanged += round((single + 327.68) / step) == raw
    assert found["Wide"].unchanged == unchanged


ANGLES = """
service_set turning {
  service Turning {
    urn: "urn:example:Turning"
    inputs: new message_def SetAngles {
      code: "0xD302"
      body: new record AnglesRec {
        fixed_field Roll { type: uint16 units: radian scale: { lower: -3 upper: 3 } }
        fixed_field Pitch { type: uint16 units: radian scale: { lower: -3 upper: 3 } }
        fixed_field Yaw { type: uint16 units: radian scale: { lower: -3.1415927 upper: 3.1415927 } }
      }
    }
  }
}

angles {
  JAUS SetAngles
  ROS geometry_msgs/PoseStamped
  JAUS->ROS ( Roll, Pitch, Yaw -> pose.orientation : frd_angles_to_flu_quaternion )
  ROS->JAUS ( pose.orientation -> Roll, Pitch, Yaw : flu_quaternion_to_frd_angles )
}
"""


@pytest.mark.slow
def test_angles_beyond_upright_are_told_by_others(tmp_path):
    wide = Proofs(ANGLES, tmp_path)
    pitch = wide.field("Pitch", name="angles")
    assert 0.4 < pitch.changed / 65536 < 0.6
    assert pitch.mixed is not None
    assert 0.4 < pitch.mixed.changed / 65536 < 0.6
    roll = wide.field("Roll", name="angles")
    assert roll.mixed is not None
    assert roll.unchanged == 65536 > roll.mixed.unchanged


TWO_BRIDGES = """
there {
  JAUS SetSmall
  ROS geometry_msgs/Twist
  JAUS->ROS ( Speed -> linear.x  Gear -> angular.x )
}
back {
  JAUS SetSmall
  ROS geometry_msgs/Twist
  ROS->JAUS ( linear.x -> Speed  angular.x -> Gear )
}
other {
  JAUS SetSmall
  ROS geometry_msgs/Vector3
  ROS->JAUS ( x -> Speed )
}
bridge first {
  address: 1.1.2
  connection up { map: there topic /robot/speed {} }
}
bridge second {
  address: 1.1.3
  namespace: robot
  connection down { map: back direction: rosToJaus topic speed {} }
  connection elsewhere { map: back direction: rosToJaus topic /speed {} }
  connection unlike { map: other direction: rosToJaus topic speed3 {} }
}
"""


@pytest.mark.slow
def test_two_bridges_that_meet_at_a_topic_are_one_trip(tmp_path):
    name = "first.up + second.down"
    proofs = Proofs(MESSAGE + TWO_BRIDGES, tmp_path, (name,))
    trips = round_trips(proofs.report.model)
    assert [trip.name for trip in trips] == ["there", "back", "other", name]
    for path, total in (("Speed", 65536), ("Gear", 256)):
        found = proofs.field(path, name=name)
        assert found.has_way_back
        assert found.unchanged == found.tried == total
    assert proofs.field("linear.x", "ROS", name).has_way_back
    assert not proofs.rules(name)


@pytest.mark.slow
def test_a_factor_between_two_bridges_names_both(tmp_path):
    text = TWO_BRIDGES.replace("linear.x -> Speed ", "linear.x -> Speed : scale(0.5) ")
    name = "first.up + second.down"
    proofs = Proofs(MESSAGE + text, tmp_path, (name,))
    assert proofs.rules(name) == {"JML922"}
    found = next(finding for finding in proofs.report.diagnostics if finding.element == name)
    assert found.message.startswith(f"{name}: JAUS Speed is changed by ")
    line = proofs.path.read_text(encoding="utf-8").splitlines()[found.location.line - 1]
    assert "scale(0.5)" in line


JOINED = """
joined {
  JAUS SetSmall
  ROS geometry_msgs/Twist
  join gear { type: std_msgs/UInt8  freshness: 1.0  whenStale: dropMessage }
  JAUS->ROS ( Speed -> linear.x  Wide -> linear.z )
  ROS->JAUS (
    linear.x -> Speed
    gear.data -> Gear : expression("255 - value")
    linear.z, gear.data -> Wide : expression("if(data > 300, nan, z)")
  )
}
"""


@pytest.mark.slow
def test_joined_messages_are_tried_as_others(tmp_path):
    proofs = Proofs(MESSAGE + JOINED, tmp_path)
    gear = proofs.field("gear.data", "ROS", "joined")
    assert (gear.tried, gear.has_way_back) == (256, False)
    (reached,) = gear.reached
    assert (reached.path, reached.least, reached.greatest) == ("Gear", 0, 255)
    assert (reached.is_monotonic, reached.distinct) == (True, 256)
    # Without the joined message none would come back.
    for path in ("Speed", "Wide"):
        found = proofs.field(path, name="joined")
        assert found.has_way_back
        assert found.unchanged == found.tried == 65536, path
    for side, path in (("ROS", "gear.data"), ("JAUS", "Speed"), ("ROS", "linear.z")):
        found = proofs.field(path, side, "joined")
        assert found.compared > 100, path
        assert not found.differing, path
    model = check_project([proofs.path]).model
    (trip,) = round_trips(model)
    # What needs a joined message is no way of one number alone.
    assert proof_code(model, trip).shortcuts == ()


@pytest.mark.slow
def test_forms_that_differ_by_a_joined_message_are_told(tmp_path, monkeypatch):
    def planted(model: Model, used: RoundTrip) -> ProofCode:
        code = proof_code(model, used)
        assert any("255.0 - " in text for text in code.python.files.values())
        files = {
            path: text.replace("255.0 - ", "254.0 - ") for path, text in code.python.files.items()
        }
        return replace(code, python=replace(code.python, files=files))

    monkeypatch.setattr("jausml.proving.running.proof_code", planted)
    proofs = Proofs(MESSAGE + JOINED, tmp_path)
    assert proofs.field("gear.data", "ROS", "joined").differing > 100
    assert "JML925" in proofs.rules("joined")


def test_errors_that_nobody_foresees_are_told(tmp_path, monkeypatch):
    def planted(model: Model, used: RoundTrip) -> ProofCode:
        code = proof_code(model, used)
        files = {
            path: text.replace("        return target\n", '        raise RuntimeError("planted")\n')
            for path, text in code.python.files.items()
        }
        return replace(code, python=replace(code.python, files=files))

    monkeypatch.setattr("jausml.proving.running.proof_code", planted)
    proofs = Proofs(MESSAGE + small(), tmp_path)
    found = proofs.field("linear.x", "ROS")
    assert set(found.faults) == {"RuntimeError: planted"}
    assert "JML924" in proofs.rules("small")


FAULTY = small(
    more="quantity top { value: 10 }",
    up="""
      Speed -> linear.x
      Turn -> linear.y : scale(top)
      Wide -> linear.z : expression("0.02 - value")
      Gear -> angular.x
    """,
    down="""
      angular.y -> Gear
      linear.x -> Speed : expression("round(value)") { precision: 0.001 }
      linear.y -> Turn : scale(-0.05)
      linear.z -> Wide : negate
      angular.z -> Real { outOfRange: dropField }
    """,
)
POLICIES = """
bridge proof_policies {
  address: 1.1.2
  quantity top { value: 20 }
  connection up { map: small topic a {} }
  connection down { map: small direction: rosToJaus outOfRange: dropMessage topic a {} }
}
"""


@pytest.fixture(scope="module")
def faulty(tmp_path_factory: pytest.TempPathFactory) -> Proofs:
    return Proofs(MESSAGE + FAULTY + POLICIES, tmp_path_factory.mktemp("faulty"))


def test_what_a_bridge_says_of_its_map_counts(faulty):
    assert faulty.field("Turn").reached[0].greatest == 20  # as the bridge says, not the map
    found = faulty.field("linear.y", "ROS")
    assert found.limited == 0  # as the policy of the connection says
    assert found.refused == found.sampled > 0
    left_out = faulty.field("angular.z", "ROS")  # as the assignment says
    assert left_out.left_out > 0 == left_out.refused


# A wrong factor is found between two bridges, by the rule of signs and offsets.
def test_signs_offsets_rounding_and_other_members_are_found_at_their_assignments(faulty):
    lines = faulty.path.read_text(encoding="utf-8").splitlines()
    for field, rule, message, text in (
        ("Speed", "JML921", "error of up to 0.5", "precision: 0.001"),
        ("Turn", "JML922", "", "linear.y -> Turn"),
        ("Wide", "JML922", "", "linear.z -> Wide"),
        ("Gear", "JML923", "", "angular.y -> Gear"),
    ):
        (found,) = (
            diagnostic
            for diagnostic in faulty.report.diagnostics
            if diagnostic.rule == rule and f"JAUS {field} " in diagnostic.message
        )
        assert message in found.message
        assert text in lines[found.location.line - 1]
