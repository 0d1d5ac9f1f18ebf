"""ROS packages that processes of a workspace need, and whether Python finds them."""

from __future__ import annotations

import os
import sys
from importlib.machinery import PathFinder
from typing import TYPE_CHECKING, Any

from jausml.cli.common import EnvironmentFault

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

_INTERFACES = ("msg", "srv", "action")
_MESSAGES = "_msgs"


def require_packages(entries: Sequence[Mapping[str, Any]], folder: Path, python_path: str) -> None:
    """Refuses to start processes whose messages nobody has built or installed."""
    path = [*filter(None, python_path.split(os.pathsep)), *sys.path]
    for entry in entries:
        for name in _needed(folder / str(entry.get("package", "")) / "package.xml"):
            is_own = any((folder / name / kind).is_dir() for kind in _INTERFACES)
            # Without an __init__ it is the folder of definitions beside us, or nothing at all.
            found = PathFinder.find_spec(name, path)
            if (is_own or name.endswith(_MESSAGES)) and (found is None or found.origin is None):
                raise EnvironmentFault(
                    f"{entry['name']} needs {name}, {_cure(name, folder, is_own)}"
                )


def _cure(name: str, folder: Path, is_own: bool) -> str:
    if not is_own:
        debian = name.replace("_", "-")
        return (
            "which Python does not find: source a ROS 2 installation that has it"
            f" (apt install ros-jazzy-{debian}), or pip install ros-jazzy-{debian}"
        )
    root = folder.parent if folder.name == "src" else folder
    return (
        "whose messages are not built yet: in a shell with ROS 2, run `colcon build` in"
        f" {root} and source install/setup.bash, then run this again"
    )


def _needed(file: Path) -> Iterator[str]:
    """Yields the names of packages that a package.xml says its package needs to run."""
    from lxml import etree

    if not file.is_file():
        return
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    try:
        root = etree.parse(file, parser).getroot()
    except etree.XMLSyntaxError:
        return
    for each in root.iter("depend", "exec_depend"):
        if each.text:
            yield each.text.strip()
