"""Plan of a merge: what the other side did to the base, as changes of ours, and conflicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from jausml.authoring.differences.changes import NOTHING, feature_text, words
from jausml.authoring.differences.finding import is_ordered
from jausml.authoring.merging.sides import Sides, Value
from jausml.language.metamodel import FeatureKind, FeatureTable
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import contents
from jausml.language.model.diagnostics import RuleInfo

CHANGED_TWICE, GONE_HERE, LOST_TARGET, ELSEWHERE, AS_LINES, LEFT_OUT = (
    "JML811",
    "JML812",
    "JML813",
    "JML814",
    "JML815",
    "JML816",
)

MERGE_RULES: Mapping[str, RuleInfo] = {
    CHANGED_TWICE: RuleInfo(
        "merge: changed on both sides",
        "Both sides of a merge gave an element other values of the same feature, changed the same "
        "assignment or scale, or added elements of the same name that differ. Our side is kept. "
        "Good: write the intended value, and commit.",
    ),
    GONE_HERE: RuleInfo(
        "merge: removed on one side, used on the other",
        "One side removed an element that the other side changed, or refers to. Our side is kept: "
        "the element stays if it is there, and stays away if it is not. Good: remove it and what "
        "refers to it, or keep it.",
    ),
    LOST_TARGET: RuleInfo(
        "merge: reference to what is not there",
        "The other side refers to an element that our side removed, so the merge could not apply "
        "this reference. Good: refer to another element.",
    ),
    ELSEWHERE: RuleInfo(
        "merge: references of another file do not follow",
        "Another file refers to elements of the merged file by their positions, which the merge "
        "shifts. Good: look at the references of that file; ids (xmi:id) do not shift.",
    ),
    AS_LINES: RuleInfo(
        "merge: merged as lines",
        "One of the three states cannot be read as a model, or has references that lead nowhere "
        "and do not name an id in another file, so the file was merged as git merges lines. Good: "
        "look at the result, and validate it.",
    ),
    LEFT_OUT: RuleInfo(
        "merge: comment left out",
        "The other side wrote a comment for which the merged file has no place where it would be "
        "a comment. Good: write it where it belongs, and commit.",
    ),
}
"""The rules of conflicts by id."""


@dataclass(frozen=True)
class Conflict:
    """A place where two sides of a merge do not go together.

    `feature`: the feature, empty for the whole element. `file`: the file where another one is meant
    than that which is merged, else empty.
    """

    rule: str
    element: EObject
    message: str
    feature: str = ""
    file: str = ""


_WHOLE = (bridge.Assignment, bridge.TableEntry, jaus.ScaleRange, jaus.ValueSet, jaus.Transition)
"""Elements that mean something as a whole: half of each side would be what nobody meant."""


@dataclass(frozen=True)
class Addition:
    """An element of theirs that our side shall have.

    `before`: the sibling on our side that it stands before, None at the end.
    """

    owner: EObject
    feature: FeatureTable
    element: EObject
    before: EObject | None


@dataclass(frozen=True)
class Setting:
    """Values that a feature of our side shall have."""

    element: EObject
    feature: FeatureTable
    values: tuple[Value, ...]


@dataclass(frozen=True)
class Order:
    """The order that elements of one owner of our side shall have."""

    owner: EObject
    feature: FeatureTable
    elements: tuple[EObject, ...]


@dataclass
class Plan:
    """The changes to make on our side.

    `replaced`: elements that make room for others, before anything else. `moved`: elements that
    are new in one place of theirs, and stay where our side changed them.
    """

    replaced: list[EObject] = field(default_factory=list)
    additions: list[Addition] = field(default_factory=list)
    settings: list[Setting] = field(default_factory=list)
    orders: list[Order] = field(default_factory=list)
    removed: list[EObject] = field(default_factory=list)
    moved: set[EObject] = field(default_factory=set)
    conflicts: list[Conflict] = field(default_factory=list)


def planned(sides: Sides) -> Plan:
    """Returns the plan by which our side becomes the merge of both."""
    planner = _Planner(sides)
    for root in sides.base.documents[0].roots:
        planner.pair(root, sides.ours.matching.news[root], sides.theirs.matching.news[root])
    planner.gone()
    return planner.plan


class _Planner:
    def __init__(self, sides: Sides) -> None:
        self._sides = sides
        self._ours, self._theirs = sides.ours.matching, sides.theirs.matching
        self.plan = Plan()
        self._gone: list[tuple[EObject, EObject]] = []

    def pair(self, base: EObject, ours: EObject, theirs: EObject) -> None:
        """Looks at an element that all three have."""
        sides = self._sides
        if sides.is_same(base, theirs, sides.theirs):
            return
        # A list is no whole: the assignments of its elements are merged one by one.
        is_whole = isinstance(base, _WHOLE) and not isinstance(base, bridge.ListAssignment)
        if is_whole and not sides.is_same(base, ours, sides.ours):
            if not sides.is_alike(ours, theirs):
                mine, other = self._difference(base, ours), self._difference(base, theirs)
                what = f"{self._label(ours)} was changed on both sides"
                self._clash(ours, "", f"{what}: ours: {mine}; theirs: {other}")
            return
        for feature in sides.features(base):
            if feature.kind is FeatureKind.CONTAINMENT:
                self._parts(base, ours, theirs, feature)
            else:
                self._values(base, ours, theirs, feature)

    def _values(self, base: EObject, ours: EObject, theirs: EObject, feature: FeatureTable) -> None:
        sides = self._sides
        before = sides.values(base, feature, None)
        here = sides.values(ours, feature, sides.ours)
        there = sides.values(theirs, feature, sides.theirs)
        if there in (before, here):
            return
        if here == before:
            self.plan.settings.append(Setting(ours, feature, there))
        elif feature.many and feature.is_reference:
            # Of references, what either side added comes and what either side removed goes.
            kept = [value for value in here if value in there or value not in before]
            added = [value for value in there if value not in before and value not in here]
            self.plan.settings.append(Setting(ours, feature, (*kept, *added)))
        else:
            was, ours_now, theirs_now = (
                feature_text(element, feature) or NOTHING for element in (base, ours, theirs)
            )
            what = f"{words(feature.name)} of {self._label(ours)}"
            self._clash(
                ours, feature.name, f"{what} was {was}: ours is {ours_now}, theirs {theirs_now}"
            )

    def _parts(self, base: EObject, ours: EObject, theirs: EObject, feature: FeatureTable) -> None:
        before = contents(base, feature)
        for part in before:
            here, there = self._ours.news.get(part), self._theirs.news.get(part)
            if here is not None and there is not None:
                self.pair(part, here, there)
            elif here is not None:
                self._gone_there(part, here, is_one=not feature.many)
            elif there is not None and not self._sides.is_same(part, there, self._sides.theirs):
                difference = self._difference(part, there)
                what = f"{self._label(part)} was removed by us and changed by them: {difference}"
                self.plan.conflicts.append(Conflict(GONE_HERE, ours, what, feature.name))
        self._added(ours, theirs, feature)
        self._ordered(base, ours, theirs, feature)

    def _gone_there(self, base: EObject, ours: EObject, *, is_one: bool) -> None:
        if self._sides.is_same(base, ours, self._sides.ours):
            (self.plan.replaced if is_one else self.plan.removed).append(ours)
        else:
            self._gone.append((base, ours))

    def gone(self) -> None:
        """Looks at what our side changed and theirs has no more, or has in another place."""
        sides = self._sides
        # Only when all additions are known can one of them be the element that is missing.
        new = [
            element
            for addition in self.plan.additions
            for element in sides.all_of(addition.element)
        ]
        for base, ours in self._gone:
            moved_element = next(
                (element for element in new if self._is_moved(base, element)), None
            )
            if moved_element is not None:
                self.plan.moved.add(moved_element)
            owner = moved_element.eContainer() if moved_element is not None else None
            did = "removed" if owner is None else f"moved to {self._label(owner)}"
            difference = self._difference(base, ours)
            what = f"{self._label(ours)} was {did} by them and changed by us: {difference}"
            self.plan.conflicts.append(Conflict(GONE_HERE, ours, what))

    def _is_moved(self, base: EObject, theirs: EObject) -> bool:
        """Tells whether theirs has an element of the base in another place, by id or name."""
        if base.eClass is not theirs.eClass or theirs in self.plan.moved:
            return False
        identifiers = (side.identifier for side in (self._sides.base, self._sides.theirs.model))
        one, other = (of(obj) for of, obj in zip(identifiers, (base, theirs), strict=True))
        # An id is surer than a name, so with an id on either side names do not count.
        if one or other:
            return one == other
        names = [getattr(element, "name", None) for element in (base, theirs)]
        return names[0] == names[1] and any(names)

    def _added(self, ours: EObject, theirs: EObject, feature: FeatureTable) -> None:
        new = [content for content in contents(ours, feature) if content not in self._ours.olds]
        there = contents(theirs, feature)
        for position, element in enumerate(there):
            if element in self._theirs.olds:
                continue
            twin = self._twin(element, new)
            if twin is None and not feature.many and self._is_taken(ours, feature):
                self._clash(ours, feature.name, f"{self._label(element)} was added by them")
            elif twin is None:
                before = self._following(there[position + 1 :])
                self.plan.additions.append(Addition(ours, feature, element, before))
            else:
                # Each of ours is the twin of one of theirs alone.
                new.remove(twin)
                self._paired(twin, element)
                if not self._sides.is_alike(twin, element):
                    difference = self._sides.difference(
                        twin, self._sides.ours, element, self._sides.theirs
                    )
                    what = f"{self._label(twin)} was added on both sides, and is not the same"
                    self._clash(twin, "", f"{what}: from ours to theirs: {difference}")

    def _twin(self, theirs: EObject, new: Sequence[EObject]) -> EObject | None:
        """Returns the new element of our side with the same id or name."""
        name = getattr(theirs, "name", None)
        identifier = self._sides.theirs.model.identifier(theirs)
        for element in new:
            other = self._sides.ours.model.identifier(element)
            if identifier and identifier == other:
                return element
            same_name = bool(name) and element.eClass is theirs.eClass and element.name == name  # type: ignore[attr-defined]
            if same_name or self._sides.is_alike(element, theirs):
                return element
        return None

    def _paired(self, ours: EObject, theirs: EObject) -> None:
        """Remembers that elements, and what they own, are the same on both sides."""
        self._sides.twins[theirs] = ours
        for feature in self._sides.table(theirs).contained:
            if feature.name not in self._sides.table(ours).features:
                continue
            left = list(contents(ours, feature))
            for content in contents(theirs, feature):
                twin = self._twin(content, left)
                if twin is not None:
                    left.remove(twin)
                    self._paired(twin, content)

    def _is_taken(self, ours: EObject, feature: FeatureTable) -> bool:
        """Tells whether our side has an element where there is room for one alone."""
        return any(content not in self.plan.replaced for content in contents(ours, feature))

    def _following(self, siblings: Sequence[EObject]) -> EObject | None:
        """Returns the next sibling of theirs that our side has too."""
        known = (self._theirs.olds.get(sibling) for sibling in siblings)
        counterparts = (self._ours.news.get(element) for element in known if element is not None)
        return next((element for element in counterparts if element is not None), None)

    def _ordered(
        self, base: EObject, ours: EObject, theirs: EObject, feature: FeatureTable
    ) -> None:
        news = (self._ours.news, self._theirs.news)
        common = [
            element
            for element in contents(base, feature)
            if all(element in pairing for pairing in news)
        ]
        here = self._in_base(contents(ours, feature), self._ours.olds, common)
        there = self._in_base(contents(theirs, feature), self._theirs.olds, common)
        if there in (common, here):
            return
        if here != common:
            # Where the order means nothing, that of ours will do.
            if not is_ordered(self._sides.table(base), feature):
                return
            what = (
                f"{words(feature.name)} of {self._label(ours)} stand in another order on each side"
            )
            self._clash(ours, feature.name, what)
            return
        wanted = tuple(self._ours.news[element] for element in there)
        self.plan.orders.append(Order(ours, feature, wanted))

    def _in_base(
        self, elements: Sequence[EObject], olds: dict[EObject, EObject], common: list[EObject]
    ) -> list[EObject]:
        wanted = set(common)
        known = (olds[element] for element in elements if element in olds)
        return [element for element in known if element in wanted]

    def _clash(self, element: EObject, feature: str, message: str) -> None:
        self.plan.conflicts.append(Conflict(CHANGED_TWICE, element, message, feature))

    def _difference(self, base: EObject, obj: EObject) -> str:
        side = self._sides.ours if obj in self._ours.olds else self._sides.theirs
        return self._sides.difference(base, None, obj, side)

    def _label(self, obj: EObject) -> str:
        return self._sides.label(obj)
