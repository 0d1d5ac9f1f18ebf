"""What pages that need nothing else begin with."""

from __future__ import annotations

import base64
import hashlib
from html import escape


def page_head(title: str, style: str, policy: str = "") -> str:
    """Returns the beginning of a page, up to its heading.

    `policy`: what the page may load and run (Content-Security-Policy); empty for no word on it.
    """
    stated = f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n' if policy else ""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'{stated}<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{style}</style>\n</head>\n<body>\n"
        f"<h1>{escape(title)}</h1>"
    )


def hashed(text: str) -> str:
    """Returns what allows a text within a page in a policy."""
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"
