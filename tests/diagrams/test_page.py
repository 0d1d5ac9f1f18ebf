"""The page: one file that asks nobody, and in which texts of a model stay texts."""

import base64
import hashlib
import json
import re
from html.parser import HTMLParser

import pytest
from diagram_support import CAR, read
from sweeps import sweep
from test_pictures import HOSTILE, hostile

from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.writers import html


class Page(HTMLParser):
    """What a page holds: its tags, its scripts and styles."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.inline, self.policy = [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if dict(attrs).get("http-equiv") == "Content-Security-Policy":
            self.policy = dict(attrs)["content"]

    def handle_data(self, data):
        tag, attributes = self.tags[-1] if self.tags else ("", {})
        if tag in ("script", "style") and "type" not in attributes and data.strip():
            self.inline.append(data)


def test_the_page_asks_no_host_and_runs_its_own_script_alone():
    report = read(CAR)
    text = html.render(graph_of(report.model, "system", report.diagnostics))
    page = Page(text)
    assert page.policy.startswith("default-src 'none'")
    assert "unsafe" not in page.policy
    assert len(page.inline) == 3
    for inline_text in page.inline:
        digest = base64.b64encode(hashlib.sha256(inline_text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in page.policy
    for _, attributes in page.tags:
        assert not {"src", "href", "style"} & set(attributes)
        assert not any(name.startswith("on") for name in attributes)
    assert "http" not in text.replace("http://www.w3.org/2000/svg", "").replace("http-equiv", "")


@pytest.mark.parametrize("text", sweep(HOSTILE, every=4, rest=1), ids=range(len(HOSTILE)))
def test_texts_are_data(text):
    made = html.render(hostile(text))
    plain = html.render(hostile("x"))
    shapes = [
        [tag for tag, _ in Page(document).tags if tag not in ("text",)]
        for document in (made, plain)
    ]
    assert shapes[0] == shapes[1] or text == ""
    known = json.loads(re.search(r'id="known">(.*)</script>', made)[1])
    assert any(entry["title"] == text for entry in known.values())
    keys = set(re.findall(r'data-key="(k\d+)"', made))
    assert keys == set(known)


def test_the_same_bytes_each_time():
    assert html.render(hostile("x")) == html.render(hostile("x"))


def test_the_filter_finds_edges_by_the_rows_at_their_ends():
    report = read(CAR)
    text = html.render(graph_of(report.model, "system", report.diagnostics))
    known = json.loads(re.search(r'id="known">(.*)</script>', text)[1])
    edges = [entry for entry in known.values() if entry["title"] == "vehicle → bridge"]
    assert any("odometry" in edge["text"] for edge in edges)
