"""Planner of changes of XMI files: what the file will hold is printed as EMF saves it.

What was not read, such as a reference that leads nowhere, is printed as it is written.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

from jausml.authoring.editing.applying import NAME
from jausml.authoring.editing.commands import Add, EditError, ElementCommand, Rename, Set
from jausml.authoring.editing.drafts import Context
from jausml.authoring.editing.working_copy import ElementCopy, attribute_values
from jausml.authoring.editing.xmi.comments import Comments
from jausml.authoring.editing.xmi.names import Names
from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable
from jausml.language.model.names import name_of
from jausml.language.model.reading.classes import is_xmi
from jausml.language.model.refs import Ref
from jausml.language.model.xmi.parsing import Node
from jausml.language.model.xmi.printing import (
    XSI,
    DocumentPrinter,
    UnwritableError,
    attribute_text,
    element_text,
)
from jausml.language.text.reading.scanning import line_end

Target: TypeAlias = ElementCopy | Ref

_ENCODING = re.compile(r"""\ufeff?<\?xml[^>]*?encoding\s*=\s*["']([\w.:-]+)""")


def print_xmi(commands: Sequence[ElementCommand], context: Context) -> bytes | None:
    """Returns an XMI file in which commands hold, all of one state; None where it stays as it is.

    `EditError`: its encoding cannot be written again.
    """
    return _printed(commands, context) if _Touch(context).is_touched(commands) else None


def is_laid_out_xmi(context: Context) -> bool:
    """Tells whether an XMI file is laid out as `print_xmi` does it."""
    try:
        return _printed((), context) == context.document.data
    except (EditError, UnwritableError):
        return False


def _printed(commands: Sequence[ElementCommand], context: Context) -> bytes:
    document = context.document
    if not document.root_nodes:
        return document.data
    try:
        old = document.data.decode(document.encoding)
        # Some codecs do not give back what they read, and the rest of the file must stay as it is.
        is_same = old.encode(document.encoding) == document.data
    except (LookupError, ValueError):
        is_same = False
    if not is_same:
        message = f"the encoding {document.encoding} of {context.file} cannot be kept"
        raise EditError(f"{message}: save it as UTF-8")
    stated = _ENCODING.match(old)
    # A declaration says UTF-16; which byte comes first is told by the byte order mark.
    encoding = stated.group(1) if stated else document.encoding[:6].upper()
    lines = [f'<?xml version="1.0" encoding="{encoding}"?>', *_Printer(commands, context).lines()]
    text = "\n".join([*lines, ""]).replace("\n", line_end(old))
    mark = "\ufeff" if old.startswith("\ufeff") else ""
    return f"{mark}{text}".encode(document.encoding, "xmlcharrefreplace")


