"""What is written is registered: rules in the folders of rules, output formats in theirs."""

from __future__ import annotations

import pkgutil
from importlib import import_module

import pytest

from jausml.language.validation import formats
from jausml.language.validation.rule import Rule
from jausml.language.validation.rules import MODULES, all_rules, bridge, jaus, ros


def modules_in(package):
    """Returns the modules that lie in the folder of a package."""
    names = [each.name for each in pkgutil.iter_modules(package.__path__) if not each.ispkg]
    return [import_module(f"{package.__name__}.{name}") for name in names]


@pytest.mark.parametrize("folder", [bridge, jaus, ros], ids=lambda each: each.__name__)
def test_each_folder_lists_its_modules(folder):
    assert set(modules_in(folder)) == set(folder.MODULES) <= set(MODULES)


def test_each_module_has_rules_and_each_rule_an_id_of_its_own():
    rules = all_rules()
    assert len({each.id for each in rules}) == len(rules)
    for module in MODULES:
        assert any(isinstance(each, Rule) for each in vars(module).values())


def test_each_module_that_renders_is_a_format():
    names = [each.__name__ for each in modules_in(formats) if hasattr(each, "render")]
    assert [name.rpartition(".")[2] for name in names] == sorted(formats.RENDERERS)
