"""Makes the references of the documentation from metamodels, library, rules and command line.

They are not committed. The site gets them by `make docs`; `make reference` writes them into
docs/reference/ for who reads the pages in a checkout.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

import click

from jausml.cli import main as command_line
from jausml.cli.lookup import listed
from jausml.language.metamodel import (
    ClassTable,
    FeatureTable,
    PackageTable,
    documentation,
    load_metamodels,
)
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model import read_models
from jausml.language.semantics.assignments.steps import knows_unknown
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.conversions.definition import Definition, NoArithmetic
from jausml.language.semantics.paths.attributes import Attribute, Found
from jausml.language.semantics.paths.markers import unknown
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import Placed, flattened, outer_scope
from jausml.language.text.notation import NOTATIONS
from jausml.live.systems.explaining import MEANINGS
from jausml.views.pages import markdown_table

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "reference"
READY_MAPS = sorted((ROOT / "models" / "library" / "mappings").glob("*.ros2jaus"))
ROS_TYPES = sorted((ROOT / "models" / "library" / "ros").glob("*.xmi"))
LANGUAGES = ("jaus", "ros", "bridge", "system")

_RULES = """\
# Rules

Look up the rules that `jausml validate`, the importers and `jausml generate` check, in the order of
their ids. Each entry says what the rule requires and why, with examples where they help.

