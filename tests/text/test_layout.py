"""The layout of ros2jaus text: what is written is what is read, and nothing gets lost."""

import dataclasses
import re

from for_each import for_each
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.language.text.reading.parsing import parse
from jausml.language.text.reading.scanning import scan
from jausml.language.text.tree import (
    NOWHERE,
    Assignment,
    Call,
    Clock,
    Direction,
    Element,
    End,
    Entry,
    Feature,
    Href,
    Ignored,
    Import,
    Member,
    Name,
    Number,
    SyntaxTree,
    Table,
    Text,
    Vector,
    VectorEntry,
)
from jausml.language.text.writing.layout import WIDTH, lay_out
from jausml.language.text.writing.spelling import can_document
from jausml.language.text.writing.spelling import documentation as comment_lines


def without_spans(value):
    """Returns a tree that was written nowhere."""
    if isinstance(value, (list, tuple)):
        return (
            type(value)(map(without_spans, value))
            if value.__class__ is tuple
            else [without_spans(child) for child in value]
        )
    if not dataclasses.is_dataclass(value):
        return value
    fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    fields = {name: without_spans(field_value) for name, field_value in fields.items()}
    return type(value)(**{**fields, **({"span": NOWHERE} if "span" in fields else {})})


# Trees as the parser makes them

anything = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)
some_words = st.sampled_from(
    [
        "pose",
        "pose.pose.position.x",
        "/cmd_vel",
        "geometry_msgs/Twist",
        "a[1].b",
        "c[2]",
        ".",
        "x1",
        "import",
        "JAUS",
        "clock",
        "3d",
        "Ünï",
        "my-robot",
        "`",
        "\\",
    ]
)
names = st.builds(Name, some_words | anything | st.just("Sensor is not Active"))
numbers = st.builds(Number, st.sampled_from(["0", "-2", "0x1F", "1.5e-3", "100.1.1", "-Infinity"]))
texts = st.builds(Text, st.sampled_from(["", "a // b", "/* x */", '😀 "\n\t\\']) | anything)
hrefs = st.builds(Href, anything)
line = st.text(st.characters(exclude_categories=["C", "Z"]), max_size=8).map(lambda t: t.strip())
line_comments = line.map(lambda text: f"// {text}".rstrip())
block_comments = line.map(lambda text: f"/* {text.replace('*/', '')} */")
long_comments = st.sampled_from(
    ["/*\n * a\n */", "/* a\n\n     deep\nflat */", "/***\n   art\n***/"]
)
comments = st.lists(line_comments | block_comments | long_comments, max_size=2)
trailing = st.just("") | line_comments | block_comments
documentation = st.just("") | anything.filter(can_document) | st.just("a\n\nb */ *\\/ * c\n\n\n* d")


def commented(strategy):
    """Gives items comments."""

    def adorn(item, before, spaced, behind, said, apart):
        item.comments = [*before, *([""] if before and apart else [])]
        item.trailing, item.documentation, item.spaced = behind, said, spaced
        return item

    plain = strategy
    args = (comments, st.booleans(), trailing, documentation, st.booleans())
    return plain | st.builds(adorn, strategy, *args)


def listed(strategy):
    """Lists of items; the first stands behind no empty line."""

    def first_is_not_spaced(items):
        if items:
            items[0].spaced = False
        return items

    lists = st.lists(commented(strategy), max_size=3).map(first_is_not_spaced)
    # Deferred, for Hypothesis writes out all that a strategy consists of.
    return st.deferred(lambda: lists)


def closed(owner):
    """Gives owners comments before their closing brackets."""

    def close(item, closing, apart):
        inner = next(
            getattr(item, attribute)
            for attribute in ("items", "assignments", "entries", "expected")
            if hasattr(item, attribute)
        )
        if closing:
            item.closing = [*([""] if inner and apart else []), *closing]
        return item

    return owner | st.builds(close, owner, comments, st.booleans())


simple = names | numbers | texts


def features_of(values):
    return st.builds(Feature, names, st.lists(values, min_size=1, max_size=3))


