"""What another program, or somebody who typed, made of a file: which element is which since."""

from __future__ import annotations

from collections import defaultdict
from itertools import chain
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.batches import with_created
from jausml.authoring.editing.commands import EditError, Remove, Rename, Set
from jausml.language.model import refs

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator

    from jausml.authoring.editing.commands import Add, Move
    from jausml.authoring.editing.forest import Forest, Thing
    from jausml.language.model.refs import Ref

_NAME = "name"


class Outside:
    """A change of a file of which only the file before and after is known.

    An element is the same if it has the same names up to its root. What has no name of its own is
    found again only where nothing of it has changed, since its position says nothing.
    """

    def __init__(self, file: str, before: Forest, after: Forest) -> None:
        self._file = file
        self._old = {ref: thing for thing, ref in before.refs().items()}
        self._refs = after.refs()
        self._contents: dict[Thing, Hashable] = {}
        self._same: dict[Thing, Thing] = {}
        old, new = before.roots[file], after.roots[file]
        if len(old) == len(new) == 1 and old[0].table is new[0].table:
            # The only one may have another name, and is the same all the same.
            self._same[old[0]] = new[0]
            old, new = _owned(old[0]), _owned(new[0])
        self._pair(old, new)

    def followed(
        self, command: Set | Add | Remove | Move | Rename, *, is_first: bool = True
    ) -> Set | Add | Remove | Move | Rename:
        """Returns a command with the refs after the change.

        Args:
            is_first: Whether the command gives way where both change the same; else it wins.

        Raises:
            EditError: What it speaks of is gone or cannot be found again for certain, or what it
                changes was changed already.
        """
        if is_first:
            self._check(command)
        return with_created(command, self._followed)

    def _followed(self, ref: Ref) -> Ref:
        if refs.split(ref)[0] != self._file:
            return ref
        old = self._old.get(ref)
        new = self._same.get(old) if old is not None else None
        if new is None:
            what = old.label if old is not None else ref
            message = f"{what} of {self._file} is gone or has another name meanwhile"
            raise EditError(message, conflict=True)
        return self._refs[new]

    def _check(self, command: Set | Add | Remove | Move | Rename) -> None:
        old = self._old.get(command.element) if isinstance(command, Set | Remove | Rename) else None
        new = self._same.get(old) if old is not None else None
        if old is None or new is None:
            return
        if isinstance(command, Remove):
            if self._content(old) != self._content(new):
                message = f"{old.label} was changed meanwhile: look at it before it goes"
                raise EditError(message, conflict=True)
            return
        feature = command.feature if isinstance(command, Set) else _NAME
        if _value(old, feature) != _value(new, feature):
            now = ", ".join(map(str, new.values.get(feature, ()))) or "something else"
            message = f"{feature} of {old.label} was changed meanwhile, to {now}"
            raise EditError(message, conflict=True)

    # Which is which

    def _pair(self, old: Iterable[Thing], new: Iterable[Thing]) -> None:
        pending = [(list(old), list(new))]
        while pending:
            before, after = pending.pop()
            pairs = [*_unique(before, after, _named)]
            paired = set(chain.from_iterable(pairs))
            left, other = ([e for e in each if e not in paired] for each in (before, after))
            pairs += _unique(left, other, self._content)
            for one, same in pairs:
                self._same[one] = same
                pending.append((_owned(one), _owned(same)))

    def _content(self, thing: Thing) -> Hashable:
        """Returns all that a thing is, without its position."""
        known = self._contents.get(thing)
        if known is None:
            names = sorted({*thing.values, *thing.references})
            values = tuple((name, _value(thing, name)) for name in names)
            owned = tuple(
                (name, tuple(map(self._content, each)))
                for name, each in sorted(thing.owned.items())
            )
            known = (thing.table.qualified_name, thing.feature, values, owned)
            self._contents[thing] = known
        return known


def _unique(
    before: Iterable[Thing], after: Iterable[Thing], mark: Callable[[Thing], Any]
) -> Iterator[tuple[Thing, Thing]]:
    """Yields the pairs of things that nothing else has the mark of, on either side."""
    sides: list[dict[Hashable, list[Thing]]] = []
    for things in (before, after):
        found = defaultdict(list)
        for each in things:
            found[mark(each)].append(each)
        sides.append(found)
    old, new = sides
    for key, things in old.items():
        others = new.get(key, ())
        if key is not None and len(things) == len(others) == 1:
            yield things[0], others[0]


def _named(thing: Thing) -> Hashable:
    """Returns how a thing is called where it stands, None for what is owned and has no name."""
    if not thing.name and thing.owner is not None:
        return None
    return thing.table.qualified_name, thing.feature, thing.name


def _owned(thing: Thing) -> list[Thing]:
    return [each for children in thing.owned.values() for each in children]


def _value(thing: Thing, feature: str) -> Hashable:
    values = tuple(thing.values.get(feature, ()))
    targets = thing.references.get(feature, ())
    return values, tuple(each if isinstance(each, str) else _path(each) for each in targets)


def _path(thing: Thing) -> Hashable:
    """Returns a thing by its names, and by its position where it has none."""
    steps: list[Hashable] = []
    each: Thing | None = thing
    while each is not None:
        siblings = each.owner.owned.get(each.feature, []) if each.owner is not None else []
        steps.append((each.feature, each.name or siblings.index(each) if siblings else each.name))
        each = each.owner
    return thing.file, tuple(steps)
