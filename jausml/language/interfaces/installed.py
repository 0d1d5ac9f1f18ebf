"""Installed packages: where their definitions lie."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.interfaces.definitions import is_package_name
from jausml.language.interfaces.parsing import PARTS

if TYPE_CHECKING:
    from collections.abc import Iterable


class Installation:
    """The share folders of installed ROS packages.

    They are those of the prefixes in the environment variable AMENT_PREFIX_PATH, in its order,
    then that of the running Python.
    """

    def __init__(self, shares: Iterable[str | os.PathLike[str]] = ()) -> None:
        prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
        found = [Path(each) for each in shares]
        found += [Path(each, "share") for each in (*filter(None, prefixes), sys.prefix)]
        self.shares = list(dict.fromkeys(found))

    def folder(self, package: str) -> Path | None:
        """Returns the share folder of a package that defines interfaces, None without one."""
        if not is_package_name(package):
            return None
        for share in self.shares:
            folder = share / package
            # Unlike Path.is_dir this is False where nothing may be looked at.
            if any(os.path.isdir(folder / kind) for kind in PARTS):  # noqa: PTH112
                return folder
        return None

    def packages(self) -> list[str]:
        """Returns the names of the installed packages that define interfaces, sorted."""
        found: set[str] = set()
        for share in self.shares:
            for kind in PARTS:
                found.update(path.parent.name for path in share.glob(f"*/{kind}"))
        return sorted(found)


def definition_files(folder: Path) -> list[Path]:
    """Returns the definition files of a package, by kind and name."""
    return [path for kind in PARTS for path in sorted((folder / kind).glob(f"*.{kind}"))]
