"""First contact: whether the target is there, what it announces, what it answers."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from jausml.live.messages.legal import listed
from jausml.live.peers.conformance.probe import Probe
from jausml.live.peers.conformance.session import PINGS, Limits, Session
from jausml.live.peers.conformance.trace import Trace
from jausml.live.peers.describing import describe
from jausml.live.peers.services import services_of
from jausml.live.peers.wire import Wire
from jausml.runtime.base.address import WILDCARD_COMPONENT, WILDCARD_NODE, JausAddress
from jausml.runtime.messages import ReportServices
from jausml.runtime.services.discovery_messages import query_all_services
from jausml.runtime.wire.message import DecodeError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.live.messages import Catalogue
    from jausml.live.peers.network import Network
    from jausml.runtime.services.definitions import ServiceIdentity
    from jausml.runtime.wire.message import Message


class TargetNotReached(Exception):  # noqa: N818 - an outcome of the network, not a fault of ours
    """The target does not answer at all."""


@contextmanager
def opened(
    network: Network,
    target: JausAddress,
    catalogue: Catalogue,
    *,
    limits: Limits | None = None,
    timeout: float = 1.0,
    quiet: float = 0.3,
) -> Iterator[Session]:
    """Finds the target and yields the session with it; undoes what is left behind at the end.

    Raises:
        OSError: The network cannot be used as the settings say.
        TargetNotReached: Nothing came from the target.
    """
    trace = Trace(lambda payload: describe(payload, catalogue))
    with Wire(network.settings) as wire:
        probe = Probe(
            wire,
            target,
            network.own,
            trace,
            timeout=timeout,
            quiet=quiet,
            known=network.settings.address_book.get(target),
        )
        if not probe.find_target():
            raise TargetNotReached(f"{target} does not answer; {_why(probe, network)}")
        session = Session(probe, trace, limits or Limits(), catalogue)
        session.services = _announced(session)
        session.ping = _answered_query(session)
        try:
            yield session
        finally:
            session.undo()


def _why(probe: Probe, network: Network) -> str:
    if probe.others:
        others = listed([str(each) for each in sorted(probe.others)])
        return f"nothing came from it, but from {others}: check the id and that it runs"
    return f"nothing at all was heard; {network.hints()}"


def _announced(session: Session) -> Sequence[ServiceIdentity]:
    """Returns the services that the target, or the Discovery server of its subsystem, lists."""
    target = session.probe.target
    report = session.tried(query_all_services(), ReportServices, attempts=2)
    if report is not None:
        own = services_of(report, target.subsystem).get(target)
        if own:
            return own
    query = query_all_services().encode()
    everyone = JausAddress(target.subsystem, WILDCARD_NODE, WILDCARD_COMPONENT)
    for server, endpoint in session.probe.servers(everyone).items():
        payload = session.probe.ask_bystander(server, endpoint, query)
        if payload is None:
            continue
        try:
            found = services_of(ReportServices.decode(payload), target.subsystem)
        except DecodeError:
            continue
        if target in found:
            return found[target]
    return ()


def _answered_query(session: Session) -> tuple[Message, type[Message]]:
    for query, report_class in PINGS:
        if session.tried(query, report_class) is not None:
            return query, report_class
    return PINGS[0]
