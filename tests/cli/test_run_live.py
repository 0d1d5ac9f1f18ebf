"""`jausml generate` and `jausml run` with the shipped targets, JUDP and ROS 2."""

import os
import signal
import subprocess
import sys

import needs
import pytest
from ports import free_port

pytestmark = [pytest.mark.live, pytest.mark.usefixtures("folder")]


@pytest.fixture
def workspace(folder, jausml, model_text):
    needs.ask("rclpy")
    host = f'<hosts name="here" port="{free_port()}"/>'
    text = model_text.replace("</system:System>", f"{host}</system:System>")
    (folder / "model.xmi").write_text(text, encoding="utf-8")
    result = jausml("generate", "model.xmi", "-o", "out")
    assert result.exit_code == 0, result.stderr
    return folder / "out"


@pytest.mark.slow
def test_component_and_bridge_start_and_stop(workspace):
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": "83",
        "PYTHONUNBUFFERED": "1",
    }
    process = subprocess.Popen(
        [sys.executable, "-m", "jausml", "run", str(workspace)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    seen = ""
    wanted = ("sensor runs as 10.1.1", "sensor_bridge runs as 10.1.2")
    while not all(text in seen for text in wanted):
        line = process.stdout.readline()
        assert line, f"ended early: {seen}{process.stderr.read()}"
        seen += line
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert all("are compiled, once" in line for line in err.splitlines())
