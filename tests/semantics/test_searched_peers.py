"""In which state those obey that are searched for: what they provide, and what components do."""

import pytest
from generated import model_in

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.jaus.commands import guard_of_executors, guard_of_receivers

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
    model = model_in(tmp_path, MODEL.format(services=services), "finder.ros2jaus")
    [connection] = model.instances(bridge.Connection, library=False)
    message = connection.map.message
    assert guard_of_receivers(message, [], connection.search) == "READY"
    assert guard_of_executors([], connection.search) == "READY"
