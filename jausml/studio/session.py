"""A session: a project, the pages that look at it, and what happens meanwhile."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from jausml.studio.asking import showing
from jausml.studio.asking.living import Living
from jausml.studio.checking import Checking
from jausml.studio.methods import Answering

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from contextlib import AbstractContextManager

    from jausml.studio.checking import Verdict
    from jausml.studio.desk import Desk
    from jausml.studio.rpc import Request


class Session:
    """Answers pages, and tells them what happens.

    Args:
        desk: What it works with.
    """

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._living = Living(desk)
        desk.audience.left = self._living.leave
        self._answering = Answering({**showing.methods(desk), **self._living.methods()})
        self._checking = Checking(desk.verdicts, lambda: desk.shown.files, self._tell)

    def told(self, listener: Callable[[str], None]) -> AbstractContextManager[None]:
        """Tells a listener what happens as long as the context lasts; see `Audience`."""
        return self._desk.audience.told(listener)

    async def answer(self, request: Request) -> object:
        """Returns the result of a request.

        Raises:
            RpcError: There is none, and why.
        """
        return await self._answering.answer(request)

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Looks after the project as long as the context lasts."""
        self._checking.start()
        try:
            yield
        finally:
            self._living.stop()
            self._checking.close()
            self._answering.close()

    def _tell(self, verdict: Verdict) -> None:
        self._desk.audience.tell("problems", showing.problems(self._desk, verdict))
