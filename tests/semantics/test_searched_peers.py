"""In which state those obey that are searched for: what they provide, and what components do."""

import pytest

from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.semantics.jaus.commands import guard_of_executors, guard_of_receivers
from jausml.language.text.notation import NOTATIONS

MODEL = """\
import mappings.primitive_driver

bridge finder {{
    address: 10.1.9
    connection drive {{
        map: wrench_effort
        direction: rosToJaus
        search: {{ services: {services} }}
        topic cmd_vel {{}}
    }}
}}
"""


@pytest.mark.parametrize("services", ["PrimitiveDriver", "Management"])
def test_who_is_searched_for_has_states_as_components_have(tmp_path, services):
    path = tmp_path / "finder.ros2jaus"
    path.write_text(MODEL.format(services=services), encoding="utf-8")
    model = read_models([path], notations=NOTATIONS).model
    [connection] = model.instances(bridge.Connection, library=False)
    message = connection.map.message
    assert guard_of_receivers(message, [], connection.search) == "READY"
    assert guard_of_executors([], connection.search) == "READY"
