"""The vocabulary of JSIDL: checks of documents against it, and attributes as values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from types import MappingProxyType

from jausml.language.importers.findings import ImportFindings
from jausml.language.importers.jsidl.scopes import MissingError, NumberError, Scope, Scopes
from jausml.language.model.documents import Document
from jausml.language.model.reading.problems import NodePlace
from jausml.language.model.values import nearest, show, suggest
from jausml.language.model.xmi.parsing import Node

NAMESPACES = ("urn:jaus:jsidl:1.0", "urn:jaus:jsidl:1.1")
PLUS = "urn:jaus:jsidl:plus"
ROOTS = ("service_def", "service_set", "declared_type_set", "declared_const_set")

CONTAINERS = ("record", "sequence", "list", "variant")
FIELDS = (
    "fixed_field",
    "variable_field",
    "bit_field",
    "fixed_length_string",
    "variable_length_string",
    "variable_length_field",
    "variable_format_field",
)
BODY_PARTS = ("header", "body", "footer")


@dataclass(frozen=True, slots=True)
class ElementRule:
    """Attributes and children that an element may have.

    Attributes:
        required: Attributes without which it means nothing.
        assumed: Attributes that files leave out, with the value to assume.
    """

    required: frozenset[str] = frozenset()
    assumed: Mapping[str, str] = field(default_factory=dict)
    optional: frozenset[str] = frozenset()
    children: frozenset[str] = frozenset()
    has_text: bool = False

    @property
    def attributes(self) -> frozenset[str]:
        """All attributes."""
        return self.required | self.assumed.keys() | self.optional


def _element(
    required: str = "",
    optional: str = "",
    children: str = "",
    *,
    assumed: Mapping[str, str] = MappingProxyType({}),
    has_text: bool = False,
) -> ElementRule:
    return ElementRule(
        frozenset(required.split()),
        assumed,
        frozenset(optional.split()) | {"interpretation"},
        frozenset(children.split()),
        has_text,
    )


def _declared(*names: str) -> str:
    return " ".join(f"{name} declared_{name}" for name in names)


_CONTAINER = _declared(*CONTAINERS)
_MEMBERS = _declared(*FIELDS, "array")
_SETS = "declared_const_set_ref declared_type_set_ref"
_SET = "value_set declared_value_set"
_VALUES = f"scale_range {_SET}"
_STEPS = "action send_action"
_MESSAGE = f"description {_declared(*BODY_PARTS)}"
_UNITS = {"field_units": "one"}
_LIMITS = {"lower_limit_type": "inclusive", "upper_limit_type": "inclusive"}
_STATES = "state default_state"
_TRANSITION = "parameter guard internal simple push pop action send_action"
_DECLARABLE = (*CONTAINERS, *FIELDS, *BODY_PARTS, "array", "message_def", "event_def", "value_set")

VOCABULARY: Mapping[str, ElementRule] = {
    "service_def": _element(
        "name id version",
        "deprecated",
        "description assumptions references declared_const_set declared_type_set"
        " message_set internal_events_set protocol_behavior",
    ),
    "service_set": _element(
        "name", "id version", "description declared_const_set declared_type_set service_def"
    ),
    "description": _element(has_text=True),
    "assumptions": _element(has_text=True),
    "references": _element(children="inherits_from client_of"),
    "inherits_from": _element("name id version"),
    "client_of": _element("name id version"),
    "declared_const_set": _element("name", "id version", "declared_const_set_ref const_def"),
    "declared_const_set_ref": _element("name id version"),
    "declared_type_set_ref": _element("name id version"),
    "const_def": _element("name const_value", "const_type field_units"),
    "declared_type_set": _element(
        "name", "id version", f"description {_SETS} {_declared(*_DECLARABLE)}"
    ),
    "message_set": _element(children="description input_set output_set"),
    "input_set": _element(children=_declared("message_def")),
    "output_set": _element(children=_declared("message_def")),
    "internal_events_set": _element(children=_declared("event_def")),
    "message_def": _element(
        "name message_id", "deprecated", _MESSAGE, assumed={"is_command": "false"}
    ),
    "event_def": _element("name", "deprecated", _MESSAGE),
    **{part: _element(optional="name", children=_CONTAINER) for part in BODY_PARTS},
    **{f"declared_{name}": _element("name declared_type_ref", "optional") for name in _DECLARABLE},
    "record": _element("name", "optional", f"presence_vector {_MEMBERS}"),
    "sequence": _element("name", "optional", f"presence_vector {_CONTAINER}"),
    "list": _element("name", "optional", f"count_field {_CONTAINER}"),
    "variant": _element("name", "optional", f"vtag_field {_CONTAINER}"),
    "array": _element("name", "optional", f"dimension {_MEMBERS}"),
    "dimension": _element("size", "name"),
    "fixed_field": _element("name field_type", "optional", _VALUES, assumed=_UNITS),
    "variable_field": _element("name", "optional", "type_and_units_field"),
    "type_and_units_field": _element(children="type_and_units_enum"),
    "type_and_units_enum": _element("name index field_type", children=_VALUES, assumed=_UNITS),
    "bit_field": _element("name field_type_unsigned", "optional", "sub_field"),
    "sub_field": _element("name", children=f"bit_range {_SET}"),
    "bit_range": _element("from_index to_index"),
    "fixed_length_string": _element("name string_length", "optional"),
    "variable_length_string": _element("name", "optional", "count_field"),
    "variable_length_field": _element("name field_format", "optional", "count_field"),
    "variable_format_field": _element("name", "optional", "format_field count_field"),
    "format_field": _element(children="format_enum"),
    "format_enum": _element("index field_format"),
    "count_field": _element("field_type_unsigned", "min_count max_count"),
    "vtag_field": _element("field_type_unsigned", "min_count max_count"),
    "presence_vector": _element("field_type_unsigned"),
    "scale_range": _element(
        "real_lower_limit real_upper_limit", assumed={"integer_function": "round"}
    ),
    "value_set": _element(optional="name offset_to_lower_limit", children="value_range value_enum"),
    "value_range": _element("lower_limit upper_limit", assumed=_LIMITS),
    "value_enum": _element("enum_index enum_const"),
    "protocol_behavior": _element(optional="is_stateless", children="start state_machine"),
    "start": _element("state_machine_name state_name"),
    "state_machine": _element("name", children=_STATES),
    "state": _element(
        "name", "initial_state", f"entry exit transition default_transition {_STATES}"
    ),
    "entry": _element(children=_STEPS),
    "exit": _element(children=_STEPS),
    "transition": _element("name", children=_TRANSITION),
    "default_transition": _element(children=_TRANSITION),
    "default_state": _element(children="transition default_transition"),
    "parameter": _element("type", "value"),
    "guard": _element("condition"),
    "simple": _element(children="end_state"),
    "end_state": _element("state"),
    "internal": _element(),
    "push": _element(children="end_state simple"),
    "pop": _element(optional="transition", children="argument"),
    "action": _element("name", children="argument"),
    "send_action": _element("name", children="argument"),
    "argument": _element("value"),
}
"""The elements of JSIDL by name."""


def is_jsidl(root: Node) -> bool:
    """Tells by its namespace whether a root element is one of JSIDL."""
    return root.namespace in (*NAMESPACES, PLUS)


def check_document(document: Document, root: Node, findings: ImportFindings) -> bool:
    """Checks all elements and attributes of a file, and drops what editors added.

    Args:
        root: Its root element; elements that were reported or belong to editors are taken out.

    Returns:
        Whether the file is a JSIDL file at all.
    """
    place = NodePlace(document, root)
    if not is_jsidl(root):
        message = f"<{root.tag}> is of namespace {show(root.namespace)}, not of JSIDL"
        if not root.namespace:
            message = f"<{root.tag}> has no namespace"
        findings.report("JML601", place, message, f'write xmlns="{NAMESPACES[0]}"')
        return False
    if root.tag not in ROOTS:
        message = f"<{root.tag}> is not the root of a JSIDL file"
        hint = suggest(root.tag, ROOTS) or f"one of {', '.join(ROOTS)}"
        findings.report("JML601", place, message, hint)
        return False
    pending = [root]
    while pending:
        node = pending.pop()
        rule = VOCABULARY[node.tag]
        _check_attributes(NodePlace(document, node), rule, findings)
        node.children = [
            child
            for child in node.children
            if _is_known(NodePlace(document, child), rule, findings)
        ]
        pending += node.children
        if not rule.has_text and node.text.strip():
            message = f"text {show(node.text.strip())} has no meaning in <{node.tag}>"
            findings.report("JML602", NodePlace(document, node), message)
    return True


def _is_known(place: NodePlace, rule: ElementRule, findings: ImportFindings) -> bool:
    node = place.node
    if node.namespace in NAMESPACES or (node.namespace == PLUS and node.tag in rule.children):
        if node.tag in rule.children:
            return True
        parent = node.parent.tag if node.parent is not None else ""
        message = f"<{parent}> has no element <{node.tag}>"
        findings.report("JML602", place, message, suggest(node.tag, rule.children))
    elif node.namespace != PLUS:
        message = f"<{node.tag}> of namespace {show(node.namespace)} is no part of JSIDL"
        findings.report("JML602", place, message)
    return False


def _check_attributes(place: NodePlace, rule: ElementRule, findings: ImportFindings) -> None:
    node = place.node
    names = [name for name in node.attributes[::2] if " " not in name]
    missing = sorted(name for name in rule.required if name not in names)
    for name in names:
        # Editors keep the look of their diagrams in attributes mx...
        if name in rule.attributes or name.startswith("mx"):
            continue
        near = nearest(name, missing) or nearest(name, rule.attributes)
        if near in missing:
            missing.remove(near)
        hint = f"did you mean '{near}'?" if near else ""
        message = f"<{node.tag}> has no attribute '{name}'"
        findings.report("JML603", place.at(name), message, hint)
    for name in missing:
        findings.report("JML604", place, f"<{node.tag}>{_name(node)} has no '{name}'")
    for name, value in rule.assumed.items():
        if name not in names:
            message = f"<{node.tag}>{_name(node)} has no '{name}'"
            findings.report("JML621", place, message, f"'{value}' is assumed")


def _name(node: Node) -> str:
    name = node.get("name")
    return f" {show(name)}" if name else ""


NUMERIC_TYPES: Mapping[str, str] = {
    "byte": "int8",
    "short integer": "int16",
    "integer": "int32",
    "long integer": "int64",
    "unsigned byte": "uint8",
    "unsigned short integer": "uint16",
    "unsigned integer": "uint32",
    "unsigned long integer": "uint64",
    "float": "float32",
    "long float": "float64",
}
"""The types of the model by those of JSIDL (AS5684, field_type)."""

INT = (-(2**31), 2**31 - 1)
LONG = (-(2**63), 2**63 - 1)


def folded(text: str | None) -> str:
    """Returns a text with each run of white space as one blank: editors fold long lines."""
    return " ".join((text or "").split())


def documentation(*nodes: Node | None) -> str | None:
    """Returns the documentation of elements, in `interpretation` or as text.

    A model has no place for `deprecated` (AS5684 1.1) but what is said about an element.
    """
    texts = []
    for node in nodes:
        if node is not None:
            if folded(node.get("deprecated")) in ("true", "1"):
                texts.append("Deprecated.")
            texts += [folded(node.get("interpretation")), folded(node.text)]
    return " ".join(dict.fromkeys(text for text in texts if text)) or None


def children(place: NodePlace, *tags: str) -> list[NodePlace]:
    """Returns the elements directly inside one, of some tags if any are named."""
    nodes = place.node.children
    return [NodePlace(place.document, node) for node in nodes if not tags or node.tag in tags]


def joined(*texts: str | None) -> str | None:
    """Returns texts one after the other, None when there are none."""
    return " ".join(text for text in texts if text) or None


class Values:
    """Reads values and reports those that are none."""

    def __init__(self, scopes: Scopes, findings: ImportFindings) -> None:
        self._scopes = scopes
        self._findings = findings

    def text(self, place: NodePlace, name: str) -> str:
        """Returns an attribute with folded white space, or its assumed value."""
        value = place.node.get(name)
        if value is None:
            return VOCABULARY[place.node.tag].assumed.get(name, "")
        return folded(value)

    def flag(self, place: NodePlace, name: str) -> bool:
        """Returns an attribute that is true or false; false without it."""
        text = self.text(place, name).lower()
        if text not in ("", "true", "false", "1", "0"):
            self._wrong(place, name, "is not true or false", suggest(text, ("true", "false")))
        return text in ("true", "1")

    def choice(self, place: NodePlace, name: str, choices: Mapping[str, str]) -> str | None:
        """Returns the value that an attribute stands for, None for an unknown one."""
        text = self.text(place, name)
        value = choices.get(text) or choices.get(text.lower())
        if value is None and text:
            hint = suggest(text, choices) or f"one of {', '.join(choices)}"
            self._wrong(place, name, "is not known", hint)
        elif value is None and place.node.get(name) is not None:
            self._wrong(place, name, "is empty")
        return value

    def numeric_type(self, place: NodePlace, name: str) -> str | None:
        """Returns the numeric type that an attribute names."""
        return self.choice(place, name, NUMERIC_TYPES)

    def unsigned_type(self, place: NodePlace) -> str | None:
        """Returns the unsigned integer type that an attribute names."""
        unsigned = {
            key: type_name for key, type_name in NUMERIC_TYPES.items() if type_name.startswith("u")
        }
        return self.choice(place, "field_type_unsigned", unsigned)

    def integer(
        self, scope: Scope, place: NodePlace, name: str, bounds: tuple[int, int] = INT
    ) -> int | None:
        """Returns an integer, None when there is none."""
        value = self._number(scope, place, name)
        if value is None:
            return None
        if value.denominator != 1:
            self._wrong(place, name, "is not an integer")
        elif not bounds[0] <= value <= bounds[1]:
            self._wrong(place, name, f"is not in {bounds[0]}..{bounds[1]}")
        else:
            return int(value)
        return None

    def real(self, scope: Scope, place: NodePlace, name: str) -> float | None:
        """Returns a number, None when there is none."""
        value = self._number(scope, place, name)
        if value is None:
            return None
        try:
            return float(value)
        except OverflowError:
            self._wrong(place, name, "is out of all bounds")
            return None

    def _number(self, scope: Scope, place: NodePlace, name: str) -> Fraction | None:
        text = place.node.get(name)
        if text is None:
            return None
        try:
            return self._scopes.number(scope, text)
        except NumberError as error:
            self._wrong(place, name, str(error))
        except MissingError:
            pass  # the missing set was reported
        return None

    def _wrong(self, place: NodePlace, name: str, reason: str, hint: str = "") -> None:
        text = show(place.node.get(name) or "")
        self._findings.report("JML605", place.at(name), f"'{name}' {text} {reason}", hint)


def largest(unsigned: str) -> int:
    """Returns the largest integer of an unsigned type such as `uint8`."""
    return (1 << int(unsigned.removeprefix("uint"))) - 1
