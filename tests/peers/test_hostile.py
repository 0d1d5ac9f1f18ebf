"""Whatever a target sends, the tools give a verdict and no traceback."""

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.live.messages import MessageError, load_catalogue
from jausml.live.peers.conformance.evidence import MAX_LENGTH, Verdict, describe
from jausml.live.peers.conformance.formats import render_json, render_junit, render_text
from jausml.live.peers.conformance.run import all_groups, opened, run
from jausml.live.peers.rendering import report_json, report_line
from jausml.runtime.base.address import JausAddress
from tests.peers.peer import FaultyPeer

pytestmark = pytest.mark.ports

TARGET = JausAddress(100, 1, 1)


@pytest.fixture(scope="module")
def catalogue():
    return load_catalogue()


@settings(max_examples=300, deadline=None)
@given(data=st.data(), body=st.binary(max_size=60))
def test_any_payload_can_be_described_and_shown(catalogue, data, body):
    code = data.draw(st.sampled_from([entry.code for entry in catalogue.messages]))
    payload = code.to_bytes(2, "little") + body
    assert 0 < len(describe(payload, catalogue)) <= MAX_LENGTH
    try:
        message = catalogue.decode(payload)
    except MessageError:
        return
    assert report_line(TARGET, message.entry, message.fields).isprintable()
    assert report_json(TARGET, message.entry, message.fields).isascii()


@settings(max_examples=100, deadline=None)
@given(payload=st.binary(max_size=4))
def test_any_short_payload_can_be_described(catalogue, payload):
    assert describe(payload, catalogue)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_target_that_babbles_gets_a_report(seed, catalogue, free_port, network):
    """Each answer has the right message code and a body that is cut, prolonged or random."""
    chance = random.Random(seed)

    class Babbler(FaultyPeer):
        def put(self, packet):
            payload = packet.payload
            choice = chance.randrange(4)
            if choice == 1:
                payload = payload[: chance.randrange(len(payload) + 1)]
            elif choice == 2:
                payload += chance.randbytes(chance.randrange(1, 40))
            elif choice == 3:
                payload = payload[:2] + chance.randbytes(max(0, len(payload) - 2))
            packet = packet._replace(payload=payload)
            data = packet.encode()
            if not chance.randrange(8):
                data = chance.randbytes(1) + data[1:]
            self.socket.sendto(data, self.endpoints[packet.destination])

    babbler = Babbler(TARGET, free_port)
    try:
        with opened(network, TARGET, catalogue, timeout=0.05, quiet=0.02) as session:
            report = run(session, all_groups(), lambda _: None)
    finally:
        babbler.close()
    assert report.count(Verdict.FAIL) > 0
    for render in (render_text, render_json, render_junit):
        assert render(report)
