"""Files that a user names: as they are, or all of some endings below folders."""

from __future__ import annotations

import os
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.model.inputs import leads_out, open_input
from jausml.language.model.project import find_project_root, walk

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


class InputError(Exception):
    """What a user named cannot be used; the text names it and says why."""


def find_files(paths: Iterable[str], suffixes: tuple[str, ...]) -> list[str]:
    """Returns files as they are, and the files with certain endings below folders.

    Hidden folders and those of builds are left out.

    Raises:
        InputError: A path does not exist or cannot be read, or a folder holds no such file.
    """
    return [file for path in paths for file in files_at(path, suffixes)]


def files_at(path: str, suffixes: tuple[str, ...], hint: str = "") -> Sequence[str]:
    """Returns a file, or the files with certain endings below a folder, sorted.

    Args:
        hint: What stands behind the error of a folder without such a file.

    Raises:
        InputError: As by `find_files`.
    """
    try:
        if os.path.isdir(path):  # noqa: PTH112 - paths stay as the user wrote them
            found = sorted(walk(path, suffixes))
            _refuse_links(path, found)
            if not found:
                raise InputError(f"no {' or '.join(suffixes)} files in {shown(path)}{hint}")
            return found
        with open_input(path):
            return [path]
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        near = _near(path, suffixes) if isinstance(error, FileNotFoundError) else ""
        raise InputError(f"{shown(path)}: {reason}{near}") from error


def shown(path: str | Path) -> str:
    """Returns how messages name a path; bytes that are no UTF-8 are replaced by a sign."""
    return os.fsencode(path).decode("utf-8", "replace")


def _refuse_links(folder: str, found: Sequence[str]) -> None:
    """Refuses files of a walk that are links out of the project: nobody has named them."""
    links = [each for each in found if os.path.islink(each)]  # noqa: PTH114 - as above
    root = Path(os.path.realpath(find_project_root([Path(folder) / "any"]))) if links else None
    for each in links:
        if root is not None and leads_out(each, root):
            raise InputError(
                f"{shown(each)}: JML209 the link leads out of the project root {root}; "
                "name the file itself to have it read"
            )


def _near(path: str, suffixes: tuple[str, ...]) -> str:
    """Returns a question for the file that may be meant, empty where none is near."""
    wanted = Path(path)
    try:
        there = [each.name for each in wanted.parent.iterdir() if each.name.endswith(suffixes)]
    except OSError:
        return ""
    near = get_close_matches(wanted.name, there, n=1)
    return f"; did you mean {shown(wanted.with_name(near[0]))}?" if near else ""