simple_features = features_of(simple | hrefs)
calls = st.builds(Call, names, st.lists(simple, max_size=2).map(tuple))
sources = st.lists(names, min_size=1, max_size=3) | (numbers | texts | st.just(Clock())).map(
    lambda source: [source]
)
assignments = closed(
    st.builds(
        Assignment,
        sources,
        st.lists(names, min_size=1, max_size=2),
        st.lists(calls, max_size=2),
        listed(simple_features),
    )
).filter(lambda block: block.items or not block.closing)
nested_assignments = closed(
    st.builds(
        Assignment,
        sources,
        st.lists(names, min_size=1, max_size=2),
        st.lists(calls, max_size=2),
        listed(assignments | simple_features | st.builds(Ignored, names)),
    )
)
types = names | st.just(Name("string<=20"))
sizes = st.sampled_from(["", "3", "s", "<=5", "*"])
plain_members = st.builds(Member, types, sizes, names, listed(simple_features))
members = plain_members | st.builds(
    Member, listed(plain_members), sizes, names, listed(simple_features)
)
arrays = plain_members.filter(lambda member: member.size and "<=" not in member.type.text)
structs = st.builds(Member, listed(members), st.just(""), st.none(), listed(simple_features))
ends = st.builds(End, st.booleans(), names, st.none() | listed(members), listed(simple_features))
directions = closed(
    st.builds(Direction, st.booleans(), listed(nested_assignments | st.builds(Ignored, names)))
)
tables = closed(st.builds(Table, names, listed(st.builds(Entry, simple, simple))))
vector_entries = st.builds(VectorEntry, names, simple, st.none() | numbers)
vectors = closed(
    st.builds(Vector, names, st.booleans(), listed(vector_entries), listed(vector_entries))
)


def elements_of(items):
    """Elements with certain items."""
    named = st.builds(Element, names, names, listed(items))
    return closed(named | st.builds(Element, st.none(), names, listed(items)))


def blocks_of(items):
    """Blocks as values of features."""
    bare = st.builds(Element, st.none(), st.none(), listed(items))
    return closed(bare | st.builds(Element, names, st.none() | names, listed(items)))


leaves = simple_features | arrays | structs | ends | directions | tables | vectors
block_items = st.recursive(
    leaves, lambda items: elements_of(items) | features_of(simple | blocks_of(items)), max_leaves=6
)
imports = st.builds(Import, names.filter(lambda name: "[" not in name.text) | texts)
documents = closed(
    st.builds(
        SyntaxTree, listed(imports | elements_of(block_items) | simple_features | arrays | structs)
    )
)


@settings(max_examples=25)
@given(documents)
def test_what_is_written_is_read(document):
    text = lay_out(document)
    parsed = parse(text)
    assert parsed.faults == []
    assert without_spans(parsed.document) == without_spans(document)


# Any layout of a text means the same, and gives the same layout

separators = st.sampled_from([" ", "\n", "\n\n\n", "\t", " // why\n", " /* what\n ever */ "])


@settings(max_examples=25)
@given(documents, st.randoms(use_true_random=False), st.data())
def test_layout_is_idempotent_and_keeps_all_tokens_and_comments(document, random, data):
    tokens = scan(lay_out(document)).tokens
    kinds = data.draw(st.lists(separators, min_size=1, max_size=4))
    gaps = [random.choice(kinds) for _ in tokens]
    for position, token in enumerate(tokens):
        if token.type == "NAMED_BRACKET":
            gaps[position] = " "
        elif token.type == "END_BRACKET":
            gaps[position] = "\n"
        elif [neighbour.type for neighbour in tokens[position : position + 2]] == ["WORD", "WORD"]:
            # The two words of an element without a block stand on one line.
            gaps[position] = " "
    loose = "".join(f"{token}{gap}" for token, gap in zip(tokens, gaps, strict=True))
    parsed = parse(loose)
    assert parsed.faults == []
    laid_out = lay_out(parsed.document)
    assert lay_out(parse(laid_out).document) == laid_out
    again = scan(laid_out)
    assert as_text(again.tokens) == as_text(tokens)
    assert squeezed(again.comments) == squeezed(scan(loose).comments)


def as_text(tokens):
    """Returns tokens in a row; empty blocks of assignments, ends and members are left out."""
    return " ".join(tokens).replace(" { }", "")


def squeezed(comments):
    """Returns what comments say, in any order: those within an item go before it."""
    return sorted(re.sub(r"\s+", " ", str(comment)).strip() for comment in comments)


