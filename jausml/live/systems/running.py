"""A running system, whose parts are heard and queried on a thread of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from threading import Event, Lock, Thread

from jausml.live.messages import Catalogue
from jausml.live.peers.identity import identified
from jausml.live.peers.network import Network, fault, silence_log
from jausml.live.peers.operator import Identity, Operator, running_operator
from jausml.live.peers.query_client import NoAnswer
from jausml.live.systems.folding import expected
from jausml.live.systems.monitoring import Monitor, listening, polling
from jausml.live.systems.ros_diagnostics import RosDiagnostics
from jausml.live.systems.state import DeclaredConnection
from jausml.runtime.base.standstill import steady

PERIOD = 0.25  # seconds between two calls of `RunningSystem._look`

LONGEST = 1.0  # seconds after which listeners get an unchanged state, as its ages have changed

_REMEDY = "End it, or let it share the port"


class RunningSystem:
    """A running system, from `start` to `stop`; its state has the faults of sources."""

    def __init__(
        self,
        network: Network,
        declarations: Iterable[DeclaredConnection],
        components: Mapping[str, str],
        catalogue: Callable[[], Catalogue],
        timeout: float,
        identity: Identity | None = None,
    ) -> None:
        """Sends nothing before `start`.

        Args:
            declarations: The connections of the model.
            components: The names of its components by JAUS id.
            catalogue: Returns the messages that are known.
            timeout: Seconds that a query waits for its report.
        """
        self.monitor = Monitor(expected(declarations, components, steady()))
        self._network, self._catalogue = network, catalogue
        self._timeout, self._identity = timeout, identity
        self._beginning = Lock()
        self._end = Event()
        self._thread = Thread(target=self._run, name="running system", daemon=True)

    def start(self) -> None:
        """Starts the thread, once."""
        with self._beginning:
            if self._thread.ident is None:
                self._thread.start()

    def stop(self) -> None:
        """Ends all queries and subscriptions, and waits for that."""
        with self._beginning:
            has_begun = self._thread.ident is not None
        self._end.set()
        if has_begun:
            self._thread.join()

    def _run(self) -> None:
        with ExitStack() as stack:
            ros = stack.enter_context(listening(self.monitor))
            self._enter(self._operator(stack), ros)
            stack.callback(self._leave)
            while not self._end.wait(PERIOD):
                self._look()

    def _operator(self, stack: ExitStack) -> Operator | None:
        """Returns the operator for queries; None, and a fault in the state, without a network."""
        silence_log()
        try:
            network = stack.enter_context(identified(self._network))
            operator = stack.enter_context(
                running_operator(network, self._catalogue(), self._timeout, self._identity)
            )
        except NoAnswer as error:
            self.monitor.take_source("JAUS", str(error))
        except OSError as error:
            self.monitor.take_source("JAUS", fault(error, self._network, _REMEDY))
        else:
            stack.enter_context(polling(self.monitor, operator))
            return operator
        return None

    def _enter(self, operator: Operator | None, ros: RosDiagnostics | None) -> None:
        """Is called at the start; arguments are None where there is no JAUS or no ROS."""

    def _leave(self) -> None:
        """Is called before operator and diagnostics end."""

    def _look(self) -> None:
        """Is called once in `PERIOD`."""
