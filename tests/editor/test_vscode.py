"""The extension of Visual Studio Code: its files are sound, and its colours know the language."""

import json
import re
from pathlib import Path

from build_grammar import GRAMMAR as GRAMMAR_FILE
from build_grammar import grammar
from for_each import for_each

from jausml.authoring.editor.context import keywords
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.text.keywords import KEYWORDS
from jausml.language.text.notation import SUFFIX

GUARDS = ("integrations/vscode", "metamodels")

FOLDER = Path(__file__).parents[2] / "integrations" / "vscode"
GRAMMAR = json.loads((FOLDER / "syntaxes" / "ros2jaus.tmLanguage.json").read_text("utf-8"))
PACKAGE = json.loads((FOLDER / "package.json").read_text("utf-8"))


def patterns(node):
    """Yields the regular expressions of a grammar."""
    if isinstance(node, dict):
        for key, value in node.items():
            if key in ("match", "begin", "end"):
                yield value
            yield from patterns(value)
    elif isinstance(node, list):
        for child in node:
            yield from patterns(child)


def coloured(name, line):
    """Returns what a rule of the grammar colours on a line."""
    rule = re.compile(GRAMMAR["repository"][name]["match"])
    return [
        text
        for match in rule.finditer(line)
        for text in (match.groups() if rule.groups else (match.group(),))
    ]


@for_each("pattern", sorted(set(patterns(GRAMMAR))))
def test_the_patterns_are_regular_expressions(pattern):
    re.compile(pattern)


def test_what_is_included_is_there():
    included = {pattern["include"].removeprefix("#") for pattern in GRAMMAR["patterns"]}
    assert included == set(GRAMMAR["repository"])


@for_each("word", KEYWORDS)
def test_keywords_are_coloured(word):
    assert coloured("statements", f"  {word} x") == [word]
    assert coloured("statements", f"{word}: x `{word}` a.{word} {word}s") == []


@for_each("name", CONVERSIONS)
def test_conversions_are_coloured(name):
    assert coloured("conversions", f"a -> b : {name}(1), {name}") == [name, name]


def test_the_conversions_of_the_grammar_are_written_by_their_table():
    text = GRAMMAR_FILE.read_text(encoding="utf-8")
    assert grammar(text) == text, "run `make types`"


def test_classes_are_coloured():
    classes = {keyword for keyword in keywords() if "." not in keyword}
    pattern = GRAMMAR["repository"]["elements"]["match"]
    assert set(re.search(r"\(([\w|]+)\)", pattern).group(1).split("|")) == classes
    assert coloured("elements", "bridge front {") == ["bridge"]


def test_features_directions_and_numbers_are_coloured():
    assert coloured("features", "c { rate: 5  map: x } a -> b : c") == ["rate", "map"]
    assert coloured("directions", "JAUS->ROS (") == ["JAUS", "->", "ROS"]
    assert coloured("ends", "ROS nav_msgs/Odometry (") == ["ROS", "nav_msgs/Odometry"]
    numbers = ["100.1.1", "-0x1F", "1.5e-3", "2"]
    assert coloured("numbers", " ".join([*numbers, "x2", "a.3"])) == numbers


def test_the_extension_starts_the_server_and_is_complete():
    (language,) = PACKAGE["contributes"]["languages"]
    (grammar,) = PACKAGE["contributes"]["grammars"]
    assert language["extensions"] == [SUFFIX]
    assert grammar["scopeName"] == GRAMMAR["scopeName"]
    for file in (PACKAGE["main"], language["configuration"], grammar["path"]):
        assert (FOLDER / file).is_file()
    assert '"language-server"' in (FOLDER / "extension.js").read_text("utf-8")
    configuration = json.loads((FOLDER / language["configuration"]).read_text("utf-8"))
    assert configuration["comments"]["lineComment"] == "//"
