"""Watching: model files that other programs change, create or delete."""

from __future__ import annotations

import os
from pathlib import PurePath
from typing import TYPE_CHECKING

from watchfiles import awatch

from jausml.authoring.editing.reading import SUFFIXES

if TYPE_CHECKING:
    import asyncio
    from collections.abc import AsyncIterator
    from pathlib import Path

    from watchfiles import Change

DEBOUNCE_MS, STEP_MS = 50, 10
"""Milliseconds: what changes within them is told at once; how long it must have been quiet."""

LAYOUT_SUFFIX = ".layout.json"


async def changes(root: Path, end: asyncio.Event) -> AsyncIterator[list[str]]:
    """Yields model files that have changed, relative to a folder with forward slashes."""

    def is_model(_: Change, path: str) -> bool:
        parts = PurePath(os.path.relpath(path, root)).parts
        is_hidden = any(part.startswith(".") for part in parts)
        return not is_hidden and path.endswith((*SUFFIXES, LAYOUT_SUFFIX))

    watching = awatch(
        root,
        watch_filter=is_model,
        debounce=DEBOUNCE_MS,
        step=STEP_MS,
        stop_event=end,
        ignore_permission_denied=True,
    )
    async for found in watching:
        yield sorted({os.path.relpath(each, root).replace(os.sep, "/") for _, each in found})
