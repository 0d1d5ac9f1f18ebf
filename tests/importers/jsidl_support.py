"""JSIDL texts for tests, and their import."""

import re
from pathlib import Path

from jausml.language.importers.jsidl import Source, import_sources

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WINCH = sorted(path for path in (HERE / "winch").iterdir())
MARKER = re.compile(r"⟦(JML\d\d\d)⟧")

SERVICE = """<?xml version="1.0" encoding="UTF-8"?>
<service_def xmlns="urn:jaus:jsidl:1.0" xmlns:new="urn:jaus:jsidl:1.1" name="Lamp"
    id="urn:example:light:Lamp" version="1.0">
  <description>Gives light.</description>
  {references}
  <declared_type_set name="Types">
    {types}
  </declared_type_set>
  <message_set>
    <input_set>
      <message_def name="SetLamp" message_id="D100" is_command="true">
        <body name="Body">
          {body}
        </body>
      </message_def>
      <message_def name="QueryLamp" message_id="D101" is_command="false">
        <body name="Body"/>
      </message_def>
    </input_set>
    <output_set>
      <message_def name="ReportLamp" message_id="D102" is_command="false">
        <body name="Body"/>
      </message_def>
    </output_set>
  </message_set>
  <internal_events_set>
    <event_def name="Burnt"/>
  </internal_events_set>
  <protocol_behavior>
    {behaviour}
  </protocol_behavior>
</service_def>
"""


def service(body="", types="", behaviour="", references=""):
    """Returns a service with parts of its own."""
    return SERVICE.format(body=body, types=types, behaviour=behaviour, references=references)


def record(fields, attributes=""):
    """Returns a record with fields."""
    return f'<record name="Rec" optional="false"{attributes}>{fields}</record>'


def type_set(body, name="Set", identifier="urn:example:light:Set", version="1.0"):
    """Returns a declared_type_set."""
    return (
        f'<declared_type_set xmlns="urn:jaus:jsidl:1.0" name="{name}" id="{identifier}"'
        f' version="{version}">{body}</declared_type_set>'
    )


def constants(body, identifier="urn:example:light:Constants", version="1.0"):
    """Returns a declared_const_set."""
    return (
        f'<declared_const_set xmlns="urn:jaus:jsidl:1.0" name="C" id="{identifier}"'
        f' version="{version}">{body}</declared_const_set>'
    )


def run(*texts, **options):
    """Imports documents in memory."""
    named = enumerate(texts)
    return import_sources([Source(f"{n}.xml", text.encode()) for n, text in named], **options)


def good(*texts, **options):
    """Imports documents that have no findings; returns the first service."""
    result = run(*texts, **options)
    assert result.diagnostics == [], [str(diagnostic) for diagnostic in result.diagnostics]
    return result.sets[0].services[0]


def marked(*texts, **options):
    """Imports documents with markers ⟦JML605⟧ at the places of the findings, and checks these.

    Returns:
        The findings.
    """
    expected = []
    plain = []
    for number, given in enumerate(texts):
        text = given
        while match := MARKER.search(text):
            before = text[: match.start()]
            line = before.count("\n") + 1
            column = len(before) - (before.rfind("\n") + 1) + 1
            expected.append((f"{number}.xml", line, column, match.group(1)))
            text = before + text[match.end() :]
        plain.append(text)
    result = run(*plain, **options)
    found = [
        (
            diagnostic.location.path,
            diagnostic.location.line,
            diagnostic.location.column,
            diagnostic.rule,
        )
        for diagnostic in result.diagnostics
    ]
    assert found == sorted(expected), [str(diagnostic) for diagnostic in result.diagnostics]
    return result.diagnostics


def winch(**options):
    """Imports the service with every kind of field."""
    sources = [Source(path.name, path.read_bytes()) for path in WINCH]
    return import_sources(sources, **options)
