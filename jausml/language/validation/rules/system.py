"""Rules about systems: package metadata, hosts, placements."""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Iterator, Mapping

from jausml.language.metamodel.classes import jaus, ros, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.names import snake_case, taken
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_VERSION = re.compile(r"(0|[1-9][0-9]*)(\.(0|[1-9][0-9]*)){2}")
_EMAIL = re.compile(r"[A-Za-z0-9._%+-]+@[A-Za-z0-9-]+(\.[A-Za-z0-9-]+)+")
_HIGHEST_DOMAIN = 101
_HIGHEST_PORT = 65535
_HIGHEST_TTL = 255
_FRAGMENT_SIZES = (64, 4079)


@rule("JML511", "impossible package metadata", kinds=system.System, needs=())
def metadata(_: Subject, whole: system.System) -> Iterator[Finding]:
    """The package metadata of a system is valid in a package.xml (REP 149).

    The version is three numbers joined by dots, the address of the maintainer is an e-mail address,
    and the names of maintainer and license are single lines that are not blank. No package depends
    on itself, nor by way of others: colcon could build none of them first.

    Bad: `version="1.0"`

    Good: `version="1.0.0"`
    """
    if not _VERSION.fullmatch(whole.version or ""):
        message = f"version {whole.version!r} is not three numbers joined by dots"
        yield Finding(whole, message, "version")
    if not _EMAIL.fullmatch(whole.maintainerEmail or ""):
        message = f"maintainerEmail {whole.maintainerEmail!r} is no e-mail address"
        yield Finding(whole, message, "maintainerEmail")
    for feature, text in (("maintainer", whole.maintainer), ("license", whole.license)):
        if not text.strip() or not text.isprintable():
            yield Finding(whole, f"{feature} {text!r} is blank or not of one line", feature)


@metadata.also(system.System, needs=())
def _dependencies(_: Subject, whole: system.System) -> Iterator[Finding]:
    elements: list[jaus.Component | ros.Node] = [*whole.components, *whole.bridges, *whole.nodes]
    packages = {_package(participant.name or ""): participant for participant in elements}
    needed = {name: list(participant.dependencies) for name, participant in packages.items()}
    for name, element in packages.items():
        way = _way_back(name, needed)
        if way:
            message = f"the package of '{element.name}' depends on itself: {' -> '.join(way)}"
            yield Finding(element, message, "dependencies")


def _package(name: str) -> str:
    """Returns the name of the package of an element."""
    own = snake_case(name)
    return f"{own}_jaus" if taken(own) else own


def _way_back(package: str, needed: Mapping[str, list[str]]) -> list[str]:
    """Returns the packages from one by those that each needs back to it; none for no way."""
    paths, seen = [[package]], {package}
    for way in paths:
        for dependency in needed.get(way[-1], ()):
            if dependency == package:
                return [*way, dependency]
            if dependency not in seen:
                seen.add(dependency)
                paths.append([*way, dependency])
    return []


@rule("JML512", "impossible network settings", kinds=system.System, needs=("name",))
def network(_: Subject, whole: system.System) -> Iterator[Finding]:
    """The ROS domain is 0..101; a host has an IPv4 address, a UDP port and a multicast group.

    An interface has an address of its own: no group, no broadcast, not 0.0.0.0. Higher domains
    reach into the ephemeral ports of Linux. Multicast groups are 224.0.0.0..239.255.255.255
    (RFC 5771), times to live 0..255. Packets carry 64..4079 bytes; peers cut larger ones.

    Bad: `<hosts name="onboard" multicastGroup="10.0.0.1"/>`

    Good: `<hosts name="onboard" multicastGroup="239.255.0.1"/>`
    """
    yield from _range(whole, "rosDomain", whole.rosDomain, 0, _HIGHEST_DOMAIN)


@network.also(system.Host, needs=("name",))
def _network_host(_: Subject, host: system.Host) -> Iterator[Finding]:
    yield from _range(host, "port", host.port, 1, _HIGHEST_PORT)
    yield from _range(host, "multicastTtl", host.multicastTtl, 0, _HIGHEST_TTL)
    yield from _range(host, "fragmentSize", host.fragmentSize, *_FRAGMENT_SIZES)
    interface = _ipv4(host.interface)
    if interface is None or _is_of_many(interface):
        what = "no IPv4 address" if interface is None else "no address of one computer"
        message = f"interface {host.interface!r} of '{host.name}' is {what}"
        yield Finding(host, message, "interface")
    group = _ipv4(host.multicastGroup)
    if group is None or not group.is_multicast:
        message = f"multicastGroup {host.multicastGroup!r} of '{host.name}'"
        yield Finding(host, f"{message} is no multicast address", "multicastGroup")


@rule("JML513", "placed twice or elsewhere", kinds=system.System)
def placements(_: Subject, whole: system.System) -> Iterator[Finding]:
    """An element runs on one host, and a system places its own elements on its own hosts.

    Bad: two placements of the component vehicle

    Good: one
    """
    own = {*whole.components, *whole.bridges, *whole.nodes}
    holders: dict[EObject, system.Placement] = {}
    for placement in whole.placements:
        if placement.host is not None and placement.host not in whole.hosts:
            message = f"host '{placement.host.name}' is not of system '{whole.name}'"
            yield Finding(placement, message, "host")
        placed: list[jaus.Component | ros.Node] = [*placement.components, *placement.nodes]
        for element in placed:
            feature = "nodes" if isinstance(element, ros.Node) else "components"
            first = holders.setdefault(element, placement)
            if element not in own:
                message = f"'{element.name}' is not of system '{whole.name}'"
                yield Finding(placement, message, feature)
            elif first is not placement:
                note = Note(first, "the first placement")
                message = f"'{element.name}' is placed twice"
                yield Finding(placement, message, feature, related=(note,))


@rule(
    "JML514", "hosts that cannot talk to each other", severity=Severity.WARNING, kinds=system.System
)
def transports(_: Subject, whole: system.System) -> Iterator[Finding]:
    """Either all hosts of a system speak JAUS over TCP, or none of them does.

    A host with the transport `jtcp` and one with `judp` or `nodeManager` do not hear each other.

    Bad: `<hosts name="onboard" transport="jtcp"/>` beside `<hosts name="station"/>`

    Good: `transport="jtcp"` for both
    """
    for host in whole.hosts[1:]:
        first = whole.hosts[0]
        if (host.transport.name == "jtcp") != (first.transport.name == "jtcp"):
            note = Note(first, f"'{first.name}' has {first.transport.name}")
            message = f"'{host.name}' has the transport {host.transport.name}"
            yield Finding(host, message, "transport", related=(note,))


def _range(
    element: system.NamedElement, feature: str, value: int, lower: int, upper: int
) -> Iterator[Finding]:
    if not lower <= value <= upper:
        message = f"{feature} {value} of '{element.name}' is not in {lower}..{upper}"
        yield Finding(element, message, feature)


def _is_of_many(address: ipaddress.IPv4Address) -> bool:
    return address.is_unspecified or address.is_multicast or address.is_reserved


def _ipv4(text: str) -> ipaddress.IPv4Address | None:
    try:
        return ipaddress.IPv4Address(text)
    except ValueError:
        return None
