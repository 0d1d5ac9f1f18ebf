"""The commands that the documentation shows are there, and run in order, as a reader types them."""

import os
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import build_site
import click
import needs
import pytest
from click.testing import CliRunner
from for_each import for_each
from nav2 import nav2
from scripts import run_script, succeeded
from sweeps import sweep
from warm import programs

from jausml.cli import main

GUARDS = ("metamodels", "README.md", "docs")

ROOT = Path(__file__).resolve().parents[2]
REFERENCES = {ROOT / path: make for path, make in build_site.REFERENCES.items()}
PAGES = [ROOT / "README.md", *sorted({*(ROOT / "docs").rglob("*.md")} - REFERENCES.keys())]
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
BESIDE = re.compile(
    r'^<div class="beside" markdown>\n\n```ros2jaus\n(.*?)^```\n\n```xml\n(.*?)^```\n\n</div>$',
    re.MULTILINE | re.DOTALL,
)
NAME = re.compile(r'<\w+:\w+ xmi:version="2.0"[^>]* name="(\w+)"')
FINDING = re.compile(r"^ *(\S+:\d+[:\d]*: (?:error|warning|info): .*)$", re.MULTILINE)
WHOLE_FINDING = re.compile(r"\S+:\d+:\d+: (?:error|warning|info): JML\d{3} ")
LINK = re.compile(r"\]\((?!http)([^)#]+)(?:#[^)]*)?\)")
pytestmark = pytest.mark.timeout(300)


def script(page: Path) -> str:
    """Returns the commands of a page: what follows `$ `, and the lines of here documents."""
    lines = "".join(BLOCK.findall(page.read_text(encoding="utf-8"))).splitlines()
    return "\n".join(line.removeprefix("$ ") for line in lines)


WITH_COMMANDS = [page for page in PAGES if script(page)]
NO_WORDS = re.compile(r"<<'?(\w+)'?\n.*?\n\1$| \d?>(?:&\d| \S+)", re.MULTILINE | re.DOTALL)
"""Here documents, and where the output goes."""


def verbs(page: Path) -> Iterator[list[str]]:
    """Yields what follows `jausml` in each of the commands of a page."""
    text = NO_WORDS.sub("", script(page))
    lexer = shlex.shlex(text, posix=True, punctuation_chars="();<|&\n")
    lexer.whitespace, lexer.whitespace_split, lexer.commenters = " ", True, ""
    words: list[str] = []
    for word in [*lexer, "\n"]:
        if not set(word) <= set(lexer.punctuation_chars):
            words.append(word)
        else:
            if "jausml" in words:
                yield words[words.index("jausml") + 1 :]
            words = []


@for_each("page", WITH_COMMANDS, ids=lambda page: page.stem)
def test_verbs_and_options_that_pages_name_are_there(page):
    for words in verbs(page):
        take(main, words)


def take(command: click.Command, words: list[str]) -> None:
    """Takes words as a command does, but for what they stand for."""
    context = click.Context(command, **command.context_settings)
    _, rest, _ = command.make_parser(context).parse_args(words)
    if isinstance(command, click.Group) and rest:
        _, verb, rest = command.resolve_command(context, rest)
        assert verb is not None
        take(verb, rest)
    else:
        assert not rest or context.allow_extra_args, words


NEED_A_COMPILER = {"compile-bridges", "prove", "python", "safety-case"}
NEED_NAV2 = {"for-student-teams"}
GUARDING = {"install", "jaus-and-ros", "report"}


@pytest.mark.live
@pytest.mark.parametrize(
    "page",
    sweep(WITH_COMMANDS, every=lambda page: page.stem in GUARDING, rest=1),
    ids=lambda page: page.stem,
)
def test_commands_run(page, tmp_path):
    (tmp_path / "models").symlink_to(ROOT / "models")
    further = {}
    if page.stem in NEED_A_COMPILER:
        needs.ask("compiler")
    else:
        further["CXX"] = "none"  # to compile the bridges of each page would take the most of it
    if page.stem in NEED_NAV2:
        further["PYTHONPATH"] = nav2()
    environment = {
        **os.environ,
        "PATH": os.pathsep.join(
            [str(programs()), str(Path(sys.executable).parent), os.environ["PATH"]]
        ),
        **further,
        "HOME": str(tmp_path),  # what readers put there is not put into that of who tests
    }
    bash = shutil.which("bash")
    assert bash is not None
    line = [bash, "-euo", "pipefail", "-c", script(page)]
    result = run_script(line, cwd=tmp_path, env=environment, timeout=250)
    assert result.returncode == 0, result.stdout + result.stderr


def test_findings_that_pages_show_have_the_form_of_findings():
    shown = [
        (page.name, line)
        for page in PAGES
        for line in FINDING.findall(page.read_text(encoding="utf-8"))
    ]
    assert len(shown) >= 5
    assert [page_line for page_line in shown if not WHOLE_FINDING.match(page_line[1])] == []


def test_tutorials_have_commands():
    tutorials = {*(ROOT / "docs" / "tutorials").glob("*.md")}
    assert len(tutorials) == 3
    assert tutorials <= {*WITH_COMMANDS}


@for_each("page", [*PAGES, *REFERENCES], ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    text = REFERENCES[page]() if page in REFERENCES else page.read_text(encoding="utf-8")
    for link in LINK.findall(text):
        goal = Path(os.path.normpath(page.parent / link))
        assert goal in REFERENCES or goal.exists(), f"{page.name} links to {link}"


def test_readme_names_exactly_the_two_commands():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"^    (\S.*)$", text, re.MULTILINE) == ["make demo", "make test"]


@pytest.mark.slow
def test_readme_shows_a_system_that_generates(tmp_path):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```ros2jaus\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    (tmp_path / "front.ros2jaus").write_text(shown, encoding="utf-8")
    command = [sys.executable, "-m", "jausml", "generate", "front.ros2jaus", "-o", "src"]
    succeeded(command, cwd=tmp_path, timeout=60)
    base = (tmp_path / "src" / "front" / "front" / "front_base.py").read_text(encoding="utf-8")
    assert "target.twist.twist.linear.y = conversions.negate(source.velocity_y)" in base


BOTH_NOTATIONS = [
    pytest.param(*pair, id=f"{page.stem}-{number}")
    for page in PAGES
    for number, pair in enumerate(BESIDE.findall(page.read_text(encoding="utf-8")))
]


def test_there_are_models_in_both_notations():
    assert len(BOTH_NOTATIONS) >= 3


@pytest.mark.parametrize(("text", "xmi"), BOTH_NOTATIONS)
def test_text_and_xmi_side_by_side_are_the_same(text, xmi, tmp_path):
    named = NAME.search(xmi)
    assert named is not None
    source, made = tmp_path / f"{named[1]}.ros2jaus", tmp_path / "made.xmi"
    source.write_text(text, encoding="utf-8")
    result = CliRunner().invoke(main, ["convert", str(source), str(made)])
    assert result.exit_code == 0, result.output
    assert made.read_text(encoding="utf-8") == xmi
