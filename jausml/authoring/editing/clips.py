"""Clips: elements as text that goes by the clipboard, into an editor or into another project.

Each element is written as it stands in its owner. Whatever stands in a clipboard may be pasted, be
it from here or typed by somebody: it is read and judged as any text is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Add, EditError, Set
from jausml.authoring.editing.describing import described
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.filling import add_values, make
from jausml.language.model import refs
from jausml.language.model.diagnostics import Severity
from jausml.language.model.names import around, name_of
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.printing import UnwritableError
from jausml.language.text.keywords import keyword_of
from jausml.language.text.notation import NOTATIONS, Ros2Jaus
from jausml.language.text.tree import Element, Feature, Import, Name, SyntaxTree, Text
from jausml.language.text.writing.references import ROOT, STANDING
from jausml.language.text.writing.unparsing import to_clip

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from pathlib import Path

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.diagnostics import Diagnostic
    from jausml.language.model.model import Model
    from jausml.language.model.refs import Ref
    from jausml.language.text.reading.parsing import Parsed
    from jausml.language.text.tree import BlockItem

_SUFFIX = ".clip"
_FILE = f"clipboard{_SUFFIX}"
_UNREADABLE = frozenset({"JML701", "JML702", "JML714"})
_MISSING = "JML108"
"""The rule of features that have no value: where it is pasted that is found again."""


@dataclass(frozen=True)
class LeftOut:
    """A part of a clip that has no target here, with the name of its element."""

    name: str
    message: str


@dataclass(frozen=True)
class Clip:
    """The elements of a text, as commands that add them to an owner."""

    commands: tuple[Add | Set, ...]
    left_out: tuple[LeftOut, ...]


def clip_text(elements: Sequence[EObject], model: Model, root: Path) -> str:
    """Returns elements of a model with all that they own as text.

    `root`: the folder of the project, to which imports are relative.
    """
    try:
        return to_clip(elements, model, root / _FILE)
    except UnwritableError as error:
        raise EditError(f"this cannot be copied: {error}") from error


def read_clip(text: str, root: Path, files: Mapping[str, bytes], known: Collection[str]) -> Clip:
    """Returns the elements that a text describes, as a clip.

    `files`: what the files of the project hold. `known`: those whose names hold where it is pasted.
    What leads to nothing here is left out; of a map or a connection it becomes an open decision.
    `EditError`: the text cannot be read, or has no element.
    """
    notation = _Notation(files, known)
    result = read_models(
        [root / _FILE],
        project_root=root,
        notations=(notation, *NOTATIONS),
        contents={root / _FILE: text.encode(), **{root / file: files[file] for file in files}},
    )
    model, own = result.model, result.model.documents[0]
    errors = [
        diagnostic
        for diagnostic in result.diagnostics
        if diagnostic.location.path == own.display and diagnostic.severity is Severity.ERROR
    ]
    fault = next((diagnostic for diagnostic in errors if diagnostic.rule in _UNREADABLE), None)
    if fault is not None:
        where = f"line {fault.location.line}: " if fault.location.line else ""
        raise EditError(f"what is in the clipboard cannot be read: {where}{fault.message}")
    elements = list(_elements(model, notation.features))
    if not elements:
        raise EditError("what is in the clipboard has no element of a model")
    left_out = [
        _left_out(model, refs.find(f"{_FILE}#{diagnostic.fragment}", model, root), diagnostic)
        for diagnostic in errors
        if diagnostic.rule != _MISSING
    ]

    def ref_of(obj: EObject, of: Model) -> Ref:
        return refs.ref_of(obj, of, root)

    commands = described([(element, model) for element, _ in elements], ref_of)
    features = iter(feature for _, feature in elements)
    return Clip(
        tuple(
            replace(command, feature=next(features))
            if isinstance(command, Add) and not command.owner
            else command
            for command in commands
        ),
        tuple(left_out),
    )


def _elements(model: Model, features: Sequence[str]) -> Iterator[tuple[EObject, str]]:
    """Yields each element to paste and the feature that had it, empty where the text names none."""
    said = iter(features)
    for root in model.documents[0].roots:
        if model.metamodels.class_of(root).qualified_name in STANDING:
            for element in model.owned(root):
                yield element, element.eContainmentFeature().name
        else:
            yield root, next(said)


def _left_out(model: Model, obj: EObject | None, diagnostic: Diagnostic) -> LeftOut:
    """Notes what is left out, at the nearest element of which a decision may be open."""
    owner = around(obj, bridge.DecisionOwner)
    if owner is not None:
        text = f"say what is meant where this was pasted: {diagnostic.message}"
        decision = make(model.metamodels, bridge.OpenDecision, text=text)
        decisions = model.metamodels.class_of(owner).features["openDecisions"]
        add_values(owner, decisions, [*owner.openDecisions, decision])
    return LeftOut(name_of(obj) if obj is not None else "", diagnostic.message)


class _Notation(Ros2Jaus):
    """Text in which any element may stand alone, as it stood where it was copied."""

    suffixes = (_SUFFIX,)

    def __init__(self, files: Collection[str], known: Collection[str]) -> None:
        super().__init__(parse=self._parsed)
        self._files = files
        self._known = known
        self.features: list[str] = []
        """The features of elements that do not stand in a root of their own."""

    def _parsed(self, text: str) -> Parsed:
        from jausml.language.text.reading.parsing import parse  # noqa: PLC0415 - heavy

        parsed = parse(text)
        imports: list[Import] = []
        items: list[BlockItem] = []
        for item in parsed.document.items:
            if isinstance(item, Import):
                imports.append(item)
            else:
                items.append(self._standing(item))
        named = [statement for statement in imports if isinstance(statement.target, Text)]
        # One that is not here would hide all else that is not.
        gone = [
            import_statement
            for import_statement in named
            if import_statement.target.text not in self._files
        ]
        if gone or not named:
            imports += [Import(target=Text(file)) for file in self._known]
        kept = [import_statement for import_statement in imports if import_statement not in gone]
        return replace(parsed, document=SyntaxTree([*kept, *items]))

    def _standing(self, item: BlockItem) -> BlockItem:
        """Returns an item as a root."""
        if isinstance(item, Feature) and all(isinstance(value, Element) for value in item.values):
            name = item.name.text
            self.features += ["" if name == ROOT.text else name] * len(item.values)
            return replace(item, name=replace(item.name, text=ROOT.text))
        if not isinstance(item, Element) or (item.name is None and item.keyword is None):
            return item
        keyword = item.keyword or Name("attribute_map", item.span)
        if keyword.text in _STANDING_WORDS:
            return item
        self.features.append("")
        block = replace(item, keyword=keyword, documentation="", comments=[])
        return Feature(span=item.span, documentation=item.documentation, name=ROOT, values=[block])


_STANDING_WORDS = frozenset(keyword_of(kind.rpartition(".")[2]) for kind in STANDING)
