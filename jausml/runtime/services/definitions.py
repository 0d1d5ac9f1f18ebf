"""Terms that the component, its services and its clients share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum, IntEnum

from ..base.address import JausAddress
from ..base.settings import check_range

CORE = "urn:jaus:jss:core:"  # prefix of the identifiers of the core services (AS5710)

VERSION_1_1 = (1, 1)
"""Major and minor version of the core services of AS5710A; AS5710 is 1.0."""

MAX_EVENT_RATE = 1092.0  # upper limit of RequestedPeriodicRate in Hz (AS5710, CreateEvent)


@dataclass(frozen=True)
class ServiceIdentity:
    """A service as Discovery reports it (AS5710, ReportServices)."""

    urn: str  # e.g. ``urn:jaus:jss:mobility:PrimitiveDriver``; case matters
    major: int
    minor: int


class Guard(Enum):
    """Who a component obeys an input message from (AS5710, AccessControl and Management)."""

    ANY = "any"  # every component
    CONTROLLED = "controlled"  # the controller alone, in Standby or Ready
    READY = "ready"  # the controller alone, in Ready


class Status(IntEnum):
    """Management state of a component (AS5710, ReportStatus)."""

    INITIALIZE = 0
    READY = 1
    STANDBY = 2
    SHUTDOWN = 3
    FAILURE = 4
    EMERGENCY = 5


class Scope(IntEnum):
    """How much a Discovery service answers for (AS5710, QueryIdentification, QueryType)."""

    SYSTEM = 1
    SUBSYSTEM = 2
    NODE = 3
    COMPONENT = 4


@dataclass(frozen=True)
class HandoffRequest:
    """Somebody asks for control of a component that this one controls."""

    target: JausAddress  # the controlled component
    number: int  # by which the target knows the request
    client: JausAddress  # who asks
    authority: int  # the authority code with which it would have control
    explanation: str  # why it asks, for people


@dataclass(frozen=True)
class ComponentSettings:
    """How a component behaves towards its peers.

    Attributes:
        default_authority: Lowest authority code that may control the component, 0 to 255.
        control_timeout: Seconds after which control lapses unless it is requested again, 0 to
            255; 0 means never (AS5710, QueryTimeout).
        control_survives_emergency: Whether the controller keeps control in an emergency, for
            clients that count on it; AS5710 ends it. It is not obeyed before the end either.
        handoff_timeout: Seconds in which the controller decides who has asked it for control, 0 to
            255; 0 means any time (IOP, QueryHandoffTimeout).
        enhanced_timeout: Seconds after which such a request lapses unless it is sent again, 0 to
            255; 0 means never (IOP, QueryEnhancedTimeout).
        event_timeout: Minutes after which an event lapses unless it is updated, 0 to 255;
            0 means never (AS5710, QueryEventTimeout).
        event_rate_min: Slowest periodic event in Hz; slower requests get this rate.
        event_rate_max: Fastest periodic event in Hz; faster requests get this rate.
        event_rate_budget: Reports a second of all periodic events together; who asks for more
            than a fair share gets less.
        max_events: Events that the component serves at a time, 0 to 255. When all are taken, the
            host that has most gives way to one that has fewer.
        heartbeat_rate: Rate in Hz of unrequested heartbeats, up to 100; 0 means
            never. None means 1 Hz if the component provides the service UnsolicitedHeartbeat of
            the IOP, and never if it does not.
        heartbeat_scope: Whom these reach: SUBSYSTEM or SYSTEM.
        max_list_elements: Elements that the list of a ListManager may hold, 0 to 65534.
        discovery_scope: What the Discovery service answers for. One component of a subsystem
            takes SUBSYSTEM, by convention n.1.1.
        subsystem_name: Name of the subsystem in ReportIdentification; the component's own
            name when empty.
        registration_lifetime: Seconds after which a registered component that was not heard
            of is forgotten.
        digital_resources: URLs of the streams and files of the component, such as
            rtsp://10.0.0.7/front (IOP, Digital Resource Discovery). It reports them itself if it
            provides that service, else it registers them where its subsystem has it.
        register_services: Whether the component registers its services with the Discovery
            service of its subsystem.
        discovery_timeout: Seconds without an answer of that Discovery service after which it is
            taken for lost, and looked for.
        greeted: Components that say nothing before they are asked for their identification, and
            the scope that they are asked for.
        retry_min: Seconds before an unanswered request is sent again for the first time.
        retry_max: Longest time in seconds between two requests to a component that is silent.
        refused_retry: Seconds between two requests after a refusal.
        watch_interval: Longest time in seconds between two checks of a controlled component, and
            between two requests to one that is heard, but does not answer.
        check_interval: Longest time in seconds between two renewals of an every-change event,
            whose provider may rightly be silent; finds a provider that was restarted.

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
    """What a handler returns when its command is not done yet, and ends when it is.

    A client that sent the command in a CreateCommandEvent learns the end from a CommandEvent
    (AS5710 v1.1, Events); the end of any other command concerns nobody. A handler that returns
    nothing has done its command at once, one that raises has failed. May be used on any thread.
    """

    def __init__(self) -> None:
        self._succeeded: bool | None = None
        self._on_end: Callable[[], None] | None = None

    @property
    def active(self) -> bool:
        """Whether the command is still under way: neither done, failed, expired nor cancelled."""
        return self._succeeded is None

    @property
    def succeeded(self) -> bool | None:
        """Whether the command was done; None as long as it is under way."""
        return self._succeeded

    def succeed(self) -> None:
        """The command is done; no effect after its end."""
        self._end(succeeded=True)

    def fail(self) -> None:
        """The command cannot be done; no effect after its end."""
        self._end(succeeded=False)

    def when_ended(self, action: Callable[[], None]) -> None:
        """Runs an action at the end, or now if that is past; one action at most."""
        self._on_end = action
        if self._succeeded is not None:
            action()

    def _end(self, *, succeeded: bool) -> None:
        if self._succeeded is None:
            self._succeeded = succeeded
            if self._on_end is not None:
                self._on_end()


COMMAND_REQUESTS = range(224, 255)
"""Request ids of the command events of one provider: smaller ones are those of its events."""

_RTSP, _MPEG2_TS, _FTP, _SFTP, _FTP_OVER_SSH, _HTTP, _HTTPS, _SCP = range(8)

_SERVER_TYPES = {
    "rtsp": _RTSP,
    "udp": _MPEG2_TS,
    "rtp": _MPEG2_TS,
    "ftp": _FTP,
    "sftp": _SFTP,
    "http": _HTTP,
    "https": _HTTPS,
    "scp": _SCP,
}
"""Kinds of servers by the scheme of their URLs."""

_LONGEST_URL = 255


def server_type(url: str) -> int:
    """Returns the kind of server of a URL; ValueError where the IOP has none, or it is too long."""
    scheme = url.partition("://")[0].lower()
    if scheme not in _SERVER_TYPES or "://" not in url:
        known = ", ".join(_SERVER_TYPES)
        raise ValueError(f"{url} is no URL of a digital resource; it begins with {known}")
    if len(url) > _LONGEST_URL or not url.isascii():
        raise ValueError(f"{url} has more than {_LONGEST_URL} characters, or others than ASCII")
    return _SERVER_TYPES[scheme]


DIGITAL_RESOURCE_DISCOVERY = "urn:jaus:jss:iop:DigitalResourceDiscovery"
