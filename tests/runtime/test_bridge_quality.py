"""Which publishers and subscriptions ROS connects, by the rules of DDS."""

import pytest

from jausml.runtime.bridge.ends.topics import (
    LOSS_WINDOW,
    Conflict,
    EndpointHealth,
    Qos,
    TopicCounts,
    conflicts,
)


@pytest.mark.parametrize(
    ("offered", "requested"),
    [
        (Qos(), Qos()),
        (Qos(), Qos(reliability="best_effort")),
        (Qos(durability="transient_local"), Qos()),
        (Qos(deadline=0.1), Qos(deadline=0.1)),
        (Qos(deadline=0.1), Qos()),
        (Qos(liveliness="manual_by_topic", lease_duration=1.0), Qos(lease_duration=2.0)),
        (Qos(reliability="system_default"), Qos()),
    ],
)
def test_ends_that_meet(offered, requested):
    assert conflicts(offered, requested) == []


@pytest.mark.parametrize(
    ("offered", "requested", "expected"),
    [
        (Qos(reliability="best_effort"), Qos(), Conflict("reliability", "best_effort", "reliable")),
        (Qos(), Qos(durability="transient_local"),
            Conflict("durability", "volatile", "transient_local")),
        (Qos(), Qos(deadline=0.1), Conflict("deadline", 0.0, 0.1)),
        (Qos(deadline=0.2), Qos(deadline=0.1), Conflict("deadline", 0.2, 0.1)),
        (Qos(), Qos(liveliness="manual_by_topic"),
            Conflict("liveliness", "automatic", "manual_by_topic")),
        (Qos(lease_duration=2.0), Qos(lease_duration=1.0),
            Conflict("liveliness_lease_duration", 2.0, 1.0)),
    ],
)  # fmt: skip
def test_ends_that_do_not(offered, requested, expected):
    assert conflicts(offered, requested) == [expected]
    if expected.policy != "deadline":
        assert conflicts(requested, offered) == []


def test_what_is_lost_on_the_way_is_told_with_the_cure_for_a_while():
    now = [0.0]
    health = EndpointHealth(
        publishes=False,
        topic="/map",
        qos=Qos(reliability="best_effort"),
        entity="subscription",
        others=lambda: [("/slam", Qos())],
        clock=lambda: now[0],
    )
    assert health.faults() == []
    health.counts = TopicCounts(taken=3, lost=2, missed=2)  # in the queue: the bridge was slow
    assert health.faults() == []
    health.counts.missed = 5
    (fault,) = health.faults()
    assert "larger than 512 kB" in fault.text
    assert "qos_overrides./map.subscription.reliability:=reliable" in fault.text
    now[0] = LOSS_WINDOW
    assert health.faults() == []
    health.counts.missed = 6
    health.others = lambda: [("/slam", Qos(reliability="best_effort"))]
    assert health.faults() == []
