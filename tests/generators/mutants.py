"""Mutants of models: attributes, references and elements changed at random, by the metamodels.

A mutant is drawn with a function that chooses one of some things, so that hypothesis can make a
failing one small and a plain run can make thousands.
"""

import copy
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import TypeVar
from xml.etree import ElementTree

from jausml.language.metamodel import (
    ClassTable,
    FeatureKind,
    FeatureTable,
    ValueKind,
    load_metamodels,
)
from jausml.language.model import read_models
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.notation import NOTATIONS

Thing = TypeVar("Thing")
Choose = Callable[[Sequence[Thing]], Thing]
Element = ElementTree.Element

ROOT = Path(__file__).resolve().parents[2]
MODELS, CASES, HERE = ROOT / "models", ROOT / "tests" / "cases", Path(__file__).parent
XMI, XSI = "http://www.omg.org/XMI", "http://www.w3.org/2001/XMLSchema-instance"
_TYPE, _ID = f"{{{XSI}}}type", f"{{{XMI}}}id"

SEEDS = (
    MODELS / "minimal" / "minimal.xmi",
    MODELS / "catvehicle" / "catvehicle.xmi",
    MODELS / "examples" / "waypoints" / "waypoints.ros2jaus",
    MODELS / "examples" / "winch" / "winch.xmi",
    CASES / "hostile_strings" / "model.xmi",
    CASES / "ros_node" / "features.xmi",
    CASES / "ros_node" / "hosts.xmi",
    CASES / "bridge_loop" / "model.xmi",
    HERE / "checked_bridge.ros2jaus",
    HERE / "narrow_bridge.xmi",
    HERE / "lamp.xmi",
)

TEXTS = (
    *("", " ", ".", "/", "-", "_", "0", "x", "A", "self", "None", "class", "lambda", "match"),
    *("con", "nul.msg", "aux", "../../x", "/etc/passwd", "a//b", "a/b", "~x", "~/x", "{sub}/x"),
    *("json", "rclpy", "std_msgs", "jausml_runtime", "messages", "main", "test", "node", "data"),
    *("__init__", "__class__", "_x", "x_", "X", "x_2", "X2", "x__y", "X_y", "pi", "time", "header"),
    *("é", "größe", "ﬁ", "\u2028", "\ufeff", "\U0001f600", "名前", "a\tb", "a\nb", "a\rb"),
    *("'", '"', '"""', "'''", "\\", "\\N{x}", "#", "-->", "]]>", "{{x}}", "{%x%}", "%s", "${x}"),
    *("coding:utf-7", "x" * 130, "x" * 300, "a.b", "a[0]", "a[-1]", "a[99999]", "a,b", "a , ,b"),
    *("true", "nan", "inf", "1e308", "-1e-320", "9" * 30, "0x10", "1_0", "1.0", "m", "m/s^", "%"),
    *("a and", "not", "a or b", "sin(x)", "1/0", "2**999", "x*x", "(((((x)))))", "if", "0.0.0"),
)
INTEGERS = (0, 1, -1, 2, 3, 7, 8, 63, 64, 127, 128, 255, 256, 65535, 65536, 4194304, 2**31 - 1)
REALS = ("0", "-0.0", "1", "-1", "0.1", "1e-9", "1e9", "1e308", "-1e308", "5e-324", "NaN", "INF")


@cache
def seed_texts() -> tuple[str, ...]:
    """Returns the models that mutants are made of, as XMI that holds in any folder."""
    return tuple(_as_xmi(path) for path in SEEDS)


def _as_xmi(path: Path) -> str:
    result = read_models([path], project_root=ROOT, notations=NOTATIONS)
    assert not result.has_errors, result.diagnostics
    model = result.model
    # What a seed refers to outside of the library comes along.
    roots = [r for d in model.documents if not d.is_library for r in d.roots]
    return to_xmi(roots, model, Path("/elsewhere") / "model.xmi")


def mutant(choose: Choose, texts: Sequence[str]) -> str:
    """Returns a changed model.

    Args:
        choose: Chooses one of some things.
        texts: The models to change one of.
    """
    root = ElementTree.fromstring(choose(texts))  # noqa: S314 - of this repository
    for _ in range(choose((1, 1, 1, 2, 3, 5))):
        places = list(_places(root))
        _CHANGES[choose(tuple(_CHANGES))](choose, root, places)
    return _written(root)


def _written(root: Element) -> str:
    """Returns the document; values of xsi:type need prefixes that no tag may use."""
    packages = load_metamodels().packages
    names = {XMI: "xmi", XSI: "xsi", **{uri: package.name for uri, package in packages.items()}}
    for uri, prefix in names.items():
        ElementTree.register_namespace(prefix, uri)
    text = ElementTree.tostring(root, encoding="unicode")
    head, end, rest = text.partition(">")
    lost = (f' xmlns:{name}="{uri}"' for uri, name in names.items() if f'"{uri}"' not in head)
    slash = "/" if head.endswith("/") else ""
    return f"{head.removesuffix('/')}{''.join(lost)}{slash}{end}{rest}"


