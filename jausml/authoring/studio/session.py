"""A session: a project, the pages that look at it, and what happens meanwhile."""

from __future__ import annotations

import asyncio
import logging
import threading
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from jausml.authoring.studio import watching
from jausml.authoring.studio.answers.palette import library_entries
from jausml.authoring.studio.asking import answering, editing, generating, mapping, reading, showing
from jausml.authoring.studio.asking.living import Living
from jausml.authoring.studio.checking import Checking
from jausml.authoring.studio.methods import Answering
from jausml.language.metamodel import load_metamodels

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from contextlib import AbstractContextManager
    from pathlib import Path

    from jausml.authoring.studio.checking import Verdict
    from jausml.authoring.studio.desk import Desk
    from jausml.authoring.studio.rpc import Request

_MODULES = (showing, editing, answering, reading, mapping, generating)
_LOG = logging.getLogger(__name__)


class Session:
    """Answers pages, and tells them what happens."""

    def __init__(self, desk: Desk) -> None:
        load_metamodels()  # now, for threads that ask at once would load them twice
        self._desk = desk
        self._living = Living(desk)
        desk.audience.left = self._living.leave
        methods = {name: each for module in _MODULES for name, each in module.methods(desk).items()}
        self._answering = Answering({**methods, **self._living.methods()})
        self._checking = Checking(desk.verdicts, lambda: desk.looked_at.files, self._judged)
        desk.followers.extend((self._checking.begin, self._living.changed))

    @property
    def root(self) -> Path:
        """The folder that was opened, symbolic links followed."""
        return self._desk.project.root

    @property
    def revision(self) -> int:
        """The revision of the project now."""
        return self._desk.project.revision

    def told(self, listener: Callable[[str], None]) -> AbstractContextManager[None]:
        """Tells a listener what happens as long as the context lasts; see `Audience`."""
        return self._desk.audience.told(listener)

    async def answer(self, request: Request) -> object:
        """Returns the result of a request."""
        return await self._answering.answer(request)

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Looks after the project as long as the context lasts."""
        end = asyncio.Event()
        watched = asyncio.create_task(self._watch(end))
        self._checking.start()
        # Reading the library takes seconds on a busy computer: better before somebody asks for it.
        threading.Thread(target=library_entries, name="library", daemon=True).start()
        try:
            with self._desk.faults.kept():
                yield
        finally:
            end.set()
            self._checking.close()
            await watched  # it may wait for its turn among the changes
            self._answering.close()
            await asyncio.to_thread(self._living.stop)
            await asyncio.to_thread(self._desk.trials.close)

    async def _watch(self, end: asyncio.Event) -> None:
        try:
            async for files in watching.changes(self._desk.project.root, end):
                await self._answering.in_turn(self._desk.refresh, files)
        except OSError:
            _LOG.exception("changes by other programs are not seen any more")

    def _judged(self, verdict: Verdict) -> None:
        self._desk.audience.tell("problems", showing.problems(self._desk, verdict))
