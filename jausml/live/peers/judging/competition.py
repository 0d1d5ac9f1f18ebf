"""Competitions as data: tasks with their parts and points, and the score of a run."""

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
    """A part of a task, with its points.

    Attributes:
        needs: Names of parts of the same task without which it cannot be judged.
        is_last: Whether it comes after all tasks, since it ends the target.
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
    """A task, whose parts are judged in order; the target stays controlled between them.

    Attributes:
        rule: The rules of the task, in our words.
        is_unasked: Whether the target begins it, before the judge has sent anything.
    """

    name: str
    title: str
    rule: str
    parts: tuple[Part, ...] = ()
    is_unasked: bool = False


# Makes a part from the name and the source of its task.
PartOf = Callable[[str, str], Part]


def part(
    name: str, points: float, title: str, *needs: str, is_last: bool = False
) -> Callable[..., PartOf]:
    """Returns a function that makes a part of a task from its steps."""

    def of(*steps: Step) -> PartOf:
        return lambda task_name, source: Part(
            Check(f"{task_name}.{name}", title, source, title, steps), points, needs, is_last
        )

    return of


def task(
    name: str, title: str, rule: str, source: str, *parts: PartOf, is_unasked: bool = False
) -> Task:
    """Returns a task, whose parts have its name and source."""
    return Task(name, title, rule, tuple(factory(name, source) for factory in parts), is_unasked)


@dataclass(frozen=True, slots=True)
class Competition:
    """Tasks in their order.

    Attributes:
        source: The publication of the rules, and which points are ours.
        not_covered: Demands of the rules that are not judged, or not public.
        skips_count: Whether parts that cannot be judged, e.g. without control, lose their points.
    """

    name: str
    title: str
    source: str
    tasks: tuple[Task, ...] = ()
    not_covered: tuple[str, ...] = ()
    skips_count: bool = True


@dataclass(frozen=True, slots=True)
class Score:
    """The result of a part."""

    task: Task
    part: Part
    result: CheckResult

    @property
    def points(self) -> float:
        """The points for it: all or none."""
        return self.part.points if self.result.verdict in _GIVEN else 0.0


@dataclass(frozen=True, slots=True)
class Sheet:
    """The score sheet of a run.

    Attributes:
        target: JAUS id of the judged component.
        begun: Date and time in UTC.
        services: The reported services of the target.
    """

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
        """Returns whether the points of a part count among the possible ones."""
        return self.competition.skips_count or score.result.verdict is not Verdict.SKIPPED

    def reached(self, task: Task | None = None) -> float:
        """Returns the reached points, of one task or of all."""
        return round(sum(score.points for score in self._chosen(task)), 2)

    def possible(self, task: Task | None = None) -> float:
        """Returns the possible points, of one task or of all."""
        chosen = (score.part.points for score in self._chosen(task) if self.counts(score))
        return round(sum(chosen), 2)

    @property
    def is_full(self) -> bool:
        """Whether all possible points were reached."""
        return not self.interrupted and self.reached() == self.possible() > 0

    def _chosen(self, task: Task | None) -> Sequence[Score]:
        return self.scores if task is None else self.of(task)


class Judge:
    """Judge of the tasks of a competition.

    Attributes:
        scores: The scores so far.
        interrupted: Whether a user interrupted the run.
    """

    def __init__(self, tasks: Iterable[Task], on_score: Callable[[Score], None]) -> None:
        self._tasks = tuple(tasks)
        self._on_score = on_score
        self.scores: list[Score] = []
        self.interrupted = False

    def meet(self, session: Session) -> bool:
        """Judges the tasks that the target begins; returns whether it got any points for them."""
        for task in self._tasks:
            if task.is_unasked:
                self._take(session, task, task.parts)
        return any(score.result.verdict in _GIVEN for score in self.scores)

    def run(self, session: Session) -> None:
        """Judges all other tasks; parts that end the target come last."""
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
        """Adds a score, and passes it to `on_score`."""
        self.scores.append(score)
        self._on_score(score)

    def _obstacle(self, task: Task, part: Part) -> str:
        scored_parts = {
            score.part.name
            for score in self.scores
            if score.task is task and score.result.verdict in _GIVEN
        }
        lacking = [part_name for part_name in part.needs if part_name not in scored_parts]
        return f"cannot be judged without {task.name}.{lacking[0]}" if lacking else ""
