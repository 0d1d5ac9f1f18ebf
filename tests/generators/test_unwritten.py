"""What a component does for reports, and for their silence, before anybody has written it."""

from jausml.generation.rendering import render
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml_generators.jaus_component.target import TARGET

MODEL = """import `jaus.mobility`
system s {
  component vehicle { address: 100.1.1  provides: VelocityStateSensor  external: true }
  component logger {
    address: 100.1.3
    service_connection velocity {
      provider: vehicle  message: VelocityStateSensor.ReportVelocityState
      exchange: periodic  rate: 5  silenceTimeout: 1
    }
  }
}
"""


def test_a_silence_is_told_beside_reports_that_come_often(tmp_path):
    path = tmp_path / "s.ros2jaus"
    path.write_text(MODEL, encoding="utf-8")
    made = render(read_models([path], notations=NOTATIONS).model, [TARGET])
    [base] = [artifact.text for artifact in made if artifact.path.endswith("logger_base.py")]
    before, _, behind = base.partition("def on_velocity_silent")
    assert '"component.not_implemented", f"on_velocity: ' in before
    assert '"component.silence_not_implemented", f"on_velocity_silent:' in behind
