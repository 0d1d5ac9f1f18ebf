"""The library of ROS interfaces: definitions are read exactly, the output is what is shipped."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest
from lxml import etree

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "models" / "library" / "ros"


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location(
        "build_ros_library", ROOT / "tools" / "build_ros_library.py"
    )
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("float64 x", {"name": "x", "type": "float64"}),
        ("float64 w 1  # real", {"name": "w", "type": "float64", "default": "1"}),
        ("int8 A=-2", {"name": "A", "type": "int8", "constant": "-2"}),
        ('string S = "a # b" # c', {"name": "S", "type": "string", "constant": '"a # b"'}),
        ("string<=8 t", {"name": "t", "type": "string", "string_bound": 8}),
        (
            "float64[36] covariance",
            {
                "name": "covariance",
                "type": "float64",
                "array_kind": "fixedArray",
                "array_size": 36,
            },
        ),
        (
            "Range[<=1] r",
            {"name": "r", "type": "Range", "array_kind": "boundedSequence", "array_size": 1},
        ),
        (
            "geometry_msgs/Point[] p",
            {"name": "p", "type": "geometry_msgs/Point", "array_kind": "unboundedSequence"},
        ),
    ],
)
def test_line(tool, line, expected):
    assert tool.parse_line(line) == tool.FieldFacts(**expected)


@pytest.mark.parametrize("line", ["", "   ", "# only a comment", "  # 'quoted' too"])
def test_line_without_facts(tool, line):
    assert tool.parse_line(line) is None


def test_unclear_line_is_reported_with_its_file(tool, tmp_path, capsys):
    folder = tmp_path / "odd_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Odd.msg").write_text("what?\n")
    assert tool.main([str(tmp_path), "odd_msgs", "--output", str(tmp_path / "out")]) == 1
    message = capsys.readouterr().err
    assert "Odd.msg: what?" in message
    assert tool.main([str(tmp_path), "absent_msgs", "--output", str(tmp_path / "out")]) == 1


def test_action_sections(tool, tmp_path):
    folder = tmp_path / "demo" / "action"
    folder.mkdir(parents=True)
    (folder / "Go.action").write_text("int32 order\n---\nint32[] sequence\n---\nint32 step\n")
    assert tool.main([str(tmp_path), "demo", "--output", str(tmp_path)]) == 0
    action = etree.parse(tmp_path / "demo.xmi").getroot().find("actions")
    assert [part.tag for part in action] == ["goal", "result", "feedback"]
    assert action.find("feedback").get("name") == "Go_Feedback"


def test_shipped_library_is_what_the_tool_writes(tool, tmp_path):
    share = Path(sys.prefix) / "share"
    if not (share / "geometry_msgs").is_dir():
        pytest.skip("no ROS message packages in this environment")
    assert tool.main([str(share), "--output", str(tmp_path)]) == 0
    for path in sorted(LIBRARY.glob("*.xmi")):
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


def test_shipped_fields_are_those_of_the_message_classes():
    """The slots of the installed classes are a second witness, independent of the parser."""
    for package in ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "diagnostic_msgs"):
        module = pytest.importorskip(f"{package}.msg")
        root = etree.parse(LIBRARY / f"{package}.xmi").getroot()
        for message in root.findall("messages"):
            types = getattr(module, message.get("name")).get_fields_and_field_types()
            names = [field.get("name") for field in message.findall("fields")]
            # rosidl gives a message without fields one dummy member, which Python hides.
            assert names == [n for n in types if n != "structure_needs_at_least_one_member"]
