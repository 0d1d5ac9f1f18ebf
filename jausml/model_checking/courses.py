"""A counter-example as the course of a sequence diagram."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.views.diagrams.writers.sequence import Course, Line

if TYPE_CHECKING:
    from jausml.model_checking.checking import CounterExample
    from jausml.model_checking.systems import Subject


def course_of(subject: Subject, example: CounterExample) -> Course:
    """Returns what happens one after the other; steps of time without anything else are one."""
    lines: list[Line] = []
    first = len(example.moments) - example.repeats
    for number, moment in enumerate(example.moments):
        step = moment.step
        time = f"{moment.seconds:g} s"
        if not step.is_tick:
            lines.append(Line(time, step.what, step.actor, step.receiver))
            if step.on_to:
                lines.append(Line(time, step.what, step.receiver, step.on_to))
        elif lines and not lines[-1].sender:
            lines[-1] = Line(time, lines[-1].text)
        else:
            goes_on = example.repeats and number >= first
            lines.append(Line(time, "time passes, for ever" if goes_on else "time passes"))
    return Course(f"{subject.name}: {example.rule}", example.message, tuple(lines))