class _Touch:
    """Finder of commands that concern a file; without one, the file stays as it is laid out."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._working_copy = context.working_copy

    def is_touched(self, commands: Sequence[ElementCommand]) -> bool:
        if any(map(self._changes, commands)):
            return True
        # A reference by position must follow its target, even where its file is not edited.
        before, after = self._context.paths, self._working_copy.paths()
        shifted = {copy for copy, path in before.items() if after.get(copy) != path}
        shifted |= {copy for copy in after if copy.root.file != copy.file}
        return bool(shifted) and any(
            copy.file == self._context.file for copy, _ in self._working_copy.referrers(shifted)
        )

    def _changes(self, command: ElementCommand) -> bool:
        named = command.owner if isinstance(command, Add) else command.element
        copy = self._working_copy.find(named)
        if copy is None:
            return False
        file = self._context.file
        if isinstance(command, Rename):
            # Of other files only those that refer by names are concerned.
            return copy.obj is not None and name_of(copy.obj) != command.name
        if isinstance(command, Set):
            return copy.file == file and self._differs(copy, command)
        return file in (copy.file, copy.root.file)

    def _differs(self, copy: ElementCopy, command: Set) -> bool:
        name, feature = command.feature, copy.table.features[command.feature]
        node = self._context.model.node_of(copy.obj) if copy.obj is not None else None
        if feature.kind is not FeatureKind.ATTRIBUTE:
            before = self._working_copy.references_of(copy).get(name, [])
            return before != copy.references.get(name, [])
        is_unsaid = not command.values and node is not None and node.get(name) is not None
        return is_unsaid or attribute_values(copy.obj, feature) != copy.values.get(name, ())


class _Printer(DocumentPrinter[Target]):
    """Printer of one file from the working copy, with its comments."""

    def __init__(self, commands: Sequence[ElementCommand], context: Context) -> None:
        super().__init__(context.model.metamodels)
        self._context = context
        root = context.document.root_nodes[0]
        self._root = root.parent or root
        self._is_wrapped = root.parent is not None
        self._names = Names(context, self._root)
        self._comments: dict[str, Comments] = {}
        self._spaces: dict[str, str] = {}
        self._set = {
            (
                context.working_copy.find(command.element),
                command.feature if isinstance(command, Set) else NAME,
            )
            for command in commands
            if isinstance(command, Set | Rename)
        }

    def lines(self) -> list[str]:
        """Returns the lines of the document behind its declaration."""
        roots = self._context.working_copy.roots[self._context.file]
        comments = self._comments_of(self._context.file)
        if not self._is_wrapped and len(roots) == 1:
            return [*self.lines_of_document(roots, is_wrapped=False), *comments.last]
        lines = self.lines_of_document(roots, is_wrapped=True)
        if self._is_wrapped:
            lines = list(self._commented(self._root, self._context.file, lines, ""))
        return [*lines, *comments.last]

    # What is printed

    def table_of(self, element: Target) -> ClassTable:
        if isinstance(element, ElementCopy):
            return element.table
        obj, model = self._context.locate(element)
        return model.metamodels.class_of(obj)

    def identifier_of(self, element: Target) -> str | None:
        if not isinstance(element, ElementCopy) or not element.identifier:
            return None
        identifying = element.table.id_feature
        said = element.values.get(identifying.name, ()) if identifying is not None else ()
        return element.identifier if element.identifier not in said else None

    def values_of(self, element: Target, feature: FeatureTable) -> Sequence[str | None]:
        return element.values.get(feature.name, ()) if isinstance(element, ElementCopy) else ()

    def targets_of(self, element: Target, feature: FeatureTable) -> Sequence[Target]:
        if not isinstance(element, ElementCopy):
            return ()
        targets: list[Target] = [*element.references.get(feature.name, ())]
        return [*targets, *element.owned.get(feature.name, ())]

    def fragment_of(self, target: Target) -> str | None:
        return self._names.fragment(target) if self._names.is_local(target) else None

    def href_of(self, target: Target) -> str:
        return self._names.href(target)

    def is_apart(self, element: Target) -> bool:
        return not self._names.is_local(element)

    def namespaces(self) -> Mapping[str, str]:
        return {**super().namespaces(), **self._spaces}

    def further_attributes(self) -> str:
        """Returns the attributes of the root by which Eclipse finds metamodels, as it has them."""
        attributes = ""
        for name, text in _attributes(self._root):
            space, _, local = name.rpartition(" ")
            if space == XSI and local != "type":
                places = self._located(text) if local == "schemaLocation" else text
                attributes += f' xsi:{local}="{attribute_text(places)}"'
                self.has_types = True
        return attributes

    def _located(self, text: str) -> str:
        """Returns the schema locations, with that of a new namespace if the file has others.

        It lies beside theirs; without its place Eclipse opens the file no longer.
        """
        packages = self.metamodels.packages
        words = text.split()
        known = dict(zip(words[::2], words[1::2], strict=False))
        folders = [
            place.removesuffix(file)
            for uri, place in known.items()
            if uri in packages and place.endswith(file := f"{packages[uri].name}.ecore")
        ]
        used = {
            package.ns_uri: package.name
            for package in packages.values()
            if package.name in self.prefixes
        }
        new = used.keys() - known.keys() - set(self._root.prefixes.values())
        if not folders or not new:
            return text
        known |= {uri: f"{folders[0]}{used[uri]}.ecore" for uri in new}
        return " ".join(f"{uri} {place}" for uri, place in sorted(known.items()))

    # What an element has besides, and what was not read

    def lines_of(self, element: Target, tag: str, head: str, indent: str) -> Iterator[str]:
        lines = super().lines_of(element, tag, head, indent)
        node = self._node(element)
        if node is None or not isinstance(element, ElementCopy):
            return lines
        unknown = [child for child in node.children if child.tag not in element.table.features]
        inner = [
            line
            for unknown_node in unknown
            for line in self._raw(unknown_node, element.file, f"{indent}  ")
        ]
        attributes = "".join(self._unknown_attributes(node, element.table))
        if attributes:
            lines = super().lines_of(element, tag, head + attributes, indent)
        inner += self._homeless(element, node, indent)
        return self._commented(node, element.file, lines, indent, inner)

    def attribute(self, element: Target, feature: FeatureTable) -> str | None:
        node = self._unread(element, feature)
        if node is None:
            return super().attribute(element, feature)
        text = node.get(feature.name)
        if text is None or feature.kind is not FeatureKind.CROSS_REFERENCE:
            return text
        return " ".join(map(self._followed, text.split()))

    def children(self, element: Target, feature: FeatureTable, indent: str) -> Iterator[str]:
        node = self._node(element)
        plain = _plain(node, feature.name)
        if not plain or not isinstance(element, ElementCopy):
            yield from super().children(element, feature, indent)
            return
        if feature.kind is FeatureKind.CONTAINMENT:
            yield from self._mixed(element, feature, indent)
            return
        is_unread = self._unread(element, feature) is not None
        lines = iter(() if is_unread else super().children(element, feature, indent))
        for child_node in plain:
            if is_unread:
                yield from self._raw(child_node, element.file, indent)
            else:
                child_lines = (line for line in (next(lines, None),) if line is not None)
                yield from self._commented(child_node, element.file, child_lines, indent)
        yield from lines

    def _mixed(self, copy: ElementCopy, feature: FeatureTable, indent: str) -> Iterator[str]:
        """Yields the parts of an element, with the elements of other files at their old places."""
        node = self._node(copy)
        owned = copy.owned.get(feature.name, [])
        known = self._context.working_copy.copies
        plain: list[Node] = []
        before: defaultdict[ElementCopy, list[Node]] = defaultdict(list)
        for child in node.children if node is not None else ():
            if child.tag == feature.name and child.obj is None:
                plain.append(child)
            elif child.tag == feature.name and known.get(child.obj) in owned:
                before[known[child.obj]] = plain
                plain = []
        apart = iter(copy.references.get(feature.name, ()))
        is_unread = self._unread(copy, feature) is not None
        # None stands for the end: what is behind the last element.
        for owned_copy in (*owned, None):
            for child in before[owned_copy] if owned_copy is not None else plain:
                if is_unread:
                    yield from self._raw(child, copy.file, indent)
                elif (target := next(apart, None)) is not None:
                    href = attribute_text(self.href_of(target))
                    line = f'{indent}<{self.child_tag(target, feature)} href="{href}"/>'
                    yield from self._commented(child, copy.file, [line], indent)
            if owned_copy is not None:
                yield from self.lines_of(
                    owned_copy, self.child_tag(owned_copy, feature), "", indent
                )

    def _homeless(self, copy: ElementCopy, node: Node, indent: str) -> Iterator[str]:
        """Yields the comments at child elements that an XML attribute takes the place of."""
        for child in node.children if self._comments_of(copy.file).before else ():
            feature = copy.table.features.get(child.tag)
            if feature is None or child.obj is not None:
                continue
            if self.attribute(copy, feature) is not None:
                yield from self._commented(child, copy.file, (), f"{indent}  ")

    def _unread(self, element: Target, feature: FeatureTable) -> Node | None:
        """Returns the node of an element whose feature is printed as it is written."""
        if not isinstance(element, ElementCopy) or (element, feature.name) in self._set:
            return None
        model = self._context.working_copy.models[element.file]
        names = model.unread.get(id(element.obj), ())
        is_unread = feature.name in names or "" in names
        return self._node(element) if is_unread else None

    def _unknown_attributes(self, node: Node, table: ClassTable) -> Iterator[str]:
        for name, text in _attributes(node):
            space, _, local = name.rpartition(" ")
            if space not in ("", XSI) and not is_xmi(space):
                yield f' {self._prefixed(node, space)}{local}="{attribute_text(text)}"'
            elif not space and local not in table.features and local != "href":
                yield f' {local}="{attribute_text(text)}"'

    def _raw(self, node: Node, file: str, indent: str) -> Iterator[str]:
        """Yields the lines of an XML element as it is written."""
        tag = f"{self._prefixed(node, node.namespace)}{node.tag}"
        head = f"{indent}<{tag}"
        for name, text in _attributes(node):
            space, _, local = name.rpartition(" ")
            if local == "type" and ":" in text:
                prefix = text.partition(":")[0].strip()
                self._spaces |= {prefix: node.prefixes[prefix]} if prefix in node.prefixes else {}
            value = self._followed(text) if name == "href" else text
            head += f' {self._prefixed(node, space)}{local}="{attribute_text(value)}"'
        inner = [line for child in node.children for line in self._raw(child, file, f"{indent}  ")]
        if inner:
            lines = [f"{head}>", *inner, f"{indent}</{tag}>"]
        else:
            text = element_text(node.text)
            lines = [f"{head}>{text}</{tag}>" if text.strip() else f"{head}/>"]
        return self._commented(node, file, lines, indent)

    def _prefixed(self, node: Node, space: str) -> str:
        if not space:
            return ""
        prefix = next(prefix for prefix, uri in node.prefixes.items() if uri == space)
        if prefix and prefix != "xml" and not is_xmi(space):
            self._spaces[prefix] = space
        # Whatever version of XMI was read, what is written has one.
        return f"{'xmi' if is_xmi(space) else prefix}:" if prefix else ""

    def _followed(self, word: str) -> str:
        """Returns a reference as it is to be written; a dangling one stays as it is."""
        uri, mark, fragment = word.partition("#")
        target = self._names.target(uri, fragment) if mark else self._names.target("", word)
        if target is None:
            return word
        return self._names.href(target) if mark else self._names.fragment(target)

    # Comments

    def _node(self, element: Target) -> Node | None:
        if not isinstance(element, ElementCopy) or element.obj is None:
            return None
        model = self._context.working_copy.models[element.file]
        return model.node_of(element.obj) if model.documents[0].is_xml else None

    def _comments_of(self, file: str) -> Comments:
        comments = self._comments.get(file)
        if comments is None:
            document = self._context.working_copy.models[file].documents[0]
            comments = self._comments[file] = Comments(document.data)
        return comments

    def _commented(
        self, node: Node, file: str, lines: Iterable[str], indent: str, inner: Iterable[str] = ()
    ) -> Iterator[str]:
        """Yields lines of an element with its comments.

        `inner`: further lines, to stand before its end tag.
        """
        comments, at = self._comments_of(file), node.offset
        yield from (f"{indent}{comment}" for comment in comments.before.get(at, ()))
        closing = [*inner, *(f"{indent}  {comment}" for comment in comments.closing.get(at, ()))]
        trailing = comments.trailing.get(at, ())
        if not closing and not trailing:
            yield from lines
            return
        whole = list(lines)
        if not whole:
            yield from (
                f"{indent}{comment}" for comment in (*comments.closing.get(at, ()), *trailing)
            )
            return
        # An empty element has no end tag yet, before which they could stand.
        if closing and len(whole) == 1 and whole[0].endswith("/>"):
            tag = re.split(r"[\s/>]", whole[0].strip()[1:], maxsplit=1)[0]
            whole = [f"{whole[0][:-2]}>", f"{indent}</{tag}>"]
        elif closing and len(whole) == 1:
            whole = [
                *(comment.strip() and f"{indent}{comment.strip()}" for comment in closing),
                *whole,
            ]
            closing = []
        whole[-1:] = [*closing, "  ".join((whole[-1], *trailing))]
        yield from whole


def _plain(node: Node | None, tag: str) -> list[Node]:
    """Returns the child elements of a feature that are no elements of the model."""
    children = node.children if node is not None else ()
    return [child for child in children if child.tag == tag and child.obj is None]


def _attributes(node: Node) -> Iterator[tuple[str, str]]:
    return zip(node.attributes[::2], node.attributes[1::2], strict=True)
