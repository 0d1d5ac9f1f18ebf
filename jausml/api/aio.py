"""Components for asyncio: what waits can be awaited, reports are iterated over with `async for`."""

from __future__ import annotations

import asyncio
import contextlib
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

from jausml.api.component import MOST_WAITING, Component, Fields, Received

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable


class AsyncSubscription:
    """Reports of an event, to be iterated over with `async for`; ends with `close`.

    Attributes:
        missed: Reports that were thrown away because nobody took them in time, the oldest first.
    """

    def __init__(self) -> None:
        """Begins without an event, in the running event loop."""
        self.missed = 0
        self._loop = asyncio.get_running_loop()
        self._reports: asyncio.Queue[Received | None] = asyncio.Queue()
        self._cancel: Callable[[], None] | None = None

    async def __aenter__(self) -> AsyncSubscription:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def __aiter__(self) -> AsyncIterator[Received]:
        """Yields reports as they come, until the subscription is closed."""
        while (report := await self._reports.get()) is not None:
            yield report

    async def next(self) -> Received:
        """Returns the next report.

        Raises:
            EOFError: The subscription is closed.
        """
        report = await self._reports.get()
        if report is None:
            raise EOFError("the subscription is closed")
        return report

    async def close(self) -> None:
        """Cancels the event."""
        if self._cancel is not None:
            cancel, self._cancel = self._cancel, None
            await asyncio.to_thread(cancel)
        self._put(None)

    def take(self, report: Received) -> None:
        """Takes a report, on any thread."""
        # A loop that is closed has nobody left who would take it.
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._put, report)

    def begin(self, cancel: Callable[[], None]) -> None:
        """Takes what cancels the event at the end."""
        self._cancel = cancel

    def _put(self, report: Received | None) -> None:
        if self._reports.qsize() >= MOST_WAITING:
            self._reports.get_nowait()
            self.missed += 1
        self._reports.put_nowait(report)


class AsyncComponent:
    """A `Component` whose calls can be awaited; use it in an `async with` block."""

    def __init__(self, address: str | None = None, **options: Any) -> None:
        """Describes a component.

        Args:
            address: JAUS id, subsystem.node.component; None for a free one of 65000.
            options: Those of `Component`.

        Raises:
            ValueError: An address means nothing.
            MessageError: A model cannot be read, or there is no such service.
        """
        self._inner = Component(address, **options)

    async def __aenter__(self) -> AsyncComponent:
        await asyncio.to_thread(self._inner.start)
        return self

    async def __aexit__(self, *_: object) -> None:
        await asyncio.to_thread(self._inner.stop)

    @property
    def address(self) -> str:
        """Its JAUS id."""
        return self._inner.address

    async def query(self, target: str, name: str, fields: Fields | None = None) -> Fields:
        """Asks for a report, as `Component.query`."""
        return await asyncio.to_thread(self._inner.query, target, name, fields)

    async def subscribe(
        self, target: str, name: str, rate: float | None = None
    ) -> AsyncSubscription:
        """Subscribes to a report, as `Component.subscribe`."""
        subscription = AsyncSubscription()
        watch = self._inner.watch
        subscription.begin(await asyncio.to_thread(watch, target, name, rate, subscription.take))
        return subscription

    async def discover(self, duration: float = 2.0) -> dict[str, tuple[str, ...]]:
        """Returns the services of each component, as `Component.discover`."""
        return await asyncio.to_thread(self._inner.discover, duration)

    @asynccontextmanager
    async def control(
        self, target: str, *, authority: int = 127, resume: bool = True
    ) -> AsyncIterator[AsyncComponent]:
        """Controls a component as long as the block, as `Component.control`."""
        held = self._inner.control(target, authority=authority, resume=resume)
        await asyncio.to_thread(held.__enter__)
        try:
            yield self
        finally:
            await asyncio.to_thread(held.__exit__, None, None, None)

    async def command(self, target: str, name: str, fields: Fields | None = None) -> None:
        """Sends a message once, as `Component.command`."""
        await asyncio.to_thread(self._inner.command, target, name, fields)

    def answer(self, name: str, give: Callable[[], Fields | None]) -> Callable[[], None]:
        """Answers a query, as `Component.answer`; `give` is called on a thread of the component."""
        return self._inner.answer(name, give)

    def obey(self, name: str, take: Callable[[Received], None]) -> None:
        """Has a function take a message, as `Component.obey`, in the running event loop."""
        loop = asyncio.get_running_loop()
        self._inner.obey(name, lambda received: _soon(loop, take, received))


def _soon(
    loop: asyncio.AbstractEventLoop, take: Callable[[Received], None], received: Received
) -> None:
    loop.call_soon_threadsafe(take, received)
