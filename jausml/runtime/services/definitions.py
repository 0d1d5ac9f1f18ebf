"""Definitions for components, their services and their clients."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum, IntEnum

from ..base.address import JausAddress
from ..base.settings import check_range

CORE = "urn:jaus:jss:core:"  # prefix of the identifiers of the core services (AS5710)

VERSION_1_1 = (1, 1)  # version of the core services of AS5710A; those of AS5710 are 1.0
MAX_EVENT_RATE = 1092.0  # upper limit of RequestedPeriodicRate in Hz (AS5710, CreateEvent)


@dataclass(frozen=True)
class ServiceIdentity:
    """A service as Discovery reports it (AS5710, ReportServices)."""

    urn: str  # e.g. ``urn:jaus:jss:mobility:PrimitiveDriver``; case matters
    major: int
    minor: int


class Guard(Enum):
    """Which senders of a message a component obeys (AS5710, AccessControl and Management)."""

    ANY = "any"  # every component
    CONTROLLED = "controlled"  # only the controller, in Standby or Ready
    READY = "ready"  # only the controller, in Ready


class Status(IntEnum):
    """Management state of a component (AS5710, ReportStatus)."""

    INITIALIZE = 0
    READY = 1
    STANDBY = 2
    SHUTDOWN = 3
    FAILURE = 4
    EMERGENCY = 5


class Scope(IntEnum):
    """Scope of a Discovery service or query (AS5710, QueryIdentification, QueryType)."""

    SYSTEM = 1
    SUBSYSTEM = 2
    NODE = 3
    COMPONENT = 4


@dataclass(frozen=True)
class HandoffRequest:
    """A request of another client for control of a component that this one controls."""

    target: JausAddress  # the controlled component
    number: int  # identifier of the request at the target
    client: JausAddress
    authority: int  # authority code of the client
    explanation: str  # reason of the client, for people


@dataclass(frozen=True)
class ComponentSettings:
    """How a component behaves towards its peers.

    Attributes:
        default_authority: Lowest authority code that may control the component, 0 to 255.
        control_timeout: Seconds after which control lapses unless it is requested again, 0 to
            255; 0 means never (AS5710, QueryTimeout).
        control_survives_emergency: Whether the controller keeps control in an emergency, which
            some clients need, against AS5710. It is not obeyed during the emergency.
        handoff_timeout: Seconds within which the controller decides on a request for handoff, 0 to
            255; 0 means any time (IOP, QueryHandoffTimeout).
        enhanced_timeout: Seconds after which such a request lapses unless it is sent again, 0 to
            255; 0 means never (IOP, QueryEnhancedTimeout).
        event_timeout: Minutes after which an event lapses unless it is updated, 0 to 255;
            0 means never (AS5710, QueryEventTimeout).
        event_rate_min: Slowest periodic event in Hz; slower requests get this rate.
        event_rate_max: Fastest periodic event in Hz; faster requests get this rate.
        event_rate_budget: Reports a second of all periodic events together; a client that requests
            more than a fair share gets a lower rate.
        max_events: Events that the component serves at a time, 0 to 255. When all are used, the
            host with most events loses one to a host with fewer.
        heartbeat_rate: Rate in Hz of unsolicited heartbeats, up to 100; 0 means never. None means
            1 Hz if the component provides the service UnsolicitedHeartbeat of the IOP, else never.
        heartbeat_scope: Receivers of these heartbeats: SUBSYSTEM or SYSTEM.
        max_list_elements: Elements that the list of a ListManager may hold, 0 to 65534.
        discovery_scope: Scope of the Discovery service. One component of a subsystem has
            SUBSYSTEM, by convention n.1.1.
        subsystem_name: Name of the subsystem in ReportIdentification; the component's own
            name when empty.
        registration_lifetime: Seconds after which a silent registered component is forgotten.
        digital_resources: URLs of the streams and files of the component, such as
            rtsp://10.0.0.7/front (IOP, Digital Resource Discovery). It reports them itself if it
            provides that service, else it registers them at the provider of its subsystem.
        register_services: Whether the component registers its services with the Discovery
            service of its subsystem.
        discovery_timeout: Seconds without an answer of that Discovery service after which it is
            searched for again.
        greeted: Components that only send messages after a QueryIdentification, and its scope.
        retry_min: Seconds before an unanswered request is sent again for the first time.
        retry_max: Longest time in seconds between two requests to a silent component.
        refused_retry: Seconds between two requests after a refusal.
        watch_interval: Longest time in seconds between two checks of a controlled component, and
            between two requests to one that sends messages, but does not answer.
        check_interval: Longest time in seconds between two renewals of an every-change event, by
            which a restart of its provider is noticed.

    Raises:
        ValueError: A value is out of its range.
    """

    default_authority: int = 0
    control_timeout: int = 5
    control_survives_emergency: bool = False
    handoff_timeout: int = 60
    enhanced_timeout: int = 10
    event_timeout: int = 1
    event_rate_min: float = 0.1
    event_rate_max: float = MAX_EVENT_RATE
    event_rate_budget: float = 4000.0
    max_events: int = 255
    heartbeat_rate: float | None = None
    heartbeat_scope: Scope = Scope.SUBSYSTEM
    max_list_elements: int = 1024
    discovery_scope: Scope = Scope.COMPONENT
    subsystem_name: str = ""
    registration_lifetime: float = 300.0
    digital_resources: tuple[str, ...] = ()
    register_services: bool = True
    discovery_timeout: float = 60.0
    greeted: Mapping[JausAddress, Scope] = field(default_factory=dict)
    retry_min: float = 0.1
    retry_max: float = 5.0
    refused_retry: float = 5.0
    watch_interval: float = 1.0
    check_interval: float = 10.0

    def __post_init__(self) -> None:
        check_range("default_authority", self.default_authority, 0, 255)
        check_range("control_timeout", self.control_timeout, 0, 255)
        check_range("handoff_timeout", self.handoff_timeout, 0, 255)
        check_range("enhanced_timeout", self.enhanced_timeout, 0, 255)
        check_range("event_timeout", self.event_timeout, 0, 255)
        check_range("event_rate_max", self.event_rate_max, 0.02, MAX_EVENT_RATE)
        check_range("event_rate_min", self.event_rate_min, 0.02, self.event_rate_max)
        check_range("event_rate_budget", self.event_rate_budget, 1, 255 * MAX_EVENT_RATE)
        check_range("max_events", self.max_events, 0, 255)
        check_range("heartbeat_rate", self.heartbeat_rate or 0.0, 0, 100)
        check_range("heartbeat_scope", self.heartbeat_scope, Scope.SYSTEM, Scope.SUBSYSTEM)
        check_range("max_list_elements", self.max_list_elements, 0, 65534)
        check_range("discovery_timeout", self.discovery_timeout, 1, 86400)
        check_range("registration_lifetime", self.registration_lifetime, 1, 86400)
        check_range("retry_min", self.retry_min, 0.05, 60)
        check_range("retry_max", self.retry_max, self.retry_min, 600)
        check_range("refused_retry", self.refused_retry, 0.05, 600)
        check_range("watch_interval", self.watch_interval, 0.05, 600)
        check_range("check_interval", self.check_interval, 0.05, 600)
        for url in self.digital_resources:
            server_type(url)
        for address in self.greeted:
            if not address.is_concrete:
                raise ValueError(f"{address} names no single component to greet")


class Completion:
    """The result of a command, which its handler returns before the command has ended.

    A client that sent the command in a CreateCommandEvent is sent the result as a CommandEvent
    (AS5710 v1.1, Events); for other commands it has no effect. A command whose handler returns None
    has succeeded, and one whose handler raises has failed. May be used on any thread.
    """

    def __init__(self) -> None:
        self._succeeded: bool | None = None
        self._on_end: Callable[[], None] | None = None

    @property
    def active(self) -> bool:
        """Whether the command is still under way."""
        return self._succeeded is None

    @property
    def succeeded(self) -> bool | None:
        """Whether the command has succeeded; None while it is under way."""
        return self._succeeded

    def succeed(self) -> None:
        """Ends the command with success; no effect after its end."""
        self._end(succeeded=True)

    def fail(self) -> None:
        """Ends the command with failure; no effect after its end."""
        self._end(succeeded=False)

    def when_ended(self, action: Callable[[], None]) -> None:
        """Runs an action at the end, or now if it has ended; only the last action is kept."""
        self._on_end = action
        if self._succeeded is not None:
            action()

    def _end(self, *, succeeded: bool) -> None:
        if self._succeeded is None:
            self._succeeded = succeeded
            if self._on_end is not None:
                self._on_end()


# request ids for command events; report events have smaller ones
COMMAND_REQUESTS = range(224, 255)

_RTSP, _MPEG2_TS, _FTP, _SFTP, _FTP_OVER_SSH, _HTTP, _HTTPS, _SCP = range(8)

_SERVER_TYPES = {  # by the scheme of a URL
    "rtsp": _RTSP,
    "udp": _MPEG2_TS,
    "rtp": _MPEG2_TS,
    "ftp": _FTP,
    "sftp": _SFTP,
    "http": _HTTP,
    "https": _HTTPS,
    "scp": _SCP,
}
_LONGEST_URL = 255


def server_type(url: str) -> int:
    """Returns the ServerType of a URL (IOP); raises ValueError for one that is not allowed."""
    scheme = url.partition("://")[0].lower()
    if scheme not in _SERVER_TYPES or "://" not in url:
        known = ", ".join(_SERVER_TYPES)
        raise ValueError(f"{url} is no URL of a digital resource; it begins with {known}")
    if len(url) > _LONGEST_URL or not url.isascii():
        raise ValueError(f"{url} has more than {_LONGEST_URL} characters, or others than ASCII")
    return _SERVER_TYPES[scheme]


DIGITAL_RESOURCE_DISCOVERY = "urn:jaus:jss:iop:DigitalResourceDiscovery"
