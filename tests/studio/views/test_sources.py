"""Where elements stand in their files."""

from for_each import for_each
from generated import model_of
from scope_support import CAR, SHIPPED, named, scope_of

from jausml.authoring.proposals.elements import Scope
from jausml.authoring.studio.views.spots import source
from jausml.language.metamodel.classes import bridge, jaus


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
    scope = scope_of("examples/catvehicle/catvehicle.ros2jaus")
    found = source(scope, named(scope, bridge.Connection, "bridge.steering_command"))
    assert (found.notation, found.file) == ("text", "examples/catvehicle/catvehicle.ros2jaus")
    assert piece(found).startswith("connection steering_command {")
    assert piece(found).endswith("}")


def test_an_element_of_the_library_is_found_there():
    scope = scope_of(CAR)
    [message] = [e for e in scope.model.instances(jaus.MessageDef) if e.name == "ReportLocalPose"]
    found = source(scope, scope.ref(message))
    assert found.file == "library:/jaus/mobility.xmi"
    assert 'name="ReportLocalPose"' in piece(found)


def test_line_ends_and_wide_characters_are_counted_as_browsers_do(tmp_path):
    text = "// \U0001f697 car\r\nsystem car {\r\n    node \u00e4 { }\r\n    host one { }\r\n}\r\n"
    path = tmp_path / "car.ros2jaus"
    path.write_bytes(text.encode())
    scope = Scope(model_of(path), tmp_path)
    [host] = scope.model.root.hosts
    found = source(scope, scope.ref(host))
    assert piece(found) == "host one { }"
    assert "\r" not in found.text


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
