"""Scopes of names in JSIDL: sets of types and constants, the references to them, and expressions.

Numbers are exact fractions, so that limits of 64-bit integers keep their last digit.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from jausml.language.attributes.cursor import Language, TokenCursor
from jausml.language.importers.findings import ImportFindings
from jausml.language.model.diagnostics import Related
from jausml.language.model.documents import Document
from jausml.language.model.reading.problems import NodePlace
from jausml.language.model.values import show, suggest
from jausml.language.model.xmi.parsing import Node

LONGEST = 1000
"""Characters of an expression; more is none that a person wrote."""
DEEPEST = 50
"""Signs and parentheses within each other."""
_LARGEST_EXPONENT = 400

_NUMBER = re.compile(r"(?:[0-9]+|[0-9]{1,3}(?:,[0-9]{3})+)?\.?[0-9]*(?:[eE]([+-]?[0-9]+))?")

Lookup = Callable[[str], Fraction]
"""Returns the value of a constant by its dotted name; raises NumberError."""


class NumberError(ValueError):
    """A text is no expression, or has no value; the message says of the text why."""


def _malformed(message: str, column: int) -> NumberError:
    return NumberError(f"is no expression: {message} at column {column}")


_LANGUAGE = Language(
    noun="expression",
    tokens=re.compile(
        r"\s*(?:(?P<number>(?:[0-9][0-9,]*\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
        r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\s*\.\s*[A-Za-z_][A-Za-z0-9_]*)*)"
        r"|(?P<sign>[-+*/()]))"
    ),
    error=_malformed,
    longest=LONGEST,
    deepest=DEEPEST,
)


def evaluate(text: str, constant: Lookup) -> Fraction:
    """Returns the value of an expression.

    Raises:
        NumberError: The text is no expression, divides by zero or is out of all bounds.
    """
    if not text.strip():
        raise NumberError("is empty")
    return _Parser(text, constant).whole()


class _Parser:
    """Recursive descent over the tokens, which computes as it reads."""

    def __init__(self, text: str, constant: Lookup) -> None:
        self._cursor = TokenCursor(text, _LANGUAGE)
        self._constant = constant

    def whole(self) -> Fraction:
        value = self._total()
        self._cursor.expect_end()
        return value

    def _total(self) -> Fraction:
        value = self._product()
        while sign := self._cursor.take("+", "-"):
            right = self._product()
            value = value + right if sign == "+" else value - right
        return value

    def _product(self) -> Fraction:
        value = self._factor()
        while sign := self._cursor.take("*", "/"):
            right = self._factor()
            if sign == "/" and not right:
                raise NumberError("divides by zero")
            value = value * right if sign == "*" else value / right
            _check_size(value)
        return value

    def _factor(self) -> Fraction:
        cursor = self._cursor
        if sign := cursor.take("+", "-"):
            value = cursor.nested(self._factor)
            return -value if sign == "-" else value
        if cursor.take("("):
            return cursor.parenthesized(self._total)
        if cursor.token.kind == "number":
            return _number(cursor.advance().text)
        if cursor.token.kind == "name":
            return self._constant("".join(cursor.advance().text.split()))
        raise cursor.error(f"a value is missing before {cursor.token}")


def _number(text: str) -> Fraction:
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise NumberError(f"has '{text}', whose commas do not part thousands")
    exponent = match.group(1) or "0"
    if len(exponent) > 4 or abs(int(exponent)) > _LARGEST_EXPONENT:
        raise NumberError(f"has '{text}', which is out of all bounds")
    return Fraction(text.replace(",", ""))


def _check_size(value: Fraction) -> None:
    if max(value.numerator.bit_length(), value.denominator.bit_length()) > 20_000:
        raise NumberError("is out of all bounds")


_SETS = ("declared_type_set", "declared_const_set")
_MESSAGE_SETS = ("message_set", "input_set", "output_set", "internal_events_set")
_DEEPEST_CONSTANT = 20
_REFERENCES = tuple(f"{kind}_ref" for kind in _SETS)


@dataclass(eq=False, slots=True)
class Scope:
    """A service, a set of types or a set of constants, with the names in it.

    Attributes:
        outer: The service around a set of its own, else None.
        sets: Sets by the name with which a dotted path names them; None for a set that is missing,
            which was reported.
    """

    place: NodePlace
    outer: Scope | None = None
    declarations: dict[str, NodePlace] = field(default_factory=dict)
    sets: dict[str, Scope | None] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Its name for messages."""
        return f"{self.place.node.tag} {show(self.place.node.get('name') or '')}"


