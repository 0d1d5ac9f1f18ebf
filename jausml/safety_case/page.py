"""Safety cases as a document that a reviewer reads, prints, and signs or refuses goal by goal."""

from __future__ import annotations

import hashlib
from html import escape
from pathlib import PurePath
from typing import TYPE_CHECKING
from urllib.parse import quote

from jausml.safety_case.picture import STYLE, names_of
from jausml.views.pages import hashed, page_head

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jausml.safety_case.argument import Goal, SafetyCase
    from jausml.safety_case.evidence import Evidence

_STYLE = """
:root { color-scheme: light; }
body { font: 14px/1.45 system-ui, sans-serif; color: #1b1b1b; background: #fff;
  margin: 2rem auto; max-width: 60rem; padding: 0 1rem; overflow-wrap: anywhere; }
h3 { font-size: 1rem; margin: 0; } p, ul { margin: .25rem 0; }
svg { display: block; max-width: 100%; height: auto; }
th, td { text-align: left; vertical-align: top; padding-right: 1rem; }
section { border: 1px solid #b0b0b0; border-left: .4rem solid #00795a; padding: .6rem .9rem;
  margin: .8rem 0; break-inside: avoid; }
section.open { border-left-color: #b34700; }
.bad { color: #b34700; font-weight: 600; }
.sign span { display: inline-block; min-width: 9rem; border-bottom: 1px solid; height: 1.6em; }
@media print { body { margin: 0; max-width: none; font-size: 11px; } h2 { break-after: avoid; } }
"""
_POLICY = f"default-src 'none'; style-src {hashed(_STYLE)} {hashed(STYLE)}; base-uri 'none'"
_SIGNATURE = (
    '<p class="sign">\N{BALLOT BOX} accepted \N{BALLOT BOX} refused, name <span></span> '
    "date <span></span> reason <span></span></p>"
)
_SEAL = "<!-- sha256 of what stands above: "


def render(case: SafetyCase, pictures: Mapping[str, str]) -> str:
    """Returns a safety case as a document."""
    text = "\n".join(_lines(case, pictures)) + "\n"
    return f"{text}{_SEAL}{_digest(text)} -->\n"


def is_untouched(document: str) -> bool:
    """Tells whether nobody has written into a document since it was made."""
    text, seal, rest = document.rpartition(_SEAL)
    return bool(seal) and rest.startswith(_digest(text))


def _digest(text: str) -> str:
    """Returns the digest of a text as it is written, paths that are no text included."""
    return hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()


def _lines(case: SafetyCase, pictures: Mapping[str, str]) -> Iterator[str]:
    yield page_head(f"Safety case of {case.system}", _STYLE, _POLICY)
    yield f"<p>{case.summary}, by jausml {case.jausml}: the model answers the hazard, evidence is "
    yield "for it and none against it. Whether that is enough, a person decides.</p>"
    yield pictures["case"]
    yield "<h2>What is not covered</h2>\n<ul>"
    for goal in case.goals:
        link = f'<a href="#{goal.number}">{goal.number}</a> {escape(goal.claim)}'
        yield from (f"<li>{link}: {escape(each)}</li>" for each in goal.against)
    yield "</ul>\n<p>Nothing here argues that these assumptions hold:</p>\n<ul>"
    yield from (f"<li>{escape(each)}</li>" for each in case.assumptions)
    yield "</ul>"
    evidence = {each.id: _named(each) for each in case.evidence}
    for hazard in case.hazards:
        yield f"<h2>{hazard.number} {escape(hazard.title)}</h2>"
        yield "" if hazard.goals else "<p>It concerns nothing in this model.</p>"
        yield from (pictures[each] for each in names_of(hazard))
        for goal in hazard.goals:
            yield from _goal(goal, evidence)
    yield "<h2>Evidence</h2>\n<table><tr><th>what</th><th>sha256</th><th>state</th></tr>"
    yield from (_row(f"model {escape(name)}", digest) for name, digest in case.model.items())
    for each in case.evidence:
        yield _row(_named(each), each.sha256, each.stale or "of this model")
    for name, digest in case.tests.items():
        yield _row(f"generated {escape(name)}", digest, "what a test run has to run")
    yield f"</table>\n<h2>The case as a whole</h2>\n{_SIGNATURE}\n</body>\n</html>"


def _goal(goal: Goal, evidence: Mapping[str, str]) -> Iterator[str]:
    place = f"{goal.element}, {PurePath(goal.location.path).name}:{goal.location.line}"
    yield f'<section class="{"" if goal.supported else "open"}" id="{goal.number}">'
    yield f"<h3>{goal.number} {escape(goal.claim)}</h3>\n<p>{escape(place)}</p>\n<ul>"
    for answer in goal.answers:
        yield f"<li>The model: {escape(answer.text)}</li>"
        if answer.reason:
            yield f"<li>Reason that a person gave: {escape(answer.reason)}. Whoever signs accepts "
            yield "that it holds for this machine.</li>"
    yield from (f'<li class="bad">Undeveloped: {escape(each)}</li>' for each in goal.gaps)
    for each in goal.supports:
        kind = "Evidence" if each.holds else '<span class="bad">Evidence against</span>'
        yield f"<li>{kind}: {evidence[each.evidence]}: {escape(each.text)}</li>"
    yield from (f"<li>Not found: {each}</li>" for each in goal.lacks)
    yield f"</ul>\n{_SIGNATURE}\n</section>"


def _row(*cells: str) -> str:
    return f"<tr>{''.join(f'<td>{each}</td>' for each in cells)}</tr>"


def _named(each: Evidence) -> str:
    link = (
        f' <a href="{escape(quote(each.path, errors="surrogateescape"))}">{escape(each.path)}</a>'
        if each.path
        else ""
    )
    return f"{each.id} {each.kind}{link}"
