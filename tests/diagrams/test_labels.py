"""Lines of all shipped models: labels lie on nothing else, ways keep off frames and corners."""

from itertools import combinations

import pytest
from diagram_support import MODELS, read
from large_systems import large_system
from picture_figures import OFF, distance
from sweeps import sweep

from jausml.views.diagrams.bundling import is_crowded
from jausml.views.diagrams.layout.graphviz import place
from jausml.views.diagrams.layout.labels import Ground, _crosses, hidden
from jausml.views.diagrams.layout.parallel import APART, nearness
from jausml.views.diagrams.layout.settling import Area, area_of, chain
from jausml.views.diagrams.layout.sheet import samples
from jausml.views.diagrams.ordering import ordered
from jausml.views.diagrams.views import graph_of, view_names
from jausml.views.diagrams.writers import shapes, values

SHIPPED = sorted(
    path.relative_to(MODELS).as_posix()
    for ending in ("*.xmi", "*.ros2jaus")
    for path in MODELS.rglob(ending)
    if "library" not in path.parts
)

ARROWHEAD = 8
"""Pixels of the end of a line that an arrowhead takes."""

HIDING = {"machine:Winch.ReceiveFSM": 1, "system jaus_only": 1, "system simulator": 3}
"""Labels of lines that run close to others all along, and one that lies on its own line."""

OFF_LINE = OFF + shapes.LINE_HEIGHT
"""Pixels from a line to its label on the page, where a line of live text may stand between them."""


def placed(graph):
    sheet = shapes.sheet_of(ordered(graph), packed=False)
    return sheet, place(sheet)


def on_page(graph):
    sheet = values._sheet(graph)
    return sheet, place(sheet)


def _known(view, graph):
    return graph.title if view == "system" else view


def hidden_within(sheet, places):
    """Returns how much labels hide: the number of lines and borders where it is no text.

    No label is cut by the borders of the picture.
    """
    ground = Ground(sheet, places)
    areas = [ground.area(line, middle) for line, middle in ground.labels.items()]
    assert min((min(area.left, area.top) for area in areas), default=0) >= 0
    assert max((area.right for area in areas), default=0) <= places.width
    assert max((area.bottom for area in areas), default=0) <= places.height
    return hidden(sheet, places)


def assert_ways_are_clear(sheet, corners, frames, lines):
    """Complains of lines that leave the frame of both their ends, or begin or end at a corner.

    None goes through a box.
    """
    parents = {frame.id: frame.parent for frame in sheet.frames}
    areas = {box.id: area_of(box, corners[box.id]) for box in sheet.boxes}
    groups = {box.id: list(chain(box.group, parents)) for box in sheet.boxes}
    for line in sheet.lines:
        points = samples(lines[line.id].points)
        ends = groups[line.source[0]], groups[line.target[0]]
        around = [frames[group_id] for group_id in ends[0] if group_id in ends[1]]
        for x, y in points:
            assert all(f.left < x < f.right and f.top < y < f.bottom for f in around), line
            for area in areas.values():
                is_in = area.left + 1 < x < area.right - 1 and area.top + 1 < y < area.bottom - 1
                assert not is_in, line
        for (name, _), (x, y) in ((line.source, points[0]), (line.target, points[-1])):
            left, top, right, bottom = areas[name]
            far = [abs(x - a) + abs(y - b) for a in (left, right) for b in (top, bottom)]
            assert min(far) > ARROWHEAD, line


@pytest.mark.parametrize("name", sweep(SHIPPED, every=3))
def test_labels_and_ways_of_shipped_models_lie_on_nothing(name):
    model = read(MODELS / name).model
    for view in view_names(model, library=False):
        graph = graph_of(model, view)
        if not is_crowded(graph):
            sheet, places = placed(graph)
            assert hidden_within(sheet, places) == HIDING.get(_known(view, graph), 0), view
            frames = {name: Area(*one, *other) for name, (one, other) in places.frames.items()}
            assert_ways_are_clear(sheet, places.boxes, frames, places.lines)


