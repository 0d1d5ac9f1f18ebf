"""What both ends say they exchanged, against what the network did."""

import time
from collections.abc import Mapping
from typing import Any, NamedTuple

from tests.live.bridge_support import wait_for

from .networks import ADDRESSES, Udp
from .rover_system import System

PAIRS = {
    f"{ADDRESSES[sender]} to {ADDRESSES[receiver]}": (sender, receiver)
    for peer in ("vehicle", "operator")
    for sender, receiver in ((peer, "bridge"), ("bridge", peer))
}
"""Who sends to whom by way of the network."""

UNDER_WAY = 0.2
"""Seconds after which what was under way has come."""


class Books(NamedTuple):
    """What is known while nothing passes, by pair.

    Attributes:
        accounts: What receivers say.
        truths: What the network says.
        starts: How often each role was started.
        connections: What the connections of the bridge say of their messages.
    """

    accounts: Mapping[str, dict[str, Any]]
    truths: Mapping[str, dict[str, int]]
    starts: Mapping[str, int]
    connections: Mapping[str, Mapping[str, int]]


def books(system: System) -> Books | None:
    """Lets nothing pass for a moment, and returns what all say then; None if nobody can know."""
    if not isinstance(system.network, Udp):
        return None
    system.network.fare(drop=1.0)
    closed = time.monotonic()

    def latest() -> dict[str, dict[str, Any]] | None:
        told = {account["pair"]: account for account in system.accounts()}
        is_known = all(told.get(pair, {"at": 0.0})["at"] > closed + UNDER_WAY for pair in PAIRS)
        return told if is_known else None

    accounts = wait_for(latest, "accounts of all")
    truths = system.network.truths()
    system.network.fare()
    connections = {name: fact["counts"] for name, fact in system.connections().items()}
    return Books(accounts, truths, system.starts(), connections)


def adds_up(before: Books, after: Books, unread: str = "") -> dict[str, dict[str, int]]:
    """Sees to it that what was sent came or was counted as lost, exactly, since a time.

    What came to a connection of the bridge was passed, thinned or dropped by name.

    A receiver that was started meanwhile has a new account, and is left out. Of a sender that was
    started meanwhile the first number may be near the last one by chance, which nobody can tell
    from a loss; it is left out then.

    Args:
        before: What was known at that time.
        after: What is known now.
        unread: A role that was halted, and threw away what it had not read: that is lost to it.

    Returns:
        What came and was lost, by pair.
    """
    assert after.connections
    for name, counts in after.connections.items():
        dropped = sum(count for key, count in counts.items() if key.startswith("dropped: "))
        ended = counts["messages passed"] + counts.get("thinned", 0) + dropped
        assert counts["messages taken"] == ended, f"{name}: {counts}"
    started = {role for role, starts in after.starts.items() if starts > before.starts[role]}
    found = {}
    for pair, (sender, receiver) in PAIRS.items():
        told, truth = after.accounts[pair], after.truths[pair]
        former, former_truth = before.accounts[pair], before.truths[pair]
        is_anew = (
            told["began anew"] > former["began anew"] and truth["lives"] > former_truth["lives"]
        )
        if receiver in started or (sender in started and not is_anew):
            continue
        lost = "lost on the way, at most"
        seen = {"came": told["came"] - former["came"], "lost": told[lost] - former[lost]}
        real = {figure: truth[figure] - former_truth[figure] for figure in seen}
        if receiver == unread:
            thrown = real["came"] - seen["came"]
            assert thrown >= 0, f"{pair}: {seen} came of {real}"
            real = {"came": seen["came"], "lost": real["lost"] + thrown}
        assert seen == real, f"{pair}: the receiver says {seen}, the network did {real}"
        found[pair] = seen
    return found
