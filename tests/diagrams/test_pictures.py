"""Pictures: what stands in SVG, where, and that texts of a model stay texts."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from diagram_support import CAR, MODELS, read
from sweeps import sweep

from jausml.views.diagrams.bundling import bundled
from jausml.views.diagrams.graph import BRIDGE_COLUMN, Edge, End, Finding, Graph, Group, Node, Port
from jausml.views.diagrams.layout import graphviz
from jausml.views.diagrams.layout.graphviz import place
from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.writers import shapes, svg
from jausml.views.diagrams.writers.shapes import cut, width
from jausml.views.diagrams.writers.text import render_dot, render_mermaid

SVG = "{http://www.w3.org/2000/svg}"
HOSTILE = (
    "<script>alert(1)</script>",
    "a\"b'c",
    "a\nb\r\nc",
    "\u202egnitirw tfel ot thgir \u05e9\u05dc\u05d5\u05dd \u0645\u0631\u062d\u0628\u0627",
    "]]>--></style></title></svg>",
    "\\N \\E {x} |y| [z] <b> & &amp; %s",
    "\x00\x07\x1b",
    "",
    "名前" * 60,
)


def graph(name, view="system"):
    report = read(name)
    return graph_of(report.model, view, report.diagnostics)


def hostile(text):
    """Returns a graph of each part of which a text is the text."""
    wrong = (Finding("error", "R", text), Finding("warning", "R", text))
    told = ((text, text),)
    ports = tuple(
        Port(f"p{n}{text}", text, text, text, n, details=told, findings=wrong) for n in range(2)
    )
    nodes = tuple(
        Node(
            f"{kind}{text}",
            kind,
            text,
            text,
            ports,
            f"g{text}",
            column,
            details=told,
            findings=wrong,
        )
        for column, kind in enumerate(("component", "bridge", "node"))
    )
    edges = (
        Edge("e", End(nodes[0].id, ports[0].id), End(nodes[1].id), "message", text, (text,)),
        Edge(
            f"f{text}", End(nodes[1].id), End(nodes[2].id), "call", text, (text, text), details=told
        ),
    )
    groups = (Group(f"g{text}", "host", text),)
    return Graph("system", text, nodes, groups, edges, findings=wrong)


@pytest.mark.parametrize("text", sweep(HOSTILE, every=2, rest=1), ids=range(len(HOSTILE)))
def test_texts_are_data(text):
    found = hostile(text)
    picture = svg.render(found)
    root = ElementTree.fromstring(picture.encode())  # noqa: S314 - our own
    names = {element.tag.removeprefix(SVG) for element in root.iter()}
    assert names <= {"svg", "title", "style", "defs", "marker", "path", "rect", "text", "g"}
    shown = cut(text, 48)
    assert any(shown == (element.text or "") for element in root.iter(f"{SVG}text")) or not shown
    assert "<script" not in picture
    chart = render_mermaid(found)
    assert "<script" not in chart
    assert len(chart.splitlines()) == len(render_mermaid(hostile("x")).splitlines())
    # Graphviz reads what is written for it, with as many things.
    (read_back,) = graphviz._run(render_dot(found))
    boxes = [node for node in read_back["objects"] if "nodes" not in node]
    assert (len(boxes), len(read_back["edges"])) == (3 + len(found.findings), 2)


@pytest.mark.parametrize(
    "view", ["system", "map:velocity_state", "service:PrimitiveDriver", "map:cruise_speed"]
)
def test_boxes_do_not_overlap_and_texts_stay_inside(view):
    found = graph(CAR, view)
    assert_legible(found)


def test_a_machine_is_legible():
    assert_legible(graph(MODELS / "examples" / "winch" / "service.xmi", "machine:ReceiveFSM"))


def assert_legible(found):
    sheet = shapes.sheet_of(found, packed=False)
    places = place(sheet)
    corners = [
        (*places.boxes[sheet_box.id], sheet_box.width, sheet_box.height)
        for sheet_box in sheet.boxes
    ]
    for index, (x, y, wide, high) in enumerate(corners):
        assert x >= -1
        assert y >= -1
        assert x + wide <= places.width + 1
        assert y + high <= places.height + 1
        for a, b, c, d in corners[index + 1 :]:
            assert x + wide <= a or a + c <= x or y + high <= b or b + d <= y
    for node in found.nodes:
        box = shapes.box_of(node)
        assert width(shapes.title_of(node), shapes.TITLE, bold=True) <= box.width
    ends = {sheet_box.id: sheet_box for sheet_box in sheet.boxes}
    for line in sheet.lines:
        points = places.lines[line.id].points
        for point, (name, _) in ((points[0], line.source), (points[-1], line.target)):
            left, top = places.boxes[name]
            assert left - 2 <= point[0] <= left + ends[name].width + 2
            assert top - 2 <= point[1] <= top + ends[name].height + 2


def test_the_same_bytes_each_time():
    assert svg.render(graph(CAR)) == svg.render(graph(CAR))


def test_themes():
    found = graph(MODELS / "minimal" / "minimal.xmi")
    auto, light, dark = (svg.render(found, theme) for theme in ("auto", "light", "dark"))
    assert "prefers-color-scheme:dark" in auto
    assert "prefers-color-scheme" not in light + dark
    assert "#1E1E1E" in dark
    assert "#1E1E1E" not in light


def large(bridges=6, components=60, connections=300):
    nodes = [Node(f"b{n}", "bridge", f"bridge{n}", column=BRIDGE_COLUMN) for n in range(bridges)]
    nodes += [
        Node(f"c{n}", "component", f"component{n}", ports=(Port("p", "p"),), column=0)
        for n in range(components)
    ]
    edges = [
        Edge(
            f"e{n}", End(f"c{n % components}", "p"), End(f"b{n * 7 % bridges}"), "message", f"m{n}"
        )
        for n in range(connections)
    ]
    return Graph("system", "large", tuple(nodes), (), tuple(edges))


def test_a_large_system_has_a_frame_for_each_bridge():
    found = large()
    shown = bundled(found)
    assert len(shown.groups) == 6
    assert len(shown.edges) < 80
    told = sum(edge.count for edge in shown.edges)
    across = [p for n in shown.nodes if n.kind != "bridge" for p in n.ports if "also" in p.label]
    assert told + sum(int(port.note.split()[0]) for port in across) == len(found.edges)
    picture = svg.render(found)
    assert picture.count('class="box') == 66


def test_a_loop_of_a_large_system_is_counted_once():
    found = large()
    loop = Edge("loop", End("c1", "p"), End("c1", "p"), "message", "again")
    shown = bundled(replace(found, edges=(*found.edges, loop)))
    (row,) = (
        port for port in shown.by_id["c1"].ports if port.label.endswith(found.by_id["c1"].title)
    )
    assert row.note == "1 connection"


def test_bundles_have_no_labels_and_their_boxes_say_what_is_wrong():
    found = large()
    wrong = (Finding("warning", "R", "is wrong"),)
    marked = replace(
        found,
        nodes=tuple(
            replace(n, ports=tuple(replace(p, findings=wrong) for p in n.ports))
            for n in found.nodes
        ),
        edges=tuple(replace(e, findings=wrong) for e in found.edges),
    )
    picture = svg.render(marked)
    assert 'class="label"' not in picture
    assert picture.count(">! warning: is wrong</text>") == 60


@pytest.mark.parametrize("render", [render_mermaid, render_dot])
def test_text_tells_what_is_wrong_with_lines_and_files_too(render):
    wrong, unread = Finding("warning", "R", "is odd"), Finding("error", "R", "is no text")
    found = large(connections=3)
    first, *others = found.edges
    shown = render(
        replace(found, edges=(replace(first, findings=(wrong,)), *others), findings=(unread,))
    )
    assert f"warning<br/>{first.title}" in shown
    assert "error: is no text" in shown


def test_a_small_system_stays_as_it_is():
    found = large(connections=80)
    assert bundled(found) is found


def test_findings_are_a_word_and_not_a_colour_alone():
    found = graph(MODELS / "minimal" / "minimal.xmi")
    wrong = (Finding("error", "JML1", "is wrong"),)
    marked = replace(found, nodes=(replace(found.nodes[0], findings=wrong), *found.nodes[1:]))
    picture = svg.render(marked)
    assert re.search(r">× error: is wrong</text>", picture)
    assert 'class="doubled"' in picture


@pytest.mark.parametrize(
    ("name", "path", "view"),
    [
        ("system", CAR, "system"),
        ("map", CAR, "map:velocity_state"),
        ("service", CAR, "service:PrimitiveDriver"),
        ("machine", MODELS / "examples" / "winch" / "service.xmi", "machine:ReceiveFSM"),
    ],
)
def test_the_pictures_of_the_docs_show_what_is_there(name, path, view):
    # Another version of Graphviz may place things elsewhere.
    shown = (MODELS.parent / "docs" / f"diagram-{name}.svg").read_text(encoding="utf-8")
    drawn = svg.render(graph(path, view), "light")
    texts = re.compile(r">([^<]*)</text>")
    assert texts.findall(shown) == texts.findall(drawn)


MAPPINGS = MODELS / "library" / "mappings"


@pytest.mark.parametrize(
    ("file", "view"),
    [
        ("velocity_state_driver", "map:velocity_command"),
        ("odometry", "map:odometry"),
        ("power_plant", "map:battery"),
        ("global_pose_sensor", "map:global_pose"),
    ],
)
def test_the_rows_of_maps_face_each_other(monkeypatch, file, view):
    """Lines go straight across, both directions beside each other, and labels cover no other."""
    monkeypatch.setattr(graphviz, "program", lambda: None)
    found = graph(MAPPINGS / f"{file}.ros2jaus", view)
    assert_legible(found)
    sheet = shapes.sheet_of(found, packed=False)
    places = place(sheet)
    left = [box for box in sheet.boxes if box.column == min(b.column for b in sheet.boxes)]
    begin = max(places.boxes[box.id][0] + box.width for box in left)
    end = min(places.boxes[box.id][0] for box in sheet.boxes if box not in left)
    for line in sheet.lines:
        points = places.lines[line.id].points
        assert {points[0][0], points[-1][0]} == {begin, end}
        assert all(begin <= x <= end for x, _ in points)
    labels = [
        (*places.lines[line.id].label, line.width, line.height - 4)
        for line in sheet.lines
        if line.width
    ]
    assert labels
    for index, (x, y, wide, high) in enumerate(labels):
        assert begin <= x - wide / 2 <= x + wide / 2 <= end
        for a, b, c, d in labels[index + 1 :]:
            assert abs(x - a) * 2 >= wide + c - 0.5 or abs(y - b) * 2 >= high + d - 0.5


def test_lines_of_both_directions_stand_beside_each_other():
    found = graph(MAPPINGS / "velocity_state_driver.ros2jaus", "map:velocity_command")
    sheet = shapes.sheet_of(found, packed=False)
    places = place(sheet)
    ways = {}
    for line in sheet.lines:
        points = places.lines[line.id].points
        ways.setdefault(frozenset((line.source, line.target)), []).append(points)
    both = [bundle for bundle in ways.values() if len(bundle) == 2]
    assert len(both) == 6
    for one, other in both:
        assert one[0][1] == other[-1][1] - 7
        assert one[-1][1] == other[0][1] - 7
