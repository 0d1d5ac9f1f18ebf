"""Diagrams of what changed: what came, went and changed in colours and signs."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from click.testing import CliRunner

from jausml.cli import main
from jausml.language.model import LIBRARY_URI
from jausml.views.diagrams.writers.shapes import style

ROOT = Path(__file__).resolve().parents[2]
BASE = (ROOT / "models" / "minimal" / "minimal.xmi").read_text(encoding="utf-8")
BASE = BASE.replace("../library/", LIBRARY_URI)
NODE = '  <nodes name="{}">\n    <subscriptions name="speed" topic="velocity">\n'
NODE += '      <type href="http://www.jausml.org/library/ros/geometry_msgs.xmi#TwistStamped"/>\n'
NODE += "    </subscriptions>\n  </nodes>\n"
END = "</system:System>"
OLD = BASE.replace(END, NODE.format("logger") + END)
NEW = BASE.replace(END, NODE.format("display") + '  <nodes name="idle"/>\n' + END)
NEW = NEW.replace('<topics name="velocity"/>', '<topics name="speed"/>')
NEW = NEW.replace('address="10.1.1"', 'address="10.1.9"')
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def drawn(tmp_path):
    """Draws what changed from one text of a model to another."""

    def run(old, new, *options, status=0):
        for name, text in (("old", old), ("new", new)):
            (tmp_path / name).mkdir(exist_ok=True)
            (tmp_path / name / "model.xmi").write_text(text, encoding="utf-8")
        states = (str(tmp_path / state / "model.xmi") for state in ("old", "new"))
        done = CliRunner().invoke(main, ["diff", "--format", "svg", *options, *states])
        assert done.exit_code == status, done.output
        return done.stdout if status == 0 else done.stderr

    return run


def parts(picture):
    """Returns the titles of the boxes of a picture by their state."""
    found = {}
    for group in ET.fromstring(picture).iter(f"{SVG}g"):  # noqa: S314 - we wrote it
        kinds = group.get("class", "").split()
        if kinds[:1] == ["box"]:
            state = next((kind for kind in kinds if kind in ("added", "removed", "changed")), "")
            found.setdefault(state, set()).add(group.findtext(f"{SVG}text"))
    return found


def test_boxes_that_came_went_and_changed(drawn):
    other = OLD.replace(
        "</nodes>",
        "</nodes>\n" + '  <nodes name="idle"><publishers name="a" topic="b">'
        '<type href="http://www.jausml.org/library/ros/std_msgs.xmi#String"/></publishers></nodes>',
    )
    other = other.replace('address="10.1.1"', 'address="10.1.9"')
    found = parts(drawn(OLD, other))
    assert found["added"] == {"+ idle"}
    assert found["changed"] == {"~ sensor"}
    assert found[""] == {"sensor_bridge", "logger"}
    back = parts(drawn(other, OLD))
    assert back["removed"] == {"\N{MINUS SIGN} idle"}
    assert back["changed"] == {"~ sensor"}


def test_lines_that_came_and_went(drawn):
    picture = drawn(OLD, NEW)
    edges = re.findall(r'<path class="edge (\w+) \w* ?([a-z]*)"', picture)
    assert ("topic", "removed") in edges, "nobody publishes what the node listens to any more"
    assert ("topic", "added") in edges, "what is published now goes to others"
    assert "+ blue: added" in picture


def test_nothing_changed_has_no_colours(drawn):
    picture = drawn(OLD, OLD)
    assert parts(picture).keys() == {""}
    assert "added" not in picture


def test_a_view_in_which_nothing_changed_is_told(tmp_path):
    old, new = tmp_path / "old.xmi", tmp_path / "new.xmi"
    old.write_text(OLD, encoding="utf-8")
    new.write_text(OLD.replace('address="10.1.1"', 'address="10.1.9"'), encoding="utf-8")
    words = ["diff", "--format", "svg", str(old), str(new)]
    done = CliRunner().invoke(main, [*words, "--view", "map:velocity"])
    assert done.stderr == (
        "note: nothing changed in map:velocity; 1 change, 1 breaks peers elsewhere\n"
    )
    assert CliRunner().invoke(main, words).stderr == ""


def test_a_map_shows_assignments(drawn):
    line = (
        '<toRos xsi:type="bridge:ConstantAssignment" target="header.frame_id" value="base_link"/>'
    )
    assert line in OLD
    new = OLD.replace(line, "").replace("Velocity_X", "Velocity_Y")
    picture = drawn(OLD, new, "--view", "map:velocity")
    classes = re.findall(r'class="edge \w+ ([^"]*)"', picture)
    assert any("removed" in edge_class for edge_class in classes)
    assert any("added" in edge_class or "changed" in edge_class for edge_class in classes)


def test_a_view_that_came_is_added_as_a_whole(drawn):
    new = OLD.replace('name="velocity" documentation="JAUS', 'name="pace" documentation="JAUS')
    assert parts(drawn(OLD, new, "--view", "map:pace")).keys() == {"added"}
    assert parts(drawn(OLD, new, "--view", "map:velocity")).keys() == {"removed"}
    assert "no view 'map:none'" in drawn(OLD, new, "--view", "map:none", status=2)


def test_a_page_tells_what_changed(drawn, tmp_path):
    page = tmp_path / "changes.html"
    drawn(OLD, NEW, "--format", "html", "-o", str(page))
    text = page.read_text(encoding="utf-8")
    assert "address 10.1.1 -\\u003e 10.1.9" in text or "address 10.1.1 -> 10.1.9" in text
    assert "~ sensor" in text


def luminance(colour):
    channels = (int(colour[n : n + 2], 16) / 255 for n in (1, 3, 5))
    linear = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)
    return sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


@pytest.mark.parametrize(("theme", "ink"), [("light", "#1B1B1B"), ("dark", "#EEEEEE")])
def test_texts_can_be_read_on_the_colours(theme, ink):
    """Contrast of 4.5 to 1 at least (WCAG 2.2, 1.4.3)."""
    fills = re.findall(
        r"\.box\.(added|removed|changed) \.body[^{]*\{fill:(#\w{6})\}", style(theme, compares=True)
    )
    assert {state for state, _ in fills} == {"added", "removed", "changed"}
    for _, fill in fills:
        dark, light = sorted((luminance(ink), luminance(fill)))
        assert (light + 0.05) / (dark + 0.05) >= 4.5
