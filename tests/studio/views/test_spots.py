"""Ends of lines in the view of a map."""

import pytest
from scope_support import CAR, scope_of

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.views.spots import end_of
from jausml.language.metamodel.classes import bridge


def test_ids_of_the_map_view_name_members():
    scope = scope_of(CAR)
    [used] = [
        attribute_map
        for attribute_map in scope.model.instances(bridge.AttributeMap)
        if attribute_map.name == "velocity_state"
        and scope.model.document_of(attribute_map).path.name in CAR
    ]
    identifier = scope.model.fragment(used)
    assert end_of(scope, used, f"{identifier}!jaus", "Velocity_X").is_jaus
    assert not end_of(scope, used, f"{identifier}!ros", "twist.twist").is_jaus
    with pytest.raises(AnswerError, match="no end"):
        end_of(scope, used, "bridge", "x")
