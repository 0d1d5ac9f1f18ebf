"""States of connections: the function that decides, and each cell of the table in the how-to."""

import logging
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime import ComponentSettings, Guard
from jausml.runtime import messages as core
from jausml.runtime.base.counters import LOGGER
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.connections.events_to_ros import EventToTopics
from jausml.runtime.bridge.connections.queries_to_ros import QueryToTopics
from jausml.runtime.bridge.ends.ends import BridgeSettings
from jausml.runtime.bridge.ends.topics import Topic
from jausml.runtime.bridge.reports.states import (
    INTERVAL,
    LEVELS,
    ConnectionPhase,
    Facts,
    Judgement,
    StateLog,
    StopReason,
    judge,
)

from .bridge_support import (
    CORE,
    OTHER,
    OWN,
    PEER,
    Number,
    command,
    message_connection,
    minutes,
    obeyed,
    report,
    safe,
    values,
)

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "top.md"


def rows(title):
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    (start,) = [i for i, line in enumerate(lines) if line.startswith(f"| {title} |")]
    for line in lines[start:]:
        if not line.startswith("|"):
            return
        cells = [word.strip().strip("`") for word in line.strip("|").split("|")]
        if set(cells) != {"---"}:
            yield cells


HEAD, *TABLE = rows("what happens")
CELLS = [
    (happens, kind, told)
    for happens, *row in TABLE
    for kind, told in zip(HEAD[1:], row, strict=True)
]


# ------------------------------------------------------------------ the function


@pytest.mark.parametrize(
    ("facts", "phase", "reason"),
    [
        (Facts(), "active", "running"),
        (Facts(is_heard=False), "waiting", "no message yet"),
        (Facts(stopped=StopReason.START), "waiting", "no message yet"),
        (Facts(lacking="searching a", stopped=StopReason.SILENCE), "waiting", "searching a"),
        (Facts(stopped=StopReason.SILENCE), "silent", "the source is silent"),
        (Facts(stopped=StopReason.SILENCE, is_heard=False), "waiting", "no message yet"),
        (Facts(stopped=StopReason.STANDBY), "waiting",
            "no message since the stop: the bridge stands by"),
        (Facts(stopped=StopReason.INACTIVE, is_heard=False), "waiting", "no message yet"),
        (Facts(stopped=StopReason.INACTIVE, is_heard=False, forbidden="e"), "refused", "e"),
        (Facts(stopped=StopReason.CLOCK), "silent", "nobody says the time on /clock"),
        (Facts(stopped=StopReason.EMERGENCY, forbidden="e", failing="f"), "refused", "e"),
        (Facts(forbidden="e", is_heard=False), "refused", "e"),
        (Facts(stopped=StopReason.SILENCE, failing="f"), "failed", "f"),
        (Facts(refusal="no peer obeys", complaint="slow"), "refused", "no peer obeys"),
        (Facts(complaint="slow"), "degraded", "slow"),
        (Facts(fault="qos", stopped=StopReason.START), "degraded", "qos"),
        (Facts(error="values", fault="qos"), "failed", "values"),
    ],
)  # fmt: skip
def test_what_facts_mean(facts, phase, reason):
    assert judge(facts) == (ConnectionPhase(phase), reason)


TEXTS = st.sampled_from(["", "a reason"])


@given(
    st.builds(
        Facts, TEXTS, TEXTS, TEXTS, TEXTS, st.none() | st.sampled_from(StopReason), TEXTS,
        st.booleans(), TEXTS, TEXTS,
    )
)  # fmt: skip
def test_all_facts_have_one_state_with_a_reason(facts):
    judged = judge(facts)
    assert judged == judge(facts)
    assert judged.reason
    assert judged.level == LEVELS[judged.phase]
    is_well = facts == Facts(is_heard=True)
    assert (judged.phase is ConnectionPhase.ACTIVE) is is_well


