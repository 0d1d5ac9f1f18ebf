"""The transport of a host, from the model to processes that talk."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from generated import model_in
from ports import free_port
from scripts import succeeded
from sweeps import sweep
from workspaces import python_path, write

from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

pytestmark = pytest.mark.ports

MODEL = """
import `jaus.core-1.1`
system fleet {{
  component arm {{ address: 10.1.1  provides: Discovery }}
  component leg {{ address: 10.1.2  provides: Discovery }}
  component desk {{ address: 20.1.1 }}
  host robot {{ transport: {transport}  port: {robot} }}
  host station {{ transport: {transport}  port: {station}  fragmentSize: 1400 }}
  placement {{ host: robot  components: arm, leg }}
  placement {{ host: station  components: desk }}
}}
"""
ASK = """
import queue
from desk.desk_base import TRANSPORT
from jausml_runtime import JausAddress
from jausml_runtime import Component
from jausml_runtime.messages import QueryIdentification, ReportIdentification
from jausml_runtime import running_transport

answers = queue.SimpleQueue()
with running_transport(TRANSPORT) as transport:
    asking = Component(transport, JausAddress(20, 1, 1), name="desk", services=())
    asking.on_message(ReportIdentification, lambda report, sender: answers.put(str(sender)))
    asking.start()
    seen = set()
    while len(seen) < 2:
        for address in TRANSPORT.address_book:
            asking.send(QueryIdentification(query_type=4), address)
        try:
            seen.add(answers.get(timeout=0.2))
        except queue.Empty:
            pass
    asking.stop()
print(sorted(seen))
"""


def generate(folder: Path, transport: str, robot: int = 3794, station: int = 3795) -> None:
    text = MODEL.format(transport=transport, robot=robot, station=station)
    write(model_in(folder, text, "fleet.ros2jaus"), [COMPONENT, MESSAGES, RUNTIME, BRINGUP], folder)


def environment(folder: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": python_path(folder)}


@pytest.mark.parametrize(
    ("transport", "expected"),
    sweep(
        [
            ("judp", "TransportKind.JUDP 0 1400"),
            ("jtcp", "TransportKind.JTCP 2 1400"),
            ("nodeManager", "TransportKind.NODE_MANAGER 0 1400"),
        ],
        every=3,
    ),
)
def test_a_process_has_the_transport_of_its_host(tmp_path, transport, expected):
    generate(tmp_path, transport)
    values = "t.transport, len(t.address_book), t.fragment_size"
    code = f"from desk.desk_base import TRANSPORT as t; print({values})"
    done = succeeded([sys.executable, "-c", code], env=environment(tmp_path), timeout=60)
    assert done.stdout.strip() == expected
    succeeded(
        ["ruff", "format", "--check", "--isolated", "--line-length", "100", "desk", "arm"],
        cwd=tmp_path,
        env={**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"},
        timeout=60,
    )


def test_the_launch_files_pass_it_on(tmp_path):
    generate(tmp_path, "nodeManager")
    text = (tmp_path / "fleet_bringup" / "launch" / "fleet_robot.launch.py").read_text("utf-8")
    assert "judp, jtcp or node-manager (node-manager)" in text  # which the processes have anyway
    assert '["--jaus-transport=", LaunchConfiguration("jaus_transport")],' in text


@pytest.mark.slow
def test_generated_processes_of_two_hosts_talk_over_tcp(tmp_path):
    generate(tmp_path, "jtcp", free_port(), free_port())
    processes = [
        subprocess.Popen(
            [sys.executable, "-m", f"{name}.main"], env=environment(tmp_path), cwd=tmp_path
        )
        for name in ("arm", "leg")
    ]
    try:
        done = succeeded([sys.executable, "-c", ASK], env=environment(tmp_path), timeout=60)
        assert done.stdout.strip() == "['10.1.1', '10.1.2']"
    finally:
        for process in processes:
            process.terminate()
        assert [process.wait(20) for process in processes] == [0, 0]
