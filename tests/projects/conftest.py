"""Projects that `jausml init` makes, and the verb itself."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from jausml.cli import main


@pytest.fixture(scope="session")
def jausml():
    """Runs a verb in this process; returns what click says of it."""

    def run(*arguments):
        return CliRunner().invoke(main, list(map(str, arguments)))

    return run


@pytest.fixture
def rover(tmp_path, monkeypatch, jausml):
    """Makes a project in a notation, empty unless told, and works in it; returns its model."""

    def make(notation, origin="empty"):
        done = jausml("init", tmp_path / "rover", "--notation", notation, "--from", origin)
        assert done.exit_code == 0, done.output
        monkeypatch.chdir(tmp_path / "rover")
        return tmp_path / "rover" / "models" / f"rover.{'xmi' if notation == 'xmi' else 'ros2jaus'}"

    return make
