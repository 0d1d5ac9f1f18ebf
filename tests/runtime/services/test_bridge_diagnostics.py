"""What bridges say on /diagnostics."""

import logging
import time

import pytest

from jausml.runtime import Guard, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.quirks import Quirk
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.diagnosing import LOSS_WINDOW, SLICE
from jausml.runtime.bridge.ends.ends import BridgeSettings
from jausml.runtime.bridge.ends.topics import Topic
from jausml.runtime.bridge.reports.diagnostics import WINDOW, Latency
from jausml.runtime.conversions import Time, time_to_timestamp
from jausml.runtime.messages import (
    ConfirmEventRequest,
    CreateEvent,
    Event,
    ReleaseControl,
    ReportEventTimeout,
    RequestControl,
    Reset,
    Resume,
    SetTime,
)
from jausml.runtime.transports.packets.duplicates import Account
from jausml.runtime.transports.packets.messenger import PeerTraffic
from jausml.runtime.transports.packets.outbox import Outcome
from jausml.runtime.transports.transport import MAX_PEERS

from .bridge_support import (
    CORE,
    OTHER,
    OWN,
    PEER,
    Number,
    command,
    event,
    message_connection,
    minutes,
    obeyed,
    peer_component,
    query,
    safe,
    stopping,
    values,
)


def test_diagnostics_judge_each_connection(world, setting):
    peer_component(world)
    setting.open(event(rate=10.0, silence_timeout=0.5), command(control=Guard.READY))
    world.run(0.05)
    world.run(3.0)
    status = setting.ros.statuses[-1]["timeout"]
    assert (status.level, status.message) == ("ok", "running")
    assert float(values(status)["rate (Hz)"]) == pytest.approx(10.0, abs=1.5)
    assert values(status)["declared rate (Hz)"] == "10.00"
    assert values(status)["peer 1.1.1"] == "confirmed"
    assert values(status)["translation"] == "light classes"
    drive = setting.ros.statuses[-1]["drive"]
    assert (drive.level, drive.message) == ("stale", "no message yet")
    assert values(drive)["peer 1.1.1"] == "ready"
    world.lost = lambda source, *_: source == PEER
    world.run(2.0)
    assert setting.ros.statuses[-1]["timeout"].message == "the source is silent"
    setting.say(99.0, every=1.0)
    drive = setting.ros.statuses[-1]["drive"]
    assert (drive.level, drive.message) == ("warning", "messages are dropped")
    assert any(key.startswith("dropped: ") for key in values(drive))


def test_diagnostics_count_the_reasons_of_stops(world, setting):
    setting.open(obeyed(), services=CORE)
    operator = world.probe("5.1.1")
    for message in (ReleaseControl(), ReleaseControl(), Reset()):
        operator.tell(OWN, RequestControl(authority_code=200), Resume(), minutes(2), message)
        world.run(1.1)
    told = values(setting.ros.statuses[-1]["times"])
    assert {key: value for key, value in told.items() if key.startswith("stopped: ")} == {
        "stopped: no message yet": "1",
        "stopped: control was released": "2",
        "stopped: the bridge is reset": "1",
    }


def test_diagnostics_tell_lapsed_control_from_released(world, setting):
    setting.open(obeyed(), services=CORE)
    operator = world.probe("5.1.1")
    operator.tell(OWN, RequestControl(authority_code=200), Resume(), minutes(2))
    world.run(7.0)
    status = setting.ros.statuses[-1]["times"]
    lapsed = "control lapsed: its client did not request it again in time"
    assert values(status)[f"stopped: {lapsed}"] == "1"
    assert lapsed in setting.bridge.connections[0].forbidden()
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]


def test_diagnostics_tell_what_becomes_of_a_command_without_its_source(world, setting):
    setting.open(
        command("drive", is_command=True, safe_value=safe),
        command("goal", is_command=True, hold_reason="a goal stands until the next one"),
        event(),
    )
    world.run(1.1)
    told = {
        name: values(status).get("when lost") for name, status in setting.ros.statuses[-1].items()
    }
    assert told == {
        "drive": "the stop is sent",
        "goal": "the last message stands (a goal stands until the next one)",
        "timeout": None,
        "jaus state": None,
    }


