"""Components for asyncio: what waits can be awaited, reports are iterated over with `async for`."""

from __future__ import annotations

import asyncio
import contextlib
from contextlib import asynccontextmanager
from inspect import iscoroutinefunction
from typing import TYPE_CHECKING, Any

from jausml.live.api.component import Component
from jausml.live.api.messages import MOST_WAITING

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Generator

    from jausml.live.api.component import ComponentStatus
    from jausml.live.api.messages import Fields, Received


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
        """Returns the next report."""
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


class Subscribing:
    """A subscription under way: `await` it, or use it in an `async with` block at once."""

    def __init__(self, begin: Callable[[], Awaitable[AsyncSubscription]]) -> None:
        """Begins nothing yet."""
        self._begin = begin
        self._made: AsyncSubscription | None = None

    def __await__(self) -> Generator[Any, None, AsyncSubscription]:
        return self._begin().__await__()

    async def __aenter__(self) -> AsyncSubscription:
        self._made = await self
        return self._made

    async def __aexit__(self, *_: object) -> None:
        if self._made is not None:
            await self._made.close()


class AsyncComponent:
    """A `Component` whose calls can be awaited.

    Use it in an `async with` block, or `start` and `stop` it.
    """

    def __init__(self, address: str | None = None, **options: Any) -> None:
        """Describes a component.

        Args:
            address: JAUS id, subsystem.node.component; None for a free one of 65000.

        Raises:
            MessageError: A model cannot be read, or there is no such service.
        """
        self._inner = Component(address, **options)
        self._tasks: set[asyncio.Future[None]] = set()

    def __repr__(self) -> str:
        return repr(self._inner).replace("<", "<Async", 1)

    async def __aenter__(self) -> AsyncComponent:
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.stop()

    async def start(self) -> None:
        """Opens the network and begins to answer, as `Component.start`."""
        await asyncio.to_thread(self._inner.start)

    async def stop(self) -> None:
        """Releases control, cancels events and closes the network, as `Component.stop`."""
        await asyncio.to_thread(self._inner.stop)

    @property
    def address(self) -> str:
        """Its JAUS id."""
        return self._inner.address

    async def query(
        self,
        target: str,
        name: str | int,
        fields: Fields | None = None,
        timeout: float | None = None,
    ) -> Fields:
        """Asks for a report, as `Component.query`."""
        return await asyncio.to_thread(self._inner.query, target, name, fields, timeout)

    def subscribe(self, target: str, name: str | int, rate: float | None = None) -> Subscribing:
        """Subscribes to a report, as `Component.subscribe`, when it is awaited or entered."""

        async def begin() -> AsyncSubscription:
            made, watch = AsyncSubscription(), self._inner.watch
            made.begin(await asyncio.to_thread(watch, target, name, rate, made.take))
            return made

        return Subscribing(begin)

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

    async def request(
        self,
        target: str,
        name: str | int,
        fields: Fields | None = None,
        timeout: float | None = None,
    ) -> Received:
        """Sends a command and returns what came back, as `Component.request`."""
        return await asyncio.to_thread(self._inner.request, target, name, fields, timeout)

    async def status(self, target: str) -> ComponentStatus:
        """Returns the state of a component, as `Component.status`."""
        return await asyncio.to_thread(self._inner.status, target)

    async def emergency(self, target: str) -> ComponentStatus:
        """Stops a component, as `Component.emergency`."""
        return await asyncio.to_thread(self._inner.emergency, target)

    async def clear(self, target: str) -> ComponentStatus:
        """Ends our emergency, as `Component.clear`."""
        return await asyncio.to_thread(self._inner.clear, target)

    async def command(self, target: str, name: str | int, fields: Fields | None = None) -> None:
        """Sends a message once, as `Component.command`."""
        await asyncio.to_thread(self._inner.command, target, name, fields)

    def answer(self, name: str | int, give: Callable[[], Fields | None]) -> Callable[[], None]:
        """Answers a query, as `Component.answer`; `give` is called on a thread of the component."""
        return self._inner.answer(name, give)

    def obey(
        self,
        name: str | int,
        take: Callable[[Received], None] | Callable[[Received], Awaitable[None]],
    ) -> None:
        """Has a function, async or not, take a message in the running event loop.

        See `Component.obey`.
        """
        loop = asyncio.get_running_loop()

        def soon(received: Received) -> None:
            # A loop that is closed has nobody left who would take it.
            with contextlib.suppress(RuntimeError):
                loop.call_soon_threadsafe(self._call, take, received)

        self._inner.obey(name, soon if callable(take) else take)

    def _call(self, take: Callable[[Received], Any], received: Received) -> None:
        """Calls what takes a message; a task is kept until it is over."""
        if iscoroutinefunction(take):
            task = asyncio.ensure_future(take(received))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        else:
            take(received)
