"""Diagnostics: findings with a stable rule id at a place in a file, and the rules of the reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum


class Severity(Enum):
    """The gravity of a finding."""

    ERROR = "error"
    """The model cannot be used."""
    WARNING = "warning"
    """The model can be used, but hardly means what it says."""
    INFO = "info"
    """Worth knowing."""


@dataclass(frozen=True, order=True, slots=True)
class Location:
    """A place in a file; lines and columns, in characters, are counted from 1."""

    path: str
    line: int = 1
    column: int = 1

    def __str__(self) -> str:
        return f"{self.path}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Related:
    """A second place that explains a finding, such as the other holder of a duplicate id."""

    location: Location
    message: str


@dataclass(frozen=True, slots=True)
class ReadFault:
    """Why a document, a reference or a value cannot be read; the place is in the document."""

    rule: str
    message: str
    hint: str = ""
    line: int = 1
    column: int = 1


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding about a model.

    Attributes:
        unread: The features of the element whose values could not be read; None where it may be any
            of them, or where the finding is not one of a reader.
    """

    rule: str
    severity: Severity
    location: Location
    message: str
    hint: str = ""
    element: str = ""
    fragment: str = ""
    related: tuple[Related, ...] = ()
    unread: frozenset[str] | None = None

    @property
    def sort_key(self) -> tuple[str, int, int, str, str]:
        """Path, line, column, rule and message: the order in which findings are shown."""
        place = self.location
        return (place.path, place.line, place.column, self.rule, self.message)

    def __lt__(self, other: Diagnostic) -> bool:
        return self.sort_key < other.sort_key

    def __str__(self) -> str:
        text = f"{self.location}: {self.severity.value}: {self.rule} {self.message}"
        return f"{text} ({self.hint})" if self.hint else text


@dataclass(frozen=True, slots=True)
class RuleInfo:
    """A rule: title, reason and cure, and severity."""

    title: str
    explanation: str
    severity: Severity = Severity.ERROR


