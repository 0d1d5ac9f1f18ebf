"""Property forms, of every class of the four metamodels and of shipped elements."""

import pytest
from for_each import for_each
from scope_support import CAR, SHIPPED, named, scope_of

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.views.forms import choices, form_of
from jausml.language.metamodel import FeatureKind, documentation, load_metamodels
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model import Diagnostic, Severity
from jausml.language.semantics.names import in_words

CONCRETE = sorted(
    class_table.qualified_name
    for class_table in load_metamodels().classes.values()
    if not class_table.abstract
)
KINDS = {"text", "multiline", "number", "integer", "boolean", "choice", "reference"}


def form_at(scope, ref, diagnostics=()):
    """The form of what a reference names."""
    return form_of(scope, scope.find(ref), diagnostics)


@for_each("name", CONCRETE)
def test_every_class_has_a_form(name):
    table = load_metamodels().classes[name]
    found = form_of(scope_of(CAR), table.python_class())
    assert found.class_ == in_words(table.name)
    assert found.documentation
    settable = [
        feature_table for feature_table in table.features.values() if feature_table.settable
    ]
    owned = {
        feature_table.name
        for feature_table in settable
        if feature_table.kind is FeatureKind.CONTAINMENT
    }
    others = {
        feature_table.name
        for feature_table in settable
        if feature_table.kind is not FeatureKind.CONTAINER
    } - owned
    assert {field.feature for field in found.fields} == others
    assert {children.feature for children in found.children} == owned
    for field in found.fields:
        feature = table.features[field.feature]
        assert field.kind in KINDS
        assert field.documentation == documentation(feature.feature)
        assert field.documentation, field.feature
        assert field.many == feature.many
        assert not field.values or field.required
        if field.kind == "choice":
            legal = feature.data_type.legal
            assert [choice.value for choice in field.choices] == list(legal)
            assert field.default in (*legal, "")
    for field in found.children:
        assert field.kinds
        for kind in field.kinds:
            child = load_metamodels().classes[kind.kind]
            assert not child.abstract
            assert child in table.features[field.feature].target.subtypes


def test_a_ros_field_lists_what_its_markers_say():
    scope = scope_of("library/ros/sensor_msgs.xmi")
    found = form_at(scope, named(scope, ros.Field, "NavSatFix.altitude"))
    (markers,) = (child for child in found.children if child.feature == "markers")
    assert markers.elements[0].label.startswith("unknown if value != value, written NaN (NavSatFix")


@for_each("name", SHIPPED, shards=9, slow=True)
def test_every_shipped_element_has_a_form(name):
    scope = scope_of(name)
    for element in scope.model.elements_of(scope.model.documents[0]):
        found = form_at(scope, scope.ref(element))
        assert found.title
        for field in found.fields:
            if field.kind == "reference" and field.values:
                legal = choices(scope, found.element, field.feature)
                known = {choice.value for choice in legal.choices}
                if not legal.more:
                    assert known.issuperset(field.values), (found.title, field.feature)
            if field.kind == "choice" and field.values:
                assert set(field.values) <= {choice.value for choice in field.choices}


def test_a_connection_tells_values_defaults_units_and_targets():
    scope = scope_of(CAR)
    found = form_at(scope, named(scope, bridge.Connection, "bridge.speed_command"))
    fields = {field.feature: field for field in found.fields}
    assert next(iter(fields)) == "name"
    assert list(fields)[-1] == "documentation"
    assert not found.readonly
    assert found.owner == named(scope, bridge.Bridge, "catvehicle.bridge")
    assert fields["priority"].values == ("high",)
    assert fields["priority"].default == "standard"
    assert fields["silenceTimeout"].values == ("0.5",)
    assert fields["silenceTimeout"].unit == "s"
    assert (fields["rate"].values, fields["rate"].unit) == ((), "Hz")
    assert fields["map"].shown == ("speed_command",)
    labels = [choice.label for choice in choices(scope, found.element, "map", "velocity").choices]
    assert "velocity_state" in labels  # of the project
    assert "velocity_state_twist" in labels  # and of the library
    assert labels[0].startswith("velocity")  # what begins with it comes first
    assert not fields["map"].choices
    peers = {choice.label for choice in choices(scope, found.element, "peers").choices}
    assert peers == {"vehicle", "operator_control_unit", "bridge"}


def test_fields_of_a_connection_stand_in_groups():
    scope = scope_of(CAR)
    found = form_at(scope, named(scope, bridge.Connection, "bridge.speed_command"))
    groups = [field.group for field in found.fields]
    runs = [group for at, group in enumerate(groups) if at == 0 or groups[at - 1] != group]
    assert runs == ["", "rates and limits", "silence and stops", "trust and control", ""]
    assert max(map(groups.count, runs)) < len(groups) / 2


