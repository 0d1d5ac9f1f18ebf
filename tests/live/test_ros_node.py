"""Generated nodes in processes of their own: topics, latched state, a service, signals."""

import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import needs
import pytest
from scripts import ran, succeeded
from sweeps import sweep
from workspaces import python_path

needs.ask("rclpy")

from jausml.generation.workspace import generate as generate_code
from jausml.language.model import read_models
from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.ros_node.target import TARGET as ROS_NODE
from jausml_generators.runtime.target import TARGET as RUNTIME

pytestmark = pytest.mark.live

MODEL = Path(__file__).resolve().parents[1] / "cases" / "ros_node" / "talk.xmi"
PATIENCE = 30

# What users would write into the skeletons.
TALKER = {
    "from .talker_base import TalkerBase\n": """\
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool

from .talker_base import TalkerBase
""",
    "        super().on_timer()\n": """\
        self.publish_word(String(data=self.parameter_text))
        if not self.asked and self.client_double.service_is_ready():
            self.asked = True
            future = self.client_double.call_async(SetBool.Request(data=True))
            future.add_done_callback(self.on_answer)

    asked = False

    def on_answer(self, future) -> None:
        print("answer", future.result().message, flush=True)

    def __init__(self) -> None:
        super().__init__()
        self.publish_state(Int32(data=42))
        print("ready", self.parameter_text, self.parameter_factor, flush=True)
""",
}
LISTENER = {
    "        super().on_word(message)\n": '        print("word", message.data, flush=True)\n',
    "        super().on_state(message)\n": '        print("state", message.data, flush=True)\n',
    "        return super().on_double(request, response)\n": """\
        response.success = request.data
        response.message = "twice"
        return response
""",
}


class Process:
    """A process whose lines of output are waited for."""

    def __init__(self, workspace, name, *arguments):
        environment = {**os.environ, "PYTHONPATH": python_path(workspace)}
        self.popen = subprocess.Popen(
            [sys.executable, "-m", f"{name}.main", *arguments],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.lines = []
        self.fresh = queue.SimpleQueue()
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self):
        for line in self.popen.stdout:
            self.fresh.put(line)
        self.fresh.put(None)

    def wait_for(self, pattern):
        """Returns the first line that matches, of those that are still to come."""
        end = time.monotonic() + PATIENCE
        while (left := end - time.monotonic()) > 0:
            try:
                line = self.fresh.get(timeout=left)
            except queue.Empty:
                break
            if line is None:
                break
            self.lines.append(line)
            if re.search(pattern, line):
                return line
        raise AssertionError(f"no {pattern!r} in {self.lines}")

    def end(self, number):
        """Sends a signal; returns the exit code and all output."""
        self.popen.send_signal(number)
        code = self.popen.wait(PATIENCE)
        self.reader.join(PATIENCE)
        while not self.fresh.empty():
            self.lines.append(self.fresh.get() or "")
        return code, "".join(self.lines)

    def close(self):
        # Asked first: a DDS process that is killed leaves shared memory behind.
        self.popen.terminate()
        try:
            self.popen.wait(PATIENCE)
        finally:
            self.popen.kill()
            self.popen.wait(PATIENCE)
        self.reader.join(PATIENCE)
        self.popen.stdout.close()


def fill_in(file, replacements):
    text = file.read_text()
    for before, after in replacements.items():
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    file.write_text(text)


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    out = tmp_path_factory.mktemp("talk")
    generate(out)
    fill_in(out / "talker" / "talker" / "talker.py", TALKER)
    fill_in(out / "listener" / "listener" / "listener.py", LISTENER)
    return out


@pytest.fixture
def start(workspace):
    processes = []

    def begin(name, *arguments):
        processes.append(Process(workspace, name, *arguments))
        return processes[-1]

    yield begin
    for process in processes:
        process.close()


def generate(out):
    generate_code(read_models([MODEL]).model, [ROS_NODE, BRINGUP, RUNTIME], out)
    return out


