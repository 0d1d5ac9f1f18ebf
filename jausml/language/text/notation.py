"""ros2jaus text as a notation of models, and the rules of its reader."""

from __future__ import annotations

import codecs
from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind
from jausml.language.model import conflicts
from jausml.language.model.diagnostics import RuleInfo, Severity
from jausml.language.model.notation import Fault, Notation
from jausml.language.text.keywords import keyword_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from jausml.language.metamodel import ClassTable, FeatureTable, Metamodels
    from jausml.language.text.reading.bridge_of_maps import BridgeOfMaps
    from jausml.language.text.reading.document import TextDocument
    from jausml.language.text.reading.parsing import Parsed

TEXT_RULES: Mapping[str, RuleInfo] = {
    "JML701": RuleInfo(
        "text that cannot be read",
        "The text does not follow the grammar of ros2jaus at this place. Reading continues behind "
        "it, so that all such places are found in one run. Bad: `rate 25`. Good: `rate: 25`.",
    ),
    "JML702": RuleInfo(
        "misplaced in the text",
        "A keyword names no class of the metamodels, or an element, a map's clause or a feature "
        "stands where its kind has no place. Keywords are the classes in lower case. Bad: `brigde "
        "front { }`. Good: `bridge front { }`.",
    ),
    "JML703": RuleInfo(
        "documentation of nothing",
        "A documentation comment precedes something that has no documentation in a model. Bad: "
        "`/** Ten times a second. */ rate: 10`. Good: `// Ten times a second.` before it.",
        Severity.WARNING,
    ),
    "JML704": RuleInfo(
        "unknown import",
        "An import without quotation marks names a file of the shipped library by folder and "
        "name. Bad: `import global_pose`. Good: `import mappings.global_pose`; or "
        '`import "robot.xmi"` for a file of yours, relative to the text.',
    ),
    "JML705": RuleInfo(
        "value of the wrong kind",
        "A feature or a conversion takes something else: a block where it owns elements, a name "
        "where it refers to them, a value elsewhere. Bad: `qos: reliable`. Good: "
        "`qos: { reliability: reliable }`.",
    ),
    "JML706": RuleInfo(
        "type that declares nothing",
        "A struct without a name, or a named one that no member uses, has no effect. Bad: "
        "`struct [ float32 x ]`. Good: `struct [ float32 x ] pose`, and a member `pose here`.",
        Severity.WARNING,
    ),
    "JML707": RuleInfo(
        "declared twice",
        "Two types, or two members of one message, have the same name. Bad: `( uint8 a  uint8 a )`."
        " Good: `( uint8 a  uint8 b )`.",
    ),
    "JML708": RuleInfo(
        "unknown member",
        "The message is known and has no such member. Members that are listed are checked; a map "
        "needs to list none. Bad: `JAUS ReportVelocityState ( uint32 VelocityX )`. Good: "
        "`JAUS ReportVelocityState ( uint32 Velocity_X )`, or `JAUS ReportVelocityState`.",
    ),
    "JML709": RuleInfo(
        "member of another type",
        "The message is known and its member is of another type. Bad: "
        "`ROS std_msgs/Float64 ( float32 data )`. Good: `ROS std_msgs/Float64 ( float64 data )`.",
    ),
    "JML710": RuleInfo(
        "unknown type of a member",
        "A member of a new message is of a type that is neither a primitive word, nor declared in "
        "the text, nor (for ROS) a known message type. Bad: `JAUS Status ( uint12 a )`. Good: "
        "`JAUS Status ( uint16 a )`.",
    ),
    "JML711": RuleInfo(
        "code assigned",
        "A new JAUS message states no code; the next free one of 0xD000 and above was taken, in "
        "the order of the text. State it so that it stays the same when the text grows. Bad: "
        "`JAUS Status ( uint8 a )`. Good: `JAUS Status ( uint8 a ) { code: 0xD000 }`.",
        Severity.INFO,
    ),
    "JML712": RuleInfo(
        "message that cannot be declared",
        "A new message has a fact that its kind cannot have, a size that is no number, more "
        "optional members than a presence vector counts, or no code is left. Bad: "
        "`uint8 [none] a`. Good: `uint8 [4] a`.",
    ),
    "JML713": RuleInfo(
        "facts of a known message",
        "The message is known; its code and other facts are in its own model and cannot be stated "
        "again. Bad: `JAUS SetWrenchEffort { code: 0x0405 }`. Good: `JAUS SetWrenchEffort`.",
    ),
    "JML714": RuleInfo(
        "no text", "The file is not UTF-8 text, or is empty. Good: save it as UTF-8."
    ),
    "JML715": RuleInfo(
        "connection that may mean several things",
        "Usually, the services of a bridge and its peers and the map leave only one direction and "
        "one exchange for a connection, which then need not be stated. Here several are possible, "
        "and the bridge would behave differently. Bad: a bridge that provides VelocityStateSensor, "
        "with `connection speed { map: velocity_state  peers: vehicle  topic odom }`, where "
        "vehicle provides it too. Good: the same with `direction: jausToRos`, for what vehicle "
        "reports.",
    ),
    "JML716": RuleInfo(
        "bridge of all maps beside a system",
        "The option --bridge-address makes a system with one bridge, which carries all maps of the "
        "file. A file with a system defines its own bridges. Bad: the option with a file that has "
        "a component. Good: the option with a file of maps.",
    ),
}
"""The rules of the text language by id. Ids are never used again for something else."""


