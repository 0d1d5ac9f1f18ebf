"""What a model says of the messages that pass, in the generated bridge and its parameter file."""

from generated import model_in, text_of

from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bringup.target import TARGET as BRINGUP

TEXT = """
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
    model = model_in(tmp_path, TEXT)
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
