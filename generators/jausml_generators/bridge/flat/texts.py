"""Expressions of Python as text, and the names of limits in it."""

from __future__ import annotations

import ast
import io
import tokenize

from jausml.generation.literals import python_string


def text_of(expression: ast.AST) -> str:
    """Returns an expression as Python text, with strings as generated code has them."""
    text = ast.unparse(expression)
    if "'" not in text and "e+" not in text:
        return text
    for token in reversed(list(tokenize.generate_tokens(io.StringIO(text).readline))):
        (_, begin), (_, end) = token.start, token.end
        if token.type == tokenize.STRING:
            text = text[:begin] + python_string(ast.literal_eval(token.string)) + text[end:]
        elif token.type == tokenize.NUMBER:
            text = text[:begin] + token.string.replace("e+", "e") + text[end:]
    return text


def limit_variable(policy: str) -> str:
    """Returns the local variable of a limit of the connection.

    Args:
        policy: Attribute of the connection that it is.
    """
    return f"{policy}_limit"
