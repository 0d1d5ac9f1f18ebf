"""Whatever arrives, a component stays in order."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.runtime import Scope, ServiceIdentity, chain
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import (
    CreateCommandEvent,
    DeleteElement,
    QueryStatus,
    RejectEventRequest,
    ReportStatus,
    RequestControl,
    Resume,
    SetElement,
    SetTime,
)

from .state_tables import CORE_NAMES, V1_1, core_services

FAILURES = ("component.handler_failed", "loop.callback_failed")
PROVIDER = JausAddress(2, 1, 1)
SERVICES = (
    *core_services(V1_1, *CORE_NAMES),
    ServiceIdentity("urn:jaus:jss:core:ListManager", 1, 1),
    ServiceIdentity("urn:jaus:jss:mobility:GlobalWaypointListDriver", 1, 0),
    ServiceIdentity("urn:jaus:jss:iop:UnsolicitedHeartbeat", 1, 1),
)
UIDS = st.one_of(st.integers(0, 4), st.just(65535))


def lists():
    """Requests of a controller for the list, most of which are refused."""
    data = st.builds(SetElement.ElementData, st.integers(0, 1), st.just(b"\x0c\x04"))
    element = st.builds(SetElement.ElementRec, UIDS, UIDS, UIDS, data)
    deletion = st.builds(DeleteElement.DeleteElementRec, UIDS)
    return st.one_of(
        st.builds(SetElement, element_list=st.lists(element, max_size=4)),
        st.builds(DeleteElement, delete_element_list=st.lists(deletion, max_size=3)),
    ).map(lambda message: message.encode())


def times():
    """SetTime with any bits."""
    words = st.tuples(st.binary(min_size=4, max_size=4), st.binary(min_size=2, max_size=2))
    return words.map(lambda parts: SetTime.CODE.to_bytes(2, "little") + b"\3" + b"".join(parts))


def command_event(request_id, duration, command):
    """CreateCommandEvent with a command of any length, which the codec would not encode."""
    template = CreateCommandEvent(request_id, duration, bytes(2)).encode()
    return template[:-6] + len(command).to_bytes(4, "little") + command


def command_events(commands):
    """CreateCommandEvent with any command."""
    return st.builds(
        lambda duration, command: command_event(1, duration, command),
        st.integers(0, 3),
        st.one_of(st.binary(max_size=1), commands),
    )


def payloads(classes):
    """Messages with right codes and any bodies."""
    codes = st.sampled_from(sorted(classes)).map(lambda code: code.to_bytes(2, "little"))
    bodies = st.binary(max_size=40)
    messages = st.tuples(codes, bodies).map(lambda parts: parts[0] + parts[1])
    known = st.one_of(messages, lists(), times())
    return st.one_of(st.binary(max_size=40), known, command_events(known))


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_messages(world, message_classes, data):
    for address in ("1.1.1", str(PROVIDER), "3.1.1"):
        world.detach(JausAddress.parse(address))
    tested = world.component("1.1.1", services=SERVICES, discovery_scope=Scope.SUBSYSTEM)
    tested.subscribe(PROVIDER, QueryStatus(), ReportStatus, lambda *_: None, rate=5)
    tested.control(PROVIDER, authority=9)
    tested.command(PROVIDER, Resume(), max_duration=1)
    tested.set_list(PROVIDER, chain([(1, b"", 1), (2, b"", 1)]))
    tested.read_list(PROVIDER, lambda _elements: None)
    tested.start()
    probes = [world.probe(str(PROVIDER), strict=False), world.probe("3.1.1", strict=False)]
    probes[0].ask(RequestControl(authority_code=200), tested)
    for payload in data.draw(st.lists(payloads(message_classes), max_size=12)):
        data.draw(st.sampled_from(probes)).send_bytes(payload, tested)
        world.run(0.1, step=0.1)
    counts = world.counters.snapshot()
    assert not any(counts.get(name) for name in FAILURES)
    probes[1].take()
    probes[1].send(QueryStatus(), tested)
    (answer,) = probes[1].take(ReportStatus)
    assert answer.status == tested.status
    tested.stop()
    world.run(0.1, step=0.1)


@pytest.mark.parametrize("command", [b"", b"\x0c", b"\x0c\x04"], ids=["none", "half", "code"])
def test_a_command_event_without_a_command_is_rejected(world, command):
    tested = world.started("1.1.1", services=SERVICES)
    client = world.probe("3.1.1")
    client.take()
    client.send_bytes(command_event(7, 0, command), tested)
    answers = client.take()
    assert [(type(answer), answer.request_id) for answer in answers] == [(RejectEventRequest, 7)]
    assert not {*FAILURES} & world.counters.snapshot().keys()
