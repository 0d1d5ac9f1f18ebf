"""Real processes, real JUDP and real rclpy for the live tests of bridges."""

import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from generated import model_of
from ports import free_port
from ros_nodes import SpinningNode
from workspaces import kept, packages_of

from jausml.generation import native
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

ROOT = Path(__file__).resolve().parents[2]
MODEL = ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi"
SUPPORT = str(ROOT / "tests" / "support")
TARGETS = (BRIDGE, MESSAGES, RUNTIME.for_whole_library())
PATIENCE = 60.0
"""Seconds for what comes: the start of a bridge alone takes three of a processor, which others have
at the same time."""

COMPILED = bool(os.environ.get("JAUSML_COMPILED"))
"""Whether bridges run with a compiled core, to try all of these tests on the fast path."""


def generate(document: Path = MODEL, *, compiled: bool = COMPILED) -> list[str]:
    """Generates the bridges of a model, of the test bridge as a rule, for all tests.

    Returns:
        The folders for the module path.
    """
    folder = kept(model_of(document, allow_outside=True), TARGETS, compiled=compiled)
    if compiled:
        built = native.build(native.cores(folder), native.compiler())
        assert [built_core.reason for built_core in built if built_core.reason] == []
    return packages_of(folder)


def generate_text(folder: Path, name: str, text: str) -> list[str]:
    """Generates the bridges of a model in text, which is written beside them."""
    document = folder / f"{name}.ros2jaus"
    document.write_text(text, encoding="utf-8")
    return generate(document)


def wait_for(condition, what: str, seconds: float = PATIENCE):
    """Waits until a condition holds; returns what it gave.

    Raises:
        AssertionError: It did not hold in time.
    """
    end = time.monotonic() + seconds
    while True:
        found = condition()
        if found:
            return found
        assert time.monotonic() < end, f"no {what} within {seconds} s"
        time.sleep(0.01)


