"""Generated workspaces in tests: where Python finds their packages."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def packages_of(workspace: Path) -> list[str]:
    """Returns the folders of the packages, for the module path."""
    return [str(path) for path in sorted(workspace.iterdir()) if (path / path.name).is_dir()]


def python_path(workspace: Path) -> str:
    """Returns the value of PYTHONPATH with all packages of a workspace."""
    return os.pathsep.join(packages_of(workspace))
