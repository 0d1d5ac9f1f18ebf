"""What a verb works with is loaded when it works: help and completion of the shell are quick."""

import subprocess
import sys

import pytest
from for_each import for_each

from jausml.cli import VERBS
from jausml.cli.shared import options
from jausml.language.validation import formats
from jausml.live.peers import console, measuring, network
from jausml.live.peers.conformance import formats as conformance_formats

HEAVY = {
    *("jinja2", "lark", "lxml", "numpy", "pyecore", "pygls"),
    *(
        "jausml.generation",
        "jausml.live",
        "jausml.language.metamodel",
        "jausml.language.model",
        "jausml.runtime",
    ),
    *(
        "jausml.language.semantics",
        "jausml.language.text",
        "jausml.language.validation",
        "jausml.language.wire",
    ),
}
WITH_TARGETS = {"generate"}
"""Its help tells what the installed targets do, and has to load them."""
HELPED = [*(verb for verb in VERBS if verb not in WITH_TARGETS), "import ros", "list maps"]


TOLD = """
import os, sys
from click.testing import CliRunner
from jausml.cli import main

for verb in {verbs!r}:
    if os.fork():
        os.wait()
        continue
    code = CliRunner().invoke(main, [*verb.split(), "--help"]).exit_code
    print(verb, code, sorted({heavy!r} & set(sys.modules)), sep=":", flush=True)
    os._exit(0)
"""


@pytest.fixture(scope="module")
def told():
    """What a process tells that has done nothing else, by verb: exit code and what it loaded."""
    line = [sys.executable, "-c", TOLD.format(verbs=HELPED, heavy=HEAVY)]
    done = subprocess.run(line, capture_output=True, text=True)
    return dict(output_line.split(":", 1) for output_line in done.stdout.splitlines())


@for_each("verb", HELPED)
def test_help_loads_nothing_heavy(told, verb):
    assert told.get(verb) == "0:[]"


def test_options_offer_what_there_is():
    assert tuple(formats.RENDERERS) == options.REPORT_FORMATS
    assert tuple(conformance_formats.RENDERERS) == options.CONFORMANCE_FORMATS
    assert tuple(measuring.QUESTIONS) == options.QUESTIONS
    assert options.AUTHORITY == console.DEFAULT_AUTHORITY
    assert options.TRANSPORTS == network.TRANSPORTS
    assert options.INTERFACE == network.DEFAULT_INTERFACE
    assert options.PORT == network.DEFAULT_PORT
    assert options.GROUP == network.DEFAULT_GROUP


def loaded(line, modules):
    """What of some modules a command loads that a process runs."""
    code = TOLD.format(verbs=[line], heavy=modules).replace(', "--help"', "")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert f"{line}:0:" in done.stdout, done.stderr
    return done.stdout.rpartition(":")[2].strip()


def test_what_is_built_already_is_told_without_what_models_need(tmp_path):
    manifest = tmp_path / ".jausml" / "manifest.json"
    manifest.parent.mkdir()
    manifest.write_text('{"schema": 2, "models": {}, "files": {}}', encoding="utf-8")
    heavy = HEAVY - {"jausml.generation", "jausml.language.model"}
    assert loaded(f"build {tmp_path}", heavy) == "[]"


def test_an_empty_project_is_made_without_what_edits_models(tmp_path):
    editing = {"jausml.authoring.editing", "jausml.authoring.proposals", "jausml.generation"}
    assert loaded(f"init {tmp_path}/made --from empty --quiet", editing) == "[]"
