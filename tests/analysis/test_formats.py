"""The forms of a report: text of a hundred columns, JSON by its schema, a page for itself."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from generated import model_of

from jausml.generation.target import system_of
from jausml.views import analysis
from jausml.views.analysis.formats import html, text
from jausml.views.analysis.formats import json as plain
from jausml.views.analysis.report import report_of
from jausml.views.analysis.sizes import Assumptions

ROOT = Path(__file__).resolve().parents[2]
MODELS = [
    ROOT / "models" / "minimal" / "minimal.xmi",
    ROOT / "models" / "catvehicle" / "catvehicle.xmi",
    ROOT / "models" / "examples" / "fleet" / "fleet.ros2jaus",
    ROOT / "models" / "examples" / "waypoints" / "waypoints.ros2jaus",
    ROOT / "models" / "examples" / "winch" / "winch.xmi",
    ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi",
    ROOT / "tests" / "live" / "stops.ros2jaus",
    ROOT / "tests" / "live" / "services.ros2jaus",
    ROOT / "tests" / "live" / "waypoint_lists.ros2jaus",
]
SCHEMA = json.loads(
    (Path(analysis.__file__).parent / "formats" / "report.schema.json").read_text("utf-8")
)
CLASSES = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "integer": int,
    "number": (int, float),
    "null": type(None),
}


def report(path):
    model = model_of(path)
    return report_of(system_of(model), Assumptions(rates={"made": 2.5}, lengths={"up": 3}))


def faults(value, schema, path="$"):
    """Yields where a value is not as a schema says, of the keywords that ours uses."""
    if "$ref" in schema:
        yield from faults(value, SCHEMA["$defs"][schema["$ref"].rpartition("/")[2]], path)
        return
    unknown = set(schema) - {
        *("type", "description", "properties", "required", "additionalProperties", "items"),
        *("enum", "const", "$schema", "$defs", "title"),
    }
    assert not unknown, unknown
    kinds = schema.get("type", list(CLASSES))
    classes = tuple(CLASSES[kind] for kind in ([kinds] if isinstance(kinds, str) else kinds))
    flat = tuple(
        class_ for one in classes for class_ in (one if isinstance(one, tuple) else (one,))
    )
    if not isinstance(value, flat) or (isinstance(value, bool) and bool not in flat):
        yield f"{path}: {value!r} is no {kinds}"
        return
    if "const" in schema and value != schema["const"]:
        yield f"{path}: {value!r}"
    if "enum" in schema and value not in schema["enum"]:
        yield f"{path}: {value!r}"
    if isinstance(value, list):
        for index, item in enumerate(value):
            yield from faults(item, schema["items"], f"{path}[{index}]")
    if isinstance(value, dict):
        known = schema.get("properties", {})
        yield from (f"{path}: no {name}" for name in set(schema.get("required", ())) - set(value))
        for name, member in value.items():
            inner = known.get(name, schema.get("additionalProperties", {}))
            if inner is False:
                yield f"{path}: {name} is unknown"
            else:
                yield from faults(member, inner, f"{path}.{name}")


@pytest.fixture(scope="module", params=MODELS, ids=lambda path: path.stem)
def made(request):
    return report(request.param), request.param


def test_json_is_as_its_schema_says(made):
    found = json.loads(plain.render(made[0]))
    assert list(faults(found, SCHEMA)) == []
    assert found["components"]


def test_the_schema_refuses_other_things(made):
    found = json.loads(plain.render(made[0]))
    found["components"][0]["load"]["sent"]["packets_per_s"] = "many"
    found["more"] = 1
    del found["system"]
    assert len(list(faults(found, SCHEMA))) == 3


def test_text_fits_a_hundred_columns(made):
    rendered = text.render(made[0])
    assert max(map(len, rendered.splitlines())) <= text.WIDTH
    for bridge in made[0].bridges:
        for connection in bridge.connections:
            assert connection.name in rendered


class Checker(HTMLParser):
    """Counts what is open, and notes what leads elsewhere."""

    def __init__(self):
        super().__init__()
        self.open, self.tags, self.links, self.words = [], set(), [], []

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self.links += [value for name, value in attributes if name in ("src", "href")]
        if tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


def test_the_page_stands_alone(made):
    page = html.render(made[0])
    checker = Checker()
    checker.feed(page)
    checker.close()
    assert checker.open == []
    assert checker.links == []
    assert "script" not in checker.tags
    assert "url(" not in page
    assert "prefers-color-scheme: dark" in page
    for bridge in made[0].bridges:
        for connection in bridge.connections:
            assert {connection.name, connection.message, connection.type} <= set(checker.words)


def test_the_heaviest_connection_comes_first(made):
    page = html.render(made[0])
    for bar in re.findall(r"<table>.*?</table>", page, re.DOTALL)[1:]:
        widths = [float(match) for match in re.findall(r"width: ([\d.]+)%", bar)]
        assert widths == sorted(widths, reverse=True)
        assert all(0 <= width <= 100 for width in widths)


def test_names_of_a_model_are_no_markup(system):
    found = system(
        "bridge b { address: 1.1.1  provides: VelocityStateSensor\n"
        "connection a { map: velocity_state  topic odom } }"
    )
    found.name = "<script>&"
    page = html.render(report_of(found, Assumptions()))
    assert "<script" not in page
    assert "&lt;script&gt;&amp;" in page


def test_the_same_model_gives_the_same_bytes(made):
    again = report(made[1])
    for form in (text, plain, html):
        assert form.render(again) == form.render(made[0])
