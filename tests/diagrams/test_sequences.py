"""Sequences of events, as text of Mermaid and as pictures."""

import re

from jausml.views.diagrams.writers.sequence import Event, SequenceDiagram, mermaid, svg
from jausml.views.diagrams.writers.shapes import width


def test_a_sequence_of_time_alone_has_time_as_its_participant():
    diagram = SequenceDiagram("title", "it ends", (Event("1 s", "time passes"),))
    assert mermaid(diagram).splitlines()[2:] == [
        "  participant a0 as time",
        "  Note over a0: 1 s time passes",
        "  Note over a0: it ends",
    ]
    assert "time passes" in svg(diagram)


def test_a_picture_is_as_wide_as_its_bold_title():
    title = "ill " * 20
    picture = svg(SequenceDiagram(title, "", (Event("1 s", "go", "a", "b"),)))
    right = re.search(r'viewBox="0 0 ([0-9.]+) ', picture)[1]
    assert float(right) >= width(title.strip(), 16, bold=True) + 2 * 16


def test_a_text_stands_behind_the_longest_time():
    time = "0.0333333 s"
    picture = svg(
        SequenceDiagram("", "", (Event(time, "time passes"), Event("1 s", "go", "a", "b")))
    )
    (begin,) = re.findall(r'<text x="([0-9.]+)"[^>]*>time passes<', picture)
    assert float(begin) > 16 + width(time, 10)
