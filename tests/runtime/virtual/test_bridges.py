"""Generated bridges in virtual time: both directions, stops by its clock, the same each time."""

import json
import os
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from generated import model_of
from scripts import succeeded
from workspaces import kept, python_path

from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

MODEL = Path(__file__).resolve().parents[2] / "live" / "stops.ros2jaus"
SCALE = 100.0
SCRIPT = Path(__file__).with_name("two_bridges.py")


@pytest.fixture(scope="module")
def drive():
    """Runs the bridges in a process of their own; returns what happened."""
    workspace = kept(model_of(MODEL), [BRIDGE, MESSAGES, RUNTIME.for_whole_library()])

    def run(hash_seed="0", **options):
        words = [f"--{name}={value}" for name, value in options.items()]
        environment = {
            **os.environ,
            "PYTHONPATH": python_path(workspace),
            "PYTHONHASHSEED": hash_seed,
        }
        result = succeeded([sys.executable, str(SCRIPT), *words], env=environment, timeout=100)
        return json.loads(result.stdout)

    return run


def moving(happened):
    """What arrived of the commands: when, and when each was given, which its speed says."""
    return [(when, SCALE * speed) for when, speed in happened["arrived"] if speed > 0]


def test_commands_cross_both_bridges_in_the_time_of_the_way(drive):
    happened = drive(delay=0.1)
    arrived = moving(happened)
    assert len(arrived) > 300
    late = [when - given for when, given in arrived]
    assert late == [pytest.approx(0.1, abs=1e-5)] * len(late)
    assert [when for when, _ in arrived] == sorted(when for when, _ in arrived)
    assert "loop.callback_failed" not in happened["counters"]


def test_joints_are_found_by_the_names_that_their_map_gives_them(drive):
    happened = drive(seconds=3, until=3)
    turned = [sample for sample in happened["turned"] if any(sample[1])]
    assert turned == [[["pan", "tilt"], [0.5, 0.25]], [["pan", "tilt"], [0.75, 0.125]]]
    assert happened["counters"]["bridge.set_pan_tilt_velocities.absent_field"] == 1


@pytest.mark.slow
def test_a_lossy_way_loses_its_part(drive):
    arrived = moving(drive(loss=0.2, seconds=120, until=120))
    assert 0.7 * 2300 < len(arrived) < 0.87 * 2300
    assert max(b - a for (a, _), (b, _) in pairwise(arrived)) < 5


def test_silence_stops_the_vehicle_by_virtual_time(drive):
    happened = drive(cut=10.0, seconds=15, until=15)
    last = moving(happened)[-1][0]
    stops = [when for when, speed in happened["arrived"] if when > last and speed == 0]
    assert 9.9 < last <= 10
    assert stops[0] - last == pytest.approx(1.0, abs=0.001)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bytes_at_the_same_times(drive):
    way = {"delay": 0.05, "loss": 0.2, "seconds": 60, "until": 60}
    one = drive(seed=1, hash_seed="1", **way)
    assert drive(seed=1, hash_seed="2", **way) == one
    assert drive(seed=2, hash_seed="1", **way)["digest"] != one["digest"]
