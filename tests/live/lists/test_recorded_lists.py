"""Lists and goals are recorded, and what became of them is explained."""

from __future__ import annotations

import pytest

pytest.importorskip("rclpy")

from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.live.systems.explaining import explained

from ..bridge_support import wait_for
from ..recorder import Recorder
from .list_system import LIVE, PATIENCE, order, wait_goal

pytestmark = [
    pytest.mark.live,
    pytest.mark.ports,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
MODEL = LIVE / "waypoint_lists.ros2jaus"


def test_all(system, operator, tmp_path, packages, monkeypatch):
    import os
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([packages[-1], os.environ.get("PYTHONPATH", "")]))
    model = read_models([MODEL], notations=NOTATIONS, allow_outside=True).model
    with Recorder(tmp_path, MODEL, system.port) as recorder:
        operator.give(1, 2)
        operator.execute()
        wait_goal(system)
        operator.wait_active(1)
        order(system, "abort")
        wait_for(lambda: operator.ends == [False], "the failure", PATIENCE)
        import time
        time.sleep(3)
        recorded = recorder.end()
    for t, n in sorted(recorded.recording.topics.items()):
        print(n, t)
    for m in recorded.marks:
        print(m)
        if m.kind == "drop":
            e = explained(recorded, model, m.subject, m.time)
            for part in (e.counter, e.state, e.ros, e.jaus):
                print("\n".join(part))
                print("--")
    assert 0
