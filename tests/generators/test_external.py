"""Components that exist already, and connections of components to whatever is found."""

import ast
from functools import partial

import pytest
from generated import model_in, texts_of

from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.bringup.target import processes
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES

VEHICLE = "component vehicle { address: 100.1.1 provides: VelocityStateSensor external: true }\n"
FRONT = """
import mappings.velocity_state_sensor
bridge front {
    address: 100.1.2
    connection velocity { map: velocity_state peers: vehicle topic odometry }
}
"""
WATCHER = """
component watcher {
    address: 100.1.3
    service_connection velocity {
        search: { services: VelocityStateSensor  subsystem: 100  choice: all }
        message: ReportVelocityState
        silenceTimeout: 2
    }
    service_connection once {
        search: { services: VelocityStateSensor }
        message: ReportVelocityState
        exchange: oneTime
    }
}
"""


@pytest.fixture
def model_of(tmp_path):
    return partial(model_in, tmp_path)


def files_of(model):
    return texts_of(model, [BRIDGE, COMPONENT, MESSAGES, BRINGUP])


def test_nothing_is_generated_or_started_for_an_external_component(model_of):
    model = model_of(FRONT + VEHICLE)
    files = files_of(model)
    assert not [path for path in files if path.startswith("vehicle/")]
    assert [process["name"] for process in processes(model)] == ["front"]
    launch = files["model_bringup/launch/model.launch.py"]
    assert "vehicle" not in launch
    assert "vehicle" not in files["model_bringup/package.xml"]


def test_its_address_is_known_all_the_same(model_of):
    base = files_of(model_of(FRONT + VEHICLE))["front/front/front_base.py"]
    assert "peers=[JausAddress(100, 1, 1)]" in base


def test_an_external_bridge_is_nobodys_package(model_of):
    model = model_of(FRONT.replace("address: 100.1.2", "address: 100.1.2 external: true") + VEHICLE)
    assert not [path for path in files_of(model) if path.startswith("front/")]
    assert processes(model) == []


def test_where_an_external_component_is_follows_from_its_placement_alone(model_of):
    hosts = """
        host here { interface: "127.0.0.1" transport: jtcp }
        host there { interface: "127.0.0.2" transport: jtcp }
        placement { host: there components: front }
    """
    base = files_of(model_of(FRONT + VEHICLE + hosts))["front/front/front_base.py"]
    assert "100.1.1=" not in base
    placed = hosts + "placement { host: here components: vehicle }"
    base = files_of(model_of(FRONT + VEHICLE + placed))["front/front/front_base.py"]
    assert '"100.1.1=127.0.0.1:3794"' in base


JUDGE = """
component judge { address: 42.1.1 type: ocu external: true endpoint: "192.168.1.42" greet: true }
component arm { address: 42.1.2 external: true endpoint: "arm.local:4000" }
"""


def settings_of(base):
    """The settings of a bridge or component, by the name of their class."""
    calls = [syntax for syntax in ast.walk(ast.parse(base)) if isinstance(syntax, ast.Call)]
    return {ast.unparse(call.func): ast.unparse(call) for call in calls}


@pytest.mark.parametrize(
    "host", ["", "host here {}", 'host here { transport: jtcp interface: "10.0.0.9" }']
)
def test_a_process_knows_where_stated_peers_are_and_whom_to_greet(model_of, host):
    files = files_of(model_of(FRONT + VEHICLE + WATCHER + JUDGE + host))
    for path in ("front/front/front_base.py", "watcher/watcher/watcher_base.py"):
        settings = settings_of(files[path])
        book = "peers('42.1.1=192.168.1.42:3794', '42.1.2=arm.local:4000')"
        assert f"address_book={book}" in settings["TransportSettings"]
        greeted = "greeted={JausAddress(42, 1, 1): Scope.SUBSYSTEM}"
        assert greeted in settings["ComponentSettings"]
        assert "clients = (*" in files[path]
        assert ".clients, Greeter)" in files[path]


@pytest.mark.parametrize(
    ("kind", "scope"),
    [
        ("vehicle", "SUBSYSTEM"),
        ("other", "SUBSYSTEM"),
        ("node", "NODE"),
        ("payload", "COMPONENT"),
        ("component", "COMPONENT"),
    ],
)
def test_a_peer_is_asked_for_what_it_is(model_of, kind, scope):
    base = files_of(model_of(FRONT + VEHICLE + JUDGE.replace("type: ocu", f"type: {kind}")))
    settings = settings_of(base["front/front/front_base.py"])
    assert f"JausAddress(42, 1, 1): Scope.{scope}" in settings["ComponentSettings"]


def test_behind_a_node_manager_nobody_is_told_of_places(model_of):
    model = model_of(FRONT + VEHICLE + JUDGE + "host here { transport: nodeManager }")
    settings = settings_of(files_of(model)["front/front/front_base.py"])
    assert "address_book" not in settings["TransportSettings"]
    assert "greeted=" in settings["ComponentSettings"]


def test_reports_of_whatever_is_found(model_of):
    base = files_of(model_of(WATCHER))["watcher/watcher/watcher_base.py"]
    calls = [
        ast.unparse(syntax)
        for syntax in ast.walk(ast.parse(base))
        if isinstance(syntax, ast.Call) and "_found" in ast.unparse(syntax.func)
    ]
    urn = "('urn:jaus:jss:mobility:VelocityStateSensor',)"
    assert calls == [
        f"self.subscribe_to_found(PeerSearch({urn}, subsystem=100, choice=PeerChoice.ALL), "
        "QueryVelocityState(presence_vector=511), ReportVelocityState, self.on_velocity, rate=1.0, "
        "silence_timeout=2.0, on_silence=self.on_velocity_silent)",
        f"self.query_found(PeerSearch({urn}), QueryVelocityState(presence_vector=511), "
        "ReportVelocityState, self.on_once)",
    ]
    assert "a provider of VelocityStateSensor" in base
