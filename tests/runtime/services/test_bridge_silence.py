"""What connections of bridges do when their source is silent."""

from __future__ import annotations

from jausml.runtime import Guard
from jausml.runtime.messages import SetTime

from .bridge_support import CORE, OTHER, PEER, Number, command, event, minutes, safe


def test_safe_value_once_then_recovery(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(silence_timeout=1.0, safe_value=safe))
    for _ in range(30):
        setting.ros.deliver["numbers"](Number(5.0))
        world.run(0.1)
    assert peer.take() == [minutes(5)] * 30
    world.run(0.85)
    assert peer.take() == []  # the timeout counts from the last message
    world.run(5.0)
    assert peer.take() == [minutes(0)]
    setting.ros.deliver["numbers"](Number(6.0))
    assert not connection.is_silent
    assert peer.take() == [minutes(6)]
    world.run(5.0)
    assert peer.take() == [minutes(0)]
    assert connection.statistics.safe_values == 2


def test_source_that_never_spoke_is_silent(world, setting):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    world.run(1.1)
    assert peer.take() == [minutes(0)]


def test_peer_that_was_away_gets_the_safe_value_when_it_is_ready(world, setting):
    received = []
    connection = setting.open(
        command(silence_timeout=1.0, safe_value=safe, control=Guard.READY, peers=[PEER, OTHER])
    )
    world.run(2.0)
    assert connection.statistics.safe_values == 0
    for address in (PEER, OTHER):
        tested = world.component(str(address), services=CORE)
        tested.handle(
            SetTime,
            lambda message, _, to=address: received.append((to, message)),
            when=Guard.READY,
        )
        tested.start()
        world.run(10.0)
    # The peer that came first does not get it again when the other one comes.
    assert received == [(PEER, minutes(0)), (OTHER, minutes(0))]


def test_silence_timeout_is_a_parameter(world, setting):
    peer = world.probe(str(PEER))
    setting.ros.parameters["drive.silence_timeout"] = 5.0
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    world.run(4.9)
    assert peer.take() == []
    world.run(0.2)
    assert peer.take() == [minutes(0)]


def test_silence_without_safe_value_is_only_told(world, setting):
    connection = setting.open(event(rate=1.0, silence_timeout=1.0))
    world.run(2.0)
    assert connection.is_silent
    assert setting.ros.numbers("timeout") == []


def test_failing_safe_value_is_counted(world, setting):
    def broken():
        raise ValueError("?")

    connection = setting.open(command(silence_timeout=1.0, safe_value=broken))
    world.run(2.0)
    assert setting.drops(connection) == {"translation_failed": 1}
