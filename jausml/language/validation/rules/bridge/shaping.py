"""Rules about shaping: which messages a connection passes on, of those that it could."""

from __future__ import annotations

import math
from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.limits import (
    GREATEST_DECIMATION,
    LEAST_PACE,
    LONGEST_TIME,
)
from jausml.language.semantics.connections.reports import holds_state, is_report
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.scopes import is_sound
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, rule


@rule("JML490", "shaping out of range", kinds=bridge.Connection, needs=("name",))
def shaping_range(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A maxRate is 0 or at least 0.001 Hz, a decimation 1 to 1000000, an ageLimit 0 to 3600 s.

    Bad: `decimation="0"`

    Good: `decimation="5"`
    """
    rate, seconds = connection.maxRate, connection.ageLimit
    if rate != 0 and not (math.isfinite(rate) and rate >= LEAST_PACE):
        message = f"maxRate {rate:g} of '{connection.name}' is neither 0 nor {LEAST_PACE:g} or more"
        yield Finding(connection, message, "maxRate")
    if not 1 <= connection.decimation <= GREATEST_DECIMATION:
        message = f"decimation {connection.decimation} of '{connection.name}' is not 1 to"
        yield Finding(connection, f"{message} {GREATEST_DECIMATION}", "decimation")
    if not 0 <= seconds <= LONGEST_TIME:
        message = f"ageLimit {seconds:g} of '{connection.name}' is not 0 to {LONGEST_TIME:g} s"
        yield Finding(connection, message, "ageLimit")


@rule("JML491", "shaping of what is asked for", kinds=bridge.Connection, condition=is_sound)
def queries_unshaped(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection that uses queries determines with its rate how many messages come.

    Bad: `direction="jausToRos" exchange="query" rate="10" maxRate="5"`

    Good: the same with `rate="5"` alone
    """
    if connection.exchange.name != "query" or not is_to_ros(connection):
        return
    for feature, is_said in (
        ("maxRate", connection.maxRate != 0),
        ("decimation", connection.decimation != 1),
    ):
        if is_said:
            message = f"'{connection.name}' asks as often as its rate says"
            yield Finding(connection, message, feature, f"leave {feature} out, and state the rate")


@rule(
    "JML492",
    "maxRate that changes nothing",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def rates_reached(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A maxRate is below the rate at which messages of a periodic event come.

    That is the rate of the connection, or the frequency of the bridge, of each of its peers, and
    the part of it that the decimation leaves.

    Bad: `exchange="periodicEvent" rate="10" maxRate="20"`

    Good: `exchange="periodicEvent" rate="10"`
    """
    owner = connection.eContainer()
    if connection.exchange.name != "periodicEvent" or not is_to_ros(connection):
        return
    if not 0 < connection.maxRate < math.inf or connection.search is not None or owner is None:
        return
    rate = (
        (connection.rate or owner.frequency)
        * max(len(connection.peers), 1)
        / max(connection.decimation, 1)
    )
    if connection.maxRate >= rate:
        message = f"no more than {rate:g} messages of '{connection.name}' come each second"
        yield Finding(connection, message, "maxRate", "leave maxRate out")


@rule(
    "JML493",
    "shaping that loses the last word",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def last_words_kept(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A message that stays valid until the next one always passes.

    A decimation passes one of several messages, and the last one of a command, of a change or of a
    state may be another. A maxRate does not lose it. A state is as old as its last change; an
    ageLimit would treat it as late.

    Bad: `decimation="10"` for SetWrenchEffort, or for an everyChangeEvent

    Good: the same with `maxRate="5"`
    """
    changes = connection.exchange.name == "everyChangeEvent" and is_to_ros(connection)
    is_command = stops.carries_commands(connection)
    is_state = (
        changes or (is_report(connection) and holds_state(connection)) or _is_latched(connection)
    )
    if connection.decimation > 1 and (is_command or is_state):
        message = f"the decimation of '{connection.name}' may leave its last message out"
        yield Finding(connection, message, "decimation", "state a maxRate")
    if connection.ageLimit > 0 and is_state and not is_command:
        message = f"'{connection.name}' holds a state, whose age does not make it wrong"
        yield Finding(connection, message, "ageLimit", "leave ageLimit out")


def _is_latched(connection: bridge.Connection) -> bool:
    return not is_to_ros(connection) and any(
        topic.join is None and topic.qos is not None and topic.qos.durability.name != "volatile"
        for topic in connection.topics
    )
