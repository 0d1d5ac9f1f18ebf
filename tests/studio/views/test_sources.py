"""Where elements stand in their files, and which one is written at a place of a text."""

import pytest
from for_each import for_each
from generated import model_of
from scope_support import CAR, MODELS, SHIPPED, named, scope_of

from jausml.authoring.proposals.elements import Scope
from jausml.authoring.studio.views.spots import element_at, source
from jausml.language.metamodel.classes import bridge, jaus, ros

TEXT = "examples/catvehicle/catvehicle.ros2jaus"


def piece(found):
    data = found.text.encode("utf-16-le")
    return data[2 * found.start : 2 * found.end].decode("utf-16-le")


def test_an_element_of_xmi_is_its_tags():
    scope = scope_of(CAR)
    found = source(scope, named(scope, bridge.Connection, "bridge.steering_command"))
    assert found.notation == "xmi"
    assert piece(found).startswith('<bridgeConnections name="steering_command"')
    assert piece(found).endswith("</bridgeConnections>")


def test_an_element_of_text_is_its_block():
    scope = scope_of(TEXT)
    found = source(scope, named(scope, bridge.Connection, "bridge.steering_command"))
    assert (found.notation, found.file) == ("text", TEXT)
    assert piece(found).startswith("connection steering_command {")
    assert piece(found).endswith("}")


def test_an_element_of_the_library_is_found_there():
    scope = scope_of(CAR)
    [message] = [e for e in scope.model.instances(jaus.MessageDef) if e.name == "ReportLocalPose"]
    found = source(scope, scope.ref(message))
    assert found.file == "library:/jaus/mobility.xmi"
    assert 'name="ReportLocalPose"' in piece(found)


@for_each("name", SHIPPED, shards=20, slow=True)
def test_every_element_stands_somewhere(name):
    scope = scope_of(name)
    elements = list(scope.model.elements_of(scope.model.documents[0]))
    for element in elements[:: max(1, len(elements) // 60)]:
        found = source(scope, scope.ref(element))
        name = getattr(element, "name", None)
        assert found.start < found.end or found.start == 0
        if name and found.notation == "xmi":
            assert f'name="{name}"' in piece(found) or "&" in piece(found)


# ---- which element is written at a place ---------------------------------------------------------


@pytest.mark.parametrize("name", [CAR, TEXT, "minimal/minimal.xmi"])
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


@pytest.mark.parametrize("name", [CAR, TEXT])
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
    lines = ["// \U0001f600 \U0001f600", "system robot {", "    node \u00e4 { }", "}", ""]
    path = tmp_path / "robot.ros2jaus"
    path.write_bytes(end.join(lines).encode())
    scope = Scope(model_of(path), tmp_path)
    [node] = scope.model.instances(ros.Node, library=False)
    page = "\n".join(lines)
    start = len(page[: page.index("node")].encode("utf-16-le")) // 2
    found = source(scope, scope.ref(node))
    assert (found.start, piece(found)) == (start, "node \u00e4 { }")
    assert "\r" not in found.text
    assert element_at(scope.model, start + 2) is node
    assert element_at(scope.model, found.end - 1) is node
    assert element_at(scope.model, 0) is None


def test_nothing_is_written_behind_the_end():
    model = scope_of(TEXT).model
    size = len((MODELS / TEXT).read_text(encoding="utf-8"))
    assert element_at(model, size + 100) is None
