"""Rules about connections that do not pass all messages on."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.freshness import holds_state, is_report
from jausml.language.semantics.paths.directions import sound_connections
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject

LEAST_RATE = 0.001
GREATEST_DECIMATION = 1_000_000
LONGEST_TIME = 3600.0
"""What parameters of the runtime take too."""


@rule("JML490", Severity.ERROR, "shaping out of range")
def shaping_range(subject: Subject) -> Iterator[Finding]:
    """A maxRate is 0 or at least 0.001 Hz, a decimation 1 to 1000000, an ageLimit 0 to 3600 s.

    Bad: `decimation="0"`

    Good: `decimation="5"`
    """
    for each in subject.instances(bridge.Connection, needs=("name",)):
        rate, seconds = each.maxRate, each.ageLimit
        if rate != 0 and not (math.isfinite(rate) and rate >= LEAST_RATE):
            message = f"maxRate {rate:g} of '{each.name}' is neither 0 nor {LEAST_RATE:g} or more"
            yield Finding(each, message, "maxRate")
        if not 1 <= each.decimation <= GREATEST_DECIMATION:
            message = f"decimation {each.decimation} of '{each.name}' is not 1 to"
            yield Finding(each, f"{message} {GREATEST_DECIMATION}", "decimation")
        if not 0 <= seconds <= LONGEST_TIME:
            message = f"ageLimit {seconds:g} of '{each.name}' is not 0 to {LONGEST_TIME:g} s"
            yield Finding(each, message, "ageLimit")


@rule("JML491", Severity.ERROR, "shaping of what is asked for")
def queries_unshaped(subject: Subject) -> Iterator[Finding]:
    """A connection that uses queries determines with its rate how many messages come.

    Bad: `direction="jausToRos" exchange="query" rate="10" maxRate="5"`

    Good: the same with `rate="5"` alone
    """
    for each in sound_connections(subject):
        if each.exchange.name != "query" or each.direction.name != "jausToRos":
            continue
        for feature, is_said in (
            ("maxRate", each.maxRate != 0),
            ("decimation", each.decimation != 1),
        ):
            if is_said:
                message = f"'{each.name}' asks as often as its rate says"
                yield Finding(each, message, feature, f"leave {feature} out, and state the rate")


@rule("JML492", Severity.WARNING, "maxRate that changes nothing")
def rates_reached(subject: Subject) -> Iterator[Finding]:
    """A maxRate is below the rate at which messages of a periodic event come.

    That is the rate of the connection, or the frequency of the bridge, of each of its peers, and
    the part of it that the decimation leaves.

    Bad: `exchange="periodicEvent" rate="10" maxRate="20"`

    Good: `exchange="periodicEvent" rate="10"`
    """
    for each in sound_connections(subject):
        owner = each.eContainer()
        if each.exchange.name != "periodicEvent" or each.direction.name != "jausToRos":
            continue
        if not 0 < each.maxRate < math.inf or each.search is not None or owner is None:
            continue
        rate = (each.rate or owner.frequency) * max(len(each.peers), 1) / max(each.decimation, 1)
        if each.maxRate >= rate:
            message = f"no more than {rate:g} messages of '{each.name}' come each second"
            yield Finding(each, message, "maxRate", "leave maxRate out")


@rule("JML493", Severity.WARNING, "shaping that loses the last word")
def last_words_kept(subject: Subject) -> Iterator[Finding]:
    """A message that stays valid until the next one always passes.

    A decimation passes one of several messages, and the last one of a command, of a change or of a
    state may be another. A maxRate does not lose it. A state is as old as its last change; an
    ageLimit would treat it as late.

    Bad: `decimation="10"` for SetWrenchEffort, or for an everyChangeEvent

    Good: the same with `maxRate="5"`
    """
    for each in sound_connections(subject):
        changes = each.exchange.name == "everyChangeEvent" and each.direction.name == "jausToRos"
        is_command = stops.is_command(each)
        is_state = changes or (is_report(each) and holds_state(each)) or _is_latched(each)
        if each.decimation > 1 and (is_command or is_state):
            message = f"the decimation of '{each.name}' may leave its last message out"
            yield Finding(each, message, "decimation", "state a maxRate")
        if each.ageLimit > 0 and is_state and not is_command:
            message = f"'{each.name}' holds a state, whose age does not make it wrong"
            yield Finding(each, message, "ageLimit", "leave ageLimit out")


def _is_latched(connection: bridge.Connection) -> bool:
    return connection.direction.name == "rosToJaus" and any(
        each.join is None and each.qos is not None and each.qos.durability.name != "volatile"
        for each in connection.topics
    )
