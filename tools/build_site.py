"""Builds the site of the documentation, for `make docs`; fails at the first warning.

The pages are written to be read in the repository too. So docs/index.md says which pages there are
and in which order, and what they link to outside docs/ comes along. The references are made here,
of what the code is now. Each version has a folder of its own; versions.json beside them is what the
chooser of versions on each page reads.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Any

import build_reference

import jausml

ROOT = Path(__file__).resolve().parent.parent
DOCS = PurePosixPath("docs")
REFERENCES = {DOCS / "reference" / name: make for name, make in build_reference.MAKERS.items()}
"""What makes the pages that are not committed, by their path in the repository."""
OUTSIDE = PurePosixPath("repository")
"""Folder of the site for what lies outside docs/."""
SETTINGS = "zensical.toml"
_FENCE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(\]\()(?!\w+:|#)([^)\s#]+)")
_HEADING = re.compile(r"^(##+) (.+)$")
_LISTED = re.compile(r"^- \[([^\]]+)\]\(([^)#]+)")
_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_VERSION = re.compile(r"\d+(\.\d+)*")


class SiteError(Exception):
    """The site cannot be built as it should be."""


def site_path(path: PurePosixPath) -> PurePosixPath:
    """Where a file of the repository stands in the site.

    Args:
        path: Its path in the repository.
    """
    return path.relative_to(DOCS) if path.is_relative_to(DOCS) else OUTSIDE / path


def links(page: PurePosixPath, text: str) -> Iterator[PurePosixPath]:
    """The files of the repository that a page links to.

    Args:
        page: Its path in the repository.
        text: What stands in it.
    """
    for match in _LINK.finditer(_FENCE.sub("", text)):
        yield _target(page, match[2])


def moved(page: PurePosixPath, text: str) -> str:
    """A page with the links that lead to where the files stand in the site.

    Args:
        page: Its path in the repository.
        text: What stands in it.
    """

    def link(match: re.Match[str]) -> str:
        goal = site_path(_target(page, match[2]))
        return match[1] + PurePosixPath(os.path.relpath(goal, site_path(page).parent)).as_posix()

    kept, parts = 0, []
    for fence in _FENCE.finditer(text):
        parts += [_LINK.sub(link, text[kept : fence.start()]), fence[0]]
        kept = fence.end()
    return "".join([*parts, _LINK.sub(link, text[kept:])])


def _target(page: PurePosixPath, link: str) -> PurePosixPath:
    return PurePosixPath(os.path.normpath(page.parent / link))


def navigation(index: PurePosixPath = DOCS / "index.md") -> list[dict[str, Any]]:
    """The pages that an index lists under its headings, as nested lists by title.

    Args:
        index: A page with lists of links; another `index.md` that it lists brings its own list.
    """
    top: list[dict[str, Any]] = []
    open_lists = {1: top}
    for line in (ROOT / index).read_text(encoding="utf-8").splitlines():
        if heading := _HEADING.match(line):
            depth = len(heading[1])
            entries: list[dict[str, Any]] = []
            open_lists[depth - 1].append({heading[2]: entries})
            open_lists = {
                open_list: open_lists[open_list] for open_list in open_lists if open_list < depth
            }
            open_lists[depth] = entries
        elif listed := _LISTED.match(line):
            page = _target(index, listed[2])
            entry: Any = site_path(page).as_posix()
            if page.name == index.name:
                entry = [entry, *navigation(page)]
            open_lists[max(open_lists)].append({listed[1]: entry})
    return top


def stage(folder: Path, page_texts: Mapping[PurePosixPath, str]) -> None:
    """Puts together what the site is built from: pages, what they link to, and the settings.

    Args:
        folder: An empty folder.
        page_texts: The text of pages that are no files, by their path in the repository.

    Raises:
        SiteError: A page links to what is not there.
    """
    todo = [
        PurePosixPath(path.relative_to(ROOT).as_posix())
        for path in (ROOT / DOCS).rglob("*")
        if path.is_file()
    ]
    todo += page_texts
    done = set()
    while todo:
        path = todo.pop()
        if path in done:
            continue
        done.add(path)
        if path not in page_texts and not (ROOT / path).is_file():
            raise SiteError(f"a page links to {path}, which is no file")
        place = folder / DOCS / site_path(path)
        place.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            # One that is there as a file may be of an older state of the code.
            text = (
                page_texts[path]
                if path in page_texts
                else (ROOT / path).read_text(encoding="utf-8")
            )
            place.write_text(moved(path, text), encoding="utf-8")
            todo += links(path, text)
        else:
            shutil.copyfile(ROOT / path, place)
    settings = (ROOT / SETTINGS).read_text(encoding="utf-8")
    pages = [{"Home": "index.md"}, *navigation()]
    head = f"[project]\nnav = {_toml(pages)}\n"
    (folder / SETTINGS).write_text(settings.replace("[project]\n", head, 1), encoding="utf-8")


def _toml(value: str | list[Any] | dict[str, Any]) -> str:
    """A value as TOML on one line: strings are those of JSON."""
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, dict):
        pairs = (f"{json.dumps(key)} = {_toml(member)}" for key, member in value.items())
        return f"{{ {', '.join(pairs)} }}"
    return json.dumps(value)


def build(site: Path, version: str, page_texts: Mapping[PurePosixPath, str]) -> None:
    """Builds one version of the site beside those that stand there.

    Args:
        site: Folder of all versions.
        version: Name of this one's folder.
        page_texts: The text of pages that are not committed, by their path in the repository.

    Raises:
        SiteError: There was a warning.
    """
    with tempfile.TemporaryDirectory(prefix="jausml-site-") as name:
        folder = Path(name)
        stage(folder, page_texts)
        command = [sys.executable, "-m", "zensical", "build", "--strict", "--clean"]
        done = subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)
        said = _COLOUR.sub("", done.stdout + done.stderr).partition("Traceback")[0]
        if done.returncode or "warning" in said.lower():
            raise SiteError(said)
        shutil.rmtree(site / version, ignore_errors=True)
        shutil.copytree(folder / "site", site / version)
    tell_versions(site)


def tell_versions(site: Path) -> None:
    """Writes which versions there are, the newest first, and leads visitors to that one.

    Args:
        site: Folder of all versions.
    """
    names = (path.name for path in site.iterdir() if (path / "index.html").is_file())
    versions = sorted(names, key=_order, reverse=True)
    shown = [
        {
            "version": version,
            "title": version,
            "aliases": ["latest"] if version == versions[0] else [],
        }
        for version in versions
    ]
    (site / "versions.json").write_text(json.dumps(shown, indent=2) + "\n", encoding="utf-8")
    goal = f"{versions[0]}/"
    (site / "index.html").write_text(
        f'<!doctype html>\n<meta charset="utf-8">\n<title>jausml</title>\n'
        f'<meta http-equiv="refresh" content="0; url={goal}">\n<a href="{goal}">jausml</a>\n',
        encoding="utf-8",
    )


def _order(version: str) -> tuple[int, ...]:
    return tuple(map(int, version.split("."))) if _VERSION.fullmatch(version) else ()


def main() -> int:
    """Command line entry."""
    parser = argparse.ArgumentParser(description="Build the site of the documentation.")
    parser.add_argument("--out", type=Path, default=ROOT / "site", help="folder of all versions")
    parser.add_argument("--name", default=jausml.__version__, help="folder of this version")
    options = parser.parse_args()
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        build(options.out, options.name, {path: make() for path, make in REFERENCES.items()})
    except (SiteError, OSError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{options.out / options.name}/index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
