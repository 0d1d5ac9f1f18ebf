"""What the editor is answered, as functions of a text and a place."""

import re

import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from jausml.authoring.editing.commands import Remove
from jausml.authoring.editor.completion import UNITS, complete
from jausml.authoring.editor.definition import define, outline
from jausml.authoring.editor.hover import hover
from jausml.authoring.editor.places import Columns, Place
from jausml.authoring.editor.workspace_edits import RenameError, fixes, rename, unsaved
from jausml.language.attributes.units import parse_unit
from jausml.language.metamodel.classes import bridge
from jausml.language.model.refs import ref_of
from jausml.language.text.reading.parsing import parse

MAP = """\
velocity {{
    JAUS ReportVelocityState
    ROS nav_msgs/Odometry
    table gear ( A <-> 1 )
    quantity top {{ value: 5 }}
    join imu {{ type: sensor_msgs/Imu }}
    report_join local {{ message: ReportLocalPose }}
    {way} (
        {}
    )
}}
other {{ table `other gear` ( A <-> 1 ) }}
"""


def to_ros(line):
    return MAP.format(line, way="JAUS->ROS")


def to_jaus(line):
    return MAP.format(line, way="ROS->JAUS")


@pytest.fixture
def offered(bench, at):
    """Returns the labels that are offered at a mark."""

    def labels(text):
        path, place = at(text)
        return [completion.label for completion in complete(bench, path, place).completions]

    return labels


@pytest.mark.parametrize(
    ("text", "some"),
    [
        ("¦", {"import", "bridge", "component", "map_library"}),
        ("import ¦", {"mappings.global_pose_sensor", "ros.geometry_msgs"}),
        ("bridge b { ¦ }", {"connection", "quantity", "frequency"}),
        ("m { JAUS ¦ }", {"ReportVelocityState", "QueryGlobalPose"}),
        ("m { JAUS ReportVel¦", {"ReportVelocityState"}),
        ("m { ROS geometry_msgs/T¦ }", {"geometry_msgs/Twist"}),
        ("m { JAUS ReportVelocityState ( ¦ ) }", {"Velocity_X", "TimeStamp"}),
        (to_ros("¦"), {"Velocity_X", "clock", "ignore"}),
        (to_ros("X -> y\n¦"), {"Velocity_X"}),
        (to_ros("a, Vel¦"), {"Velocity_X"}),
        (to_ros("Velocity_X -> ¦"), {"twist", "header"}),
        (to_ros("Velocity_X -> tw¦\nYaw -> x"), {"twist"}),
        (to_ros("Velocity_X -> a, twist.twist.¦"), {"twist.twist.linear"}),
        (to_ros("ignore ¦"), {"twist", "pose"}),
        (to_ros("X -> y : ¦"), {"negate", "look_up", "with_units"}),
        (to_ros("X -> y : negate, sc¦"), {"scale"}),
        (to_ros("X -> y : look_up(¦)"), {"gear"}),
        (to_ros("X -> y : value_to_percent(¦"), {"top"}),
        (to_ros("X -> y : with_units(¦)"), {"m/s"}),
        (to_ros('X -> y : with_units("¦")'), {"rad/s"}),
        (to_ros('"m" -> z\nX -> y : with_units("m¦")'), {"rad/s"}),
        (to_ros("X -> y { whenAbsent: ¦ }"), {"dropMessage", "leave"}),
        (to_ros("X -> y { ¦ }"), {"whenAbsent", "precision"}),
        (to_jaus("¦"), {"twist", "imu"}),
        (to_jaus("imu.¦"), {"imu.orientation"}),
        (to_jaus("x -> ¦"), {"Velocity_X"}),
        ("bridge b { connection c { map: ¦ } } velocity { JAUS X }", {"velocity"}),
        ("node n { publisher p { qos: { reliability: ¦ } } }", {"reliable", "best_effort"}),
        ("quantity q { units: ¦ }", {"m/s"}),
    ],
)
def test_completion(offered, text, some):
    assert some <= set(offered(text))


def test_completion_keeps_to_its_side_and_its_map(offered):
    assert "twist" not in offered(to_ros("¦"))
    assert "Velocity_X" not in offered(to_ros("X -> ¦"))
    assert offered(to_ros("X -> y : look_up(¦)")) == ["gear"]


def test_completion_in_the_elements_of_lists(offered):
    text = """m { JAUS ReportPath ROS nav_msgs/Path
        ROS->JAUS ( poses -> x { ¦ } ) }"""
    assert {"header", "pose"} <= set(offered(text))


