"""The elements of several files as plain things, which commands can be tried on.

Elements of one file are read once for each file that refers to it; here they are one. What a
command means is done to things first, and what is then read of the changed files must be the same.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.filling import contents, is_set
from jausml.language.model.refs import file_of, find, fragment_of, ref_of, split
from jausml.language.model.xmi.writer import lexical
from jausml.language.semantics.ways import CONNECTION, FEATURES
from jausml.language.text.notation import SUFFIX

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from jausml.language.metamodel import ClassTable, FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model
    from jausml.language.model.refs import Ref


class Thing:
    """An element.

    Attributes:
        file: The file of which it was read or for which it was made.
        obj: The element of the model of that file, None when it is new.
        values: What its attributes have, as XMI writes it, by name; None is no value where
            there is a default. What has its default is left out.
        references: What it refers to, by the name of the feature: things, and the refs of
            elements of files that the forest has not.
        open: Attributes that a text leaves open: what they have follows from all else, and may
            be another value after an edit.
    """

    __slots__ = (
        "feature",
        "file",
        "identifier",
        "obj",
        "open",
        "owned",
        "owner",
        "references",
        "table",
        "values",
    )

    def __init__(self, table: ClassTable, file: str, obj: EObject | None = None) -> None:
        self.table = table
        self.file = file
        self.obj = obj
        self.identifier = ""
        self.values: dict[str, tuple[str | None, ...]] = {}
        self.references: dict[str, list[Thing | Ref]] = {}
        self.owned: dict[str, list[Thing]] = {}
        self.owner: Thing | None = None
        self.feature = ""
        self.open: set[str] = set()

    @property
    def name(self) -> str:
        """Its name, empty without one."""
        return next(iter(self.values.get("name", ())), None) or ""

    @property
    def label(self) -> str:
        """What people call it."""
        return f"{self.table.name} '{self.name}'" if self.name else self.table.name

    @property
    def root(self) -> Thing:
        """The root of its document."""
        thing = self
        while thing.owner is not None:
            thing = thing.owner
        return thing

    def everything(self) -> Iterator[Thing]:
        """Yields it and all that it owns, in order."""
        pending = [self]
        while pending:
            thing = pending.pop()
            yield thing
            for children in reversed(list(thing.owned.values())):
                pending += reversed(children)

    def __repr__(self) -> str:
        return f"<{self.label} of {self.file}>"


class Forest:
    """The elements of some files of a project; `Forest.grown` has all of them."""

    def __init__(self, models: Mapping[str, Model], root: Path) -> None:
        self.models = dict(models)
        self.folder = root
        self.roots: dict[str, list[Thing]] = {}
        self.things: dict[EObject, Thing] = {}
        self._identifiers: dict[Thing, str] = {}
        self._foreign: dict[EObject, Ref] = {}

    @classmethod
    def grown(cls, models: Mapping[str, Model], root: Path) -> Forest:
        """Returns the forest of all elements of some files."""
        forest = cls(models, root)
        for file, model in models.items():
            document = model.documents[0]
            forest.roots[file] = [forest._grown(each, file) for each in document.roots]
        forest.pair()
        for thing in list(forest.everything()):
            thing.references = forest.references_of(thing)
        return forest

    def find(self, ref: Ref) -> Thing | None:
        """Returns the thing of a ref as it was read, None when the forest has none."""
        model = self.models.get(split(ref)[0])
        obj = find(ref, model, self.folder) if model is not None else None
        return self.things.get(obj) if obj is not None else None

    def fragments(self, paths: Mapping[Thing, str] | None = None) -> dict[Thing, str]:
        """Returns by which fragments things are found: ids, else paths."""
        return {**(self.paths() if paths is None else paths), **self._identifiers}

    def paths(self) -> dict[Thing, str]:
        """Returns the paths of things by features, as they stand now."""
        found: dict[Thing, str] = {}
        for roots in self.roots.values():
            for index, root in enumerate(roots):
                pending = [(root, f"/{index if len(roots) > 1 else ''}")]
                while pending:
                    thing, path = pending.pop()
                    found[thing] = path
                    for name, children in thing.owned.items():
                        if thing.table.features[name].many:
                            pending += [(c, f"{path}/@{name}.{i}") for i, c in enumerate(children)]
                        else:
                            pending += [(each, f"{path}/@{name}") for each in children]
        return found

    def ref(self, thing: Thing, fragments: Mapping[Thing, str] | None = None) -> Ref:
        """Returns the ref of a thing as it stands now."""
        return f"{thing.root.file}#{(fragments or self.fragments())[thing]}"

    def refs(self, paths: Mapping[Thing, str] | None = None) -> dict[Thing, Ref]:
        """Returns the refs of all things in the files that they were read of."""
        return {each: f"{each.file}#{at}" for each, at in self.fragments(paths).items()}

    def referrers(self, targets: set[Thing]) -> Iterator[tuple[Thing, str]]:
        """Yields what refers to one of some things, and the name of the feature."""
        for thing in self.everything():
            for name, values in thing.references.items():
                if any(each in targets for each in values):
                    yield thing, name

    def everything(self) -> Iterator[Thing]:
        """Yields all things, in order."""
        for roots in self.roots.values():
            for root in roots:
                yield from root.everything()

    def _grown(self, obj: EObject, file: str) -> Thing:
        """Makes a thing of an element, and of all that it owns, without references."""
        root = self._thing(obj, file)
        pending = [root]
        while pending:
            thing = pending.pop()
            for name, children in self.owned_by(thing).items():
                made = thing.owned[name] = [self._thing(each, file) for each in children]
                for each in made:
                    each.owner, each.feature = thing, name
                pending += made
        return root

    def _thing(self, obj: EObject, file: str) -> Thing:
        model = self.models[file]
        thing = Thing(model.metamodels.class_of(obj), file)
        thing.identifier = model.identifier(obj) or ""
        self.hold(thing, obj, file)
        self.take_values(thing)
        return thing

    def hold(self, thing: Thing, obj: EObject, file: str) -> None:
        """Makes an element that was read of a file that of a thing."""
        model = self.models[file]
        thing.obj, thing.file = obj, file
        self.things[obj] = thing
        if thing.identifier and fragment_of(obj, model.documents[0], model) == thing.identifier:
            self._identifiers[thing] = thing.identifier

    def take_values(self, thing: Thing) -> None:
        """Gives a thing the values that the attributes of its element have."""
        obj: Any = thing.obj
        thing.values = {
            name: values
            for name, feature in attributes_of(thing.table)
            if name in obj.__dict__ and (values := attribute_values(obj, feature))
        }
        thing.open = open_features(thing.table, thing.file)
        node = self.models[thing.file].node_of(obj) if thing.open else None
        if node is not None:
            thing.open -= {child.tag for child in node.children}

    def owned_by(self, thing: Thing) -> dict[str, list[EObject]]:
        """Returns what the element of a thing owns of its own file, by the name of the feature."""
        model = self.models[thing.file]
        document = model.documents[0]
        found = {}
        for feature in thing.table.contained:
            children = contents(thing.obj, feature)
            # Others are roots of another file, which this one refers to.
            own = [each for each in children if model.document_of(each) is document]
            if own:
                found[feature.name] = own
        return found

    def pair(self) -> None:
        """Finds the things of elements that were read once more, with another file."""
        for model in self.models.values():
            for document in model.documents[1:]:
                known = self.roots.get(file_of(document, self.folder))
                if known is not None:
                    self._pair(document, known, model)

    def _pair(self, document: Document, roots: list[Thing], model: Model) -> None:
        pending = list(zip(document.roots, roots, strict=False))
        while pending:
            obj, thing = pending.pop()
            self.things[obj] = thing
            for name, owned in thing.owned.items():
                children = contents(obj, thing.table.features[name])
                own = [each for each in children if model.document_of(each) is document]
                pending += zip(own, owned, strict=False)

    def references_of(self, thing: Thing) -> dict[str, list[Thing | Ref]]:
        """Returns what the element of a thing refers to, when all things are there."""
        obj: Any = thing.obj
        model = self.models[thing.file]
        found = {}
        for name, feature in references_of(thing.table):
            if name not in obj.__dict__:
                continue
            targets = contents(obj, feature)
            if feature.kind is FeatureKind.CONTAINMENT:
                owned = {each.obj for each in thing.owned.get(name, ())}
                targets = [each for each in targets if each not in owned]
            if targets:
                found[name] = [self._target(each, model) for each in targets]
        return found

    def _target(self, obj: EObject, model: Model) -> Thing | Ref:
        thing = self.things.get(obj)
        if thing is not None:
            return thing
        # Many refer to the same elements of the library.
        ref = self._foreign.get(obj)
        if ref is None:
            ref = self._foreign[obj] = ref_of(obj, model, self.folder)
        return ref


@cache
def attributes_of(table: ClassTable) -> tuple[tuple[str, FeatureTable], ...]:
    """Returns the attributes of a class with their names."""
    features = table.features.items()
    return tuple(each for each in features if each[1].kind is FeatureKind.ATTRIBUTE)


@cache
def references_of(table: ClassTable) -> tuple[tuple[str, FeatureTable], ...]:
    """Returns the features of a class by which its elements refer to others or own them."""
    kinds = (FeatureKind.CROSS_REFERENCE, FeatureKind.CONTAINMENT)
    return tuple(each for each in table.features.items() if each[1].kind in kinds)


def open_features(table: ClassTable, file: str) -> set[str]:
    """Returns the attributes of a class that a file may leave open, and that then follow."""
    is_open = table.qualified_name == CONNECTION and file.endswith(SUFFIX)
    return set(FEATURES) if is_open else set()


def attribute_values(obj: Any, feature: FeatureTable) -> tuple[str | None, ...]:
    """Returns what an attribute has, as XMI writes it; nothing when that need not be written."""
    texts = tuple(lexical(each, feature) for each in contents(obj, feature))
    if feature.many:
        return texts
    if feature.unsettable:
        return texts or ((None,) if is_set(obj, feature) else ())
    text = texts[0] if texts else None
    return () if text == default_text(feature) else (text,)


@cache
def default_text(feature: FeatureTable) -> str | None:
    """Returns the default of an attribute as XMI writes it, None without one."""
    return lexical(feature.default, feature) if feature.default is not None else None
