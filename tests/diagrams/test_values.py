"""Values: sizes and places for a page, which stay while the model changes."""

import json
import os
from copy import deepcopy
from dataclasses import replace

import pytest
from diagram_support import CAR, MODELS, read
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_pictures import large

from jausml.views.diagrams.bundling import framed, is_crowded
from jausml.views.diagrams.graph import Edge, End, Finding, Graph, Group, Node, Port
from jausml.views.diagrams.layout.settling import FRAME_MARGIN
from jausml.views.diagrams.layout.sheet import Places, Route
from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.writers import values

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "25"))
KINDS = ("component", "bridge", "node")


def graph(path=CAR, view="system"):
    report = read(path)
    return graph_of(report.model, view, report.diagnostics, MODELS)


def rows(sheet):
    """Puts boxes side by side: a layout in no time."""
    left, boxes = 0, {}
    for box in sheet.boxes:
        boxes[box.id] = left, 40
        left += box.width + 150
    lines = {
        sheet_line.id: Route(((0, 0), (1, 1), (2, 2), (3, 3)), (1, 1)) for sheet_line in sheet.lines
    }
    return Places(left, 200, boxes, {}, lines)


def render(*arguments, **more):
    return values.settled(*arguments, **more).values()


def areas(found):
    return {
        node["key"]: (node["x"], node["y"], node["x"] + node["width"], node["y"] + node["height"])
        for node in found["nodes"]
    }


def corners(found):
    return {node["key"]: (node["x"], node["y"]) for node in found["nodes"]}


def assert_apart(found, moved=()):
    known = list(areas(found).items())
    for index, (one, a) in enumerate(known):
        for other, b in known[index + 1 :]:
            apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
            assert apart or {one, other} <= set(moved), (one, a, other, b)


def assert_framed(found):
    groups = {group["id"]: group for group in found["groups"]}
    for node in found["nodes"]:
        around = groups.get(node["group"])
        while around:
            assert around["x"] <= node["x"]
            assert around["y"] <= node["y"]
            assert node["x"] + node["width"] <= around["x"] + around["width"]
            assert node["y"] + node["height"] <= around["y"] + around["height"]
            around = groups.get(around["parent"])


@pytest.mark.parametrize(
    ("path", "view"),
    [
        (CAR, "system"),
        (CAR, "map:velocity_state"),
        (CAR, "service:PrimitiveDriver"),
        (MODELS / "examples" / "winch" / "service.xmi", "machine:ReceiveFSM"),
    ],
)
def test_boxes_are_apart_in_their_frames_and_the_same_each_time(path, view):
    shown = graph(path, view)
    found = render(shown)
    assert_apart(found)
    assert_framed(found)
    assert json.loads(json.dumps(found)) == found
    assert render(shown) == found
    for edge in found["edges"]:
        assert len(edge["route"]) % 3 == 1


def hosted(graph):
    """A graph on two hosts, with every fifth box on the second."""
    return replace(
        graph,
        nodes=tuple(
            replace(node, group="h2" if at % 5 == 0 else "h1")
            for at, node in enumerate(graph.nodes)
        ),
        groups=(Group("h1", "host", "host 1", key="h1"), Group("h2", "host", "host 2", key="h2")),
    )


@pytest.mark.parametrize("shown", [large(), hosted(large()), hosted(large(20, 200, 2000))])
def test_a_large_system_has_frames_and_each_of_its_rows_and_lines(shown):
    assert is_crowded(shown)
    found = render(framed(shown))
    assert_apart(found)
    assert_framed(found)
    assert found["crowded"]
    assert [edge["id"] for edge in found["edges"]] == [edge.id for edge in shown.edges]
    rows = {(node["id"], port["id"]) for node in found["nodes"] for port in node["ports"]}
    assert rows == {(node.id, port.id) for node in shown.nodes for port in node.ports}
    bridges = [group for group in found["groups"] if group["kind"] == "bridge"]
    assert len(bridges) == sum(node.kind == "bridge" for node in shown.nodes)
    for at, one in enumerate(bridges):
        for other in bridges[at + 1 :]:
            apart = one["x"] + one["width"] <= other["x"] or other["x"] + other["width"] <= one["x"]
            above = one["y"] + one["height"] <= other["y"]
            assert apart or above or other["y"] + other["height"] <= one["y"]
    assert max(found["width"], found["height"]) < 4 * min(found["width"], found["height"])
    assert render(framed(shown)) == found


