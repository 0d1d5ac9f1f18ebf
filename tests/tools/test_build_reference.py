"""The references can be made, and have a section for each class, rule, verb and conversion."""

import re
from pathlib import Path

import build_reference
import click
from click.testing import CliRunner
from for_each import for_each

from jausml.cli import main
from jausml.language.metamodel import load_metamodels
from jausml.language.semantics.conversions import CONVERSIONS

GUARDS = ("tools/build_reference.py", "metamodels", "models/library", "jausml/cli", ".gitignore")
ROOT = Path(__file__).resolve().parents[2]


def sections(name: str) -> list[str]:
    """The headings of a page."""
    return re.findall(r"^## (.+)$", build_reference.MAKERS[name](), re.MULTILINE)


@for_each("language", build_reference.LANGUAGES)
def test_each_class_has_a_section(language):
    package = load_metamodels().package_named(language).epackage
    kinds = [str(classifier.name) for classifier in package.eClassifiers]
    told = [heading.removesuffix(" (abstract)") for heading in sections(f"{language}.md")]
    assert sorted(told) == sorted(kinds)


def test_each_rule_has_a_section():
    listed = CliRunner().invoke(main, ["rules"]).output
    rules = re.findall(r"^(JML\d{3})\b", listed, re.MULTILINE)
    assert len(rules) > 200
    assert [heading.split()[0] for heading in sections("rules.md")] == rules


def test_each_verb_has_a_section():
    verbs = [heading.split()[1] for heading in sections("cli.md") if " " in heading]
    assert list(dict.fromkeys(verbs)) == main.list_commands(click.Context(main))


def test_each_conversion_has_a_line():
    page = build_reference.conversions_page()
    calls = [conversion.call for conversion in CONVERSIONS.values()]
    assert [call for call in calls if f"| `{call}` |" not in page] == []


def test_what_is_unknown_is_told_of_ready_maps():
    page = build_reference.unknown_page()
    assert "## global_pose_sensor" in page.splitlines()
    row = "| `global_pose` | JAUS | `latitude`, `longitude` | `status.status < 0` | is left out |"
    assert row in page


def test_markers_stand_under_their_packages():
    assert "sensor_msgs" in sections("markers.md")


def test_they_are_not_committed():
    ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    assert {f"/docs/reference/{name}" for name in build_reference.MAKERS} <= set(ignored)
