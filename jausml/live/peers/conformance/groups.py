"""Groups of checks, in the order in which they run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.live.peers.conformance import (
    access,
    codecs,
    discovery,
    events,
    lists,
    liveness,
    management,
    time_service,
    transport,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.peers.conformance.check import Check
    from jausml.live.peers.conformance.session import Session


@dataclass(frozen=True, slots=True)
class Group:
    """Checks of one topic.

    Attributes:
        name: First part of the ids of its checks.
        title: What it is about.
        requires: Returns why the group cannot run against a target, or nothing.
        checks: Returns its checks for a target.
    """

    name: str
    title: str
    requires: Callable[[Session], str]
    checks: Callable[[Session], tuple[Check, ...]]


def all_groups() -> tuple[Group, ...]:
    """Returns the groups in the order in which they run."""
    return (
        Group("transport", "Transport", transport.requires, lambda _: transport.CHECKS),
        Group("discovery", "Discovery", discovery.requires, lambda _: discovery.CHECKS),
        Group("liveness", "Liveness", liveness.requires, lambda _: liveness.CHECKS),
        Group("time", "Time", time_service.requires, lambda _: time_service.CHECKS),
        Group("events", "Events", events.requires, lambda _: events.CHECKS),
        Group("access", "AccessControl", access.requires, lambda _: access.CHECKS),
        Group("management", "Management", management.requires, lambda _: management.CHECKS),
        Group("list", "ListManager", lists.requires, lambda _: lists.CHECKS),
        Group("codecs", "Codecs of the announced services", codecs.requires, codecs.checks),
    )


def fixed_checks() -> tuple[Check, ...]:
    """Returns the checks that do not depend on what a target announces."""
    modules = (
        transport,
        discovery,
        liveness,
        time_service,
        events,
        access,
        management,
        lists,
    )
    return tuple(check for module in modules for check in module.CHECKS)
