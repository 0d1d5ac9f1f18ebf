"""The code of a generated workspace in this process, where a virtual world can hold it."""

from __future__ import annotations

import importlib
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from types import ModuleType

SHARED = frozenset({"catvehicle", "jausml_runtime"})
"""Packages that all workspaces have alike; one copy of them serves all."""


@dataclass(frozen=True)
class Workspace:
    """The packages of a workspace, to be imported by name.

    Packages of two workspaces may have the same names. Each workspace gets modules of its own, but
    for those that all share.

    Attributes:
        folder: Where it was generated.
        modules: What was imported of it, by full name.
    """

    folder: Path
    modules: dict[str, ModuleType]

    @classmethod
    def at(cls, folder: Path) -> Workspace:
        """Returns the workspace of a folder; nothing is imported yet."""
        return cls(folder, {})

    def module(self, name: str) -> Any:
        """Returns a module of the workspace.

        Args:
            name: Its full name, e.g. `vehicle.vehicle`.

        Raises:
            ImportError: There is none.
        """
        with self._on_path():
            return importlib.import_module(name)

    @contextmanager
    def _on_path(self) -> Iterator[None]:
        """Makes the packages importable, then takes them out of what others import."""
        names = {path.name for path in self.folder.iterdir() if (path / path.name).is_dir()}
        former, former_path = dict(sys.modules), list(sys.path)
        own = names - SHARED
        for name in [module for module in sys.modules if module.partition(".")[0] in own]:
            del sys.modules[name]
        sys.modules.update(self.modules)
        # Of a link, what it leads to: what all share is still imported when this folder is gone.
        sys.path[:0] = [str((self.folder / name).resolve()) for name in sorted(names)]
        try:
            yield
        finally:
            sys.path[:] = former_path
            for name in [module for module in sys.modules if module.partition(".")[0] in own]:
                self.modules[name] = sys.modules.pop(name)
            sys.modules.update(
                {
                    name: module_type
                    for name, module_type in former.items()
                    if name.partition(".")[0] in own
                }
            )