def test_what_runs_elsewhere_stands_in_the_frame_of_its_host():
    shown = framed(hosted(large()))
    nodes = shown.by_id
    bridge_of = {node.id: node.group.removesuffix("!frame") for node in shown.nodes}
    assert "" not in bridge_of.values()
    for node in shown.nodes:
        if node.group.endswith("!frame") and node.kind != "bridge":
            original = hosted(large()).by_id
            assert original[node.id].group == original[bridge_of[node.id]].group
    assert {nodes["b0"].group, nodes["b1"].group} == {"b0!frame", "b1!frame"}


def test_boxes_in_columns_stand_near_the_rows_that_they_are_joined_with():
    bridge = replace(box("b", "bridge", 9), group="f")
    others = tuple(replace(box(f"c{n}"), group="f") for n in range(3))
    edges = tuple(
        Edge(f"e{n}", End(f"c{n}", "p0"), End("b", f"p{8 - 4 * n}"), "message") for n in range(3)
    )
    shown = Graph("system", "s", (bridge, *others), (Group("f", "bridge", "b"),), edges)
    found = render(shown)
    where = areas(found)
    assert where["component:c2"][1] < where["component:c1"][1] < where["component:c0"][1]
    assert where["component:c0"][2] < where["bridge:b"][0]


def test_frames_are_as_wide_as_the_lines_in_them():
    nodes = tuple(box(name, "node", 2, "g") for name in "abc")
    edges = (Edge("e", End("a", "p0"), End("c", "p1"), "topic"),)
    shown = Graph("system", "s", nodes, (Group("g", "host", "g"),), edges)
    at = {f"node:{name}": (0, 150 * n) for n, name in enumerate("abc")}
    [plain] = render(replace(shown, edges=()), at, place=rows)["groups"]
    [wide] = render(shown, at, place=rows)["groups"]
    assert wide["width"] >= plain["width"] + 24
    # Where something else stands they are not.
    stranger = replace(box("x", "node"), group="")
    others = replace(shown, nodes=(*nodes, stranger))
    beside = (plain["x"] + plain["width"] + 5, 150)
    [narrow] = render(others, {**at, "node:x": beside}, place=rows)["groups"]
    assert narrow["width"] == plain["width"]
    # A way of the engine counts too.
    [routed] = render(replace(shown, edges=(line("a", "b"),)), place=rows)["groups"]
    assert routed["x"] <= 0 - FRAME_MARGIN


def test_nothing_to_show():
    found = render(Graph("system", "nothing"))
    assert (found["nodes"], found["width"], found["height"]) == ([], 0, 0)


def test_ports_are_rows_of_their_box():
    found = render(graph())
    for node in found["nodes"]:
        ends = [node["head"], *(port["y"] + port["height"] for port in node["ports"])]
        assert [port["y"] for port in node["ports"]] == ends[:-1]
        assert ends[-1] == node["height"]


def test_no_box_grows_by_what_is_wrong_with_it():
    shown = graph()
    wrong = (Finding("error", "JML1", "is wrong " * 10),)
    marked = replace(
        shown,
        nodes=tuple(
            replace(n, findings=wrong, ports=tuple(replace(p, findings=wrong) for p in n.ports))
            for n in shown.nodes
        ),
    )
    plain, found = (render(variant, place=rows) for variant in (shown, marked))
    assert areas(plain) == areas(found)
    assert found["nodes"][0]["findings"][0]["message"] == wrong[0].message


def test_where_parts_stand_is_found_again_only_where_a_size_or_a_place_has_changed():
    shown, standing = graph(), values.Standing()
    first = values.settled(shown, {}, standing, place=rows)
    wrong = (Finding("error", "JML1", "is wrong"),)
    marked = replace(shown, nodes=tuple(replace(node, findings=wrong) for node in shown.nodes))
    again = values.settled(shown, {}, standing, last=first.places)
    kept = values.settled(marked, {}, standing, last=again.places)
    assert kept.places is again.places
    assert kept.places.corners == first.places.corners
    moved = {shown.nodes[0].key: (7, 7)}
    assert values.settled(marked, moved, standing, last=kept.places).places is not kept.places


def box(name, kind="component", rows=1, group=""):
    ports = tuple(Port(f"p{n}", f"row {n}", key=f"p{n}") for n in range(rows))
    column = KINDS.index(kind)
    return Node(name, kind, name, ports=ports, group=group, column=column, key=f"{kind}:{name}")


def line(source, target):
    return Edge(f"{source}-{target}", End(source), End(target), "message", "m", ("m",))


