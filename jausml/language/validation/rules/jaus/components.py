"""Rules about JAUS components: addresses, connections, control."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.limits import LEAST_RATE, MAXIMUM_RATE
from jausml.language.semantics.jaus.commands import needs_control
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.jaus.services import (
    find_output,
    find_query,
    is_known,
    provided_services,
    provides_access_control,
)
from jausml.language.semantics.subject import Subject
from jausml.language.validation.findings import missing_query, time_findings, unprovided
from jausml.language.validation.rule import Finding, Note, rule

_ENDS = ("name", "provider", "search", "message", "query")
_LIMITS = (("subsystem", 65534), ("node", 254), ("component", 254))
_WILDCARD_SUBSYSTEM = 65535
_NUMBERS = {
    "authority": (0, 255),
    "defaultAuthority": (0, 255),
    "controlTimeout": (0, 255),
    "eventTimeout": (0, 255),
}


@rule("JML301", "JAUS address out of range", kinds=jaus.Component, needs=("name", "address"))
def address_range(_: Subject, component: jaus.Component) -> Iterator[Finding]:
    """An address is subsystem 1..65534, node 1..254 and component 1..254 (AS5669A).

    0 is reserved, and 65535 and 255 address all subsystems, nodes or components at once.

    Bad: `<components name="vehicle" address="100.1.255"/>`

    Good: `<components name="vehicle" address="100.1.1"/>`
    """
    if not component.address:
        return
    for (name, maximum), text in zip(_LIMITS, component.address.split("."), strict=False):
        if not 1 <= int(text) <= maximum:
            message = f"{name} id {text} of '{component.name}' is not in 1..{maximum}"
            yield Finding(component, message, "address")


@rule(
    "JML309",
    "subsystem id that Junior takes for a wildcard",
    severity=Severity.WARNING,
    kinds=jaus.Component,
    needs=("name", "address"),
)
def address_bytes(_: Subject, component: jaus.Component) -> Iterator[Finding]:
    """Neither byte of a subsystem id is 255, so that peers on Junior can talk to the component.

    AS5669A allows such ids. Junior, the stack met most often, takes each byte 255 of an address
    for a wildcard, and cannot connect to subsystems 255, 511, ... and 65280..65534.

    Bad: `<components name="vehicle" address="511.1.1"/>`

    Good: `<components name="vehicle" address="512.1.1"/>`
    """
    subsystem = int((component.address or "0").split(".")[0])
    if subsystem < _WILDCARD_SUBSYSTEM and 0xFF in divmod(subsystem, 0x100):
        message = f"subsystem id {subsystem} of '{component.name}' has a byte 255"
        yield Finding(component, message, "address")


@rule("JML302", "JAUS address used twice")
def address_unique(subject: Subject) -> Iterator[Finding]:
    """Each component of a system has its own address; bridges are components too.

    If two processes have the same address, a message may reach either of them.

    Bad: a component and a bridge, both with `address="100.1.1"`

    Good: `100.1.1` and `100.1.2`
    """
    for group in subject.systems(("name", "address")):
        first: dict[tuple[int, ...], jaus.Component] = {}
        for component in group:
            if not isinstance(component, jaus.Component) or not component.address:
                continue
            address = tuple(int(part) for part in component.address.split("."))
            holder = first.setdefault(address, component)
            if holder is not component:
                message = f"address {component.address} of '{component.name}' is that of"
                note = Note(holder, f"'{holder.name}' has the address", "address")
                yield Finding(component, f"{message} '{holder.name}'", "address", related=(note,))


@rule("JML303", "number out of range", kinds=jaus.Component, needs=("name",))
def component_numbers(_: Subject, component: jaus.Component) -> Iterator[Finding]:
    """Authority codes and time-outs are one byte on the wire: 0..255 (AS5710).

    Times in seconds are finite and not negative.

    Bad: `authority="300"`

    Good: `authority="200"`
    """
    for name, (lower, upper) in _NUMBERS.items():
        value = getattr(component, name)
        if not lower <= value <= upper:
            message = f"{name} {value} of '{component.name}' is not in {lower}..{upper}"
            yield Finding(component, message, name)


@component_numbers.also(jaus.ServiceConnection, needs=("name",))
def _component_numbers_service_connection(
    _: Subject, connection: jaus.ServiceConnection
) -> Iterator[Finding]:
    yield from time_findings(connection, "silenceTimeout")


@rule(
    "JML369",
    "state that a silent report does not lead to",
    kinds=jaus.Component,
    needs=("name", "external", "provides", "coreServices", "connections"),
)
def degraded_state(subject: Subject, component: jaus.Component) -> Iterator[Finding]:
    """A connection that leads to Standby can fall silent, and its component has this state.

    A report falls silent after a `silenceTimeout` above 0, if it is asked for more than once.
    Standby is a state of Management (AS5710).

    Bad: `<connections name="pose" whenSilent="standby" .../>` without a `silenceTimeout`

    Good: the same with `silenceTimeout="2.0"`
    """
    if component.external or not is_known(subject, component):
        return
    has_state = any(service.name == "Management" for service in provided_services(component))
    for connection in component.connections:
        if connection.whenSilent.name == "stay":
            continue
        if not has_state:
            message = f"'{component.name}' has no Standby: it provides no Management"
            yield Finding(connection, message, "whenSilent", "let it provide Management")
        if connection.exchange.name == "oneTime":
            yield Finding(
                connection,
                f"'{connection.name}' brings one report, and is never silent",
                "exchange",
            )
        elif connection.silenceTimeout == 0:
            message = f"'{connection.name}' never counts as silent"
            yield Finding(connection, message, "whenSilent", "state its silenceTimeout")


@rule(
    "JML353",
    "command that nobody can give",
    kinds=jaus.Component,
    needs=("name", "external", "provides", "coreServices"),
)
def commands_controlled(subject: Subject, component: jaus.Component) -> Iterator[Finding]:
    """A component whose services have commands provides AccessControl.

    A component obeys commands only from its controller, and without AccessControl nobody can become
    the controller (AS5710). Commands for everyone are those of published services without
    AccessControl.

    Bad: a component with `coreServices="none"` that provides a service of yours with the command
    SetLamp, which inherits nothing

    Good: the same service with `inherits` of Management
    """
    if component.external or not is_known(subject, component):
        return
    if provides_access_control(component):
        return
    for service in provided_services(component):
        command = next(
            (candidate for candidate in service.inputs if needs_control(candidate, service)), None
        )
        if command is not None:
            message = f"'{component.name}' obeys {command.name} from nobody"
            hint = f"let {service.name} inherit Management"
            note = Note(service, f"'{service.name}'")
            yield Finding(
                component, f"{message}: it provides no AccessControl", "provides", hint, (note,)
            )


@rule(
    "JML304",
    "connection to a report that the provider does not send",
    kinds=jaus.ServiceConnection,
    needs=_ENDS,
)
def connection_provided(subject: Subject, connection: jaus.ServiceConnection) -> Iterator[Finding]:
    """The provider of a connection provides a service whose outputs hold the report.

    Services that the provided ones inherit count. A message of another service also counts if its
    code and its layout are the same.

    Bad: a connection to ReportLocalPose with a provider that provides VelocityStateSensor alone

    Good: the same provider with `provides` of LocalPoseSensor as well
    """
    provider, message = connection.provider or connection.search, connection.message
    if provider is None or not is_known(subject, provider) or not subject.is_intact(message):
        return
    if find_output(message, provider) is None:
        yield unprovided(connection, provider, message, "sends", "message")


@rule("JML305", "connection without a query", kinds=jaus.ServiceConnection, needs=_ENDS)
def connection_query(subject: Subject, connection: jaus.ServiceConnection) -> Iterator[Finding]:
    """A report is asked for by a query that the provider takes.

    Events carry the query inside (AS5710, CreateEvent). Without `query` it is found by name:
    QueryX for ReportX, or X.

    Bad: a connection to a message named PoseReport without `query`

    Good: the same connection with `query` set to the message that asks for it
    """
    provider, message = connection.provider or connection.search, connection.message
    if provider is None or not is_known(subject, provider) or not subject.is_intact(message):
        return
    if connection.query is not None and not subject.is_intact(connection.query):
        return
    if find_output(message, provider) is None:
        return
    if find_query(connection, provider) is None:
        yield missing_query(connection, message, provider)


@rule(
    "JML306", "rate out of range", kinds=jaus.ServiceConnection, needs=("name", "exchange", "rate")
)
def connection_rate(_: Subject, connection: jaus.ServiceConnection) -> Iterator[Finding]:
    """The rate of a periodic connection is above 0 and at most 1092 per second.

    More does not fit the field of the CreateEvent message (AS5710).

    Bad: `exchange="periodic" rate="0"`

    Good: `exchange="periodic" rate="10.0"`
    """
    if connection.exchange.name == "periodic":
        yield from rate_finding(connection)


@rule(
    "JML307",
    "control of a component that cannot be controlled",
    kinds=jaus.Component,
    needs=("name", "controls"),
)
def controls_access(subject: Subject, component: jaus.Component) -> Iterator[Finding]:
    """A component named in `controls` provides AccessControl, which components do by default.

    Without the service it never answers a request for control (AS5710, RequestControl).

    Bad: `controls="sensor"` where sensor is `external` and provides VelocityStateSensor alone

    Good: `controls="vehicle"` where vehicle provides PrimitiveDriver, which inherits it
    """
    for target in component.controls:
        if target is component:
            message = f"'{component.name}' controls itself"
            yield Finding(component, message, "controls")
        elif is_known(subject, target) and not provides_access_control(target):
            yield Finding(
                component,
                f"'{target.name}', which '{component.name}' controls, provides no AccessControl",
                "controls",
                related=(Note(target, f"'{target.name}'"),),
            )


@rule("JML308", "service provided twice", kinds=jaus.Component, needs=("name", "provides"))
def services_unique(_: Subject, component: jaus.Component) -> Iterator[Finding]:
    """A component provides one service of a URN.

    Discovery reports services by URN (AS5710, ReportServices); two versions of one service in a
    component would answer the same messages. Services that are only inherited do not count:
    service sets inherit from different versions of the core.

    Bad: `provides` of Liveness from core-1.0 and of Liveness from core-1.1

    Good: `provides` of one of them
    """
    by_urn: dict[str, list[jaus.Service]] = defaultdict(list)
    for service in component.provides:
        if service.urn:
            by_urn[service.urn].append(service)
    for urn, services in by_urn.items():
        if len(services) > 1:
            versions = ", ".join(str(service.version) for service in services)
            message = f"'{component.name}' provides {urn} more than once (versions {versions})"
            second = [at for at, provided in enumerate(component.provides) if provided.urn == urn][
                1
            ]
            yield Finding(component, message, "provides", position=second)


@rule(
    "JML352",
    "state machine that a bridge does not run",
    severity=Severity.WARNING,
    kinds=bridge.Bridge,
)
def bridges(subject: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """A bridge translates messages and runs no state machine of the services that it provides.

    The rule ignores services of the library: a bridge handles those as its maps say.

    Bad: a bridge that provides a service with a state machine

    Good: a component that provides it
    """
    for service in with_inherited(owner.provides):
        is_kept = service.urn in SERVED_BY_RUNTIME or subject.model.is_library(service)
        if service.machines and not is_kept:
            text = f"the bridge '{owner.name}' does not run the state machine of"
            note = Note(service, f"'{service.name}'")
            yield Finding(owner, f"{text} '{service.name}'", "provides", related=(note,))


def rate_finding(connection: jaus.ServiceConnection | bridge.Connection) -> Iterator[Finding]:
    """Yields a finding when an event cannot have the rate of a connection."""
    if not LEAST_RATE <= connection.rate <= MAXIMUM_RATE:
        message = f"rate {connection.rate:g} of '{connection.name}' is out of range"
        yield Finding(connection, message, "rate", f"{LEAST_RATE:g} to {MAXIMUM_RATE:g}")
