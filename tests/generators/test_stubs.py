"""Stubs that `jausml generate --check` prints for missing methods: what skeletons have."""

import pytest
from click.testing import CliRunner
from sweeps import sweep

from jausml.cli import main

METHODS = ("on_set_velocity_command", "on_set_acceleration_limit")


@pytest.mark.parametrize("method", sweep(METHODS, every=2))
def test_a_stub_can_be_pasted_over_the_method_of_the_skeleton(tmp_path, method):
    model, out = tmp_path / "car.ros2jaus", tmp_path / "src"
    model.write_text("component car { address: 100.1.2  provides: VelocityStateDriver }")
    words = ["generate", str(model), "-o", str(out)]
    assert CliRunner().invoke(main, words).exit_code == 0
    skeleton = out / "car" / "car" / "car.py"
    text = skeleton.read_text("utf-8")
    start = text.index(f"    def {method}(")
    written = text[start : text.index("\n\n    def ", start)]
    skeleton.write_text(text.replace(f"def {method}(", f"def {method}s("), encoding="utf-8")
    done = CliRunner().invoke(main, [*words, "--check"])
    assert f"{method}s: renamed to {method}?" in done.output
    assert f"\n{written}\n" in done.output
