"""The figure is a PNG of the declared size, made without touching the caller's matplotlib."""

import struct
import subprocess
import sys
from pathlib import Path

import catvehicle
import pytest
from catvehicle import StraightArcStraight, VehicleParameters
from catvehicle.closed_loop import Loop
from catvehicle.figure import RESOLUTION, SIZE, draw_run

pytestmark = pytest.mark.slow

PARAMETERS = VehicleParameters()
PATH = StraightArcStraight.right_turn(PARAMETERS)


def test_figure_is_a_png_and_equal_runs_give_equal_bytes(tmp_path):
    samples = Loop(PARAMETERS, PARAMETERS, duration=9.0).run()
    first, second = tmp_path / "first.png", tmp_path / "second.png"

    draw_run(samples, PATH, PARAMETERS, first, "A run")
    draw_run(samples, PATH, PARAMETERS, second, "A run")

    data = first.read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    assert struct.unpack(">II", data[16:24]) == tuple(round(RESOLUTION * edge) for edge in SIZE)
    assert data == second.read_bytes()


@pytest.mark.slow
def test_another_run_gives_another_picture(tmp_path):
    samples = Loop(PARAMETERS, PARAMETERS, duration=9.0).run()

    draw_run(samples, PATH, PARAMETERS, tmp_path / "whole.png", "A run")
    draw_run(samples[:500], PATH, PARAMETERS, tmp_path / "half.png", "A run")

    assert (tmp_path / "whole.png").read_bytes() != (tmp_path / "half.png").read_bytes()


def test_a_run_without_samples_is_refused(tmp_path):
    with pytest.raises(ValueError, match="without samples"):
        draw_run([], PATH, PARAMETERS, tmp_path / "none.png", "Nothing")


@pytest.mark.parametrize(
    ("module", "absent"),
    [
        ("catvehicle", "matplotlib"),
        ("catvehicle", "numpy"),
        ("catvehicle.figure", "matplotlib.pyplot"),
    ],
)
def test_importing_stays_light(module, absent):
    folder = Path(catvehicle.__file__).parents[1]
    code = f"import sys; sys.path.insert(0, {str(folder)!r}); import {module}; " + (
        f"sys.exit({absent!r} in sys.modules)"
    )

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
