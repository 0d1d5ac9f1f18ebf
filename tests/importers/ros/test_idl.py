"""Definitions in IDL say what those in the notation of ROS say; the rest is told with its place."""

from dataclasses import replace
from pathlib import Path

import pytest
from for_each import for_each

from jausml.language.importers.ros import import_packages, package_sources
from jausml.language.interfaces import Installation
from jausml.language.interfaces.idl import parse_interface
from jausml.language.interfaces.parsing import definition_files

TRACK = """\
// A file of somebody.
#include "geometry_msgs/msg/Point.idl"
#include "std_msgs/msg/Header.idl"
module t_msgs { module msg {
  module Track_Constants {
    /** Nobody follows it. */
    const uint8 LOST = 2;
    const string FRAME = "a \\"map\\"" "\\n";
    const unsigned long MOST = 4;
  };
  typedef double double__9[9];
  typedef geometry_msgs::msg::Point corners[MOST];
  @verbatim (language="comment", text="What a camera" "\\n" "follows.")
  struct Track {
    std_msgs::msg::Header header;
    @unit (value="m/s") @default (value=-1.5) float speed_mps;
    @verbatim(language="c", text="x") @unit(value="bananas") long a, b; // two
    // Of the
    // corners.
    corners outline;
    sequence<double, 100> points;
    sequence<string<8>> names;
    @default (value="(1, 2, 3)") unsigned long long ids[3];
    @default (value=TRUE) boolean seen;
    @default (value="say \\"x\\"") string<16> label;
    double__9 covariance;
    wstring wide; octet raw; char letter; unsigned short u; long long big; int8 tiny;
  };
}; };
"""


def read(text, name="Track", kind="msg"):
    return parse_interface(f"t_msgs/{kind}/{name}.idl", kind, text)


def test_all_that_rosidl_reads():
    found = read(TRACK)
    (section,) = found.sections
    assert found.faults == []
    assert section.comment == "What a camera\nfollows."
    said = [(field.name, str(field.type), field.default, field.comment) for field in section.fields]
    assert said == [
        ("header", "std_msgs/Header", None, ""),
        ("speed_mps", "float32", "-1.5", ""),
        ("a", "int32", None, "two"),
        ("b", "int32", None, "two"),
        ("outline", "geometry_msgs/Point[4]", None, "Of the\ncorners."),
        ("points", "float64[<=100]", None, ""),
        ("names", "string<=8[]", None, ""),
        ("ids", "uint64[3]", "[1, 2, 3]", ""),
        ("seen", "bool", "true", ""),
        ("label", "string<=16", 'say "x"', ""),
        ("covariance", "float64[9]", None, ""),
        ("wide", "wstring", None, ""),
        ("raw", "byte", None, ""),
        ("letter", "char", None, ""),
        ("u", "uint16", None, ""),
        ("big", "int64", None, ""),
        ("tiny", "int8", None, ""),
    ]
    assert [field.units for field in section.fields[1:4]] == ["m/s", "bananas", "bananas"]
    assert [
        (constant.name, constant.type, constant.value, constant.comment)
        for constant in section.constants
    ] == [
        ("LOST", "uint8", "2", "Nobody follows it."),
        ("FRAME", "string", 'a "map"\n', ""),
        ("MOST", "uint32", "4", ""),
    ]


@pytest.mark.needs("interfaces")
def test_what_rosidl_wrote_says_what_it_was_written_from():
    """Of each installed interface there are both; rosidl writes char as uint8."""
    checked = 0
    for name in Installation().packages():
        for path in definition_files(Installation().folder(name)):
            kind = path.suffix[1:]
            ours = parse_interface(str(path), kind, path.read_text(encoding="utf-8"))
            idl = path.with_suffix(".idl")
            theirs = parse_interface(str(idl), kind, idl.read_text(encoding="utf-8"))
            assert theirs.faults == []
            assert [facts(section, name) for section in theirs.sections] == [
                facts(section, name) for section in ours.sections
            ], idl
            checked += 1
    assert checked > 100


