"""Maker of a new model project: a model, what Eclipse needs beside it, and what CI runs."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import jinja2

from jausml import __version__
from jausml.authoring.projects.copies import SUMS, renewed, sums_of
from jausml.authoring.projects.eclipse import METAMODELS, with_schema_location
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.projects.first_model import as_xmi, empty_text, empty_xmi, text_of
from jausml.language.model.inputs import read_input
from jausml.language.model.uris import library_root
from jausml.language.model.xmi.writer import replace_file
from jausml.language.semantics.names import DEVICES

_NAME = re.compile(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
_LIBRARY = "library"
TEMPLATES = {
    ".project": "project.j2",
    ".gitignore": "gitignore.j2",
    ".github/workflows/models.yml": "workflow.j2",
    ".pre-commit-config.yaml": "hooks.j2",
    "README.md": "readme.j2",
}
"""Files that are rendered, by their paths."""


@dataclass(frozen=True)
class Wish:
    """What is wanted.

    Attributes:
        is_empty: Whether the system shall be empty, without an example.
    """

    name: str
    is_text: bool = False
    is_empty: bool = False

    @property
    def model(self) -> str:
        """Path of the model."""
        return f"models/{self.name}.{'ros2jaus' if self.is_text else 'xmi'}"


def name_for(folder: Path) -> str:
    """Returns the name of a project in a folder."""
    words = re.findall(r"[a-z0-9]+", folder.resolve().name.lower())
    name = "_".join(words)
    if not _NAME.fullmatch(name):
        raise ProjectError(f"{folder.name!a} makes no name of a system; give one by --name")
    return name


def create(folder: Path, wish: Wish) -> list[str]:
    """Writes the files of a project; none when one is there already with other contents.

    Returns:
        The paths of what was written, relative to the folder.

    Raises:
        OSError: A file cannot be written.
    """
    if not _NAME.fullmatch(wish.name):
        raise ProjectError(f"{wish.name!a} is no name of a system: small letters, digits, single _")
    if wish.name in DEVICES:
        raise ProjectError(f"{wish.name!a} is a device name on Windows; give another by --name")
    contents = _contents(wish)
    taken = [each for each, data in contents.items() if _differs(folder / each, data)]
    if taken:
        more = f" and {len(taken) - 1} more" if len(taken) > 1 else ""
        raise ProjectError(f"{folder / taken[0]} is there already{more}; nothing was written")
    written = [each for each in contents if not (folder / each).exists()]
    for each in written:
        (folder / each).parent.mkdir(parents=True, exist_ok=True)
        replace_file(folder / each, contents[each])
    return written


def renew_copies(folder: Path) -> tuple[list[str], list[str]]:
    """Writes the copies that Eclipse needs as they are now; those that somebody changed stay.

    Returns:
        The paths of what was written, and of what stays, relative to the folder.
    """
    written: list[str] = []
    kept: list[str] = []
    for name, contents in copies_for().items():
        wanted, changed = renewed(folder / name, contents)
        for path, data in wanted.items():
            (folder / name / path).parent.mkdir(parents=True, exist_ok=True)
            replace_file(folder / name / path, data)
        written += [f"{name}/{path}" for path in wanted]
        kept += [f"{name}/{path}" for path in changed]
    return written, kept


def _contents(wish: Wish) -> dict[str, bytes]:
    found = {wish.model: _model(wish)}
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("jausml.authoring.projects"),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 - names are checked, and no file is HTML
    )
    for path, template in TEMPLATES.items():
        text = environment.get_template(template).render(wish=wish, version=__version__)
        found[path] = text.encode()
    for folder, copies in copies_for().items():
        found |= {f"{folder}/{path}": data for path, data in copies.items()}
        found[f"{folder}/{SUMS}"] = sums_of(copies)
    return found


def copies_for() -> dict[str, dict[str, bytes]]:
    """Returns the copies that Eclipse needs, by folder and path in it."""
    library: dict[str, bytes] = {}
    for source in sorted(library_root().rglob("*.xmi")):
        path = source.relative_to(library_root()).as_posix()
        text = with_schema_location(source.read_text(encoding="utf-8"), f"../../{METAMODELS}")
        library[path] = text.encode()
    return {_LIBRARY: library, METAMODELS: _metamodels()}


def _metamodels() -> dict[str, bytes]:
    folder = Path(str(library_root())).parent.parent / METAMODELS
    return {each.name: each.read_bytes() for each in sorted(folder.glob("*.ecore"))}


def _model(wish: Wish) -> bytes:
    beside = f"../{METAMODELS}"
    if wish.is_empty:
        return (empty_text(wish.name) if wish.is_text else empty_xmi(wish.name, beside)).encode()
    xmi = as_xmi(wish.name, beside)
    return (text_of(xmi, wish.name) if wish.is_text else xmi).encode()


def _differs(path: Path, data: bytes) -> bool:
    try:
        return read_input(path) != data
    except FileNotFoundError:
        return False
