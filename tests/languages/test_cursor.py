"""The token cursor: what it takes, and where it says that a text goes wrong."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.attributes.cursor import Language, LanguageError, TokenCursor

LISTS = Language(
    noun="list",
    tokens=re.compile(r"\s*(?:(?P<name>[a-z]+)|`(?P<quoted>[^`]*)`|(?P<sign>[(),]))"),
    error=LanguageError,
    longest=30,
    deepest=3,
)


def read(text):
    """Returns a nested list of words."""
    cursor = TokenCursor(text, LISTS)

    def item():
        return cursor.parenthesized(items) if cursor.take("(") else cursor.advance().text

    def items():
        found = [item()]
        while cursor.take(","):
            found.append(item())
        return found

    found = items()
    cursor.expect_end()
    return found


def test_tokens_are_read_in_their_order():
    assert read(" a, (b,(c)) ,d ") == ["a", ["b", ["c"]], "d"]


def test_what_is_quoted_is_no_sign():
    cursor = TokenCursor("`,`", LISTS)
    assert not cursor.take(",")
    assert cursor.advance() == ("quoted", ",", 2)


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("a  ?", 4, "'\\?' belongs in no list"),
        ("a, (b", 4, "a parenthesis is not closed"),
        ("a b", 3, "'b' where the list should end"),
        ("((((a", 5, "the list is nested too deeply"),
        ("a" * 31, 30, "no list has more than 30 characters"),
    ],
)
def test_faults_have_a_column(text, column, message):
    with pytest.raises(LanguageError, match=message) as caught:
        read(text)
    assert caught.value.column == column


def test_what_is_missing_is_named():
    cursor = TokenCursor("a", LISTS)
    with pytest.raises(LanguageError, match=r"no list begins: '\(' is missing at column 1"):
        cursor.expect("(", "no list begins")


@given(st.text(alphabet="ab ,()`é", max_size=30))
def test_columns_say_where_tokens_stand(text):
    try:
        cursor = TokenCursor(text, LISTS)
    except LanguageError:
        return
    while cursor.token.kind != "end":
        token = cursor.advance()
        assert text[token.column - 1 :].startswith(token.text)
    assert cursor.token.column == len(text.rstrip()) + 1
