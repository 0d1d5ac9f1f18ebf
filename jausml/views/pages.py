"""Pages that need nothing else, by templates that ask; and tables in Markdown."""

from __future__ import annotations

import base64
import functools
import hashlib
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    import jinja2


def page(
    package: str, name: str, title: str, known: Mapping[str, object], styles: Sequence[str] = ()
) -> str:
    """Returns a page that loads and runs nothing, of two templates of a package.

    `name`: theirs, without `.html.j2` and `.css.j2`. `known`: what the templates may ask; all of it
    is text and no markup, unless it is marked as such. `styles`: what else within the page may give
    it a style.
    """
    environment = _environment(package)
    style = environment.get_template(f"{name}.css.j2").render()
    allowed = " ".join(map(hashed, (style, *styles)))
    policy = f"default-src 'none'; style-src {allowed}; base-uri 'none'"
    body = environment.get_template(f"{name}.html.j2").render(known)
    return f"{page_head(title, style, policy)}\n{body}\n</body>\n</html>\n"


@functools.cache
def _environment(package: str) -> jinja2.Environment:
    """Returns the templates of a package, and those that all pages share."""
    import jinja2  # noqa: PLC0415 - tables do without it

    loaders = [jinja2.PackageLoader(package_name) for package_name in (package, "jausml.views")]
    return jinja2.Environment(
        loader=jinja2.ChoiceLoader(loaders),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


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


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Returns the lines of a table in Markdown."""
    escaped = ([cell.replace("|", "\\|") for cell in row] for row in rows)
    lines = (f"| {' | '.join(cells)} |" for cells in (head, *escaped))
    first, *others = lines
    return [first, f"|{'---|' * len(head)}", *others]


def hashed(text: str) -> str:
    """Returns the source expression that allows a text within a page in a policy."""
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"
