"""Rules about systems: package metadata, hosts, placements."""

from __future__ import annotations

import ipaddress
import re
from typing import TYPE_CHECKING, Any

from jausml.model.diagnostics import Severity
from jausml.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.validation.subject import Subject

_VERSION = re.compile(r"(0|[1-9][0-9]*)(\.(0|[1-9][0-9]*)){2}")
_EMAIL = re.compile(r"[A-Za-z0-9._%+-]+@[A-Za-z0-9-]+(\.[A-Za-z0-9-]+)+")
_HIGHEST_DOMAIN = 101
_HIGHEST_PORT = 65535
_HIGHEST_TTL = 255


@rule("JML511", Severity.ERROR, "impossible package metadata")
def metadata(subject: Subject) -> Iterator[Finding]:
    """What a system says for its packages is what a package.xml can hold (REP 149).

    The version is three numbers joined by dots, the address of the maintainer one of e-mail,
    the names of maintainer and license are not blank and of one line.

    Bad: `version="1.0"`

    Good: `version="1.0.0"`
    """
    for system in subject.instances("system.System"):
        if not _VERSION.fullmatch(system.version or ""):
            message = f"version {system.version!a} is not three numbers joined by dots"
            yield Finding(system, message, "version")
        if not _EMAIL.fullmatch(system.maintainerEmail or ""):
            message = f"maintainerEmail {system.maintainerEmail!a} is no e-mail address"
            yield Finding(system, message, "maintainerEmail")
        for feature in ("maintainer", "license"):
            text = getattr(system, feature) or ""
            if not text.strip() or not text.isprintable():
                yield Finding(system, f"{feature} {text!a} is blank or not of one line", feature)


@rule("JML512", Severity.ERROR, "impossible network settings")
def network(subject: Subject) -> Iterator[Finding]:
    """The ROS domain is 0..101; a host has an IPv4 address, a UDP port and a multicast group.

    Higher domains reach into the ephemeral ports of Linux. Multicast groups are
    224.0.0.0..239.255.255.255 (RFC 5771), times to live 0..255.

    Bad: `<hosts name="onboard" multicastGroup="10.0.0.1"/>`

    Good: `<hosts name="onboard" multicastGroup="239.255.0.1"/>`
    """
    for system in subject.instances("system.System"):
        yield from _range(system, "rosDomain", 0, _HIGHEST_DOMAIN)
    for host in subject.instances("system.Host"):
        yield from _range(host, "port", 1, _HIGHEST_PORT)
        yield from _range(host, "multicastTtl", 0, _HIGHEST_TTL)
        if _ipv4(host.interface) is None:
            message = f"interface {host.interface!a} of '{host.name}' is no IPv4 address"
            yield Finding(host, message, "interface")
        group = _ipv4(host.multicastGroup)
        if group is None or not group.is_multicast:
            message = f"multicastGroup {host.multicastGroup!a} of '{host.name}'"
            yield Finding(host, f"{message} is no multicast address", "multicastGroup")


@rule("JML513", Severity.ERROR, "placed twice or elsewhere")
def placements(subject: Subject) -> Iterator[Finding]:
    """An element runs on one host, and a system places its own elements on its own hosts.

    Bad: two placements of the component vehicle

    Good: one
    """
    for system in subject.instances("system.System"):
        own = {*system.components, *system.bridges, *system.nodes}
        holders: dict[Any, Any] = {}
        for placement in system.placements:
            if placement.host is not None and placement.host not in system.hosts:
                message = f"host '{placement.host.name}' is not of system '{system.name}'"
                yield Finding(placement, message, "host")
            for feature in ("components", "nodes"):
                for element in getattr(placement, feature):
                    first = holders.setdefault(element, placement)
                    if element not in own:
                        message = f"'{element.name}' is not of system '{system.name}'"
                        yield Finding(placement, message, feature)
                    elif first is not placement:
                        note = Note(first, "the first placement")
                        message = f"'{element.name}' is placed twice"
                        yield Finding(placement, message, feature, related=(note,))


@rule("JML514", Severity.WARNING, "hosts that cannot talk to each other")
def transports(subject: Subject) -> Iterator[Finding]:
    """Hosts of one system speak JAUS over TCP all, or none of them does.

    A host with the transport `jtcp` and one with `judp` or `nodeManager` do not hear each other.

    Bad: `<hosts name="onboard" transport="jtcp"/>` beside `<hosts name="station"/>`

    Good: `transport="jtcp"` for both
    """
    for system in subject.instances("system.System"):
        for host in system.hosts[1:]:
            first = system.hosts[0]
            if (host.transport.name == "jtcp") != (first.transport.name == "jtcp"):
                note = Note(first, f"'{first.name}' has {first.transport.name}")
                message = f"'{host.name}' has the transport {host.transport.name}"
                yield Finding(host, message, "transport", related=(note,))


def _range(element: Any, feature: str, lower: int, upper: int) -> Iterator[Finding]:
    value = getattr(element, feature)
    if not lower <= value <= upper:
        message = f"{feature} {value} of '{element.name}' is not in {lower}..{upper}"
        yield Finding(element, message, feature)


def _ipv4(text: Any) -> ipaddress.IPv4Address | None:
    try:
        return ipaddress.IPv4Address(text)
    except ValueError:
        return None


RULES = (metadata, network, placements, transports)
