"""What is written is registered: rules of any module of their folder, output formats in theirs."""

import pkgutil
from importlib import import_module

from jausml.language.validation import formats, rules
from jausml.language.validation.rule import Rule
from jausml.language.validation.rules.bridge.deployment import PARAMETERS
from jausml.runtime.bridge.ends import parameters


def modules_in(package):
    """Returns the modules that lie in the folder of a package and below it."""
    names = pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    return [import_module(name.name) for name in names if not name.ispkg]


def test_each_module_has_rules_and_each_rule_an_id_of_its_own():
    found = rules.all_rules()
    assert len({rule.id for rule in found}) == len(found)
    for module in modules_in(rules):
        own = [member for member in vars(module).values() if isinstance(member, Rule)]
        assert own
        assert set(own) <= set(found)


def test_each_module_that_renders_is_a_format():
    names = [module.__name__ for module in modules_in(formats) if hasattr(module, "render")]
    assert [name.rpartition(".")[2] for name in names] == sorted(formats.RENDERERS)


def test_the_parameters_of_every_bridge_are_known():
    known = [one for one in vars(parameters).values() if isinstance(one, parameters.Known)]
    # Those of a connection begin with its name, and no quantity is called so.
    assert {one.name for one in known if "{" not in one.name} <= PARAMETERS
