"""Places of metamodels in a merge: `xsi:schemaLocation`, which Eclipse reads and no model holds."""

from __future__ import annotations

import re

_PLACES = re.compile(rb"(?<=[\s:]schemaLocation=[\"'])[^\"'<]*")


def with_places(merged: bytes, base: bytes, ours: bytes, theirs: bytes) -> bytes:
    """Returns a merge with the places of metamodels that theirs has changed and ours has not.

    They change where a model was moved to another folder. Bytes of UTF-16 stay as they are.
    """
    was, mine, other, now = map(_places, (base, ours, theirs, merged))
    for uri, place in other.items():
        if was.get(uri) == mine.get(uri) and uri in now:
            now[uri] = place
    if now == _places(merged):
        return merged
    written = b" ".join(each for pair in now.items() for each in pair)
    return _PLACES.sub(lambda _: written, merged, count=1)


def _places(data: bytes) -> dict[bytes, bytes]:
    """Returns the places of metamodels by namespace."""
    found = _PLACES.search(data)
    words = found.group().split() if found is not None else []
    return dict(zip(words[::2], words[1::2], strict=False))
