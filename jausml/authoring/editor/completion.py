"""Completions: what can stand at a place of a text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

from jausml.authoring.editor.context import (
    Context,
    Part,
    contained_classes,
    context_at,
    features_of,
    keywords,
    table,
)
from jausml.authoring.editor.definition import facts, fields_of, sides_at
from jausml.authoring.editor.names import Declaration
from jausml.authoring.editor.places import Place, start_of
from jausml.authoring.editor.workbench import Workbench, imports_of, names_in
from jausml.language.metamodel import ClassTable, FeatureTable, ValueKind, documentation
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.model.names import qualified_name
from jausml.language.model.values import show
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.text.keywords import keyword_of
from jausml.language.text.reading.imports import library_files, library_maps
from jausml.language.text.reading.parsing import parsed_text
from jausml.language.text.tree import Assignment, Direction, Element, End, Feature, Name
from jausml.language.text.writing.spelling import path as written_path
from jausml.language.text.writing.spelling import word as written_word

UNITS = (
    *("m", "mm", "km", "s", "ms", "Hz", "kg", "N", "N m", "Pa", "K", "V", "A", "W", "J"),
    *("m/s", "m/s^2", "rad", "rad/s", "rad/s^2", "percent", "degree Celsius", "degree"),
    *("meter", "meter per second", "meter per second squared", "radian", "radian per second"),
    *("m^2", "m^3", "T", "lx", "C", "A h", "rpm", "1"),
)
"""Units that are offered; many more can be written."""

_TOP = ("component", "node", "bridge", "host", "placement", "system", "map_library")
_TOP_WORDS = ("import", "struct", *_TOP)
_MAP_WORDS = ("JAUS", "ROS", "JAUS->ROS", "ROS->JAUS", "table", "vector")


Kind: TypeAlias = Literal[
    "Keyword", "Property", "File", "Class", "Field", "Reference", "Function", "Unit", "EnumMember"
]
"""Kinds of completions by the Language Server Protocol 3.17 (`CompletionItemKind`)."""


@dataclass(frozen=True, slots=True)
class Completion:
    """An element, a name or a word that can stand at a place.

    Attributes:
        text: What is written, when that is not the label.
        module: What is imported with it, as a text writes it; empty for nothing.
        is_first: Whether it goes better than others with what stands around.
    """

    label: str
    kind: Kind
    detail: str = ""
    documentation: str = ""
    text: str = ""
    module: str = ""
    is_first: bool = False


@dataclass(frozen=True, slots=True)
class CompletionList:
    """One completion: something that can stand at a place."""

    start: Place
    end: Place
    completions: tuple[Completion, ...]
    imports_end: Place


def complete(bench: Workbench, path: Path, place: Place) -> CompletionList:
    """Returns the completions at a place."""
    text = bench.text(path)
    context = context_at(text, parsed_text(text), place)
    completions = _OFFERS.get(context.part, _nothing)(bench, path, context)
    offered: dict[tuple[str, str], Completion] = {}
    for completion in completions:
        offered.setdefault((completion.label, completion.module), completion)
    imports = imports_of(bench.tree(path))
    end = Place(imports[-1].span.end_line + 1 if imports else 1, 1)
    return CompletionList(context.start, context.end, tuple(offered.values()), end)


def _nothing(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:  # noqa: ARG001
    yield from ()


def _item(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:  # noqa: ARG001
    if context.item is None:
        yield from (_keyword(top_word) for top_word in _TOP_WORDS)
    elif context.item is context.map:
        yield from (Completion(map_word, "Keyword") for map_word in _MAP_WORDS)
    if context.table is not None:
        yield from (
            _keyword(keyword_of(contained.name)) for contained in contained_classes(context.table)
        )
    yield from map(_feature, features_of(context.item, context.table).values())


def _keyword(word: str) -> Completion:
    known = keywords().get(word)
    return Completion(word, "Keyword", "", documentation(known.eclass) if known else "")


def _feature(feature: FeatureTable) -> Completion:
    name = feature.name
    kind = feature.type_name.rpartition(".")[2]
    return Completion(name, "Property", kind, documentation(feature.feature), f"{name}: ")


def _import(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:  # noqa: ARG001
    yield from (Completion(written_word(library), "File") for library in library_files())


def _jaus_type(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:  # noqa: ARG001
    for element in bench.elements(path, jaus.MessageDef):
        service = getattr(element.eContainer(), "name", "") or ""
        detail = f"{element.code} {service}".strip()
        name = written_word(element.name or "")
        yield Completion(
            name, "Class", detail, element.documentation or "", module=bench.file_of(path, element)
        )


def _ros_type(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:  # noqa: ARG001
    for element in bench.elements(path, ros.MessageType):
        package = getattr(element.eContainer(), "name", None)
        if package and element.name:
            name = written_word(f"{package}/{element.name}")
            yield Completion(
                name, "Class", "", element.documentation or "", module=bench.file_of(path, element)
            )


def _member(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:
    end = context.around(End)
    if not isinstance(end, End):
        return
    sides = sides_at(bench, path, context)
    for field in fields_of(sides.target if end.is_jaus else sides.source):
        path_place = sides.follow(field.name, is_source=not end.is_jaus)
        detail = ", ".join(facts(path_place.attribute())) if path_place is not None else ""
        yield Completion(written_word(field.name), "Field", detail)


def _path(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:
    is_source = context.part is Part.SOURCE
    sides = sides_at(bench, path, context)
    if not context.word and is_source and context.around(Direction) is not None:
        yield from (Completion(keyword, "Keyword") for keyword in ("ignore", "clock"))
    if is_source:
        yield from (Completion(join, "Reference", "join") for join in sides.joins)
        if isinstance(context.item, Assignment):
            yield from map(_feature, features_of(context.item, None).values())
    before, _, _ = context.word.rpartition(".")
    for field in fields_of(sides.follow(before or ".", is_source=is_source)):
        name = f"{before}.{field.name}" if before else field.name
        path_place = sides.follow(name, is_source=is_source)
        detail = ", ".join(facts(path_place.attribute())) if path_place is not None else ""
        said = field.documentation or ""
        yield Completion(written_path(name), "Field", detail, said)


def _conversion(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:  # noqa: ARG001
    for conversion in CONVERSIONS.values():
        shown = (conversion.signature, conversion.documentation)
        yield Completion(conversion.name, "Function", *shown)


def _argument(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:
    conversion = CONVERSIONS.get(context.about)
    for argument in conversion.arguments[:1] if conversion is not None else ():
        if argument.refers_to:
            yield from _declared(bench, path, table(argument.refers_to), context)
        elif argument.feature == "units":
            yield from _units(context)


def _units(context: Context) -> Iterator[Completion]:
    for unit in UNITS:
        yield Completion(unit, "Unit", text=unit if context.in_text else f'"{unit}"')


def _value(bench: Workbench, path: Path, context: Context) -> Iterator[Completion]:
    feature = features_of(context.item, context.table).get(context.about)
    if context.about == "units":
        yield from _units(context)
    if feature is None or context.in_text:
        return
    if feature.data_type is not None:
        yield from _literals(feature)
    elif feature.target is not None:
        if feature.target is table("bridge.AttributeMap"):
            yield from map(_reference, maps(bench, path, context))
        yield from _declared(bench, path, feature.target, context)
        if feature.target is table("jaus.Service"):
            yield from map(_reference, services(bench, path))
        elif feature.target is table("jaus.MessageDef"):
            yield from _jaus_type(bench, path, context)
        elif feature.target is table("ros.MessageType"):
            yield from _ros_type(bench, path, context)


def _reference(candidate: Candidate) -> Completion:
    name = written_path(candidate.name)
    return Completion(
        name, "Reference", candidate.detail, module=candidate.module, is_first=candidate.fits
    )


def _literals(feature: FeatureTable) -> Iterator[Completion]:
    data_type = feature.data_type
    if data_type is not None and data_type.kind is ValueKind.BOOLEAN:
        yield from (Completion(word, "EnumMember") for word in ("true", "false"))
    for word in data_type.legal if data_type is not None else ():
        literal = data_type.literals[word] if data_type is not None else None
        default = " (default)" if literal is not None and literal == feature.default else ""
        yield Completion(written_word(word), "EnumMember", default.strip(), documentation(literal))


def _declared(
    bench: Workbench, path: Path, wanted: ClassTable, context: Context
) -> Iterator[Completion]:
    """Yields the names of a class that the text and its imports declare."""
    for file in (path, *bench.imports(path)):
        for declaration in names_in(bench.text(file)).declared(wanted):
            if _is_visible(declaration, context):
                detail = f"{keyword_of(declaration.table.name)} in {show(file.name)}"
                yield Completion(written_path(declaration.name.text), "Reference", detail)


def _is_visible(declaration: Declaration, context: Context) -> bool:
    """Tells whether a name can be meant by itself: tables and the like only in their map."""
    owned = declaration.table in (table("bridge.ValueTable"), table("bridge.Quantity"))
    around = [start_of(level.item.span) for level in context.levels if level.item is not None]
    return not owned or all(start_of(owner.span) in around for owner in declaration.owners)


_OFFERS = {
    Part.ITEM: _item,
    Part.IMPORT: _import,
    Part.JAUS_TYPE: _jaus_type,
    Part.ROS_TYPE: _ros_type,
    Part.MEMBER: _member,
    Part.SOURCE: _path,
    Part.TARGET: _path,
    Part.CONVERSION: _conversion,
    Part.ARGUMENT: _argument,
    Part.VALUE: _value,
}


@dataclass(frozen=True, slots=True)
class Candidate:
    """An element that a reference can name.

    `module`: what the text must import first, empty when it knows the name.
    """

    name: str
    detail: str
    module: str = ""
    fits: bool = False


def services(bench: Workbench, path: Path) -> Iterator[Candidate]:
    """Yields the services that a text can name.

    Those that the library has in several versions need an import that says which.
    """
    imported = _imported(bench, path)
    named: dict[str, list[jaus.Service]] = {}
    for element in bench.elements(path, jaus.Service):
        named.setdefault(element.name or "", []).append(element)
    for name, versions in named.items():
        module_of = bench.module_of if len(versions) > 1 else bench.file_of
        modules = [module_of(path, candidate) for candidate in versions]
        known = [pair for pair in zip(versions, modules, strict=True) if pair[1] in {"", *imported}]
        for service, module in known[:1] or zip(versions, modules, strict=True):
            detail = f"{qualified_name(service)} {service.version or ''}".strip()
            yield Candidate(name, detail, "" if known else module)


def maps(bench: Workbench, path: Path, context: Context) -> Iterator[Candidate]:
    """Yields the maps of the library for a connection: first those of its services."""
    imported = _imported(bench, path)
    wanted = _messages_around(bench, path, context)
    for library_map in library_maps():
        module = "" if library_map.module in imported else library_map.module
        detail = f"{library_map.message}, {library_map.type}"
        yield Candidate(library_map.name, detail, module, library_map.message in wanted)


def _imported(bench: Workbench, path: Path) -> set[str]:
    items = imports_of(bench.tree(path))
    return {item.target.text for item in items if isinstance(item.target, Name)}


def _messages_around(bench: Workbench, path: Path, context: Context) -> set[str]:
    """Returns the names of the messages that the bridge and its peers have around a place."""
    blocks = [level.item for level in context.levels if isinstance(level.item, Element)]
    named = {name for block in blocks for name in _values(block, ("provides", "uses", "services"))}
    peers = {name for block in blocks for name in _values(block, ("peers",))}
    for item in bench.tree(path).items:
        if isinstance(item, Element) and item.name is not None and item.name.text in peers:
            named |= set(_values(item, ("provides",)))
    steps = {service_path.rpartition(".")[2] for service_path in named}
    known = [element for element in bench.elements(path, jaus.Service) if element.name in steps]
    return {
        str(message.name)
        for service in with_inherited(known)
        for message in (*service.inputs, *service.outputs)
    }


def _values(block: Element, features: Iterable[str]) -> Iterator[str]:
    for item in block.items:
        if isinstance(item, Feature) and item.name.text in features:
            yield from (value.text for value in item.values if isinstance(value, Name))
