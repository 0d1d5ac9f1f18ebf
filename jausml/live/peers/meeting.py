"""What peers are like: each is asked as a bridge would ask it, and what was learnt is told."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from jausml.live.peers.asking import NoAnswer
from jausml.live.peers.operator import running_operator

if TYPE_CHECKING:
    from jausml.live.messages import Catalogue
    from jausml.live.peers.network import Network

_TIMEOUT_S = 1.0


class Met(NamedTuple):
    """What is told of a peer.

    Attributes:
        verdict: `ok`, `note` for what it does otherwise than others, `error` if it is silent.
    """

    name: str
    verdict: str
    text: str


def met(network: Network, catalogue: Catalogue) -> list[Met]:
    """Returns what the peers of a network are like, which are asked one after the other.

    Raises:
        OSError: The network cannot be used as the settings say.
    """
    found: list[Met] = []
    with running_operator(network, catalogue, _TIMEOUT_S) as operator:
        for peer in network.settings.address_book:
            try:
                services = operator.meet(peer)
            except NoAnswer as error:
                found.append(Met(str(peer), "error", str(error)))
                continue
            count = f"{len(services)} services" if services else "no services that it tells of"
            found.append(Met(str(peer), "ok", f"answers; {count}"))
            learnt = [each for each in operator.quirks() if each[0] == peer]
            found += [Met(str(peer), "note", str(each)) for _, each in learnt]
    return found
