"""A JAUS operator changes the life cycle and the mode of a ROS node, by the model of the page."""

import re
import subprocess

import needs
import pytest
import warm
from ports import free_port

needs.ask("rclpy")

from rcl_interfaces.msg import IntegerRange, ParameterDescriptor

from .bridge_support import ROOT, Process, generate_text, wait_for

pytestmark = pytest.mark.live

AT_MOST_2 = IntegerRange(from_value=0, to_value=2, step=1)
PAGE = ROOT / "docs" / "how-to" / "ready-mappings.md"
MODEL = re.compile(r"^\$ cat > managed\.ros2jaus <<'END'\n(.*?)^END$", re.MULTILINE | re.DOTALL)


def test_an_operator_activates_and_deactivates_a_node(ros, tmp_path):
    from rclpy.lifecycle import LifecycleNode

    driver = LifecycleNode("driver", context=ros.node.context)
    ros.executor.add_node(driver)
    driver.trigger_configure()
    path = generate_text(tmp_path, "managed", MODEL.search(PAGE.read_text("utf-8"))[1])
    port = str(free_port())
    bridge = Process(["-m", "managed.main", "--jaus-port", port], path, tmp_path / "log")

    def ocu(*words):
        line = [*warm.command(), "ocu", *words, "--port", port]
        return subprocess.run(line, capture_output=True, text=True, timeout=110)

    def state():
        return ocu("query", "100.1.40", "PlatformState").stdout

    def command(name):
        """Commands anew where a bridge that stood still has thrown away what came meanwhile."""
        line = "command", "100.1.40", "SetPlatformState", f"PlatformState={name}"
        wait_for(lambda: ocu(*line).returncode == 0, f"the command {name}")

    def mode():
        return driver.get_parameter("platform_mode").value

    try:
        ready = ocu("status", "100.1.40", "--timeout", "60")
        assert ready.returncode == 0, ready.stderr
        wait_for(lambda: "(Initialize)" in state(), "the state of the node")
        command("Operational")
        wait_for(lambda: "(Operational)" in state(), "an active node")
        command("Operational")  # which it is already, and which no node may fail of
        command("Emergency")
        assert "(Operational)" in state()
        command("Initialize")
        wait_for(lambda: "(Initialize)" in state(), "an inactive node")
        assert "Standard" not in ocu("query", "100.1.40", "PlatformMode", "--timeout", "2").stdout
        driver.declare_parameter("platform_mode", 0, ParameterDescriptor(integer_range=[AT_MOST_2]))
        done = ocu("command", "100.1.40", "SetPlatformMode", "PlatformMode=2")
        assert done.returncode == 0, done.stderr
        wait_for(lambda: mode() == 2, "maintenance")
        assert re.search(r"PlatformMode.*\b2\b", ocu("query", "100.1.40", "PlatformMode").stdout)
        ocu("command", "100.1.40", "SetPlatformMode", "PlatformMode=1")
        wait_for(lambda: mode() == 1, "training")
        ocu("command", "100.1.40", "SetPlatformMode", "PlatformMode=200")  # the node refuses it
        assert re.search(r"PlatformMode.*\b1\b", ocu("query", "100.1.40", "PlatformMode").stdout)
    finally:
        bridge.kill()
        ros.executor.remove_node(driver)
        driver.destroy_node()
