"""Models and a runner for the tests of the command line."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from jausml.cli import main

MINIMAL = Path(__file__).parents[2] / "models" / "minimal" / "minimal.xmi"


@pytest.fixture
def jausml():
    """Runs the command line in this process, with a text on stdin."""

    def run(*arguments, text=""):
        return CliRunner().invoke(main, [str(argument) for argument in arguments], input=text)

    return run


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def model_text():
    """The minimal model, with references that hold in any folder."""
    text = MINIMAL.read_text(encoding="utf-8")
    return text.replace("../library/", "http://www.jausml.org/library/")


@pytest.fixture
def folder(here, model_text):
    """A current folder with good.xmi, bad.xmi (one error) and doubtful.xmi (one warning)."""
    warning = model_text.replace(
        '<topics name="velocity"/>',
        '<topics name="velocity"/><safeValue target="twist.linear.x" value="0"/>',
    )
    for name, text in {
        "good": model_text,
        "bad": model_text.replace('rate="10.0"', 'rate="2000"'),
        "doubtful": warning,
    }.items():
        (here / f"{name}.xmi").write_text(text, encoding="utf-8")
    return here