def test_a_completion_replaces_the_whole_word(bench, at):
    path, place = at(to_ros("Velocity_X -> twist.tw¦ist.linear.x"))
    found = complete(bench, path, place)
    assert (found.start.column, found.end.column) == (23, 43)


@for_each("unit", UNITS)
def test_offered_units_are_units(unit):
    parse_unit(unit)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (to_ros("Velo¦city_X -> a"), ["unit meter per second", "-327.68 to 327.67", "forward"]),
        (to_ros("a -> twist.twist.linear.x¦"), ["unit m/s", "forwardLeftUp"]),
        (to_ros("a -> b : sc¦ale(2)"), ["scale(factor): number -> number", "factor"]),
        (to_ros("a -> b : look_up(ge¦ar)"), ["value_table **gear**"]),
        (to_ros("a -> b { when¦Absent: leave }"), ["**whenAbsent**: AbsentPolicy"]),
        (to_ros("a -> b { whenAbsent: le¦ave }"), ["**leave**"]),
        (to_jaus("imu.orient¦ation -> a"), ["Quaternion", "unknown if orientation_covariance[0]"]),
        ("m { JAUS ReportVelocity¦State }", ["VelocityStateSensor.ReportVelocityState", "0x"]),
        ("m { ROS geometry_msgs/Tw¦ist }", ["geometry_msgs.Twist"]),
        ("bri¦dge b { }", ["**bridge**"]),
        ("bridge b { freq¦uency: 5 }", ["**frequency**"]),
        ("/** Says it. */ velo¦city { JAUS X }", ["attribute_map **velocity**", "Says it."]),
    ],
)
def test_hover(bench, at, text, words):
    path, place = at(text)
    found = hover(bench, path, place)
    assert found is not None
    for word in words:
        assert word in found.text


@pytest.mark.parametrize("text", ["¦", "m { ¦ }", to_ros("Nothing¦ -> a"), "§¦"])
def test_hover_over_nothing(bench, at, text):
    assert hover(bench, *at(text)) is None


def test_definition_within_a_text(bench, at):
    path, place = at(to_ros("a -> b : look_up(ge¦ar)"))
    found = define(bench, path, place)
    assert (found.path, found.span.line, found.span.column) == (path, 4, 11)


def test_definition_of_an_imported_map(bench, at, tmp_path):
    (tmp_path / "maps.ros2jaus").write_text("\n  shared { JAUS X }")
    text = 'import "maps.ros2jaus" bridge b { connection c { map: sha¦red } }'
    found = define(bench, *at(text))
    assert (found.path.name, found.span.line, found.span.column) == ("maps.ros2jaus", 2, 3)


@pytest.mark.parametrize(
    ("text", "file", "tag"),
    [
        ("m { JAUS ReportVelocity¦State }", "mobility.xmi", 'name="ReportVelocityState"'),
        (to_ros("Velocity_¦X -> a"), "mobility.xmi", 'name="Velocity_X"'),
        (to_ros("a -> twist.twist.linear¦"), "geometry_msgs.xmi", 'name="linear"'),
    ],
)
def test_definition_in_the_library(bench, at, text, file, tag):
    found = define(bench, *at(text))
    assert found.path.name == file
    assert tag in found.path.read_text().splitlines()[found.span.line - 1]


def renamed(bench, text_at, name):
    """Returns the texts after a renaming, by the names of their files."""
    path, place = text_at
    edits = rename(bench, path, place, name)
    texts = {}
    for file in {edit.path for edit in edits}:
        lines = bench.text(file).split("\n")
        own = (edit for edit in edits if edit.path == file)
        for edit in sorted(own, key=lambda e: (e.span.line, -e.span.column), reverse=False):
            line, span = lines[edit.span.line - 1], edit.span
            lines[span.line - 1] = line[: span.column - 1] + edit.text + line[span.end_column - 1 :]
        texts[file.name] = "\n".join(lines)
    return texts


@pytest.mark.parametrize("mark", ["table ge¦ar", "look_up(ge¦ar)"])
def test_rename_a_table_from_anywhere(bench, at, mark):
    text = to_ros("a -> b : look_up(gear)") + "third { table gear ( ) }"
    new = renamed(bench, at(text.replace(mark.replace("¦", ""), mark, 1)), "the gear")
    expected = text.replace("table gear ( A", "table `the gear` ( A", 1)
    assert new["robot.ros2jaus"] == expected.replace("look_up(gear)", "look_up(`the gear`)")


