"""Digests of the files of a model: by them, what was found of a model names it."""

from __future__ import annotations

import os
from hashlib import sha256
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.model.model import Model


def digests(model: Model) -> dict[str, str]:
    """Returns the sha256 of each file of a model, those of the library left out, as `sha256sum`.

    Returns:
        Digests by path, relative to the folder of the first file, in the order of the paths.
    """
    own = [each for each in model.documents if not each.is_library]
    folder = model.documents[0].path.parent
    found = {
        os.path.relpath(each.path, folder).replace(os.sep, "/"): sha256(each.data).hexdigest()
        for each in own
    }
    return dict(sorted(found.items()))