def test_the_page_has_each_state_with_its_level():
    words = {"stale": "STALE", "ok": "OK", "warning": "WARN", "error": "ERROR"}
    told = {state: level for state, level, _ in list(rows("state"))[1:]}
    assert told == {phase.value: words[level] for phase, level in LEVELS.items()}


def test_the_log_tells_changes_and_not_each_of_many(caplog):
    log = StateLog("pose")
    active = Judgement(ConnectionPhase.ACTIVE, "running")
    silent = Judgement(ConnectionPhase.SILENT, "the source is silent")
    with caplog.at_level(logging.INFO, LOGGER.name):
        log.note(Judgement(ConnectionPhase.WAITING, "no message yet"), 1.0)
        for second in range(int(2 * INTERVAL)):
            log.note((active, silent)[second % 2], 10.0 + second)
        log.note(silent, 10.0 + 3 * INTERVAL)
    assert [(record.levelname, record.message) for record in caplog.records] == [
        ("INFO", "pose is active: running"),
        ("WARNING", "pose is silent: the source is silent"),
    ]


def test_the_log_tells_once_for_whom_a_connection_waits(caplog):
    log = StateLog("pose")
    with caplog.at_level(logging.INFO, LOGGER.name):
        log.note(Judgement(ConnectionPhase.WAITING, "no message yet"), 1.0)
        for second in range(2, 20):
            log.note(Judgement(ConnectionPhase.WAITING, "100.1.1 does not answer"), float(second))
    assert [record.message for record in caplog.records] == [
        "pose is waiting: 100.1.1 does not answer"
    ]


# ------------------------------------------------------------------ the table


def connection_of(kind, scene):
    """A connection named `c`; nothing can be translated while the scene says 0."""

    def number(report):
        return Number(report.timeout / scene.number)

    def number_of_time(message):
        return Number(message.time_stamp.minutes / scene.number)

    def time_of_number(source):
        return core.ReportTime(time_stamp=core.ReportTime.TimeStamp(minutes=int(1 / source.data)))

    def order(source):
        return minutes(int(1 / source.data))

    asked = {"type": Number, "topics": [Topic("c")], "peers": [PEER], "silence_timeout": 1.0}
    asked |= {"query": core.QueryEventTimeout(), "message": core.ReportEventTimeout, "rate": 10.0}
    stops = {"silence_timeout": 1.0, "is_command": True}
    made = {
        "event": lambda: EventToTopics("c", number, **asked),
        "query": lambda: QueryToTopics("c", number, **asked),
        "message": lambda: message_connection(number_of_time, silence_timeout=1.0),
        "report": lambda: report("c", time_of_number, freshness=1.0),
        "command to ROS": lambda: obeyed(number_of_time, **stops),
        "command to JAUS": lambda: command(
            "c", control=Guard.READY, safe_value=safe, translate=order, **stops
        ),
    }[kind]()
    made.name = "c"
    return made


