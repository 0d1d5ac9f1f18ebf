"""Texts by pieces: they give the tree of the whole, whatever was parsed before."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import sweep

from jausml.language.text.reading import parsing
from jausml.language.text.reading.parsing import parse
from jausml.language.text.reading.pieces import Pieces, parsed_text

FEWER = settings(max_examples=max(1, settings().max_examples // 4))
MODELS = Path(__file__).parents[2] / "models"
TEXTS = [each.read_text(encoding="utf-8") for each in sorted(MODELS.rglob("*.ros2jaus"))]
PUT_IN = (
    *("", "}", "{", "})", ")", "(", "[", ";", "}  // }", "} /* more", "*/ }", "/* a", "//"),
    *('"', "`", "component", "component other {", "host", "a { } // b", "a { } b { }"),
    *("struct [ uint8 x ]", "x: { }", ", { }", 'x: "{ \\" {"', "x: `{ }`", "/** About. */", "\r"),
    *("import mappings.pose", "a -> b { c -> d }", "x: {\n  y: 1\n}", "  // alone\n", "\n\n"),
    *("JAUS ReportPose", "JAUS->ROS (", "table t (", "vector v JAUS->ROS (", "a {\n\n}", "\t"),
)


def grown(groups=2, connections=4):
    """A system with bridges with connections, each with comments of all kinds."""
    lines = ["import mappings.velocity_state_sensor", "", "/** All. */", "system grown {"]
    for group in range(groups):
        lines += [f"  // Of {group}.", f"  bridge front_{group} {{  ", f"    address: 1.{group}.1"]
        for each in range(connections):
            lines += [
                "",
                "    // A report, {",
                f'    /** Of "{group}" and }} */',
                f"    connection c{each} {{ // one",
                f"      map: velocity_state  rate: {each}",
                "      topic t { qos: { depth: 5 } }  // } {",
                f'      documentation: "{{ {each} \\" }}"',
                "      /* before",
                "       * the end */",
                "    }  // behind",
            ]
        lines += ["    // Nothing more.", "  }", "", "  host desk", "  placement { host: desk }"]
    return "\n".join([*lines, "  // The end.", "}", "", "// of all", ""])


def told(parsed):
    """Everything that a tree and its tokens say."""
    tokens = [(t.type, str(t), t.line, t.column, t.end_line, t.end_column) for t in parsed.tokens]
    return repr(parsed.document), lists(parsed.document), parsed.faults, tokens


def lists(tree):
    """Where the lists of a tree stand, which its text does not show."""
    pending, found = list(tree.items), []
    while pending:
        item = pending.pop()
        for slot in ("items", "members", "features", "assignments", "entries", "given", "type"):
            inner = getattr(item, slot, None)
            if isinstance(inner, list):
                found.append((getattr(inner, "start", None), getattr(inner, "end", None)))
                pending += inner
        pending += [each for each in getattr(item, "values", ()) if hasattr(each, "items")]
    return found


@pytest.mark.parametrize("text", sweep([grown(), grown(6, 8), *TEXTS], every=5))
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_pieces_give_the_tree_of_the_whole(text, end):
    text = text.replace("\n", end)
    pieces = Pieces()
    assert told(pieces.parsed(text)) == told(parse(text))
    assert told(pieces.parsed(f"\ufeff{text}")) == told(parse(text))


@st.composite
def edits(draw):
    """A text, and its states as it is edited: lines left out, put in, changed and moved."""
    lines = "\n".join(draw(st.lists(st.sampled_from([*TEXTS, grown()]), min_size=1, max_size=2)))
    lines = lines.split("\n")
    end = draw(st.sampled_from(["\n", "\n", "\r\n"]))
    states = [end.join(lines)]
    for _ in range(draw(st.integers(1, 6))):
        before = list(lines)
        at, kind = draw(st.integers(0, len(lines))), draw(st.integers(0, 4))
        if kind == 0:
            lines[at : at + draw(st.integers(0, 2))] = [draw(st.sampled_from(PUT_IN))]
        elif kind == 1:
            lines[at : at + 1] = [each.replace("a", "b") for each in lines[at : at + 1]]
        elif kind == 2:
            taken = lines[at : at + draw(st.integers(1, 40))]
            del lines[at : at + len(taken)]
            other = draw(st.integers(0, len(lines)))
            lines[other:other] = taken
        elif kind == 3:
            lines.insert(at, "")
        elif lines[at : at + 1]:
            place = draw(st.integers(0, len(lines[at])))
            letter = draw(st.sampled_from([*'{}()[]"`/*:,;\\', " ", "x", "1"]))
            lines[at] = lines[at][:place] + letter + lines[at][place:]
        states.append(end.join(lines))
        if draw(st.booleans()):
            lines = before  # else everything is broken soon
    return states


@FEWER
@given(edits())
def test_after_each_edit_the_tree_is_that_of_the_whole(states):
    pieces = Pieces()
    for text in states:
        whole = parse(text)
        rough = pieces.parsed(text)
        assert bool(rough.faults) >= bool(whole.faults)
        assert rough.faults or rough.is_apart
        if rough.is_apart:
            assert told(rough) == told(whole)
        assert told(parsed_text(text)) == told(whole)


@FEWER
@given(edits())
def test_trees_that_were_given_stay_as_they_are(states):
    pieces = Pieces()
    given_before = [pieces.parsed(text) for text in states]
    said = [told(each) for each in given_before]
    for text in reversed(states):
        pieces.parsed(f"\n{text}")
    assert [told(each) for each in given_before] == said


def parsed_by(pieces, text):
    """The characters that are parsed for a text."""
    found = []

    def noted(frame, event, _argument):
        if event == "call" and frame.f_code is parsing.parse_part.__code__:
            found.append(len(frame.f_locals["text"].strip()))

    sys.setprofile(noted)
    try:
        pieces.parsed(text)
    finally:
        sys.setprofile(None)
    return found


@pytest.mark.parametrize("groups", sweep([4, 40, 160], every=3))
def test_what_is_parsed_for_an_edit_does_not_grow_with_the_text(groups):
    """A number: the connection, its bridge around it, and the system around that."""
    text = grown(groups, 8)
    pieces = Pieces()
    pieces.parsed(text)
    edited = text.replace("rate: 5", "rate: 55", 1)
    assert len(parsed_by(pieces, edited)) == 3
    at = text.index("rate: 7", len(text) // 2)
    again = f"{edited[: at + 1]}rate: 77{edited[at + 8 :]}"
    assert len(parsed_by(pieces, again)) == 3


def test_what_has_only_moved_is_not_parsed():
    text = grown(4, 8)
    pieces = Pieces()
    pieces.parsed(text)
    assert len(parsed_by(pieces, f"\n{text}")) == 1, "the import, and the system around the rest"
    assert told(pieces.parsed(f"\n{text}")) == told(parse(f"\n{text}"))
    inside = text.replace("bridge front_1 {", "bridge front_1 {\n", 1)
    # The second bridge and the system around it, and the piece that is another first one.
    assert len(parsed_by(pieces, inside)) == 3


def test_what_is_wrong_in_a_piece_leaves_the_others_alone():
    text = "first { a b c: }\nsecond { x: 1 }\nthird { y: 2 }\n"
    found = Pieces().parsed(text)
    assert [str(item.name.text) for item in found.document.items][-2:] == ["second", "third"]

    text = grown(2, 6).replace("rate: 3", "rate: :")
    (_, whole) = Pieces().parsed(text).document.items
    names = [each.name.text for each in whole.items if each.name and "front" in each.name.text]
    assert names == ["front_0", "front_1"]
    (second,) = [each for each in whole.items if each.name and each.name.text == "front_1"]
    assert len([each for each in second.items if type(each).__name__ == "Element"]) == 6


def test_brackets_too_deep_are_those_of_the_whole():
    text = "a {\n" * 70 + "}\n" * 70
    assert told(Pieces().parsed(text)) == told(parse(text))


@pytest.mark.parametrize("wrong", ["rate", "rate: :", "rate: ( 5", "x -> y", "'5"])
def test_an_error_within_brackets_has_no_other_piece_parsed(wrong):
    text = grown(4, 8)
    pieces = Pieces()
    pieces.parsed(text)
    broken = text.replace("rate: 5", wrong, 1)
    assert len(parsed_by(pieces, broken)) <= 3
    found = pieces.parsed(broken)
    assert found.faults
    if "(" not in wrong:
        assert told(found) == told(parse(broken))
        assert found.is_apart


@pytest.mark.parametrize("put_in", sweep(["{", "}", "/*", "(", '"'], every=5))
def test_what_is_open_has_little_parsed_and_nothing_once_it_is_closed(put_in):
    text = grown(20, 8)
    pieces = Pieces()
    pieces.parsed(text)
    at = text.index("rate: 5", len(text) // 2)
    for typed in (put_in, f"{put_in} ", f"{put_in} a"):
        opened = f"{text[:at]}{typed}{text[at:]}"
        assert sum(parsed_by(pieces, opened)) < 0.1 * len(text)
        assert told(parsed_text(opened)) == told(parse(opened))
    assert sum(parsed_by(pieces, f"{text[:at]} {text[at:]}")) < 0.1 * len(text)


@pytest.mark.slow
def test_of_many_states_few_are_kept():
    pieces, text = Pieces(), grown(2, 8)
    for number in range(50):
        state = text.replace("rate: 5", f"rate: {number}")
        assert told(pieces.parsed(state)) == told(parse(state))
    (kept,) = pieces._kept
    assert (kept.last, kept.closed) == (kept.last, kept.last)
    for number in range(50):
        pieces.parsed(f"component c{number} {{\n}}\n" * number * 9)
    assert len(pieces._kept) <= 8


@pytest.mark.slow
def test_threads_share_the_pieces():
    pieces, text = Pieces(), grown(3, 8)
    states = [text.replace("rate: 5", f"rate: {number}\n" * (number % 3)) for number in range(24)]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(pieces.parsed, states))
    assert list(map(told, found)) == [told(parse(each)) for each in states]
