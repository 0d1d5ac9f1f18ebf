"""What was worked out before, in the cache of the user, under a seal.

Caches are restored and shared, by others too. Therefore what is kept bears a seal, whose key lies
elsewhere and is the user's alone: what others wrote, and what belongs to another state of its
inputs, is as if it were not there.
"""

from __future__ import annotations

import hmac
import json
import os
import secrets
import stat
import sys
import time
import zlib
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.language.model.inputs import read_unnoted

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_SEAL = 32
"""Bytes of a seal, and of its key."""

_FORGOTTEN = 30 * 24 * 3600
"""Seconds after which a file is removed that nobody has used since."""

_OF_OTHERS = stat.S_IWGRP | stat.S_IWOTH

_CODE = ("jausml", "jausml_generators", "jausml.metamodels")
_LIBRARIES = ("jinja2", "lark", "lxml", "pyecore", "pyecoregen")


def kept(name: str, state: str) -> Any:
    """Returns what this user has kept under a name for a state; None where there is nothing."""
    path = _cache() / name
    try:
        if not (_is_own(path.parent) and _is_own(path)):
            return None
        data = read_unnoted(path)
        seal, body = data[:_SEAL], data[_SEAL:]
        is_own = hmac.compare_digest(seal, _seal(name, state, body))
        found = json.loads(zlib.decompress(body)) if is_own else None
        os.utime(path)
        return found
    except (OSError, RuntimeError, ValueError, zlib.error):
        return None


def keep(name: str, state: str, content: Any) -> None:
    """Keeps JSON under a name for a state, in place of any other, where that can be done."""
    try:
        folder = _cache()
        folder.mkdir(parents=True, exist_ok=True)
        folder.chmod(0o700)  # it may be older than this
        for each in folder.iterdir():
            if each.stat().st_mtime < time.time() - _FORGOTTEN:
                each.unlink()
        body = zlib.compress(json.dumps(content).encode(), 1)
        _write(folder / name, _seal(name, state, body) + body)
    except (OSError, RuntimeError, ValueError):
        return  # It is worked out again the next time.


@cache
def tool() -> tuple[str, ...]:
    """Returns what says which program works: versions, and all files of it, as in a checkout.

    Files that change later are not those of what works in this process.

    Raises:
        OSError, PackageNotFoundError: Nobody knows what works.
    """
    return tuple(_tool())


def _tool() -> Iterator[str]:
    yield f"{__version__} {sys.version}"
    yield from map(version, _LIBRARIES)
    for package in _CODE:
        folder = Path(str(files(package)))
        for path in sorted(folder.rglob("*")):
            if "__pycache__" not in path.parts and path.is_file():
                yield f"{path.relative_to(folder)} {sha256(path.read_bytes()).hexdigest()}"


def digest(texts: Iterable[str]) -> str:
    """Returns the digest of some texts, which tells them apart however they are cut."""
    found = sha256()
    for each in texts:
        data = each.encode("utf-8", "surrogateescape")
        found.update(b"%d " % len(data) + data)
    return found.hexdigest()


def _is_own(path: Path) -> bool:
    """Tells whether something is the user's, and nobody else can write it."""
    found = path.stat()
    return os.name != "posix" or (
        found.st_uid == os.geteuid() and not stat.S_IMODE(found.st_mode) & _OF_OTHERS
    )


def _seal(name: str, state: str, body: bytes) -> bytes:
    return hmac.digest(_key(), json.dumps([name, state]).encode() + body, "sha256")


def _key() -> bytes:
    """Returns the key of the user, which is made when it is first asked for."""
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    path = Path(state) / "jausml" / "seal"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        _write(path, secrets.token_bytes(_SEAL))
    key, of_file = read_unnoted(path), path.stat()
    if os.name == "posix" and (of_file.st_uid != os.geteuid() or of_file.st_mode & 0o077):
        raise PermissionError(f"{path} is not the user's alone")
    if len(key) != _SEAL:
        raise ValueError(f"{path} is no key")
    return key


def _write(path: Path, data: bytes) -> None:
    """Writes a file that nobody else can read, at once."""
    new = path.with_name(f"{path.name}.{os.getpid()}")
    descriptor = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(descriptor, "wb") as file:
        file.write(data)
    new.replace(path)


def _cache() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "jausml"
