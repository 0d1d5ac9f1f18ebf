"""New projects: a model, what Eclipse needs beside it, what CI runs, and renewed copies."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import jinja2

from jausml import __version__
from jausml.authoring.projects.eclipse_xmi import METAMODELS, with_schema_location
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.projects.starting import EMPTY, EXAMPLE, starting_point, text_to_begin_with
from jausml.authoring.projects.texts import empty_text, empty_xmi, example_xmi, text_of
from jausml.language.model.files import read_input, replace_file
from jausml.language.model.library import XMI, library_paths, place_in_library
from jausml.language.semantics.names import DEVICES

_NAME = re.compile(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
_LIBRARY = "library"
_ECLIPSE = ".project"
TEMPLATES = {
    _ECLIPSE: "project.j2",
    ".gitattributes": "gitattributes.j2",
    ".gitignore": "gitignore.j2",
    ".github/workflows/models.yml": "workflow.j2",
    ".pre-commit-config.yaml": "hooks.j2",
    "README.md": "readme.j2",
}
"""Files that are rendered, by their paths."""

SUMS = "SHA256SUMS"
"""The file in a folder of copies that says what they were, as `sha256sum` writes it."""


@dataclass(frozen=True)
class Wish:
    """The wanted project.

    `origin`: the name of the starting point of the model.
    """

    name: str
    is_text: bool = False
    origin: str = EXAMPLE

    @property
    def model(self) -> str:
        """Path of the model."""
        return f"models/{self.name}.{'ros2jaus' if self.is_text else 'xmi'}"


def name_for(folder: Path) -> str:
    """Returns the name of a project in a folder."""
    words = re.findall(r"[a-z0-9]+", folder.resolve().name.lower())
    name = "_".join(words)
    if not _NAME.fullmatch(name):
        raise ProjectError(f"{folder.name!r} makes no name of a system; give one by --name")
    return name


def create(folder: Path, wish: Wish) -> list[str]:
    """Writes the files of a project; none when one is there already with other contents.

    Returns the paths of what was written, relative to the folder. `OSError`: a file cannot be
    written.
    """
    if not _NAME.fullmatch(wish.name):
        raise ProjectError(f"{wish.name!r} is no name of a system: small letters, digits, single _")
    if wish.name in DEVICES:
        raise ProjectError(f"{wish.name!r} is a device name on Windows; give another by --name")
    contents = _contents(wish)
    taken = [file for file, data in contents.items() if _differs(folder / file, data)]
    if taken:
        more = f" and {len(taken) - 1} more" if len(taken) > 1 else ""
        raise ProjectError(f"{folder / taken[0]} is there already{more}; nothing was written")
    written = [content for content in contents if not (folder / content).exists()]
    for file in written:
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        replace_file(folder / file, contents[file])
    return written


def is_project(folder: Path) -> bool:
    """Tells whether a folder has a file of projects alone: that of Eclipse, or the library."""
    return (folder / _ECLIPSE).is_file() or (folder / _LIBRARY).is_dir()


def renew_copies(folder: Path) -> tuple[list[str], list[str]]:
    """Writes the present copies for Eclipse; those that a user has changed stay.

    Returns the paths of what was written, and of what stays, relative to the folder.
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
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("jausml.authoring.projects"),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 - names are checked, and no file is HTML
    )
    beside = f"../{METAMODELS}"
    files = {wish.model: model_text(wish.origin, wish.name, beside, is_text=wish.is_text)}
    for path, template in TEMPLATES.items():
        text = environment.get_template(template).render(wish=wish, version=__version__)
        files[path] = text.encode()
    for folder, copies in copies_for().items():
        files |= {f"{folder}/{path}": data for path, data in copies.items()}
        files[f"{folder}/{SUMS}"] = sums_of({path: _digest(data) for path, data in copies.items()})
    return files


def copies_for() -> dict[str, dict[str, bytes]]:
    """Returns the copies that Eclipse needs, by folder and path in it."""
    library: dict[str, bytes] = {}
    for source in library_paths(suffixes=(XMI,)):
        text = with_schema_location(source.read_text(encoding="utf-8"), f"../../{METAMODELS}")
        library[place_in_library(source)] = text.encode()
    return {_LIBRARY: library, METAMODELS: _metamodels()}


def _metamodels() -> dict[str, bytes]:
    folder = Path(str(resources.files("jausml.metamodels")))
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.ecore"))}


def model_text(origin: str, name: str, metamodels: str = "", *, is_text: bool) -> bytes:
    """Returns a model that begins with a starting point.

    `metamodels`: folder of the metamodels for Eclipse, relative to the model; empty for none.
    `ProjectError`: there is no such starting point, or none in XMI.
    """
    point = starting_point(origin)
    if point is None:
        raise ProjectError(f"there is no starting point {origin!r}")
    if point.is_text_only:
        if not is_text:
            raise ProjectError(f"{origin} uses ready maps, which are text")
        return text_to_begin_with(point, name).encode()
    if origin == EMPTY:
        return (empty_text(name) if is_text else empty_xmi(name, metamodels)).encode()
    xmi = example_xmi(name, metamodels)
    return (text_of(xmi, name) if is_text else xmi).encode()


def _differs(path: Path, data: bytes) -> bool:
    try:
        return read_input(path) != data
    except FileNotFoundError:
        return False


def sums_of(digests: Mapping[str, str]) -> bytes:
    """Returns the file of checksums of the copies."""
    return "".join(f"{digest}  {path}\n" for path, digest in sorted(digests.items())).encode()


def renewed(folder: Path, contents: Mapping[str, bytes]) -> tuple[dict[str, bytes], list[str]]:
    """Returns the copies to write anew, and those that a user has changed."""
    stored = read_input(folder / SUMS) if (folder / SUMS).is_file() else b""
    lines = stored.decode("utf-8", "replace").splitlines()
    known = {
        path: known_digest for known_digest, _, path in (line.partition("  ") for line in lines)
    }
    digests = {path: _digest(data) for path, data in contents.items()}
    wanted: dict[str, bytes] = {}
    kept = []
    for path, data in contents.items():
        current_data = read_input(folder / path) if (folder / path).is_file() else None
        if current_data == data:
            continue
        if current_data is None or _digest(current_data) == known.get(path):
            wanted[path] = data
        else:
            kept.append(path)
            # Who takes the change back has the copy renewed next time.
            digests[path] = known.get(path, "")
    sums = sums_of({path: stated for path, stated in digests.items() if stated})
    if stored != sums:
        wanted[SUMS] = sums
    return wanted, kept


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
