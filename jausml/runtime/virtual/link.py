"""Links: what a way does to what passes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

    from ..base.loop import Loop, Timer

LONGEST_HOLD = 1.0
"""Seconds that something waits at most to be overtaken, where nothing follows."""


@dataclass(frozen=True)
class Link:
    """What a way does to what passes it, in one direction.

    Attributes:
        delay: Seconds that everything takes.
        jitter: Seconds up to which something takes longer, each length as likely as any other.
            What comes later may overtake; without jitter the order stays.
        exponential: Mean in seconds of a further delay, which is mostly short and seldom long.
        loss: Part that gets lost, 0 to 1.
        burst: Mean number in a row of those that get lost (Gilbert and Elliott); at 0 each gets
            lost or not whatever became of the one before.
        duplicate: Part that arrives twice, 0 to 1.
        reorder: Part that the next one overtakes, 0 to 1; where nothing follows it goes on after
            a second.

    Raises:
        ValueError: A value is out of its range, or losses cannot be so many in so short bursts.
    """

    delay: float = 0.0
    jitter: float = 0.0
    exponential: float = 0.0
    loss: float = 0.0
    burst: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what no way can do."""
        for name in ("delay", "jitter", "exponential"):
            if not 0 <= getattr(self, name) < float("inf"):
                raise ValueError(f"{name} is {getattr(self, name)}; it must be 0 s or more")
        for name in ("loss", "duplicate", "reorder"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} is {getattr(self, name)}; it must lie in 0..1")
        if self.burst and not self.burst >= 1:
            raise ValueError(f"burst is {self.burst}; it is a number of packets, at least 1")
        if self.burst and self.loss < 1 and self.loss > self.burst * (1 - self.loss):
            least = self.loss / (1 - self.loss)
            raise ValueError(f"a loss of {self.loss:g} takes bursts of at least {least:.3g}")

    @property
    def is_plain(self) -> bool:
        """Whether all passes at once."""
        return self == _PLAIN


_PLAIN = Link()


class Way:
    """A link in use: what is lost by now, and what is held.

    Attributes:
        link: What it does; another one counts for what comes from then on.
    """

    def __init__(self, loop: Loop, random: Random, link: Link) -> None:
        """Begin to let pass.

        Args:
            random: Decides what happens, in the order in which it happens.
        """
        self.link = link
        self.is_cut = False
        self._loop = loop
        self._random = random
        self._is_losing = False
        self._held: list[Callable[[], None]] = []
        self._hold: Timer | None = None

    def carry(self, arrive: Callable[[], None]) -> bool:
        """Let something pass, in a later turn of the loop.

        Args:
            arrive: Run at the other end, once for each copy.

        Returns:
            Whether it gets there.
        """
        link = self.link
        if self.is_cut or (link.loss and self._loses(link)):
            return False
        copies = 2 if link.duplicate and self._random.random() < link.duplicate else 1
        for _ in range(copies):
            if link.reorder and self._random.random() < link.reorder:
                self._keep(arrive)
            else:
                self._pass(arrive, link)
        return True

    def _loses(self, link: Link) -> bool:
        drawn = self._random.random()
        if not link.burst or link.loss == 1:
            return drawn < link.loss
        if self._is_losing:
            self._is_losing = drawn >= 1 / link.burst
        else:
            self._is_losing = drawn < link.loss / (1 - link.loss) / link.burst
        return self._is_losing

    def _pass(self, arrive: Callable[[], None], link: Link) -> None:
        self._send(arrive, link)
        self._release()

    def _send(self, arrive: Callable[[], None], link: Link) -> None:
        delay = link.delay
        if link.jitter:
            delay += self._random.uniform(0.0, link.jitter)
        if link.exponential:
            delay += self._random.expovariate(1 / link.exponential)
        if delay:
            self._loop.call_later(delay, arrive)
        else:
            self._loop.call_soon(arrive)

    def _keep(self, arrive: Callable[[], None]) -> None:
        self._held.append(arrive)
        if self._hold is None:
            self._hold = self._loop.call_later(LONGEST_HOLD, self._release)

    def _release(self) -> None:
        """Let what was overtaken follow."""
        if self._hold is not None:
            self._hold.cancel()
            self._hold = None
        held, self._held = self._held, []
        for arrive in held:
            self._send(arrive, self.link)
