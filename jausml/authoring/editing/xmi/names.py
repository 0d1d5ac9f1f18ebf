"""How an XMI file names elements: fragments, hrefs, prefixes, and the references it has."""

from __future__ import annotations

import posixpath
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import quote

from jausml.authoring.editing.reading import is_library
from jausml.authoring.editing.working_copy import ElementCopy
from jausml.language.metamodel import FeatureKind
from jausml.language.model import refs
from jausml.language.model.library import LIBRARY_URI, copy_in_project, library_root
from jausml.language.model.reading.classes import XSI, is_xmi
from jausml.language.model.refs import FragmentFinder
from jausml.language.model.uris import UriFault, UriResolver
from jausml.language.model.xmi.writer import attribute_text, element_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.authoring.editing.drafts import Context
    from jausml.authoring.editing.xmi.source import Attribute, Edits, Element, Line, Source
    from jausml.language.metamodel import ClassTable, FeatureTable
    from jausml.language.model.documents import Document
    from jausml.language.model.refs import Ref
    from jausml.language.model.xmi.parsing import Node


XMI = "http://www.omg.org/XMI"
_XSI = "xsi"
_PLACE = re.compile(r"([^\s\"']+)\s+([^\s\"']+)")
"""A namespace and the place of its metamodel, of which `xsi:schemaLocation` lists several."""

_WORD = re.compile(r"\S+")

_PATH = re.compile(r"/(?:[0-9]+)?(?:/@[^/.@\[\]?]+(?:\.[0-9]+)?)*")


