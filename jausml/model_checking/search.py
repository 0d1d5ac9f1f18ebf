"""Explicit search of a product, breadth first, and the properties that it must have.

These are safety, stops in time, no deadlock, no livelock.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol


class Step(NamedTuple):
    """A step between two states.

    Attributes:
        receiver: Receiver of the message; empty without one.
        is_tick: Whether it is one step of time.
        passes: Source of the command that takes effect by it; empty without one.
        on_to: Name of the next receiver, to which the message is passed on.
        is_helpful: Whether it is also possible if no other client interferes.
        is_restart: Whether all begins anew by it, which is no way out of a trap.
    """

    actor: str
    what: str
    receiver: str = ""
    is_tick: bool = False
    passes: str = ""
    on_to: str = ""
    is_helpful: bool = False
    is_restart: bool = False


TIME = Step("time", "passes", is_tick=True, is_helpful=True)  # one step of time


class Product(Protocol):
    """Parts of a system, their possible steps, and the properties that must hold."""

    def initial(self) -> Any:
        """Returns the state at the start."""

    def steps(self, state: Any) -> Iterable[tuple[Step, Any]]:
        """Yields the possible steps in a state, each with the state after it."""

    @property
    def bound(self) -> int:
        """Ticks after the loss of a source in which its stop is due; 0 for never."""

    @property
    def late_stop(self) -> str:
        """The fault when the stop is late; `{bound}` in it stands for the time."""

    def source(self, state: Any) -> str:
        """Returns the source of the command in effect, which could be lost; empty without one."""

    def is_over(self, state: Any) -> bool:
        """Returns whether the state is final, so that no further step is required."""

    def place(self, state: Any) -> str:
        """Returns the state of the machine; empty for a product without machine."""

    def fault(self, state: Any, step: Step, after: Any) -> str:
        """Returns the fault of a transition; empty for none."""

    def omissions(self, states: Sequence[Any]) -> Iterable[str]:
        """Yields what of the steps in searched states was left out, in words."""


class Bounds(NamedTuple):
    """Limits of a search: number of states, and a function that ends it, such as at a time."""

    states: int
    is_over: Callable[[], bool]


class Edge(NamedTuple):
    """The numbers of a step and of the state after it."""

    step: int
    after: int


@dataclass
class Graph:
    """The reached states, by number; 0 is the initial one.

    Attributes:
        edges: The edges that leave each state.
        before: For each state the number of the one before it, and of the step between.
        omissions: What was not searched, in words; empty if all was.
    """

    states: list[Any] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    edges: list[tuple[Edge, ...]] = field(default_factory=list)
    before: list[tuple[int, int]] = field(default_factory=list)
    omissions: list[str] = field(default_factory=list)

    def way_to(self, state: int) -> list[Edge]:
        """Returns the shortest way from the start to a state."""
        way: list[Edge] = []
        while state:
            previous, step = self.before[state]
            way.append(Edge(step, state))
            state = previous
        return way[::-1]

    def transitions(self) -> Iterator[tuple[int, int, int]]:
        """Yields all transitions: state, step, state."""
        for state, edges in enumerate(self.edges):
            for step, after in edges:
                yield state, step, after


_LOOKS_AT_CLOCK_EVERY = 1024


def explore(product: Product, bounds: Bounds) -> Graph:
    """Returns the reachable states within the bounds."""
    graph = Graph()
    numbers: dict[Any, int] = {}
    steps: dict[Step, int] = {}
    pending: deque[int] = deque()
    is_cut = False

    def number_of(state: Any, before: int, step: int) -> int | None:
        nonlocal is_cut
        number = numbers.get(state)
        if number is None:
            if len(graph.states) >= bounds.states:
                is_cut = True
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
            is_cut = True
            break
        edges: list[Edge] = []
        for step, after in product.steps(graph.states[at]):
            label = steps.setdefault(step, len(steps))
            number = number_of(after, at, label)
            # A step that changes nothing counts only where time passes or a command takes effect.
            if number is not None and (number != at or step.is_tick or step.passes):
                edges.append(Edge(label, number))
        graph.edges.append(tuple(edges))
    # Reached states beyond the bounds have no edges.
    graph.edges += [()] * (len(graph.states) - len(graph.edges))
    graph.steps = list(steps)
    graph.omissions += product.omissions(graph.states)
    graph.omissions += [f"only {len(graph.states)} states were searched"] if is_cut else []
    return graph


DEADLOCK, LIVELOCK, LATE_STOP, CONTROL = "JML931", "JML932", "JML933", "JML934"


@dataclass(frozen=True)
class Violation:
    """A property that does not hold.

    Attributes:
        way: The edges from the start.
        repeats: Number of last steps of the way that repeat for ever.
    """

    rule: str
    message: str
    way: tuple[Edge, ...]
    repeats: int = 0


def violations(product: Product, graph: Graph) -> list[Violation]:
    """Returns a shortest violation of each property that does not hold.

    What is not to be reached in what was not searched to its end is not judged.
    """
    candidates = [_unsafe(product, graph), _late_stop(product, graph)]
    if not graph.omissions:
        candidates += [
            _deadlock(product, graph) or _trap(product, graph),
            _livelock(product, graph),
        ]
    return [violation for violation in candidates if violation is not None]


def _unsafe(product: Product, graph: Graph) -> Violation | None:
    for state, step, after in graph.transitions():
        states = graph.states
        message = product.fault(states[state], graph.steps[step], states[after])
        if message:
            return Violation(CONTROL, message, (*graph.way_to(state), Edge(step, after)))
    return None


def _late_stop(product: Product, graph: Graph) -> Violation | None:
    """Returns a violation by a command that is in effect too long after its source is lost."""
    lasting = _lasting(product, graph)
    still = {state for state, edges in enumerate(lasting) if edges is not None}
    for _ in range(max(product.bound, 1)):
        still = _after_tick(lasting, still)
        if not still:
            return None
    return Violation(LATE_STOP, product.late_stop, _late_way(product, graph, lasting))


# For each state with a command in effect, the transitions without its source that keep it so:
# step, next state, and whether time passes. None for other states.
_Lasting = list[list[tuple[int, int, bool]] | None]


def _lasting(product: Product, graph: Graph) -> _Lasting:
    sources = [product.source(state) for state in graph.states]
    edges_by_state: _Lasting = [[] if source else None for source in sources]
    for state, step, after in graph.transitions():
        source, edges = sources[state], edges_by_state[state]
        edge = graph.steps[step]
        # The source itself is silent, and a command of another source has its own time.
        if edges is not None and edge.actor != source and sources[after] == source:
            edges.append((step, after, edge.is_tick))
    return edges_by_state


def _after_tick(lasting: _Lasting, states: set[int]) -> set[int]:
    """Returns the states in which a command is still in effect after one tick."""
    pending, seen, later_states = list(states), set(states), set()
    while pending:
        for _, after, is_tick in lasting[pending.pop()] or ():
            if is_tick:
                later_states.add(after)
            elif after not in seen:
                seen.add(after)
                pending.append(after)
    return later_states


def _late_way(product: Product, graph: Graph, lasting: _Lasting) -> tuple[Edge, ...]:
    """Returns a shortest way on which a command is in effect too long."""
    starts = ((state, 0) for state, edges in enumerate(lasting) if edges is not None)
    before: dict[tuple[int, int], tuple[tuple[int, int], int] | None] = dict.fromkeys(starts)
    # Breadth first from all of them, so that the first hit is a shortest way.
    pending = deque(before)
    while pending:
        at = pending.popleft()
        state, ticks = at
        for step, after, is_tick in lasting[state] or ():
            reached = (after, ticks + is_tick)
            if reached in before:
                continue
            before[reached] = (at, step)
            pending.append(reached)
            if reached[1] == max(product.bound, 1):
                return _traced(graph, before, reached)
    raise AssertionError("there is such a way: it was just found")


def _traced(
    graph: Graph,
    before: dict[tuple[int, int], tuple[tuple[int, int], int] | None],
    reached: tuple[int, int],
) -> tuple[Edge, ...]:
    way: list[Edge] = []
    while (previous := before[reached]) is not None:
        way.append(Edge(previous[1], reached[0]))
        reached = previous[0]
    return (*graph.way_to(reached[0]), *way[::-1])


def _deadlock(product: Product, graph: Graph) -> Violation | None:
    """Returns a violation by a state from which no command can take effect any more."""
    stuck = _stuck(product, graph, lambda step: not step.is_restart)
    if stuck is None:
        return None
    return Violation(DEADLOCK, "no command can take effect any more", tuple(graph.way_to(stuck)))


def _trap(product: Product, graph: Graph) -> Violation | None:
    """Returns a violation by the nearest state from which the machine cannot return.

    A state that is left at the start and never entered need not be reached again, unless only one
    other state can be reached instead.
    """
    places = [product.place(state) for state in graph.states]
    edges = [
        (state, after)
        for state, step, after in graph.transitions()
        if not graph.steps[step].is_restart
    ]
    entered = {places[after] for state, after in edges if places[state] != places[after]}
    origins: list[list[int]] = [[] for _ in places]
    for state, after in edges:
        origins[after].append(state)
    traps = []
    for place in dict.fromkeys(places):
        predecessors = _leading(origins, [at for at, other in enumerate(places) if other == place])
        outside = [at for at in range(len(places)) if at not in predecessors]
        lost = [at for at in outside if not product.is_over(graph.states[at])]
        if lost and (place in entered or len({places[at] for at in lost}) == 1):
            traps.append((lost[0], place))
    if not traps:
        return None
    at, place = min(traps)
    message = f"{places[at]} is a trap: {place} is never reached again"
    return Violation(DEADLOCK, message, tuple(graph.way_to(at)))


def _leading(origins: list[list[int]], pending: list[int]) -> set[int]:
    """Returns the states from which given states can be reached, including these."""
    predecessors = set(pending)
    while pending:
        fresh = [state for state in origins[pending.pop()] if state not in predecessors]
        predecessors.update(fresh)
        pending += fresh
    return predecessors


def _livelock(product: Product, graph: Graph) -> Violation | None:
    """Returns a violation by a state without effect of any request, though no client interferes."""
    stuck = _stuck(product, graph, lambda step: step.is_helpful)
    if stuck is None:
        return None
    way, cycle = graph.way_to(stuck), _cycle(graph, stuck)
    message = "time goes on and no command takes effect, though nobody hinders it"
    return Violation(LIVELOCK, message, (*way, *cycle), repeats=len(cycle))


def _stuck(product: Product, graph: Graph, counts: Callable[[Step], bool]) -> int | None:
    """Returns the nearest state from which no command takes effect by the counted steps."""
    counted = [counts(step) for step in graph.steps]
    origins: list[list[int]] = [[] for _ in graph.states]
    pending: list[int] = []
    for state, step, after in graph.transitions():
        if counted[step]:
            origins[after].append(state)
            if graph.steps[step].passes:
                pending.append(state)
    lively = _leading(origins, pending)
    for number, state in enumerate(graph.states):
        if number not in lively and not product.is_over(state):
            return number
    return None


def _cycle(graph: Graph, state: int) -> list[Edge]:
    """Returns the steps of time from a state on, until a state repeats."""
    way: list[Edge] = []
    seen = {state: 0}
    # Time can pass in each state, and the states are finite, so one repeats.
    while True:
        tick = next(edge for edge in graph.edges[state] if graph.steps[edge.step].is_tick)
        way.append(tick)
        state = tick.after
        if state in seen:
            return way
        seen[state] = len(way)
