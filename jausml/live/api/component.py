"""A JAUS component without a model: asks, watches, commands and answers others by names.

with Component("10.1.1") as operator:
    print(operator.query("100.1.1", "VelocityState"))
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from weakref import WeakSet

from jausml.live.api.messages import (
    Declarations,
    Fields,
    Models,
    Received,
    Subscription,
    catalogue,
    taking,
)
from jausml.live.messages import MessageEntry
from jausml.live.peers.discovery import controller_of, label_of
from jausml.live.peers.identity import identified
from jausml.live.peers.network import DEFAULT_GROUP, Network, component_address, fault
from jausml.live.peers.operator import Operator, running_operator
from jausml.live.peers.requesting import request
from jausml.live.peers.watching import Reply
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import JUDP_PORT, TransportSettings
from jausml.runtime.messages import Resume
from jausml.runtime.services.definitions import Status

_REMEDY = "Give all components that speak with each other another port="


@dataclass(frozen=True)
class ComponentStatus:
    """The state of a component and who controls it.

    Attributes:
        state: Its state of Management, e.g. `READY`; None when it does not say.
        controller: The JAUS id of who controls it; None when nobody does, or it does not say.
        authority: The authority of the controller, or the least that it demands.
    """

    state: str | None
    controller: str | None
    authority: int | None


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
        book = dict(_peer(peer_address, place) for peer_address, place in (peers or {}).items())
        settings = TransportSettings(
            interface=interface, port=port, multicast_group=multicast_group, address_book=book
        )
        own = component_address(address or "65000.1.1")
        self._network = Network(own, settings, is_own_given=address is not None)
        self._catalogue = catalogue(models)
        self._declared = Declarations(self._catalogue, name, provides)
        self._timeout = timeout
        self._stack = ExitStack()
        self._running: Operator | None = None
        self._subscriptions: WeakSet[Subscription] = WeakSet()

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
            ours = self._declared
            operator = running_operator(
                network, self._catalogue, self._timeout, ours.identity, ours.prepare
            )
            try:
                self._running = stack.enter_context(operator)
            except OSError as error:
                raise OSError(error.errno, fault(error, self._network, _REMEDY)) from error
            self._stack = stack.pop_all()

    def stop(self) -> None:
        """Releases control, cancels events, whose iterations end, and closes the network."""
        for subscription in list(self._subscriptions):
            subscription.close()
        self._running = None
        self._stack.close()

    @property
    def address(self) -> str:
        """Its JAUS id."""
        return str(self._operator.own if self._running is not None else self._network.own)

    # ---- asking -----------------------------------------------------------------------------

    def query(
        self,
        target: str,
        name: str | int,
        fields: Fields | None = None,
        timeout: float | None = None,
    ) -> Fields:
        """Asks for a report and returns its fields.

        Args:
            name: Name or code of the query or of its report, or what both share (`VelocityState`).
            fields: Fields of the query; without it everything is asked for.

        Raises:
            NoAnswer: No report comes; the text says what was heard instead.
            MessageError: There is no such message, or the fields are wrong.
        """
        address = self._other(target)
        entry, report_fields = self._waiting.query(address, _text(name), fields, timeout)
        return entry.shortened(report_fields)

    def subscribe(self, target: str, name: str | int, rate: float | None = None) -> Subscription:
        """Subscribes to a report by an event (AS5710, CreateEvent).

        Args:
            rate: Reports each second; None means at every change.

        Raises:
            Refused: It gives no such event; the text says why.
        """
        subscription = Subscription()
        subscription.begin(self.watch(target, name, rate, subscription.take))
        self._subscriptions.add(subscription)
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
        subsystems = self._waiting.survey.take(duration)
        return {
            str(component.address): tuple(map(label_of, component.services))
            for subsystem in subsystems
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

    def request(
        self,
        target: str,
        name: str | int,
        fields: Fields | None = None,
        timeout: float | None = None,
    ) -> Received:
        """Sends a command and returns what came back: a confirmation, or a report of its effect.

        Which messages confirm or reject a command is said by its service. SetX without a
        confirmation is followed by QueryX until ReportX has what was set, any other command by
        QueryStatus. A number that tells the answer from others (RequestID) need not be given.

        Args:
            fields: Its fields, as for `command`.
            timeout: Seconds to wait; None for those of the component.

        Raises:
            MessageError: There is no such message, or the fields are wrong.
            NoAnswer: Nothing came.
            Refused: It was rejected, has no effect, or cannot have any; the text says why.
        """
        address = self._other(target)
        entry, answer_fields = request(self._waiting, address, _text(name), fields, timeout)
        return Received(entry.name, entry.shortened(answer_fields), target)

    def command(self, target: str, name: str | int, fields: Fields | None = None) -> None:
        """Sends a message once, without waiting for its effect.

        Args:
            fields: Its fields; the one record of a body need not be named.

        Raises:
            MessageError: There is no such message, or the fields are wrong.
            NoAnswer: Nothing was ever heard of the component.
            Refused: It obeys its controller alone, and we are not, or it left Ready since: nothing
                is sent.
        """
        address = self._other(target)
        operator = self._waiting
        entry = operator.find(address, _text(name))
        message = operator.message(entry, fields or {})
        operator.check_obeyed(address, entry)
        operator.send(address, message)

    def status(self, target: str) -> ComponentStatus:
        """Returns the state of a component and who controls it."""
        state, control = self._waiting.status(self._other(target))
        if control is None:
            return ComponentStatus(_state(state), None, None)
        controller = controller_of(control) if control.subsystem_id else None
        return ComponentStatus(_state(state), controller, control.authority_code)

    def emergency(self, target: str) -> ComponentStatus:
        """Stops a component by an emergency, which lasts until `clear`; control is not needed.

        Raises:
            NoAnswer: It does not tell its state: nobody knows whether it has stopped.
            Refused: It sets no emergency.
        """
        address = self._other(target)
        if self._waiting.emergency(address) is None:
            raise self._waiting.unanswered(address, "SetEmergency", "ReportStatus")
        return self.status(target)

    def clear(self, target: str) -> ComponentStatus:
        """Ends the emergency that this component has set.

        Raises:
            NoAnswer: It does not tell its state.
            Refused: The emergency lasts: somebody else has set it.
        """
        address = self._other(target)
        if self._waiting.clear(address) is None:
            raise self._waiting.unanswered(address, "ClearEmergency", "ReportStatus")
        return self.status(target)

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
        query, report = self._declared.answer(_text(name), give)
        if self._running is not None:
            self._running.provide(query, report, give)

        def changed() -> None:
            if self._running is not None:
                self._running.report_changed(report)

        return changed

    def obey(self, name: str | int, take: Callable[[Received], Reply | None]) -> None:
        """Has a function take a message: a command from the controller in Ready alone.

        Args:
            take: Takes it. It may return a message to answer with: its name and its fields.

        Raises:
            TypeError: What takes is no function, or is async.
            ValueError: Something takes it already, or it is a query.
        """
        entry = self._declared.obey(_text(name), take)
        if self._running is not None:
            self._running.obey(entry, taking(take))

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


def _state(state: Status | None) -> str | None:
    return None if state is None else state.name


def _text(name: str | int) -> str:
    """Returns a name or code as text."""
    return name if isinstance(name, str) else f"{name:04X}"
