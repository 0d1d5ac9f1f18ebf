"""A working copy of the elements of several files, on which commands are tried.

Elements of one file are read once for each file that refers to it; here they are one. What a
command means is done to the copies first; what is then read of the changed files must be the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import contents, is_set
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.refs import Ref, file_of, find, fragment_of, ref_of, split
from jausml.language.model.xmi.writer import lexical
from jausml.language.semantics.connections.exchanges import CONNECTION, FEATURES
from jausml.language.text.notation import SUFFIX


@dataclass(eq=False, slots=True, repr=False)
class ElementCopy:
    """A copy of an element, or a new element.

    Attributes:
        file: The file of which it was read or for which it was made.
        obj: The element of the model of that file, None when it is new.
        identifier: The id that its file gives it, empty without one.
        values: What its attributes have, as XMI writes it, by name; None is no value where
            there is a default. What has its default is left out.
        references: What it refers to, by the name of the feature: copies, and the refs of
            elements of files that the working copy has not.
        owned: Its parts, by the name of the feature of it that has them.
        owner, feature: Of which element it is a part, by which feature; None and empty for roots.
        open: Attributes that a text leaves open: what they have follows from all else, and may
            be another value after an edit.
    """

    table: ClassTable
    file: str
    obj: EObject | None = None
    identifier: str = ""
    values: dict[str, tuple[str | None, ...]] = field(default_factory=dict)
    references: dict[str, list[ElementCopy | Ref]] = field(default_factory=dict)
    owned: dict[str, list[ElementCopy]] = field(default_factory=dict)
    owner: ElementCopy | None = None
    feature: str = ""
    open: set[str] = field(default_factory=set)

    @property
    def name(self) -> str:
        """Its name, empty without one."""
        return next(iter(self.values.get("name", ())), None) or ""

    @property
    def label(self) -> str:
        """Class and name, for people."""
        return f"{self.table.name} '{self.name}'" if self.name else self.table.name

    @property
    def root(self) -> ElementCopy:
        """The root of its document."""
        copy = self
        while copy.owner is not None:
            copy = copy.owner
        return copy

    @property
    def siblings(self) -> tuple[list[ElementCopy], list[ElementCopy]]:
        """The elements of the same feature of its owner before it, and behind it."""
        own = self.owner.owned[self.feature] if self.owner is not None else [self]
        at = own.index(self)
        return own[:at], own[at + 1 :]

    def everything(self) -> Iterator[ElementCopy]:
        """Yields the element and all of its parts, in order."""
        pending = [self]
        while pending:
            copy = pending.pop()
            yield copy
            for children in reversed(list(copy.owned.values())):
                pending += reversed(children)

    def __repr__(self) -> str:
        return f"<{self.label} of {self.file}>"


class WorkingCopy:
    """The elements of some files of a project; `WorkingCopy.of` has all of them.

    Attributes:
        folder: The folder of the project, from which `models` and `roots` name files.
        copies: Copies by the elements that were read, of which several may have one copy.
        identifiers: The ids by which copies are found.
    """

    def __init__(self, models: Mapping[str, Model], root: Path) -> None:
        self.models = dict(models)
        self.folder = root
        self.roots: dict[str, list[ElementCopy]] = {}
        self.copies: dict[EObject, ElementCopy] = {}
        self.identifiers: dict[ElementCopy, str] = {}

    @classmethod
    def of(cls, models: Mapping[str, Model], root: Path) -> WorkingCopy:
        """Returns the working copy of all elements of some files."""
        working_copy = cls(models, root)
        for file, model in models.items():
            document = model.documents[0]
            working_copy.roots[file] = [
                working_copy._grown(element, file) for element in document.roots
            ]
        working_copy.pair()
        for copy in list(working_copy.everything()):
            copy.references = working_copy.references_of(copy)
        return working_copy

    def find(self, ref: Ref) -> ElementCopy | None:
        """Returns the copy of a ref as it was read, None when the working copy has none."""
        model = self.models.get(split(ref)[0])
        obj = find(ref, model, self.folder) if model is not None else None
        return self.copies.get(obj) if obj is not None else None

    def fragments(self, paths: Mapping[ElementCopy, str] | None = None) -> dict[ElementCopy, str]:
        """Returns by which fragments copies are found: ids, else `paths`, those of now if None."""
        return {**(self.paths() if paths is None else paths), **self.identifiers}

    def paths(self) -> dict[ElementCopy, str]:
        """Returns the paths of copies by features, as they stand now."""
        paths: dict[ElementCopy, str] = {}
        for roots in self.roots.values():
            for index, root in enumerate(roots):
                pending = [(root, f"/{index if len(roots) > 1 else ''}")]
                while pending:
                    copy, path = pending.pop()
                    paths[copy] = path
                    for name, children in copy.owned.items():
                        if copy.table.features[name].many:
                            pending += [
                                (child, f"{path}/@{name}.{index}")
                                for index, child in enumerate(children)
                            ]
                        else:
                            pending += [(child, f"{path}/@{name}") for child in children]
        return paths

    def ref(self, copy: ElementCopy, fragments: Mapping[ElementCopy, str] | None = None) -> Ref:
        """Returns the ref of a copy as it stands now.

        Args:
            fragments: Those of all copies; None computes them.
        """
        return f"{copy.root.file}#{(fragments or self.fragments())[copy]}"

    def refs(self, paths: Mapping[ElementCopy, str] | None = None) -> dict[ElementCopy, Ref]:
        """Returns the refs of all copies in the files that they were read of."""
        return {copy: f"{copy.file}#{at}" for copy, at in self.fragments(paths).items()}

    def referrers(self, targets: set[ElementCopy]) -> Iterator[tuple[ElementCopy, str]]:
        """Yields the elements that refer to one of some copies, with the name of the feature."""
        for copy in self.everything():
            for name, values in copy.references.items():
                if any(value in targets for value in values):
                    yield copy, name

    def everything(self) -> Iterator[ElementCopy]:
        """Yields all copies, in order."""
        for roots in self.roots.values():
            for root in roots:
                yield from root.everything()

    def _grown(self, obj: EObject, file: str) -> ElementCopy:
        """Makes a copy of an element, and of all that it owns, without references."""
        root = self._copy(obj, file)
        pending = [root]
        while pending:
            copy = pending.pop()
            for name, children in self.owned_by(copy).items():
                copies = copy.owned[name] = [self._copy(child, file) for child in children]
                for child in copies:
                    child.owner, child.feature = copy, name
                pending += copies
        return root

    def _copy(self, obj: EObject, file: str) -> ElementCopy:
        model = self.models[file]
        copy = ElementCopy(model.metamodels.class_of(obj), file)
        copy.identifier = model.identifier(obj) or ""
        self.hold(copy, obj, file)
        self.take_values(copy)
        return copy

    def hold(self, copy: ElementCopy, obj: EObject, file: str) -> None:
        """Makes an element that was read of a file that of a copy."""
        model = self.models[file]
        copy.obj, copy.file = obj, file
        self.copies[obj] = copy
        if copy.identifier and fragment_of(obj, model.documents[0], model) == copy.identifier:
            self.identifiers[copy] = copy.identifier

    def take_values(self, copy: ElementCopy) -> None:
        """Gives a copy the values that the attributes of its element have."""
        obj: Any = copy.obj
        copy.values = {
            feature.name: values
            for feature in features_of(copy.table, FeatureKind.ATTRIBUTE)
            # What was never set has its default, and asking for it would create it.
            if feature.name in obj.__dict__ and (values := attribute_values(obj, feature))
        }
        copy.open = open_features(copy.table, copy.file)
        # What the text states is not open.
        node = self.models[copy.file].node_of(obj) if copy.open else None
        if node is not None:
            copy.open -= {child.tag for child in node.children}

    def owned_by(self, copy: ElementCopy) -> dict[str, list[EObject]]:
        """Returns the parts of an element in its own file, by the name of the feature."""
        model = self.models[copy.file]
        document = model.documents[0]
        elements_by_feature = {}
        for feature in copy.table.contained:
            children = contents(copy.obj, feature)
            # Others are roots of another file, which this one refers to.
            own = [child for child in children if model.document_of(child) is document]
            if own:
                elements_by_feature[feature.name] = own
        return elements_by_feature

    def pair(self) -> None:
        """Finds the copies of elements that were read once more, with another file."""
        for model in self.models.values():
            for document in model.documents[1:]:
                known = self.roots.get(file_of(document, self.folder))
                if known is not None:
                    self._pair(document, known, model)

    def _pair(self, document: Document, roots: list[ElementCopy], model: Model) -> None:
        pending = list(zip(document.roots, roots, strict=False))
        while pending:
            obj, copy = pending.pop()
            self.copies[obj] = copy
            for name, owned in copy.owned.items():
                children = contents(obj, copy.table.features[name])
                own = [child for child in children if model.document_of(child) is document]
                pending += zip(own, owned, strict=False)

    def references_of(self, copy: ElementCopy) -> dict[str, list[ElementCopy | Ref]]:
        """Returns the targets of the references of an element, once all copies are there."""
        obj: Any = copy.obj
        model = self.models[copy.file]
        targets_by_feature = {}
        kinds = (FeatureKind.CROSS_REFERENCE, FeatureKind.CONTAINMENT)
        for feature in features_of(copy.table, *kinds):
            name = feature.name
            if name not in obj.__dict__:
                continue
            targets = contents(obj, feature)
            if feature.kind is FeatureKind.CONTAINMENT:
                owned = {child.obj for child in copy.owned.get(name, ())}
                targets = [target for target in targets if target not in owned]
            if targets:
                targets_by_feature[name] = [self._target(target, model) for target in targets]
        return targets_by_feature

    def _target(self, obj: EObject, model: Model) -> ElementCopy | Ref:
        return self.copies.get(obj) or ref_of(obj, model, self.folder)


def features_of(table: ClassTable, *kinds: FeatureKind) -> list[FeatureTable]:
    """Returns the features of some kinds of a class."""
    return [feature for feature in table.features.values() if feature.kind in kinds]


def open_features(table: ClassTable, file: str) -> set[str]:
    """Returns the attributes of a class that a file may leave open, and that then follow."""
    is_open = table.qualified_name == CONNECTION and file.endswith(SUFFIX)
    return set(FEATURES) if is_open else set()


def attribute_values(obj: Any, feature: FeatureTable) -> tuple[str | None, ...]:
    """Returns the texts of an attribute as XMI has them; none when they need not be written."""
    texts = tuple(lexical(content, feature) for content in contents(obj, feature))
    if feature.many:
        return texts
    if feature.unsettable:
        return texts or ((None,) if is_set(obj, feature) else ())
    text = texts[0] if texts else None
    return () if text == default_text(feature) else (text,)


def default_text(feature: FeatureTable) -> str | None:
    """Returns the default of an attribute as XMI writes it, None without one."""
    return lexical(feature.default, feature) if feature.default is not None else None
