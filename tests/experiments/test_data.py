"""A run is the same value after it was written and read."""

import json
import math

import pytest
from catvehicle.metrics import Sample

from experiments.right_turn.data import Run, read_all

RUN = Run(
    system="J",
    name="03",
    arrived=True,
    samples=[Sample(0.1, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)],
    latencies={"sense_act": [0.2, 0.1], "to_vehicle": [0.003]},
    config={"port": 3794, "plant": "kinematic"},
    metrics={"path_error_max": 0.25},
    counters={"drops": 2},
)


def test_a_run_comes_back_as_it_was(tmp_path):
    RUN.write(RUN.place(tmp_path))

    assert Run.read(tmp_path / "J" / "03") == RUN
    assert read_all(tmp_path) == [RUN]


def test_a_hop_is_summarised_where_messages_took_it(tmp_path):
    RUN.write(tmp_path)
    latency = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))["latency"]

    assert set(latency) == {"sense_act", "to_vehicle"}
    assert latency["sense_act"] == {"count": 2, "p50": 0.1, "p95": 0.2, "p99": 0.2, "maximum": 0.2}


def test_a_metric_that_is_not_finite_is_no_number_in_the_file(tmp_path):
    Run("R", "0", arrived=False, metrics={"closeness": math.inf}).write(tmp_path)

    assert json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))["metrics"] == {
        "closeness": None
    }
    assert math.isnan(Run.read(tmp_path).metrics["closeness"])


def test_a_file_of_another_kind_is_refused(tmp_path):
    RUN.write(tmp_path)
    (tmp_path / "latencies.csv").write_text("a,b\n", encoding="utf-8")

    with pytest.raises(ValueError, match=r"latencies\.csv:1: header is not hop,seconds"):
        Run.read(tmp_path)
