"""`jausml latency` against running components, and the figures that it shows."""

import json
import time
from datetime import datetime, timezone
from pathlib import Path

import pytest

from jausml.language.model import read_models
from jausml.live.peers.entry_messages import message_class
from jausml.live.peers.measuring import ReportTimes, reports_of
from jausml.runtime.base.address import JausAddress

from .test_top import MODEL

TARGET = JausAddress(100, 1, 1)
ROOT = Path(__file__).resolve().parents[2]


def stamp(seconds):
    """Fields of a TimeStamp of an instant."""
    moment = datetime.fromtimestamp(seconds, timezone.utc)
    return {
        "Milliseconds": moment.microsecond // 1000,
        "Seconds": moment.second,
        "Minutes": moment.minute,
        "Hour": moment.hour,
        "Day": moment.day,
    }


@pytest.fixture
def stamped(component, catalogue):
    """Starts a component whose velocity has a TimeStamp of 50 ms ago."""
    made = component(services=("mobility:VelocityStateSensor",))
    report = message_class(catalogue.message("ReportVelocityState"))
    made.provide(
        message_class(catalogue.message("QueryVelocityState")),
        report,
        lambda *_: report(
            {"ReportVelocityStateRec": {"Velocity_X": 1.0, "TimeStamp": stamp(time.time() - 0.05)}}
        ),
    )
    return made


@pytest.mark.ports
@pytest.mark.usefixtures("stamped")
def test_rate_age_and_round_trip_are_measured(jausml):
    words = ("--rate", "25", "--duration", "1", "--interval", "0.1", "--format", "json")
    result = jausml("latency", "100.1.1", "VelocityState", *words)
    assert result.exit_code == 0, result.output
    (found,) = json.loads(result.stdout)["reports"]
    assert (found["component"], found["report"]) == ("100.1.1", "ReportVelocityState")
    assert found["reports"] > 1
    assert found["rate"] > 0
    assert found["queries"] > found["unanswered"]
    assert found["fault"] is None
    times = found["milliseconds"]
    assert times["age"]["min"] >= 49
    assert times["query"]["median"] > 0
    assert times["jitter"]["min"] >= 0


@pytest.mark.ports
@pytest.mark.usefixtures("stamped")
def test_every_report_of_a_component_is_shown_as_a_table(jausml):
    result = jausml("latency", "100.1.1", "--rate", "20", "--duration", "0.5")
    assert result.exit_code == 0, result.output
    head, under, *rows = result.stdout.splitlines()
    assert " ".join(head.split()) == "component report reports Hz jitter age query lost"
    assert under.split() == ["median", "p99"] * 3
    assert [row.split()[:2] for row in rows] == [["100.1.1", "ReportVelocityState"]]


@pytest.mark.ports
@pytest.mark.usefixtures("stamped")
def test_a_model_names_components_and_reports(jausml, refused, tmp_path, monkeypatch):
    model = tmp_path / "speed.ros2jaus"
    model.write_text(MODEL, encoding="utf-8")
    result = jausml("latency", model, "--duration", "0.5", "--format", "json")
    assert result.exit_code == 0, result.output
    (found,) = json.loads(result.stdout)["reports"]
    assert (found["component"], found["report"]) == ("100.1.1", "ReportVelocityState")
    assert jausml("latency", model, "VelocityState").exit_code == 2
    monkeypatch.chdir(tmp_path)
    refused("Missing argument 'ID|MODEL': no project is here", "latency", "--duration", "0.5")
    (tmp_path / ".project").write_text("<projectDescription/>", encoding="utf-8")
    result = jausml("latency", "--duration", "0.5")
    assert result.exit_code == 0, result.output
    assert "100.1.1    ReportVelocityState" in result.stdout


@pytest.mark.ports
def test_a_report_that_never_comes_is_exit_status_1(jausml, component):
    component(services=("mobility:VelocityStateSensor",))
    words = ("--duration", "0.2", "--timeout", "0.2")
    result = jausml("latency", "100.1.1", "VelocityState", *words)
    assert result.exit_code == 1, result.output
    assert "100.1.1 ReportVelocityState: no event" in result.stderr
    assert result.stdout.splitlines()[-1].split()[2:4] == ["0", "-"]


@pytest.mark.ports
def test_nobody_there_is_exit_status_2(refused):
    refused("--interface", "latency", "100.1.1", "--timeout", "0.2")


@pytest.mark.parametrize("source", ["nothing.xmi", "100.1", "100.1.255"])
def test_what_is_no_source_is_refused(refused, source):
    refused("is no file, and no JAUS id", "latency", source)


def test_a_model_with_errors_is_refused(jausml, tmp_path):
    model = tmp_path / "bad.xmi"
    model.write_text("<nothing/>")
    result = jausml("latency", model)
    assert result.exit_code == 1
    assert "bad.xmi:1:1: JML101 root element" in result.stderr


def test_reports_of_a_model():
    model = read_models([ROOT / "models" / "catvehicle" / "catvehicle.xmi"]).model
    vehicle, own = JausAddress(100, 1, 1), JausAddress(100, 1, 2)
    assert reports_of(model) == [
        (vehicle, "ReportVelocityState"),
        (vehicle, "ReportWrenchEffort"),
        (vehicle, "ReportLocalPose"),
        (own, "ReportLocalPose"),
    ]


# ------------------------------------------------------------------ figures


@pytest.fixture
def stream(catalogue):
    query, report = map(catalogue.message, ("QueryVelocityState", "ReportVelocityState"))
    return ReportTimes(TARGET, query, report)


def test_rate_and_jitter_of_arrivals(stream):
    stream.arrivals = [(arrival_time, 0.0, b"") for arrival_time in (0.0, 0.1, 0.2, 0.35, 0.4)]
    assert stream.rate == pytest.approx(10.0)
    assert stream.jitter.median == pytest.approx(0.0, abs=1e-9)
    assert stream.jitter.greatest == pytest.approx(0.05)
    assert stream.ages is None


def test_one_report_has_no_rate(stream):
    stream.arrivals = [(0.0, 0.0, b"")]
    assert stream.rate is None
    assert stream.jitter is None


@pytest.mark.parametrize("age", [0.25, -0.5, 0.0])
def test_age_at_the_turn_of_a_month(stream, age):
    arrived = datetime(2026, 3, 1, 0, 0, 0, 100_000, timezone.utc).timestamp()
    fields = {"ReportVelocityStateRec": {"TimeStamp": stamp(round(arrived - age, 3))}}
    stream.arrivals = [(0.0, arrived, stream.report.encode(fields)), (0.0, arrived, b"\x01")]
    assert stream.ages.count == 1
    assert stream.ages.median == pytest.approx(age, abs=1e-6)
