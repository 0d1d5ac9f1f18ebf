"""Comparison of what was read of changed files with what commands mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.editing.commands import EditError

if TYPE_CHECKING:
    from jausml.editing.forest import Forest, Thing
    from jausml.model.refs import Ref


def matched(wanted: Forest, read: Forest) -> dict[Thing, Thing]:
    """Returns which things of one forest are those of another.

    Args:
        wanted: A forest that commands were applied to.
        read: What was read of the changed files.

    Raises:
        EditError: They are not the same.
    """
    found: dict[Thing, Thing] = {}
    pending: list[tuple[Thing, Thing]] = []
    for file, roots in wanted.roots.items():
        if len(roots) != len(read.roots[file]):
            raise _different(file, f"{len(roots)} and {len(read.roots[file])} roots")
        pending += zip(roots, read.roots[file], strict=True)
    while pending:
        one, other = pending.pop()
        found[one] = other
        if one.table is not other.table or one.identifier != other.identifier:
            raise _different(one, "is another element")
        if one.values != other.values and _stated(one, one.open) != _stated(other, one.open):
            raise _different(one, f"has {other.values}, not {one.values}")
        names = [name for name, each in one.owned.items() if each]
        if len(names) != len(other.owned):
            raise _different(one, f"owns {list(other.owned)}, not {names}")
        for name in names:
            ours, theirs = one.owned[name], other.owned.get(name, [])
            if len(ours) != len(theirs):
                raise _different(one, f"has {len(theirs)} {name}, not {len(ours)}")
            pending += zip(ours, theirs, strict=True)
    _match_references(found)
    return found


def _stated(thing: Thing, open_names: set[str]) -> dict[str, tuple[str | None, ...]]:
    """Returns what the attributes of a thing have, without those that a text leaves open."""
    return {name: each for name, each in thing.values.items() if name not in open_names}


def _match_references(found: dict[Thing, Thing]) -> None:
    def same(target: Thing | Ref) -> Thing | Ref | None:
        return target if isinstance(target, str) else found.get(target)

    for one, other in found.items():
        ours = {name: each for name, each in one.references.items() if each}
        if len(ours) != len(other.references):
            raise _different(one, f"refers by {list(other.references)}, not {list(ours)}")
        for name, targets in ours.items():
            read = other.references.get(name, [])
            if len(read) != len(targets) or any(
                same(a) != b for a, b in zip(targets, read, strict=True)
            ):
                raise _different(one, f"refers by {name} to {read}, not {targets}")


def _different(where: Thing | str, what: str) -> EditError:
    place = where if isinstance(where, str) else f"{where.label} of {where.file}"
    message = "the edit would do something else than it says, so nothing is done"
    return EditError(f"{message}: {place} {what}")
