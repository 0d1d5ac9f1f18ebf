"""A generated deployment on two hosts, behind its own firewalls: multicast, named peers, TCP.

A vehicle and its trailer, which share the port of one host, say how fast they are, by JAUS; the
bridge is on the other host; a ROS 2 node beside the vehicle says what arrives. All run as their
units say.
"""

import json
import os
import signal
import subprocess
import sys
import threading
from contextlib import ExitStack, contextmanager
from pathlib import Path

import needs
import pytest
from sweeps import sweep

needs.ask("rclpy")

from deployed import install, moved, started
from network_hosts import two_hosts
from workspaces import python_path

from jausml.generation.workspace import generate
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.deployment.target import TARGET as DEPLOYMENT
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.ros_node.target import TARGET as ROS_NODE
from jausml_generators.runtime.target import TARGET as RUNTIME

from .bridge_support import wait_for

pytestmark = pytest.mark.live

MODEL = Path(__file__).with_name("two_hosts.ros2jaus")
PROBE = Path(__file__).with_name("probe.py")
ADDRESSES = {"onboard": "10.77.0.1", "station": "10.77.0.2"}
STRANGER = "10.77.0.66"
GROUP = "239.255.0.1"
UNITS = {"vehicle": "onboard", "trailer": "onboard", "display": "onboard", "watcher": "station"}
TARGETS = (BRIDGE, BRINGUP, DEPLOYMENT, COMPONENT, MESSAGES, ROS_NODE, RUNTIME)
PATIENCE = 60
SPEEDS = {"odometry": ("vehicle", 2.0), "trailing": ("trailer", 1.5)}
SKELETONS = {
    **{
        name: {
            "return super().report_velocity_state(query, sender)": (
                f"return ReportVelocityState(velocity_x={speed}, velocity_y=0.5, yaw_rate=0.25)"
            )
        }
        for name, speed in SPEEDS.values()
    },
    "display": {
        f"super().on_{topic}(message)": (
            f'print("{topic}", round(message.twist.twist.linear.x, 2), flush=True)'
        )
        for topic in SPEEDS
    },
}


@pytest.fixture(scope="module")
def hosts():
    needs.ask("namespaces of networks")
    with two_hosts(*ADDRESSES.values()) as made:
        yield dict(zip(ADDRESSES, made, strict=True))


def workspace_of(folder, transport):
    """Generates the workspace; returns its folder."""
    text = MODEL.read_text(encoding="utf-8").replace("transport: judp", f"transport: {transport}")
    (folder / "rover.ros2jaus").write_text(text, encoding="utf-8")
    read = read_models([folder / "rover.ros2jaus"], notations=NOTATIONS)
    assert not read.diagnostics, read.diagnostics
    out = folder / "src"
    generate(read.model, TARGETS, out)
    for package, methods in SKELETONS.items():
        skeleton = out / package / package / f"{package}.py"
        code = skeleton.read_text(encoding="utf-8")
        for said, says in methods.items():
            assert said in code
            code = code.replace(said, says)
        skeleton.write_text(code, encoding="utf-8")
    return out


class Deployment:
    """The system on its two hosts, with the processes that were started."""

    def __init__(self, workspace, hosts, folder):
        self.hosts = hosts
        self.folder = folder
        self.images = {name: folder / name for name in hosts}
        for name, image in self.images.items():
            install(workspace / "rover_deployment" / "hosts" / name, image)
        programs = Path(sys.executable).parent
        setup = f'export PATH="{programs}:$PATH" PYTHONPATH="{python_path(workspace)}"\n'
        (folder / "setup.bash").write_text(setup, encoding="utf-8")
        self.processes = {}

    def close_ports(self):
        """Loads the firewall of each host."""
        for name, host in self.hosts.items():
            image = self.images[name]
            file = image / "etc" / "jaus" / "rover" / "firewall.nft"
            loaded = image / "loaded.nft"
            loaded.write_text(moved(file.read_text(encoding="utf-8"), image), encoding="utf-8")
            host.run("nft", "-f", str(loaded))

    def change(self, name, text):
        """Says in local.env of a host what differs there."""
        with (self.images[name] / "etc" / "jaus" / "rover" / "local.env").open("a") as file:
            file.write(text)

    def start(self, name):
        """Starts a process as its unit says."""
        host = UNITS[name]
        command, variables = started(self.images[host], f"jaus-rover-{name}.service")
        kept = {key: value for key, value in os.environ.items() if not key.startswith("ROS_")}
        log = self.log(name).open("wb")
        with log:
            self.processes[name] = subprocess.Popen(
                self.hosts[host].command(command),
                env={**kept, **variables, "JAUS_WORKSPACE": str(self.folder)},
                stdout=log,
                stderr=subprocess.STDOUT,
            )

    def log(self, name):
        return self.folder / f"{name}.log"

    def arrives(self):
        """Waits until the speeds of vehicle and trailer have crossed both networks."""
        try:
            wait_for(self.has_arrived, "speed of vehicle and trailer", PATIENCE)
        except AssertionError as error:
            said = "".join(f"\n--- {unit}\n{self.log(unit).read_text()}" for unit in UNITS)
            raise AssertionError(f"{error}{said}") from error

    def has_arrived(self):
        for name, process in self.processes.items():
            assert process.poll() is None, self.log(name).read_text()
        shown = self.log("display").read_text()
        return all(f"{topic} {speed}" in shown for topic, (_, speed) in SPEEDS.items())

    def close(self):
        for process in self.processes.values():
            process.send_signal(signal.SIGTERM)
        try:
            return {name: child.wait(PATIENCE) for name, child in self.processes.items()}
        finally:
            for child in self.processes.values():
                child.kill()
                child.wait()


