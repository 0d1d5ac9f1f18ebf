"""Whatever arrives, a component stays in order."""

from __future__ import annotations

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.runtime.address import JausAddress
from jausml.runtime.component import Scope
from jausml.runtime.core_messages import QueryStatus, ReportStatus

FAILURES = ("component.handler_failed", "loop.callback_failed")
PROVIDER = JausAddress(2, 1, 1)


def payloads(classes):
    """Messages with right codes and any bodies."""
    codes = st.sampled_from(sorted(classes)).map(lambda code: code.to_bytes(2, "little"))
    bodies = st.binary(max_size=40)
    return st.one_of(
        st.binary(max_size=40), st.tuples(codes, bodies).map(lambda parts: parts[0] + parts[1])
    )


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_any_messages(world, message_classes, data):
    for address in ("1.1.1", str(PROVIDER), "3.1.1"):
        world.detach(JausAddress.parse(address))
    tested = world.component("1.1.1", discovery_scope=Scope.SUBSYSTEM)
    tested.subscribe(PROVIDER, QueryStatus(), ReportStatus, lambda *_: None, rate=5)
    tested.control(PROVIDER, authority=9)
    tested.start()
    probes = [world.probe(str(PROVIDER), strict=False), world.probe("3.1.1", strict=False)]
    for payload in data.draw(st.lists(payloads(message_classes), max_size=12)):
        data.draw(st.sampled_from(probes)).send_bytes(payload, tested)
        world.run(0.1, step=0.1)
    counts = world.counters.snapshot()
    assert not any(counts.get(name) for name in FAILURES)
    (answer,) = [
        each for each in probes[1].ask(QueryStatus(), tested) if isinstance(each, ReportStatus)
    ]
    assert answer.status == tested.status
    tested.stop()
    world.run(0.1, step=0.1)
