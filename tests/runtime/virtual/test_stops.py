"""Stops over a way that loses: nothing that was sent before is obeyed after."""

import pytest

from jausml.runtime import ComponentSettings
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.ends.ends import BridgeSettings
from jausml.runtime.clients.exchanges import Exchanges, Unanswered
from jausml.runtime.messages import ReportStatus, SetTime

from ..services.bridge_support import OWN, PEER, Number, Ros, command, minutes, safe
from .test_network import component


@pytest.fixture
def obeyed(world):
    """The minutes that a peer is told, in order: one of another make, which knows no order."""
    told, transport = [], world.transport()
    transport.attach(
        PEER, lambda payload, _: told.append(SetTime.decode(payload).time_stamp.minutes)
    )
    return told


def test_a_command_that_got_lost_is_not_repeated_after_the_stop(world, obeyed):
    bridge, ros, transport = _bridge(), Ros(), world.transport()
    bridge.open(ros, transport)
    try:
        world.run_for(1.0)
        ros.deliver["numbers"](Number(40.0))
        world.run_for(0.04)
        transport.cut()
        ros.deliver["numbers"](Number(50.0))
        world.run_for(0.045)
        transport.restore()
        world.run_for(3.0)
    finally:
        bridge.close()
    assert obeyed == [0, 40, 0]


def _bridge():
    bridge = Bridge(
        BridgeSettings("bridge", OWN, component=ComponentSettings(register_services=False))
    )
    bridge.connections = [command(acknowledge=True, silence_timeout=0.05, safe_value=safe)]
    return bridge


def test_a_command_that_was_told_to_have_failed_is_not_repeated(world, obeyed):
    transport, ends = world.transport(), []
    asker = component(transport, OWN, services=())
    exchanges = Exchanges(asker)
    exchanges.listen([ReportStatus])
    world.run_for(1.0)
    transport.cut()
    exchanges.ask(
        PEER, minutes(7).encode(), [ReportStatus], ends.append, timeout=0.05, is_query=False
    )
    world.run_for(0.07)
    assert ends == [Unanswered.SILENT]
    transport.restore()
    world.run_for(2.0)
    assert obeyed == []
