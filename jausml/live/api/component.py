"""A JAUS component without a model: asks, watches, commands and answers others by names.

with Component("10.1.1") as operator:
    print(operator.query("100.1.1", "VelocityState"))
"""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from inspect import iscoroutinefunction
from queue import Empty, Full, Queue
from typing import TYPE_CHECKING, Any

from jausml.live.api.payloads import catalogue
from jausml.live.peers.entry_messages import find_exchange, find_message
from jausml.live.peers.network import DEFAULT_GROUP, Network, component_address, fault, identified
from jausml.live.peers.operator import Identity, Operator, running_operator
from jausml.runtime.base.settings import JUDP_PORT, TransportSettings
from jausml.runtime.messages import Resume
from jausml.runtime.services.definitions import ServiceIdentity, Status

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from jausml.live.api.payloads import Models
    from jausml.live.messages import Catalogue, MessageEntry
    from jausml.runtime.base.address import JausAddress

Fields = dict[str, Any]
"""Fields of a message by their names, without the one record of a body."""

_REMEDY = "Give all components that speak with each other another port="

MOST_WAITING = 1000
"""Reports that wait to be taken; then the oldest is thrown away."""


@dataclass(frozen=True)
class Received:
    """A message that came.

    Attributes:
        fields: Its fields, in units of the standard.
    """

    name: str
    fields: Fields
    sender: str


class Subscription:
    """Reports of an event, to be iterated over; ends with `close`.

    Attributes:
        missed: Reports that were thrown away because nobody took them in time, the oldest first.
    """

    def __init__(self) -> None:
        self.missed = 0
        self._reports: Queue[Received | None] = Queue(MOST_WAITING)
        self._cancel: Callable[[], None] | None = None

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Received]:
        """Yields reports as they come, until the subscription is closed."""
        while (report := self._reports.get()) is not None:
            yield report

    def next(self, timeout: float | None = None) -> Received:
        """Returns the next report.

        Args:
            timeout: Seconds to wait; None waits forever.

        Raises:
            TimeoutError: None came in time, or the subscription is closed.
        """
        try:
            report = self._reports.get(timeout=timeout)
        except Empty:
            raise TimeoutError(f"no report within {timeout:g} s") from None
        if report is None:
            raise TimeoutError("the subscription is closed")
        return report

    def close(self) -> None:
        """Cancels the event."""
        if self._cancel is not None:
            self._cancel()
            self._cancel = None
        self.take(None)

    def take(self, report: Received | None) -> None:
        """Takes a report, on another thread; None ends the iteration."""
        while True:
            try:
                self._reports.put_nowait(report)
            except Full:
                self._drop()
            else:
                return

    def begin(self, cancel: Callable[[], None]) -> None:
        """Takes what cancels the event at the end."""
        self._cancel = cancel

    def _drop(self) -> None:
        try:
            self._reports.get_nowait()
        except Empty:
            return
        self.missed += 1