def test_slow_source_is_told(world, setting):
    peer_component(world, event_rate_max=2.0)
    setting.open(event(rate=10.0))
    world.run(4.0)
    assert setting.ros.statuses[-1]["timeout"].message == "slower than declared"


@pytest.mark.parametrize("rate", [0.1, 0.2, 0.7, 1.0, 10.0])
def test_a_slow_source_that_is_as_declared_is_well(world, setting, rate):
    peer_component(world)
    setting.open(event(rate=rate))
    world.run(60.0, step=0.05)
    told = [status["timeout"] for status in setting.ros.statuses]
    assert {status.message for status in told} <= {"running", "no message yet"}
    assert float(values(told[-1])["rate (Hz)"]) == pytest.approx(rate, rel=0.4)


def test_a_slow_source_that_fell_silent_is_told(world, setting):
    """A provider that confirms the event, but has nothing to report."""
    peer = peer_component(world)
    setting.open(event(rate=0.2))
    world.run(30.0, step=0.05)
    world.lost = lambda _source, _destination, code: code == Event.CODE
    world.run(14.0, step=0.05)
    assert setting.ros.statuses[-1]["timeout"].message == "slower than declared"
    assert peer.running


@pytest.mark.parametrize("make", [event, query])
def test_one_dead_peer_of_two_is_told(world, setting, make):
    peer_component(world)
    other = peer_component(world, OTHER)
    setting.open(make(rate=5.0, peers=[PEER, OTHER]))
    world.run(5.0)
    assert setting.ros.statuses[-1]["timeout"].level == "ok"
    world.lost = lambda source, *_: source == OTHER
    world.run(15.0)
    status = setting.ros.statuses[-1]["timeout"]
    assert (status.level, status.message) == ("warning", "nothing from 1.1.2")
    assert values(status)["peer 1.1.2"] == "asked"
    world.lost = lambda *_: False
    world.run(10.0)
    assert other.running
    assert setting.ros.statuses[-1]["timeout"].level == "ok"


def test_a_peer_that_is_not_there_is_told_while_messages_go_to_it(world, setting):
    """Messages that nobody acknowledges count as passed: they went out."""
    connection = setting.open(command("tell"))
    setting.say(*[5.0] * 70, every=0.1)
    assert connection.statistics.passed == 70
    assert setting.judged("tell") == ("warning", "nothing from 1.1.1")
    world.probe(str(PEER), strict=False)
    setting.say(*[5.0] * 20, every=0.1)
    assert setting.ros.statuses[-1]["tell"].level == "ok"


def test_who_controls_a_peer_instead_or_why_it_refuses_is_told(world, setting):
    peer = peer_component(world)
    rival = world.started("6.1.1", services=())
    session = rival.control(PEER, authority=255)
    world.run(1.0)
    setting.open(command("drive", control=Guard.READY))
    world.run(3.0)
    told = values(setting.ros.statuses[-1]["drive"])
    assert told["peer 1.1.1"] == "refused: 6.1.1 controls 1.1.1"
    session.release()
    rival.set_emergency(PEER)
    world.run(3.0)
    assert peer.status is Status.EMERGENCY
    told = values(setting.ros.statuses[-1]["drive"])
    assert told["peer 1.1.1"] == "refused: 1.1.1 is in EMERGENCY"


def test_reports_that_got_lost_or_came_late_are_told(world, setting):
    peer = world.probe(str(PEER), strict=False)
    connection = setting.open(event(rate=10.0))
    create = next(message for message in peer.take() if isinstance(message, CreateEvent))
    peer.send(
        ConfirmEventRequest(request_id=create.request_id, event_id=4, confirmed_periodic_rate=10.0),
        OWN,
    )
    report = ReportEventTimeout(timeout=1).encode()
    for number in (1, 2, 5, 4, 6):
        peer.send(Event(event_id=4, sequence_number=number, report_message=report), OWN)
    world.run(1.05)
    status = setting.ros.statuses[-1]["timeout"]
    assert (status.level, status.message) == ("warning", "messages are lost")
    assert values(status)["lost on the way"] == "2"
    assert values(status)["out of order"] == "1"
    assert connection.statistics.passed == 4