def test_rename_a_join_in_paths(bench, at):
    text = to_jaus("imu.orientation -> a imu.x, twist -> b")
    new = renamed(bench, at(text.replace("join imu", "join im¦u")), "unit")["robot.ros2jaus"]
    assert new == text.replace("imu", "unit")


def test_rename_a_report_join_in_paths(bench, at):
    text = to_ros("local.Yaw -> a imu.x -> b")
    new = renamed(bench, at(text.replace("join local", "join lo¦cal")), "near")["robot.ros2jaus"]
    assert new == text.replace("local", "near")


def test_paths_of_a_joined_report_are_completed(offered):
    assert {"local.Yaw", "local.Roll"} <= set(offered(to_ros("local.¦")))


def test_rename_reaches_other_texts_and_steps_of_names(bench, at, tmp_path):
    using = tmp_path / "using.ros2jaus"
    using.write_text("nothing")
    bench.texts[using] = 'import "robot.ros2jaus"\nbridge b { connection c { map: velocity } }'
    new = renamed(bench, at(to_ros("a -> b").replace("velocity", "velo¦city", 1)), "speed")
    assert new["using.ros2jaus"].endswith("map: speed } }")
    assert new["robot.ros2jaus"].startswith("speed {")


def test_rename_reaches_the_closed_texts_of_the_project(bench, at, tmp_path):
    (tmp_path / ".project").write_text("", encoding="utf-8")
    (tmp_path / "models").mkdir()
    using = tmp_path / "models" / "using.ros2jaus"
    using.write_text('import "../robot.ros2jaus"\nbridge b { connection c { map: velocity } }')
    new = renamed(bench, at(to_ros("a -> b").replace("velocity", "velo¦city", 1)), "speed")
    assert new["using.ros2jaus"].endswith("map: speed } }")


def test_no_name_is_given_that_means_something_else_in_another_text(bench, at, tmp_path):
    using = tmp_path / "using.ros2jaus"
    using.write_text("nothing")
    bench.texts[using] = 'import "robot.ros2jaus"\nbridge b { connection m { peers: car } }'
    place = at("component ca¦r { }")
    with pytest.raises(RenameError, match=r"'m' of using.ros2jaus refers by peers to .*Bridge 'b'"):
        rename(bench, *place, "b")
    assert len(rename(bench, *place, "m")) == 2


def test_a_text_with_syntax_errors_is_mended_before_something_in_it_is_renamed(bench, at):
    with pytest.raises(RenameError, match=r"robot.ros2jaus cannot be parsed as it is"):
        rename(bench, *at("node a¦ { } node b {"), "c")


@pytest.mark.parametrize(
    ("text", "name", "reason"),
    [
        ("m { JAUS Report¦VelocityState }", "x", "only what a text declares"),
        (
            "import mappings.local_waypoint_driver "
            "bridge b { connection c { map: local_way¦point } }",
            "x",
            "shipped library",
        ),
        ("node a¦ { } node b { }", "b", "line 1 declares another"),
        ("node a¦ { }", " ", "printable"),
    ],
)
def test_renames_that_cannot_be(bench, at, text, name, reason):
    with pytest.raises(RenameError, match=reason):
        rename(bench, *at(text), name)


def test_outline():
    (velocity, other) = outline(to_ros("a -> b"))
    assert (velocity.name, velocity.kind) == ("velocity", "attribute_map")
    inner = [(child.name, child.kind) for child in velocity.children]
    joins = [("imu", "join"), ("local", "report_join")]
    assert inner == [("gear", "value_table"), ("top", "quantity"), *joins]
    assert [child.name for child in other.children] == ["other gear"]


def test_positions_in_units_of_the_editor():
    columns = Columns("ä🚜b\nx", "utf-16")
    assert [columns.place(0, units).column for units in (0, 1, 3, 4, 9)] == [1, 2, 3, 4, 4]
    assert columns.units(1, 4) == (0, 4)
    assert Columns("ä🚜b", "utf-8").units(1, 4) == (0, 7)
    assert Columns("ä🚜b", "utf-32").units(1, 4) == (0, 3)
    assert columns.end() == (1, 1)
    assert columns.place(7, 7) == Place(8, 1)


