"""The processes of a generated workspace, as its manifest lists them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from jausml.cli.shared.files import EnvironmentFault

_MODULE = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)


@dataclass(frozen=True)
class ProcessEntry:
    """A process of a workspace.

    Attributes:
        kind: `bridge`, `component`, or `node` for one that speaks ROS alone.
        module: What Python runs.
        package: The package that it is of, whose `package.xml` says what it needs.
        parameters: File of ROS parameters in the workspace; empty for none.
        domain: ROS domain.
    """

    name: str
    kind: str
    module: str
    package: str = ""
    arguments: tuple[str, ...] = ()
    parameters: str = ""
    domain: int = 0

    @property
    def speaks_jaus(self) -> bool:
        """Whether it is a component or a bridge."""
        return self.kind != "node"

    @property
    def speaks_ros(self) -> bool:
        """Whether it is a ROS node or a bridge."""
        return self.kind != "component"


def process_entries(folder: Path) -> Sequence[ProcessEntry]:
    """Returns the processes of a workspace, in the order of its manifest.

    Raises:
        EnvironmentFault: The manifest cannot be read, or does not say what runs.
    """
    from jausml.generation.manifest import read_manifest

    manifest = read_manifest(folder)
    if manifest.problem:
        raise EnvironmentFault(f"{folder}: {manifest.problem}; generate it again")
    lists = [facts["processes"] for facts in manifest.models.values() if "processes" in facts]
    try:
        entries = [_entry(fields) for fields in chain(*lists)]
    except (TypeError, KeyError, AttributeError):
        lists = []
    if not lists:
        raise EnvironmentFault(f"{folder}: the manifest lists no processes; generate it again")
    # A component that two models have is one process.
    return list({entry.name: entry for entry in entries}.values())


def _entry(fields: Any) -> ProcessEntry:
    """Returns a process as the manifest has it (`TypeError`, `KeyError`: it is damaged)."""
    name, kind, module = (fields[key] for key in ("name", "kind", "module"))
    package, parameters = (fields.get(key, "") for key in ("package", "parameters"))
    arguments, domain = fields.get("arguments", []), fields.get("domain", 0)
    texts = (name, kind, module, package, parameters, *arguments)
    is_sound = isinstance(arguments, list) and isinstance(domain, int)
    if not is_sound or not all(isinstance(text, str) for text in texts):
        raise TypeError("a value is of another type")
    # Python would take an option, or a statement, for what it runs.
    if not _MODULE.fullmatch(module):
        raise TypeError("no name of a module")
    return ProcessEntry(name, kind, module, package, tuple(arguments), parameters, domain)
