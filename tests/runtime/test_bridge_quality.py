"""Which publishers and subscriptions ROS connects, by the rules of DDS."""

from __future__ import annotations

import pytest

from jausml.runtime.bridge.ends.topics import Conflict, Qos, conflicts


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
        (
            Qos(reliability="best_effort"),
            Qos(),
            Conflict("reliability", "best_effort", "reliable"),
        ),
        (
            Qos(),
            Qos(durability="transient_local"),
            Conflict("durability", "volatile", "transient_local"),
        ),
        (Qos(), Qos(deadline=0.1), Conflict("deadline", 0.0, 0.1)),
        (Qos(deadline=0.2), Qos(deadline=0.1), Conflict("deadline", 0.2, 0.1)),
        (
            Qos(),
            Qos(liveliness="manual_by_topic"),
            Conflict("liveliness", "automatic", "manual_by_topic"),
        ),
        (
            Qos(lease_duration=2.0),
            Qos(lease_duration=1.0),
            Conflict("liveliness_lease_duration", 2.0, 1.0),
        ),
    ],
)
def test_ends_that_do_not(offered, requested, expected):
    assert conflicts(offered, requested) == [expected]
    if expected.policy != "deadline":
        assert conflicts(requested, offered) == []
