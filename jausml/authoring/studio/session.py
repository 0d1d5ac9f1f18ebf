"""A session: answers pages, watches files of the project, and tells pages what happens."""

from __future__ import annotations

import asyncio
import logging
import os
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

from watchfiles import Change, awatch

from jausml.authoring.editing.layout import SUFFIXES
from jausml.authoring.studio.checking import Checking, Verdict, prepare
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.handlers import (
    editing,
    generating,
    modelling,
    partitioning,
    recordings,
    showing,
    stepping,
)
from jausml.authoring.studio.handlers.showing import LiveRequests
from jausml.authoring.studio.rpc import refusal_of
from jausml.language.metamodel import load_metamodels
from jausml.language.model.project import is_model_file
from jausml.live.serving.rpc import Answering, Method
from jausml.live.serving.sockets import PACE

_MODULES = (showing, editing, generating, modelling, partitioning, stepping, recordings)
_LOG = logging.getLogger(__name__)

DEBOUNCE_MS, STEP_MS = 50, 10
"""Milliseconds: what changes within them is told at once; how long it must have been quiet."""


def methods_of(context: StudioContext) -> dict[str, Method]:
    """Returns the functions that answer requests about a project, by the names of the requests."""
    methods = {
        name: Method(partial(answer, context))
        for module in _MODULES
        for name, answer in module.METHODS.items()
    }
    changes = {**editing.CHANGES, **generating.CHANGES}.items()
    return methods | {name: Method(partial(do, context), in_turn=True) for name, do in changes}


class Session:
    """Session of pages: answers to their requests, and events for them."""

    urgent = ()
    pace = PACE

    def __init__(self, context: StudioContext) -> None:
        """Begins a session."""
        load_metamodels()  # now, for threads that ask at once would load them twice
        self._context = context
        live = self._live = LiveRequests(context)
        context.subscribers.left = live.leave
        methods = methods_of(context) | {
            "live.start": Method(live.start),
            "live.stop": Method(live.stop),
            "live.message": Method(live.message),
        }
        self._answering = Answering(methods, refusal_of)
        self.answer, self.subscribed = self._answering.answer, context.subscribers.subscribed
        self._checking = Checking(
            context.verdicts, lambda: context.viewed_files.files, self._judged
        )
        context.followers.extend((self._checking.begin, self._live.changed))

    @property
    def root(self) -> Path:
        """The folder that was opened, symbolic links followed."""
        return self._context.project.root

    @property
    def revision(self) -> int:
        """The revision of the project now."""
        return self._context.project.revision

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Looks after the project as long as the context lasts."""
        end = asyncio.Event()
        watched = asyncio.create_task(self._watch(end))
        self._checking.start()
        threading.Thread(target=prepare, name="library", daemon=True).start()
        try:
            with self._context.faults.kept():
                yield
        finally:
            end.set()
            self._checking.close()
            await watched  # it may wait for its turn among the changes
            self._answering.close()
            await asyncio.to_thread(self._live.stop)
            await asyncio.to_thread(self._context.recordings.close)
            await asyncio.to_thread(self._context.trials.close)

    async def _watch(self, end: asyncio.Event) -> None:
        try:
            async for files in changes(self._context.project.root, end):
                await self._answering.in_turn(partial(self._context.refresh, files))
        except OSError:
            _LOG.exception("changes by other programs are not seen any more")

    def _judged(self, verdict: Verdict) -> None:
        self._context.subscribers.notify("problems", showing.problems(self._context, verdict))


async def changes(root: Path, end: asyncio.Event) -> AsyncIterator[list[str]]:
    """Yields model files that have changed, relative to a folder with forward slashes."""

    def is_model(_: Change, path: str) -> bool:
        file = os.path.relpath(path, root).replace(os.sep, "/")
        return is_model_file(file, root, SUFFIXES)

    watching = awatch(
        root,
        watch_filter=is_model,
        debounce=DEBOUNCE_MS,
        step=STEP_MS,
        stop_event=end,
        ignore_permission_denied=True,
    )
    async for file_changes in watching:
        yield sorted({os.path.relpath(path, root).replace(os.sep, "/") for _, path in file_changes})
