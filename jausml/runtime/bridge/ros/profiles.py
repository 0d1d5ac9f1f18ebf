"""Quality of service as rclpy has it, and the parameters that change it."""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from ..ends.topics import Parameter, Qos

if TYPE_CHECKING:
    from collections.abc import Callable, Container

    from ..ends.topics import EndpointHealth

OVERRIDABLE = ("reliability", "durability", "history", "depth")
"""Policies that parameters may change; times are the business of the model."""

LEAST_DEPTH = 100
"""Messages that a subscription keeps at least unless it is latched: ten times what a plain
subscription keeps. At 1000 messages a second that bridges a stall of a tenth of a second."""

MOST_KEPT = 5000
"""Messages that a publisher with `keep_all` keeps for a reader that does not read.

Fast DDS keeps as many. Then each `publish` waits a tenth of a second for that reader, and Python
with it: one reader that stands still would hold up all topics.
"""

_UNLIMITED = 2**63 - 1
"""Nanoseconds that ROS reports for a time that nobody limits."""


def overridden(
    health: EndpointHealth, given: Container[str], parameter: Callable[[Parameter], Any]
) -> Qos:
    """Returns the quality of service of an endpoint after parameters.

    A parameter exists only where command line or file give it: with four for each endpoint, those
    that matter would be hard to find among them, and the start would take longer.
    """
    qos = health.qos
    for policy in OVERRIDABLE:
        name = health.parameter(policy)
        if name in given:
            text = f"{policy} of the {health.entity} of {health.topic}."
            value = parameter(Parameter(name, getattr(qos, policy), text))
            qos = replace(qos, **{policy: value})
    return qos


def deep_enough(qos: Qos) -> Qos:
    """Returns the quality of service of a subscription that does not lose what it can keep.

    A queue of ten is full after 10 ms at 1000 messages a second. What is latched keeps its depth,
    which says how much of the past is asked for.
    """
    if qos.durability == "volatile" and qos.history == "keep_last" and qos.depth < LEAST_DEPTH:
        return replace(qos, depth=LEAST_DEPTH)
    return qos


def never_waiting(qos: Qos) -> Qos:
    """Returns the quality of service of a publisher that forgets the oldest rather than wait."""
    return replace(qos, history="keep_last", depth=MOST_KEPT) if qos.history == "keep_all" else qos


def profile_of(qos: Qos) -> QoSProfile:
    """Returns the rclpy profile; its policies have the names that the model uses.

    Raises:
        RuntimeError: There is no such policy, or the profile is none for rclpy.
    """
    profile = QoSProfile(
        reliability=_policy(ReliabilityPolicy, "reliability", qos.reliability),
        durability=_policy(DurabilityPolicy, "durability", qos.durability),
        history=_policy(HistoryPolicy, "history", qos.history),
        depth=qos.depth,
        liveliness=_policy(LivelinessPolicy, "liveliness", qos.liveliness),
    )
    if qos.deadline > 0:
        profile.deadline = Duration(seconds=qos.deadline)
    if qos.lifespan > 0:
        profile.lifespan = Duration(seconds=qos.lifespan)
    if qos.lease_duration > 0:
        profile.liveliness_lease_duration = Duration(seconds=qos.lease_duration)
    return profile


def qos_of(profile: QoSProfile) -> Qos:
    """Returns what a profile says; of another node, history and depth are not known."""
    return Qos(
        reliability=profile.reliability.name.lower(),
        durability=profile.durability.name.lower(),
        deadline=_seconds(profile.deadline),
        lifespan=_seconds(profile.lifespan),
        liveliness=profile.liveliness.name.lower(),
        lease_duration=_seconds(profile.liveliness_lease_duration),
    )


def _policy(kind: Any, name: str, value: str) -> Any:
    try:
        return kind[value.upper()]
    except KeyError:
        raise RuntimeError(f"unexpected QoS override for policy {name}: {value}") from None


def _seconds(duration: Duration) -> float:
    count = duration.nanoseconds
    return count / 1e9 if 0 < count < _UNLIMITED else 0.0