def facts(section, package):
    def plain(kind):
        if kind.name == "char":
            return str(replace(kind, name="uint8"))
        return str(kind if kind.is_primitive else replace(kind, package=kind.package or package))

    def value(text, kind):
        return float(text) if text and kind == "float64" else text

    fields = [(e.name, plain(e.type), value(e.default, str(e.type))) for e in section.fields]
    return fields, [
        (constant.name, value(constant.value, constant.type)) for constant in section.constants
    ]


WHOLE = "module t_msgs { module msg { %s }; };"


@for_each(
    ("text", "rule", "column", "said"),
    [
        ("enum Colour { RED };", "JML652", 30, "'enum' declares nothing"),
        ("struct Track : Base { };", "JML652", 43, "'{' is missing before ':'"),
        ("struct Other { long a; };", "JML652", 37, "of no use"),
        ("struct Track { long double a; };", "JML644", 45, "'long double'"),
        ("struct Track { wchar a; };", "JML644", 45, "'wchar'"),
        ("struct Track { long a[2][3]; };", "JML644", 51, "arrays of arrays"),
        ("struct Track { long a[0]; };", "JML644", 52, "no size"),
        ("struct Track { long frontLeft; };", "JML645", 50, "'frontLeft'"),
        ("struct Track { long a; long a; };", "JML647", 58, "there already"),
        ("struct Track { @default (value=300) uint8 a; };", "JML646", 72, "not in 0..255"),
        ("struct Track { long a }", "JML652", 52, "';' is missing before '}'"),
        ("struct Track { long a; ", "JML652", 59, "a name is missing"),
        ("struct Track { long $; };", "JML652", 50, "begins nothing"),
        ('struct Track { @unit (value="\\x01") long a; };', "JML642", 58, "U+0001"),
        ("/* \x01 */", "JML642", 30, "U+0001"),
        ("", "JML652", 1, "no structure 'Track'"),
    ],
)
def test_what_ros_does_not_have_is_told_with_its_place(text, rule, column, said):
    (fault,) = read(WHOLE % text).faults
    assert (fault.rule, fault.line, fault.column) == (rule, 1, column)
    assert said in fault.message


def test_a_file_may_end_anywhere():
    whole = WHOLE % "struct Track { @unit (value=x) long a; };"
    for end in range(len(whole)):
        assert read(whole[:end]).faults


def test_services_and_actions_have_a_structure_for_each_part():
    text = "module t_msgs { module srv { struct Pull_Request { float l; };\n"
    text += "struct Pull_Response { uint8 structure_needs_at_least_one_member; }; }; };"
    request, response = read(text, "Pull", "srv").sections
    assert [field.name for field in request.fields] == ["l"]
    assert response.fields == []
    (fault,) = read(text.replace("Pull_Response", "Pull_Answer"), "Pull", "srv").faults
    assert (fault.line, fault.column) == (2, 8)


def test_a_message_beside_it_uses_the_type(tmp_path):
    folder = tmp_path / "t_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Track.idl").write_text(TRACK)
    (folder / "Tracks.msg").write_text("Track[] tracks\n")
    (folder / "Both.msg").write_text("bool x\n")
    (folder / "Both.idl").write_text("nonsense, which rosidl would have written of the other")
    for path in (tmp_path, folder, folder.parent):
        (source,) = package_sources([str(path)])
        result = import_packages([source])
        assert result.diagnostics == []
        messages = {message.name: message for message in result.packages[0].messages}
        assert messages.keys() == {"Track", "Tracks", "Both"}
        assert messages["Tracks"].fields[0].messageType is messages["Track"]
    speed, a = messages["Track"].fields[1:3]
    assert (speed.units, speed.documentation) == ("m/s", None)
    assert (a.units, a.documentation) == (None, "two [bananas]")
    (alone,) = package_sources([str(Path(folder, "Track.idl"))])
    assert import_packages([alone]).diagnostics == []
