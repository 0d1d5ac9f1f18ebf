"""The conformance checks pass good components and find each fault by the check that names it."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from ports import free_port

from jausml.live.peers.conformance.access import requires
from jausml.live.peers.conformance.client import Client
from jausml.live.peers.conformance.evidence import Verdict, describe
from jausml.live.peers.conformance.run import (
    TargetNotReached,
    all_groups,
    fixed_checks,
    opened,
    run,
)
from jausml.live.peers.conformance.session import Limits
from jausml.live.peers.network import make_network
from jausml.runtime import JausComponent, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import ClearEmergency, SetEmergency
from jausml.runtime.services.definitions import Status
from tests.peers.peer import FaultyPeer

pytestmark = pytest.mark.ports

TARGET = JausAddress(100, 1, 1)
QUICK = {"timeout": 0.4, "quiet": 0.06}

FAULTS = {
    "acks with payload": "transport.ack-empty",
    "acks another number": "transport.ack-sequence",
    "acks twice": "transport.ack",
    "acks as last fragment": "transport.ack-flags",
    "acks everything": "transport.no-ack",
    "acks duplicates never": "transport.duplicate-ack",
    "takes duplicates": "transport.duplicate",
    "reads version 3": "transport.version",
    "needs the broadcast flag": "transport.wildcard-destination",
    "answers for others": "transport.other-destination",
    "answers the unknown": "transport.unknown-message",
    "reads no fragments": "transport.fragments",
    "counts nothing": "transport.sequence-numbers",
    "appends garbage": "transport.well-formed",
    "dies of truncated bodies": "transport.truncated-bodies",
    "dies of short datagrams": "transport.short-datagrams",
    "identifies as another scope": "discovery.identification",
    "lists differ": "discovery.service-list",
    "has no pulse": "liveness.pulse",
    "confirms another request": "events.create-periodic",
    "reports before it confirms": "events.confirm-first",
    "sends the query back": "events.report",
    "numbers all events as one": "events.sequence",
    "sends too often": "events.rate",
    "ignores unknown events": "events.update-unknown",
    "rejects with another code": "events.unsupported-message",
    "takes any event type": "events.unknown-type",
    "goes on after cancel": "events.cancel",
    "lists no events": "events.query-all",
    "lists all events": "events.query-by-id",
    "confirms any cancellation": "events.cancel-unknown",
    "reports another authority": "access.uncontrolled",
    "takes any authority": "access.insufficient",
    "equal preempts": "access.equal-authority",
    "lower preempts": "access.lower-authority",
    "preempts in silence": "access.preemption",
    "released by anybody": "access.release-by-other",
    "authority by anybody": "access.set-authority-by-other",
    "authority raised": "access.set-authority-raised",
    "never lapses": "access.timeout",
    "lapses early": "access.timeout",
    "renews no control": "access.timeout-renewed",
    "releases in silence": "access.release-uncontrolled",
    "stays ready": "management.release-ends-ready",
    "obeys anybody": "management.resume-by-other",
    "ignores emergencies": "management.emergency",
    "keeps its controller in emergency": "management.emergency-ready",
    "controlled in emergency": "management.emergency-no-control",
    "resumes in emergency": "management.emergency-resume",
    "resets in emergency": "management.emergency-reset",
    "cleared by anybody": "management.clear-by-other",
    "first clears all": "management.emergency-two-clients",
    "clears to ready": "management.clear",
    "trailing bytes": "codecs.Management.QueryStatus",
}


def only(*ids):
    """Returns the groups with some of their checks."""

    def chosen(group):
        return replace(
            group,
            requires=lambda _: "",
            checks=lambda session: tuple(c for c in group.checks(session) if c.id in ids),
        )

    return [chosen(group) for group in all_groups()]


def verdicts(report):
    return {result.check.id: result.verdict for result in report.results}


def failures(report):
    return {r.check.id: r.messages for r in report.results if r.verdict is Verdict.FAIL}


def skipped(report):
    return {r.check.id for r in report.results if r.verdict is Verdict.SKIPPED}


@pytest.fixture(scope="module")
def found(catalogue):
    """The verdict of the named check on each fault; the faulty peers are tested side by side."""
    assert catalogue.messages  # made once, not by several threads

    def test(fault):
        port = free_port()
        network = make_network("65000.1.1", "127.0.0.1", port, "239.255.0.1", [])
        peer = FaultyPeer(TARGET, port, fault)
        try:
            with opened(network, TARGET, catalogue, timeout=0.8, quiet=0.15) as session:
                return verdicts(run(session, only(FAULTS[fault]), lambda _: None))
        finally:
            peer.close()

    with ThreadPoolExecutor(8) as pool:
        return dict(zip(FAULTS, pool.map(test, FAULTS), strict=True))


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_by_the_check_that_names_it(fault, found):
    assert found[fault] == {FAULTS[fault]: Verdict.FAIL}


@pytest.mark.slow
def test_who_does_not_say_who_controls_it_is_judged_by_what_it_grants(peer, network, catalogue):
    peer("says not who controls it")
    groups = [g for g in all_groups() if g.name == "access"]
    with opened(network, TARGET, catalogue, **QUICK) as session:
        report = run(session, groups, lambda _: None)
    first, *others = report.results
    assert first.verdict is Verdict.FAIL
    assert first.messages == ("QueryControl is not answered with ReportControl",)
    assert first.evidence
    found = {other.check.id: other for other in others}
    assert found["access.request"].messages == (
        "who has control is not seen, for QueryControl is not answered",
    )
    assert found["access.preemption"].verdict is Verdict.NOTE
    assert Verdict.FAIL not in {other.verdict for other in others}


@pytest.mark.parametrize("default", [150, 256])
def test_authority_that_is_not_told_is_found_by_asking_with_more(peer, network, catalogue, default):
    target = peer("says not who controls it", "says not which authority")
    target.authority = target.default = default
    with opened(network, TARGET, catalogue, **QUICK) as session:
        report = run(session, only("access.request", "management.resume"), lambda _: None)
        is_refused = default > 255
        assert session.sufficient == (255 if is_refused else 205)
        if is_refused:
            assert "insufficient authority, even with 255" in requires(session)
        else:
            assert requires(session) == ""
            assert set(verdicts(report).values()) <= {Verdict.PASS, Verdict.NOTE}


def test_a_target_that_answers_no_query_fails(peer, network, catalogue):
    peer("answers nothing")
    groups = [g for g in all_groups() if g.name == "transport"]
    with opened(network, TARGET, catalogue, timeout=0.15, quiet=0.05) as session:
        report = run(session, groups, lambda _: None)
    assert failures(report).keys() == {"transport.ack"}
    assert not report.passed


def test_a_target_that_lists_each_id_is_asked_for_no_unknown_one(catalogue, network, free_port):
    class Crowd(FaultyPeer):
        def listed(self, kind, names, seq=False):
            nodes = super().listed(kind, names, seq=True)
            (own,) = nodes[0].component_list
            nodes[0].component_list += [
                kind.ComponentSeq(kind.ComponentRec(number, 0), own.service_list[:1])
                for number in range(2, 255)
            ]
            return nodes if seq else kind(node_list=nodes)

    peer = Crowd(TARGET, free_port)
    try:
        with opened(network, TARGET, catalogue, **QUICK) as session:
            report = run(session, only("discovery.services-unknown"), lambda _: None)
    finally:
        peer.close()
    assert skipped(report) == {"discovery.services-unknown"}


def test_without_faults_the_same_checks_pass(peer, network, catalogue):
    peer()
    with opened(network, TARGET, catalogue, **QUICK) as session:
        report = run(session, only(*FAULTS.values()), lambda _: None)
    assert verdicts(report) == dict.fromkeys(FAULTS.values(), Verdict.PASS), failures(report)


@pytest.mark.slow
def test_a_component_of_ours_has_no_failures(component, network, catalogue):
    target = component(default_authority=5)
    with opened(network, TARGET, catalogue, **QUICK) as session:
        report = run(session, all_groups(), lambda _: None)
    assert failures(report) == {}
    assert skipped(report) == {
        "codecs.ListManager.QueryElement",
        "events.sequence-wrap",
        "events.timeout",
        "list.elements",
        "management.shutdown",
        "management.shutdown-by-other",
    }
    assert report.count(Verdict.NOTE) == 0
    codecs = [r.check for r in report.results if r.check.group == "codecs"]
    assert {c.explanation.partition(".")[0] for c in codecs} == {
        "Sends the query and decodes its report"
    }
    assert not target.elements
    assert target.status is Status.STANDBY
    assert target.controller is None


def test_a_component_of_ours_of_version_1_0_has_no_failures(component, network, catalogue):
    component(version=0)
    with opened(network, TARGET, catalogue, **QUICK) as session:
        report = run(session, [g for g in all_groups() if g.name == "management"], lambda _: None)
    assert failures(report) == {}
    notes = {r.check.id for r in report.results if r.verdict is Verdict.NOTE}
    assert notes == {"management.clear-after-ready"}


def test_destructive_checks_run_last_and_only_when_allowed(component, network, catalogue):
    target = component()
    groups = [g for g in all_groups() if g.name in ("management", "liveness")]
    with opened(network, TARGET, catalogue, limits=Limits(destructive=True), **QUICK) as session:
        report = run(session, groups, lambda _: None)
    assert [r.check.id for r in report.results][-1] == "management.shutdown"
    assert failures(report) == {}
    assert target.status is Status.SHUTDOWN


def test_a_target_that_somebody_else_controls_is_left_alone(component, network, catalogue):
    target = component(control_timeout=0)
    groups = [g for g in all_groups() if g.name in ("access", "management")]
    with opened(network, TARGET, catalogue, **QUICK) as session:
        session.probe.client(9).send(_request(200))
        report = run(session, groups, lambda _: None)
    assert set(verdicts(report).values()) == {Verdict.SKIPPED}
    assert "65000.1.10 controls the target" in report.results[0].messages[0]
    assert target.controller == JausAddress(65000, 1, 10)


def test_an_interrupted_run_leaves_the_target_as_it_was(component, network, catalogue):
    target = component()

    def interrupt(result):
        if result.check.id == "management.emergency-no-control":
            raise KeyboardInterrupt

    groups = [g for g in all_groups() if g.name == "management"]
    with opened(network, TARGET, catalogue, **QUICK) as session:
        report = run(session, groups, interrupt)
    assert report.interrupted
    assert not report.passed
    assert target.status is Status.STANDBY
    assert target.controller is None


def test_an_absent_target_is_told_with_what_to_check(network, catalogue):
    with (
        pytest.raises(TargetNotReached, match=r"100\.1\.1 does not answer.*--interface"),
        opened(network, TARGET, catalogue, timeout=0.05, quiet=0.05),
    ):
        pass


def test_every_check_has_an_id_of_its_own_and_says_what_it_is():
    checks = fixed_checks()
    assert len({check.id for check in checks}) == len(checks)
    assert all(check.explanation and check.title and check.source for check in checks)
    assert {check.group for check in checks} == {g.name for g in all_groups()} - {"codecs"}


def _request(authority):
    from jausml.runtime.messages import RequestControl

    return RequestControl(authority_code=authority)


@pytest.mark.parametrize("cranes", [0, 222], ids=["in one packet", "in several packets"])
def test_services_of_a_target_without_discovery_come_from_its_subsystem(
    component, network, catalogue, cranes
):
    server = component()
    target = JausAddress(100, 1, 2)
    names = ["core:Events", "core:Liveness", "acme:Winch"]
    names += [f"acme:Crane{number}" for number in range(cranes)]
    services = [ServiceIdentity(f"urn:jaus:jss:{name}", 1, 1) for name in names]
    other = JausComponent(server.transport, target, name="other", services=services)
    other.start()
    groups = [g for g in all_groups() if g.name in ("liveness", "codecs")]
    try:
        with opened(network, target, catalogue, **QUICK) as session:
            report = run(session, groups, lambda _: None)
    finally:
        other.stop()
    assert report.services == tuple(f"{service.urn} 1.1" for service in services)
    assert verdicts(report)["liveness.event"] is Verdict.PASS
    (winch,) = [r for r in report.results if r.check.id == "codecs.Winch"]
    assert winch.check.explanation.startswith("The layouts of the service are not known")
    assert winch.messages == ("the library lacks it; --model FILE adds a service",)


@pytest.mark.parametrize(
    ("payload", "text"),
    [
        ("024002000000", "ReportStatus, not decodable"),
        ("02400200000000", "ReportStatus(status=2, reserved=0)"),
        ("0544010000", "message 4405"),
        ("03", "1 bytes, no message code"),
        ("b77a00", "message 7AB7 with 1 bytes of body"),
    ],
)
def test_evidence_says_what_a_payload_is(payload, text, catalogue):
    assert describe(bytes.fromhex(payload), catalogue).startswith(text)


# -- what a client has caused is owed until it is undone -------------------------------------------


def test_an_emergency_is_undone_though_a_datagram_is_lost(peer, network, catalogue, wait_until):
    target = peer("loses each first command")
    with opened(network, TARGET, catalogue, **QUICK) as session:
        for _ in range(2):
            session.client(1).send(SetEmergency(emergency_code=1))
        assert session.reaches(Status.EMERGENCY)
    wait_until(lambda: target.state == Status.STANDBY)


def test_ctrl_c_while_it_is_undone_leaves_nothing_behind(
    component, network, catalogue, monkeypatch
):
    target = component()
    with opened(network, TARGET, catalogue, timeout=0.4, quiet=0.05) as session:
        session.client(1).send(SetEmergency(emergency_code=1))
        assert session.reaches(Status.EMERGENCY)
        put = Client.put

        def interrupted(client, packet):
            if packet.payload[:2] == ClearEmergency(emergency_code=1).encode()[:2]:
                raise KeyboardInterrupt
            put(client, packet)

        monkeypatch.setattr(Client, "put", interrupted)
        with pytest.raises(KeyboardInterrupt):
            session.tidy()
        monkeypatch.undo()
        assert session.tidy()
        assert target.status is Status.STANDBY