@pytest.mark.parametrize("name", sweep(SHIPPED, every=3))
def test_ways_of_shipped_models_are_clear_on_the_page(name):
    model = read(MODELS / name).model
    for view in view_names(model, library=False):
        graph = graph_of(model, view)
        if not is_crowded(graph):
            found = values.settled(graph).places
            assert_ways_are_clear(found.sheet, found.corners, found.frames, found.routes)


@pytest.mark.parametrize("name", sweep(SHIPPED, every=3))
def test_labels_of_shipped_models_are_at_their_lines_on_the_page(name):
    """Room for live texts is wider than most labels: 30 of 58 stood in its middle, far away."""
    model = read(MODELS / name).model
    for view in view_names(model, library=False):
        for edge in values.settled(graph_of(model, view)).values()["edges"]:
            if edge["label"] is None:
                continue
            width = max(shapes.width(text, shapes.SMALL) for text in edge["labels"])
            x, y = edge["label"]
            left = x - {"start": 0, "middle": width / 2, "end": width}[edge["anchor"]]
            up = shapes.LINE_HEIGHT * len(edge["labels"]) / 2
            way = samples(tuple(map(tuple, edge["route"])))
            assert distance(Area(left, y - up, left + width, y + up), way) <= OFF_LINE, edge


@pytest.mark.parametrize("draw", [placed, on_page], ids=["picture", "page"])
def test_lines_of_the_same_two_boxes_are_apart(draw):
    """Two transitions of the winch lead from the states in Moving to Idle."""
    graph = graph_of(read(MODELS / "examples/winch/winch.xmi").model, "machine:Winch.ReceiveFSM")
    sheet, places = draw(graph)
    plain = [line for line in sheet.lines if not line.source[1] and not line.target[1]]
    pairs = [
        (one.id, other.id)
        for one, other in combinations(plain, 2)
        if one.source != one.target and {one.source, one.target} == {other.source, other.target}
    ]
    assert len(pairs) == 3
    for one, other in pairs:
        assert nearness(places.lines[one], places.lines[other]) >= APART


@pytest.fixture(scope="module")
def five_groups(tmp_path_factory):
    file = tmp_path_factory.mktemp("large") / "five.ros2jaus"
    file.write_text(large_system(5), encoding="utf-8")
    return graph_of(read(file).model, "system")


def test_groups_stand_beside_each_other_and_their_labels_lie_on_nothing(five_groups):
    sheet, places = placed(five_groups)
    assert hidden_within(sheet, places) == 0
    assert places.width > places.height


def test_a_label_that_lies_on_something_is_found(five_groups):
    sheet, places = placed(five_groups)
    ground = Ground(sheet, places)
    line = next(sheet_line for sheet_line in sheet.lines if sheet_line.width)
    box = next(iter(places.boxes.values()))
    assert ground.hidden(line.id, (box[0] + 5, box[1] + 5)) > 0


def test_a_label_that_lies_on_the_title_of_a_frame_is_found():
    graph = graph_of(read(MODELS / "catvehicle/catvehicle.xmi").model, "system")
    sheet, places = placed(graph)
    ground = Ground(sheet, places)
    (frame,) = sheet.frames
    (left, top), line = places.frames[frame.id][0], sheet.lines[0]
    on_title = left + 1 + line.width / 2, top + 1 + line.height / 2
    off_line = 1
    assert ground.hidden(line.id, on_title) == off_line + 1


@pytest.mark.parametrize(
    ("segment", "crosses"),
    [
        (((5, -5), (5, 15)), True),
        (((-5, 4), (15, 6)), True),
        (((4, 4), (6, 6)), True),
        (((-4, 6), (6, -4)), True),
        (((9, -5), (15, 5)), False),  # past a corner
        (((-5, 5), (5, 15)), False),  # at a corner
        (((10, -5), (10, 15)), False),  # along a side
        (((-5, 10), (15, 10)), False),
        (((-5, 5), (0, 5)), False),  # up to a side
        (((5, 10), (5, 15)), False),
    ],
)
def test_a_line_crosses_what_it_goes_through(segment, crosses):
    assert _crosses(segment, Area(0, 0, 10, 10)) is crosses
    assert _crosses(segment[::-1], Area(0, 0, 10, 10)) is crosses
