"""Models to begin with: an empty one, or the minimal example, as XMI or as text."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from jausml.authoring.projects.eclipse_xmi import with_schema_location
from jausml.language.model.library import LIBRARY_URI, library_root
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.printing import attribute_text
from jausml.language.text.writing.unparsing import to_text

_EXAMPLE = "minimal"

_EMPTY = """\
<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"\
 xmlns:system="http://www.jausml.org/system/1.0" xmi:id="minimal" name="minimal"/>
"""

_EMPTY_SET = """\
<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="minimal" version="1.0"/>
"""


def example_xmi(name: str, metamodels: str) -> str:
    """Returns the minimal example under another name, for a model in a folder beside `library/`."""
    path = library_root().parent / _EXAMPLE / f"{_EXAMPLE}.xmi"
    return with_schema_location(_named(path.read_text(encoding="utf-8"), name), metamodels)


def empty_xmi(name: str, metamodels: str) -> str:
    """Returns an empty system as XMI.

    `metamodels`: folder of the metamodels, relative to the model; empty where there is none.
    """
    return with_schema_location(_named(_EMPTY, name), metamodels)


def empty_services(name: str, metamodels: str) -> str:
    """Returns an empty service set as XMI."""
    named = _EMPTY_SET.replace('name="minimal"', f'name="{attribute_text(name)}"')
    return with_schema_location(named, metamodels)


def empty_text(name: str) -> str:
    """Returns an empty system as ros2jaus text."""
    return text_of(empty_xmi(name, ""), name)


def text_of(xmi: str, name: str) -> str:
    """Returns XMI as ros2jaus text; `../library/` in it means the shipped library.

    `name`: what the file is called that is read meanwhile.
    """
    with TemporaryDirectory(prefix="jausml-") as folder:
        path = Path(folder) / f"{name}.xmi"
        path.write_text(xmi.replace("../library/", LIBRARY_URI), encoding="utf-8")
        model = read_models([path]).model
        return to_text(model.documents[0].roots, model, path.with_suffix(".ros2jaus"))


def _named(xmi: str, name: str) -> str:
    own = f'xmi:id="{_EXAMPLE}" name="{_EXAMPLE}"'
    text = identifier = attribute_text(name)
    before, _, behind = xmi.partition(own)
    # The example may have an element of this name.
    while f'xmi:id="{identifier}"' in behind:
        identifier += "_system"
    return f'{before}xmi:id="{identifier}" name="{text}"{behind}'
