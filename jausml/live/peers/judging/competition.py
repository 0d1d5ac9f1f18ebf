"""Competitions as data: tasks, what points are given for in each, and the score of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

from jausml.live.peers.conformance.check import Check, CheckResult, Step
from jausml.live.peers.conformance.evidence import Verdict
from jausml.live.peers.conformance.run import outcome
from jausml.live.peers.conformance.session import Session

_GIVEN = (Verdict.PASS, Verdict.NOTE)


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a task, and the points that it is worth.

    Attributes:
        needs: Names of parts of the same task without which nothing can be said of it.
        is_last: Whether it comes after all tasks, since the target cannot go on afterwards.
    """

    check: Check
    points: float
    needs: tuple[str, ...] = ()
    is_last: bool = False

    @property
    def name(self) -> str:
        """The part of the id after the task."""
        return self.check.id.rpartition(".")[2]


@dataclass(frozen=True, slots=True)
class Task:
    """A task, whose parts are taken one after the other without letting go of the target.

    Attributes:
        rule: What the rules say of it, in words of ours.
        is_unasked: Whether it begins before the judge has sent anything.
    """

    name: str
    title: str
    rule: str
    parts: tuple[Part, ...] = ()
    is_unasked: bool = False


# Makes a part of a task by the name of that, with the source of it.
PartOf = Callable[[str, str], Part]


def part(
    name: str, points: float, title: str, *needs: str, is_last: bool = False
) -> Callable[..., PartOf]:
    """Declares a part of a task, and takes its steps."""

    def of(*steps: Step) -> PartOf:
        return lambda task_name, source: Part(
            Check(f"{task_name}.{name}", title, source, title, steps), points, needs, is_last
        )

    return of


def task(
    name: str, title: str, rule: str, source: str, *parts: PartOf, is_unasked: bool = False
) -> Task:
    """Declares a task."""
    return Task(name, title, rule, tuple(factory(name, source) for factory in parts), is_unasked)


@dataclass(frozen=True, slots=True)
class Competition:
    """Tasks in their order.

    Attributes:
        source: Where the rules are published, and what of the points is ours.
        not_covered: What the rules ask for and this judge does not look at, or that is not public.
        skips_count: Whether points are lost for what could not be judged, e.g. without control.
    """

    name: str
    title: str
    source: str
    tasks: tuple[Task, ...] = ()
    not_covered: tuple[str, ...] = ()
    skips_count: bool = True


@dataclass(frozen=True, slots=True)
class Score:
    """The points of a part."""

    task: Task
    part: Part
    result: CheckResult

    @property
    def points(self) -> float:
        """The points that were given."""
        return self.part.points if self.result.verdict in _GIVEN else 0.0


@dataclass(frozen=True, slots=True)
class Sheet:
    """The score of a run (`begun`: time of day, in UTC)."""

    competition: Competition
    target: str
    endpoint: str
    begun: datetime
    services: tuple[str, ...] = ()
    scores: tuple[Score, ...] = ()
    interrupted: bool = False

    @property
    def tasks(self) -> tuple[Task, ...]:
        """The tasks that were judged, in the order of the rules."""
        return tuple(dict.fromkeys(score.task for score in self.scores))

    def of(self, task: Task) -> tuple[Score, ...]:
        """Returns the scores of a task."""
        return tuple(score for score in self.scores if score.task is task)

    def counts(self, score: Score) -> bool:
        """Whether the points of a part belong to what could be reached."""
        return self.competition.skips_count or score.result.verdict is not Verdict.SKIPPED

    def reached(self, task: Task | None = None) -> float:
        """Returns the points that were given, of one task or in all."""
        return round(sum(score.points for score in self._chosen(task)), 2)

    def possible(self, task: Task | None = None) -> float:
        """Returns the points that could be reached."""
        chosen = (score.part.points for score in self._chosen(task) if self.counts(score))
        return round(sum(chosen), 2)

    @property
    def is_full(self) -> bool:
        """Whether there are full marks."""
        return not self.interrupted and self.reached() == self.possible() > 0

    def _chosen(self, task: Task | None) -> Sequence[Score]:
        return self.scores if task is None else self.of(task)


class Judge:
    """Lets a target take the tasks of a competition."""

    def __init__(self, tasks: Iterable[Task], on_score: Callable[[Score], None]) -> None:
        self._tasks = tuple(tasks)
        self._on_score = on_score
        self.scores: list[Score] = []
        self.interrupted = False

    def meet(self, session: Session) -> bool:
        """Takes the tasks that begin without a word, and returns whether the target was heard."""
        for task in self._tasks:
            if task.is_unasked:
                self._take(session, task, task.parts)
        return any(score.result.verdict in _GIVEN for score in self.scores)

    def run(self, session: Session) -> None:
        """Takes all other tasks; parts after which the target cannot go on come last."""
        try:
            for task in self._tasks:
                if not task.is_unasked:
                    self._take(
                        session,
                        task,
                        [task_part for task_part in task.parts if not task_part.is_last],
                    )
                    session.tidy()
            for task in self._tasks:
                self._take(
                    session, task, [task_part for task_part in task.parts if task_part.is_last]
                )
        except KeyboardInterrupt:
            self.interrupted = True
            session.tidy()

    def in_order(self) -> tuple[Score, ...]:
        """Returns the scores in the order of the tasks."""
        return tuple(sorted(self.scores, key=lambda score: self._tasks.index(score.task)))

    def _take(self, session: Session, task: Task, parts: Sequence[Part]) -> None:
        for part in parts:
            obstacle = self._obstacle(task, part)
            if obstacle:
                result = CheckResult(part.check, Verdict.SKIPPED, (obstacle,))
            else:
                result = outcome(session, part.check)
            self.note(Score(task, part, result))

    def note(self, score: Score) -> None:
        """Keeps a score and tells of it."""
        self.scores.append(score)
        self._on_score(score)

    def _obstacle(self, task: Task, part: Part) -> str:
        scored_parts = {
            score.part.name for score in self.scores if score.task is task and _is_given(score)
        }
        lacking = [part_name for part_name in part.needs if part_name not in scored_parts]
        return f"cannot be judged without {task.name}.{lacking[0]}" if lacking else ""


def _is_given(score: Score) -> bool:
    return score.result.verdict in _GIVEN
