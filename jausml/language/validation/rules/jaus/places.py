"""Rules about where external components are, and about those that must be greeted."""

from __future__ import annotations

import ipaddress
import re
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.hosts import endpoint_of, host_of, is_ipv4
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject

_NUMBERS = re.compile(r"[0-9.]+")
_HIGHEST_PORT = 65535


@rule("JML359", Severity.ERROR, "impossible place of a component")
def places(subject: Subject) -> Iterator[Finding]:
    """An external component that runs on no host of the system may state where it is.

    An `endpoint` has an IPv4 address of one computer, or the name of one, and a port of 1..65535.
    A component that is placed on a host has its place from there, and so has one that is generated.
    Only external components are greeted.

    Bad: `<components name="judge" external="true" endpoint="192.168.1.300"/>`

    Good: `<components name="judge" external="true" endpoint="192.168.1.42:3794" greet="true"/>`
    """
    needs = ("name", "external", "endpoint", "greet")
    for component in subject.instances(jaus.Component, needs=needs):
        if component.endpoint and (fault := _fault(component.endpoint)):
            message = f"endpoint {component.endpoint} of '{component.name}' {fault}"
            yield Finding(component, message, "endpoint")
        for feature in ("endpoint", "greet"):
            if getattr(component, feature) and not component.external:
                message = f"'{component.name}' has {feature}, but is generated here"
                hint = "leave it out, or make the component external"
                yield Finding(component, message, feature, hint)
    for whole in subject.instances(system.System):
        for component in _elements(whole):
            host = host_of(whole, component)
            if component.external and component.endpoint and host is not None:
                note = Note(host, f"'{host.name}' is at {host.interface}:{host.port}")
                message = f"'{component.name}' has an endpoint, and is placed on '{host.name}'"
                yield Finding(component, message, "endpoint", "leave out one of them", (note,))


@rule("JML361", Severity.WARNING, "stated peer that is not reached or not heard")
def reached(subject: Subject) -> Iterator[Finding]:
    """Processes reach an external component whose place is stated, and hear what it says.

    A bridge with `allowedHosts` hears the hosts that they name alone. Behind a node manager, the
    node manager decides where messages go. TCP reaches only those whose place is known, so a peer
    that must be greeted needs one there.

    Bad: `<components external="true" endpoint="192.168.1.42"/>` beside a bridge with
    `<allowedHosts>10.0.0.0/24</allowedHosts>`

    Good: the same with `<allowedHosts>192.168.1.42</allowedHosts>`
    """
    for whole in subject.instances(system.System):
        for component in _elements(whole):
            if component.external and (component.endpoint or component.greet):
                yield from _not_exchanged(whole, component)


def _not_exchanged(whole: system.System, component: jaus.Component) -> Iterator[Finding]:
    """Yields what keeps the processes of a system from exchanging messages with a component."""
    feature = "endpoint" if component.endpoint else "greet"
    place = endpoint_of(whole, component)
    processes = [each for each in _elements(whole) if not each.external]
    for host in dict.fromkeys(host_of(whole, each) for each in processes):
        if host is None:
            continue
        note = Note(host, f"'{host.name}' has {host.transport.name}")
        if host.transport.name == "nodeManager" and component.endpoint:
            message = f"endpoint of '{component.name}' has no effect behind a node manager"
            yield Finding(component, message, feature, related=(note,))
        elif host.transport.name == "jtcp" and place is None:
            message = f"'{component.name}' cannot be greeted by TCP: nobody says where it is"
            yield Finding(component, message, feature, "state its endpoint", (note,))
    for each in processes:
        if place is not None and isinstance(each, bridge.Bridge) and not _hears(each, place[0]):
            note = Note(each, f"'{each.name}' takes messages of its allowedHosts alone")
            message = f"'{each.name}' does not hear '{component.name}' at {place[0]}"
            hint = f"add {place[0]} to its allowedHosts"
            yield Finding(component, message, feature, hint, (note,))


def _hears(owner: bridge.Bridge, host: str) -> bool:
    """Tells whether a bridge may hear a host; what cannot be judged here counts as heard."""
    if not owner.allowedHosts or not is_ipv4(host):
        return True
    address = ipaddress.IPv4Address(host)
    try:
        return any(address in ipaddress.IPv4Network(each) for each in owner.allowedHosts)
    except ValueError:
        return True


def _fault(endpoint: str) -> str:
    """Returns what is wrong with an endpoint of the right form, empty when nothing is."""
    host, _, port = endpoint.partition(":")
    if port and not 1 <= int(port) <= _HIGHEST_PORT:
        return f"has a port that is not in 1..{_HIGHEST_PORT}"
    if not _NUMBERS.fullmatch(host):
        return ""
    if not is_ipv4(host):
        return "has no IPv4 address"
    address = ipaddress.IPv4Address(host)
    is_of_many = address.is_unspecified or address.is_multicast or address.is_reserved
    return "has no address of one computer" if is_of_many else ""


def _elements(whole: system.System) -> list[jaus.Component]:
    return [*whole.components, *whole.bridges]
