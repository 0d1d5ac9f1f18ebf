"""Property forms, of every class of the four metamodels and of shipped elements."""

from __future__ import annotations

import pytest
from for_each import for_each
from scope_support import CAR, SHIPPED, named, scope_of

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.views.forms import choices, form, form_of
from jausml.language.metamodel import FeatureKind, documentation, load_metamodels
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model import Diagnostic, Severity
from jausml.language.semantics.names import in_words

CONCRETE = sorted(
    each.qualified_name for each in load_metamodels().classes.values() if not each.abstract
)
KINDS = {"text", "multiline", "number", "integer", "boolean", "choice", "reference"}


@for_each("name", CONCRETE)
def test_every_class_has_a_form(name):
    table = load_metamodels().classes[name]
    found = form_of(scope_of(CAR), table.python_class())
    assert found.class_ == in_words(table.name)
    assert found.documentation
    settable = [each for each in table.features.values() if each.settable]
    owned = {each.name for each in settable if each.kind is FeatureKind.CONTAINMENT}
    others = {each.name for each in settable if each.kind is not FeatureKind.CONTAINER} - owned
    assert {each.feature for each in found.fields} == others
    assert {each.feature for each in found.children} == owned
    for each in found.fields:
        feature = table.features[each.feature]
        assert each.kind in KINDS
        assert each.documentation == documentation(feature.feature)
        assert each.documentation, each.feature
        assert each.many == feature.many
        assert not each.values or each.required
        if each.kind == "choice":
            legal = feature.data_type.legal
            assert [choice.value for choice in each.choices] == list(legal)
            assert each.default in (*legal, "")
    for each in found.children:
        assert each.kinds
        for kind in each.kinds:
            child = load_metamodels().classes[kind.kind]
            assert not child.abstract
            assert child in table.features[each.feature].target.subtypes


def test_a_ros_field_lists_what_its_markers_say():
    scope = scope_of("library/ros/sensor_msgs.xmi")
    found = form(scope, named(scope, ros.Field, "NavSatFix.altitude"))
    (markers,) = (each for each in found.children if each.feature == "markers")
    assert markers.elements[0].label.startswith("unknown if value != value, written NaN (NavSatFix")


@for_each("name", SHIPPED, shards=3, slow=True)
def test_every_shipped_element_has_a_form(name):
    scope = scope_of(name)
    for element in scope.model.elements_of(scope.model.documents[0]):
        found = form(scope, scope.ref(element))
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
    found = form(scope, named(scope, bridge.Connection, "bridge.speed_command"))
    fields = {each.feature: each for each in found.fields}
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
    labels = [each.label for each in choices(scope, found.element, "map", "velocity").choices]
    assert "velocity_state" in labels  # of the project
    assert "velocity_state_twist" in labels  # and of the library
    assert labels[0].startswith("velocity")  # what begins with it comes first
    assert not fields["map"].choices
    peers = {each.label for each in choices(scope, found.element, "peers").choices}
    assert peers == {"vehicle", "operator_control_unit", "bridge"}


def test_what_must_be_given_has_no_default_and_a_rate_is_that_of_its_bridge():
    scope = scope_of("library/jaus/mobility.xmi")
    fields = {each.feature: each for each in form_of(scope, scale_of(scope), ()).fields}
    assert (fields["lower"].required, fields["lower"].default) == (True, "")
    scope = scope_of(CAR)
    used = next(each for each in scope.own(bridge.Connection) if not each.rate)
    rate = next(e for e in form_of(scope, used, ()).fields if e.feature == "rate")
    assert rate.default == f"{used.eContainer().frequency}"


def scale_of(scope):
    return next(iter(scope.model.instances(jaus.ScaleRange)))


def test_references_lead_to_what_the_model_allows():
    scope = scope_of(CAR)
    [pose, *_] = scope.model.instances(jaus.ServiceConnection)
    ref = scope.ref(pose)
    messages = {each.label for each in choices(scope, ref, "message").choices}
    assert "LocalPoseSensor.ReportLocalPose" in messages
    assert "PrimitiveDriver.SetWrenchEffort" not in messages  # the vehicle takes it
    providers = {each.label for each in choices(scope, ref, "provider").choices}
    assert providers == {"vehicle", "operator_control_unit", "bridge"}
    with pytest.raises(AnswerError, match="has no reference 'name'"):
        choices(scope, ref, "name")


def test_elements_of_the_library_are_not_changed():
    scope = scope_of(CAR)
    [message] = [
        each for each in scope.model.instances(jaus.MessageDef) if each.name == "ReportLocalPose"
    ]
    found = form_of(scope, message)
    assert found.readonly
    assert not any(each.changeable for each in found.fields)
    assert not any(each.kinds for each in found.children)


def test_fields_tell_what_is_wrong_with_them():
    name = CAR
    scope = scope_of(name)
    [first, *_] = scope.model.instances(bridge.Connection, library=False)
    scope_ref = scope.ref(first)
    place, fragment = scope.model.location(first, "map"), scope.model.fragment(first)
    finding = Diagnostic("JML411", Severity.ERROR, place, "wrong", fragment=fragment)
    fields = {each.feature: each for each in form(scope, scope_ref, [finding]).fields}
    assert fields["map"].problems == ("wrong",)
    assert fields["rate"].problems == ()


def test_what_is_gone_is_told():
    with pytest.raises(AnswerError, match="no element"):
        form(scope_of(CAR), "catvehicle/catvehicle.xmi#//@bridges.7")
