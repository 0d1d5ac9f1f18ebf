"""Comparison of what was read of changed files with what commands mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.forest import Forest

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from jausml.authoring.editing.forest import Thing
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model


def renewed(wanted: Forest, models: Mapping[str, Model], changed: Collection[Thing]) -> Forest:
    """Returns the forest of what was read of changed files, made of the things that are meant.

    Args:
        wanted: A forest that a command was applied to. Its things become those of what was read.

    Raises:
        EditError: Something else was read than is meant; the forest is worth nothing any more.
    """
    read = Forest(models, wanted.folder)
    for file, roots in wanted.roots.items():
        found = models[file].documents[0].roots
        if len(roots) != len(found):
            raise _different(file, f"{len(roots)} and {len(found)} roots")
        read.roots[file] = roots
        pending = list(zip(roots, found, strict=True))
        while pending:
            thing, obj = pending.pop()
            _renew(thing, obj, file, wanted, read, is_changed=thing in changed)
            pending += _children(thing, read)
    read.pair()
    for thing in read.everything():
        _compare_references(thing, read)
    return read


def _renew(
    thing: Thing, obj: EObject, file: str, wanted: Forest, read: Forest, *, is_changed: bool
) -> None:
    """Makes an element that was read that of a thing, if it has the values that are meant."""
    model = read.models[file]
    if model.metamodels.class_of(obj) is not thing.table:
        raise _different(thing, "is another element")
    if thing.identifier != (model.identifier(obj) or ""):
        raise _different(thing, "is another element")
    is_written_alike = not is_changed and _is_written_alike(thing, obj, wanted, model)
    read.hold(thing, obj, file)
    if not is_written_alike:
        meant, open_names = thing.values, thing.open
        read.take_values(thing)
        if meant != thing.values and _stated(meant, open_names) != _stated(
            thing.values, open_names
        ):
            raise _different(thing, f"has {thing.values}, not {meant}")


def _is_written_alike(thing: Thing, obj: EObject, wanted: Forest, model: Model) -> bool:
    """Tells whether all values of an element are written as they were before the command.

    It has them in XML attributes alone: then they are the same, for nothing else tells them.
    """
    if thing.obj is None or not model.documents[0].is_xml:
        return False
    before = wanted.models[thing.file].node_of(thing.obj)
    after = model.node_of(obj)
    if before is None or after is None or before.attributes != after.attributes:
        return False
    return all(child.obj is not None for node in (before, after) for child in node.children)


def _stated(
    values: Mapping[str, tuple[str | None, ...]], open_names: set[str]
) -> dict[str, tuple[str | None, ...]]:
    """Returns what attributes have, without those that a text leaves open."""
    return {name: each for name, each in values.items() if name not in open_names}


def _children(thing: Thing, read: Forest) -> list[tuple[Thing, EObject]]:
    """Returns what a thing owns, and the elements that were read of it."""
    found = read.owned_by(thing)
    if not found and not thing.owned:
        return []
    names = {name for name, each in thing.owned.items() if each}
    if names != found.keys():
        raise _different(thing, f"owns {list(found)}, not {sorted(names)}")
    # In the order of the metamodel, whatever the command has added last.
    thing.owned = {name: thing.owned[name] for name in found}
    pairs: list[tuple[Thing, EObject]] = []
    for name, children in thing.owned.items():
        if len(children) != len(found[name]):
            raise _different(thing, f"has {len(found[name])} {name}, not {len(children)}")
        pairs += zip(children, found[name], strict=True)
    return pairs


def _compare_references(thing: Thing, read: Forest) -> None:
    meant = {name: each for name, each in thing.references.items() if each}
    thing.references = read.references_of(thing)
    if meant == thing.references:
        return
    for name in (*meant, *thing.references):
        wanted, found = meant.get(name, []), thing.references.get(name, [])
        if wanted != found:
            raise _different(thing, f"refers by {name} to {found}, not {wanted}")


def _different(where: Thing | str, what: str) -> EditError:
    place = where if isinstance(where, str) else f"{where.label} of {where.file}"
    message = "the edit would do something else than it says, so nothing is done"
    return EditError(f"{message}: {place} {what}")
