"""Writes models/library/ros/<package>.xmi from the interface definitions of an installed ROS 2.

Usage: build_ros_library.py SHARE_FOLDER [PACKAGE ...] [--output FOLDER]

SHARE_FOLDER is the folder that holds one folder for each ROS package, for example
/opt/ros/jazzy/share. Only facts are taken over (names, types, sizes, defaults, constants), no
comments. The output is the same for the same definitions, whatever the machine.
"""

from __future__ import annotations

import argparse
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

DEFAULT_PACKAGES = (
    "builtin_interfaces",
    "std_msgs",
    "geometry_msgs",
    "nav_msgs",
    "sensor_msgs",
    "diagnostic_msgs",
    "std_srvs",
)
DEFAULT_OUTPUT = Path(__file__).resolve().parent.parent / "models" / "library" / "ros"

INTEGERS = frozenset(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))
PRIMITIVES = INTEGERS | {"bool", "byte", "char", "float32", "float64", "string", "wstring"}

# The grammar of a line, after the ROS 2 interface definition: type, array, name, value.
_LINE = re.compile(
    r"(?P<type>[A-Za-z][\w/]*)"
    r"(?:<=(?P<bound>\d+))?"
    r"(?P<array>\[(?:(?P<at_most><=)?(?P<size>\d+))?\])?"
    r"\s+(?P<name>[A-Za-z]\w*)"
    r"(?:\s*=\s*(?P<constant>.+)|\s+(?P<default>.+))?"
)
_COMMENT = re.compile(r"""((?:[^#"']|"[^"]*"|'[^']*')*)#.*""")


class DefinitionError(ValueError):
    """A line of an interface definition that cannot be understood."""


@dataclass(frozen=True)
class FieldFacts:
    """One field or constant as its definition line states it."""

    name: str
    type: str
    array_kind: str = "single"
    array_size: int = 0
    string_bound: int = 0
    default: str = ""
    constant: str = ""


@dataclass
class Definitions:
    """The interfaces of one package: name -> sections of fields (1, 2 or 3 of them)."""

    package: str
    messages: dict[str, list[FieldFacts]] = field(default_factory=dict)
    services: dict[str, list[list[FieldFacts]]] = field(default_factory=dict)
    actions: dict[str, list[list[FieldFacts]]] = field(default_factory=dict)


def parse_line(line: str) -> FieldFacts | None:
    """Reads one line; None when it holds nothing but space and comment.

    Raises:
        DefinitionError: the line is no field and no constant.
    """
    commented = _COMMENT.fullmatch(line)
    text = (commented.group(1) if commented else line).strip()
    if not text:
        return None
    found = _LINE.fullmatch(text)
    if found is None:
        raise DefinitionError(text)
    kind = "single"
    if found["array"]:
        kind = "unboundedSequence"
        if found["size"]:
            kind = "boundedSequence" if found["at_most"] else "fixedArray"
    return FieldFacts(
        name=found["name"],
        type=found["type"],
        array_kind=kind,
        array_size=int(found["size"] or 0),
        string_bound=int(found["bound"] or 0),
        default=(found["default"] or "").strip(),
        constant=(found["constant"] or "").strip(),
    )


def parse_sections(text: str) -> list[list[FieldFacts]]:
    """Reads a definition; `---` lines part its sections (request and response, and so on)."""
    sections: list[list[FieldFacts]] = [[]]
    for line in text.splitlines():
        if line.strip() == "---":
            sections.append([])
            continue
        facts = parse_line(line)
        if facts is not None:
            sections[-1].append(facts)
    return sections


def read_package(share: Path, package: str) -> Definitions:
    """Reads all interfaces of an installed package.

    Raises:
        DefinitionError: with the file, when a definition cannot be understood.
        FileNotFoundError: the package is not installed under `share`.
    """
    folder = share / package
    if not folder.is_dir():
        raise FileNotFoundError(folder)
    found = Definitions(package)
    for path in sorted(folder.glob("*/*")):
        if path.suffix not in {".msg", ".srv", ".action"}:
            continue
        try:
            sections = parse_sections(path.read_text(encoding="utf-8"))
        except DefinitionError as error:
            raise DefinitionError(f"{path}: {error}") from error
        if path.suffix == ".msg":
            found.messages[path.stem] = sections[0]
        elif path.suffix == ".srv":
            found.services[path.stem] = sections
        else:
            found.actions[path.stem] = sections
    return found


