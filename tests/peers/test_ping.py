"""`jausml ping` against running components, in this process and in others."""

import json
import os
import signal
import subprocess

import pytest
import warm

from jausml.live.peers.measuring import Pings, spread_of
from jausml.runtime.base.address import JausAddress

pytestmark = pytest.mark.ports


def test_answers_and_a_summary_are_shown(jausml, vehicle):
    vehicle()
    result = jausml("ping", "100.1.1", "--count", "3", "--interval", "0.01")
    assert result.exit_code == 0, result.stderr
    first, *answers, counts, figures = result.stdout.splitlines()
    assert first == "100.1.1: QueryHeartbeatPulse every 0.01 s"
    assert [answer.partition(":")[2].split()[1] for answer in answers] == ["1:", "2:", "3:"]
    assert all(answer.endswith(" ms") for answer in answers)
    assert counts == "3 asked, 3 answered, 0.0% lost"
    assert figures.startswith("round trip in ms: min ")


def test_json_has_one_object_a_line(jausml, vehicle):
    vehicle()
    result = jausml("ping", "100.1.1", "-c", "2", "-i", "0.01", "--format", "json")
    first, second, summary = map(json.loads, result.stdout.splitlines())
    assert (first["question"], second["question"]) == (1, 2)
    assert first["milliseconds"] > 0
    assert set(summary["milliseconds"]) == {"min", "median", "p99", "max"}
    assert {**summary, "milliseconds": None} == {
        "component": "100.1.1",
        "message": "QueryHeartbeatPulse",
        "sent": 2,
        "answered": 2,
        "loss": 0.0,
        "milliseconds": None,
    }


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (("Transport", "Events", "Discovery"), "QueryIdentification"),
        (("Transport", "Events", "AccessControl", "Management"), "QueryStatus"),
        (("Transport", "Events", "AccessControl"), "QueryControl"),
    ],
)
def test_a_question_is_chosen_that_the_component_answers(jausml, component, names, expected):
    component(names=names)
    result = jausml("ping", "100.1.1", "-c", "1", "--timeout", "1")
    assert result.exit_code == 0, result.output
    assert f"100.1.1: {expected} every" in result.stdout


def test_the_question_may_be_given(jausml, vehicle):
    vehicle()
    result = jausml("ping", "100.1.1", "-c", "1", "--question", "status")
    assert "QueryStatus" in result.stdout


def test_nobody_there_is_exit_status_1_with_a_hint(jausml):
    result = jausml("ping", "100.1.1", "-c", "1", "--timeout", "0.2")
    assert result.exit_code == 1
    assert "0 asked, 0 answered" in result.stdout
    assert "--interface" in result.stderr


def test_a_question_without_an_answer_is_lost(jausml, component):
    component(names=("Transport", "Events", "Discovery"))
    words = ("-c", "2", "-i", "0.01", "--timeout", "0.1", "--question", "status")
    result = jausml("ping", "100.1.1", *words)
    assert result.exit_code == 1
    assert "question 2: no answer within 0.1 s" in result.stdout
    assert "2 asked, 0 answered, 100.0% lost" in result.stdout


@pytest.mark.parametrize("words", [("100.1",), ("255.1.1.1",), ("100.1.255",), ()])
def test_what_is_no_component_is_refused(jausml, words):
    assert jausml("ping", *words).exit_code == 2


def test_ctrl_c_ends_with_the_summary(vehicle, free_port):
    vehicle()
    process = subprocess.Popen(
        [*warm.command(), "ping", "100.1.1", "-i", "0.02", "--port", str(free_port)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    try:
        for _ in range(4):
            assert "100.1.1" in process.stdout.readline()
        process.send_signal(signal.SIGINT)
        rest, errors = process.communicate(timeout=20)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 0, errors
    assert "0.0% lost" in rest


# ------------------------------------------------------------------ figures


def test_figures_of_times():
    spread = spread_of([0.001 * number for number in range(1, 201)])
    assert spread.count == 200
    assert spread.milliseconds() == {"min": 1.0, "median": 100.0, "p99": 198.0, "max": 200.0}
    assert spread_of([0.5]).milliseconds() == dict.fromkeys(("min", "median", "p99", "max"), 500.0)
    assert spread_of([]) is None


def test_counts_of_pings():
    pings = Pings([0.1, None, 0.2, None])
    assert (pings.sent, pings.answered, pings.loss) == (4, 2, 0.5)
    assert Pings().loss == 0.0


def test_the_address_of_another_is_not_taken_for_the_target(jausml, vehicle):
    vehicle()
    result = jausml("ping", JausAddress(100, 1, 2), "-c", "1", "--timeout", "0.2")
    assert result.exit_code == 1


def test_an_interrupt_before_a_question_is_chosen_ends_it(jausml, monkeypatch):
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("jausml.live.peers.measuring.answered_question", interrupted)
    result = jausml("ping", "100.1.1")
    assert (result.exit_code, result.stdout) == (1, "0 asked, 0 answered, 0.0% lost\n")