class Component:
    """A JAUS component in this process; use it in a `with` block, or `start` and `stop` it.

    Calls wait for their outcome. They may come from any thread; functions that are handed over are
    called on a thread of the component, one at a time, and should return soon. They cannot ask
    others by it: its answers are taken on that thread.
    """

    def __init__(
        self,
        address: str | None = None,
        *,
        provides: str | Sequence[str] = (),
        name: str = "jausml",
        interface: str = "127.0.0.1",
        port: int = JUDP_PORT,
        multicast_group: str = DEFAULT_GROUP,
        peers: Mapping[str, tuple[str, int]] | None = None,
        models: Models = (),
        timeout: float = 3.0,
    ) -> None:
        """Describes a component; nothing is sent before it is started.

        Args:
            address: JAUS id, subsystem.node.component; None for a free one of 65000.
            provides: Services that others may find, by URN or name; what they inherit, and the
                core services that each tool has, come along.
            peers: Where components are that multicast does not reach: host and port by JAUS id.

        Raises:
            MessageError: A model cannot be read, or there is no such service.
        """
        if not timeout > 0:
            raise ValueError(f"timeout is {timeout}; it must be above 0 s")
        book = dict(_peer(each, place) for each, place in (peers or {}).items())
        settings = TransportSettings(
            interface=interface, port=port, multicast_group=multicast_group, address_book=book
        )
        own = component_address(address or "65000.1.1")
        self._network = Network(own, settings, is_own_given=address is not None)
        self._catalogue = catalogue(models)
        named = (provides,) if isinstance(provides, str) else provides
        self._identity = Identity(name, _identities(self._catalogue, named))
        self._timeout = timeout
        self._stack = ExitStack()
        self._running: Operator | None = None
        self._answers: dict[MessageEntry, tuple[MessageEntry, Callable[[], Fields | None]]] = {}
        self._obeyed: dict[MessageEntry, Callable[[Received], None]] = {}

    def __repr__(self) -> str:
        state = "stopped" if self._running is None else "runs"
        return f"<{type(self).__name__} {self.address}, {state}>"

    def __enter__(self) -> Component:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Opens the network and begins to answer.

        Raises:
            OSError: The network cannot be used; the text says why.
        """
        if self._running is not None:
            return
        with ExitStack() as stack:
            network = stack.enter_context(identified(self._network))
            operator = running_operator(
                network, self._catalogue, self._timeout, self._identity, self._prepare
            )
            try:
                self._running = stack.enter_context(operator)
            except OSError as error:
                raise OSError(error.errno, fault(error, self._network, _REMEDY)) from error
            self._stack = stack.pop_all()

    def stop(self) -> None:
        """Releases control, cancels events and closes the network."""
        self._running = None
        self._stack.close()

    @property
    def address(self) -> str:
        """Its JAUS id."""
        return str(self._operator.own if self._running is not None else self._network.own)

    # ---- asking -----------------------------------------------------------------------------

    def query(self, target: str, name: str | int, fields: Fields | None = None) -> Fields:
        """Asks for a report and returns its fields.

        Args:
            name: Name or code of the query or of its report, or what both share (`VelocityState`).
            fields: Fields of the query; without it everything is asked for.

        Raises:
            NoAnswer: No report comes; the text says what was heard instead.
            MessageError: There is no such message, or the fields are wrong.
        """
        address = self._other(target)
        entry, found = self._waiting.query(address, _text(name), fields)
        return entry.shortened(found)

    def subscribe(self, target: str, name: str | int, rate: float | None = None) -> Subscription:
        """Subscribes to a report by an event (AS5710, CreateEvent).

        Args:
            rate: Reports each second; None means at every change.

        Raises:
            Refused: It gives no such event; the text says why.
        """
        subscription = Subscription()
        subscription.begin(self.watch(target, name, rate, subscription.take))
        return subscription

    def watch(
        self, target: str, name: str | int, rate: float | None, take: Callable[[Received], None]
    ) -> Callable[[], None]:
        """Subscribes to a report, and has a function take each.

        Args:
            rate: Reports each second; None means at every change.
            take: Takes a report, on a thread of the component.

        Returns:
            A function that cancels the event.

        Raises:
            Refused: It gives no such event; the text says why.
        """

        def taking(entry: MessageEntry, fields: Fields) -> None:
            take(Received(entry.name, entry.shortened(fields), target))

        return self._waiting.watch(self._other(target), _text(name), rate, taking).cancel

    def discover(self, duration: float = 2.0) -> dict[str, tuple[str, ...]]:
        """Returns the services of each component that answers within a time.

        Args:
            duration: Seconds to listen.
        """
        found = self._waiting.survey.take(duration)
        return {
            str(component.address): tuple(
                f"{each.urn}/{each.major}.{each.minor}" for each in component.services
            )
            for subsystem in found
            for component in subsystem.components.values()
        }

    # ---- commanding -------------------------------------------------------------------------

    @contextmanager
    def control(
        self, target: str, *, authority: int = 127, resume: bool = True
    ) -> Iterator[Component]:
        """Controls a component as long as the block, and brings it to Ready.

        Args:
            resume: Whether to bring it to Ready (AS5710, Resume).

        Raises:
            Refused: It gives no control, or does not come to Ready.
        """
        address = self._other(target)
        self._waiting.control(address, authority)
        try:
            if resume:
                self._operator.change(address, Resume(), Status.READY)
            yield self
        finally:
            if self._running is not None:
                self._operator.release(address)

    def command(self, target: str, name: str | int, fields: Fields | None = None) -> None:
        """Sends a message once, without waiting; commands are obeyed under control alone.

        Args:
            fields: Its fields; the one record of a body need not be named.

        Raises:
            MessageError: There is no such message, or the fields are wrong.
            Refused: Control was taken, or the component left Ready, in a `control` block: nothing
                is sent.
        """
        address = component_address(target)
        entry = self._operator.find(address, _text(name))
        message = self._operator.message(entry, fields or {})
        self._operator.check_obeyed(address)
        self._operator.send(address, message)

    # ---- answering --------------------------------------------------------------------------

    def answer(self, name: str | int, give: Callable[[], Fields | None]) -> Callable[[], None]:
        """Answers a query, and events on it, with what a function returns; also before the start.

        Args:
            give: Returns the fields of the present report; None when there is none now.

        Returns:
            A function to be called when the report may have changed, for events at every change.

        Raises:
            TypeError: What gives is no function, or is async.
            ValueError: The query is answered already.
        """
        _check_callable(give, "that returns the fields")
        query, report = find_exchange(self._catalogue, _text(name), self._identity.services)
        if query in self._answers:
            raise ValueError(f"{query.name} is answered already")
        self._answers[query] = report, give
        if self._running is not None:
            self._running.provide(query, report, give)

        def changed() -> None:
            if self._running is not None:
                self._running.report_changed(report)

        return changed

    def obey(self, name: str | int, take: Callable[[Received], None]) -> None:
        """Has a function take a message: a command from the controller in Ready alone.

        Raises:
            TypeError: What takes is no function, or is async.
            ValueError: Something takes it already, or it is a query.
        """
        _check_callable(take, "that takes the message")
        entry = find_message(self._catalogue, _text(name), self._identity.services)
        if entry.name.startswith("Query"):
            raise ValueError(f"{entry.name} is a query: `answer` gives its report")
        if entry in self._obeyed:
            raise ValueError(f"{entry.name} is obeyed already")
        self._obeyed[entry] = take
        if self._running is not None:
            self._running.obey(entry, _taking(take))

    def _prepare(self, operator: Operator) -> None:
        """Has the operator do what was declared, before anybody can ask it."""
        for query, (report, give) in self._answers.items():
            operator.provide(query, report, give)
        for entry, take in self._obeyed.items():
            operator.obey(entry, _taking(take))

    @property
    def _operator(self) -> Operator:
        if self._running is None:
            raise RuntimeError("the component is not started: use it in a `with` block")
        return self._running

    @property
    def _waiting(self) -> Operator:
        """The operator, for a call that waits."""
        operator = self._operator
        if operator.is_on_its_thread:
            raise RuntimeError(
                "a function that takes messages cannot wait for an answer, which comes on the same "
                "thread: put the message into a queue, and ask on another thread"
            )
        return operator

    def _other(self, target: str) -> JausAddress:
        """Returns the address of another component, which can answer."""
        address = component_address(target)
        if address == self._operator.own:
            raise ValueError(f"{target} is this component itself")
        return address


def _peer(peer: str, place: tuple[str, int]) -> tuple[JausAddress, tuple[str, int]]:
    match place:
        case (str(), int()):
            return component_address(peer), place
    raise ValueError(f"peer {peer} is at {place!r}, not at host and port, e.g. ('10.0.0.1', 3794)")


def _text(name: str | int) -> str:
    """Returns a name or code as text."""
    return name if isinstance(name, str) else f"{name:04X}"


def _check_callable(function: object, purpose: str) -> None:
    if iscoroutinefunction(function):
        raise TypeError(f"a function {purpose} cannot be async: it is called on another thread")
    if not callable(function):
        raise TypeError(f"{function!r} is not a function {purpose}")


def _taking(
    take: Callable[[Received], None],
) -> Callable[[MessageEntry, Fields, JausAddress], None]:
    def taking(entry: MessageEntry, fields: Fields, sender: JausAddress) -> None:
        take(Received(entry.name, entry.shortened(fields), str(sender)))

    return taking


def _identities(known: Catalogue, names: Sequence[str]) -> tuple[ServiceIdentity, ...]:
    """Returns services with all that they inherit, and the core services that each tool has."""
    found = {each.urn: each for each in Identity().services}
    for name in names:
        for each in known.find_services(name)[0].lineage:
            major, _, minor = each.version.partition(".")
            found.setdefault(each.urn, ServiceIdentity(each.urn, int(major), int(minor or 0)))
    return tuple(found.values())
