"""Checks that the message packages of processes are built or installed."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from importlib.machinery import PathFinder
from pathlib import Path

from jausml.cli.live.processes import ProcessEntry
from jausml.cli.shared.files import EnvironmentFault

_INTERFACES = ("msg", "srv", "action")
_MESSAGE_SUFFIX = "_msgs"


def require_packages(entries: Sequence[ProcessEntry], folder: Path, python_path: str) -> None:
    """Refuses to start processes whose messages nobody has built or installed."""
    path = [*filter(None, python_path.split(os.pathsep)), *sys.path]
    for entry in entries:
        for name in _dependencies(folder / entry.package / "package.xml"):
            is_own = any((folder / name / kind).is_dir() for kind in _INTERFACES)
            # Without an __init__ it is the folder of definitions beside us, or nothing at all.
            spec = PathFinder.find_spec(name, path)
            if (is_own or name.endswith(_MESSAGE_SUFFIX)) and (spec is None or spec.origin is None):
                raise EnvironmentFault(
                    f"{entry.name} needs {name}, {_remedy(name, folder, is_own)}"
                )


def _remedy(name: str, folder: Path, is_own: bool) -> str:
    from jausml.language.model.library import has_package
    from jausml.live.machine import package_cure

    if not (is_own or has_package(name)):
        return (
            "which Python does not find: it is a package of yours, or was imported: run"
            f" `colcon build` where the sources of {name} are, source install/setup.bash,"
            " then run this again"
        )
    if not is_own:
        return (
            "which Python does not find: source a ROS 2 installation that has it, or"
            f" {package_cure(name)}"
        )
    root = folder.parent if folder.name == "src" else folder
    return (
        "whose messages are not built yet: in a shell with ROS 2, run `colcon build` in"
        f" {root} and source install/setup.bash, then run this again"
    )


def _dependencies(file: Path) -> Iterator[str]:
    """Yields the names of packages that a package.xml says its package needs to run."""
    from lxml import etree

    if not file.is_file():
        return
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    try:
        root = etree.parse(file, parser).getroot()
    except etree.XMLSyntaxError:
        return
    for element in root.iter("depend", "exec_depend"):
        if element.text:
            yield element.text.strip()
