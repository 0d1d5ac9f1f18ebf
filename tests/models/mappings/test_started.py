"""Each ready map is in a bridge that really starts, with rclpy and sockets, on both sides."""

import json
import os
import sys

import needs
import pytest
from mapping_support import FILES
from ports import free_domain, free_port
from scripts import succeeded
from workspaces import python_path

pytestmark = [pytest.mark.slow, pytest.mark.live]

# One process for all of them: most of what a start takes is the import of rclpy.
START = """
import importlib, json, sys
from jausml_runtime import JausError, TransportSettings, running_transport
from jausml_runtime.bridge.messages.limits import RosTypeError
from jausml_runtime.bridge.process import ManagedBridge
from jausml_runtime.bridge.ros.node import RosNode

def started(stem, transport):
    name = f"{stem}_bridge"
    module = importlib.import_module(f"{name}.{name}")
    bridge = getattr(module, "".join(word.capitalize() for word in name.split("_")))()
    node = RosNode(name, "", [])
    managed = ManagedBridge(bridge, node, transport, print)
    try:
        node.manage(managed)
        with transport.loop.lock:
            node.bring_up()
        return node.node.state
    finally:
        managed.cleanup()
        node.close()

said = {}
with running_transport(TransportSettings(port=int(sys.argv[1]))) as transport:
    for stem in sys.argv[2:]:
        try:
            said[stem] = started(stem, transport)
        except RosTypeError as error:
            said[stem] = f"left out: {error}"
        except Exception as error:
            said[stem] = repr(error)
print(json.dumps(said))
"""

WITHOUT_WHEELS = ("ackermann_msgs", "geographic_msgs")
"""Packages of messages that may not be installed; their maps are tried by their vectors."""


def test_bridges_with_each_ready_map_start(workspace):
    needs.ask("rclpy")
    done = succeeded(
        [sys.executable, "-c", START, str(free_port()), *(file.stem for file in FILES)],
        env={
            **os.environ,
            "PYTHONPATH": python_path(workspace),
            "ROS_DOMAIN_ID": free_domain(),
        },
        timeout=300,
    )
    said = json.loads(done.stdout.splitlines()[-1])
    lacking = {
        stem
        for stem, state in said.items()
        if state.startswith("left out: ") and any(name in state for name in WITHOUT_WHEELS)
    }
    others = {stem: state for stem, state in said.items() if stem not in lacking}
    assert others == dict.fromkeys(others, "active")
    assert len(others) > 30