def test_the_layout():
    text = """
// The robot.

import  "robot.xmi"   // ours
import mappings.global_pose;
/** Body velocity.
  *   Twice.  */
velocity_state{JAUS ReportVelocityState ROS nav_msgs/Odometry(geometry_msgs/TwistWithCovariance
twist)
table gear(PARK<->0 DRIVE<->"D")


quantity max_speed{value:8.94;units:"m/s"}
JAUS->ROS(TimeStamp->header.stamp:timestamp_to_time // when
clock->header.stamp
Velocity_X->twist.twist.linear.x{whenAbsent:dropMessage}
Velocity_Y -> twist.twist.linear.y:negate,scale(0.5) ignore twist.twist.linear.z
PointList->poses{X->pose.position.x index->`import`}
// the end
)
vector v ROS->JAUS(x=1 y=2=>Z=0.70711~1e-5)}
/* last */
"""
    assert (
        lay_out(parse(text).document)
        == """\
// The robot.

import "robot.xmi"  // ours
import mappings.global_pose
/** Body velocity. Twice. */
velocity_state {
    JAUS ReportVelocityState
    ROS nav_msgs/Odometry ( geometry_msgs/TwistWithCovariance twist )
    table gear ( PARK <-> 0  DRIVE <-> "D" )

    quantity max_speed { value: 8.94  units: "m/s" }
    JAUS->ROS (
        TimeStamp -> header.stamp : timestamp_to_time  // when
        clock -> header.stamp
        Velocity_X -> twist.twist.linear.x { whenAbsent: dropMessage }
        Velocity_Y -> twist.twist.linear.y : negate, scale(0.5)
        ignore twist.twist.linear.z
        PointList -> poses {
            X -> pose.position.x
            index -> `import`
        }
        // the end
    )
    vector v ROS->JAUS ( x = 1  y = 2 => Z = 0.70711 ~ 1e-5 )
}
/* last */
"""
    )


def test_comments_between_the_halves_of_a_vector_stay_there():
    text = """m {
    vector still JAUS->ROS (
        Speed = 0  // at rest
        // gives
        => data = 0
    )
}
"""
    laid_out = lay_out(parse(text).document)
    assert laid_out.index("at rest") < laid_out.index("gives") < laid_out.index("data")
    assert lay_out(parse(laid_out).document) == laid_out


def test_a_struct_without_name_ends_its_line():
    text = "x {\n    struct []\n    name: 1\n}\n"
    assert lay_out(parse(text).document) == text


def test_lists_share_a_line_while_they_fit():
    members = [Member(Name("float32"), "", Name(f"member_{number}")) for number in range(4)]
    end = End(True, Name("Message"), members)
    short = lay_out(SyntaxTree([end])).splitlines()
    assert len(short) == 1
    end.members += [Member(Name("float32"), "", Name("x" * (WIDTH - len(short[0]) - 10)))]
    fitting = lay_out(SyntaxTree([end])).splitlines()
    assert [len(text_line) for text_line in fitting] == [WIDTH]
    end.members[-1] = Member(Name("float32"), "", Name("x" * (WIDTH - len(short[0]) - 9)))
    assert len(lay_out(SyntaxTree([end])).splitlines()) == 7


def test_values_that_do_not_fit_go_on_in_the_next_line():
    feature = Feature(Name("provides"), [Name("x" * 40) for _ in range(5)])
    text = lay_out(SyntaxTree([feature]))
    assert [len(text_line) <= WIDTH for text_line in text.splitlines()] == [True, True, True]
    assert without_spans(parse(text).document) == SyntaxTree([feature])


@for_each("text", ["", "a", "a */ b", "*\\/", " a", "a ", "\na", "*", "/", "a\nb", "a\n\n* b"])
def test_documentation_that_a_comment_holds(text):
    item = Import(Name("x"), documentation=text)
    back = parse(lay_out(SyntaxTree([item]))).document.items[0]
    assert (back.documentation == text) == (can_document(text) or not text)
    assert can_document(text) == (text not in ("", " a", "a ", "\na", "a\nb"))


def test_documentation_fills_its_lines_and_goes_no_further():
    for room in range(20, 40):
        sizes = [len(comment_line) for comment_line in comment_lines("one two six ten " * 20, room)]
        assert max(sizes) <= room
        assert min(sizes[1:-2]) >= room - len(" two")
