"""What two sequences have in common."""

import pytest

from jausml.authoring.editing.splices import common_ends


@pytest.mark.parametrize(
    ("old", "new", "ends"),
    [("abcd", "abxd", (2, 1)), ("aa", "a", (1, 0)), ("", "ab", (0, 0)), ("ab", "ab", (2, 0))],
)
def test_common_ends_never_overlap(old, new, ends):
    assert common_ends(old, new) == ends
