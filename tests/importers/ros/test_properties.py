"""Definitions written from facts are read as these facts; rosidl reads them no other way."""

import contextlib
import io
import json
import os

import needs
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.language.importers.ros import (
    ROS_RULES,
    InterfaceFile,
    PackageSource,
    import_packages,
    placed,
)
from jausml.language.interfaces import parse_definition
from jausml.language.interfaces.definitions import INTEGER_RANGES, PRIMITIVES, TEXTS, FieldType
from jausml.language.model import READER_RULES
from jausml.language.model.xmi.writer import to_xmi
from jausml_generators.ros_interfaces.definitions import package_files

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "60"))
QUICK = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=EXAMPLES < 100,
    suppress_health_check=list(HealthCheck),
)
WORDS = st.sampled_from(["x", "y1", "rope_speed", "a_b_c", "n0", "class", "end_2", "string"])
CONSTANTS = st.sampled_from(["X", "Y1", "ROPE_SPEED", "A_B_C", "N0", "CLASS", "END_2", "E"])
PLAIN = st.text(st.sampled_from("abz09 ,.;:[](){}<>/*é漢😀&%$-_@!?"), max_size=9).map(str.strip)


@st.composite
def types(draw):
    """Draws the type of a field: of this package, of geometry_msgs or primitive."""
    base = draw(st.sampled_from([*PRIMITIVES, "Other", "geometry_msgs/Point"]))
    package, _, name = base.rpartition("/")
    bound = draw(st.integers(0, 9)) if name in TEXTS else 0
    array = draw(
        st.sampled_from(["single", "single", "fixedArray", "boundedSequence", "unboundedSequence"])
    )
    size = draw(st.integers(1, 4)) if array in ("fixedArray", "boundedSequence") else 0
    return FieldType(name, package, bound, array, size)


def scalar(draw, kind):
    """Draws a value as text of a definition, and as models have it."""
    if kind.name in TEXTS:
        text = draw(PLAIN)[: kind.string_bound or 9]
        quote = draw(st.sampled_from("'\""))
        text = text.replace("'", "").replace('"', "")
        inner = text + quote if draw(st.booleans()) and not kind.string_bound else text
        return quote + inner.replace(quote, "\\" + quote) + quote, inner
    if kind.name == "bool":
        text = draw(st.sampled_from(["true", "True", "1", "false", "FALSE", "0"]))
        return text, "true" if text.lower() in ("true", "1") else "false"
    if kind.name.startswith("float"):
        text = repr(draw(st.floats(-1e30, 1e30, allow_nan=False)))
        return text, text
    value = draw(st.integers(*INTEGER_RANGES[kind.name]))
    return draw(st.sampled_from([str(value), hex(value)])), str(value)


@st.composite
def lines(draw, used):
    """Draws a field or a constant: its line, and its facts."""
    comment = draw(st.sampled_from(["", "  # about it", " ## more # signs", "# close"]))
    if draw(st.booleans()):
        name = draw(CONSTANTS.filter(lambda candidate: candidate not in used))
        kind = FieldType(draw(st.sampled_from(PRIMITIVES)))
        text, value = scalar(draw, kind)
        space = draw(st.sampled_from(["", " "]))
        used.add(name)
        return f"{kind} {name}{space}={space}{text}{comment}", ("constant", name, str(kind), value)
    name = draw(WORDS.filter(lambda candidate: candidate not in used))
    kind = draw(types())
    default, value = "", None
    if kind.is_primitive and draw(st.booleans()):
        default, value = default_of(draw, kind)
    used.add(name)
    gap = draw(st.sampled_from([" ", "   "]))
    return f"{kind}{gap}{name}{gap}{default}{comment}", ("field", name, str(kind), value)


def default_of(draw, kind):
    if kind.array == "single":
        return scalar(draw, kind)
    count = kind.array_size if kind.array == "fixedArray" else draw(st.integers(0, 2))
    count = min(count, kind.array_size) if kind.array == "boundedSequence" else count
    single = FieldType(kind.name, "", kind.string_bound)
    pairs = [scalar(draw, single) for _ in range(count)]
    text = ", ".join(literal for literal, _ in pairs)
    # As rosidl has it, blanks at the ends of an element are lost even inside quotes.
    texts = [json.dumps(v.strip(), ensure_ascii=False) for _, v in pairs]
    shown = texts if kind.name in TEXTS else [v for _, v in pairs]
    return f"[{text}]", f"[{', '.join(shown)}]"


@st.composite
def messages(draw):
    used: set[str] = set()
    drawn = [draw(lines(used)) for _ in range(draw(st.integers(0, 6)))]
    ending = draw(st.sampled_from(["\n", "\r\n"]))
    return ending.join([*(line for line, _ in drawn), ""]), [facts for _, facts in drawn]