def test_nodes_talk_by_topics_and_services(start, workspace):
    parameters = workspace / "talk_bringup" / "config" / "talker.yaml"
    given = ("--params-file", str(parameters), "-p", "text:=hi", "-p", "tect:=hi")
    talker = start("talker", "--ros-args", *given)
    # The smallest numbers survive the way through YAML; the command line has the last word.
    talker.wait_for("^ready hi 1e-07$")
    # The state was published before there was a listener, which gets it all the same.
    listener = start("listener")
    first = listener.wait_for("^(word|state)")
    other = "state 42" if first.startswith("word") else "word hi"
    listener.wait_for(f"^{other}$")
    assert first in ("word hi\n", "state 42\n")
    talker.wait_for("^answer twice$")
    outputs = []
    for process, number in ((talker, signal.SIGINT), (listener, signal.SIGTERM)):
        code, output = process.end(number)
        assert code == 0, output
        assert "Traceback" not in output
        assert "incompatible" not in output
        outputs.append(output)
    assert "/talker has no parameter tect; did you mean text" in outputs[0]


@pytest.mark.slow
def test_names_and_quality_of_service_can_be_changed_from_outside(start):
    talker = start("talker", "--ros-args", "-r", "word:=phrase", "-r", "__ns:=/other")
    talker.wait_for("^ready")
    override = "qos_overrides./other/phrase.subscription.reliability:=reliable"
    arguments = ("--ros-args", "-r", "__ns:=/other", "-r", "word:=phrase")
    # Reliable asks for more than the talker offers: the override arrives if ROS refuses the pair.
    listener = start("listener", *arguments, "-p", override)
    listener.wait_for("incompatible QoS.*RELIABILITY")
    heard = start("listener", *arguments)
    heard.wait_for("^word hello$")


# The signal comes while the callback runs, which then publishes in a ROS that is no more.
INTERRUPTED = """\
        os.kill(os.getpid(), signal.SIGTERM)
        end = time.monotonic() + 20
        while ok() and time.monotonic() < end:
            time.sleep(0.001)
        assert not ok()
        self.publish_word(String())
"""
MODULES = """\
import os, signal, time
from rclpy.utilities import ok
from std_msgs.msg import String
from .talker_base import TalkerBase
"""


@pytest.mark.parametrize(
    ("body", "code"),
    sweep(
        [
            pytest.param("        raise RuntimeError('a mistake of the user')\n", 1, id="failed"),
            pytest.param(INTERRUPTED, 0, id="interrupted"),
        ],
        every=2,
    ),
)
def test_only_a_failure_of_the_user_is_one(body, code, tmp_path):
    workspace = generate(tmp_path)
    replacements = {
        "from .talker_base import TalkerBase\n": MODULES,
        "        super().on_timer()\n": body,
    }
    fill_in(workspace / "talker" / "talker" / "talker.py", replacements)
    process = Process(workspace, "talker")
    try:
        assert process.popen.wait(PATIENCE) == code
        process.reader.join(PATIENCE)
        output = "".join(iter(process.fresh.get, None))
    finally:
        process.close()
    assert ("a mistake of the user" in output) is (code == 1)
    assert ("Traceback" in output) is (code == 1), output


UNSEEN = """
import sys, threading, time

import rclpy
from listener.main import main

def shut_down_unseen():
    # As a signal does at a bad moment: nobody wakes the executor, which waits already.
    waiting = 0
    while waiting < 3:
        time.sleep(0.05)
        frame = sys._current_frames()[threading.main_thread().ident]
        waiting = waiting + 1 if frame.f_code.co_name == "_wait_for_ready_callbacks" else 0
    context = rclpy.get_default_context()
    with context.handle:
        context.handle.shutdown()
    print("shut down", flush=True)

threading.Thread(target=shut_down_unseen).start()
main()
"""


@pytest.mark.slow
def test_a_shutdown_that_wakes_nobody_is_noticed(workspace):
    environment = {**os.environ, "PYTHONPATH": python_path(workspace)}
    command = [sys.executable, "-c", UNSEEN]
    ended = succeeded(command, env=environment, timeout=PATIENCE)
    assert ended.stdout == "shut down\n"


@pytest.mark.parametrize(
    ("parameter", "words"),
    [("factor:=2.0", "Parameter factor out of range"), ("factor:=1", "expecting type 'DOUBLE'")],
)
def test_a_value_that_does_not_do_is_one_line_and_status_2(workspace, parameter, words):
    done = ran(
        [sys.executable, "-m", "talker.main", "--ros-args", "-p", parameter],
        env={**os.environ, "PYTHONPATH": python_path(workspace)},
        timeout=PATIENCE,
    )
    assert done.returncode == 2, done.stderr
    (line,) = [output for output in done.stderr.splitlines() if "cannot run" in output]
    assert words in line
    assert "Traceback" not in done.stderr
