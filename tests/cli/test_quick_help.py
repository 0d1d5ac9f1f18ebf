"""What a verb works with is loaded when it works: help and completion of the shell are quick."""

from __future__ import annotations

import subprocess
import sys

import pytest

from jausml.cli import VERBS
from jausml.cli.shared import options
from jausml.language.validation import formats
from jausml.live.peers import console, measuring, network
from jausml.live.peers.conformance import formats as conformance_formats

GUARDS = ("jausml/cli/shared/known",)

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


@pytest.mark.parametrize(
    "verb",
    [*([each] for each in VERBS if each not in WITH_TARGETS), ["import", "ros"], ["list", "maps"]],
    ids=" ".join,
)
def test_help_loads_nothing_heavy(verb):
    code = (
        "import sys; from click.testing import CliRunner; from jausml.cli import main; "
        f"print(CliRunner().invoke(main, {[*verb, '--help']!r}).exit_code); "
        f"print(sorted({HEAVY!r} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)

    assert run.stdout.split("\n")[:2] == ["0", "[]"]


def test_options_offer_what_there_is():
    assert tuple(formats.RENDERERS) == options.REPORT_FORMATS
    assert tuple(conformance_formats.RENDERERS) == options.CONFORMANCE_FORMATS
    assert tuple(measuring.QUESTIONS) == options.QUESTIONS
    assert options.AUTHORITY == console.DEFAULT_AUTHORITY
    assert options.TRANSPORTS == network.TRANSPORTS
    assert options.INTERFACE == network.DEFAULT_INTERFACE
    assert options.PORT == network.DEFAULT_PORT
    assert options.GROUP == network.DEFAULT_GROUP
