"""Files of the user: what they are, and what their text mentions, wherever that is."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from jausml.generation.contract.edits import Lines
from jausml.generation.contract.interface import module_of
from jausml.generation.contract.symbols import Module
from jausml.generation.contract.syntax import last_name

if TYPE_CHECKING:
    from collections.abc import Iterator

_BY_TEXT = ("getattr", "hasattr", "setattr", "delattr")
_BLOCKS = ("body", "orelse", "finalbody", "handlers", "cases")


@dataclass(frozen=True)
class File:
    """A file of the user.

    Attributes:
        path: Relative to the output folder.
    """

    path: str
    data: bytes
    tree: ast.Module

    @cached_property
    def module(self) -> Module:
        """The module that it is; its name is empty outside of packages."""
        is_package = self.path.endswith("/__init__.py")
        return Module(module_of(self.path), self.tree, is_package, is_generated=False)

    @cached_property
    def lines(self) -> Lines:
        """Its lines."""
        return Lines(self.data)

    @cached_property
    def nodes(self) -> list[ast.AST]:
        """All nodes of its tree."""
        return list(ast.walk(self.tree))

    @cached_property
    def names(self) -> frozenset[str]:
        """The names that are read, written or deleted; an import is no mention."""
        return frozenset(each.id for each in self.nodes if isinstance(each, ast.Name))

    @cached_property
    def stored(self) -> frozenset[str]:
        """The attributes that are set of whatever object."""
        attributes = (each for each in self.nodes if isinstance(each, ast.Attribute))
        return frozenset(each.attr for each in attributes if isinstance(each.ctx, ast.Store))

    @cached_property
    def derived(self) -> frozenset[str]:
        """The names of classes from which others derive."""
        classes = (each for each in self.nodes if isinstance(each, ast.ClassDef))
        return frozenset(last_name(base) for each in classes for base in each.bases)

    @cached_property
    def asked(self) -> frozenset[str]:
        """The attributes that are asked for or set by a text, as by `getattr`."""
        return frozenset(
            argument.value
            for each in self.nodes
            if isinstance(each, ast.Call) and last_name(each) in _BY_TEXT
            for argument in each.args
            if isinstance(argument, ast.Constant) and isinstance(argument.value, str)
        )

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of texts, docstrings left out."""
        return frozenset(word for text in self._texts() for word in re.findall(r"\w+", text))

    def _texts(self) -> Iterator[str]:
        documentation = {
            each.value
            for each in self.nodes
            if isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant)
        }
        for each in self.nodes:
            match each:
                case ast.Constant(value=str(text)) if each not in documentation:
                    yield text

    def is_alone(self, statement: ast.stmt) -> bool:
        """Tells whether a block would be empty without a statement."""
        for each in self.nodes:
            if isinstance(each, ast.Module):
                continue
            for block in _BLOCKS:
                if getattr(each, block, None) == [statement]:
                    return True
        return False
