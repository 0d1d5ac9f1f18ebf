"""What a component does for reports, and for their silence, before anybody has written it."""

from generated import model_in, text_of

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
    base = text_of(model_in(tmp_path, MODEL), [TARGET], "logger_base.py")
    before, _, behind = base.partition("def on_velocity_silent")
    assert '"component.not_implemented", f"on_velocity: ' in before
    assert '"component.silence_not_implemented", f"on_velocity_silent:' in behind