READER_RULES: Mapping[str, RuleInfo] = {
    "JML001": RuleInfo(
        "unreadable file",
        "The file does not exist, is a folder, a pipe or a device, or may not be read.",
    ),
    "JML002": RuleInfo(
        "file too large",
        "The file is larger than 64 MiB, which bounds the memory that a model may take. Split it: "
        "a model may refer to elements of other files by href. The environment variable "
        "JAUSML_MAX_FILE_MIB sets another limit.",
    ),
    "JML003": RuleInfo("empty file", "The file has no content at all."),
    "JML004": RuleInfo(
        "not well-formed XML",
        "An XML parser cannot read the file. The reported place is where the parser gave up; the "
        "cause is often just before it. The rest of the file is not checked.",
    ),
    "JML005": RuleInfo(
        "Git LFS pointer",
        "The file holds only the pointer of Git LFS, because the real content was not fetched.",
    ),
    "JML006": RuleInfo(
        "unreadable encoding",
        "The XML declaration names an unknown encoding, or the bytes do not fit it. UTF-8 is what "
        "Eclipse writes; UTF-16 with a byte order mark and the usual 8-bit encodings are read too.",
    ),
    "JML007": RuleInfo(
        "DOCTYPE refused",
        "A document type declaration can name other files and define entities that grow without "
        "bound. Models need none, so none is accepted.",
    ),
    "JML008": RuleInfo("nested too deeply", "Elements are nested deeper than any model needs."),
    "JML009": RuleInfo(
        "merge conflict markers", "A merge left lines of <<<<<<<, ======= or >>>>>>>."
    ),
    "JML010": RuleInfo(
        "schemaLocation names another file",
        "xsi:schemaLocation tells Eclipse where a metamodel lies. jausml always uses the "
        "metamodels that it ships; the document names a file of another name for one of them, so "
        "Eclipse may check it against something else.",
        Severity.INFO,
    ),
    "JML011": RuleInfo("no model element", "The document is an empty xmi:XMI.", Severity.WARNING),
    "JML012": RuleInfo(
        "text without meaning",
        "Text stands between child elements. Eclipse drops it on the next save: documentation "
        "belongs in a `documentation` attribute.",
        Severity.WARNING,
    ),
    "JML013": RuleInfo(
        "prefix that Eclipse does not know",
        "XML leaves prefixes to the author, but EMF recognises xsi:type and xmi:id by the prefixes "
        "xsi and xmi. jausml reads the document; Eclipse may not.",
        Severity.WARNING,
    ),
    "JML101": RuleInfo(
        "unknown namespace",
        "The namespace of an element is not the nsURI of a metamodel, or its prefix is not "
        "declared. The metamodels are http://www.jausml.org/{jaus,ros,bridge,system}/1.0.",
    ),
    "JML102": RuleInfo("unknown class", "The metamodel has no class of this name."),
    "JML103": RuleInfo(
        "unknown feature", "The class of the element has no attribute or reference of this name."
    ),
    "JML104": RuleInfo(
        "abstract class",
        "No element can be of an abstract class. Name a concrete one by xsi:type. A reference by "
        "href needs the xsi:type as well, because Eclipse makes a placeholder of that class.",
    ),
    "JML105": RuleInfo("unknown literal", "The enumeration has no such literal."),
    "JML106": RuleInfo(
        "wrong value",
        "The text is not a value of the attribute's data type: integers are digits with an "
        "optional sign, numbers may have a decimal point and an exponent, booleans are true or "
        "false.",
    ),
    "JML107": RuleInfo(
        "value breaks a pattern",
        "The data type of the attribute restricts its text by a regular expression.",
    ),
    "JML108": RuleInfo(
        "required feature missing",
        "A feature with a lower bound of one or more has no value and no default.",
    ),
    "JML109": RuleInfo("too many values", "A feature has more values than its upper bound."),
    "JML110": RuleInfo("too few values", "A feature has fewer values than its lower bound."),
    "JML111": RuleInfo(
        "several values for one",
        "A single-valued feature is given more than once. Eclipse silently keeps the last one.",
    ),
    "JML112": RuleInfo(
        "feature cannot be set",
        "The feature is derived or unchangeable: its value follows from the rest of the model.",
    ),
    "JML113": RuleInfo(
        "wrong class",
        "The class named by xsi:type is not the class of the feature or one that specialises it.",
    ),
    "JML114": RuleInfo(
        "contained element written as a reference",
        "The feature owns its elements: they are written as child elements, not as an XML "
        "attribute. One that lies in another file is a child element with an href.",
    ),
    "JML115": RuleInfo(
        "reference written as a contained element",
        "The feature refers to elements that are owned elsewhere: write an XML attribute with a "
        "fragment, or a child element with an href.",
    ),
    "JML201": RuleInfo("duplicate id", "Two elements of a document have the same id."),
    "JML202": RuleInfo(
        "unresolved reference", "The document has no element of this id or at this fragment."
    ),
    "JML203": RuleInfo(
        "referenced file missing",
        "The file that an href names does not exist or cannot be read. It is reported once, at the "
        "first reference.",
    ),
    "JML204": RuleInfo(
        "fragment not found in the referenced file",
        "The referenced file was read, but has no element of this id or at this fragment.",
    ),
    "JML205": RuleInfo(
        "reference to the wrong class",
        "The element referred to is not of the class that the reference asks for.",
    ),
    "JML206": RuleInfo("containment cycle", "An element would contain itself."),
    "JML207": RuleInfo("contained twice", "An element can have one owner only."),
    "JML208": RuleInfo(
        "network refused",
        "Nothing is fetched from the network. The shipped library is named by "
        "http://www.jausml.org/library/, which stands for files of this installation.",
    ),
    "JML209": RuleInfo(
        "outside the project",
        "An href leads out of the project root. A model from elsewhere could name any file of the "
        "machine; allow it explicitly when it is meant.",
    ),
    "JML210": RuleInfo(
        "unknown Eclipse project",
        "A platform:/resource/ href names an Eclipse project. jausml searches for the name in the "
        ".project files of the project root, of its folders, and of the folders beside the project "
        "of the model; then among the names of folders. --project NAME=FOLDER states where it is.",
    ),
    "JML211": RuleInfo(
        "unsupported URI", "The scheme of the href does not name a file, or the href is not a URI."
    ),
    "JML212": RuleInfo("no such library model", "The shipped library has no file of this name."),
    "JML213": RuleInfo(
        "value listed twice",
        "A value occurs twice in a feature that holds each value once.",
        Severity.WARNING,
    ),
    "JML214": RuleInfo(
        "reference by names",
        "A fragment such as //Name is understood here, but EMF resolves names in metamodels only.",
        Severity.WARNING,
    ),
    "JML215": RuleInfo(
        "unknown name",
        "A reference by name in ros2jaus text names no element of the class that it needs. jausml "
        "searches for names in the document from the inside out, then in the documents that it "
        "imports, then among the services, messages and types of the shipped library. Bad: `peers: "
        "sensr` beside `component sensor`. Good: `peers: sensor`.",
    ),
    "JML216": RuleInfo(
        "ambiguous name",
        "A reference by name in ros2jaus text may mean several elements. Write more of the names "
        "around it, or import the document that is meant. Bad: `provides: Events`, which AS5710 "
        'has in two versions. Good: `import "http://www.jausml.org/library/jaus/core-1.1.xmi"` '
        "before it; or `query: LocalVectorDriver.QueryTravelSpeed`.",
    ),
}
"""The rules of the reader by id. Ids are never used again for something else."""
