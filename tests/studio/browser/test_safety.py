"""What a real browser lets the page do, and what the page keeps to itself."""

from urllib.parse import urlsplit

import pytest
from playwright.sync_api import expect

pytestmark = [pytest.mark.needs("chromium", "page"), pytest.mark.ports, pytest.mark.timeout(300)]


def test_the_token_leaves_the_address_and_lasts_for_the_tab(open_studio, example):
    page = open_studio(example)
    address = open_studio.studios[0].address
    expect(page.get_by_label("File")).to_have_value("catvehicle.xmi")
    own, _, fragment = page.url.partition("#")
    assert own == f"http://{urlsplit(address).netloc}/"
    token = urlsplit(address).fragment.removeprefix("token=")
    assert token
    assert "token" not in fragment
    assert token not in fragment
    page.reload()
    expect(page.get_by_label("File")).to_have_value("catvehicle.xmi")
    assert token not in open_studio.studios[0].log.read_text()


def test_without_the_token_nothing_is_shown(open_shared, open_studio):
    page = open_shared()
    expect(page.get_by_label("File")).to_have_value("catvehicle.xmi")
    stranger = open_studio.page_of(page.url)
    expect(stranger.get_by_text("catvehicle")).to_have_count(0)
    expect(stranger.get_by_text("token").first).to_be_visible()


ASKING = """address => Promise.all([
    new Promise(done => {
        const socket = new WebSocket(`ws://${address}/socket`);
        socket.onopen = () => done("open");
        socket.onerror = () => done("refused");
    }),
    fetch(`http://${address}/`).then(() => "read", () => "refused"),
])"""


@pytest.mark.slow
def test_pages_of_different_sites_can_ask_nothing(open_shared, open_studio, chromium, example):
    page = open_shared()
    expect(page.get_by_label("File")).to_have_value("catvehicle.xmi")
    context = chromium.new_context()
    for site in ("http://127.0.0.1:9/", "http://other.test/"):
        other = context.new_page()
        other.route(
            site, lambda route: route.fulfill(body="<!doctype html>", content_type="text/html")
        )
        other.goto(site)
        assert other.evaluate(ASKING, urlsplit(page.url).netloc) == ["refused", "refused"]
    context.close()
    other = open_studio(example)
    expect(other.get_by_label("File")).to_have_value("catvehicle.xmi")
    address = urlsplit(other.url).netloc
    assert page.evaluate(ASKING, address) == ["refused", "refused"]
    assert any("Content Security Policy" in complaint for complaint in open_studio.complaints)
    open_studio.complaints.clear()
