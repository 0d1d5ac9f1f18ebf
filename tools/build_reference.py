"""Writes docs/reference/ from metamodels, rules and command line: it cannot drift from them."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

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
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.conversions.definition import Definition, NoArithmetic
from jausml.views.pages import markdown_table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "reference"
LANGUAGES = ("jaus", "ros", "bridge", "system")

_RULES = """\
# Rules

Look up the rules that `jausml validate`, the importers and `jausml generate` check, in the order of
their ids. Each entry says what the rule requires and why, with examples where they help.

On the command line, `jausml rules` lists all rules, and `jausml explain JML103` shows one of them.
[Check models in CI](../how-to/ci.md) shows how to allow single findings.
"""

_CONVERSIONS = """\
# Conversions

Look up the conversions that an assignment of an attribute map can apply to a value. It may list
several, which are applied one after the other. `takes` and `yields` are the kinds of values before
and after. [Carry a message across a bridge](../how-to/map-a-message.md) shows how to use them, and
[Frames, signs and units](../explanation/frames.md) which ones a pair of axes needs.
"""

_ARITHMETIC = """\
## What they compute

The arithmetic of each, in the language of the conversion `expression`: the parts that it takes, the
condition under which it drops the message, local values, and a line for each part of the result.
Numbers are real numbers of 64 bits, and so are the whole numbers of times. IEEE 754 fixes each bit
of the results. `[C library]` marks what also calls functions of which a C library decides the last
bit.

```"""

_COMMAND_LINE = """\
# Command line

Look up the commands of `jausml` with their options. The texts are those of `jausml COMMAND --help`;
the [how-to guides](../index.md) show the commands in use.
"""

_METAMODEL = """\
Look up the classes of this metamodel with their features. In [ros2jaus](../ros2jaus.md) text, an
element begins with its class in lower case (`service_connection` for ServiceConnection), and the
features keep their names. In XMI and in Eclipse, features are attributes and child elements; [Text
and XMI, side by side](../explanation/text-and-xmi.md) shows both. A number such as `0..1` or `1..*`
says how many values a feature has.
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
    return (
        f"`{feature.name}`",
        feature.type_name,
        number,
        default,
        documentation(feature.feature),
    )


def _data_types(package: PackageTable) -> list[str]:
    lines: list[str] = []
    for classifier in package.epackage.eClassifiers:
        if classifier.eClass.name == "EEnum":
            lines += [f"## {classifier.name}", "", documentation(classifier), ""]
            literals = [(f"`{each.name}`", documentation(each)) for each in classifier.eLiterals]
            lines += [*markdown_table(("literal", "meaning"), literals), ""]
        elif classifier.eClass.name == "EDataType":
            lines += [f"## {classifier.name}", "", documentation(classifier), ""]
    return lines


def conversions_page() -> str:
    """Returns the page of the conversions: how each is written, what it takes and yields."""
    rows = [
        (f"`{each.call}`", ", ".join(each.inputs), ", ".join(each.outputs), each.documentation)
        for each in CONVERSIONS.values()
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


def rules_page() -> str:
    """Returns the page of all rules with what `jausml explain` says."""
    lines = [_RULES]
    for entry in listed.rules():
        lines += [f"## {entry['rule']} {entry['title']}", "", f"Severity: {entry['severity']}.", ""]
        lines += [entry["documentation"], ""]
    return "\n".join(lines).rstrip() + "\n"


def command_line_page() -> str:
    """Returns the page of the command line: what each verb's --help prints."""
    lines = [_COMMAND_LINE]
    root = click.Context(
        command_line,
        info_name="jausml",
        terminal_width=96,
        max_content_width=96,
        show_default=True,
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


def pages() -> Mapping[str, str]:
    """Returns every page by file name."""
    makers: dict[str, Callable[[], str]] = {
        "rules.md": rules_page,
        "cli.md": command_line_page,
        "conversions.md": conversions_page,
    }
    texts = {f"{language}.md": metamodel_page(language) for language in LANGUAGES}
    return texts | {name: maker() for name, maker in makers.items()}


def main() -> int:
    """Writes the pages; with --check only tells whether they are up to date (exit 1 when not)."""
    stale = []
    for name, text in pages().items():
        path = FOLDER / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            stale.append(name)
            if "--check" not in sys.argv[1:]:
                FOLDER.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8", newline="\n")
    print(f"{len(stale)} pages changed: {', '.join(stale)}" if stale else "reference is up to date")
    return 1 if stale and "--check" in sys.argv[1:] else 0


if __name__ == "__main__":
    sys.exit(main())
