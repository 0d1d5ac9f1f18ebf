"""The competitions that can be judged, and a run of one against a component."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.run import CheckFilter, known_names, opened, run
from jausml.live.peers.judging import igvc, iop
from jausml.live.peers.judging.competition import (
    Competition,
    Judge,
    Part,
    Score,
    Sheet,
    Task,
)
from jausml.live.peers.judging.driving import Course

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from jausml.live.messages import Catalogue
    from jausml.live.peers.conformance.check import CheckResult
    from jausml.live.peers.conformance.probe import RawEndpoint
    from jausml.live.peers.conformance.session import Session
    from jausml.live.peers.network import Network
    from jausml.runtime.base.address import JausAddress

CONFORMANCE = "conformance"

ID = {"igvc-jaus": "42.1.1", "igvc-iop": "42.1.1"}
"""Id of the judge by competition, where the rules fix it."""


class ConformanceJudge(Judge):
    """Gives a point for each check of conformance that applies to the target."""

    def __init__(self, selection: CheckFilter, on_score: Callable[[Score], None]) -> None:
        """Prepares; nothing is sent."""
        self._selection = selection
        self._groups = {
            each.name: Task(each.name, each.name, "one point for each check that applies")
            for each in selection.groups()
        }
        super().__init__(self._groups.values(), on_score)

    def run(self, session: Session) -> None:
        """Runs the checks."""
        report = run(session, self._selection.groups(), self._note)
        self.interrupted = report.interrupted

    def _note(self, result: CheckResult) -> None:
        self.note(Score(self._groups[result.check.group], Part(result.check, 1), result))


def competition(name: str, course: Course | None = None) -> Competition:
    """Returns a competition by its name."""
    return _COMPETITIONS[name](course or Course())


def _conformance(_: Course) -> Competition:
    return Competition(
        CONFORMANCE,
        "Conformance",
        "The checks of `jausml conformance`, against AS5669A, AS5710 and AS5684; each is worth a "
        "point, and those that do not apply are worth none.",
        not_covered=(
            "checks that end the component, or take minutes: jausml conformance has them",
        ),
        skips_count=False,
    )


_COMPETITIONS: dict[str, Callable[[Course], Competition]] = {
    "igvc-jaus": igvc.jaus_challenge,
    "igvc-iop": iop.iop_challenge,
    CONFORMANCE: _conformance,
}


def task_names(name: str) -> set[str]:
    """Returns the names of the tasks of a competition and of their parts."""
    if name == CONFORMANCE:
        return known_names()
    tasks = competition(name).tasks
    return {each.name for each in tasks} | {part.check.id for e in tasks for part in e.parts}


def judged(
    network: Network,
    target: JausAddress,
    catalogue: Catalogue,
    rules: Competition,
    *,
    only: Collection[str] = (),
    on_score: Callable[[Score], None] = lambda _: None,
    timeout: float = 1.0,
    quiet: float = 0.3,
    wire: RawEndpoint | None = None,
) -> Sheet:
    """Lets a component take the tasks of a competition.

    Args:
        only: Names of tasks or of parts, whose needs are taken too; all when empty.

    Raises:
        OSError: The network cannot be used.
        TargetNotReached: Nothing came from the target.
    """
    judge: Judge
    if rules.name == CONFORMANCE:
        judge = ConformanceJudge(CheckFilter(frozenset(only)), on_score)
    else:
        chosen = (_chosen(each, only) for each in rules.tasks)
        judge = Judge([each for each in chosen if each.parts], on_score)
    with opened(
        network, target, catalogue, timeout=timeout, quiet=quiet, meet=judge.meet, wire=wire
    ) as session:
        begun = next((each.result.begun for each in judge.scores), None) or session.probe.utc()
        judge.run(session)
        host, port = session.probe.endpoint or ("", 0)
        return Sheet(
            rules,
            str(target),
            f"{host}:{port}",
            begun,
            tuple(f"{each.urn} {each.major}.{each.minor}" for each in session.services),
            judge.in_order(),
            judge.interrupted,
        )


def _chosen(task: Task, only: Collection[str]) -> Task:
    if not only or task.name in only:
        return task
    names = {each.name for each in task.parts if each.check.id in only}
    for each in reversed(task.parts):
        names |= set(each.needs) if each.name in names else set()
    return replace(task, parts=tuple(each for each in task.parts if each.name in names))
