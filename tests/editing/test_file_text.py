"""The text of a file, of which splices are made by offsets in characters."""

from __future__ import annotations

import codecs

import pytest

from jausml.authoring.editing.splices import FileText, Splice, applied, common_ends, merged

TEXT = "größe = 1\r\n\u2028weg: \U0001f916 → x\r\nletzte"


@pytest.mark.parametrize(
    ("encoding", "mark"),
    [("utf-8", b""), ("utf-8", codecs.BOM_UTF8), ("utf-16-le", b""), ("utf-16-be", b"")],
)
@pytest.mark.parametrize("text", [TEXT, "plain\r\nlines\r\n", ""])
def test_a_splice_puts_a_text_in_place_of_any_characters(encoding, mark, text):
    data = mark + text.encode(encoding)
    whole = FileText("a.txt", data, encoding, len(mark))
    for start in range(len(text) + 1):
        for end in range(start, len(text) + 1):
            changed = applied(data, [whole.splice(start, end, "ü\nü")])
            newline = "\r\n" if "\r\n" in text else "\n"
            expected = f"{text[:start]}ü{newline}ü{text[end:]}"
            assert changed == mark + expected.encode(encoding)


@pytest.mark.parametrize(
    ("old", "new", "ends"),
    [("abcd", "abxd", (2, 1)), ("aa", "a", (1, 0)), ("", "ab", (0, 0)), ("ab", "ab", (2, 0))],
)
def test_common_ends_never_overlap(old, new, ends):
    assert common_ends(old, new) == ends


def test_what_is_put_in_before_bytes_that_go_away_stays():
    gone, put = Splice("f", 3, b"old", b""), Splice("f", 3, b"", b"new ")
    assert merged([gone, put]) == [put, gone]
    assert applied(b"an old man", merged([gone, put])) == b"an new  man"
