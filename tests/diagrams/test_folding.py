"""Large pictures: what closed frames tell, and that nothing moves when they are opened."""

import json
from itertools import pairwise

import pytest
from generated import model_in
from large_systems import large_system

from jausml.authoring.studio.drawing import Drawings, difference
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.views.diagrams.bundling import framed
from jausml.views.diagrams.folding import CLOSED, MOST_SHOWN, folded, frames_of, is_large
from jausml.views.diagrams.graph import Edge, End, Finding, Graph, Group, Node, Port
from jausml.views.diagrams.views import graph_of

GROUPS, HOSTS = 40, 3


def node(name, group, *, kind="component", findings=(), rows=()):
    ports = tuple(Port(row, row) for row in rows)
    return Node(name, kind, name, ports=ports, group=group, key=name, findings=findings)


def edge(name, source, target, kind="message", findings=()):
    return Edge(name, End(source), End(target), kind, key=name, findings=findings)


WRONG = Finding("error", "JML1", "wrong")
ODD = Finding("warning", "JML2", "odd")

SMALL = Graph(
    "system",
    "s",
    (
        node("a", "one", findings=(ODD,)),
        node("b", "one", kind="bridge", rows=("r",)),
        node("c", "two"),
        node("d", ""),
    ),
    (
        Group("host", "host", "host", key="host"),
        Group("one", "bridge", "one", "host", key="one"),
        Group("two", "bridge", "two", key="two"),
    ),
    (
        edge("ab", "a", "b"),
        edge("bc", "b", "c", findings=(WRONG,)),
        edge("ac", "a", "c"),
        edge("cd", "c", "d"),
    ),
)


def test_a_closed_frame_tells_how_much_is_in_it_and_the_worst_of_it():
    shown = folded(SMALL, ())
    pairs = [(box.id, box.kind) for box in shown.nodes]
    assert pairs == [("d", "component"), ("host", CLOSED), ("two", CLOSED)]
    host = shown.by_id["host"]
    assert host.subtitle == "1 component, 1 bridge, 3 lines"
    assert dict(host.details) == {"frames": "1"}
    assert host.findings == (Finding("error", "", "1 error, 1 warning in it"),)
    assert shown.groups == ()


def test_lines_between_closed_frames_are_one_and_a_single_one_stays_what_it_is():
    edges = {line.id: line for line in folded(SMALL, ()).edges}
    assert set(edges) == {"bc!bundle", "cd"}
    assert (edges["bc!bundle"].source, edges["bc!bundle"].target) == (End("host"), End("two"))
    assert edges["bc!bundle"].count == 2
    assert edges["bc!bundle"].findings == (Finding("error", "", "1 error in it"),)
    assert (edges["cd"].source, edges["cd"].target) == (End("two"), End("d"))


def test_what_is_opened_is_shown_and_a_frame_in_a_closed_one_is_not_seen():
    assert folded(SMALL, ("one",)) == folded(SMALL, ())
    shown = folded(SMALL, ("host",))
    assert [group.id for group in shown.groups] == ["host"]
    assert {box.id for box in shown.nodes} == {"one", "two", "d"}
    assert folded(SMALL, ("host", "one", "two")) == SMALL


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return model_in(tmp_path_factory.mktemp("large"), large_system(GROUPS, HOSTS), "large.ros2jaus")


@pytest.fixture(scope="module")
def graph(model):
    return graph_of(model, "system")


def test_a_system_is_large_by_its_boxes(graph):
    assert len(graph.nodes) == GROUPS * 6 > MOST_SHOWN
    assert is_large(framed(graph))
    assert not is_large(SMALL)


def test_each_box_stands_in_the_frame_of_its_bridge_on_its_host(graph):
    around = frames_of(framed(graph))
    assert all(len(frame_pair) == 2 for frame_pair in around.values())


def test_opening_moves_nothing_and_tells_only_what_is_new(graph, tmp_path):
    drawings = Drawings(tmp_path)
    first = drawings.draw("m", graph, {}, (), of=1)
    hosts = [box["key"] for box in first["nodes"]]
    assert {box["kind"] for box in first["nodes"]} == {CLOSED}
    assert len(hosts) == HOSTS
    second = drawings.again("m", "system", hosts, of=1)
    bridges = [box["key"] for box in second["nodes"]]
    assert len(bridges) == GROUPS
    whole = drawings.again("m", "system", (*hosts, *bridges), of=1)
    assert len(whole["nodes"]) == len(graph.nodes)
    assert len(whole["edges"]) == len(graph.edges)
    places = {box["id"]: (box["x"], box["y"]) for box in (*first["nodes"], *second["nodes"])}
    assert {frame["id"]: (frame["x"], frame["y"]) for frame in whole["groups"]} == places
    one = drawings.again("m", "system", (*hosts, bridges[0]), of=1)
    assert len(json.dumps(difference(second, one))) < len(json.dumps(whole)) / 20
    assert drawings.again("m", "system", hosts, of=2) is None


def test_what_is_wrong_is_seen_at_the_closed_frames_around_it(model, tmp_path):
    (document, *_) = model.documents
    (component, *_) = document.roots[0].components
    place, fragment = Location(document.display), model.fragment(component)
    found = Diagnostic("JML1", Severity.ERROR, place, "wrong", fragment=fragment)
    drawn = Drawings(tmp_path).draw("m", graph_of(model, "system", [found]), {})
    wrong = [box for box in drawn["nodes"] if box["findings"]]
    assert [box["title"] for box in wrong] == ["host h0 (judp)"]
    assert wrong[0]["findings"][0]["severity"] == "error"


def test_a_picture_and_its_difference_are_the_next_picture(graph, tmp_path):
    drawings = Drawings(tmp_path)
    pictures = [drawings.draw("m", graph, {}, opened) for opened in ((), ("host:h0",), ())]
    for before, after in pairwise(pictures):
        assert applied(before, difference(before, after)) == after


def applied(before, changes):
    """What the page makes of a picture and what has changed."""
    made = dict(changes["rest"])
    for name in ("nodes", "groups", "edges"):
        parts = {part["id"]: part for part in before[name]}
        for part_id in changes[name]["gone"]:
            del parts[part_id]
        parts.update({part["id"]: part for part in changes[name]["put"]})
        made[name] = [parts[part_id] for part_id in changes[name]["order"] or parts]
    return made
