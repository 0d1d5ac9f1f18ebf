"""The first model of a project: a sensor whose velocity a bridge publishes, or an empty system."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from jausml.model.reading.reader import read_models
from jausml.model.uris import LIBRARY_URI, library_root
from jausml.text.writing.unparsing import to_text

_EXAMPLE = "minimal"
_LANGUAGES = ("jaus", "ros", "bridge", "system")
_EMPTY = """\
<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"\
 xmlns:system="http://www.jausml.org/system/1.0" xmi:id="minimal" name="minimal"/>
"""


def as_xmi(name: str) -> str:
    """Returns the example as XMI that Eclipse opens, below a folder beside metamodels and library.

    Args:
        name: Name of the system.
    """
    path = library_root().parent / _EXAMPLE / f"{_EXAMPLE}.xmi"
    return _named(path.read_text(encoding="utf-8"), name)


def empty_xmi(name: str) -> str:
    """Returns an empty system as XMI that Eclipse opens.

    Args:
        name: Name of the system.
    """
    return _named(_EMPTY, name)


def as_text(xmi: str, name: str) -> str:
    """Returns a model as ros2jaus text.

    Args:
        xmi: The model, below a folder beside the library.
        name: Name of the system.
    """
    with TemporaryDirectory(prefix="jausml-init-") as folder:
        path = Path(folder) / f"{name}.xmi"
        path.write_text(xmi.replace("../library/", LIBRARY_URI), encoding="utf-8")
        model = read_models([path]).model
        return to_text(model.documents[0].roots, model, path.with_suffix(".ros2jaus"))


def with_schema_location(xmi: str, metamodels: str) -> str:
    """Returns a model that tells Eclipse where the metamodels are.

    Args:
        xmi: The model, whose first line of elements says nothing of it.
        metamodels: Folder of the metamodels, relative to the model.
    """
    places = " ".join(
        f"http://www.jausml.org/{each}/1.0 {metamodels}/{each}.ecore" for each in _LANGUAGES
    )
    return xmi.replace(" xmi:id=", f' xsi:schemaLocation="{places}" xmi:id=', 1)


def _named(xmi: str, name: str) -> str:
    own = f'xmi:id="{_EXAMPLE}" name="{_EXAMPLE}"'
    named = xmi.replace(own, f'xmi:id="{name}" name="{name}"', 1)
    return with_schema_location(named, "../metamodels")
