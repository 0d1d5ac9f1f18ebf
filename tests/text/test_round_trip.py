"""Models in XMI become ros2jaus text and models again: nothing is lost, nothing is added."""

import os
from pathlib import Path
from tempfile import TemporaryDirectory

import emf_check
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from model_strategies import TEXT, models
from sweeps import sweep

from jausml.language.metamodel import load_metamodels
from jausml.language.model import LIBRARY_URI, library_root, read_models
from jausml.language.model.comparison import compare
from jausml.language.model.xmi.writer import name_identifiers, to_xmi, write_model
from jausml.language.text.notation import NOTATIONS
from jausml.language.text.reading.parsing import parse
from jausml.language.text.writing.layout import lay_out
from jausml.language.text.writing.unparsing import to_text

GUARDS = ("metamodels",)

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = load_metamodels()
SHIPPED_FILES = sorted(
    path
    for path in (ROOT / "models").rglob("*.*")
    if path.suffix in (".xmi", ".ros2jaus") and "src" not in path.parts
)
LARGE = 50_000
"""Bytes from which on a shipped file goes to text, but not back to XMI: that takes seconds."""
QUICK = settings(deadline=None, suppress_health_check=list(HealthCheck))
# Random elements lack what they must have, which is no fault of a notation.
LACKING = {"JML108", "JML109", "JML110", "JML111"}

WORDS = ["a", "b", "a.b", "b.a", "a/b", "x[1]", "1st", "two words", "é", "-", "true", "clock", "."]
KEYWORDS = ["JAUS", "ROS", "new", "table", "import", "struct", "ignore", "bridge", "record", "map"]
KNOWN = ["Management", "core", "Twist", "geometry_msgs", "Pose", "shared", "other"]
HOSTILE = ["", " ", "back`tick", 'quo"te', "back\\slash", "tab\t", " edge ", "li\nne", "*/", "/*"]
NAMES = st.sampled_from([*WORDS, *KEYWORDS, *KNOWN, *HOSTILE]) | TEXT
PATHS = st.sampled_from(
    ["x", "a.b[2].c", "/angle", ".", "Roll, Pitch", "Roll,Pitch", "x, ", "index", "true", "clock",
     "5", "-1.5", "two words.x", "a..b", "a.", "/", "//", "[1]", "x[1", "`x`", ""]
) | NAMES  # fmt: skip
CONSTANTS = st.sampled_from(
    ["0", "0.0", "-0", "+5", "1e5", "1E+5", "0x1F", "1.", ".5", "100.1.1", "Infinity", "-Infinity",
     "NaN", "true", "false", "True", "5 ", "1_000", "absent", "clock", "odom", "D E"]
) | NAMES  # fmt: skip
PROSE = st.sampled_from(
    ["One line.", "Two\nlines.", "Gap\n\nof lines.", " indented", "  first\n    second\n third",
     "* star", "one\n* two", "ends */ early", "/* begins", "trailing ", "\n", "", "// slashes", "*",
     "tab\tin", "carriage\rreturn", "quo\"te and back\\slash", "é \u2028 \u0085 \U0001f600"]
) | TEXT  # fmt: skip


def hostile(feature):
    """Returns a strategy for the texts of a feature: what it means, and what could break text."""
    if feature.name == "name":
        return NAMES
    if feature.name in ("source", "target", "path", "keys"):
        return PATHS
    if feature.name == "documentation":
        return PROSE
    return CONSTANTS


OTHER = """<?xml version="1.0" encoding="UTF-8"?>
<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:bridge="http://www.jausml.org/bridge/1.0" xmlns:jaus="http://www.jausml.org/jaus/1.0"
    xmlns:ros="http://www.jausml.org/ros/1.0" xmlns:system="http://www.jausml.org/system/1.0">
  <jaus:ServiceSet name="other">
    <types xsi:type="jaus:Record" name="shared">
      <fields xsi:type="jaus:FixedField" name="a"/>
    </types>
    <services name="Management" urn="urn:x:Management">
      <inherits href="http://www.jausml.org/library/jaus/core-1.1.xmi#Management"/>
      <inputs name="a" code="0xD001"/>
      <inputs name="shared" code="0xD002"/>
      <inputs code="0xD003"/>
    </services>
  </jaus:ServiceSet>
  <ros:InterfacePackage name="geometry_msgs">
    <messages name="Twist">
      <fields xsi:type="ros:MessageField" name="x">
        <messageType href="http://www.jausml.org/library/ros/geometry_msgs.xmi#Twist"/>
      </fields>
    </messages>
    <messages name="shared"/>
    <messages name="shared"/>
  </ros:InterfacePackage>
  <bridge:MapLibrary name="maps">
    <maps name="a"/>
    <maps name="shared"/>
  </bridge:MapLibrary>
  <system:System name="robot">
    <components name="a" address="1.1.1"/>
    <nodes name="b"/>
    <hosts name="shared"/>
  </system:System>
</xmi:XMI>
"""