def _places(root: Element) -> Iterator[tuple[Element, Element | None, ClassTable]]:
    """Yields elements with their owners and classes; those with an href are references."""
    classes = load_metamodels().classes
    pending: list[tuple[Element, Element | None, ClassTable | None]] = []
    pending = [(root, None, _root_class(root))]
    if pending[0][2] is None:
        pending = [(top_element, root, _root_class(top_element)) for top_element in root]
    while pending:
        element, owner, table = pending.pop()
        if table is None:
            continue
        yield element, owner, table
        for child in element:
            feature = table.features.get(child.tag)
            written = child.get(_TYPE)
            if feature is None or feature.target is None or child.get("href"):
                continue
            kind = classes.get(written.replace(":", ".")) if written else feature.target
            pending.append((child, element, kind))


def _root_class(element: Element) -> ClassTable | None:
    namespace, _, name = element.tag[1:].partition("}")
    package = load_metamodels().packages.get(namespace)
    return package.classes.get(name) if package else None


def _value(choose: Choose, root: Element, feature: FeatureTable) -> str:
    data_type = feature.data_type
    if data_type is None:
        ids = [element.get(_ID) for element in root.iter() if element.get(_ID)]
        return choose([*ids, "", "nobody"])
    if data_type.kind is ValueKind.ENUMERATION:
        return choose(data_type.legal)
    if data_type.kind is ValueKind.BOOLEAN:
        return choose(("true", "false"))
    if data_type.kind is ValueKind.INTEGER:
        ends = (data_type.minimum, data_type.maximum)
        return str(choose([n for n in (*INTEGERS, *ends) if ends[0] <= n <= ends[1]]))
    if data_type.kind is ValueKind.REAL:
        return choose(REALS)
    others = {element.get(feature.name) for element in root.iter()} - {None}
    return choose([*TEXTS, *sorted(others), *sorted(others)])


def _assign(choose: Choose, root: Element, places: list) -> None:
    """Changes an attribute, written or not."""
    element, _, table = choose(places)
    settable = [
        candidate
        for candidate in table.features.values()
        if candidate.settable
        and candidate.kind is not FeatureKind.CONTAINMENT
        and not candidate.many
    ]
    written = [candidate for candidate in settable if element.get(candidate.name) is not None]
    feature = choose([*settable, *written, *written])
    element.set(feature.name, _value(choose, root, feature))


def _many(choose: Choose, root: Element, places: list) -> None:
    """Changes the values of an attribute that has many, e.g. the dimensions of an array."""
    found = [
        (element, feature)
        for element, _, table in places
        for feature in table.features.values()
        if feature.many and feature.data_type is not None and feature.settable
    ]
    if not found:
        return
    element, feature = choose(found)
    for child in element.findall(feature.name):
        element.remove(child)
    element.attrib.pop(feature.name, None)
    for _ in range(choose((0, 1, 2, 4))):
        ElementTree.SubElement(element, feature.name).text = _value(choose, root, feature)


def _forget(choose: Choose, _root: Element, places: list) -> None:
    """Takes an attribute away."""
    element, _, _ = choose(places)
    if element.attrib:
        del element.attrib[choose(sorted(element.attrib))]


def _drop(choose: Choose, _root: Element, places: list) -> None:
    """Takes an element away."""
    element, owner, _ = choose(places)
    if owner is not None:
        owner.remove(element)


def _double(choose: Choose, _root: Element, places: list) -> None:
    """Puts a copy of an element beside it, under another id and perhaps another name."""
    element, owner, _ = choose(places)
    if owner is None:
        return
    twin = copy.deepcopy(element)
    for number, descendant in enumerate(twin.iter()):
        if descendant.get(_ID):
            descendant.set(_ID, f"{descendant.get(_ID)}.twin{number}.{len(owner)}")
    if choose((True, True, False)) and twin.get("name"):
        twin.set("name", f"{twin.get('name')}_2")
    owner.insert(list(owner).index(element) + choose((0, 1)), twin)


def _exchange(choose: Choose, _root: Element, places: list) -> None:
    """Exchanges what two elements of one class hold, or their order."""
    element, _owner, table = choose(places)
    others = [
        candidate for candidate, _, kind in places if kind is table and candidate is not element
    ]
    if not others:
        return
    other = choose(others)
    if choose((True, False)):
        element[:], other[:] = list(other), list(element)
    else:
        name = choose(sorted({*element.attrib, *other.attrib} - {_ID}) or ["name"])
        one, two = element.get(name), other.get(name)
        for receiver, value in ((element, two), (other, one)):
            if value is None:
                receiver.attrib.pop(name, None)
            else:
                receiver.set(name, value)


def _point(choose: Choose, root: Element, _places: list) -> None:
    """Lets a reference point at what another one points at."""
    found = [referrer for referrer in root.iter() if referrer.get("href")]
    if found:
        element = choose(found)
        element.set("href", choose(found).get("href") or "")


_CHANGES = {
    "assign": _assign, "assign more": _assign, "assign still more": _assign, "many": _many,
    "forget": _forget, "drop": _drop, "double": _double, "exchange": _exchange, "point": _point,
}  # fmt: skip
