"""What peers are like: each is asked as a bridge would ask it, and what was learnt is told."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.operator import running_operator
from jausml.live.peers.query_client import NoAnswer

if TYPE_CHECKING:
    from jausml.live.messages import Catalogue
    from jausml.live.peers.network import Network

_TIMEOUT_S = 1.0


def check_peers(network: Network, catalogue: Catalogue) -> list[tuple[str, str, str]]:
    """Asks the peers of a network, one after the other; returns names, verdicts and texts.

    Verdicts are `ok`, `note` for what one does otherwise than others, `error` if it is silent.
    """
    found: list[tuple[str, str, str]] = []
    with running_operator(network, catalogue, _TIMEOUT_S) as operator:
        for peer in network.settings.address_book:
            try:
                services = operator.meet(peer)
            except NoAnswer as error:
                found.append((str(peer), "error", str(error)))
                continue
            count = f"{len(services)} services" if services else "no services that it tells of"
            found.append((str(peer), "ok", f"answers; {count}"))
            learnt = [each for each in operator.quirks() if each[0] == peer]
            found += [(str(peer), "note", str(each)) for _, each in learnt]
    return found
