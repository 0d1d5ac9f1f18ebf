"""The version of the runtime's API, its check by generated code, and the root of its errors."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

# Version of the names that the runtime exports. The first number is raised when a name goes or is
# used in another way; the second, which begins at 0 then, when a name is added.
API_VERSION = (1, 0)


class ApiVersionError(ImportError):
    """The runtime is not one that the generated code was generated for."""


def require_api(version: tuple[int, int], file: str) -> None:
    """Checks that the runtime fits generated code; called when its package is imported.

    Args:
        version: API that the code was generated for: the first number must be the same, and the
            second not greater than the runtime's.
        file: The importing file, for the error.

    Raises:
        ApiVersionError: The version does not fit.
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
    """A value or message cannot be taken, carried or translated.

    Errors of the operating system stay ``OSError``.
    """


def optional_part(module: str, name: str) -> Any:
    """Imports and returns a name of a module that a workspace has only if its model needs it.

    Options of the process may need more than the model does, e.g. another transport.

    Raises:
        JausError: The workspace does not have the module.
    """
    package = __name__.removesuffix(".base.api")
    try:
        return getattr(import_module(f"{package}.{module}"), name)
    except ModuleNotFoundError as error:
        raise JausError(
            f"this workspace has no {name}, as its model asks for none;"
            " `jausml generate --all` brings it"
        ) from error
