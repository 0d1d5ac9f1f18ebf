"""New model files: one root element in the notation that the name of the file tells."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Any, cast

from jausml.authoring.editing.applying import feature_of
from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.reading import SUFFIXES, is_model_file
from jausml.language.metamodel import FeatureKind, load_metamodels
from jausml.language.metamodel.filling import new_object, set_value, set_values
from jausml.language.model.model import Model
from jausml.language.model.values import convert, suggest
from jausml.language.model.xmi.writer import UnwritableError, to_xmi
from jausml.language.text.notation import SUFFIX
from jausml.language.text.writing.unparsing import to_text

if TYPE_CHECKING:
    from jausml.authoring.editing.commands import Create, Values
    from jausml.authoring.editing.drafts import Draft
    from jausml.language.metamodel import DataTypeTable, FeatureTable, Metamodels


def new_document(command: Create, draft: Draft) -> tuple[bytes, dict[str, Values]]:
    """Returns the bytes of a new file, and references of its root that are still to be set."""
    _check_name(command.file, draft)
    metamodels = load_metamodels()
    root, later = _root(command, metamodels)
    write = to_text if command.file.endswith(SUFFIX) else to_xmi
    try:
        text = write([root], Model([], metamodels), draft.root / command.file)
    except UnwritableError as error:
        raise EditError(str(error)) from error
    return text.encode("utf-8"), later


def _root(command: Create, metamodels: Metamodels) -> tuple[Any, dict[str, Values]]:
    table = metamodels.classes.get(command.kind)
    if table is None or table.abstract:
        hint = suggest(command.kind, metamodels.classes)
        raise EditError(f"{command.kind} is no class that a file can have {hint}".strip())
    root = new_object(table)
    later: dict[str, Values] = {}
    for name, values in command.values.items():
        feature = feature_of(table, name)
        if feature.kind is FeatureKind.CROSS_REFERENCE:
            later[name] = tuple(values)
        elif feature.kind is FeatureKind.ATTRIBUTE:
            _fill(root, feature, tuple(values))
        else:
            raise EditError(f"{name} of a new {table.name} owns elements: add them afterwards")
    return root, later


def _check_name(file: str, draft: Draft) -> None:
    parts = file.split("/")
    is_plain = posixpath.normpath(file) == file and not file.startswith("/") and "\\" not in file
    if not is_plain or any(each.startswith(".") or "\0" in each for each in parts):
        raise EditError(f"{file!r} is no name of a file below the opened folder")
    if not file.endswith(SUFFIXES):
        raise EditError(f"{file} must end in {' or '.join(SUFFIXES)}")
    if not is_model_file(file, draft.root):
        raise EditError(f"{file} would not be among the models of the opened folder")
    if file in draft.files or (draft.root / file).exists():
        raise EditError(f"there is a {file} already")


def _fill(root: object, feature: FeatureTable, texts: Values) -> None:
    found = []
    for text in texts:
        value, fault = convert(text, cast("DataTypeTable", feature.data_type))
        if fault is not None:
            raise EditError(f"{feature.name}: {fault.reason}")
        found.append(value)
    if feature.many:
        set_values(root, feature, found)
    elif found:
        set_value(root, feature, found[0])
