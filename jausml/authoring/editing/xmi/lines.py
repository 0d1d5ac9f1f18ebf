"""Lines of new elements: those that the writer of models would write."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind
from jausml.language.model.xmi.writer import attribute_text, element_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.authoring.editing.forest import Thing
    from jausml.authoring.editing.xmi.edits import Line
    from jausml.authoring.editing.xmi.names import Names
    from jausml.language.metamodel import FeatureTable
    from jausml.language.model.refs import Ref


def element_lines(thing: Thing, feature: FeatureTable, names: Names) -> list[Line]:
    """Returns the lines of an element with all that it owns."""
    return list(_lines(thing, feature, names, 0))


def value_line(text: str | None, feature: FeatureTable, names: Names) -> str:
    """Returns a value of an attribute as an element."""
    if text is None:
        return f'<{feature.name} {names.xsi()}:nil="true"/>'
    return f"<{feature.name}>{element_text(text)}</{feature.name}>"


def reference_line(target: Thing | Ref, feature: FeatureTable, names: Names) -> str:
    """Returns a reference as an element."""
    kind = names.type_attribute(target, feature)
    return f'<{feature.name}{kind} href="{attribute_text(names.href(target))}"/>'


def _lines(thing: Thing, feature: FeatureTable, names: Names, depth: int) -> Iterator[Line]:
    head = f"<{feature.name}{names.type_attribute(thing, feature)}"
    if thing.identifier:
        head += f' {names.xmi()}:id="{attribute_text(thing.identifier)}"'
    inner: list[Line] = []
    for each in thing.table.features.values():
        text = _as_attribute(thing, each, names)
        if text is not None:
            head += f' {each.name}="{attribute_text(text)}"'
        else:
            inner += _children(thing, each, names, depth + 1)
    if not inner:
        yield (depth, f"{head}/>")
        return
    yield (depth, f"{head}>")
    yield from inner
    yield (depth, f"</{feature.name}>")


def _as_attribute(thing: Thing, feature: FeatureTable, names: Names) -> str | None:
    """Returns what a feature has as the value of an XML attribute, None for elements."""
    if feature.kind is FeatureKind.ATTRIBUTE:
        values = thing.values.get(feature.name, ())
        return values[0] if values and not feature.many else None
    targets = thing.references.get(feature.name, [])
    if feature.kind is not FeatureKind.CROSS_REFERENCE or not targets:
        return None
    if not all(map(names.is_local, targets)):
        return None
    return " ".join(map(names.fragment, targets))


def _children(thing: Thing, feature: FeatureTable, names: Names, depth: int) -> Iterator[Line]:
    for text in thing.values.get(feature.name, ()):
        yield (depth, value_line(text, feature, names))
    for target in thing.references.get(feature.name, ()):
        yield (depth, reference_line(target, feature, names))
    for each in thing.owned.get(feature.name, ()):
        yield from _lines(each, feature, names, depth)
