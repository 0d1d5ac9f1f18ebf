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
    liveness_and_time,
    management,
    transport,
)
from jausml.live.peers.conformance.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from jausml.live.peers.conformance.check import Check


@dataclass(frozen=True, slots=True)
class CheckGroup:
    """Checks of one topic, by the first part of their ids."""

    name: str
    requires: Callable[[Session], str]
    checks: Callable[[Session], tuple[Check, ...]]


def _of_service(name: str) -> Callable[[Session], str]:
    return partial(Session.missing, name=name)


_FIXED: tuple[tuple[str, Callable[[Session], str], tuple[Check, ...]], ...] = (
    ("transport", transport.requires, transport.CHECKS),
    ("discovery", _of_service("Discovery"), discovery.CHECKS),
    ("liveness", _of_service("Liveness"), liveness_and_time.LIVENESS),
    ("time", _of_service("Time"), liveness_and_time.TIME_CHECKS),
    ("events", _of_service("Events"), events.CHECKS),
    ("access", access.requires, access.CHECKS),
    ("management", management.requires, management.CHECKS),
    ("list", _of_service("ListManager"), lists.CHECKS),
)
"""Groups whose checks do not depend on what a target announces."""


def all_groups() -> tuple[CheckGroup, ...]:
    """Returns the groups in the order in which they run."""
    fixed = (CheckGroup(name, requires, _always(checks)) for name, requires, checks in _FIXED)
    return (*fixed, CheckGroup("codecs", codecs.requires, codecs.checks))


def _always(checks: tuple[Check, ...]) -> Callable[[Session], tuple[Check, ...]]:
    return lambda _: checks


def fixed_checks() -> tuple[Check, ...]:
    """Returns the checks that do not depend on what a target announces."""
    return tuple(check for _, _, checks in _FIXED for check in checks)


@dataclass(frozen=True, slots=True)
class CheckFilter:
    """The choice of checks by their ids, or by their groups.

    Attributes:
        only: Ids and groups; all are meant when it is empty.
    """

    only: frozenset[str] = frozenset()
    skip: frozenset[str] = frozenset()

    def groups(self) -> tuple[CheckGroup, ...]:
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

    def _chosen(self, group: CheckGroup, session: Session) -> tuple[Check, ...]:
        return tuple(check for check in group.checks(session) if self.takes(check.id))


def unknown(names: Iterable[str]) -> list[str]:
    """Returns names that neither a group nor a check has; those of codecs depend on a target."""
    known = known_names()
    return [each for each in names if each not in known and not each.startswith("codecs.")]


def known_names() -> set[str]:
    """Returns the names of groups and the ids of checks that do not depend on a target."""
    return {group.name for group in all_groups()} | {check.id for check in fixed_checks()}
