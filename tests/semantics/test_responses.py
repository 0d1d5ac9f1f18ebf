"""Which messages answer a command, and in which state those obey that are searched for."""

import pytest
from generated import model_in

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model import library_root, read_models
from jausml.language.semantics.jaus.commands import (
    guard_of_executors,
    guard_of_receivers,
    responses,
    told_after,
)

WINCH = library_root().parent / "examples" / "winch" / "winch.xmi"


@pytest.fixture(scope="module")
def services():
    files = [*sorted((library_root() / "jaus").glob("*.xmi")), WINCH]
    model = read_models([str(file) for file in files]).model
    return [*model.instances(jaus.Service)]


def found(services, service, message):
    owner = next(candidate for candidate in services if candidate.name == service)
    return owner, next(candidate for candidate in owner.inputs if candidate.name == message)


@pytest.mark.parametrize(
    ("service", "message", "names"),
    [
        ("ListManager", "SetElement", ["ConfirmElementRequest", "RejectElementRequest"]),
        ("Events", "CancelEvent", ["ConfirmEventRequest", "RejectEventRequest"]),
        ("AccessControl", "SetAuthority", []),
        ("VisualSensor", "SetVisualSensorConfiguration", ["ConfirmSensorConfiguration"]),
        ("PlatformState", "SetPlatformState", ["ConfirmPlatformStateRequest"]),
        ("PrimitiveDriver", "SetWrenchEffort", []),
        # Its machine says it.
        ("Winch", "QueryWinchState", ["ReportWinchState"]),
        ("Winch", "SetWinchCommand", ["RejectWinchCommand"]),
    ],
)
def test_confirmations_and_rejections(services, service, message, names):
    owner, command = found(services, service, message)
    assert sorted(str(response.name) for response in responses(command, owner)) == names


@pytest.mark.parametrize(
    ("service", "message", "report"),
    [
        ("PrimitiveDriver", "SetWrenchEffort", "ReportWrenchEffort"),
        ("AccessControl", "SetAuthority", "ReportAuthority"),
        ("Management", "Resume", "ReportStatus"),
        ("ListManager", "SetElement", "ReportElement"),
        ("AccessControl", "RequestControl", None),
    ],
)
def test_the_report_of_what_is_set(services, service, message, report):
    owner, command = found(services, service, message)
    told = told_after(command, owner)
    assert (told and told.report.name) == report


# -- in which state those obey that are searched for -----------------------------------------------


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
