"""The system of an operator unit: knowledge of models, present components, and alarms."""

from __future__ import annotations

import time
from collections.abc import Callable
from threading import Event

from jausml.live.messages.frozen import ThawedCatalogue
from jausml.live.operating.journal import Journal
from jausml.live.operating.knowledge import Knowledge
from jausml.live.peers.network import Network
from jausml.live.peers.operator import Identity, Operator
from jausml.live.peers.query_client import Refused
from jausml.live.systems.ros_diagnostics import RosDiagnostics
from jausml.live.systems.running import RunningSystem
from jausml.live.systems.state import ConnectionState, Level, SystemState

_TIMEOUT = 2.0  # seconds that a question waits for its answer

# Seconds after we stop or release a component in which it raises no alarm.
_OWN_ACT = 3.0


class WatchedSystem(RunningSystem):
    """A running system with our component in it, from `start` to `stop`.

    Attributes:
        catalogue: The messages of the models and of the library.
        running: Our component; None while there is no network, for the reason in `fault`.
        unread: Why the models, or files of messages, cannot be read; empty if they can.
    """

    def __init__(
        self,
        knowledge: Knowledge,
        network: Network,
        journal: Journal,
        listener: Callable[[SystemState], None],
        ending: Callable[[], None],
    ) -> None:
        """Sends nothing before `start`.

        Args:
            listener: Is called with the state once in `PERIOD`.
            ending: Is called before our component ends.
        """
        self.catalogue = ThawedCatalogue(knowledge.messages)
        self.unread = knowledge.fault or knowledge.left_out
        identity = Identity(name="jausml operate")
        super().__init__(
            network,
            knowledge.declarations,
            knowledge.components,
            lambda: self.catalogue,
            _TIMEOUT,
            identity,
        )
        self.running: Operator | None = None
        self.fault = "the unit begins"
        self._journal, self._notify, self._ending = journal, listener, ending
        self._levels: dict[str, Level] = {}
        self._acts: dict[str, float] = {}
        self._names = dict(knowledge.components)
        self._untaken = knowledge.untaken
        self._ready = Event()

    def learn(self, knowledge: Knowledge) -> None:
        """Takes the knowledge of changed models; keeps the former if they cannot be read."""
        self.unread = knowledge.fault or knowledge.left_out
        if knowledge.fault:
            return
        self._untaken = knowledge.untaken
        self.catalogue = ThawedCatalogue(knowledge.messages)
        self.monitor.take_model(knowledge.declarations, dict(knowledge.components))
        if self.running is not None:
            self.running.learn(self.catalogue)

    def _enter(self, operator: Operator | None, ros: RosDiagnostics | None) -> None:  # noqa: ARG002 - what is heard is part of the state
        if operator is not None:
            operator.learn(self.catalogue)  # which may have changed since the operator was created
            operator.handoffs.on_news = lambda news: self._journal.note("handoff", news)
        self.running, self.fault = operator, self.monitor.state().sources.get("JAUS", "")
        self._ready.set()

    def _leave(self) -> None:
        if self.running is not None:
            self._ending()
            self.running, self.fault = None, "the unit has ended"

    @property
    def operator(self) -> Operator:
        """The operator (`Refused`: there is no network, or not yet)."""
        self._ready.wait(_TIMEOUT)
        if self.running is None:
            raise Refused(self.fault)
        return self.running

    def takes(self, target: object, command: str) -> bool:
        """Returns whether a component takes a command of a service that it provides."""
        return command not in self._untaken.get(str(target), ())

    def name_of(self, address: object) -> str:
        """Returns the name of a component with its JAUS id, or the id alone if it has no name."""
        name = self._names.get(str(address), "")
        return f"{name} ({address})" if name else str(address)

    def act(self, target: object) -> None:
        """Notes that we stop or release a component, which then raises no alarm for a while."""
        self._acts[str(target)] = time.monotonic()

    def has_acted(self, target: object) -> bool:
        """Returns whether we stopped or released a component in the last seconds."""
        return time.monotonic() - self._acts.get(str(target), float("-inf")) < _OWN_ACT

    def _look(self) -> None:
        state = self.monitor.state()
        self._watch_for_alarms(state)
        self._notify(state)

    def _watch_for_alarms(self, state: SystemState) -> None:
        """Notes the components and connections whose level has changed."""
        for address, component in state.components.items():
            if component.name:
                self._names[address] = component.name
            level = component.level
            if self._levels.get(address) is not level:
                subject, is_gone = self.name_of(address), component.is_gone
                self._judge(address, subject, address, level, component.reason, is_gone=is_gone)
        for connection in state.connections.values():
            key = f"connection {connection.bridge}.{connection.name}"
            level, is_gone = connection.level, connection.is_gone
            if self._levels.get(key) is not level:
                at = self._cause(state, connection)
                self._judge(key, key, at, level, connection.reason, is_gone=is_gone)

    @staticmethod
    def _cause(state: SystemState, connection: ConnectionState) -> str:
        """Returns the JAUS id of a peer of a connection that is gone, else of its bridge."""
        peers = connection.declaration.peers if connection.declaration is not None else ()
        for address in (connection.jaus_id, *peers):
            component = state.components.get(address)
            if component is not None and component.is_gone:
                return address
        return connection.jaus_id or connection.bridge

    def _judge(
        self, key: str, subject: str, address: str, level: Level, reason: str, *, is_gone: bool
    ) -> None:
        """Raises an alarm if a level is an error, or notes the return of the subject.

        Args:
            address: The JAUS id of the cause.
        """
        before = self._levels.get(key)
        self._levels[key] = level
        if before is None:
            return
        if level is not Level.ERROR and not is_gone:
            if level in (Level.OK, Level.WARNING):
                self._journal.returned(subject)
            return
        text = f"lost: {reason}" if is_gone else reason
        if self.has_acted(address) and not is_gone:
            self._journal.note("unit", f"{subject}: {text}, after what this unit did")
        else:
            self._journal.alarm(self.name_of(address), text, subject)
