"""Texts in segments: parsed one by one they give the tree of the whole."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.text.reading.parsing import joined, parse, parse_segment, segments_of

MODELS = Path(__file__).parents[2] / "models"
TEXTS = [each.read_text(encoding="utf-8") for each in sorted(MODELS.rglob("*.ros2jaus"))]
PUT_IN = (
    *(
        "",
        "}",
        "{",
        "})",
        ")",
        "(",
        "[",
        ";",
        "}  // }",
        "} /* more",
        "*/ }",
        "/* a",
        "//",
        '"',
        "`",
    ),
    *("component", "component other {", "host", "a { } // b", "a { } b { }", "struct [ uint8 x ]"),
    *("x: { }", ", { }", 'x: "{ \\" {"', "x: `{ }`", "import mappings.pose", "/** About. */", "\r"),
)


def in_pieces(text):
    return joined([parse_segment(line, segment) for line, segment in segments_of(text)])


def told(parsed):
    """Everything that a tree and its tokens say."""
    tokens = [(t.type, str(t), t.line, t.column, t.end_line, t.end_column) for t in parsed.tokens]
    return repr(parsed.document), tokens


@pytest.mark.parametrize("text", TEXTS)
def test_segments_give_the_tree_of_the_whole(text):
    assert told(in_pieces(text)) == told(parse(text))


@st.composite
def texts(draw):
    """Parts of texts one after the other, with lines left out and put in."""
    lines = [line for each in draw(st.lists(st.sampled_from(TEXTS), max_size=3)) for line in each]
    lines = "".join(lines).split("\n")
    for _ in range(draw(st.integers(0, 5))):
        at = draw(st.integers(0, len(lines)))
        lines[at : at + draw(st.integers(0, 2))] = draw(
            st.lists(st.sampled_from(PUT_IN), max_size=2)
        )
    return "\n".join(lines)


@given(texts())
def test_segments_without_errors_give_the_tree_of_the_whole(text):
    found = in_pieces(text)
    whole = parse(text)

    assert bool(found.faults) >= bool(whole.faults)
    if not found.faults:
        assert told(found) == told(whole)
    assert "".join(segment for _, segment in segments_of(text)) == text


def test_each_element_is_a_piece_with_what_stands_before_it():
    text = (
        "import a\n\nfirst { }\n// Of the second.\nsecond {\n  x: 1 // }\n}\n\nthird { }\n// end\n"
    )

    assert segments_of(text) == [
        (1, "import a\n\nfirst { }\n"),
        (4, "// Of the second.\nsecond {\n  x: 1 // }\n}\n"),
        (8, "\nthird { }\n// end\n"),
    ]


def test_what_is_wrong_in_a_piece_leaves_the_others_alone():
    text = "first { a b c: }\nsecond { x: 1 }\nthird { y: 2 }\n"

    assert [str(item.name.text) for item in in_pieces(text).document.items][-2:] == [
        "second",
        "third",
    ]