class Process:
    """A process whose stdout is read line by line as JSON."""

    def __init__(
        self,
        arguments: list[str],
        path: list[str],
        log: Path,
        *,
        stdin: bool = False,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        module_path = os.pathsep.join([*path, SUPPORT])
        own = {"PYTHONPATH": module_path, "PYTHONUNBUFFERED": "1", **(environment or {})}
        self.log = log
        self._log_file = log.open("ab")
        self.popen = subprocess.Popen(
            [sys.executable, *arguments],
            stdin=subprocess.PIPE if stdin else None,
            stdout=subprocess.PIPE,
            stderr=self._log_file,
            env={**os.environ, **own},
            text=True,
        )
        self.lines: queue.SimpleQueue[dict] = queue.SimpleQueue()
        self.facts: list[dict] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self.popen.stdout:
            if line.startswith("{"):
                self.facts.append(json.loads(line))
            else:  # Fast DDS says its errors on standard output
                self._log_file.write(line.encode())

    def of_kind(self, *kinds: str) -> list[dict]:
        """What the process said of some kinds so far."""
        return [fact for fact in list(self.facts) if fact["kind"] in kinds]

    def tell(self, line: str) -> None:
        """Writes a line to a process that was started with `stdin`."""
        self.popen.stdin.write(f"{line}\n")
        self.popen.stdin.flush()

    def kill(self) -> None:
        """Ends the process at once, as a crash does."""
        self.popen.kill()
        self.close()

    def stop(self) -> int:
        """Asks the process to end; returns its exit code."""
        self.popen.send_signal(signal.SIGTERM)
        try:
            return self.popen.wait(timeout=PATIENCE)
        finally:
            self.close()

    def close(self) -> None:
        """Ends the process if it runs, and releases its pipes."""
        if self.popen.poll() is None:
            self.popen.kill()
        self.popen.wait(timeout=PATIENCE)
        self._reader.join(timeout=PATIENCE)
        self.popen.stdout.close()
        if self.popen.stdin is not None:
            self.popen.stdin.close()
        self._log_file.close()


class RosPeer(SpinningNode):
    """A node of the test with a thread that waits for messages."""

    def __init__(self) -> None:
        super().__init__("peer")
        self.received: dict[str, list] = {}
        self._publishers: dict[str, object] = {}
        self._subscriptions: dict[str, Any] = {}
        self.start()

    def listen(self, message_type, topic: str, qos=10) -> list:
        """Subscribes; returns the list that grows with each message."""
        if topic not in self.received:
            found: list = []
            self.received[topic] = found
            subscription = self.node.create_subscription(message_type, topic, found.append, qos)
            self._subscriptions[topic] = subscription
        return self.received[topic]

    def listen_to_publisher(self, message_type, topic: str, qos=10) -> list:
        """Subscribes and waits until a publisher was found.

        That publisher may find the subscription later: what it sends until then does not arrive.
        """
        found = self.listen(message_type, topic, qos)
        subscription = self._subscriptions[topic]
        wait_for(lambda: subscription.get_publisher_count() > 0, f"publisher of {topic}")
        return found

    def publisher(self, message_type, topic: str, qos=10):
        """Makes a publisher and waits until the bridge has found it."""
        if topic not in self._publishers:
            publisher = self.node.create_publisher(message_type, topic, qos)
            self._publishers[topic] = publisher
            wait_for(lambda: publisher.get_subscription_count() > 0, f"subscription of {topic}")
        return self._publishers[topic]

    def on_executor(self, call):
        """Calls on the thread that takes answers, and returns the result.

        An action client of rclpy drops an answer that comes before it has noted its question.
        """
        task = self.executor.create_task(call)
        wait_for(task.done, "the call")
        return task.result()

    def call(self, kind, name: str, request):
        """Calls a service once somebody serves it; returns the answer."""
        client = self.node.create_client(kind, name)
        wait_for(client.service_is_ready, f"service {name}")
        futures = [client.call_async(request)]
        asked = time.monotonic()

        def answered():
            # A server may find this client later than the client the server: its answer is lost.
            nonlocal asked
            if time.monotonic() > asked + PATIENCE / 4:
                futures.append(client.call_async(request))
                asked = time.monotonic()
            return next((future for future in futures if future.done()), None)

        answer = wait_for(answered, f"answer of {name}")
        self.node.destroy_client(client)
        return answer.result()

    def set_parameter(self, node: str, name: str, value):
        """Sets a parameter of a node; returns what it says."""
        from rcl_interfaces.srv import SetParameters
        from rclpy.parameter import Parameter

        parameter = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[parameter])
        (result,) = self.call(SetParameters, f"{node}/set_parameters", request).results
        return result

    def statuses(self, name: str) -> list:
        """Returns what `/diagnostics` says of something since the first call, the latest last."""
        from diagnostic_msgs.msg import DiagnosticArray

        arrays = list(self.listen(DiagnosticArray, "/diagnostics"))
        every = [status for array in arrays for status in array.status]
        return [status for status in every if status.name.endswith(f": {name}")]

    def status(self, name: str):
        """Waits until something has a status; returns the latest."""
        return wait_for(lambda: self.statuses(name), f"diagnostics of {name}")[-1]

    def values(self, name: str) -> dict[str, str]:
        """Waits until something has a status; returns the values of the latest."""
        return {value.key: value.value for value in self.status(name).values}


class System:
    """Processes that share a port of JAUS, and a node of the test."""

    def __init__(self, path: list[str], logs: Path) -> None:
        self.path, self.logs, self.port = path, logs, free_port()
        self.processes: list[Process] = []
        self.ros = RosPeer()

    def start(self, *arguments: str, option: str = "--jaus-port", stdin: bool = False) -> Process:
        """Starts a process, which is told the port by an option."""
        log = self.logs / f"{len(self.processes)}.log"
        line = [*arguments, option, str(self.port)]
        self.processes.append(Process(line, self.path, log, stdin=stdin))
        return self.processes[-1]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self) -> None:
        """Ends all of it, and shows what was logged."""
        self.ros.close()
        for process in self.processes:
            process.close()
        for process in self.processes:
            sys.stderr.write(process.log.read_text())


def meet(tested) -> None:
    """Waits until the ROS side of a bridge in this process knows the node of the test.

    Fast DDS 2.14 and 3.2 lose what a node announces while another one joins, once in some hundred
    times on a busy computer: that other one never hears of a publisher which is made just then.
    """
    wait_for(lambda: "peer" in tested.node.get_node_names(), "node of the test")


class Repeater:
    """Publishes a message again and again, as a controller does."""

    def __init__(self, publisher, message, period: float = 0.05) -> None:
        self._publish = lambda: publisher.publish(message)
        self._period = period
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        while not self._stop.wait(self._period):
            self._publish()

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()