def test_a_new_box_comes_beside_its_peer_and_nothing_else_moves():
    old = Graph(
        "system",
        "s",
        (box("a"), box("b", "bridge", 6), box("n", "node")),
        (),
        (line("a", "b"), line("b", "n")),
    )
    standing = values.Standing()
    before = render(old, standing=standing)
    new = replace(
        old, nodes=(box("x"), *old.nodes, box("y", "node")), edges=(*old.edges, line("x", "b"))
    )
    after = render(new, standing=standing)
    assert_apart(after)
    assert corners(before).items() <= corners(after).items()
    where = areas(after)
    assert where["component:x"][2] <= where["bridge:b"][0]
    assert where["bridge:b"][2] <= where["node:y"][0]
    kept = {edge["id"]: edge["route"] for edge in after["edges"]}
    assert all(kept[edge["id"]] == edge["route"] != [] for edge in before["edges"])
    assert kept["x-b"] == []


def test_what_comes_back_stands_where_it_stood():
    old = Graph("system", "s", (box("a"), box("b", "bridge"), box("c")), (), (line("a", "b"),))
    standing = values.Standing()
    before = render(old, standing=standing)
    render(replace(old, nodes=old.nodes[:2]), standing=standing)
    assert render(old, standing=standing) == before


def test_a_renamed_box_stays():
    old = Graph("system", "s", (box("a"), box("b", "bridge"), box("c")), (), (line("a", "b"),))
    standing = values.Standing()
    before = render(old, standing=standing)
    new = replace(old, nodes=(box("z"), *old.nodes[1:]), edges=(line("z", "b"),))
    after = render(new, standing=standing)
    assert corners(after)["component:z"] == corners(before)["component:a"]
    assert after["edges"][0]["route"] == before["edges"][0]["route"] != []


def test_a_box_that_users_placed_is_renamed_too():
    # As another program does it: the place in the layout file keeps the name of before.
    old = Graph("system", "s", (box("a"), box("b", "bridge"), box("c")), (), (line("a", "b"),))
    moved = {"component:a": (900, 600)}
    standing = values.Standing()
    render(old, moved, standing)
    new = replace(old, nodes=(box("z"), *old.nodes[1:]), edges=(line("z", "b"),))
    after = render(new, moved, standing)
    assert corners(after)["component:z"] == (900, 600)
    both = (box("z"), box("b", "bridge"), box("y"))
    twice = render(replace(new, nodes=both), moved, standing)
    assert {"component:z", "component:y"} <= set(corners(twice))


def test_a_place_that_users_gave_counts_and_its_edges_lose_their_ways():
    shown = graph()
    before = render(shown)
    key = next(node["key"] for node in before["nodes"] if node["kind"] == "bridge")
    other = next(node for node in before["nodes"] if node["kind"] == "node")
    after = render(shown, {key: (other["x"] + 3, other["y"] + 5)})
    assert corners(after)[key] == (other["x"] + 3, other["y"] + 5)
    assert_apart(after)
    bridge = next(node["id"] for node in after["nodes"] if node["key"] == key)
    for edge in after["edges"]:
        assert not edge["route"] or bridge not in (edge["source"]["node"], edge["target"]["node"])
    # Opened again it is the same.
    assert render(shown, {key: corners(after)[key]}) == after


def test_a_box_that_was_moved_goes_back_where_it_stood():
    shown, standing = graph(), values.Standing()
    before = render(shown, standing=standing)
    key = before["nodes"][0]["key"]
    moved = render(shown, {key: (900, 900)}, standing)
    assert corners(moved)[key] == (900, 900)
    assert render(shown, {}, standing) == before


def test_a_box_that_grows_makes_room_for_itself_alone():
    nodes = (box("a", rows=1), box("b"), box("c"), box("d", "bridge"))
    old = Graph("system", "s", nodes, (), tuple(line(name, "d") for name in "abc"))
    standing = values.Standing()
    before = render(old, standing=standing)
    first = min("abc", key=lambda name: corners(before)[f"component:{name}"][1])
    grown = tuple(box(first, rows=8) if node.id == first else node for node in nodes)
    after = render(replace(old, nodes=grown), standing=standing)
    assert_apart(after)
    assert corners(after)[f"component:{first}"] == corners(before)[f"component:{first}"]
    assert corners(after)["bridge:d"] == corners(before)["bridge:d"]


