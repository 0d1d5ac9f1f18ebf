"""What the packages import, and that importing them costs nothing."""

import re
import sys
from pathlib import Path

from scripts import succeeded

import jausml.language.metamodel
import jausml.language.model

METAMODEL = Path(jausml.language.metamodel.__file__).parent
MODEL = Path(jausml.language.model.__file__).parent


def imports(path):
    text = path.read_text(encoding="utf-8")
    return re.findall(r"^\s*(?:from|import) ([\w.]+)", text, re.MULTILINE)


def test_one_module_loads_through_pyecore():
    users = [
        path.name
        for path in (*METAMODEL.glob("*.py"), *MODEL.glob("*.py"))
        if any(name.startswith("pyecore.resources") for name in imports(path))
    ]
    assert users == ["loading.py"]


def test_models_are_not_read_by_pyecore_or_lxml():
    for path in MODEL.glob("*.py"):
        assert not [name for name in imports(path) if name.startswith(("pyecore", "lxml"))]


def test_layers():
    for path in METAMODEL.glob("*.py"):
        inner = [name for name in imports(path) if name.startswith("jausml.")]
        assert all(name.startswith("jausml.language.metamodel") for name in inner)
    for path in MODEL.glob("*.py"):
        inner = [name for name in imports(path) if name.startswith("jausml.")]
        assert all(
            name.startswith(("jausml.language.metamodel", "jausml.language.model"))
            for name in inner
        )


def test_modules_are_small():
    for path in (*METAMODEL.glob("*.py"), *MODEL.glob("*.py")):
        assert len(path.read_text(encoding="utf-8").splitlines()) < 400


def test_metamodels_are_not_loaded_at_import():
    code = (
        "import sys; opened = []; "
        "sys.addaudithook(lambda event, given: event == 'open' and opened.append(str(given[0]))); "
        "import jausml.language.model, jausml.language.metamodel as m; "
        "print('system.ecore' in ' '.join(opened)); "
        "m.load_metamodels(); print('system.ecore' in ' '.join(opened))"
    )
    done = succeeded([sys.executable, "-c", code], timeout=60)
    assert done.stdout.split() == ["False", "True"]


def test_public_names_are_listed():
    names = jausml.language.model.__all__
    assert len(names) == len(set(names))
    assert all(hasattr(jausml.language.model, name) for name in names)
