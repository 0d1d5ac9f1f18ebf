"""Random edits of model files, text and XMI: most leave a model that can be read, some do not."""

import re

WORD = re.compile(r"[A-Za-z_][\w./]*|\d+(?:\.\d+)*")
VALUE = re.compile(r'(?<=[\w:])="([^"]*)"')
NUMBERS = ("0", "1", "2.5", "1e9", "-3", "300")


class Edits:
    """The files of a project as one edit after the other leaves them.

    Attributes:
        files: What each holds; one that is not there is left out.
    """

    def __init__(self, files, chance):
        self.files = dict(files)
        self._start = dict(files)
        self._chance = chance

    def step(self, *, is_good):
        """Does an edit; where the one before left nothing to be read, takes it back."""
        chance = self._chance
        if not is_good or chance.random() < 0.2:
            self.files = dict(self._start)
            return
        name = chance.choice(sorted(self._start))
        if not re.search(r"\d", self.files.get(name, "")):
            self.files[name] = self._start[name]
        elif len(self._start) > 1 and name != min(self._start) and chance.random() < 0.15:
            del self.files[name]
        elif name.endswith(".xmi"):
            self.files[name] = self._xmi(self.files[name])
        else:
            self.files[name] = self._text(self.files[name])

    def _text(self, text):
        edits = (self._word, self._word, self._number, self._remove, self._double, self._swap)
        edit = self._chance.choice((*edits, self._break) if self._chance.random() < 0.2 else edits)
        return edit(text)

    def _word(self, text):
        words = list(WORD.finditer(text))
        where, what = self._chance.choice(words), self._chance.choice(words)
        return text[: where.start()] + what[0] + text[where.end() :]

    def _number(self, text):
        found = [match for match in WORD.finditer(text) if match[0][0].isdigit()]
        where = self._chance.choice(found)
        return text[: where.start()] + self._chance.choice(NUMBERS) + text[where.end() :]

    def _break(self, text):
        where = self._chance.choice([match.start() for match in re.finditer(r"[{}()]", text)])
        return text[:where] + text[where + 1 :]

    def _remove(self, text):
        start, end = self._block(text)
        return text[:start] + text[end:]

    def _double(self, text):
        start, end = self._block(text)
        return text[:end] + text[start:end] + text[end:]

    def _swap(self, text):
        start, end = self._block(text)
        follows = _block_at(text, end) if text[end:].lstrip()[:1].isalpha() else None
        if follows is None:
            return text
        return text[:start] + text[end:follows] + text[start:end] + text[follows:]

    def _block(self, text):
        """Returns where lines begin and end that open a brace and close it; at once without any."""
        starts = [match.start() for match in re.finditer(r"(?m)^ *[^\n{}]*\{", text)]
        start = self._chance.choice(starts or [len(text)])
        return start, _block_at(text, start) or len(text)

    def _xmi(self, text):
        return self._chance.choice((self._value, self._value, self._value, self._line))(text)

    def _value(self, text):
        values = list(VALUE.finditer(text))[4:]
        where = self._chance.choice(values)
        what = self._chance.choice([value[1] for value in values] + list(NUMBERS))
        return text[: where.start(1)] + what + text[where.end(1) :]

    def _line(self, text):
        """Removes an element that stands on a line, or doubles it."""
        lines = text.splitlines(keepends=True)
        whole = [n for n, line in enumerate(lines) if re.fullmatch(r"\s*<[^>]*/>\s*", line)]
        at = self._chance.choice(whole)
        lines[at : at + 1] = [lines[at]] * self._chance.choice((0, 2))
        return "".join(lines)


def _block_at(text, start):
    depth = 0
    for match in re.compile(r"[{}]").finditer(text, start):
        depth += 1 if match[0] == "{" else -1
        if depth == 0:
            return match.end()
        if depth < 0:
            return None
    return None
