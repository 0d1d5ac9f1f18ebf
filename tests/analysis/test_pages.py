"""Pages by templates: what models and files say is text, and nothing is loaded or run."""

import math
import re
from html.parser import HTMLParser

import jinja2
import pytest

from jausml.mutating.outcomes import Campaign, Outcome
from jausml.mutating.outcomes import page as campaign_page
from jausml.proving.html_pages import pages as proof_pages
from jausml.proving.results import FieldResult, MapResult
from jausml.views.pages import hashed, markdown_table, page

NASTY = "<b>it & me</b>"


class Words(HTMLParser):
    """Collects tags and words."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.words = set(), []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):  # noqa: ARG002 - as the parser calls it
        self.tags.add(tag)

    def handle_data(self, data):
        self.words.append(data)


def campaign():
    outcome = Outcome("sign", NASTY, "is turned", "nothing", "", ("drive.py",))
    return Campaign(NASTY, 2, 1, [outcome], [NASTY])


def test_what_a_campaign_says_is_text():
    found = Words(campaign_page(campaign()))
    assert "b" not in found.tags
    assert "".join(found.words).count(NASTY) >= 4


def test_what_proofs_say_is_text():
    result = MapResult(NASTY, NASTY, "a/B", remarks=[NASTY])
    made = dict(proof_pages([result], {NASTY: [NASTY]}))
    assert len(made) == 2
    for text in made.values():
        found = Words(text)
        assert "b" not in found.tags
        assert NASTY in found.words


def test_errors_without_end_have_a_picture():
    """Also where no error has one."""
    field = FieldResult("JAUS", "speed", "", 1, 1.0, (0.0, 1.0), 2, bins=[0.0, math.inf])
    text = dict(proof_pages([MapResult("drive", "a", "b", [field])], {}))["drive.html"]
    assert 'class="error" x="360.00" y="18.00" width="360.00" height="150.00"' in text
    assert "error up to inf" in text


def test_the_style_of_a_page_is_the_one_that_it_allows():
    text = campaign_page(campaign())
    style = re.search(r"<style>(.*?)</style>", text, re.DOTALL)
    policy = re.search(r'Content-Security-Policy" content="(.*?)"', text)
    assert f"style-src {hashed(style[1])};" in policy[1]
    assert policy[1].startswith("default-src 'none'")


def test_a_template_that_asks_for_what_nobody_knows_is_a_fault():
    with pytest.raises(jinja2.UndefinedError):
        page("jausml.mutating", "campaign", "", {})


def test_a_table_in_markdown_keeps_its_columns():
    assert markdown_table(("a", "b"), [("1|2", "3")]) == ["| a | b |", "|---|---|", "| 1\\|2 | 3 |"]
    assert markdown_table(("a",), []) == ["| a |", "|---|"]
