"""Version of what the runtime exports, what generated code asks for, and the root of its errors."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

API_VERSION = (1, 0)
"""Version of what the runtime exports by name.

The first number is raised when something that was exported goes or is used in another way, and the
second, which then begins at 0, when something is added.
"""


class ApiVersionError(ImportError):
    """Generated code meets a runtime that it was not generated for."""


def require_api(version: tuple[int, int], file: str) -> None:
    """Refuses a runtime that generated code does not fit; called when its package is imported.

    Args:
        version: API that the code was generated for: the first number must be the same, and the
            second not greater than the runtime's.
    """
    if version[0] == API_VERSION[0] and version[1] <= API_VERSION[1]:
        return
    folder = Path(__file__).parents[1]
    if version > API_VERSION:
        remedy = "an older runtime is found first: build and source the newer workspace anew"
    else:
        remedy = "generate the package anew with the jausml that brought the runtime"
    raise ApiVersionError(
        f"{file} needs API {version[0]}.{version[1]} of jausml_runtime, and {folder} has"
        f" {API_VERSION[0]}.{API_VERSION[1]}: {remedy}"
    )


class JausError(ValueError):
    """A value or message that cannot be taken, carried or translated.

    What the operating system refuses stays an ``OSError``.
    """


def optional_part(module: str, name: str) -> Any:
    """Returns a part of the runtime that a workspace has only where its model asks for it.

    Whoever starts the process may ask for what the model does not, e.g. for another transport;
    where the workspace does not have the module, that is a JausError.
    """
    package = __name__.removesuffix(".base.api")
    try:
        return getattr(import_module(f"{package}.{module}"), name)
    except ModuleNotFoundError as error:
        raise JausError(
            f"this workspace has no {name}, as its model asks for none;"
            " `jausml generate --all` brings it"
        ) from error
