"""Session of a run: our clients, what the target announces, and its present state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TypeVar

from jausml.live.messages import Catalogue, ServiceEntry
from jausml.live.peers.conformance.client import UNDO_ORDER, Client
from jausml.live.peers.conformance.evidence import CheckFailed, CheckSkipped, Trace
from jausml.live.peers.conformance.probe import Probe
from jausml.runtime import messages as core
from jausml.runtime.services.definitions import CORE, ServiceIdentity, Status
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import Message

M = TypeVar("M", bound=Message)

LATEST = (1, 1)
"""Version of the core services that is assumed of a target that announces none (AS5710A)."""

PINGS: tuple[tuple[Message, type[Message]], ...] = (
    (core.QueryStatus(), core.ReportStatus),
    (core.QueryControl(), core.ReportControl),
    (core.QueryIdentification(query_type=4), core.ReportIdentification),
    (core.QueryEventTimeout(), core.ReportEventTimeout),
    (core.QueryHeartbeatPulse(), core.ReportHeartbeatPulse),
)
"""Queries without effect, of which most components answer one."""

_BY_SERVICE: dict[str, tuple[Message, type[Message]]] = {
    "Management": PINGS[0],
    "AccessControl": PINGS[1],
    "Discovery": PINGS[2],
    "Events": (
        core.QueryEvents(query_events_var=core.QueryEvents.AllEventsRec(all_events=0)),
        core.ReportEvents,
    ),
    "Liveness": PINGS[4],
    "Time": (core.QueryTime(presence_vector=3), core.ReportTime),
    "ListManager": (core.QueryElementCount(), core.ReportElementCount),
}

_OTHER_NAMES = {
    "Liveness": ("urn:jaus:jss:core:Liveliness",),
    "ListManager": ("urn:jaus:jss:mobility:ListManager", "urn:jaus:jss:manipulator:ListManager"),
}
"""Identifiers under which older sets announce a core service."""


USUAL_AUTHORITY = 100
"""Authority code with which control is requested, where the target has no higher default."""

_HIGHER = (205,)
HIGHEST_AUTHORITY = 255
INSUFFICIENT = core.ConfirmControl.ResponseCode.INSUFFICIENT_AUTHORITY


class Authority(IntEnum):
    """Authority below the default one, the lowest that suffices, and two above it."""

    BELOW = -1
    LOW = 0
    MIDDLE = 1
    HIGH = 2


@dataclass(frozen=True)
class Limits:
    """Limits of a run: how long and how far the checks may go.

    Attributes:
        longest_wait: Seconds that a check may wait for a time-out of the target.
        restart: Seconds in which a target that fell silent may be started again.
    """

    longest_wait: float = 10.0
    restart: float = 5.0
    slow: bool = False
    destructive: bool = False


@dataclass
class Session:
    """A run against one target.

    Attributes:
        services: What the target announces; empty when nobody says.
        latest: What was sent last, in words.
        sufficient: Authority code that the target does not call insufficient, as far as is known.
    """

    probe: Probe
    trace: Trace
    limits: Limits
    catalogue: Catalogue
    services: Sequence[ServiceIdentity] = ()
    ping: tuple[Message, type[Message]] = PINGS[0]
    notes: list[str] = field(default_factory=list)
    latest: str = ""
    sufficient: int = USUAL_AUTHORITY
    _answered: dict[str, bool] = field(default_factory=dict)
    _default_authority: int | None = None
    _tells_controller: bool | None = None

    # ---- clients ----------------------------------------------------------------------------

    def client(self, index: int) -> Client:
        """Returns one of our clients."""
        return self.probe.client(index)

    def send(self, index: int, message: Message, priority: Priority = Priority.STANDARD) -> None:
        """Sends a message of one of our clients, which is the latest one from now on."""
        client = self.client(index)
        self.latest = f"{message.NAME} of {client.address}"
        client.send(message, priority)

    @property
    def first(self) -> Client:
        """Our first client."""
        return self.probe.client(0)

    def pause(self) -> None:
        """Receives for the quiet time."""
        self.probe.wait(lambda: False, self.probe.quiet)

    # ---- outcomes ---------------------------------------------------------------------------

    def note(self, text: str) -> None:
        """Records a deviation that peers tolerate."""
        self.notes.append(text)

    @staticmethod
    def require(holds: bool, failure: str) -> None:  # noqa: FBT001
        """Ends the check as failed unless a condition holds."""
        if not holds:
            raise CheckFailed(failure)

    @staticmethod
    def skip_unless(holds: bool, reason: str) -> None:  # noqa: FBT001
        """Ends the check as skipped unless a condition holds."""
        if not holds:
            raise CheckSkipped(reason)

    # ---- what the target provides -----------------------------------------------------------

    def provides(self, name: str) -> bool:
        """Whether the target has a core service: announced, or inherited by what is announced.

        A target that announces nothing has what it answers.
        """
        return self._announced(name) is not None if self.services else self.serves(name)

    def serves(self, name: str) -> bool:
        """Whether the target answers a query of a core service; AccessControl may grant as well."""
        if name not in self._answered:
            query, report = _BY_SERVICE[name]
            answered = self.tried(query, report, attempts=2) is not None
            if name == "AccessControl" and not answered:
                self.first.send(core.RequestControl(authority_code=255))
                answered = self.first.find(core.ConfirmControl) is not None
                self.undo()
            self._answered[name] = answered
        return self._answered[name]

    def missing(self, name: str) -> str:
        """Returns why a core service cannot be checked, or nothing.

        Raises:
            CheckFailed: The target announces a service that inherits it, and does not serve it.
        """
        if not self.provides(name):
            if self.services:
                return f"the target announces neither {name} nor a service that inherits it"
            return f"the target does not answer {_BY_SERVICE[name][0].NAME}, and announces nothing"
        heir = self._heir(name)
        if heir is not None and not self.serves(name):
            raise CheckFailed(
                f"{heir.urn.rpartition(':')[2]}, which the target announces, inherits {name}, "
                f"but {_BY_SERVICE[name][0].NAME} is not answered"
            )
        return ""

    @property
    def tells_controller(self) -> bool:
        """Whether the target reports its controller."""
        if self._tells_controller is None:
            self._tells_controller = self.tried(*PINGS[1], attempts=2) is not None
        return self._tells_controller

    def tried(self, query: Message, report_class: type[M], attempts: int = 1) -> M | None:
        """Returns the report that answers a query, or None when none comes that decodes."""
        try:
            return self.first.asked(query, report_class, attempts)
        except CheckFailed:
            return None

    def is_v1_0(self, name: str) -> bool:
        """Whether a core service is announced as the one of AS5710 before revision A."""
        service = self._announced(name)
        return service is not None and (service.major, service.minor) < LATEST

    def known_bases(self, service: ServiceIdentity) -> Sequence[ServiceIdentity]:
        """Returns the services that a service inherits from, as far as we know it."""
        entry = self.known(service)
        lineage = [] if entry is None else list(entry.lineage)[1:]
        return [ServiceIdentity(ancestor.urn, *_version(ancestor.version)) for ancestor in lineage]

    def known(self, service: ServiceIdentity) -> ServiceEntry | None:
        """Returns the service of the catalogue in its announced version."""
        return self.catalogue.services.get((service.urn, f"{service.major}.{service.minor}"))

    def _announced(self, name: str) -> ServiceIdentity | None:
        """Returns a core service as announced, or as inherited by an announced one."""
        urns = _urns(name)
        heirs = (base for service in self.services for base in self.known_bases(service))
        return next((service for service in (*self.services, *heirs) if service.urn in urns), None)

    def _heir(self, name: str) -> ServiceIdentity | None:
        """Returns the service through which alone a core service is announced."""
        urns = _urns(name)
        if any(service.urn in urns for service in self.services):
            return None
        bases = (
            (service, {base.urn for base in self.known_bases(service)}) for service in self.services
        )
        return next((service for service, base_urns in bases if base_urns.intersection(urns)), None)

    def answers(self) -> bool:
        """Whether the target still answers a query."""
        query, report = self.ping
        try:
            return self.client(2).asked(query, report) is not None
        except CheckFailed:
            return True  # with nonsense, but it does

    # ---- control ----------------------------------------------------------------------------

    @property
    def default_authority(self) -> int:
        """Lowest authority code that may control the target, as it reports it uncontrolled."""
        if self._default_authority is None:
            if self.tells_controller:
                report = self.first.ask(core.QueryAuthority(), core.ReportAuthority)
            else:
                answer = self.tried(core.QueryAuthority(), core.ReportAuthority, attempts=2)
                report = answer or core.ReportAuthority(authority_code=0)
                self.sufficient = USUAL_AUTHORITY if answer else self._tried_authority()
            self._default_authority = report.authority_code
        return self._default_authority

    def authority(self, level: Authority) -> int:
        """Returns the authority code of a level; skips the check where there is none."""
        default = self.default_authority
        if level is Authority.BELOW:
            self.skip_unless(default > 0, "the default authority is 0, or not told")
            return default - 1
        lowest = max(default, self.sufficient)
        self.skip_unless(
            lowest + level <= HIGHEST_AUTHORITY,
            f"the default authority {lowest} leaves no room above it",
        )
        return lowest + level

    def _tried_authority(self) -> int:
        """Returns the least of some authority codes that the target does not call insufficient."""
        for code in (USUAL_AUTHORITY, *_HIGHER, HIGHEST_AUTHORITY):
            self.first.send(core.RequestControl(authority_code=code))
            answer = self.first.find(core.ConfirmControl)
            self.undo()
            if answer is None or answer.response_code != INSUFFICIENT:
                return code
        return HIGHEST_AUTHORITY

    def control(self) -> core.ReportControl:
        """Returns the controller of the target."""
        return self.client(2).ask(core.QueryControl(), core.ReportControl)

    def seen_control(self) -> core.ReportControl | None:
        """Returns the controller of the target; None, and a note, when it never says so."""
        if self.tells_controller:
            return self.control()
        note = "who has control is not seen, for QueryControl is not answered"
        if note not in self.notes:
            self.note(note)
        return None

    def take(self, index: int, level: Authority) -> None:
        """Lets a client take control; skips the check where it is not granted."""
        client, authority = self.client(index), self.authority(level)
        self.send(index, core.RequestControl(authority_code=authority))
        answer = client.find(core.ConfirmControl)
        self.skip_unless(
            answer is not None and answer.response_code == 0,
            f"{client.address} cannot take control with authority {authority}; "
            "see access.request and discovery",
        )

    # ---- management -------------------------------------------------------------------------

    def status(self) -> Status:
        """Returns the state of the target."""
        report = self.client(2).ask(core.QueryStatus(), core.ReportStatus)
        try:
            return Status(report.status)
        except ValueError:
            raise CheckFailed(f"ReportStatus says {report.status}, which is no state") from None

    def reaches(self, status: Status) -> bool:
        """Whether the target comes to a state within the time of an answer or two."""
        for _ in range(3):
            if self.status() is status:
                return True
            self.pause()
        return False

    def make_ready(self, index: int) -> None:
        """Lets a client take control and resume; skips the check where that leads not to Ready."""
        self.take(index, Authority.LOW)
        self.send(index, core.Resume())
        self.skip_unless(
            self.reaches(Status.READY), "the target does not come to Ready; see management.resume"
        )

    # ---- between checks ---------------------------------------------------------------------

    def begin(self) -> None:
        """Starts the next check with empty hands."""
        self.notes.clear()
        self.latest = ""
        self.trace.restart()
        for client in self._clients():
            client.clear()

    def tidy(self) -> bool:
        """Undoes what the check left behind, and returns whether the target still answers."""
        self.undo()
        return self.answers()

    def undo(self) -> None:
        """Undoes what the check left behind."""
        for client in self._clients():
            client.cancel_events()
        for kind in UNDO_ORDER:
            for client in self._clients():
                client.undo(kind)

    def _clients(self) -> list[Client]:
        return [self.client(index) for index in range(3)]


def _urns(name: str) -> tuple[str, ...]:
    return (CORE + name, *_OTHER_NAMES.get(name, ()))


def _version(text: str) -> tuple[int, int]:
    major, _, minor = text.partition(".")
    return int(major or 0), int(minor or 0)


NOBODY = "0.0.0"
"""The controller of an uncontrolled component (AS5710, ReportControl)."""
