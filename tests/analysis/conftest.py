"""Systems for the tests of the analysis."""

from pathlib import Path

import pytest

from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check

HEAD = """\
import `jaus.core-1.1`
import mappings.velocity_state_sensor
import mappings.velocity_state_driver
import mappings.primitive_driver
import mappings.local_pose_sensor
import mappings.cost_map_2d

"""


@pytest.fixture
def system(tmp_path):
    """Returns the system of a text that follows the imports of some ready maps."""

    def made(text, head=HEAD):
        path = tmp_path / "model.ros2jaus"
        path.write_text(head + text, encoding="utf-8")
        report = check(read_models([path], notations=NOTATIONS))
        assert not report.has_errors, [str(diagnostic) for diagnostic in report.diagnostics]
        return system_of(report.model)

    return made


@pytest.fixture
def live_system():
    """Returns the system of a model of the live tests."""
    folder = Path(__file__).resolve().parents[1] / "live"
    return lambda name: system_of(read_models([folder / name], notations=NOTATIONS).model)
