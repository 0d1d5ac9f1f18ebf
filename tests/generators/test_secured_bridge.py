"""What a model says of sources and shapes, in the generated bridge and its parameter file."""

from generated import model_in, text_of

from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bringup.target import TARGET as BRINGUP

TEXT = """
import mappings.primitive_driver
component operator { address: 100.1.1 }
bridge secured {
    address: 100.1.2
    provides: PrimitiveDriver
    HOSTS
    connection drive { map: wrench_effort direction: jausToRos exchange: message
        peers: operator CAP
        topic cmd_vel {} }
}
"""


def generated(tmp_path, hosts="", cap=""):
    model = model_in(tmp_path, TEXT.replace("HOSTS", hosts).replace("CAP", cap))
    parameters = text_of(model, [BRINGUP], "secured.yaml")
    return " ".join(text_of(model, [BRIDGE]).split()), parameters


def test_sources_and_caps_are_what_the_model_says(tmp_path):
    hosts = 'allowedHosts: "10.0.0.0/24", "10.0.1.7" fixedSources: true'
    base, parameters = generated(tmp_path, hosts, "rateCap: 100")
    assert 'allowed_hosts=("10.0.0.0/24", "10.0.1.7")' in base
    assert "fixed_sources=True" in base
    assert "rate_cap=100.0" in base
    for line in (
        'jaus_allowed_hosts: "10.0.0.0/24,10.0.1.7"',
        "jaus_fixed_sources: true",
        "drive.rate_cap: 100.0",
    ):
        assert line in parameters


def test_one_host_is_a_tuple_too(tmp_path):
    base, _ = generated(tmp_path, 'allowedHosts: "10.0.1.7"')
    assert 'allowed_hosts=("10.0.1.7",)' in base


def test_nothing_is_generated_where_nothing_is_said(tmp_path):
    base, parameters = generated(tmp_path)
    for word in ("allowed_hosts", "fixed_sources", "rate_cap"):
        assert word not in base
    for line in ('jaus_allowed_hosts: ""', "jaus_fixed_sources: false", "drive.rate_cap: 0.0"):
        assert line in parameters


def test_budgets_are_what_the_model_says(tmp_path):
    stated = "amplificationLimit: 5 maxPeers: 64 maxConnections: 8 idleTimeout: 10.0"
    base, parameters = generated(tmp_path, f"{stated} maxEvents: 20 eventRateBudget: 500.0")
    for word in (
        *("amplification_limit=5", "max_peers=64", "max_connections=8", "idle_timeout=10.0"),
        *("max_events=20", "event_rate_budget=500.0"),
    ):
        assert word in base
        assert f"jaus_{word.replace('=', ': ')}" in parameters


def test_budgets_that_are_not_stated_are_in_the_parameters_alone(tmp_path):
    base, parameters = generated(tmp_path)
    assert "amplification_limit" not in base
    assert "event_rate_budget" not in base
    assert "jaus_amplification_limit: 3" in parameters
    assert "jaus_event_rate_budget: 4000.0" in parameters


SHAPED = """
import mappings.velocity_state_sensor
component vehicle { address: 100.1.1 provides: VelocityStateSensor external: true }
bridge front {
    address: 100.1.2
    connection shaped {
        map: velocity_state peers: vehicle  maxRate: 5 decimation: 2 ageLimit: 0.5
        topic odometry
    }
    connection plain { map: velocity_state peers: vehicle topic all }
}
"""


def test_shapes_and_their_parameters(tmp_path):
    model = model_in(tmp_path, SHAPED)
    base = text_of(model, [BRIDGE])
    assert base.count("shape=") == 1
    assert "shape=Shape(max_rate=5.0, decimation=2, age_limit=0.5)," in base
    assert "    Shape,\n" in base
    parameters = text_of(model, [BRINGUP], "front.yaml")
    for line in (
        "shaped.max_rate: 5.0",
        "shaped.decimation: 2",
        "shaped.age_limit: 0.5",
        "plain.max_rate: 0.0",
        "plain.decimation: 1",
        "plain.age_limit: 0.0",
    ):
        assert line in parameters
