"""The site of the documentation: it is built without a warning, and what it needs is there."""

import json
import re
from pathlib import Path, PurePosixPath

import build_site
import pytest

from jausml.language.validation.engine import check_project
from jausml.language.validation.formats import sarif

GUARDS = ("docs/index.md", "zensical.toml", "tools/build_reference.py")

ROOT = Path(__file__).resolve().parents[2]
_OTHER_SERVER = re.compile(r'<(?:script|link|img)[^>]+(?:src|href)="?(https?:[^" >]+)')


def pages(entries):
    """The pages of a navigation, in its order."""
    for entry in entries:
        for goal in entry.values() if isinstance(entry, dict) else [entry]:
            yield from pages(goal) if isinstance(goal, list) else [goal]


def test_each_page_is_listed_once():
    listed = list(pages(build_site.navigation()))
    there = {
        path.relative_to(ROOT / "docs").as_posix()
        for path in (ROOT / "docs").rglob("*.md")
        if path != ROOT / "docs" / "index.md"
    }
    there |= {build_site.site_path(path).as_posix() for path in build_site.REFERENCES}
    assert there - set(listed) == set(), "docs/index.md and docs/adr/index.md list all pages"
    assert len(listed) == len(set(listed))


def test_a_warning_ends_the_build(tmp_path, monkeypatch):
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "index.md").write_text("# Home\n\n## Learn\n\n- [Other](other.md)\n", encoding="utf-8")
    (docs / "other.md").write_text("# Other\n\n[home](index.md#nowhere)\n", encoding="utf-8")
    (tmp_path / "zensical.toml").write_text('[project]\nsite_name = "x"\n', encoding="utf-8")
    monkeypatch.setattr(build_site, "ROOT", tmp_path)
    with pytest.raises(build_site.SiteError, match="nowhere"):
        build_site.build(tmp_path / "site", "1.0.0", {})
    (docs / "other.md").write_text("# Other\n\n[gone](../gone.md)\n", encoding="utf-8")
    with pytest.raises(build_site.SiteError, match="no file"):
        build_site.build(tmp_path / "site", "1.0.0", {})


def linked_rules():
    """The rules of a SARIF log that links each of them to its section."""
    log = json.loads(sarif.render(check_project([]), "rules/"))
    return log["runs"][0]["tool"]["driver"]["rules"]


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(tmp_path):
    """One test, as the build takes seconds: versions, what comes along, search, other servers."""
    (tmp_path / "0.0.9").mkdir()
    (tmp_path / "0.0.9" / "index.html").write_text("old", encoding="utf-8")
    made = {path: make() for path, make in build_site.REFERENCES.items()}
    build_site.build(tmp_path, "0.0.10", made)

    told = json.loads((tmp_path / "versions.json").read_text(encoding="utf-8"))
    pairs = [(version["version"], version["aliases"]) for version in told]
    assert pairs == [("0.0.10", ["latest"]), ("0.0.9", [])]
    assert 'url=0.0.10/"' in (tmp_path / "index.html").read_text(encoding="utf-8")
    assert (tmp_path / "0.0.9" / "index.html").read_text(encoding="utf-8") == "old"
    site = tmp_path / "0.0.10"
    page = (site / "how-to" / "ready-mappings" / "index.html").read_text(encoding="utf-8")
    assert 'href="../../repository/models/library/mappings/"' in page
    assert (site / "repository" / "models" / "library" / "mappings" / "index.html").is_file()
    rules = (site / "reference" / "rules" / "index.html").read_text(encoding="utf-8")
    links = {rule["helpUri"].partition("#")[2] for rule in linked_rules()}
    assert len(links) > 200
    assert links <= set(re.findall(r'<h2 id="?([^" >]+)', rules))
    decisions = (site / "adr" / "index.html").read_text(encoding="utf-8")
    assert "<title>Decisions - jausml</title>" in decisions
    assert "silenceTimeout" in (site / "search.json").read_text(encoding="utf-8")
    # A prompt that is copied with its command is no command of the shell. The button marks what
    # it copies; site.css hides the prompts of what is marked.
    assert '<span class="gp">$ </span>' in page
    assert "code[data-md-copying] .gp" in (site / "site.css").read_text(encoding="utf-8")
    scripts = (site / "assets" / "javascripts").glob("bundle.*.js")
    assert any("data-md-copying" in script.read_text(encoding="utf-8") for script in scripts)
    for path in site.rglob("*.html"):
        assert _OTHER_SERVER.findall(path.read_text(encoding="utf-8")) == [], path


@pytest.mark.parametrize(
    ("page", "link", "moved"),
    [
        ("docs/how-to/a.md", "../index.md#x", "../index.md#x"),
        ("docs/how-to/a.md", "../../SECURITY.md", "../repository/SECURITY.md"),
        ("SECURITY.md", "docs/how-to/a.md", "../how-to/a.md"),
        ("models/x/README.md", "../y/README.md", "../y/README.md"),
        ("docs/a.md", "https://www.sae.org/x", "https://www.sae.org/x"),
    ],
)
def test_links_lead_where_files_stand_in_the_site(page, link, moved):
    assert build_site.moved(PurePosixPath(page), f"see [it]({link}).") == f"see [it]({moved})."


def test_code_is_no_link():
    text = "```python\na[0](b.md)\n```\n"
    assert build_site.moved(PurePosixPath("docs/a.md"), text) == text
    assert list(build_site.links(PurePosixPath("docs/a.md"), text)) == []
