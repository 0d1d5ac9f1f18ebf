"""Checks of the codecs: every query of the announced services and its report (AS5684, encoding).

Only queries are sent, never a command.
"""

from __future__ import annotations

import inspect
from functools import partial
from typing import Any

from jausml.language.wire.kinds import PRESENCE_VECTOR
from jausml.live.messages import EncodeError, MessageEntry, MessageError, ServiceEntry
from jausml.live.messages.codec import PRESENCE
from jausml.live.peers.conformance.check import Check
from jausml.live.peers.conformance.evidence import CheckFailed, CheckSkipped
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.conformance.steps import skips
from jausml.live.peers.entry_messages import optional_bits, plain_query, presence_holder
from jausml.runtime.services.definitions import ServiceIdentity

_MOST_BITS = 32
_OF_WIDER_SCOPE = ("QueryConfiguration", "QuerySubsystemList")
_ATTEMPTS = 2


def requires(session: Session) -> str:
    """Returns why the group cannot run, or nothing."""
    return "" if session.services else "the target announces no services"


def checks(session: Session) -> tuple[Check, ...]:
    """Returns one check for each query of the announced services that we know."""
    checks_by_id: dict[str, Check] = {}
    for identity in session.services:
        service = session.known(identity)
        service_checks = [_unknown(session, identity)] if service is None else _of_service(service)
        for check in service_checks:
            checks_by_id.setdefault(check.id, check)
    return tuple(checks_by_id.values())


def _of_service(service: ServiceEntry) -> list[Check]:
    queries = [entry for entry in service.inputs if entry.name.startswith("Query")]
    return [_check(service, query) for query in queries]


def _unknown(session: Session, identity: ServiceIdentity) -> Check:
    """Returns a check that says why nothing of a service is checked."""
    version = f"{identity.major}.{identity.minor}"
    versions = [
        known_version for urn, known_version in session.catalogue.services if urn == identity.urn
    ]
    known = f"known are the versions {', '.join(versions)}" if versions else "the library lacks it"

    return Check(
        f"codecs.{identity.urn.rpartition(':')[2]}",
        f"Answers the queries of {identity.urn} {version}",
        "AS5684 encoding",
        "The layouts of the service are not known, so that nothing of it is asked for.",
        (skips(f"{known}; --model FILE adds a service"),),
    )


def _check(service: ServiceEntry, query: MessageEntry) -> Check:
    return Check(
        f"codecs.{service.name}.{query.name}",
        f"Answers {query.name} with a report that decodes",
        f"AS5684 encoding; {service.label}, message {query.code_text}",
        inspect.getdoc(answers) or "",
        (partial(answers, service=service, query=query),),
    )


def answers(session: Session, service: ServiceEntry, query: MessageEntry) -> None:
    """Sends the query and decodes its report.

    The report must have no bytes left over, presence vectors without unknown bits, and legal
    values. If the query has a presence vector, all fields, none and each one alone are asked for;
    the standard lets the report hold more or fewer fields, so that a deviation is only noted.
    """
    reports = _reports_of(service, query)
    fields = plain_query(query)
    holder = presence_holder(fields)
    if holder is not None:
        _judge_subsets(session, query, fields, holder, reports)
        return
    answer = _ask(session, query, fields, reports)
    session.skip_unless(
        answer is not None or query.name not in _OF_WIDER_SCOPE,
        "not answered; only a Discovery service of the whole subsystem or node has to",
    )
    session.skip_unless(
        answer is not None or not fields,
        f"not answered with the fields {fields}; the target may have nothing for them",
    )
    _judge(session, query, answer, reports)


def _judge_subsets(
    session: Session,
    query: MessageEntry,
    fields: dict[str, Any],
    holder: dict[str, Any],
    reports: tuple[MessageEntry, ...],
) -> None:
    """Asks for all fields, for none and for each one alone."""
    bits = optional_bits(reports)
    holder[PRESENCE_VECTOR] = bits
    everything = _judge(session, query, _ask(session, query, fields, reports), reports)
    others: list[str] = []
    for wish in (0, *(1 << index for index in range(_MOST_BITS) if bits >> index & 1)):
        holder[PRESENCE_VECTOR] = wish
        presence = _judge(session, query, _ask(session, query, fields, reports), reports)
        if presence != wish & everything:
            others.append(f"{wish:#x} gives {presence:#x}")
    if others:
        session.note(
            f"the presence vector of the query does not choose the fields of the report: of "
            f"{everything:#x} that it can give, {', '.join(others[:4])}, ..."
        )


def _reports_of(service: ServiceEntry, query: MessageEntry) -> tuple[MessageEntry, ...]:
    """Returns the reports that may answer a query: by name, else all outputs of the service."""
    wanted = query.name.replace("Query", "Report", 1)
    outputs = [entry for ancestor in service.lineage for entry in ancestor.outputs]
    named = tuple(entry for entry in outputs if entry.name == wanted)
    return named or tuple(outputs)


def _ask(
    session: Session, query: MessageEntry, fields: dict[str, Any], reports: tuple[MessageEntry, ...]
) -> bytes | None:
    """Returns the payload of the report, or None when none comes."""
    client = session.first
    try:
        payload = query.encode(fields)
    except EncodeError:
        raise CheckSkipped(f"no plain {query.name} could be made") from None
    codes = tuple(entry.code for entry in reports)
    client.inbox.clear()
    for _ in range(_ATTEMPTS):
        client.put(client.packet(payload))
        received = client.first_of(codes)
        if received is not None:
            return received.payload
    return None


def _judge(
    session: Session, query: MessageEntry, answer: bytes | None, reports: tuple[MessageEntry, ...]
) -> int:
    """Decodes a report and returns the first presence vector in it."""
    if answer is None:
        raise CheckFailed(f"{query.name} is not answered")
    code = int.from_bytes(answer[:2], "little")
    report = next(entry for entry in reports if entry.code == code)
    try:
        fields = report.decode(answer)
    except MessageError as error:
        raise CheckFailed(f"{report.name} does not decode: {error}") from error
    try:
        again = report.encode(fields)
    except MessageError as error:
        raise CheckFailed(f"{report.name} holds an illegal value: {error}") from error
    if again != answer:
        session.note(f"{report.name} is coded in an unusual way; we would send {again.hex()}")
    return _presence_of(fields)


def _presence_of(fields: Any) -> int:
    if not isinstance(fields, dict):
        return 0
    if PRESENCE in fields:
        return int(fields[PRESENCE])
    return next((presence for field in fields.values() if (presence := _presence_of(field))), 0)
