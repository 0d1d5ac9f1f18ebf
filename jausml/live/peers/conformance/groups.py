"""Groups of checks, in the order in which they run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
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
    from collections.abc import Callable, Iterable

    from jausml.live.peers.conformance.check import Check
    from jausml.live.peers.conformance.session import Session


@dataclass(frozen=True, slots=True)
class Group:
    """Checks of one topic."""

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


@dataclass(frozen=True, slots=True)
class Selection:
    """The choice of checks by their ids, or by their groups.

    Attributes:
        only: Ids and groups; all are meant when it is empty.
    """

    only: frozenset[str] = frozenset()
    skip: frozenset[str] = frozenset()

    def groups(self) -> tuple[Group, ...]:
        """Returns the groups with chosen checks, which have no others."""
        return tuple(
            replace(group, checks=partial(self._chosen, group))
            for group in all_groups()
            if self._may_have(group.name)
        )

    def takes(self, check_id: str) -> bool:
        """Whether a check is chosen."""
        names = {check_id, check_id.partition(".")[0]}
        return not names & self.skip and (not self.only or bool(names & self.only))

    def _may_have(self, group: str) -> bool:
        wanted = {each.partition(".")[0] for each in self.only}
        return group not in self.skip and (not wanted or group in wanted)

    def _chosen(self, group: Group, session: Session) -> tuple[Check, ...]:
        return tuple(check for check in group.checks(session) if self.takes(check.id))


def unknown(names: Iterable[str]) -> list[str]:
    """Returns names that neither a group nor a check has; those of codecs depend on a target."""
    known = known_names()
    return [each for each in names if each not in known and not each.startswith("codecs.")]


def known_names() -> set[str]:
    """Returns the names of groups and the ids of checks that do not depend on a target."""
    return {group.name for group in all_groups()} | {check.id for check in fixed_checks()}
