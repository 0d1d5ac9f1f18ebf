"""Each folder of code is a package: what is left of one that moved would be imported as well."""

from __future__ import annotations

from sources import PACKAGES

PAGES = ("templates", "page", "__pycache__")
"""Folders of what is no code."""


def test_each_folder_of_modules_says_what_it_is():
    silent = [
        str(folder)
        for package in PACKAGES.values()
        for folder in {each.parent for each in package.rglob("*.py")}
        if not set(folder.parts) & set(PAGES)
        if not (folder / "__init__.py").is_file()
        or not (folder / "__init__.py").read_text(encoding="utf-8").startswith('"""')
    ]
    assert silent == []


def test_no_folder_holds_more_modules_than_one_can_look_over():
    known = {"cli": 61, "semantics": 44, "editing": 26, "bridge": 25}
    crowded = {
        folder.name: len(modules)
        for package in PACKAGES.values()
        for folder in [package, *(each for each in package.rglob("*") if each.is_dir())]
        if len(modules := [each for each in folder.glob("*.py") if each.stem != "__init__"]) > 24
    }
    assert {name: count for name, count in crowded.items() if count > known.get(name, 24)} == {}
