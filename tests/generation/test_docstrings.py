"""Docstrings say a long text once, and end their first line where a thought ends."""

import pytest

from jausml.generation.literals import model_docstring

LONG = "and says what the peer is to do with it when the time has come"


@pytest.mark.parametrize(
    ("text", "first", "others"),
    [
        (f"Takes a value. {LONG} {LONG}", "Takes a value.", f"{LONG} {LONG}."),
        (f"Takes a value; {LONG} {LONG}", "Takes a value.", f"{LONG[0].upper()}{LONG[1:]} {LONG}."),
        (f"Takes: one; {LONG} {LONG}", "Takes: one.", f"{LONG[0].upper()}{LONG[1:]} {LONG}."),
        (f"Takes one: two, {LONG} {LONG}", "Takes one.", f"Two, {LONG} {LONG}."),
        (f"Takes one, {LONG} {LONG}", "Takes one.", f"Takes one, {LONG} {LONG}."),
        (f"{LONG} {LONG}", f"{LONG} and says what the peer is to.", f"{LONG} {LONG}."),
        ("x" * 120, f"{'x' * 95}.", f"{'x' * 96}{'x' * 24}."),
    ],
)
def test_first_lines_end_with_a_thought(text, first, others):
    quoted, _, rest = model_docstring(text, 0).removesuffix('"""').partition("\n")
    assert quoted.startswith(f'"""{first}'[:50])
    assert "..." not in quoted
    assert quoted.endswith(".")
    assert "".join(rest.split()) == "".join(others.split())
    assert len(quoted) <= 100