def test_what_is_dropped_before_any_connection_is_told(world, setting):
    setting.open(message_connection(when=Guard.READY), services=CORE)
    world.run(1.1)
    assert "jaus traffic" not in setting.ros.statuses[-1]
    stranger = world.probe("5.1.1")
    stranger.send_bytes(b"\xfe\xca", OWN)
    world.run(1.0)
    status = setting.ros.statuses[-1]["jaus traffic"]
    assert (status.level, values(status)) == ("ok", {"dropped: component.unknown_message": "1"})
    stranger.send(minutes(1), OWN)
    stranger.send_bytes(SetTime.CODE.to_bytes(2, "little"), OWN)
    world.run(1.0)
    assert setting.judged("jaus traffic") == ("warning", "component.command_refused")
    world.run(1.0)
    status = setting.ros.statuses[-1]["jaus traffic"]
    assert (status.level, status.message) == ("ok", "running")
    assert values(status)["dropped: component.command_refused"] == "2"


def test_diagnostics_keep_their_frequency(world, setting):
    setting.ros.parameters["diagnostics_frequency"] = 5.0
    setting.open(event(rate=1.0))
    world.run(2.0)
    assert 9 <= len(setting.ros.statuses) <= 11


@pytest.mark.parametrize(("frequency", "expected"), [(20.0, 4), (0.5, 2)])
def test_diagnostics_come_once_a_second_at_most(world, setting, frequency, expected):
    bridge = setting.bridge = Bridge(BridgeSettings("bridge", OWN, frequency=frequency))
    bridge.open(setting.ros, world)
    world.run(4.1)
    assert len(setting.ros.statuses) == expected


def test_clock_before_and_after_opening(setting):
    bridge = Bridge(BridgeSettings("bridge", OWN))
    assert bridge.now().sec > 1_700_000_000
    setting.open(command())
    assert setting.bridge.now() == setting.ros.now()


def test_diagnostics_of_many_connections_take_turns_and_come_as_one(world, setting):
    many = 3 * SLICE + 1
    setting.open(*(event(f"e{number}", peers=[]) for number in range(many)))
    world.time += 1.0
    turns = 0
    while not setting.ros.statuses:
        assert world.loop.run_once(0)
        turns += 1
    assert turns >= 3
    (statuses,) = setting.ros.statuses
    assert list(statuses) == [*(f"e{number}" for number in range(many)), "jaus state"]
    world.run(1.1)
    assert len(setting.ros.statuses) == 2


# ------------------------------------------------------------------ losses


def test_losses_of_the_queue_are_told_and_counted(world, setting, caplog):
    connection = setting.open(command())
    setting.say(1.0)
    counts = setting.ros.counts["numbers"]
    counts.lost, counts.missed, counts.too_old = 3, 4, 2
    with caplog.at_level(logging.WARNING, "jausml"):
        world.run(1.1)
    status = setting.ros.statuses[-1]["drive"]
    assert (status.level, status.message) == ("warning", "messages are lost")
    told = values(status)
    assert (told["lost in queue"], told["missed"], told["too old"]) == ("3", "4", "2")
    assert world.counters.drops() == {
        "bridge.drive.lost_in_queue": 3,
        "bridge.drive.missed": 4,
        "bridge.drive.too_old": 2,
    }
    assert len(caplog.records) == 3
    setting.say(1.0, every=1.0)
    assert connection.status().message == "running"
    counts.lost += 1
    setting.bridge.close()
    assert world.counters.drops()["bridge.drive.lost_in_queue"] == 4