class Scene:
    """A bridge with one connection, its source, its peer and an operator who controls it."""

    def __init__(self, world, setting, kind):
        self.world, self.setting, self.kind = world, setting, kind
        self.operator = world.probe("5.1.1", strict=False)
        self.sensor = world.probe("6.1.1", strict=False)
        self.number = 1
        self.peer = None
        self.arrive()
        self.keeps_control = True
        setting.open(connection_of(kind, self), services=CORE)
        self.take_control(self.operator, 100)

    def arrive(self):
        self.peer = self.world.component(str(PEER), services=CORE)
        self.peer.handle(core.SetTime, lambda *_: None, when=Guard.READY)
        self.peer.start()

    def renew(self):
        """Keeps control, as operators do."""
        if self.keeps_control:
            self.operator.send(core.RequestControl(authority_code=100), OWN)

    def take_control(self, who, authority):
        who.send(core.RequestControl(authority_code=authority), OWN)
        self.world.settle()
        who.send(core.Resume(), OWN)
        self.world.settle()

    def pass_time(self, seconds, *, feeds=True):
        for turn in range(round(seconds / 0.25)):
            if turn % 4 == 0:
                self.renew()
            if feeds:
                self.feed()
            self.world.run(0.25, step=0.05)

    def feed(self):
        if self.kind in ("report", "command to JAUS"):
            self.setting.ros.deliver["numbers"](Number(float(self.number)))
        elif self.kind == "message":
            self.sensor.send(minutes(1), OWN)
        elif self.kind == "command to ROS":
            self.operator.send(minutes(1), OWN)

    def come(self):
        self.pass_time(3.0)

    def fall_silent(self):
        self.come()
        if self.kind in ("event", "query"):
            self.world.lost = lambda source, *_: source == PEER
        self.pass_time(3.0, feeds=False)

    def speak_again(self):
        self.fall_silent()
        self.world.lost = lambda *_: False
        self.pass_time(8.0)

    def say_nothing_usable(self):
        self.number = 0
        self.pass_time(3.0)

    def deactivate(self):
        self.come()
        self.setting.bridge.set_active(False)
        self.pass_time(2.0)

    def activate(self):
        self.deactivate()
        self.keeps_control = False
        self.setting.bridge.set_active(True)
        self.pass_time(8.0)

    def emergency(self):
        self.come()
        self.operator.send(core.SetEmergency(), OWN)
        self.pass_time(2.0)

    def stand_by(self):
        self.come()
        self.operator.send(core.Standby(), OWN)
        self.pass_time(2.0)

    def release(self):
        self.come()
        self.keeps_control = False
        self.operator.send(core.ReleaseControl(), OWN)
        self.pass_time(2.0)

    def take_over(self):
        self.come()
        self.keeps_control = False
        other = self.world.probe(str(OTHER), strict=False)
        other.send(core.RequestControl(authority_code=200), OWN)
        self.pass_time(2.0)

    def lose_peer(self):
        self.come()
        self.world.lost = lambda source, target, _: PEER in (source, target)
        self.pass_time(20.0)

    def find_peer(self):
        self.lose_peer()
        self.world.lost = lambda *_: False
        self.pass_time(12.0)

    def reopen(self):
        self.come()
        self.keeps_control = False
        setting = self.setting
        setting.bridge.close()
        self.world.settle()
        setting.ros.made.clear()
        setting.bridge = Bridge(
            BridgeSettings(
                "bridge", OWN, services=CORE, component=ComponentSettings(register_services=False)
            )
        )
        setting.bridge.connections = [connection_of(self.kind, self)]
        setting.bridge.open(setting.ros, self.world)
        self.pass_time(8.0)


HAPPENINGS = {
    "nothing came yet": lambda scene: scene.pass_time(1.5, feeds=False),
    "messages come": Scene.come,
    "the source falls silent": Scene.fall_silent,
    "it speaks again": Scene.speak_again,
    "nothing that comes can be translated": Scene.say_nothing_usable,
    "the node is deactivated": Scene.deactivate,
    "it is activated again": Scene.activate,
    "emergency": Scene.emergency,
    "Standby by the controller": Scene.stand_by,
    "the controller releases the bridge": Scene.release,
    "another component takes control": Scene.take_over,
    "the peer is gone": Scene.lose_peer,
    "the peer is back": Scene.find_peer,
    "the bridge is closed and opened": Scene.reopen,
}


def test_the_table_has_each_of_them():
    assert [row[0] for row in TABLE] == list(HAPPENINGS)


@pytest.mark.parametrize(("happens", "kind", "told"), CELLS)
def test_states_of_the_table(world, setting, happens, kind, told):
    if happens == "nothing came yet" and kind in ("event", "query"):
        world.lost = lambda source, *_: source == PEER
    scene = Scene(world, setting, kind)
    HAPPENINGS[happens](scene)
    status = setting.ros.statuses[-1]["c"]
    assert (values(status)["state"], status.level) == (told, LEVELS[ConnectionPhase(told)])
    assert next(iter(values(status))) == "state"
