"""How a connection of a bridge can carry its message: inference of direction and exchange.

What a bridge and its peers provide, and what the map assigns, mostly leave one option. A notation
in which nobody states it, ros2jaus text, has it from here, and rules name the options.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.jaus.services import (
    inputs_by_name,
    provided_services,
    query_name,
    searched_services,
)
from jausml.language.semantics.subject import remembered

MESSAGE, EVENT = "message", "periodicEvent"

CONNECTION = "bridge.Connection"
FEATURES = ("direction", "exchange")
"""The features of a connection that are inferred."""


@dataclass(frozen=True, slots=True)
class ExchangeOption:
    """A direction and an exchange that are possible for a connection.

    Attributes:
        direction: Literal of `bridge.Direction`.
        exchange: Literal of `bridge.Exchange`; an event stands for queries too.
    """

    direction: str
    exchange: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Inferred:
    """The features of a connection that nobody stated.

    Attributes:
        options: Those that agree with what is stated. With one of them the literals are
            certain; with none they are those that go best with the map and the message.
    """

    direction: str
    exchange: str
    options: tuple[ExchangeOption, ...] = ()

    @property
    def is_certain(self) -> bool:
        """Whether there is exactly one option."""
        return len(self.options) == 1


def infer(
    connection: bridge.Connection,
    direction: str | None = None,
    exchange: str | None = None,
    *,
    is_known: bool = True,
) -> Inferred:
    """Returns direction and exchange of a connection of which one or both are not stated.

    Args:
        connection: The connection, whose own values of both do not count.
        is_known: False where services or peers of the connection could not be read.
    """
    options = possible_exchanges(connection) if is_known else ()
    agreeing = tuple(
        exchange_option
        for exchange_option in options
        if direction in (None, exchange_option.direction)
        and _agrees(exchange_option, exchange, connection)
    )
    if len(agreeing) == 1:
        [option] = agreeing
        return Inferred(option.direction, exchange or option.exchange, agreeing)
    likely = direction or (TO_JAUS if _directions(connection) == [TO_JAUS] else TO_ROS)
    return Inferred(likely, exchange or _usual_exchange(connection), agreeing)


def possible_exchanges(connection: bridge.Connection) -> tuple[ExchangeOption, ...]:
    """Returns the options that the map, the services of the bridge and those of the peers allow.

    Args:
        connection: The connection. Peers that it does not name may have the services that the
            bridge uses.
    """
    owner, map_ = connection.eContainer(), connection.map
    if owner is None or map_ is None or map_.message is None or map_.type is None:
        return ()
    return tuple(_options(connection, owner, _directions(connection)))


def unstated(connection: bridge.Connection) -> frozenset[str]:
    """Returns the names of `FEATURES` that can be inferred, so that text need not state them."""
    actual = {name: getattr(getattr(connection, name), "name", None) for name in FEATURES}
    # As much as possible is left out: both, else the exchange, else the direction.
    for open_features in (FEATURES, FEATURES[1:], FEATURES[:1]):
        stated = [None if name in open_features else actual[name] for name in FEATURES]
        inferred = infer(connection, *stated)
        inference = {"direction": inferred.direction, "exchange": inferred.exchange}
        if inferred.is_certain and inference == actual:
            return frozenset(open_features)
    return frozenset()


def _options(
    connection: bridge.Connection, owner: bridge.Bridge, directions: Sequence[str]
) -> Iterator[ExchangeOption]:
    message, own = connection.map.message, provided_services(owner)
    partners = _partners(connection, owner)
    named = " and ".join(str(peer.name) for peer in connection.peers)
    partner = named or "a component that provides the service"
    if TO_ROS in directions:
        if _takes(own, message):
            yield ExchangeOption(
                TO_ROS, MESSAGE, f"{owner.name} takes it from {named or 'whoever sends it'}"
            )
        if partners and all(_sends(services, message) for services in partners):
            if all(_has_query(connection, services) for services in partners):
                yield ExchangeOption(TO_ROS, EVENT, f"{owner.name} asks {partner} for it")
            else:
                yield ExchangeOption(TO_ROS, MESSAGE, f"{owner.name} takes it from {partner}")
    if TO_JAUS in directions:
        if partners and all(_takes(services, message) for services in partners):
            yield ExchangeOption(TO_JAUS, MESSAGE, f"{owner.name} sends it to {partner}")
        if _sends(own, message):
            yield ExchangeOption(TO_JAUS, EVENT, f"{owner.name} reports it to whoever asks")


def _agrees(option: ExchangeOption, exchange: str | None, connection: bridge.Connection) -> bool:
    """Tells whether an option is of the stated exchange: events and queries are asked for alike."""
    if exchange is None:
        return True
    if (option.exchange == MESSAGE) == (exchange == MESSAGE):
        return True
    # A peer may send its reports unasked.
    has_peers = bool(connection.peers) or connection.search is not None
    return exchange == MESSAGE and option.direction == TO_ROS and has_peers


def _directions(connection: bridge.Connection) -> list[str]:
    """Returns the directions that a connection has assignments and topics for."""
    map_ = connection.map
    if any(topic.join is not None for topic in connection.topics):
        return [TO_JAUS]
    if connection.sources:
        return [TO_ROS]
    if map_ is None or bool(map_.toRos) == bool(map_.toJaus):
        return [TO_ROS, TO_JAUS]
    return [TO_ROS] if map_.toRos else [TO_JAUS]


def _usual_exchange(connection: bridge.Connection) -> str:
    """Returns how a message crosses that no service at hand has: by events what has a query."""
    message = connection.map.message if connection.map is not None else None
    service = message.eContainer() if message is not None else None
    if service is None or message not in _sent(service):
        return MESSAGE
    return EVENT if _has_query(connection, [service]) else MESSAGE


def _partners(connection: bridge.Connection, owner: bridge.Bridge) -> list[list[jaus.Service]]:
    """Returns the services of each component at the other end."""
    if connection.peers:
        return [provided_services(peer) for peer in connection.peers]
    if connection.search is not None:
        return [searched_services(connection.search)]
    services = with_inherited(owner.uses)
    return [services] if services else []


def _takes(services: Iterable[jaus.Service], message: jaus.MessageDef) -> bool:
    return any(_has(_taken(service), message) for service in services)


def _sends(services: Iterable[jaus.Service], message: jaus.MessageDef) -> bool:
    return any(_has(_sent(service), message) for service in services)


@remembered
def _taken(service: jaus.Service) -> frozenset[object]:
    """Returns the messages that a service takes, with their codes."""
    return _with_codes(service.inputs)


@remembered
def _sent(service: jaus.Service) -> frozenset[object]:
    """Returns the messages that a service sends, with their codes."""
    return _with_codes(service.outputs)


def _with_codes(messages: Iterable[jaus.MessageDef]) -> frozenset[object]:
    return frozenset(key for message in messages for key in (message, message.code) if key)


def _has(known: frozenset[object], wanted: jaus.MessageDef) -> bool:
    """Tells whether messages have one of the code; rules compare the layouts later."""
    return wanted in known or wanted.code in known


def _has_query(connection: bridge.Connection, services: Sequence[jaus.Service]) -> bool:
    if connection.query is not None:
        return True
    wanted = query_name(connection.map.message)
    return any(wanted in inputs_by_name(service) for service in services)