@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=20), st.integers(1, 25))
def test_positions_lead_back(text, column):
    line = re.split(r"\r?\n|\r", text)[0]
    column = min(column, len(line) + 1)
    for encoding in ("utf-8", "utf-16", "utf-32"):
        columns = Columns(text, encoding)
        assert columns.place(*columns.units(1, column)) == Place(1, column)


LETTERS = st.lists(st.sampled_from(["a", "ä", "🚜", "\n", "\r\n", "{", " "]), max_size=12).map(
    "".join
)


def told_at(text, offset, encoding):
    """Line and units of a place, as an editor tells them."""
    line = text[:offset].count("\n")
    before = text[:offset].rpartition("\n")[2]
    return line, len(before.encode(f"{encoding}-le")) // {"utf-16": 2, "utf-32": 4}[encoding]


@given(LETTERS, st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12), LETTERS), max_size=4))
def test_what_is_typed_gives_the_text_that_the_editor_has(text, changes):
    for encoding in ("utf-16", "utf-32"):
        shown, columns = text, Columns(text, encoding)
        for first, last, new in changes:
            start, end = sorted(min(offset, len(shown)) for offset in (first, last))
            # No place is within the end of a line.
            start, end = (
                offset - (shown[offset - 1 : offset + 1] == "\r\n") for offset in (start, end)
            )
            where = [told_at(shown, offset, encoding) for offset in (start, end)]
            columns = columns.edited(*where, new)
            shown = shown[:start] + new + shown[end:]
            assert columns.text == shown
            assert columns.end() == Columns(shown, encoding).end()


def test_what_is_typed_behind_the_end_is_at_the_end():
    columns = Columns("a\nb")
    assert columns.edited((7, 3), (9, 0), "c").text == "a\nbc"
    assert columns.edited((0, 9), (0, 9), "c").text == "ac\nb"
    assert columns.edited((1, 0), (0, 1), "").text == "ab"


def test_names_in_parts_are_found_where_they_have_moved_to(bench, at):
    parts = [f"  component c{n} {{\n    address: 1.1.{n}\n  }}\n" for n in range(1, 60)]
    bridge = "  bridge b {\n    connection c {\n      peers: c5¦\n    }\n  }\n"
    for above in ("", "\n", "\n\n\n", "\n"):
        text = f"system s {{\n{above}{''.join(parts)}{bridge}}}\n"
        path, place = at(text)
        assert "c59" in [
            completion.label for completion in complete(bench, path, place).completions
        ]
        where = define(bench, path, place)
        declared = 2 + len(above) + 4 * 3
        assert where.span.line == declared
        (system,) = outline(bench.text(path))
        assert system.children[4].span.line == declared
        assert [child.name for child in system.children[-1].children] == ["c"]


def test_answers_anywhere_in_a_text_whole_or_broken(bench, at):
    text = to_ros("Velocity_X -> twist.twist.linear.x : negate { whenAbsent: leave }")
    for position in range(0, len(text), 7):
        for broken in (text[:position] + "¦" + text[position:], text[:position] + "¦"):
            path, place = at(broken)
            complete(bench, path, place)
            hover(bench, path, place)
            define(bench, path, place)
            outline(bench.text(path))
    assert parse(text).faults == []


def candidates(bench, at, text):
    path, place = at(text)
    return {completion.label: completion for completion in complete(bench, path, place).completions}


@pytest.mark.parametrize(
    "text",
    [
        "component c { provides: ¦ }",
        "component c { provides: VelocityStateDriver, Vel¦ }",
        "bridge b { uses: ¦ }",
        "service Own { inherits: ¦ }",
        "bridge b { connection c { search: { services: ¦ } } }",
    ],
)
def test_services_of_the_library_are_offered(bench, at, text):
    found = candidates(bench, at, text)
    assert found.keys() >= {"VelocityStateSensor", "PrimitiveDriver", "Management"}
    assert found["VelocityStateSensor"].module == ""


def test_service_of_two_versions_brings_the_import_that_tells_which(bench, at):
    path, place = at("component c { provides: Disc¦ }")
    found = [
        completion
        for completion in complete(bench, path, place).completions
        if completion.label == "Discovery"
    ]
    assert [completion.module for completion in found] == ["jaus.core-1.0", "jaus.core-1.1"]
    imported = candidates(bench, at, "import `jaus.core-1.1`\ncomponent c { provides: Disc¦ }")
    assert imported["Discovery"].module == ""