@pytest.fixture(scope="module")
def workspaces(tmp_path_factory):
    made = {}

    def of(transport):
        if transport not in made:
            made[transport] = workspace_of(tmp_path_factory.mktemp(transport), transport)
        return made[transport]

    return of


@pytest.mark.slow
@pytest.mark.parametrize("way", sweep(["multicast", "peers", "tcp"], every=3, rest=1))
def test_the_bridge_reaches_the_other_host(way, hosts, workspaces, tmp_path):
    deployed = Deployment(workspaces("jtcp" if way == "tcp" else "judp"), hosts, tmp_path)
    if way == "peers":
        for name in hosts:
            local = deployed.images[name] / "etc" / "jaus" / "rover" / "local.env"
            (options,) = (
                line.removeprefix("#")
                for line in local.read_text(encoding="utf-8").splitlines()
                if line.startswith("#JAUS_OPTIONS=")
            )
            # Groups that differ are as good as a network that passes no multicast.
            group = ADDRESSES[name].replace("10.", "239.")
            deployed.change(name, f"{options} --jaus-multicast-group {group}\n")
    if not needs.missing("nft"):
        deployed.close_ports()
    try:
        for name in UNITS:
            deployed.start(name)
        deployed.arrives()
    finally:
        codes = deployed.close()
    assert set(codes.values()) == {0}


@contextmanager
def knocking(hosts, kind, knocks):
    """Knocks from the one host at ports of the other; gives the list of what comes through."""
    came = []
    here, there = hosts["onboard"], hosts["station"]
    ports = sorted({str(port) for *_, port in knocks})
    with ExitStack() as processes:
        listener = processes.enter_context(
            probing(there, "listen", kind, there.address, GROUP, *ports)
        )
        assert listener.stdout.readline() == '["ready"]\n'
        reader = threading.Thread(
            target=lambda: came.extend(tuple(json.loads(line)) for line in listener.stdout)
        )
        sent = [",".join(map(str, knock)) for knock in knocks]
        sender = processes.enter_context(probing(here, "knock", kind, *sent))
        reader.start()
        yield came
        listener.stdin.close()
        reader.join(PATIENCE)
        sender.stdin.close()


@contextmanager
def probing(host, *arguments):
    """Runs the probe on a host."""
    command = host.command([sys.executable, str(PROBE), *arguments])
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.fixture
def stranger(hosts):
    """A second address of the host that knocks, of which the model knows nothing."""
    here = hosts["onboard"]
    here.run("ip", "address", "add", f"{STRANGER}/24", "dev", "wire")
    yield STRANGER
    here.run("ip", "address", "delete", f"{STRANGER}/24", "dev", "wire")


@pytest.mark.needs("nft")
@pytest.mark.parametrize(
    ("transport", "kind", "closed"),
    [("judp", "udp", (22, 53794, 9150, 9400)), ("jtcp", "tcp", (22, 9160))],
)
def test_the_firewall_lets_in_what_the_model_has(
    transport, kind, closed, hosts, stranger, workspaces, tmp_path
):
    deployed = Deployment(workspaces(transport), hosts, tmp_path)
    peer, here = ADDRESSES["onboard"], ADDRESSES["station"]
    opened = [(peer, here, 9160), (peer, here, 9399), (peer, GROUP, 3794)] if kind == "udp" else []
    opened += [(peer, here, 3794)]
    of_stranger = [(stranger, *where) for _, *where in opened]
    knocks = [*of_stranger, *((peer, here, port) for port in closed), *opened]
    for host in hosts.values():
        host.run("nft", "flush", "ruleset")
    with knocking(hosts, kind, knocks) as free:
        wait_for(lambda: sorted(free) == sorted(knocks), "knocks without a firewall", PATIENCE)
    deployed.close_ports()
    with knocking(hosts, kind, knocks) as kept:
        # One wire: what was sent before the last knock is there before it, or never.
        wait_for(lambda: opened[-1] in kept, "last knock", PATIENCE)
    assert kept == opened