def test_of_frames_none_covers_what_is_not_in_it():
    groups = (Group("g", "host", "host g"), Group("h", "host", "host h"))
    nodes = (
        *(box(f"{kind}g", kind, 3, "g") for kind in KINDS),
        *(box(f"{kind}h", kind, 3, "h") for kind in KINDS),
    )
    edges = tuple(line(f"{a}{g}", f"bridge{g}") for a in ("component", "node") for g in "gh")
    old = Graph("system", "s", nodes, groups, edges)
    standing = values.Standing()
    render(old, standing=standing)
    new = old
    for number in range(4):
        group = "gh"[number % 2]
        new = replace(
            new,
            nodes=(*new.nodes, box(f"n{number}", KINDS[number % 3], 4, group)),
            edges=(*new.edges, line(f"n{number}", f"bridge{group}")),
        )
        found = render(new, standing=standing)
        assert_apart(found)
        assert_framed(found)
    g, h = found["groups"]
    assert (
        g["x"] + g["width"] <= h["x"]
        or h["x"] + h["width"] <= g["x"]
        or (g["y"] + g["height"] <= h["y"] or h["y"] + h["height"] <= g["y"])
    )


@settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_whatever_is_done_boxes_are_apart_and_stay(data):
    def draw(what):
        return data.draw(what)

    nodes = [box(f"s{n}", KINDS[n % 3], n % 4) for n in range(draw(st.integers(1, 6)))]
    groups = tuple(Group(name, "host", name, "", key=name) for name in "gh")
    edges, moved, standing = [], {}, values.Standing()
    known, last = {}, None
    downwards = draw(st.booleans())
    for step in range(draw(st.integers(2, 9))):
        grown = False
        match draw(st.sampled_from(("add", "add", "remove", "grow", "move", "join", "look"))):
            case "add":
                kind, group = draw(st.sampled_from(KINDS)), draw(st.sampled_from(("", "g", "h")))
                nodes.append(box(f"x{step}", kind, draw(st.integers(0, 6)), group))
                if len(nodes) > 1 and draw(st.booleans()):
                    edges.append(line(nodes[-1].id, draw(st.sampled_from(nodes[:-1])).id))
            case "remove" if len(nodes) > 1:
                gone = nodes.pop(draw(st.integers(0, len(nodes) - 1))).id
                edges = [e for e in edges if gone not in (e.source.node, e.target.node)]
            case "grow":
                index, grown = draw(st.integers(0, len(nodes) - 1)), True
                old = nodes[index]
                nodes[index] = box(old.id, old.kind, len(old.ports) + 3, old.group)
            case "move":
                key = draw(st.sampled_from(nodes)).key
                moved[key] = (draw(st.integers(-300, 900)), draw(st.integers(-300, 900)))
                # What stands where it is put makes room.
                grown = True
            case "look":
                pass
            case _:
                pair = draw(st.permutations([node.id for node in nodes]))[:2]
                edges += [line(*pair)] if len(pair) == 2 else []
        edges = list({edge.id: edge for edge in edges}.values())
        shown = Graph("system", "s", tuple(nodes), groups, tuple(edges), downwards)
        forgetful = deepcopy(standing)
        drawn = values.settled(shown, moved, standing, rows, last)
        last, found = drawn.places, drawn.values()
        assert found == render(shown, moved, forgetful, place=rows)
        assert_apart(found, moved)
        assert_framed(found)
        now = corners(found)
        assert all(now[box] == moved[box] for box in moved if box in now)
        if not grown:
            assert all(now[box] == place for box, place in known.items() if box in now)
        known = now


def machine(*names, edges=(), group=""):
    """Returns a machine whose states are of this group, the first of them initial."""
    states = [
        Node(name, "state", name, "" if at else "initial", (), group, 1 if at else 0, key=name)
        for at, name in enumerate(names)
    ]
    lines = (Edge(f"{a}{b}", End(a), End(b), "transition", a, (a,)) for a, b in edges)
    groups = (Group("g", "state", "g"), Group("h", "state", "h", "g")) if group else ()
    return Graph("machine:m", "m", tuple(states), groups, tuple(lines), downwards=True)


@pytest.mark.parametrize("group", ["", "h"])
@pytest.mark.parametrize("edges", [(), ("ba",), ("cd", "db", "bc"), ("ba", "cb", "dc")])
def test_the_initial_state_stands_first_and_a_new_one_last(group, edges):
    old, standing = machine(*"abcd", edges=edges, group=group), values.Standing()
    before = corners(render(old, standing=standing))
    assert all(before[name][1] > before["a"][1] for name in "bcd")
    for where in (group, ""):
        new = replace(machine(*"abcd", "e", edges=edges, group=group))
        added = (replace(new.nodes[-1], group=where),)
        found = render(replace(new, nodes=new.nodes[:-1] + added), standing=standing)
        assert_apart(found)
        after = corners(found)
        assert all(after["e"][1] > after[name][1] for name in "abcd")
        assert all(after[name] == before[name] for name in "abcd")
        standing.shown.pop("e"), standing.boxes.pop("e")