SUFFIX = ".ros2jaus"

_SPECIAL = {
    "source": "source -> target",
    "target": "source -> target",
    "assignments": "list -> list { source -> target }",
    "AttributeMap.message": "JAUS Message",
    "AttributeMap.type": "ROS package/Type",
}
"""How features are given that have a notation of their own, by name or by class and name."""

_VALUES = {
    "EString": "text",
    "EInt": "number",
    "ELong": "number",
    "EDouble": "number",
    "EDoubleObject": "number",
}


class Ros2Jaus:
    """Reads ros2jaus text.

    Args:
        parse: Parses texts in which more may stand than in files.
    """

    def __init__(
        self, bridge: BridgeOfMaps | None = None, parse: Callable[[str], Parsed] | None = None
    ) -> None:
        self._bridge = bridge
        self._parse = parse

    @property
    def suffixes(self) -> tuple[str, ...]:
        """The ending of the files."""
        return (SUFFIX,)

    @property
    def rules(self) -> Mapping[str, RuleInfo]:
        """The rules of its findings."""
        return TEXT_RULES

    def how_to_give(self, table: ClassTable, feature: FeatureTable) -> str:
        """Returns how a feature of a class is given a value."""
        if feature.name == "name":
            return f"write '{keyword_of(table.name)} <name>'"
        special = _SPECIAL.get(f"{table.name}.{feature.name}") or _SPECIAL.get(feature.name)
        return f"write '{special or _usual(feature)}'"

    def read(self, data: bytes, path: Path, metamodels: Metamodels) -> TextDocument:
        """Reads a document, as `jausml.language.model.notation.Notation` says."""
        # All this takes a while to load, and models in XMI do without it.
        from jausml.language.text.reading.document import TextDocument  # noqa: PLC0415
        from jausml.language.text.reading.parsing import parsed_text  # noqa: PLC0415
        from jausml.language.text.tree import SyntaxTree  # noqa: PLC0415

        text, fault = decode(data)
        if fault is not None:
            return TextDocument(SyntaxTree(), [fault], path, metamodels)
        parsed = (self._parse or parsed_text)(text)
        conflict, first = conflicts.unmerged(data) if parsed.faults else ("", 0)
        if conflict:
            fault = Fault(conflicts.UNMERGED, conflict, conflicts.UNMERGED_HINT, first)
            return TextDocument(SyntaxTree(), [fault], path, metamodels)
        faults = [
            Fault(
                "JML701",
                syntax_fault.message,
                syntax_fault.hint,
                syntax_fault.span.line,
                syntax_fault.span.column,
            )
            for syntax_fault in parsed.faults
        ]
        bridge = self._bridge if self._bridge is not None and self._bridge.path == path else None
        return TextDocument(parsed.document, faults, path, metamodels, bridge)


NOTATIONS: tuple[Notation, ...] = (Ros2Jaus(),)
"""The notations besides XMI that the toolchain reads."""


def decode(data: bytes) -> tuple[str, Fault | None]:
    """Returns the text of a file; or an empty text, and why the file is none."""
    if not data.removeprefix(codecs.BOM_UTF8):
        hint = "write a component, a bridge or a map, or remove the file"
        return "", Fault("JML714", "the file is empty", hint)
    try:
        return data.decode("utf-8-sig"), None
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig", errors="replace")
        line = before.count("\n") + 1
        column = len(before) - (before.rfind("\n") + 1) + 1
        message = f"the file is not UTF-8 text: byte 0x{data[error.start]:02x}"
        return "", Fault("JML714", message, "save it as UTF-8", line, column)


def _usual(feature: FeatureTable) -> str:
    target = feature.target
    if target is None:
        return f"{feature.name}: <{_VALUES.get(feature.type_name, feature.type_name)}>"
    if feature.kind is not FeatureKind.CONTAINMENT:
        return f"{feature.name}: <name of a {target.name}>"
    if target.abstract:
        return f"{feature.name}: new ... {{ }}"
    if not feature.many:
        return f"{feature.name}: {{ }}"
    name = " name" if "name" in target.features else ""
    return f"{keyword_of(target.name)}{name or ' { }'}"
