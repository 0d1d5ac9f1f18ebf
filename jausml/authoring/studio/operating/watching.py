"""The system that an operator unit is for: its model, who is there, and what goes wrong."""

from __future__ import annotations

from threading import Event
from typing import TYPE_CHECKING

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.running import RunningSystem, messages_of
from jausml.language.metamodel.classes import system
from jausml.live.messages import Catalogue, load_catalogue
from jausml.live.peers.operator import Identity
from jausml.live.systems.state import Level

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.authoring.editing.project import Project
    from jausml.authoring.studio.operating.journal import Journal
    from jausml.language.model import Model
    from jausml.live.peers.network import Network
    from jausml.live.peers.operator import Operator
    from jausml.live.systems.ros_diagnostics import RosDiagnostics
    from jausml.live.systems.state import SystemState

_TIMEOUT = 2.0


class WatchedSystem(RunningSystem):
    """A running system and our component in it, from `start` to `stop`.

    Attributes:
        running: Our component; None where there is no network, or not yet, and `fault` says why.
    """

    def __init__(
        self,
        project: Project,
        network: Network,
        journal: Journal,
        listener: Callable[[SystemState], None],
        ending: Callable[[], None],
    ) -> None:
        """Sends nothing before `start`.

        Args:
            listener: Takes the state, once in `PERIOD`.
            ending: Is called before our component ends.
        """
        self.model, self.catalogue = _read(project)
        identity = Identity(name="jausml studio")
        super().__init__(network, self.model, lambda: self.catalogue, _TIMEOUT, identity)
        self.running: Operator | None = None
        self.fault = "the unit begins"
        self._journal, self._notify, self._ending = journal, listener, ending
        self._levels: dict[str, Level] = {}
        self._ready = Event()

    def _enter(self, operator: Operator | None, ros: RosDiagnostics | None) -> None:  # noqa: ARG002 - what is heard is part of the state
        if operator is not None:
            operator.handoffs.on_news = lambda news: self._journal.note("handoff", news)
        self.running, self.fault = operator, self.monitor.state().sources.get("JAUS", "")
        self._ready.set()

    def _leave(self) -> None:
        if self.running is not None:
            self._ending()
            self.running, self.fault = None, "the unit has ended"

    @property
    def operator(self) -> Operator:
        """Who asks and commands (`AnswerError`: there is no network, or not yet)."""
        self._ready.wait(_TIMEOUT)
        if self.running is None:
            raise AnswerError(self.fault)
        return self.running

    def _look(self) -> None:
        state = self.monitor.state()
        self._watch_for_alarms(state)
        self._notify(state)

    def _watch_for_alarms(self, state: SystemState) -> None:
        """Raises alarms for what went well, or has begun, and does no more."""
        levels = {
            f"component {component_state.address}": component_state
            for component_state in state.components.values()
        }
        for subject, component in levels.items():
            self._judge(subject, component.level, component.is_gone, component.reason)
        for connection in state.connections.values():
            subject = f"connection {connection.bridge}.{connection.name}"
            self._judge(subject, connection.level, connection.is_gone, connection.reason)

    def _judge(self, subject: str, level: Level, is_gone: bool, reason: str) -> None:  # noqa: FBT001
        before = self._levels.get(subject)
        self._levels[subject] = level
        is_bad = level is Level.ERROR or is_gone
        if is_bad and before is not level and before is not None:
            self._journal.alarm(subject, f"lost: {reason}" if is_gone else reason)


def _read(project: Project) -> tuple[Model | None, Catalogue]:
    """Returns the system that is operated, None without one, and the messages it knows."""
    files = [project.opened] if project.opened else [file_info.path for file_info in project.files]
    for file in files:
        model = project.model(file).model
        if not project.opened and not any(model.instances(system.System, library=False)):
            continue
        return model, messages_of(project.root / file, project.root)
    return None, load_catalogue()
