"""The SROS 2 policy of a node allows what the node has, and nothing else."""

from pathlib import Path

import needs
import pytest
from ports import free_port

needs.ask("rclpy")

from rclpy.node import NodeNameNonExistentError
from workspaces import packages_of

from jausml.generation.rendering import render
from jausml.generation.workspace import generate as generate_code
from jausml.language.model import read_models
from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.ros_node.target import TARGET as NODES
from jausml_generators.runtime.target import TARGET as RUNTIME

from .bridge_support import MODEL, ROOT, Process, generate, wait_for
from .policy_support import allowed, graph

pytestmark = pytest.mark.live

TALK = ROOT / "tests" / "cases" / "ros_node" / "talk.xmi"


def policies(model):
    rendered = render(read_models([model]).model, [BRINGUP])
    texts = {Path(artifact.path).name: artifact.text for artifact in rendered}
    return {
        name.removesuffix(".policy.xml"): allowed(text)
        for name, text in texts.items()
        if name.endswith(".policy.xml")
    }


def check_graph(ros, node, namespace, policy):
    last: dict[str, set[str]] = {}

    def is_equal() -> bool:
        try:
            last.update(graph(ros.node, node, namespace))
        except NodeNameNonExistentError:  # not discovered yet
            return False
        return last == policy

    try:
        wait_for(is_equal, "graph that equals the policy", 30)
    except AssertionError:
        assert last == policy  # which shows what differs


def test_the_graph_of_a_bridge_is_its_policy(ros, tmp_path):
    arguments = ["-m", "loop_bridge.main", "--jaus-port", str(free_port())]
    bridge = Process(arguments, generate(), tmp_path / "log")
    try:
        check_graph(ros, "loop_bridge", "/", policies(MODEL)["loop_bridge"])
    finally:
        bridge.close()


@pytest.mark.slow
def test_the_graph_of_a_node_is_its_policy(ros, tmp_path):
    made = generate_code(read_models([TALK]).model, [NODES, RUNTIME], tmp_path / "workspace")
    path = packages_of(made.plan.out)
    nodes = {
        name: Process(["-m", f"{name}.main"], path, tmp_path / name)
        for name in ("talker", "listener")
    }
    known = policies(TALK)
    try:
        for name in nodes:
            check_graph(ros, name, "/team", known[name])
    finally:
        for node in nodes.values():
            node.close()