def test_maps_of_the_library_bring_their_import_and_those_that_fit_come_first(bench, at):
    text = """\
import mappings.primitive_driver
component vehicle { address: 100.1.1  provides: VelocityStateSensor }
bridge front {
    uses: PrimitiveDriver
    connection a { peers: vehicle  map: ¦ }
}
"""
    found = candidates(bench, at, text)
    first = {name for name, candidate in found.items() if candidate.is_first}
    assert first >= {"velocity_state", "wrench_effort"}
    assert "global_pose" in found.keys() - first
    assert found["velocity_state"].module == "mappings.velocity_state_sensor"
    assert found["wrench_effort"].module == ""
    path, place = at(text)
    assert complete(bench, path, place).imports_end == Place(2, 1)


def said_at(bench, at, text):
    path, place = at(text)
    found = hover(bench, path, place)
    return found.text if found is not None else ""


def test_hover_shows_the_fields_of_a_message(bench, at):
    said = said_at(bench, at, "m { JAUS SetVelocity¦Command ROS std_msgs/Empty }")
    assert "**mobility.VelocityStateDriver.SetVelocityCommand** 0x0415" in said
    assert "| Velocity_X | scaled uint32 | meter per second |" in said
    assert "0 Set current command" in said
    assert "| optional |" in said


def test_hover_shows_the_fields_of_a_ros_type(bench, at):
    said = said_at(bench, at, "m { ROS nav_msgs/Odo¦metry }")
    assert "| pose | geometry_msgs/PoseWithCovariance |" in said
    fix = said_at(bench, at, "m { ROS sensor_msgs/NavSat¦Fix }")
    assert "| latitude | float64 | degree | unknown if status.status < 0 (" in fix
    assert "| covariance | float64[36] |" in said_at(
        bench, at, "m { ROS geometry_msgs/PoseWith¦Covariance }"
    )


def test_hover_shows_what_a_service_takes_and_sends(bench, at):
    said = said_at(bench, at, "component c { provides: VelocityState¦Sensor }")
    assert "`urn:jaus:jss:mobility:VelocityStateSensor` 1.0" in said
    assert "takes: QueryVelocityState" in said
    assert "sends: ReportVelocityState" in said


def test_hover_shows_the_ends_of_a_map(bench, at):
    text = "import mappings.primitive_driver\nbridge b { connection c { map: wrench_eff¦ort } }"
    said = said_at(bench, at, text)
    assert "JAUS `SetWrenchEffort`, ROS `geometry_msgs/Twist`" in said
    assert "JAUS->ROS, ROS->JAUS" in said


TWO_OPEN = """\
/** 🚜 */
one { JAUS ReportVelocityState  ROS geometry_msgs/Twist  openDecisions: { text: "🚜?" } }
two { JAUS ReportLocalPose  ROS geometry_msgs/Pose  openDecisions: { text: "b" blocking: false } }
// the end
¦"""


def text_after(bench, path, edits):
    """What a text is after edits, the last of it first."""
    text, lines = bench.text(path), bench.text(path).splitlines(keepends=True)
    for edit in sorted(
        edits, key=lambda text_edit: (text_edit.span.line, text_edit.span.column), reverse=True
    ):
        start, end = (
            sum(map(len, lines[: line - 1])) + column - 1
            for line, column in (
                (edit.span.line, edit.span.column),
                (edit.span.end_line, edit.span.end_column),
            )
        )
        text = text[:start] + edit.text + text[end:]
    return text


def test_what_is_found_in_a_line_has_its_fixes(bench, at):
    path, _ = at(TWO_OPEN)
    assert [*fixes(bench, path, range(1, 2))] == []
    [fix] = fixes(bench, path, range(3, 4))
    assert (fix.finding.rule, fix.finding.location.line) == ("JML498", 3)
    after = text_after(bench, path, fix.edits)
    assert (after.count("openDecisions"), '"b"' in after) == (1, False)
    bench.texts[path] += "three {"
    assert [*fixes(bench, path, range(3, 4))] == []


def test_commands_that_follow_each_other_are_one_change_of_a_text(bench, at):
    path, _ = at(TWO_OPEN)
    held = unsaved(bench, path)
    model = held.read(path).model
    refs = [ref_of(decision, model, held.root) for decision in model.instances(bridge.OpenDecision)]
    edits = held.edits([Remove(ref) for ref in refs])
    after = text_after(bench, path, edits)
    assert "openDecisions" not in after
    assert after.startswith("/** 🚜 */\none {")
    assert after.endswith("// the end\n")
    assert bench.text(path) == TWO_OPEN.replace("¦", "")
