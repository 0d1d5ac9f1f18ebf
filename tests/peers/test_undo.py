"""What a client of the conformance test has caused is owed until it is undone."""

import pytest

from jausml.live.peers.conformance.client import Client
from jausml.live.peers.conformance.run import opened
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import ClearEmergency, SetEmergency
from jausml.runtime.services.definitions import Status

pytestmark = pytest.mark.ports

TARGET = JausAddress(100, 1, 1)


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
