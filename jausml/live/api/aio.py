"""Components for asyncio: what waits can be awaited, reports are iterated over with `async for`."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Generator
from contextlib import asynccontextmanager
from functools import partial, wraps
from inspect import iscoroutinefunction
from typing import Any, Concatenate, ParamSpec, TypeVar
from weakref import WeakSet

from jausml.live.api.component import Component
from jausml.live.api.messages import MOST_WAITING, Fields, Received

P = ParamSpec("P")
R = TypeVar("R")


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
        while (report := await self._get()) is not None:
            yield report

    async def next(self) -> Received:
        """Returns the next report."""
        report = await self._get()
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
        """Keeps the function that cancels the event at the end."""
        self._cancel = cancel

    async def _get(self) -> Received | None:
        report = await self._reports.get()
        if report is None:
            self._put(None)  # for whoever asks next
        return report

    def _put(self, report: Received | None) -> None:
        if self._reports.qsize() >= MOST_WAITING:
            self._reports.get_nowait()
            self.missed += 1
        self._reports.put_nowait(report)


class Subscribing:
    """A subscription under way: `await` it, or use it in an `async with` block at once."""

    def __init__(self, begin: Callable[[], Awaitable[AsyncSubscription]]) -> None:
        self._begin = begin
        self._subscription: AsyncSubscription | None = None

    def __await__(self) -> Generator[Any, None, AsyncSubscription]:
        return self._begin().__await__()

    async def __aenter__(self) -> AsyncSubscription:
        self._subscription = await self
        return self._subscription

    async def __aexit__(self, *_: object) -> None:
        if self._subscription is not None:
            await self._subscription.close()


def _in_thread(
    method: Callable[Concatenate[Component, P], R],
) -> Callable[Concatenate[AsyncComponent, P], Coroutine[Any, Any, R]]:
    """Returns a method of `Component` as one that can be awaited."""

    @wraps(method)
    async def call(self: AsyncComponent, /, *args: P.args, **kwargs: P.kwargs) -> R:
        return await asyncio.to_thread(method, self._inner, *args, **kwargs)

    return call


async def _given_back(getting: Awaitable[R], undo: Callable[[R], object]) -> None:
    # Who was refused has nothing to give back, and nobody is left who would be told.
    with contextlib.suppress(Exception):
        await asyncio.to_thread(undo, await getting)


class AsyncComponent:
    """A `Component` whose calls can be awaited.

    Use it in an `async with` block, or `start` and `stop` it.
    """

    def __init__(self, address: str | None = None, **options: Any) -> None:
        """Describes a component as `Component` does."""
        self._inner = Component(address, **options)
        self._tasks: set[asyncio.Future[None]] = set()
        self._subscriptions: WeakSet[AsyncSubscription] = WeakSet()

    def __repr__(self) -> str:
        return repr(self._inner).replace("<", "<Async", 1)

    async def __aenter__(self) -> AsyncComponent:
        await self._had(self._inner.start, lambda _: self._inner.stop())
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.stop()

    start = _in_thread(Component.start)
    query = _in_thread(Component.query)
    discover = _in_thread(Component.discover)
    request = _in_thread(Component.request)
    status = _in_thread(Component.status)
    emergency = _in_thread(Component.emergency)
    clear = _in_thread(Component.clear)
    command = _in_thread(Component.command)

    async def stop(self) -> None:
        """Stops, as `Component.stop`."""
        for subscription in list(self._subscriptions):
            await subscription.close()
        await asyncio.to_thread(self._inner.stop)

    @property
    def address(self) -> str:
        """Its JAUS id."""
        return self._inner.address

    def subscribe(self, target: str, name: str | int, rate: float | None = None) -> Subscribing:
        """Subscribes to a report, as `Component.subscribe`, when it is awaited or entered."""

        async def begin() -> AsyncSubscription:
            subscription = AsyncSubscription()
            watch = partial(self._inner.watch, target, name, rate, subscription.take)
            subscription.begin(await self._had(watch, lambda cancel: cancel()))
            self._subscriptions.add(subscription)
            return subscription

        return Subscribing(begin)

    @asynccontextmanager
    async def control(
        self, target: str, *, authority: int = 127, resume: bool = True
    ) -> AsyncIterator[AsyncComponent]:
        """Controls a component as long as the block, as `Component.control`."""
        held = self._inner.control(target, authority=authority, resume=resume)
        release = partial(held.__exit__, None, None, None)
        await self._had(held.__enter__, lambda _: release())
        try:
            yield self
        finally:
            await asyncio.to_thread(release)

    async def _had(self, work: Callable[[], R], undo: Callable[[R], object]) -> R:
        """Returns the result of a thread, which is undone if the caller is cancelled meanwhile.

        Args:
            undo: Gives it back, on a thread.
        """
        getting = asyncio.ensure_future(asyncio.to_thread(work))
        try:
            return await asyncio.shield(getting)
        except asyncio.CancelledError:
            # The thread goes on, and is waited for, unless one is cancelled once more.
            giving_back = asyncio.ensure_future(_given_back(getting, undo))
            self._tasks.add(giving_back)
            giving_back.add_done_callback(self._tasks.discard)
            await asyncio.shield(giving_back)
            raise

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
        """Calls a handler of messages; a task is kept until it is over."""
        if iscoroutinefunction(take):
            task = asyncio.ensure_future(take(received))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        else:
            take(received)
