"""Which element is written at a place of a text."""

import pytest
from generated import model_of
from scope_support import MODELS, scope_of

from jausml.authoring.proposals.elements import Scope
from jausml.authoring.studio.views.spots import element_at, source
from jausml.language.metamodel.classes import bridge, ros

XMI = "catvehicle/catvehicle.xmi"
TEXT = "examples/catvehicle/catvehicle.ros2jaus"


@pytest.mark.parametrize("name", [XMI, TEXT, "minimal/minimal.xmi"])
def test_the_start_of_what_is_written_leads_back_to_the_element(name):
    scope = scope_of(name)
    count = 0
    for element in scope.model.elements_of(scope.model.documents[0]):
        found = source(scope, scope.ref(element))
        there = element_at(scope.model, found.start)
        again = source(scope, scope.ref(there))
        assert (again.start, again.end) == (found.start, found.end)
        count += 1
    assert count > 5


@pytest.mark.parametrize("name", [XMI, TEXT])
def test_what_lies_between_elements_belongs_to_what_is_around_them(name):
    scope = scope_of(name)
    [whole] = scope.model.instances(bridge.Bridge, library=False)
    found = source(scope, scope.ref(whole))
    inner = [source(scope, scope.ref(connection)) for connection in whole.bridgeConnections]
    gap = max(located.end for located in inner)
    assert found.start < gap < found.end
    between = found.text.index("\n", gap) + 1 if "\n" in found.text[gap:] else gap
    assert element_at(scope.model, between) is not None


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_characters_and_ends_of_lines_are_counted_as_pages_do(tmp_path, end):
    lines = ["// \U0001f600 \U0001f600", "system robot {", "    node wheels {", "    }", "}", ""]
    path = tmp_path / "robot.ros2jaus"
    path.write_bytes(end.join(lines).encode())
    scope = Scope(model_of(path), tmp_path)
    [node] = scope.model.instances(ros.Node, library=False)
    page = "\n".join(lines)
    start = len(page[: page.index("node")].encode("utf-16-le")) // 2
    assert source(scope, scope.ref(node)).start == start
    assert element_at(scope.model, start + 2) is node
    assert element_at(scope.model, 0) is None


def test_nothing_is_written_behind_the_end():
    model = scope_of(TEXT).model
    size = len((MODELS / TEXT).read_text(encoding="utf-8"))
    assert element_at(model, size + 100) is None
