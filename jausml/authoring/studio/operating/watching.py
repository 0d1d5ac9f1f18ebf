"""The system that an operator unit is for: its model, who is there, and what goes wrong."""

from __future__ import annotations

import time
from contextlib import ExitStack
from threading import Event, Lock, Thread
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import system
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import Catalogue, CatalogueError, load_catalogue
from jausml.live.peers.network import fault, identified, silence_log
from jausml.live.peers.operator import Identity, running_operator
from jausml.live.peers.query_client import NoAnswer
from jausml.live.systems.folding import expected
from jausml.live.systems.monitoring import Monitor, listening, polling
from jausml.live.systems.state import Level, components_of, declarations_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.authoring.editing.project import Project
    from jausml.authoring.studio.operating.journal import Journal
    from jausml.language.model import Model
    from jausml.live.peers.network import Network
    from jausml.live.peers.operator import Operator
    from jausml.live.systems.state import SystemState

PERIOD = 0.25
"""Seconds from one look at the state to the next."""

_TIMEOUT = 2.0
_REMEDY = "End it, or let it share the port"


class UnitError(Exception):
    """The unit does not do what it is asked; the text says why."""


class WatchedSystem:
    """A running system and our component in it, from `start` to `stop`.

    Attributes:
        running: Our component; None where there is no network, or not yet, and `fault` says why.
    """

    def __init__(
        self,
        project: Project,
        network: Network,
        journal: Journal,
        told: Callable[[SystemState], None],
        ending: Callable[[], None],
    ) -> None:
        """Sends nothing before `start`.

        Args:
            told: Takes the state, once in `PERIOD`.
            ending: Is called before our component ends.
        """
        self.model, self.catalogue = _read(project)
        self.running: Operator | None = None
        self.fault = "the unit begins"
        self._network, self._journal = network, journal
        self._told, self._ending = told, ending
        self._monitor = Monitor(
            expected(
                declarations_of(self.model) if self.model is not None else (),
                components_of(self.model) if self.model is not None else {},
                time.monotonic(),
            )
        )
        self._levels: dict[str, Level] = {}
        self._state = Lock()
        self._ready, self._end = Event(), Event()
        self._thread = Thread(target=self._run, name="operator unit", daemon=True)

    def state(self) -> SystemState:
        """Returns the state at present."""
        return self._monitor.state()

    def start(self) -> None:
        """Begins, once; what cannot be heard is told as part of the state."""
        with self._state:
            if self._thread.ident is None:
                self._thread.start()

    def stop(self) -> None:
        """Ends it; control is released."""
        with self._state:
            has_begun = self._thread.ident is not None
        self._end.set()
        if has_begun:
            self._thread.join()

    def _run(self) -> None:
        with ExitStack() as stack:
            stack.enter_context(listening(self._monitor))
            silence_log()
            try:
                network = stack.enter_context(identified(self._network))
                operator = stack.enter_context(
                    running_operator(
                        network, self.catalogue, _TIMEOUT, Identity(name="jausml studio")
                    )
                )
            except NoAnswer as error:
                self.fault = str(error)
                self._monitor.take_source("JAUS", self.fault)
            except OSError as error:
                self.fault = fault(error, self._network, _REMEDY)
                self._monitor.take_source("JAUS", self.fault)
            else:
                stack.enter_context(polling(self._monitor, operator))
                operator.handoffs.on_news = lambda news: self._journal.note("handoff", news)
                self.running, self.fault = operator, ""
                stack.callback(self._leave)
            self._ready.set()
            while not self._end.wait(PERIOD):
                state = self._monitor.state()
                self._watch_for_alarms(state)
                self._told(state)

    def _leave(self) -> None:
        self._ending()
        self.running, self.fault = None, "the unit has ended"

    @property
    def operator(self) -> Operator:
        """Who asks and commands (`UnitError`: there is no network, or not yet)."""
        self._ready.wait(_TIMEOUT)
        if self.running is None:
            raise UnitError(self.fault)
        return self.running

    def _watch_for_alarms(self, state: SystemState) -> None:
        """Raises alarms for what went well, or has begun, and does no more."""
        levels = {f"component {each.address}": each for each in state.components.values()}
        for subject, component in levels.items():
            self._judge(subject, component.level, component.is_gone, component.reason)
        for each in state.connections.values():
            subject = f"connection {each.bridge}.{each.name}"
            self._judge(subject, each.level, each.is_gone, each.reason)

    def _judge(self, subject: str, level: Level, is_gone: bool, reason: str) -> None:  # noqa: FBT001
        before = self._levels.get(subject)
        self._levels[subject] = level
        is_bad = level is Level.ERROR or is_gone
        if is_bad and before is not level and before is not None:
            self._journal.alarm(subject, f"lost: {reason}" if is_gone else reason)


def _read(project: Project) -> tuple[Model | None, Catalogue]:
    """Returns the system that is operated, None without one, and the messages it knows."""
    files = [project.opened] if project.opened else [each.path for each in project.files]
    for file in files:
        model = project.model(file).model
        if not project.opened and not any(model.instances(system.System, library=False)):
            continue
        try:
            path = project.root / file
            found = load_catalogue([path], project_root=project.root, notations=NOTATIONS)
        except CatalogueError:
            found = load_catalogue()
        return model, found
    return None, load_catalogue()