def test_what_nobody_hears_is_told_and_no_loss(world, setting):
    peer_component(world)
    setting.open(event(rate=10.0, topics=[Topic("a"), Topic("b")]), event("c", rate=10.0))
    setting.ros.publishers["b"].matched = setting.ros.publishers["c"].matched = 0
    world.run(2.1)
    for name, topic in (("timeout", "b"), ("c", "c")):
        status = setting.ros.statuses[-1][name]
        assert (status.level, status.message) == ("ok", "running")
        unheard = int(values(status)["unheard"])
        assert 10 <= unheard <= len(setting.ros.numbers(topic))
        assert world.counters.snapshot()[f"bridge.{name}.unheard"] == unheard
    assert not setting.ros.publishers["a"].unmatched
    assert "bridge.c.unheard" not in world.counters.drops()


def test_datagrams_that_the_kernel_drops_are_told(world, setting):
    setting.open(command())
    world.run(1.1)
    assert "jaus socket" not in setting.ros.statuses[-1]
    world.counters.count("judp.kernel_dropped", amount=5)
    world.run(1.0)
    status = setting.ros.statuses[-1]["jaus socket"]
    assert (status.level, status.message) == ("warning", "datagrams are lost")
    assert values(status) == {"dropped by the kernel": "5"}
    world.run(1.0)
    assert setting.ros.statuses[-1]["jaus socket"].level == "ok"


# ------------------------------------------------------------------ latency


def latency(status):
    return {key for key in values(status) if key.startswith(("source to", "in the bridge"))}


BRIDGE = {f"in the bridge {word} (us)" for word in ("p50", "p99", "max")}
SOURCE = {f"source to bridge {word} (us)" for word in ("p50", "p99", "max")}


@pytest.mark.parametrize("parameter", ["latency", "drive.latency"])
def test_latency_is_measured_while_it_is_wanted(setting, parameter):
    connection = setting.open(command())
    setting.ros.take["numbers"](Number(1.0).to_cdr(), 1)
    assert latency(connection.status()) == set()
    setting.ros.changed[parameter](True)
    assert latency(connection.status()) == set()
    for _ in range(3):
        setting.ros.take["numbers"](Number(1.0).to_cdr(), time.time_ns() - 10**9)
    told = values(connection.status())
    assert latency(connection.status()) == BRIDGE | SOURCE
    assert 1e6 <= float(told["source to bridge p50 (us)"]) < 1e8
    assert 0 < float(told["in the bridge p50 (us)"]) <= float(told["in the bridge max (us)"])
    assert connection.statistics.passed == 4
    setting.ros.changed[parameter](False)
    assert latency(connection.status()) == set()
    setting.ros.take["numbers"](Number(1.0).to_cdr())
    assert connection.statistics.passed == 5


def test_latency_may_be_wanted_from_the_start(world, setting):
    peer = world.probe(str(PEER))
    setting.ros.parameters |= {"drive.latency": True}
    connection = setting.open(stopping())
    setting.say(1.0, 2.0)
    assert latency(connection.status()) == BRIDGE  # no stamp, no age
    world.run(1.1)
    assert peer.take() == [minutes(0), minutes(1), minutes(2), minutes(0)]


def test_latency_of_messages_with_a_time_stamp(world, setting):
    """What JAUS stamps tells the age; what has no stamp, the time in the bridge alone."""
    setting.ros.parameters["latency"] = True
    peer_component(world)
    setting.open(message_connection(), event(rate=10.0))
    now = time_to_timestamp(Time(*divmod(time.time_ns() - 5 * 10**9, 10**9)))
    stamp = SetTime.TimeStamp(now.milliseconds, now.seconds, now.minutes, now.hour, now.day)
    world.probe("5.1.1").send(SetTime(time_stamp=stamp), OWN)
    world.run(1.1)
    statuses = setting.ros.statuses[-1]
    assert latency(statuses["times"]) == BRIDGE | SOURCE
    assert 5e6 <= float(values(statuses["times"])["source to bridge max (us)"]) < 1e8
    assert latency(statuses["timeout"]) == BRIDGE