On the command line, `jausml rules` lists all rules, and `jausml explain JML103` shows one of them.
[Keep models in git and CI](../how-to/ci.md#allow-a-finding) shows how to allow single findings.
"""

_CONVERSIONS = """\
# Conversions

Look up the conversions that an assignment of an attribute map can apply to a value. It may list
several, which are applied one after the other. `takes` and `yields` are the kinds of values before
and after. [Carry a message across a bridge](../how-to/map-a-message.md) shows how to use them, and
[Frames, units and values](../explanation/frames.md) which ones a pair of axes needs.
"""

_MARKERS = """\
# Markers of ROS fields

Look up by which values the fields of the ROS types of the library say that they have no value: that
it is unknown, that there is none, or that nothing limits it. A ROS message has all of its fields,
so its definition lends some of their values another meaning. A translation takes a field whose
marker holds for absent, and writes what says so into a field that nothing sets; without anything in
`written`, the default of the field says it, or another field has to.

In a condition, `value` is the field, or each element of an array; other names are paths from the
type. [Carry a message across a bridge](../how-to/map-a-message.md#absent-values) shows what a map
can make of absent values.
"""

_UNKNOWN = """\
# Unknown values in the ready maps

Look up what comes out of a [ready map](../how-to/ready-mappings.md) where a value that goes in is
unknown: an optional field of JAUS that is left out, an element that a list lacks, or a field of ROS
whose [marker](markers.md) says so. What no line names is always there. `no message` is counted as
`absent_field`.

Values that a target cannot carry, such as an infinity, are
[another matter](../how-to/map-a-message.md#values-that-do-not-fit).
"""

_OUTCOMES = {
    "dropMessage": "no message",
    "lastValue": "the last value",
    "receptionTime": "the time of arrival",
    "leave": "stays as ROS makes it",
}
"""What comes of a source that is absent, where the assignment alone says it."""

_ARITHMETIC = """\
## What they compute

The arithmetic of each, in the language of the conversion `expression`: the parts that it takes, the
condition under which it drops the message, local values, and a line for each part of the result.
Numbers are real numbers of 64 bits, and so are the whole numbers of times. IEEE 754 fixes each bit
of the results. `[C library]` marks what also calls functions of which a C library decides the last
bit.

```"""

_COUNTERS = """\
# Counters

Look up why a bridge did not pass a message on. It counts each such message under the name of the
reason: on `/diagnostics` as `dropped: REASON` of the connection, in the log and in the last lines
of the process. [Watch a running system](../how-to/top.md#counters) shows the other counts.
"""

_COMMAND_LINE = """\
# Command line

Look up the commands of `jausml` with their options. The texts are those of `jausml COMMAND --help`;
the [how-to guides](../index.md) show the commands in use.
"""

_METAMODEL = """\
Look up the classes of this metamodel with their features. In [ros2jaus](../ros2jaus.md) text, an
element begins with its class in lower case (`service_connection` for ServiceConnection), and the
features keep their names. In XMI and in Eclipse, features are attributes and child elements; [text
and XMI](../how-to/editor.md#side-by-side) show both. A number such as `0..1` or `1..*` says how
many values a feature has.
"""


def metamodel_page(language: str) -> str:
    """Returns the page of one language: classes with their features, then enumerations."""
    package = load_metamodels().package_named(language)
    lines = [f"# The {language} language", "", documentation(package.epackage), "", _METAMODEL]
    lines += [f"Namespace: `{package.ns_uri}`, declared in `metamodels/{package.file_name}`.", ""]
    for table in package.classes.values():
        lines += _class(table)
    lines += _data_types(package)
    return "\n".join(lines).rstrip() + "\n"


def _class(table: ClassTable) -> list[str]:
    kind = " (abstract)" if table.abstract else ""
    supers = ", ".join(str(parent.name) for parent in table.eclass.eSuperTypes)
    lines = [f"## {table.name}{kind}", "", documentation(table.eclass), ""]
    if supers:
        lines += [f"Specialises {supers}.", ""]
    own = [table.features[feature.name] for feature in table.eclass.eStructuralFeatures]
    if own:
        head = ("feature", "type", "number", "default", "meaning")
        lines += [*markdown_table(head, map(_feature, own)), ""]
    return lines


def _feature(feature: FeatureTable) -> tuple[str, ...]:
    upper = "*" if feature.upper < 0 else str(feature.upper)
    number = str(feature.lower) if str(feature.lower) == upper else f"{feature.lower}..{upper}"
    default = feature.feature.defaultValueLiteral or ""
    return (f"`{feature.name}`", feature.type_name, number, default, documentation(feature.feature))


def _data_types(package: PackageTable) -> list[str]:
    lines: list[str] = []
    for classifier in package.epackage.eClassifiers:
        if classifier.eClass.name == "EEnum":
            lines += [f"## {classifier.name}", "", documentation(classifier), ""]
            literals = [
                (f"`{e_literal.name}`", documentation(e_literal))
                for e_literal in classifier.eLiterals
            ]
            lines += [*markdown_table(("literal", "meaning"), literals), ""]
        elif classifier.eClass.name == "EDataType":
            lines += [f"## {classifier.name}", "", documentation(classifier), ""]
    return lines


def conversions_page() -> str:
    """Returns the page of the conversions: how each is written, what it takes and yields."""
    rows = [
        (
            f"`{conversion.call}`",
            ", ".join(conversion.inputs),
            ", ".join(conversion.outputs),
            conversion.documentation,
        )
        for conversion in CONVERSIONS.values()
    ]
    head = ("conversion", "takes", "yields", "meaning")
    lines = [_CONVERSIONS, *markdown_table(head, rows), "", _ARITHMETIC]
    for known in CONVERSIONS.values():
        lines += [*_arithmetic(known.name, known.definition), ""]
    return "\n".join([*lines[:-1], "```"]) + "\n"


def _arithmetic(name: str, definition: Definition | NoArithmetic) -> list[str]:
    if isinstance(definition, NoArithmetic):
        return [f"{name} {definition.value}"]
    head = f"{name}({definition.takes})" + ("" if definition.is_portable else "  [C library]")
    refused = " ".join(definition.refused.split())
    refusal = [f"  refused if {refused}: {definition.reason}"] if refused else []
    return [head, *refusal, *(f"  {line}" for line in definition.lines)]


def markers_page() -> str:
    """Returns the page of the markers of the library, by package."""
    lines = [_MARKERS]
    packages = read_models(ROS_TYPES).model.instances(ros.InterfacePackage)
    for package in sorted(packages, key=lambda interface_package: str(interface_package.name)):
        fields = [
            field for message in _messages(package) for field in message.fields if field.markers
        ]
        if fields:
            head = ("field", "says", "if", "written", "stated in")
            lines += [f"## {package.name}", ""]
            lines += [
                *markdown_table(head, [row for field in fields for row in _markers(field)]),
                "",
            ]
    return "\n".join(lines)


def _messages(package: ros.InterfacePackage) -> Iterator[ros.MessageType]:
    yield from package.messages
    for service in package.services:
        yield from (service.request, service.response)
    for action in package.actions:
        yield from (action.goal, action.result, action.feedback)


def _markers(field: ros.Field) -> Iterator[tuple[str, ...]]:
    owner = field.eContainer()
    place = f"{owner.name if owner is not None else ''}.{field.name}"
    for marker in field.markers:
        yield (
            f"`{place}`",
            marker.meaning.name,
            f"`{marker.condition}`",
            f"`{marker.value}`" if marker.value else "",
            str(marker.stated),
        )


def unknown_page() -> str:
    """Returns the page of what becomes of unknown values in the ready maps, by file."""
    model = read_models(READY_MAPS, notations=NOTATIONS).model
    by_file: dict[str, list[tuple[str, ...]]] = {path.stem: [] for path in READY_MAPS}
    for attribute_map in model.instances(bridge.AttributeMap):
        stem = Path(model.location(attribute_map).path).stem
        for to_ros in (True, False):
            by_file[stem] += _unknown(attribute_map, to_ros=to_ros)
    lines = [_UNKNOWN]
    for stem, rows in by_file.items():
        if rows:
            head = ("map", "to", "unknown", "because of", "comes out")
            lines += [f"## {stem}", "", *markdown_table(head, rows), ""]
    return "\n".join(lines)


def _unknown(used: bridge.AttributeMap, *, to_ros: bool) -> Iterator[tuple[str, ...]]:
    """Yields a row for all fields of a map for which the same is unknown, and comes out."""
    assignments = used.toRos if to_ros else used.toJaus
    rows: dict[tuple[str, str], list[str]] = {}
    for placed in flattened(assignments, outer_scope(used, to_ros=to_ros)):
        assignment = placed.assignment
        if not isinstance(assignment, bridge.FieldAssignment | bridge.ListAssignment):
            continue
        for path, source in placed.sources:
            if isinstance(source, Attribute) and source.may_lack and not knows_unknown(assignment):
                key = _reason(placed, path), _outcome(assignment, placed.targets[0][1])
                rows.setdefault(key, []).append(path)
    for (reason, outcome), paths in rows.items():
        names = ", ".join(f"`{field_path}`" for field_path in dict.fromkeys(paths))
        yield f"`{used.name}`", "ROS" if to_ros else "JAUS", names, reason, outcome


def _reason(placed: Placed[bridge.Assignment], path: str) -> str:
    """Why a source is absent: the markers of the fields on its way, or that it is not there."""
    steps = path.split(".")
    prefixes = (".".join(steps[: length + 1]) for length in range(len(steps)))
    places = (placed.scope.find_source(way) for way in prefixes)
    fields = (place.field for place in places if isinstance(place, RosPlace))
    marks = [mark for field in fields if field is not None for mark in field.markers]
    conditions = dict.fromkeys(f"`{mark.condition}`" for mark in marks)
    return " or ".join(conditions) or "is not there"


def _outcome(assignment: bridge.FieldAssignment | bridge.ListAssignment, target: Found) -> str:
    policy = assignment.whenAbsent.name
    if policy == "useDefault" and isinstance(assignment, bridge.FieldAssignment):
        return f"`{assignment.defaultValue}`"
    if policy in _OUTCOMES:
        return _OUTCOMES[policy]
    if not isinstance(target, Attribute) or not target.is_ros:
        return "is left out"
    written = unknown(target.field) if isinstance(target.field, ros.Field) else None
    says = ", which says so" if target.says_unknown else ""
    return f"`{written}`" if written else f"{_OUTCOMES['leave']}{says}"


def rules_page() -> str:
    """Returns the page of all rules with what `jausml explain` says."""
    lines = [_RULES]
    for entry in listed.rules():
        lines += [f"## {entry['rule']} {entry['title']}", "", f"Severity: {entry['severity']}.", ""]
        lines += [entry["documentation"], ""]
    return "\n".join(lines).rstrip() + "\n"


def counters_page() -> str:
    """Returns the page of the counters: what each of them means."""
    rows = [(f"`{counter}`", why) for counter, why in MEANINGS.items()]
    table = markdown_table(("counter", "a message is not passed on, because"), rows)
    return "\n".join([_COUNTERS, *table]).rstrip() + "\n"


def command_line_page() -> str:
    """Returns the page of the command line: what each verb's --help prints."""
    lines = [_COMMAND_LINE]
    root = click.Context(
        command_line, info_name="jausml", terminal_width=96, max_content_width=96, show_default=True
    )
    for context in _contexts(root):
        text = context.command.get_help(context)
        lines += [f"## {context.command_path}", "", "```text", text, "```", ""]
    return "\n".join(lines).rstrip() + "\n"


def _contexts(context: click.Context) -> Iterator[click.Context]:
    """Yields a command and the commands below it."""
    yield context
    group = context.command
    if isinstance(group, click.Group):
        for name in group.list_commands(context):
            command = group.get_command(context, name)
            if command is not None:
                yield from _contexts(click.Context(command, info_name=name, parent=context))


MAKERS: Mapping[str, Callable[[], str]] = {
    **{f"{language}.md": partial(metamodel_page, language) for language in LANGUAGES},
    "rules.md": rules_page,
    "cli.md": command_line_page,
    "conversions.md": conversions_page,
    "counters.md": counters_page,
    "markers.md": markers_page,
    "unknown-values.md": unknown_page,
}
"""What makes each page, by its name in docs/reference/."""


def main() -> int:
    """Writes the pages."""
    for name, make in MAKERS.items():
        (FOLDER / name).write_text(make(), encoding="utf-8", newline="\n")
    print(f"wrote {len(MAKERS)} pages in {FOLDER}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
