"""Files that are no text as it should be: line ends, emptiness, numbers without end."""

import pytest

from jausml.language.model import read_models
from jausml.language.validation.engine import check_project


def rules(folder, data, name="robot.ros2jaus"):
    path = folder / name
    path.write_bytes(data)
    return [diagnostic.rule for diagnostic in check_project([path]).diagnostics]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_comment_ends_with_its_line_whatever_ends_lines(tmp_path, end):
    text = f"// robot{end}component v {{ address: 0.0.0 }}{end}"

    assert "JML301" in rules(tmp_path, text.encode())
    found = check_project([tmp_path / "robot.ros2jaus"]).diagnostics
    assert {diagnostic.location.line for diagnostic in found} == {2}


@pytest.mark.parametrize("data", [b"", b"\xef\xbb\xbf"])
def test_an_empty_file_is_no_model(tmp_path, data):
    assert rules(tmp_path, data) == ["JML714"]


@pytest.mark.parametrize("mark", ["\ufeff", "\x00", "\x1b"])
def test_marks_that_are_nothing_are_told(tmp_path, mark):
    text = f"component v {{ address: 1.1.1 }}{mark}component w {{ address: 1.1.2 }}\n"

    assert "JML701" in rules(tmp_path, text.encode())


@pytest.mark.parametrize("mark", ["\f", "\x0b", "\x85", "\u2028"])
def test_marks_that_are_blanks_hide_nothing(tmp_path, mark):
    text = f"component v {{ address: 1.1.999 }}{mark}component w {{ address: 1.1.999 }}\n"

    assert rules(tmp_path, text.encode()).count("JML301") == 2


@pytest.mark.parametrize("digits", ["0x" + "F" * 5000, "9" * 5000, "0." + "9" * 5000])
@pytest.mark.parametrize(
    "text",
    [
        "component v {{ address: 1.1.1  authority: {} }}",
        "m {{ JAUS A ( uint8 [{}] a ) ROS B ( uint8 a ) JAUS->ROS ( a -> a ) }}",
        "m {{ JAUS A ( uint8 a {{ lower: {} }} ) ROS B ( uint8 a ) JAUS->ROS ( a -> a ) }}",
        "m {{ JAUS A ( uint8 a ) ROS B ( uint8 a ) JAUS->ROS ( a -> a : scale({}) ) }}",
        "m {{ JAUS A {{ code: {} }} ( uint8 a ) ROS B ( uint8 a ) JAUS->ROS ( {} -> a ) }}",
    ],
)
def test_numbers_without_end_are_told(tmp_path, digits, text):
    found = rules(tmp_path, text.replace("{}", digits).format().encode())

    assert found
    assert "JML000" not in found


@pytest.mark.slow
def test_references_from_file_to_file_without_end_are_told(tmp_path):
    head = (
        '<?xml version="1.0"?>\n<system:System xmi:version="2.0" name="s{n}"'
        ' xmlns:xmi="http://www.omg.org/XMI" xmlns:system="http://www.jausml.org/system/1.0">'
    )
    for n in range(1500):
        inside = f'<components href="f{n + 1}.xmi#//@components.0"/>'
        if n == 1499:
            inside = '<components name="v" address="1.1.1"/>'
        text = f"{head.format(n=n)}{inside}</system:System>\n"
        (tmp_path / f"f{n}.xmi").write_text(text, encoding="utf-8")

    found = read_models([tmp_path / "f0.xmi"]).diagnostics

    assert "JML202" in {diagnostic.rule for diagnostic in found}
    assert any("more than 100" in diagnostic.message for diagnostic in found)
