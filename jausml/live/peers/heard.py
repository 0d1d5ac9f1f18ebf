"""Received messages of a tool, open queries, and explanations for missing answers."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from typing import Any

from jausml.live.messages import Catalogue, MessageError, ServiceEntry
from jausml.live.messages.values import listed
from jausml.live.peers.discovery import label_of
from jausml.live.peers.network import Network
from jausml.live.peers.rendering import printable
from jausml.runtime import JausComponent, PendingQuery
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.services.definitions import ServiceIdentity
from jausml.runtime.wire.message import DecodeError, Message, read_code

ATTEMPTS = 3  # least number of sendings of a query; with long timeouts one each second
_MOST_COMPONENTS = 1024
_MOST_MESSAGES = 64
# Counters of the runtime for datagrams that came and cannot be used.
_UNUSABLE = (
    "judp.version_1",
    "judp.reference_architecture",
    "judp.bad_version",
    "judp.truncated",
    "transport.bad_size",
    "transport.bad_message_type",
    "transport.compressed",
    "transport.bad_source",
    "transport.own_source",
)


class Heard:
    """The received messages of a tool: of each component and message code the last one."""

    def __init__(self, catalogue: Catalogue, network: Network, counters: Counters) -> None:
        self.catalogue = catalogue
        self._network = network
        self._counters = counters
        self._last: dict[JausAddress, dict[int, bytes]] = {}
        self._awaited: list[tuple[JausAddress, Collection[int], SimpleQueue[bytes]]] = []

    @contextmanager
    def awaiting(self, source: JausAddress, codes: Collection[int]) -> Iterator[SimpleQueue[bytes]]:
        """Yields the messages of some codes that come from a component during the block."""
        queue: SimpleQueue[bytes] = SimpleQueue()
        awaited = (source, codes, queue)
        self._awaited.append(awaited)
        try:
            yield queue
        finally:
            self._awaited.remove(awaited)

    def note(self, payload: bytes, source: JausAddress) -> None:
        """Notes a message; of a component that is not awaited, only while there is room."""
        waiting = [awaited for awaited in tuple(self._awaited) if awaited[0] == source]
        has_room = bool(waiting) or len(self._last) < _MOST_COMPONENTS
        if source not in self._last and not has_room:
            return
        known = self._last.setdefault(source, {})
        try:
            code = read_code(payload)
        except DecodeError:
            return
        if code in known or len(known) < _MOST_MESSAGES:
            known[code] = payload
        for _, codes, queue in waiting:
            if code in codes:
                queue.put(payload)

    def of(self, source: JausAddress) -> bool:
        """Returns whether any message came from a component."""
        return source in self._last

    def sources(self) -> tuple[JausAddress, ...]:
        """Returns the components from which messages came."""
        return tuple(self._last)

    def names(self, source: JausAddress) -> list[str]:
        """Returns the names of the messages that came from a component."""
        return [self._name(code) for code in tuple(self._last.get(source, ()))]

    def why(
        self, target: JausAddress, message: str, report: str, services: Sequence[ServiceIdentity]
    ) -> str:
        """Returns the likely reason why a component does not answer a message, in words.

        Args:
            report: Name of the expected answer.
            services: The known services of the component.
        """
        if not self.of(target):
            return f"{target} does not answer {message}; {self._why_silent(target)}"
        fault = self._fault(target, report)
        if fault:
            return f"{target} answers {message} with a {report} that cannot be read: {fault}"
        names = self.names(target)
        answers = [name for name in names if name != report and self._may_answer(name)]
        if not answers:
            sent = listed(names) or "nothing that can be read"
            return f"{target} sends {sent}, but does not answer {message} yet: it may be starting"
        reason = self._reason(message, services)
        return f"{target} answers ({listed(answers)}), but not {message}: {reason}"

    def nothing(self) -> str:
        """Returns the possible causes when no message came at all, the likeliest first."""
        drops = self._counters.drops()
        counts = ", ".join(f"{name} {drops[name]}" for name in _UNUSABLE if name in drops)
        if counts:
            return f"datagrams came that cannot be used ({counts}); {self._network.place}"
        return f"nothing at all was heard; {self._network.hints()}"

    def _why_silent(self, target: JausAddress) -> str:
        others = [str(address) for address in sorted(self._last) if address != target]
        if others:
            return f"nothing came from it, but from {listed(others)}: check the id and that it runs"
        return self.nothing()

    def _fault(self, target: JausAddress, report: str) -> str:
        """Returns why a received report cannot be read; empty if it can, or none came."""
        for payload in tuple(self._last[target].values()):
            if self._name(read_code(payload)) == report:
                try:
                    self.catalogue.decode(payload)
                except MessageError as error:
                    return str(error)
        return ""

    def lack(self, message: str, services: Sequence[ServiceIdentity]) -> str:
        """Returns, in words, that none of the services takes a message; empty if one does."""
        if not services or self._providing(message, services):
            return ""
        own = listed([printable(service.urn.rpartition(":")[2]) for service in services])
        names = self._names_of_takers(message) or "a service with this message"
        return f"it provides {own}, and not {names}"

    def _reason(self, message: str, services: Sequence[ServiceIdentity]) -> str:
        if not services:
            names = self._names_of_takers(message) or "it"
            return f"it does not provide {names}, has no data yet, or refuses"
        provided = self._providing(message, services)
        if provided:
            return f"it provides {provided[0].name}, so it has no data yet or refuses"
        return self.lack(message, services)

    def _providing(self, message: str, services: Sequence[ServiceIdentity]) -> list[ServiceEntry]:
        """Returns the entries of those services that take a message."""
        takers = list(self._takers(message))
        labels = set(map(label_of, services))
        return [
            service
            for service in self.catalogue.services.values()
            if service.label in labels and any(ancestor in takers for ancestor in service.lineage)
        ]

    def _names_of_takers(self, message: str) -> str:
        return listed(list(dict.fromkeys(taker.name for taker in self._takers(message))))

    def _takers(self, message: str) -> Iterator[ServiceEntry]:
        """Yields the services that have a message among their inputs."""
        for service in self.catalogue.services.values():
            if any(entry.name == message for entry in service.inputs):
                yield service

    def _may_answer(self, name: str) -> bool:
        """Returns whether a message may be an answer: one that services only take is none."""
        services = self.catalogue.services.values()
        is_sent = any(output.name == name for service in services for output in service.outputs)
        return is_sent or next(self._takers(name), None) is None

    def _name(self, code: int) -> str:
        entries = self.catalogue.find(code)
        return entries[0].name if entries else f"message 0x{code:04X}"


class OpenQuery:
    """A query that waits for its report."""

    def __init__(self, pending: PendingQuery, answers: SimpleQueue[Any]) -> None:
        self._pending = pending
        self._answers = answers

    @property
    def is_over(self) -> bool:
        """Whether the report came, or the time is over."""
        return not self._answers.empty()

    def cancel(self) -> None:
        """Ends the query."""
        self._pending.cancel()

    def within(self, seconds: float | None) -> Any:
        """Waits at most so many seconds for the report; None when none comes, and it ends."""
        try:
            return self._answers.get(timeout=seconds)
        except Empty:
            self._pending.cancel()
            return None


def start_query(
    component: JausComponent,
    target: JausAddress,
    query: Message,
    report_class: type[Message],
    seconds: float,
) -> OpenQuery:
    """Sends a query of a component, repeated within `seconds`, without waiting."""
    attempts = max(ATTEMPTS, math.ceil(seconds))
    answers: SimpleQueue[Any] = SimpleQueue()
    pending = component.query(
        target,
        query,
        report_class,
        lambda report, _: answers.put(report),
        on_failure=lambda: answers.put(None),
        timeout=seconds / attempts,
        retries=attempts - 1,
    )
    return OpenQuery(pending, answers)
