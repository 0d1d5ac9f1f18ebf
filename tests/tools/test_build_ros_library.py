"""The library of ROS interfaces: definitions are read exactly, the output is what is shipped."""

import importlib
from pathlib import Path

import build_ros_library as ros_library
import needs
import pytest
from lxml import etree

from jausml.language.interfaces import Installation

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "models" / "library" / "ros"


def test_unclear_line_is_reported_with_its_place(tmp_path, capsys):
    folder = tmp_path / "odd_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Odd.msg").write_text("what?\n")
    assert ros_library.main([str(tmp_path), "odd_msgs", "--output", str(tmp_path / "out")]) == 1
    assert "Odd.msg:1:1: error: JML643" in capsys.readouterr().err
    assert ros_library.main([str(tmp_path), "absent_msgs", "--output", str(tmp_path / "out")]) == 1
    assert "absent_msgs" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_semantics_of_a_field_that_is_not_there(tmp_path, capsys):
    folder = tmp_path / "nav_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Path.msg").write_text("float64 x\n")
    assert ros_library.main([str(tmp_path), "nav_msgs", "--output", str(tmp_path / "out")]) == 1
    assert "no type nav_msgs/GridCells" in capsys.readouterr().err


def test_action_sections(tmp_path):
    folder = tmp_path / "demo" / "action"
    folder.mkdir(parents=True)
    (folder / "Go.action").write_text("int32 order\n---\nint32[] sequence\n---\nint32 step\n")
    assert ros_library.main([str(tmp_path), "demo", "--output", str(tmp_path)]) == 0
    action = etree.parse(tmp_path / "demo.xmi").getroot().find("actions")
    assert [part.tag for part in action] == ["goal", "result", "feedback"]
    assert action.find("feedback").get("name") == "Go_Feedback"


def test_units_axes_and_ranges_reach_the_library():
    root = etree.parse(LIBRARY / "sensor_msgs.xmi").getroot()
    (latitude,) = root.xpath("messages[@name='NavSatFix']/fields[@name='latitude']")
    stated = {name: latitude.get(name) for name in ("units", "frame", "minimum", "maximum")}
    assert stated == {"units": "degree", "frame": "geodetic", "minimum": "-90.0", "maximum": "90.0"}


def test_library_holds_no_words_of_others():
    for path in LIBRARY.glob("*.xmi"):
        assert "documentation" not in path.read_text(encoding="utf-8"), path.name


@pytest.mark.needs("interfaces")
def test_shipped_library_is_what_the_tool_writes(tmp_path):
    share = Installation().folder("geometry_msgs").parent
    assert ros_library.main([str(share), "--output", str(tmp_path)]) == 0
    for path in sorted(LIBRARY.glob("*.xmi")):
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


@pytest.mark.needs("interfaces")
def test_shipped_fields_are_those_of_the_message_classes():
    """The slots of the installed classes are a second witness, independent of the parser."""
    for package in needs.INTERFACES:
        module = importlib.import_module(f"{package}.msg")
        root = etree.parse(LIBRARY / f"{package}.xmi").getroot()
        for message in root.findall("messages"):
            types = getattr(module, message.get("name")).get_fields_and_field_types()
            names = [field.get("name") for field in message.findall("fields")]
            # rosidl gives a message without fields one dummy member, which Python hides.
            assert names == [n for n in types if n != "structure_needs_at_least_one_member"]
