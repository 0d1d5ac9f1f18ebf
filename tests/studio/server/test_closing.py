"""A session ends in order, whatever is under way."""

import asyncio
import threading
from pathlib import Path

from jausml.authoring.editing.project import Project
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.session import Session


def test_what_another_program_wrote_is_taken_over_before_the_end(folder):
    project = Project(folder)
    asyncio.run(asyncio.wait_for(closed_while_busy(Session(StudioContext(project)), folder), 120))
    assert project.log
    assert all(entry.is_outside for entry in project.log)


async def closed_while_busy(session: Session, folder: Path) -> None:
    """Ends a session while changes take long and another one waits for its turn."""
    answering, may_go_on = session._answering, threading.Event()
    turns = answering._changes._work_queue
    async with session.running():
        busy = asyncio.ensure_future(answering.in_turn(lambda: may_go_on.wait(60)))
        file = folder / "catvehicle.xmi"
        text = file.read_text(encoding="utf-8")
        # The watcher may not be there yet: it sees one of several changes.
        while turns.empty():
            file.write_text(f"{text}<!-- {len(text)} -->\n", encoding="utf-8")
            text += "\n"
            await asyncio.sleep(0.2)
        asyncio.get_running_loop().call_later(0.5, may_go_on.set)
    await busy
