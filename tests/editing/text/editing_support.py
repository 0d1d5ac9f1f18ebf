"""Texts that are edited by plans: random commands, and what they shall do."""

import difflib
import random
import re
from pathlib import Path

from jausml.authoring.editing.commands import Add, Child, Move, Movement, Remove, Rename, Set
from jausml.authoring.editing.project import Project
from jausml.authoring.editing.reading import NOTATIONS
from jausml.language.metamodel import FeatureKind, ValueKind
from jausml.language.metamodel.filling import contents
from jausml.language.model import read_models, refs
from jausml.language.model.comparison import Policy, compare
from jausml.language.model.values import convert

HOSTILE = (
    "plain",
    "two words",
    'quo"ted',
    "back`quote",
    "} // */ /* {",
    "a -> b",
    "line\nbreak",
    "<script>alert(1)</script>",
    "naïve ☃ 𝔘",
    "import",
    "new",
    "0x10",
    "true",
    "tab\there",
    "\\n",
    ";",
    "a.b/c",
    "ends with ]",
    "[3]",
    "   ",
    "",
)
DERIVED = Policy(ignored=frozenset({"direction", "exchange"}))
"""What follows from the rest of a text unless it is stated may follow an edit."""


class Edited:
    """A model file that is edited.

    Args:
        path: The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()
        self.project = Project(path)
        self.first = path.read_bytes()

    @property
    def data(self) -> bytes:
        """What is stored."""
        return self.path.read_bytes()

    @property
    def model(self):
        """What the project has read of it."""
        return self.project.model(self.path.name).model

    @property
    def root(self):
        """The first root element."""
        return self.model.root

    def read(self):
        """Reads the file anew."""
        root = self.path.parent
        return read_models([self.path], project_root=root, notations=NOTATIONS).model

    def ref(self, obj) -> str:
        return refs.ref_of(obj, self.model, self.path.parent)

    def do(self, *commands) -> str:
        """Carries out commands and returns the text."""
        self.project.do(commands, "edit")
        return self.data.decode("utf-8-sig")

    def undo_all(self) -> bytes:
        """Takes all back."""
        while self.project.undo() is not None:
            pass
        return self.data

    def differences(self, *commands) -> list[str]:
        """Carries out commands; returns where the model is not what they mean."""
        wanted = self.read()
        for command in commands:
            Meaning(wanted, self.path.parent).apply(command)
        self.do(*commands)
        model = self.read()
        ours, theirs = wanted.documents[0].roots, model.documents[0].roots
        assert len(ours) == len(theirs)
        found = []
        for one, other in zip(ours, theirs, strict=True):
            found += compare(one, other, wanted.metamodels, DERIVED)
        return [str(difference) for difference in found]

    def changed_lines(self, old: bytes) -> list[str]:
        """Returns the lines that a diff against earlier bytes shows."""
        lines = (content.decode("utf-8-sig").splitlines() for content in (old, self.data))
        diff = difflib.unified_diff(*lines, n=0, lineterm="")
        return [line for line in diff if line[0] in "+-" and line[:3] not in ("+++", "---")]


class Meaning:
    """What commands mean for a model, done by the setters of pyecore."""

    def __init__(self, model, root: Path) -> None:
        self._model, self._root = model, root

    def apply(self, command) -> None:
        if isinstance(command, Set):
            self._set(self._find(command.element), command.feature, command.values)
        elif isinstance(command, Rename):
            self._find(command.element).name = command.name
        elif isinstance(command, Remove):
            self._take(self._find(command.element))
        elif isinstance(command, Move):
            moves = [
                (self._find(move.element), self._find(move.owner), move)
                for move in command.single_moves
            ]
            for obj, owner, move in moves:
                self._take(obj)
                self._own(owner, move.feature, obj, move.position)
        elif isinstance(command, Add):
            owner = self._find(command.owner)
            self._own(owner, command.feature, self._made(command), command.position)

    def _made(self, command):
        obj = self._model.metamodels.classes[command.kind].python_class()
        for name, values in command.values.items():
            self._set(obj, name, values)
        for child in command.children:
            self._own(obj, child.feature, self._made(child), None)
        return obj

    def _set(self, obj, name, values) -> None:
        feature = self._model.metamodels.class_of(obj).features[name]
        if feature.is_reference:
            found = [self._find(value) for value in values]
        else:
            found = [convert(value, feature.data_type)[0] for value in values]
        if feature.many:
            getattr(obj, name).clear()
            for value in found:
                getattr(obj, name).append(value)
        else:
            setattr(obj, name, found[0] if found else feature.default)

    def _own(self, owner, name, obj, position) -> None:
        feature = self._model.metamodels.class_of(owner).features[name]
        if not feature.many:
            setattr(owner, name, obj)
            return
        values = getattr(owner, name)
        values.insert(len(values) if position is None else position, obj)

    @staticmethod
    def _take(obj) -> None:
        owner, name = obj.eContainer(), obj.eContainmentFeature().name
        value = getattr(owner, name)
        if value is obj:
            setattr(owner, name, None)
        else:
            value.remove(obj)

    def _find(self, ref):
        found = refs.find(ref, self._model, self._root)
        assert found is not None, ref
        return found


class Commands:
    """Random commands for a text, which make sense more often than not."""

    def __init__(self, edited: Edited, seed: int) -> None:
        self._edited = edited
        self._random = random.Random(seed)

    def one(self):
        """Returns a command."""
        kinds = (self._set, self._set, self._set, self._add, self._add, self._remove, self._move)
        while True:
            command = self._random.choice((*kinds, self._rename))()
            if command is not None:
                return command

    @property
    def _model(self):
        return self._edited.model

    def _element(self):
        document = self._model.documents[0]
        found = list(self._model.elements_of(document))
        return self._random.choice(found)

    def _table(self, obj):
        return self._model.metamodels.class_of(obj)

    def _set(self):
        obj = self._element()
        plain = (FeatureKind.ATTRIBUTE, FeatureKind.CROSS_REFERENCE)
        features = [
            structural_feature
            for structural_feature in self._table(obj).features.values()
            if structural_feature.settable and structural_feature.kind in plain
        ]
        features = [feature for feature in features if feature.name != "name"]
        if not features:
            return None
        feature = self._random.choice(features)
        values = () if self._random.random() < 0.2 else self._values(feature)
        return Set(self._edited.ref(obj), feature.name, values)

    def _values(self, feature):
        if feature.is_reference:
            known = self._model.instances(feature.target.python_class)
            count = self._random.randint(1, 3) if feature.many else 1
            chosen = [self._random.choice(known) for _ in range(count)] if known else []
            return tuple(dict.fromkeys(self._edited.ref(element) for element in chosen))
        count = self._random.randint(1, 3) if feature.many else 1
        values = (self._value(feature) for _ in range(count))
        return tuple(dict.fromkeys(value for value in values if value is not None))

    def _value(self, feature):
        kind = feature.data_type.kind
        if kind is ValueKind.ENUMERATION:
            return self._random.choice(feature.data_type.legal)
        if kind is ValueKind.BOOLEAN:
            return self._random.choice(("true", "false"))
        if kind is ValueKind.INTEGER:
            return str(self._random.randint(0, 200))
        if kind is ValueKind.REAL:
            return self._random.choice(("1.5", "-2.0E-9", "0.0", "100.0"))
        for _ in range(20):
            text = self._random.choice(HOSTILE)
            if convert(text, feature.data_type)[1] is None:
                return text
        return self._random.choice(("1.2.3", "a_b"))

    def _made(self, table, depth=0):
        values, children = {}, []
        for feature in table.features.values():
            if not feature.settable or feature.kind is FeatureKind.CONTAINER:
                continue
            if not feature.lower and self._random.random() < 0.8:
                continue
            if feature.kind is FeatureKind.CONTAINMENT:
                kinds = [subtype for subtype in feature.target.subtypes if not subtype.abstract]
                if depth < 3 and kinds:
                    kinds.sort(key=lambda metaclass: metaclass.qualified_name)
                    kind = self._random.choice(kinds)
                    inner, owned = self._made(kind, depth + 1)
                    children.append(Child(feature.name, kind.qualified_name, inner, owned))
            else:
                given = self._values(feature)
                if given:
                    values[feature.name] = given
        return values, tuple(children)

    def _add(self):
        owner = self._element()
        features = [
            structural_feature
            for structural_feature in self._table(owner).features.values()
            if structural_feature.kind is FeatureKind.CONTAINMENT
            and (structural_feature.many or not contents(owner, structural_feature))
        ]
        if not features:
            return None
        feature = self._random.choice(features)
        kinds = [subtype for subtype in feature.target.subtypes if not subtype.abstract]
        kinds.sort(key=lambda metaclass: metaclass.qualified_name)
        kind = self._random.choice(kinds)
        values, children = self._made(kind)
        count = len(contents(owner, feature))
        position = self._random.choice((None, self._random.randint(0, count)))
        position = position if feature.many else None
        ref = self._edited.ref(owner)
        return Add(ref, feature.name, kind.qualified_name, values, children, position)

    def _remove(self):
        obj = self._element()
        if obj.eContainer() is None or self._is_referred_to(obj):
            return None
        return Remove(self._edited.ref(obj))

    def _is_referred_to(self, obj) -> bool:
        gone = {obj, *obj.eAllContents()}
        for element in self._model.elements_of(self._model.documents[0]):
            for feature in self._table(element).features.values():
                is_reference = feature.kind is FeatureKind.CROSS_REFERENCE
                if is_reference and element not in gone and gone & set(contents(element, feature)):
                    return True
        return False

    def _move(self):
        obj = self._element()
        owner = obj.eContainer()
        if owner is None:
            return None
        feature = obj.eContainmentFeature().name
        others = [
            element
            for element in self._model.elements_of(self._model.documents[0])
            if element.eClass is owner.eClass and element is not owner
        ]
        if others and self._random.random() < 0.3:
            owner = self._random.choice(others)
        table = self._table(owner).features[feature]
        if not table.many:
            return None
        count = len(getattr(owner, feature)) - (owner is obj.eContainer())
        position = self._random.choice((None, self._random.randint(0, count)))
        beside = [e for e in getattr(obj.eContainer(), feature) if e is not obj]
        also = ()
        if beside and self._random.random() < 0.3:
            another = self._edited.ref(self._random.choice(beside))
            also = (Movement(another, self._edited.ref(owner), feature, position),)
        return Move(self._edited.ref(obj), self._edited.ref(owner), feature, position, also)

    def _rename(self):
        obj = self._element()
        if "name" not in self._table(obj).features:
            return None
        name = self._random.choice(("renamed", "two words", "x1", "import", "naïve"))
        return Rename(self._edited.ref(obj), f"{name}{self._random.randint(1, 99)}")


def loosened(text: str) -> str:
    """Returns a text with other blanks, line breaks and comments, which means the same."""
    lines = []
    for number, line in enumerate(text.splitlines()):
        bare = line.strip()
        if bare.startswith(("*", "/*", "//")) or not bare:
            lines.append(line)
            continue
        if number % 7 == 3 and bare.endswith(("{", "(")):
            line += "  // opens"  # noqa: PLW2901
        elif number % 11 == 5:
            line += " /* beside */"  # noqa: PLW2901
        elif number % 13 == 7 and bare[-1] not in "{(}),":
            line = line.replace(": ", " :   ", 1)  # noqa: PLW2901
        if number % 17 == 2 and bare[0] not in "})" and "=>" not in bare:
            lines.append(f"{line[: len(line) - len(line.lstrip())]}// above {number}")
        lines.append(line)
    return "\n".join(lines) + "\n"


def dense(text: str) -> str:
    """Returns a text without line comments on as few lines as it can have, roughly."""
    if "//" in text:
        text = re.sub(r"^ *//.*\n", "", text, flags=re.MULTILINE)
    return re.sub(
        r"\n +(?=[\w})])(?!\* )", lambda match: " " if match.start() % 3 else match.group(), text
    )
