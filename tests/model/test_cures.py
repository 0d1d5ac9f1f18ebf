"""What messages say to do: the cure is one that helps."""

from jausml.language.model.xmi import parsing
from jausml.language.validation.engine import check_project

SYSTEM = (
    '<system:System xmlns:system="http://www.jausml.org/system/1.0" name="robot">{}</system:System>'
)


def test_other_encodings_are_told_to_become_utf_8():
    declared = '<?xml version="1.0" encoding="{}"?><a name="é"/>'
    texts = (
        declared.format("Shift_JIS").encode("utf-8"),
        declared.format("UTF-7").encode("utf-8"),
        '<a name="é"/>'.encode("latin-1"),
        declared.format("UTF-8").encode("latin-1"),
    )
    for data in texts:
        fault = parsing.parse(data).fault
        assert fault.rule in ("JML004", "JML006")
        assert "save it as UTF-8" in fault.hint


def test_a_wrong_character_is_no_matter_of_the_encoding():
    assert parsing.parse(b'<a name="b" & />').fault.hint == ""


MAP = """velocity {
    JAUS ReportVelocityState
    ROS nav_msgs/Odometry
    JAUS->ROS ( Velocity_X -> twist.twist.linear.x )
}
"""


def test_of_two_maps_of_one_name_one_is_renamed(tmp_path):
    path = tmp_path / "model.ros2jaus"
    path.write_text(f"{MAP}{MAP}bridge b {{ address: 1.1.1 connection c {{ map: velocity }} }}\n")
    found = check_project([path]).diagnostics
    (ambiguous,) = [diagnostic for diagnostic in found if diagnostic.rule == "JML216"]
    assert ambiguous.hint == "rename one of them"


def test_a_feature_that_is_unknown_names_those_that_there_are(tmp_path):
    xmi, text = tmp_path / "model.xmi", tmp_path / "model.ros2jaus"
    xmi.write_text(SYSTEM.format('<placements bridges="a"/>'))
    text.write_text("system robot { placement { bridges: a } }\n")
    for path in (xmi, text):
        found = check_project([path]).diagnostics
        (unknown,) = [diagnostic for diagnostic in found if diagnostic.rule == "JML103"]
        assert unknown.hint.startswith("it has "), unknown.hint
        assert " host" in unknown.hint


def test_the_places_of_many_unknown_attributes_are_found_in_one_walk(tmp_path, monkeypatch):
    walks = []
    whole = parsing.attribute_positions

    def counted(data, encoding, node):
        walks.append(node)
        return whole(data, encoding, node)

    monkeypatch.setattr("jausml.language.model.documents.attribute_positions", counted)
    path = tmp_path / "model.xmi"
    unknown = " ".join(f'bogus{number}="1"' for number in range(500))
    path.write_text(SYSTEM.format(f'<components name="a" address="1.1.1" {unknown}/>'))
    report = check_project([path])
    assert [diagnostic.rule for diagnostic in report.diagnostics] == ["JML103"] * 500
    columns = [diagnostic.location.column for diagnostic in report.diagnostics]
    assert columns == sorted(set(columns))
    assert len(walks) == 1


def test_an_empty_source_is_no_name_that_an_expression_may_use(tmp_path):
    path = tmp_path / "model.xmi"
    library = "http://www.jausml.org/library"
    path.write_text(
        '<bridge:MapLibrary xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xmlns:bridge="http://www.jausml.org/bridge/1.0" name="field"><maps name="m">'
        f'<message href="{library}/jaus/mobility.xmi#VelocityStateSensor.ReportVelocityState"/>'
        f'<type href="{library}/ros/geometry_msgs.xmi#Twist"/>'
        '<toRos xsi:type="bridge:FieldAssignment" target="linear.x" source="">'
        '<conversions kind="expression" expression="x"/></toRos></maps></bridge:MapLibrary>'
    )
    (unknown,) = [
        finding for finding in check_project([path]).diagnostics if finding.rule == "JML441"
    ]
    assert unknown.hint == "there is value"


def test_the_name_of_a_new_message_has_ascii_letters(tmp_path):
    path = tmp_path / "model.ros2jaus"
    text = "size {\n    JAUS Größe (\n        uint16 a\n    )\n    ROS std_msgs/Float64\n}\n"
    path.write_text(text, encoding="utf-8")
    found = [e for e in check_project([path]).diagnostics if e.rule == "JML215"]
    assert [diagnostic.location.line for diagnostic in found] == [2]
    assert "letters from A to z, digits and underscores" in found[0].hint


def test_an_id_that_reads_like_a_path_is_told_to_be_another_one(tmp_path):
    path = tmp_path / "model.xmi"
    head = '<components xmlns:xmi="http://www.omg.org/XMI" xmi:id="/x" name="a" address="1.1.1"/>'
    path.write_text(SYSTEM.format(f'{head}<hosts name="h"/><placements components="/x"/>'))
    (found,) = [
        finding for finding in check_project([path]).diagnostics if finding.rule == "JML202"
    ]
    assert found.hint == "the xmi:id '/x' is no path: use another id, without '/' at its beginning"