class Names:
    """The names that one file uses."""

    def __init__(self, context: Context, edits: Edits, root: Node) -> None:
        self._context = context
        self._edits = edits
        self._root = root
        self._declared: dict[str, str] = {}
        self._fragments: dict[ElementCopy, str] | None = None
        self._uris: dict[str, str] = {}
        self._resolver = UriResolver(context.root, allow_outside=False, projects={})
        self._finder = FragmentFinder(context.model.metamodels, lambda *_: None)

    def target(self, uri: str, fragment: str) -> ElementCopy | Ref | None:
        """Returns what an href or a fragment of the file meant; None when it leads nowhere."""
        document = self._document(uri)
        found = self._finder.find(document, fragment) if document is not None else None
        obj = found.node.obj if found is not None else None
        if obj is None:
            return None
        known = self._context.working_copy.copies.get(obj)
        return known or refs.ref_of(obj, self._context.model, self._context.root)

    def fragment(self, target: ElementCopy | Ref) -> str:
        """Returns the fragment of an element, as it will be."""
        if not isinstance(target, ElementCopy):
            return refs.split(target)[1]
        if self._fragments is None:
            self._fragments = self._context.working_copy.fragments()
        return self._fragments[target]

    def is_local(self, target: ElementCopy | Ref) -> bool:
        """Tells whether an element will stand in the file."""
        return file_of(target) == self._context.file

    def href(self, target: ElementCopy | Ref) -> str:
        """Returns the href of an element, as it will be."""
        uri = "" if self.is_local(target) else self._uri(file_of(target))
        return f"{uri}#{self.fragment(target)}"

    def type_attribute(self, target: ElementCopy | Ref, feature: FeatureTable) -> str:
        """Returns ` xsi:type="..."` where the class of an element is not that of the feature."""
        table = self._class(target)
        if table is feature.target:
            return ""
        prefix = self.prefix(table.package.ns_uri, table.package.name)
        return f' {self.prefix(XSI, _XSI)}:type="{prefix}:{table.name}"'

    def xmi(self) -> str:
        """Returns the prefix of `xmi:id`."""
        for prefix, uri in self._root.prefixes.items():
            if is_xmi(uri) and prefix:
                return prefix
        return self.prefix(XMI, "xmi")

    def xsi(self) -> str:
        """Returns the prefix of `xsi:type` and `xsi:nil`."""
        return self.prefix(XSI, _XSI)

    def prefix(self, uri: str, usual: str) -> str:
        """Returns the prefix of a namespace, which `declare` declares if need be."""
        known = {**self._root.prefixes, **self._declared}
        for prefix, each in known.items():
            if each == uri and prefix:
                return prefix
        prefix, count = usual, 0
        while prefix in known:
            count += 1
            prefix = f"{usual}{count}"
        self._declared[prefix] = uri
        return prefix

    def declare(self) -> None:
        """Declares the new prefixes, in the order in which Eclipse has them."""
        element = self._edits.source.element(self._root)
        names = {f"xmlns:{prefix}": uri for prefix, uri in self._declared.items()}
        for name in sorted(names, key=_rank):
            later = {each.name for each in element.attributes if _rank(each.name) > _rank(name)}
            self._edits.add_attribute(element, name, names[name], later)
            self._locate(names[name], element)

    def _locate(self, uri: str, element: Element) -> None:
        """Tells Eclipse where the metamodel of a new namespace is, if the file says it of others.

        It lies beside theirs; without its place Eclipse opens the file no longer.
        """
        packages = self._context.model.metamodels.packages
        written = next((each for each in element.attributes if _is_places(each.name)), None)
        if written is None or uri not in packages:
            return
        known = list(_PLACE.finditer(self._edits.source.text, written.value, written.end))
        folders = [
            each[2].removesuffix(file)
            for each in known
            if each[1] in packages and each[2].endswith(file := f"{packages[each[1]].name}.ecore")
        ]
        if folders and uri not in {each[1] for each in known}:
            place = f"{uri} {folders[0]}{packages[uri].name}.ecore"
            later = next((each.start() for each in known if each[1] > uri), None)
            if later is None:
                self._edits.put(written.end, written.end, f" {place}")
            else:
                self._edits.put(later, later, f"{place} ")

    def _class(self, target: ElementCopy | Ref) -> ClassTable:
        return target.table if isinstance(target, ElementCopy) else self._context.find_class(target)

    def _document(self, uri: str) -> Document | None:
        context = self._context
        if not uri:
            return context.document
        target = self._resolver.resolve(uri, context.document)
        if isinstance(target, UriFault):
            return None
        known = (each for each in context.model.documents if each.path == target.path)
        return next(known, None)

    def _uri(self, file: str) -> str:
        """Returns the URI of another file: as this one writes it already, else the writer's."""
        if not self._uris:
            self._uris = {"": "", **self._written_uris()}
        return self._uris.get(file) or self._usual_uri(file)

    def _written_uris(self) -> dict[str, str]:
        found: dict[str, str] = {}
        seen: set[str] = set()
        pending = [self._root]
        while pending:
            node = pending.pop()
            pending += node.children
            uri = (node.get("href") or "").strip().partition("#")[0]
            if uri and uri not in seen:
                seen.add(uri)
                document = self._document(uri)
                if document is not None:
                    found.setdefault(refs.file_of(document, self._context.root), uri)
        return found

    def _usual_uri(self, file: str) -> str:
        context = self._context
        if not is_library(file):
            here = posixpath.dirname(context.file)
            return quote(posixpath.relpath(file, here or "."))
        place = file.removeprefix(refs.LIBRARY)
        library = library_root().resolve()
        folder = (context.root / context.file).parent
        if folder.is_relative_to(library.parent):
            # As the writer does it: the shipped models name each other by paths.
            whole = (library / place).as_posix()
            return quote(posixpath.relpath(whole, folder.as_posix()))
        copy = copy_in_project(place, folder, context.root)
        if copy is not None:
            return quote(posixpath.relpath(copy.as_posix(), folder.as_posix()))
        return f"{LIBRARY_URI}{quote(place)}"


def file_of(target: ElementCopy | Ref) -> str:
    """Returns the file in which an element will stand."""
    return target.root.file if isinstance(target, ElementCopy) else refs.split(target)[0]


def _is_places(name: str) -> bool:
    return name.partition(":")[2] == "schemaLocation"


def _rank(name: str) -> tuple[int, str]:
    """Orders attributes of a root as the writer does: xmi, xsi, packages by name, features."""
    if name.endswith(":version"):
        return (0, "")
    if not name.startswith("xmlns"):
        return (4, "")
    return {"xmlns:xmi": (1, ""), "xmlns:xsi": (2, "")}.get(name, (3, name))


@dataclass(frozen=True, slots=True)
class Item:
    """One reference as it is written.

    Attributes:
        target: What it means, None when it leads nowhere.
        start: Offset of the fragment in characters.
        text: All of it, for words of an attribute: class and file included.
        node: The child element, None for a word of an attribute.
    """

    target: ElementCopy | Ref | None
    fragment: str
    start: int
    end: int
    text: str = ""
    node: Node | None = None

    @property
    def is_path(self) -> bool:
        """Whether it is a path by features, as EMF writes it."""
        return _PATH.fullmatch(self.fragment) is not None

    @property
    def is_odd(self) -> bool:
        """Whether it is neither such a path nor an id."""
        return "/" in self.fragment and not self.is_path


