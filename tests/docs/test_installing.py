"""Nobody is told to install jausml by its name, which no public index has."""

import re
from pathlib import Path

from jausml.installing import SOURCE, command

ROOT = Path(__file__).parents[2]
FOLDERS = ("docs", "generators", "integrations", "jausml", "models", "tools")
TEXTS = {".j2", ".md", ".py", ".ros2jaus", ".toml", ".yml", ".yaml"}
BY_NAME = re.compile(r"(pip|pipx) install( --?[\w-]+( wheels)?)* [\"']?jausml(?![\w.-])|uvx jausml")


def texts() -> list[Path]:
    found = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*")]
    found += [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "action.yml"]
    return [path for path in found if path.suffix in TEXTS and "node_modules" not in path.parts]


def test_no_text_installs_jausml_by_its_name():
    assert SOURCE.endswith(".whl"), "once it is on an index, this test may go"
    told = {
        str(path.relative_to(ROOT)): match.group()
        for path in texts()
        for match in BY_NAME.finditer(path.read_text(encoding="utf-8"))
    }
    assert told == {}


def test_what_is_looked_for_is_found():
    for text in ("pip install jausml", "pip install 'jausml[ros]'", "pipx install jausml"):
        assert BY_NAME.search(text)
    assert BY_NAME.search('pip install --find-links wheels "jausml==0.1.0"')
    assert not BY_NAME.search(command("record"))
