"""Explicit search: all states that can be reached, nearest first, and how each is reached."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


class Step(NamedTuple):
    """What happens between two states.

    Attributes:
        actor: Who does it.
        what: What is done, as a person says it.
        receiver: To whom; empty where it concerns the actor alone.
        is_tick: Whether it is one step of time.
        passes: Whose command takes effect by it.
        on_to: Where the receiver sends it on.
        is_helpful: Whether it goes on in a world in which nobody hinders anything.
    """

    actor: str
    what: str
    receiver: str = ""
    is_tick: bool = False
    passes: str = ""
    on_to: str = ""
    is_helpful: bool = False


TIME = Step("time", "passes", is_tick=True, is_helpful=True)
"""One step of time."""


class Product(Protocol):
    """Some parts of a system and what can happen to them together."""

    def initial(self) -> Any:
        """Returns the state at the start."""

    def steps(self, state: Any) -> Iterable[tuple[Step, Any]]:
        """Yields what can happen in a state, and the state after it."""


class Bounds(NamedTuple):
    """How far a search goes.

    Attributes:
        states: How many states it keeps.
        is_over: Whether the time is up.
    """

    states: int
    is_over: Callable[[], bool]


@dataclass
class Graph:
    """The states that were reached.

    Attributes:
        edges: For each state the numbers of steps and of the states after them.
        before: For each state the number of the one before it, and of the step between.
        is_complete: Whether no bound was met.
    """

    states: list[Any] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    edges: list[tuple[tuple[int, int], ...]] = field(default_factory=list)
    before: list[tuple[int, int]] = field(default_factory=list)
    is_complete: bool = True

    def way_to(self, state: int) -> list[tuple[int, int]]:
        """Returns the shortest way from the start: numbers of steps and of states after them."""
        way: list[tuple[int, int]] = []
        while state:
            previous, step = self.before[state]
            way.append((step, state))
            state = previous
        return way[::-1]

    def transitions(self) -> Iterator[tuple[int, int, int]]:
        """Yields all transitions: state, step, state."""
        for state, edges in enumerate(self.edges):
            for step, after in edges:
                yield state, step, after


_LOOKS_AT_CLOCK_EVERY = 1024


def explore(product: Product, bounds: Bounds) -> Graph:
    """Returns what can be reached, as far as the bounds allow."""
    graph = Graph()
    numbers: dict[Any, int] = {}
    steps: dict[Step, int] = {}
    pending: deque[int] = deque()

    def number_of(state: Any, before: int, step: int) -> int | None:
        number = numbers.get(state)
        if number is None:
            if len(graph.states) >= bounds.states:
                graph.is_complete = False
                return None
            number = numbers[state] = len(graph.states)
            graph.states.append(state)
            graph.before.append((before, step))
            pending.append(number)
        return number

    number_of(product.initial(), 0, 0)
    while pending:
        at = pending.popleft()
        if at % _LOOKS_AT_CLOCK_EVERY == 0 and bounds.is_over():
            graph.is_complete = False
            break
        edges = []
        for step, after in product.steps(graph.states[at]):
            label = steps.setdefault(step, len(steps))
            number = number_of(after, at, label)
            if number is not None and (number != at or step.is_tick or step.passes):
                edges.append((label, number))
        graph.edges.append(tuple(edges))
    graph.edges += [()] * (len(graph.states) - len(graph.edges))
    graph.steps = list(steps)
    return graph