def items(node: Node, feature: str, source: Source, names: Names) -> list[Item]:
    """Returns the references of a feature, in order."""
    found: list[Item] = []
    if node.get(feature) is not None:
        attribute = source.element(node).attribute(feature)
        if attribute is not None:
            found += _words(attribute, source, names)
    for child in node.children:
        if child.tag == feature:
            found += _of_element(child, source, names)
    return found


def is_odd(node: Node, feature: str) -> bool:
    """Tells whether a reference may be written otherwise than by a path or an id."""
    if "[" in (node.get(feature) or "") or "//" in (node.get(feature) or "").replace("//@", ""):
        return True
    hrefs = (each.get("href") for each in node.children if each.tag == feature)
    return any(each is not None and _is_odd_href(each) for each in hrefs)


def _is_odd_href(href: str) -> bool:
    fragment = href.partition("#")[2]
    return fragment.startswith("/") and _PATH.fullmatch(fragment) is None


def _words(attribute: Attribute, source: Source, names: Names) -> Iterator[Item]:
    written = source.text[attribute.value : attribute.end]
    kind = None
    for match in _WORD.finditer(written):
        word = match.group()
        uri, hash_sign, fragment = word.partition("#")
        if not hash_sign and ":" in word and "/" not in word:
            kind = match  # the class of the reference that follows
            continue
        if not hash_sign:
            uri, fragment = "", word
        end = attribute.value + match.end()
        text = written[kind.start() if kind is not None else match.start() : match.end()]
        yield Item(names.target(uri, fragment), fragment, end - len(fragment), end, text)
        kind = None


def _of_element(child: Node, source: Source, names: Names) -> Iterator[Item]:
    for attribute in source.element(child).attributes:
        prefix, _, local = attribute.name.rpartition(":")
        written = source.text[attribute.value : attribute.end]
        stripped = written.strip()
        if attribute.name == "href":
            uri, _, fragment = stripped.partition("#")
        elif local == "idref" and is_xmi(child.prefixes.get(prefix, "")):
            uri, fragment = "", stripped
        else:
            continue
        end = attribute.value + len(written.rstrip())
        yield Item(names.target(uri, fragment), fragment, end - len(fragment), end, node=child)
        return


def element_lines(copy: ElementCopy, feature: FeatureTable, names: Names) -> list[Line]:
    """Returns the lines of an element with all that it owns."""
    return list(_lines(copy, feature, names, 0))


def value_line(text: str | None, feature: FeatureTable, names: Names) -> str:
    """Returns a value of an attribute as an element."""
    if text is None:
        return f'<{feature.name} {names.xsi()}:nil="true"/>'
    return f"<{feature.name}>{element_text(text)}</{feature.name}>"


def reference_line(target: ElementCopy | Ref, feature: FeatureTable, names: Names) -> str:
    """Returns a reference as an element."""
    kind = names.type_attribute(target, feature)
    return f'<{feature.name}{kind} href="{attribute_text(names.href(target))}"/>'


def _lines(copy: ElementCopy, feature: FeatureTable, names: Names, depth: int) -> Iterator[Line]:
    head = f"<{feature.name}{names.type_attribute(copy, feature)}"
    if copy.identifier:
        head += f' {names.xmi()}:id="{attribute_text(copy.identifier)}"'
    inner: list[Line] = []
    for each in copy.table.features.values():
        text = _as_attribute(copy, each, names)
        if text is not None:
            head += f' {each.name}="{attribute_text(text)}"'
        else:
            inner += _children(copy, each, names, depth + 1)
    if not inner:
        yield (depth, f"{head}/>")
        return
    yield (depth, f"{head}>")
    yield from inner
    yield (depth, f"</{feature.name}>")


def _as_attribute(copy: ElementCopy, feature: FeatureTable, names: Names) -> str | None:
    """Returns what a feature has as the value of an XML attribute, None for elements."""
    if feature.kind is FeatureKind.ATTRIBUTE:
        values = copy.values.get(feature.name, ())
        return values[0] if values and not feature.many else None
    targets = copy.references.get(feature.name, [])
    if feature.kind is not FeatureKind.CROSS_REFERENCE or not targets:
        return None
    if not all(map(names.is_local, targets)):
        return None
    return " ".join(map(names.fragment, targets))


def _children(copy: ElementCopy, feature: FeatureTable, names: Names, depth: int) -> Iterator[Line]:
    for text in copy.values.get(feature.name, ()):
        yield (depth, value_line(text, feature, names))
    for target in copy.references.get(feature.name, ()):
        yield (depth, reference_line(target, feature, names))
    for each in copy.owned.get(feature.name, ()):
        yield from _lines(each, feature, names, depth)