def test_names_of_the_metamodels_are_words():
    assert in_words("silenceTimeout") == "silence timeout"
    assert in_words("QoSProfile") == "QoS profile"
    assert in_words("qos") == "qos"


def test_what_must_be_given_has_no_default_and_a_rate_is_that_of_its_bridge():
    scope = scope_of("library/jaus/mobility.xmi")
    fields = {field.feature: field for field in form_of(scope, scale_of(scope), ()).fields}
    assert (fields["lower"].required, fields["lower"].default) == (True, "")
    scope = scope_of(CAR)
    used = next(connection for connection in scope.own(bridge.Connection) if not connection.rate)
    rate = next(e for e in form_of(scope, used, ()).fields if e.feature == "rate")
    assert rate.default == f"{used.eContainer().frequency}"


def scale_of(scope):
    return next(iter(scope.model.instances(jaus.ScaleRange)))


def test_references_lead_to_what_the_model_allows():
    scope = scope_of(CAR)
    [pose, *_] = scope.model.instances(jaus.ServiceConnection)
    ref = scope.ref(pose)
    messages = {choice.label for choice in choices(scope, ref, "message").choices}
    assert "LocalPoseSensor.ReportLocalPose" in messages
    assert "PrimitiveDriver.SetWrenchEffort" not in messages  # the vehicle takes it
    providers = {choice.label for choice in choices(scope, ref, "provider").choices}
    assert providers == {"vehicle", "operator_control_unit", "bridge"}
    with pytest.raises(AnswerError, match="has no reference 'name'"):
        choices(scope, ref, "name")


def test_what_is_searched_comes_first_and_of_versions_the_newest(tmp_path):
    (tmp_path / "m.ros2jaus").write_text(
        "package m\nnode a { publisher p { topic: p  type: std_msgs/Bool } }\n"
        'service X { urn: "urn:x:X"  version: "1.0" }\n',
        encoding="utf-8",
    )
    scope = scope_of(tmp_path / "m.ros2jaus")

    def first(kind, feature, query):
        [element] = scope.model.instances(kind, library=False)
        return choices(scope, scope.ref(element), feature, query).choices[0].label

    assert first(ros.Publisher, "type", "odometry") == "nav_msgs/Odometry"
    assert first(ros.Publisher, "type", "geometry_msgs/pose") == "geometry_msgs/Pose"
    assert first(jaus.Service, "inherits", "management") == "Management (core-1.1)"


def test_elements_of_the_library_are_not_changed():
    scope = scope_of(CAR)
    [message] = [
        message_def
        for message_def in scope.model.instances(jaus.MessageDef)
        if message_def.name == "ReportLocalPose"
    ]
    found = form_of(scope, message)
    assert found.readonly
    assert not any(field.changeable for field in found.fields)
    assert not any(child.kinds for child in found.children)


def test_fields_tell_what_is_wrong_with_them():
    name = CAR
    scope = scope_of(name)
    [first, *_] = scope.model.instances(bridge.Connection, library=False)
    scope_ref = scope.ref(first)
    place, fragment = scope.model.location(first, "map"), scope.model.fragment(first)
    finding = Diagnostic("JML411", Severity.ERROR, place, "wrong", fragment=fragment)
    fields = {field.feature: field for field in form_at(scope, scope_ref, [finding]).fields}
    assert fields["map"].problems == ("wrong",)
    assert fields["rate"].problems == ()


def test_what_is_gone_is_told():
    with pytest.raises(AnswerError, match="no element"):
        form_at(scope_of(CAR), "catvehicle/catvehicle.xmi#//@bridges.7")


def test_lists_show_what_matters_of_each_element_and_begin_with_what_is_usual():
    scope = scope_of("examples/winch/service.xmi")
    message = next(m for m in scope.model.instances(jaus.MessageDef, library=False) if m.body)
    (fields,) = (child for child in form_of(scope, message.body).children if child.many)
    assert fields.kinds[0].kind == "jaus.FixedField"
    of_fixed = next(child for child in fields.elements if child.kind == "fixed field")
    assert [cell.feature for cell in of_fixed.cells] == ["type", "units"]
    service = named(scope, jaus.Service, "Winch")
    lists = {child.feature: child for child in form_of(scope, scope.find(service)).children}
    assert {cell.feature for child in lists["inputs"].elements for cell in child.cells} == {"code"}
    [body] = form_of(scope, message).children
    assert body.elements
