"""Reasons why a last command may stand: those of a person, told from what tools have written."""

from __future__ import annotations

import re
from difflib import SequenceMatcher

TOOL_REASON = "it stands until the next one see that something stops the vehicle on its way"
"""A reason that tools once wrote, without punctuation: nobody has decided anything."""

_ALIKE = 0.8
"""From which likeness on, of 1 for the same words, a text is taken for an edited copy of another.

A sentence of another cause that shares its form, such as that of a waypoint which SetTravelSpeed
stops, has 0.76; one word replaced leaves 0.93.
"""


def is_reason(text: str) -> bool:
    """Tells whether a text can be the reason of a person why a last command may stand.

    Args:
        text: The text. What tools have written is none, nor are some of its words, or nearly all;
            and one word such as `todo` gives no reason.
    """
    words_of_text, words_of_tool = re.findall(r"\w+", text.casefold()), TOOL_REASON.split()
    likeness = SequenceMatcher(None, words_of_text, words_of_tool, autojunk=False).ratio()
    different_words = {*words_of_text}
    return (
        len(different_words) > 1 and not different_words <= {*words_of_tool} and likeness < _ALIKE
    )
