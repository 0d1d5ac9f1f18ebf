"""Sequences of events, as text of Mermaid and as pictures."""

import re

from jausml.views.diagrams.writers.sequence import Course, Line, mermaid, svg
from jausml.views.diagrams.writers.shapes import width


def test_a_sequence_of_time_alone_has_time_as_its_participant():
    course = Course("title", "it ends", (Line("1 s", "time passes"),))
    assert mermaid(course).splitlines()[2:] == [
        "  participant a0 as time",
        "  Note over a0: 1 s time passes",
        "  Note over a0: it ends",
    ]
    assert "time passes" in svg(course)


def test_a_picture_is_as_wide_as_its_bold_title():
    title = "ill " * 20
    picture = svg(Course(title, "", (Line("1 s", "go", "a", "b"),)))
    right = re.search(r'viewBox="0 0 ([0-9.]+) ', picture)[1]
    assert float(right) >= width(title.strip(), 16, bold=True) + 2 * 16


def test_a_text_stands_behind_the_longest_time():
    time = "0.0333333 s"
    picture = svg(Course("", "", (Line(time, "time passes"), Line("1 s", "go", "a", "b"))))
    (begin,) = re.findall(r'<text x="([0-9.]+)"[^>]*>time passes<', picture)
    assert float(begin) > 16 + width(time, 10)