def test_percentiles_are_of_the_latest_messages():
    latency = Latency(lambda _data, _origin: None, time.perf_counter)
    for number in range(3 * WINDOW):
        latency._handling.append(number / 1e6)
    assert latency.describe() == [
        ("in the bridge p50 (us)", f"{2 * WINDOW + (WINDOW - 1) // 2}.0"),
        ("in the bridge p99 (us)", f"{2 * WINDOW + (WINDOW - 1) * 99 // 100}.0"),
        ("in the bridge max (us)", f"{3 * WINDOW - 1}.0"),
    ]


def exchanged(came, lost, *, is_exact=False, **outcome):
    account = Account(came=came, is_exact=is_exact, _gone=lost)
    return [PeerTraffic(OWN, PEER, 40, Outcome(**outcome), account)]


def test_each_peer_has_an_account(world, setting):
    setting.open(event())
    world.exchanged = exchanged(came=70, lost=30, acknowledged=3)
    world.run(1.1)
    status = setting.ros.statuses[-1]["account of 1.1.1"]
    assert (status.level, status.message) == ("ok", "30.0 % were lost on the way lately, at most")
    assert values(status)["sent by it"] == "100"
    assert values(status)["lost on the way, at most"] == "30"
    assert values(status)["acknowledged"] == "3"
    world.exchanged = exchanged(came=90, lost=30)
    world.run(LOSS_WINDOW + 1.1)
    world.exchanged = exchanged(came=100, lost=30)
    world.run(1.1)
    status = setting.ros.statuses[-1]["account of 1.1.1"]
    assert status.message == "nothing was lost lately"
    world.run(LOSS_WINDOW + 1.1)
    assert setting.ros.statuses[-1]["account of 1.1.1"].message == "nothing came lately"


def test_what_a_peer_does_otherwise_is_told_with_its_account(world, setting):
    setting.open(event())
    world.exchanged = exchanged(came=0, lost=0, answered=3)
    world.quirks.learn(PEER, Quirk.NO_ACKNOWLEDGEMENTS, "3 answers")
    world.run(1.1)
    told = values(setting.ros.statuses[-1]["account of 1.1.1"])
    assert told["answered, not acknowledged"] == "3"
    assert told["answers, and acknowledges nothing"] == "3 answers: an answer ends the repetition"


def test_few_peers_are_told_of_and_those_with_a_place_first(world, setting):
    setting.open(event())
    strangers = [PeerTraffic(OWN, JausAddress(7, 1, 1 + number)) for number in range(50)]
    world.keep_place(OWN, OTHER)
    world.exchanged = [PeerTraffic(OWN, OTHER), *strangers]
    world.run(1.1)
    told = [name for name in setting.ros.statuses[-1] if name.startswith("account of ")]
    assert len(told) == MAX_PEERS
    assert told[0] == f"account of {OTHER}"
    assert told[-1] == "account of 7.1.50"


@pytest.mark.parametrize(
    ("came", "lost", "level"), [(70, 30, "warning"), (98, 2, "ok"), (960, 40, "ok")]
)
def test_much_that_surely_was_lost_is_a_warning(world, setting, came, lost, level):
    setting.open(event())
    world.exchanged = exchanged(came, lost, is_exact=True)
    world.run(1.1)
    status = setting.ros.statuses[-1]["account of 1.1.1"]
    share = 100 * lost / (came + lost)
    assert (status.level, status.message) == (level, f"{share:.1f} % were lost on the way lately")
    assert values(status)["numbered"] == "by destination: what was lost is exact"


def test_a_report_that_is_half_done_ends_with_the_bridge(world, setting):
    setting.open(*(event(f"event {number}") for number in range(2 * SLICE + 1)))
    world.time += 1.0
    world.loop.run_once(0)
    setting.bridge.close()
    reported = len(setting.ros.statuses)
    world.settle()
    assert len(setting.ros.statuses) == reported
