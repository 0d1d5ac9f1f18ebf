"""Budgets of time: how old a value may be in the worst case, and times that do not go together.

A budget has the times that the model and the runtime decide. The network, the processors and what
happens before the source speaks are not in it: `jausml latency` measures them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.reports import freshness_of, holds_state, is_report
from jausml.language.semantics.directions import is_to_ros
from jausml.views.analysis.sizes import runtime_constants
from jausml.views.analysis.streams import ASSUMED, Stream, is_single, keeps_control

_HELD = "the last message stands, for a reason that the model gives"


@dataclass(frozen=True)
class Step:
    """A part of a budget."""

    name: str
    seconds: float


@dataclass(frozen=True)
class Budget:
    """Times that add up to the worst case of one situation.

    `case`: the situation: `normal`, `queue_full`, `one_lost_packet`, `source_dead` or
    `controller_dead`. `never`: why there is no bound, empty where there is one.
    """

    case: str
    steps: tuple[Step, ...] = ()
    never: str = ""

    @property
    def seconds(self) -> float | None:
        """The sum; None where there is no bound."""
        return None if self.never else sum(step.seconds for step in self.steps)


def budgets_of(
    connection: bridge.Connection, streams: list[Stream], topic_rate: float
) -> tuple[Budget, ...]:
    """Returns the budgets of a connection.

    `topic_rate`: messages each second of its topics, where these are the source.
    """
    carried = [stream for stream in streams if stream.kind in ("message", "event", "report")]
    if not carried:
        return ()
    slowest = min(carried, key=lambda stream: stream.hertz)
    period = 1 / slowest.hertz
    source_period = period if is_to_ros(connection) else 1 / topic_rate
    normal = (*_normal(connection, slowest, period), *_shaped(connection, source_period))
    budgets = [Budget("normal", normal)]
    if not is_to_ros(connection):
        budgets.append(Budget("queue_full", (*normal, _queue(connection, 1 / topic_rate))))
    budgets.append(Budget("one_lost_packet", (*normal, _loss(connection, slowest, period))))
    budgets.append(_source_dead(connection, slowest, period))
    if keeps_control(connection) or (stops.carries_commands(connection) and is_to_ros(connection)):
        budgets.append(_control_lapses(connection))
    return tuple(budgets)


def _normal(connection: bridge.Connection, stream: Stream, period: float) -> tuple[Step, ...]:
    """Returns the waits of a value when all is well."""
    if is_single(connection):
        return ()  # what comes is passed on
    if connection.exchange.name == "everyChangeEvent":
        return ()
    what = "query" if stream.kind == "report" else "event"
    return (Step(f"period of the {what}, {_hertz(stream)}", period),)


def _shaped(connection: bridge.Connection, period: float) -> tuple[Step, ...]:
    """Returns the waits of a value because fewer messages shall pass than come."""
    steps = []
    if connection.decimation > 1:
        name = f"decimation, one of {connection.decimation} messages"
        steps.append(Step(name, (connection.decimation - 1) * period))
    if connection.maxRate > 0:
        steps.append(Step(f"maxRate of {connection.maxRate:g} Hz", 1 / connection.maxRate))
    return tuple(steps)


def _hertz(stream: Stream) -> str:
    return f"{'assumed ' if stream.basis == ASSUMED else ''}{stream.hertz:g} Hz"


def _queue(connection: bridge.Connection, period: float) -> Step:
    """Returns how long a message waits behind a full queue of its topic."""
    constants = runtime_constants()
    depths = [_depth(topic) for topic in connection.topics if topic.join is None]
    depth = max(depths, default=constants.least_depth)
    limit = constants.queue_age_limit
    if depth * period > limit:
        return Step(f"queue of {depth}, older messages are dropped", limit)
    return Step(f"queue of {depth} messages", depth * period)


def _depth(topic: bridge.Topic) -> int:
    least = runtime_constants().least_depth
    if topic.qos is None:
        return least
    depth = int(topic.qos.depth)
    return max(depth, least) if topic.qos.durability.name == "volatile" else depth


def _loss(connection: bridge.Connection, stream: Stream, period: float) -> Step:
    """Returns the delay by one lost packet."""
    if stream.is_acknowledged:
        return Step("repetition of the packet", runtime_constants().acknowledge_timeout)
    if connection.exchange.name == "everyChangeEvent":
        return Step(f"until the next change, {_hertz(stream)}", period)
    what = "message" if is_single(connection) else "report"
    return Step(f"until the next {what}, {_hertz(stream)}", period)


def _source_dead(connection: bridge.Connection, stream: Stream, period: float) -> Budget:
    """Returns when the other side learns that the source is dead."""
    case = "source_dead"
    timeout = stops.silence_timeout(connection)
    if is_report(connection):
        return _stale_report(connection, stream, period)
    if timeout > 0 and (stops.has_stop(connection) or not stops.carries_commands(connection)):
        steps = [Step("silence time-out", timeout)]
        if not is_to_ros(connection):
            steps.append(_repeated())
        return Budget(case, tuple(steps))
    if stops.carries_commands(connection):
        if stops.keeps_last_command(connection):
            return Budget(case, never=_HELD)
        return Budget(case, never="the last message stands: no silence time-out")
    if is_to_ros(connection) and not is_single(connection):
        return Budget(case, never="nothing is published any more, and no safe value is stated")
    return Budget(case, never="nothing is sent any more, and no silence time-out is stated")


def _stale_report(connection: bridge.Connection, stream: Stream, period: float) -> Budget:
    timeout = freshness_of(connection) or stops.silence_timeout(connection)
    if not timeout:
        reason = "the topic holds a state" if holds_state(connection) else "no freshness is stated"
        return Budget("source_dead", never=f"the last report stands: {reason}")
    steps = [Step("freshness of the topic", timeout)]
    if connection.exchange.name != "everyChangeEvent":
        steps.append(Step(f"until the next report, {_hertz(stream)}", period))
    return Budget("source_dead", tuple(steps))


def _control_lapses(connection: bridge.Connection) -> Budget:
    """Returns when what was commanded stops after the process that commands has died."""
    if is_to_ros(connection) and stops.keeps_last_command(connection):
        return Budget("controller_dead", never=_HELD)
    if is_to_ros(connection):
        owner = connection.eContainer()
        seconds = [int(owner.controlTimeout)] if owner is not None else []
        who = "control of the bridge lapses"
    else:
        seconds = [int(peer.controlTimeout) for peer in connection.peers]
        who = "control of the peer lapses"
    if not seconds:
        return Budget("controller_dead", never="peers are found at run time: theirs is not known")
    if not all(seconds):
        return Budget("controller_dead", never="control never lapses (controlTimeout 0)")
    return Budget("controller_dead", (Step(who, float(max(seconds))),))


def _repeated() -> Step:
    """Returns the time in which the stop is repeated until it is acknowledged."""
    constants = runtime_constants()
    number = constants.acknowledge_retries
    return Step(f"the stop, repeated up to {number} times", number * constants.acknowledge_timeout)


FEWEST_PERIODS = 2
"""Periods that a silence time-out must hold: one message may be lost."""


def warnings_of(
    connection: bridge.Connection, streams: list[Stream], topic_rate: float
) -> Iterator[str]:
    """Yields the contradictions in a connection.

    `topic_rate`: messages each second of its topics, where these are the source.
    """
    yield from _rates(connection)
    yield from _times(connection, streams, topic_rate)
    held = runtime_constants().held_by_peers
    for stream in streams:
        if stream.packets > held:
            yield (
                f"{stream.message} takes {stream.packets} packets; some peers hold no more than "
                f"{held} of an unfinished message"
            )


def _rates(connection: bridge.Connection) -> Iterator[str]:
    owner = connection.eContainer()
    if not is_to_ros(connection) or connection.exchange.name != "periodicEvent" or owner is None:
        return
    rate = float(connection.rate or owner.frequency)
    for peer in connection.peers:
        yield from asked_rate(peer, rate)


def asked_rate(provider: jaus.Component, rate: float) -> Iterator[str]:
    """Yields the faults of the rate that a client asks of a provider."""
    constants = runtime_constants()
    if rate > constants.highest_event_rate:
        yield f"{rate:g} Hz is more than an event can have, {constants.highest_event_rate:g} Hz"
    elif not provider.external and rate < constants.event_rate_min:
        lowest = constants.event_rate_min
        yield f"{provider.name} gives {lowest:g} Hz at least, {rate:g} Hz are asked"


def _times(
    connection: bridge.Connection, streams: list[Stream], topic_rate: float
) -> Iterator[str]:
    arriving = [stream for stream in streams if stream.kind in ("message", "event", "report")]
    if not is_to_ros(connection):
        rate, is_assumed = topic_rate, True
    elif arriving:
        slowest = min(arriving, key=lambda stream: stream.hertz)
        rate, is_assumed = slowest.hertz, slowest.basis == ASSUMED
    else:
        return
    how = f"{'assumed ' if is_assumed else ''}period of {1 / rate:g} s"
    timeout = stops.silence_timeout(connection)
    if 0 < timeout < FEWEST_PERIODS / rate:
        yield f"silence time-out of {timeout:g} s is shorter than {FEWEST_PERIODS} times the {how}"
    freshness = freshness_of(connection)
    if 0 < freshness < 1 / rate:
        yield f"freshness of {freshness:g} s is shorter than the {how}"