def facts_of(package):
    """Returns the facts of the message M of an imported package, constants apart."""
    (found,) = [message for message in package.messages if message.name == "M"]
    fields = []
    for field in found.fields:
        common = (field.arrayKind.name, field.arraySize)
        if field.eClass.name == "PrimitiveField":
            kind = FieldType(field.type.name, "", field.stringBound, *common)
            fields.append(("field", field.name, str(kind), field.defaultValue))
        else:
            owner = field.messageType.eContainer().name
            owner = "" if owner == "demo_msgs" else owner
            kind = FieldType(field.messageType.name, owner, 0, *common)
            fields.append(("field", field.name, str(kind), None))
    constants = [("constant", c.name, c.type.name, c.value) for c in found.constants]
    return fields, constants


def written(package):
    """Returns the text of the message M as the target ros_interfaces writes it."""
    (file,) = [
        package_file for package_file in package_files(package, "") if package_file.name == "M"
    ]
    return "\n".join(file.sections[0].lines)


OTHER = PackageSource("geometry_msgs", [InterfaceFile("Point.msg", b"float64 x\n")])


@QUICK
@given(messages())
def test_facts_survive_the_import(drawn):
    text, facts = drawn
    own = PackageSource(
        "demo_msgs",
        [InterfaceFile("M.msg", text.encode()), InterfaceFile("Other.msg", b"uint8 x\n")],
    )
    result = import_packages([own, OTHER], library=False)
    assert result.diagnostics == []
    fields, constants = facts_of(result.packages[0])
    assert fields == [fact for fact in facts if fact[0] == "field"]
    assert constants == [fact for fact in facts if fact[0] == "constant"]
    again = InterfaceFile("M.msg", written(result.packages[0]).encode())
    own = PackageSource("demo_msgs", [again, own.files[1]])
    result = import_packages([own, OTHER], library=False)
    assert result.diagnostics == []
    assert facts_of(result.packages[0]) == (fields, constants)


@QUICK
@given(messages())
def test_rosidl_reads_the_same(drawn):
    needs.ask("rosidl")
    from rosidl_adapter import parser

    text, _ = drawn
    ours = parse_definition(text, "msg").sections[0]
    theirs = parser.parse_message_string("demo_msgs", "M", text)
    assert_same(ours, theirs)


def assert_same(ours, theirs):
    """Holds what we read against what rosidl read."""
    assert len(ours.fields) == len(theirs.fields)
    for mine, field in zip(ours.fields, theirs.fields, strict=True):
        kind = str(field.type).replace("demo_msgs/", "")
        assert (mine.name, str(mine.type)) == (field.name, kind)
        assert (mine.default is None) == (field.default_value is None)
        if mine.default is not None:
            assert same_value(mine.default, mine.type, field.default_value)
    assert len(ours.constants) == len(theirs.constants)
    for mine, constant in zip(ours.constants, theirs.constants, strict=True):
        assert (mine.name, mine.type) == (constant.name, constant.type)
        assert same_value(mine.value, FieldType(mine.type), constant.value)


def same_value(text, kind, value):
    if kind.array != "single":
        return json.loads(text) == value
    if kind.name in TEXTS:
        return text == value
    return json.loads(text) == value


TOKENS = st.sampled_from(
    [
        *(
            "float64",
            "uint8",
            "string",
            "string<=3",
            "bool[]",
            "int8[2]",
            "Point",
            "a/B",
            "float63",
        ),
        *("x", "y_1", "X", "A", "=", "==", "1", "-1", "0x10", "1.5", "true", "[", "]", "[1, 2]"),
        *('"a"', '"', "'", "\\", "#", "# c", "---", "\n", "\n", "\r\n", "\t", " ", "  ", "<=", "é"),
        *("\x00", "\x0c", "\u2028", "\ufeff", "[m/s]", "Header", "1e400", "1_000", "٣"),
    ]
)


@QUICK
@given(st.lists(TOKENS, max_size=30), st.sampled_from(["msg", "srv", "action"]))
def test_any_text_is_read_or_refused_with_its_place(tokens, kind):
    data = " ".join(tokens).encode()
    source = InterfaceFile(f"M.{kind}", data)
    result = import_packages([PackageSource("demo_msgs", [source])], library=False)
    for diagnostic in result.diagnostics:
        assert diagnostic.rule in ROS_RULES or diagnostic.rule in READER_RULES
        assert 1 <= diagnostic.location.line <= len(data.decode().splitlines()) + 1
        assert diagnostic.location.column >= 1
    if not result.has_errors:
        places = {"out.xmi": result.packages}
        assert to_xmi(result.packages, placed(result, places), "out.xmi")


@QUICK
@given(st.lists(TOKENS, max_size=12))
def test_what_is_accepted_rosidl_accepts_and_reads_the_same(tokens):
    needs.ask("rosidl")
    from rosidl_adapter import parser

    # rosidl stumbles over fields that are indented; they are as clear as others.
    text = "\n".join(line.strip() for line in " ".join(tokens).splitlines())
    ours = parse_definition(text, "msg")
    if ours.faults:
        return
    with contextlib.redirect_stderr(io.StringIO()):
        theirs = parser.parse_message_string("demo_msgs", "M", text.removeprefix("\ufeff").lstrip())
    assert_same(ours.sections[0], theirs)


@QUICK
@given(st.binary(max_size=60))
def test_any_bytes(data):
    source = PackageSource("demo_msgs", [InterfaceFile("M.msg", data)])
    import_packages([source], library=False)
