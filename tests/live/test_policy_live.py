"""The SROS 2 policy of a bridge allows what its node has, and nothing else."""

from __future__ import annotations

import pytest
from ports import free_domain, free_port

pytest.importorskip("rclpy")

from rclpy.node import NodeNameNonExistentError

from jausml.generation import render
from jausml.generators.bringup.target import TARGET as BRINGUP
from jausml.model import read_models

from .bridge_support import MODEL, Process, RosPeer, generate, wait_for
from .policy_support import allowed, graph

pytestmark = [
    pytest.mark.live,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]


def test_the_graph_is_the_policy(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    (text,) = (
        each.text
        for each in render(read_models([MODEL]).model, [BRINGUP])
        if each.path.endswith(".policy.xml")
    )
    policy = allowed(text)
    arguments = ["-m", "loop_bridge.main", "--jaus-port", str(free_port())]
    bridge = Process(arguments, generate(tmp_path / "workspace"), tmp_path / "log")
    ros = RosPeer()
    last: dict[str, set[str]] = {}

    def is_equal() -> bool:
        try:
            last.update(graph(ros.node, "loop_bridge", "/"))
        except NodeNameNonExistentError:  # not discovered yet
            return False
        return last == policy

    try:
        wait_for(is_equal, "graph that equals the policy")
    except AssertionError:
        assert last == policy  # which shows what differs
    finally:
        bridge.close()
        ros.close()