def write_package(found: Definitions) -> str:
    """The XMI document of a package; ids are the names of the types."""
    names = [*found.messages, *found.services, *found.actions]
    if len(set(names)) != len(names):
        raise DefinitionError(f"{found.package}: a message, service and action share a name")
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<ros:InterfacePackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"',
        '    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"',
        '    xmlns:ros="http://www.jausml.org/ros/1.0"',
        f"    xmi:id={quoteattr('package.' + found.package)} name={quoteattr(found.package)}>",
    ]
    for name, fields in found.messages.items():
        lines += _message("messages", name, name, fields, found.package, "  ")
    for name, sections in found.services.items():
        lines += _compound("services", name, ("request", "response"), sections, found.package)
    for name, sections in found.actions.items():
        lines += _compound("actions", name, ("goal", "result", "feedback"), sections, found.package)
    lines.append("</ros:InterfacePackage>")
    return "\n".join(lines) + "\n"


def _compound(
    tag: str, name: str, parts: tuple[str, ...], sections: list[list[FieldFacts]], package: str
) -> list[str]:
    """A service or an action with its parts, named after rosidl: SetBool_Request."""
    lines = [f"  <{tag} xmi:id={quoteattr(name)} name={quoteattr(name)}>"]
    for part, fields in zip(parts, sections, strict=True):
        part_name = f"{name}_{part.capitalize()}"
        lines += _message(part, part_name, part_name, fields, package, "    ")
    lines.append(f"  </{tag}>")
    return lines


def _message(
    tag: str, identity: str, name: str, fields: list[FieldFacts], package: str, indent: str
) -> list[str]:
    head = f"{indent}<{tag} xmi:id={quoteattr(identity)} name={quoteattr(name)}"
    if not fields:
        return [f"{head}/>"]
    # Fields before constants: the order that the language writes its features in.
    members = [_field(facts, package, indent + "  ") for facts in fields if not facts.constant]
    constants = [_constant(facts, indent + "  ") for facts in fields if facts.constant]
    return [f"{head}>", *members, *constants, f"{indent}</{tag}>"]


def _constant(facts: FieldFacts, indent: str) -> str:
    return (
        f"{indent}<constants name={quoteattr(facts.name)} type={quoteattr(facts.type)} "
        f"value={quoteattr(facts.constant)}/>"
    )


def _field(facts: FieldFacts, package: str, indent: str) -> str:
    kind = "PrimitiveField" if facts.type in PRIMITIVES else "MessageField"
    text = f'{indent}<fields xsi:type="ros:{kind}" name={quoteattr(facts.name)}'
    if facts.array_kind != "single":
        text += f' arrayKind="{facts.array_kind}"'
        if facts.array_size:
            text += f' arraySize="{facts.array_size}"'
    if facts.type in PRIMITIVES:
        text += f' type="{facts.type}"'
        if facts.string_bound:
            text += f' stringBound="{facts.string_bound}"'
        if facts.default:
            text += f" defaultValue={quoteattr(facts.default)}"
        return text + "/>"
    owner, _, name = facts.type.rpartition("/")
    # A header is the only type that definitions may name without its package from elsewhere.
    owner = "std_msgs" if facts.type == "Header" and package != "std_msgs" else owner
    if owner in {"", package}:
        return f"{text} messageType={quoteattr(name)}/>"
    href = quoteattr(f"{owner}.xmi#{name}")
    return f"{text}>\n{indent}  <messageType href={href}/>\n{indent}</fields>"


def main(arguments: list[str] | None = None) -> int:
    """Writes the library; exit code 1 with a message when a definition is missing or unclear."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("share", type=Path, help="folder of the installed ROS packages")
    parser.add_argument("packages", nargs="*", help="packages (default: those of the library)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder to write to")
    options = parser.parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    for package in options.packages or DEFAULT_PACKAGES:
        try:
            document = write_package(read_package(options.share, package))
        except (DefinitionError, FileNotFoundError) as error:
            print(f"build_ros_library: {error}", file=sys.stderr)
            return 1
        path = options.output / f"{package}.xmi"
        path.write_text(document, encoding="utf-8", newline="\n")
        print(path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
