"""Execution of commands in a draft, one after the other, each checked by reading again.

Their refs are those before the first of them.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from jausml.authoring.editing.applying import Applying, leaving, left_by
from jausml.authoring.editing.commands import (
    NEW,
    Add,
    Command,
    Create,
    EditError,
    ElementCommand,
    Move,
    Place,
    Remove,
    Rename,
    Set,
    with_created,
)
from jausml.authoring.editing.drafts import Context, Draft, new_document
from jausml.authoring.editing.layout import (
    Layout,
    followed,
    layout_file,
    placed,
    read_layout,
    write_layout,
)
from jausml.authoring.editing.reading import is_text
from jausml.authoring.editing.records import Referrer
from jausml.authoring.editing.text.planner import is_laid_out_text, print_text
from jausml.authoring.editing.working_copy import ElementCopy, WorkingCopy
from jausml.authoring.editing.xmi.planner import is_laid_out_xmi, print_xmi
from jausml.language.metamodel import ClassTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import refs
from jausml.language.model.model import Model, without_collector
from jausml.language.model.refs import Ref
from jausml.language.model.xmi.printing import UnwritableError

_NAMING = ("name", "urn", "version")
"""The features by which texts find elements: of one service in several versions the newest."""
_BY_NAME = re.compile(rb"""#/+[^/@"'\s]|@\w+\[|["'\s]//[^@"'\s]""")


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outcome of commands.

    `working_copy`: the elements of the files that were changed, and of those that refer to them.
    `shifts`: how each command changed refs: new ones by old ones, empty for what is gone.
    `formatted`: the files that were changed and whose layout was another one before.
    """

    created: tuple[Ref, ...]
    working_copy: WorkingCopy
    shifts: tuple[Mapping[Ref, Ref], ...]
    formatted: tuple[str, ...] = ()


def execute(commands: Sequence[Command], draft: Draft, known: WorkingCopy | None = None) -> Outcome:
    """Carries out commands in a draft.

    `known`: the working copy of an earlier outcome, which spares making one where it still holds.
    It is worth nothing any more. `EditError`: they cannot be carried out; the draft is worth
    nothing any more.
    """
    with without_collector():
        work = _Work(draft, known)
        for command in commands:
            work.execute(command)
        return work.outcome()


def names_elements(file: str, data: bytes) -> bool:
    """Tells whether a file may refer to elements by their names."""
    # Without its zeros, UTF-16 reads like ASCII.
    return is_text(file) or _BY_NAME.search(data.replace(b"\0", b"")) is not None


def referrers(ref: Ref, draft: Draft) -> tuple[Referrer, ...]:
    """Returns the elements that refer to an element or to one of its parts, in all files."""
    models = {file: draft.read(file).model for file in draft.referring(draft.editable(ref))}
    working_copy = WorkingCopy.of(models, draft.root)
    targets = set(copy_of(ref, working_copy).everything())
    fragments = working_copy.fragments()
    return tuple(
        Referrer(working_copy.ref(copy, fragments), copy.label, name)
        for copy, name in working_copy.referrers(targets)
        if copy not in targets
    )


def concerned(commands: Sequence[Command], draft: Draft) -> tuple[Referrer, ...]:
    """Returns what goes with elements that commands remove, and what loses a reference to them.

    Nothing of what they name themselves; the refs are those before the commands.
    """
    named = [
        command.element
        for command in commands
        if isinstance(command, Remove) and not command.element.startswith(NEW)
    ]
    files = dict.fromkeys(file for ref in named for file in draft.referring(draft.editable(ref)))
    models = {file: draft.read(file).model for file in files}
    working_copy = WorkingCopy.of(models, draft.root)
    copies = [copy_of(ref, working_copy) for ref in named]
    owners, going = leaving(copies, working_copy)
    losses = [(copy, "") for copy in owners if copy not in copies]
    fragments = working_copy.fragments()
    return tuple(
        Referrer(working_copy.ref(copy, fragments), copy.label, name)
        for copy, name in [*losses, *left_by(going, working_copy)]
    )


def copy_of(ref: Ref, working_copy: WorkingCopy) -> ElementCopy:
    """Returns the copy of a ref of one of the files of a working copy."""
    copy = working_copy.find(ref)
    if copy is None:
        raise EditError(f"there is no element {ref} any more", conflict=True)
    return copy


class _Work:
    """Work on a draft.

    The working copy of one command is compared with what is read after it, and serves the next.
    """

    def __init__(self, draft: Draft, known: WorkingCopy | None) -> None:
        self._draft = draft
        # A file that was read again has new elements, which the copies do not know.
        is_current = known is not None and all(
            file in draft.files and draft.read(file).model is model
            for file, model in known.models.items()
        )
        self._working_copy = (
            known if known is not None and is_current else WorkingCopy({}, draft.root)
        )
        self._created: list[ElementCopy] = []
        self._shifts: list[Mapping[Ref, Ref]] = []
        self._formatted: list[str] = []

    def outcome(self) -> Outcome:
        fragments = self._working_copy.fragments() if self._created else {}
        created = [self._working_copy.ref(copy, fragments) for copy in self._created]
        shifts, formatted = tuple(self._shifts), tuple(self._formatted)
        return Outcome(tuple(created), self._working_copy, shifts, formatted)

    def execute(self, command: Command) -> None:
        """Plans a command, makes the changes in the draft, and checks them."""
        if isinstance(command, Place):
            self._place(command)
        elif isinstance(command, Create):
            self._create(command)
        else:
            self._edit(with_created(command, self._known))

    def _place(self, command: Place) -> None:
        if command.file not in self._draft.models:
            raise EditError(f"{command.file} is no model file of the opened folder")
        layout = placed(self._layout_of(command.file), command.view, command.positions)
        self._draft.put(layout_file(command.file), write_layout(layout) or None)

    def _layout_of(self, file: str) -> Layout:
        held = self._draft.files.get(layout_file(file))
        return read_layout(held.data) if held is not None else {}

    def _create(self, command: Create) -> None:
        data, later = new_document(command, self._draft)
        self._draft.put(command.file, data)
        self._take([command.file])
        self._created.append(self._working_copy.roots[command.file][0])
        number = len(self._created) - 1
        for name, values in later.items():
            self.execute(Set(f"{NEW}{number}", name, values))

    def _edit(self, command: ElementCommand) -> None:
        if isinstance(command, Remove) and not command.element:
            return  # it went with another one
        files = self._concerned(command)
        self._take(files)
        working_copy = self._working_copy
        # Taken before the command, to tell afterwards what has shifted.
        paths = working_copy.paths()
        is_shifting = not isinstance(command, Set | Rename)
        before = working_copy.refs(paths) if is_shifting else {}
        locate, root = self._draft.locate, self._draft.root
        contexts = [
            Context(file, root, self._draft.read(file).model, working_copy, paths, locate)
            for file in files
        ]
        # Asked before the command: afterwards every file has our layout.
        odd = [context.file for context in contexts if not self._is_laid_out(context)]
        applying = Applying(working_copy, self._find, contexts[0].model.metamodels)
        applying.apply(command)
        try:
            printed = {
                context.file: (print_text if is_text(context.file) else print_xmi)(
                    applying.steps, context
                )
                for context in contexts
            }
        except UnwritableError as error:
            raise EditError(str(error)) from error
        for file, data in printed.items():
            if data is not None:
                self._draft.apply(file, data)
                self._formatted += [file] if file in odd else []
        self._check(applying)
        if is_shifting:
            self._shifts.append(_shift(before, self._working_copy.refs()))

    def _is_laid_out(self, context: Context) -> bool:
        """Tells whether a file has the layout of edits already."""
        if self._draft.files[context.file].is_printed:
            return True
        return (is_laid_out_text if is_text(context.file) else is_laid_out_xmi)(context)

    def _check(self, applying: Applying) -> None:
        """Reads the changed files, and compares their elements with the working copy."""
        models = self._read(list(self._working_copy.roots))
        changed = applying.changed.keys()
        read = renewed(self._working_copy, models, changed)
        for file in self._working_copy.roots:
            if layout_file(file) in self._draft.files:
                layout = followed(self._layout_of(file), file, self._working_copy, read)
                self._draft.put(layout_file(file), write_layout(layout) or None)
        # A later command may have removed what an earlier one created.
        there = set(read.copies.values()) if self._created else set()
        self._created = [copy for copy in self._created if copy in there]
        self._created += applying.created
        self._working_copy = read

    def _take(self, files: Sequence[str]) -> None:
        """Extends the working copy to some files, and to those with new elements."""
        wanted = dict.fromkeys([*(self._working_copy.roots if self._created else ()), *files])
        if set(wanted) == set(self._working_copy.roots):
            return
        working_copy = WorkingCopy.of(self._read(list(wanted)), self._draft.root)
        # Refs outlive the working copy, its elements do not.
        created = [self._working_copy.ref(copy) for copy in self._created]
        self._created = [copy_of(reference, working_copy) for reference in created]
        self._working_copy = working_copy

    def _read(self, files: Sequence[str]) -> dict[str, Model]:
        for file in files:
            self._draft.check(file)
        return {file: self._draft.read(file).model for file in files}

    def _concerned(self, command: ElementCommand) -> list[str]:
        """Returns the files that a command may change, that of its element first."""
        named = [] if isinstance(command, Add) else [command.element]
        named += [command.owner] if isinstance(command, Add | Move) else []
        if isinstance(command, Move):
            named += [ref for move in command.also for ref in (move.element, move.owner)]
        for reference in named:
            self._draft.element(reference)
        files = [self._draft.editable(reference) for reference in named]
        if isinstance(command, Set) and command.feature not in _NAMING:
            return files
        # Other files name elements by position or by name, and must follow.
        concerned_files = dict.fromkeys(
            concerned for file in files for concerned in self._draft.referring(file)
        )
        if isinstance(command, Set | Rename):
            return [
                concerned
                for concerned in concerned_files
                if concerned in files
                or names_elements(concerned, self._draft.files[concerned].data)
            ]
        return list(concerned_files)

    def _find(self, ref: Ref) -> tuple[ElementCopy | Ref, ClassTable]:
        if refs.split(ref)[0] in self._working_copy.models:
            copy = copy_of(ref, self._working_copy)
            return copy, copy.table
        obj, model = self._draft.locate(ref)
        return refs.ref_of(obj, model, self._draft.root), model.metamodels.class_of(obj)

    def _known(self, ref: Ref) -> Ref:
        """Returns the elements of `new:0` and `new:0/@maps.1`, and where any other one is now."""
        if not ref.startswith(NEW):
            for shift in self._shifts:
                ref = shift.get(ref, ref)
            return ref
        number, parting, path = ref.removeprefix(NEW).partition("/")
        if not number.isdecimal() or int(number) >= len(self._created):
            raise EditError(f"{ref} is nothing that was added before")
        return f"{self._working_copy.ref(self._created[int(number)])}{parting}{path}"


def _shift(before: Mapping[ElementCopy, Ref], after: Mapping[ElementCopy, Ref]) -> dict[Ref, Ref]:
    """Returns the new refs of copies by the old ones where they differ, empty for what is gone."""
    pairs = ((ref, after.get(copy, "")) for copy, ref in before.items())
    return {old: new for old, new in pairs if old != new}


def renewed(
    wanted: WorkingCopy, models: Mapping[str, Model], changed: Collection[ElementCopy]
) -> WorkingCopy:
    """Returns a working copy of what was read of changed files, made of the copies meant.

    `wanted`: a working copy that a command was applied to. Its copies go into the new one.
    `EditError`: something else was read than is meant; the copies are worth nothing any more.
    """
    read = WorkingCopy(models, wanted.folder)
    for file, roots in wanted.roots.items():
        read_roots = models[file].documents[0].roots
        if len(roots) != len(read_roots):
            raise _different(file, f"{len(roots)} and {len(read_roots)} roots")
        read.roots[file] = roots
        pending = list(zip(roots, read_roots, strict=True))
        while pending:
            copy, obj = pending.pop()
            _renew(copy, obj, file, wanted, read, is_changed=copy in changed)
            pending += _children(copy, read)
    # Elements must all be there before references to them can be compared.
    read.pair()
    for copy in read.everything():
        _compare_references(copy, read)
    return read


def _renew(
    copy: ElementCopy,
    obj: EObject,
    file: str,
    wanted: WorkingCopy,
    read: WorkingCopy,
    *,
    is_changed: bool,
) -> None:
    """Renews a copy from the element that was read, if that has the intended values."""
    model = read.models[file]
    if model.metamodels.class_of(obj) is not copy.table:
        raise _different(copy, "is another element")
    if copy.identifier != (model.identifier(obj) or ""):
        raise _different(copy, "is another element")
    # Asked before the copy gets its new element: the old one is what it compares with.
    is_written_alike = not is_changed and _is_written_alike(copy, obj, wanted, model)
    read.hold(copy, obj, file)
    if not is_written_alike:
        meant, open_names = copy.values, copy.open
        read.take_values(copy)
        if meant != copy.values and _stated(meant, open_names) != _stated(copy.values, open_names):
            raise _different(copy, f"has {copy.values}, not {meant}")


def _is_written_alike(copy: ElementCopy, obj: EObject, wanted: WorkingCopy, model: Model) -> bool:
    """Tells whether all values of an element are written as they were before the command.

    It has them in XML attributes alone: then they are the same, for nothing else tells them.
    """
    if copy.obj is None or not model.documents[0].is_xml:
        return False
    before = wanted.models[copy.file].node_of(copy.obj)
    after = model.node_of(obj)
    if before is None or after is None or before.attributes != after.attributes:
        return False
    return all(child.obj is not None for node in (before, after) for child in node.children)


def _stated(
    values: Mapping[str, tuple[str | None, ...]], open_names: set[str]
) -> dict[str, tuple[str | None, ...]]:
    """Returns the values of attributes, without those that a text leaves open."""
    return {name: value for name, value in values.items() if name not in open_names}


def _children(copy: ElementCopy, read: WorkingCopy) -> list[tuple[ElementCopy, EObject]]:
    """Returns the parts of a copy, each with the element that was read of it."""
    elements_by_feature = read.owned_by(copy)
    if not elements_by_feature and not copy.owned:
        return []
    names = {name for name, child_list in copy.owned.items() if child_list}
    if names != elements_by_feature.keys():
        raise _different(copy, f"owns {list(elements_by_feature)}, not {sorted(names)}")
    # In the order of the metamodel, whatever the command has added last.
    copy.owned = {name: copy.owned[name] for name in elements_by_feature}
    pairs: list[tuple[ElementCopy, EObject]] = []
    for name, children in copy.owned.items():
        if len(children) != len(elements_by_feature[name]):
            raise _different(
                copy, f"has {len(elements_by_feature[name])} {name}, not {len(children)}"
            )
        pairs += zip(children, elements_by_feature[name], strict=True)
    return pairs


def _compare_references(copy: ElementCopy, read: WorkingCopy) -> None:
    meant = {name: target_list for name, target_list in copy.references.items() if target_list}
    copy.references = read.references_of(copy)
    if meant == copy.references:
        return
    for name in (*meant, *copy.references):
        wanted, targets = meant.get(name, []), copy.references.get(name, [])
        if wanted != targets:
            raise _different(copy, f"refers by {name} to {targets}, not {wanted}")


def _different(where: ElementCopy | str, what: str) -> EditError:
    place = where if isinstance(where, str) else f"{where.label} of {where.file}"
    message = "the edit would do something else than it says, so nothing is done"
    return EditError(f"{message}: {place} {what}")