@pytest.fixture(scope="module")
def surroundings(tmp_path_factory):
    """A model of another document and of what it uses of the library."""
    path = tmp_path_factory.mktemp("other files") / "other model.xmi"
    path.write_text(OTHER, encoding="utf-8")
    return read_models([path], allow_outside=True).model


def reread(path):
    """Returns the roots of a file and its model, which lacks nothing but what it must have."""
    result = read_models([path], allow_outside=True, notations=NOTATIONS)
    wrong = [diagnostic for diagnostic in result.diagnostics if diagnostic.rule not in LACKING]
    assert [diagnostic for diagnostic in wrong if diagnostic.location.path == str(path)] == []
    return result.model.documents[0].roots, result.model


def check_round_trip(roots, model, folder):
    """Checks that a model is the same in XMI and in text, and text the same in its layout."""
    first, second = Path(folder) / "model.xmi", Path(folder) / "model.ros2jaus"
    first.write_text(to_xmi(roots, model, first), encoding="utf-8", newline="\n")
    text = to_text(*reread(first), second)
    second.write_text(text, encoding="utf-8", newline="\n")
    parsed = parse(text)
    assert parsed.faults == []
    assert lay_out(parsed.document) == text
    again, its_model = reread(second)
    assert_same(roots, again)
    assert to_xmi(again, its_model, first) == first.read_text(encoding="utf-8")
    assert to_text(again, its_model, second) == text


ROOTS = {
    "all": (None, 40),
    "system": ({"system.System"}, 12),
    "maps": ({"bridge.MapLibrary", "bridge.AttributeMap", "bridge.Bridge"}, 25),
    "services": ({"jaus.ServiceSet", "jaus.Service", "jaus.StateMachine"}, 15),
    "interfaces": ({"ros.InterfacePackage", "ros.Node"}, 30),
}
"""Classes of root elements, and how many examples to try: large ones take longer."""


@pytest.mark.parametrize(("roots", "examples"), ROOTS.values(), ids=ROOTS)
def test_random_models_are_the_same_in_text(roots, examples, surroundings):
    others = [element for element in surroundings.elements() if getattr(element, "name", None)]
    drawing = models(SHIPPED, texts=hostile, roots=roots, others=others, model=surroundings)

    @settings(QUICK, max_examples=examples // 4)
    @given(drawn=drawing)
    def check(drawn):
        with TemporaryDirectory() as folder:
            check_round_trip(*drawn, folder)

    check()


@pytest.mark.parametrize("path", sweep(SHIPPED_FILES, every=8), ids=lambda path: path.name)
def test_shipped_models_are_the_same_in_text(path, tmp_path):
    roots, model = reread(path)
    text, back = tmp_path / f"{path.stem}.ros2jaus", tmp_path / f"{path.stem}.xmi"
    text.write_text(to_text(roots, model, text), encoding="utf-8")
    again, its_model = reread(text)
    assert_same(roots, again)
    if path.stat().st_size < LARGE:
        assert to_text(again, its_model, text) == text.read_text(encoding="utf-8")
        write_model(again, its_model, back)
        assert_same(roots, reread(back)[0])


def test_the_car_in_text_is_the_car():
    text = ROOT / "models" / "examples" / "catvehicle" / "catvehicle.ros2jaus"
    (ours,), _ = reread(ROOT / "models" / "catvehicle" / "catvehicle.xmi")
    (theirs,), _ = reread(text)
    assert_same([ours], [theirs])
    written = text.read_text(encoding="utf-8")
    assert lay_out(parse(written).document) == written


@pytest.mark.slow
@pytest.mark.needs("emf")
def test_eclipse_judges_what_was_text_as_before(tmp_path):
    path = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
    roots, model = reread(path)
    text, back = tmp_path / "catvehicle.ros2jaus", tmp_path / "catvehicle.xmi"
    text.write_text(to_text(roots, model, text), encoding="utf-8")
    again, its_model = reread(text)
    name_identifiers(again, its_model)
    write_model(again, its_model, back)
    assert verdict(back) == (0, "")


def verdict(path):
    """Returns the exit status of Eclipse's EMF for a model, and what it says."""
    metamodels = sorted(map(str, (ROOT / "metamodels").glob("*.ecore")))
    library = f"{os.path.realpath(library_root())}{os.sep}"
    done = emf_check.ask("--map", LIBRARY_URI, library, *metamodels, path)
    return done.returncode, done.stdout + done.stderr


def assert_same(ours, theirs):
    """Checks that roots and all that they own are the same."""
    assert len(ours) == len(theirs)
    for one, other in zip(ours, theirs, strict=True):
        assert compare(one, other, SHIPPED) == []