@dataclass(frozen=True, slots=True)
class Declaration:
    """A declared type, message or constant, and the scope in which its own names are looked up."""

    scope: Scope
    place: NodePlace


class MissingError(LookupError):
    """A path leads to nothing.

    Attributes:
        is_known: True when the cause was reported already.
    """

    def __init__(self, message: str, hint: str = "", *, is_known: bool = False) -> None:
        super().__init__(message)
        self.hint = hint
        self.is_known = is_known


class Scopes:
    """The scopes of all files."""

    def __init__(self, findings: ImportFindings) -> None:
        self._findings = findings
        self._by_id: dict[str, dict[str, dict[str, Scope]]] = {kind: {} for kind in _SETS}
        self._all: list[Scope] = []
        self._used: set[NodePlace] = set()
        self._evaluating: list[NodePlace] = []
        self.services: list[Scope] = []

    def add(self, document: Document, root: Node) -> None:
        """Adds the sets and services of a file."""
        pending = [root]
        while pending:
            node = pending.pop(0)
            if node.tag == "service_set":
                pending += node.children
            elif node.tag == "service_def":
                self._add_service(NodePlace(document, node))
            elif node.tag in _SETS:
                self._add_set(NodePlace(document, node), None)

    def _add_service(self, place: NodePlace) -> None:
        service = Scope(place)
        self.services.append(service)
        for child in place.node.children:
            if child.tag in _SETS:
                own = self._add_set(NodePlace(place.document, child), service)
                service.sets.setdefault(child.get("name") or "", own)

    def _add_set(self, place: NodePlace, outer: Scope | None) -> Scope:
        scope = Scope(place, outer)
        self._all.append(scope)
        for child in place.node.children:
            name = child.get("name")
            if child.tag in _REFERENCES or child.tag == "description" or not name:
                continue
            first = scope.declarations.setdefault(name, NodePlace(place.document, child))
            if first.node is not child:
                self._report_twice(NodePlace(place.document, child), first, f"{show(name)}")
        identifier, version = place.node.get("id"), place.node.get("version")
        if identifier and version:
            versions = self._by_id[place.node.tag].setdefault(identifier, {})
            first_set = versions.setdefault(version, scope)
            if first_set is not scope:
                what = f"<{place.node.tag}> {identifier} version {version}"
                self._report_twice(place.at("id"), first_set.place, what)
        return scope

    def _report_twice(self, place: NodePlace, first: NodePlace, what: str) -> None:
        related = (Related(first.location, "the first declaration"),)
        self._findings.report("JML606", place, f"{what} is declared twice", related=related)

    def link(self) -> None:
        """Finds the sets that references name, once all files are there."""
        for scope in self._all:
            for child in scope.place.node.children:
                if child.tag in _REFERENCES:
                    place = NodePlace(scope.place.document, child)
                    target = self._find_set(place)
                    scope.sets.setdefault(child.get("name") or "", target)
        for service in self.services:
            # A service sees what its own sets see.
            for own in [set_scope for set_scope in service.sets.values() if set_scope is not None]:
                for name, target in own.sets.items():
                    service.sets.setdefault(name, target)
                for name, place in own.declarations.items():
                    service.declarations.setdefault(name, place)

    def _find_set(self, place: NodePlace) -> Scope | None:
        node = place.node
        kind = node.tag.removesuffix("_ref")
        identifier, version = node.get("id") or "", node.get("version") or ""
        if not identifier or not version:
            return None  # reported as missing
        versions = self._by_id[kind].get(identifier)
        if versions is None:
            message = f"no file declares <{kind}> {identifier}"
            hint = suggest(identifier, self._by_id[kind])
            hint = hint or "give the importer the file or folder that does, too"
            self._findings.report("JML607", place.at("id"), message, hint)
            return None
        chosen_version = pick_version(version, versions)
        if chosen_version != version and not matches(version, chosen_version):
            message = f"{identifier} is there in version {chosen_version}, not {version}"
            self._findings.report(
                "JML620", place.at("version"), message, f"{chosen_version} was taken"
            )
        return versions[chosen_version]

    def find(self, scope: Scope, path: str) -> Declaration:
        """Returns the declaration that a dotted path means in a scope."""
        *sets, name = path.split(".")
        at: Scope | None = scope
        for step in sets:
            at = self._step(at, step, path)
        while at is not None:
            place = at.declarations.get(name)
            if place is not None:
                self._used.add(place)
                return Declaration(at, place)
            if at.outer is None or sets:
                break
            at = at.outer
        if at is None:
            raise MissingError(path, is_known=True)
        raise MissingError(
            f"{show(path)} leads to no declaration: {at.name} has no {show(name)}",
            suggest(name, at.declarations),
        )

    def _step(self, at: Scope | None, step: str, path: str) -> Scope | None:
        known: set[str] = set()
        outer = at
        while outer is not None:
            if step in outer.sets:
                return outer.sets[step]
            known |= outer.sets.keys()
            outer = outer.outer
        if at is None:
            return None
        message = f"{show(path)} leads to no declaration: {at.name} refers to no set {show(step)}"
        raise MissingError(message, suggest(step, known))

    def constant(self, scope: Scope, path: str) -> Fraction:
        """Returns the value of a constant.

        Raises:
            NumberError: There is no such constant, or it has no value.
        """
        try:
            declaration = self.find(scope, path)
        except MissingError as error:
            if error.is_known:
                raise
            hint = f" ({error.hint})" if error.hint else ""
            raise NumberError(f"has an unknown constant: {error}{hint}") from error
        node = declaration.place.node
        if node.tag != "const_def":
            raise NumberError(f"has '{path}', which is a {node.tag} and no constant")
        if declaration.place in self._evaluating:
            raise NumberError(f"needs itself by the constant '{path}'")
        if len(self._evaluating) > _DEEPEST_CONSTANT:
            raise NumberError("is nested too deeply in constants")
        self._evaluating.append(declaration.place)
        try:
            return self.number(declaration.scope, node.get("const_value") or "")
        except NumberError as error:
            raise NumberError(f"has '{path}', whose value {error}") from error
        finally:
            self._evaluating.pop()

    def number(self, scope: Scope, text: str) -> Fraction:
        """Returns the value of an expression."""
        return evaluate(text, lambda path: self.constant(scope, path))

    def declared_names(self) -> frozenset[str]:
        """Returns the names of the messages and events in the services of all files."""
        names = set()
        pending = [scope.place.node for scope in self.services]
        while pending:
            node = pending.pop()
            pending += [child for child in node.children if child.tag in _MESSAGE_SETS]
            if node.tag.removeprefix("declared_") in ("message_def", "event_def"):
                names.add(node.get("name") or "")
            elif node.tag in _MESSAGE_SETS:
                pending += node.children
        return frozenset(names)

    def unused(self) -> Iterator[tuple[Scope, NodePlace]]:
        """Yields the declared types that nothing referred to, with the scopes of their names."""
        for scope in self._all:
            if scope.place.node.tag == "declared_type_set":
                for place in scope.declarations.values():
                    if place not in self._used:
                        yield scope, place


def pick_version(wanted: str, versions: Iterable[str]) -> str:
    """Returns the version of something that is there which fits best."""
    known = sorted(versions, key=_version_key)
    fitting = [version for version in known if matches(wanted, version)]
    return (fitting or known)[-1]


def matches(wanted: str, version: str) -> bool:
    """Tells whether a version matches a wanted one, in which `*` stands for any text."""
    if "*" not in wanted:
        return wanted == version
    start, *middle, end = wanted.split("*")
    if not (version.startswith(start) and version.endswith(end)):
        return False
    rest = version[len(start) : len(version) - len(end)]
    for part in middle:
        _, separator, rest = rest.partition(part) if part else ("", "*", rest)
        if not separator:
            return False
    return len(version) >= len(start) + len(end)


def _version_key(version: str) -> tuple[list[int], str]:
    return [int(part[:9]) for part in re.findall("[0-9]+", version)], version
