"""Whatever bridges there are, a report tells of each connection, in a hundred columns."""

import os
import tempfile
from pathlib import Path

import compositions
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.generation.target import system_of
from jausml.language.validation.engine import check_project
from jausml.views.analysis.formats import html, json, text
from jausml.views.analysis.report import report_of
from jausml.views.analysis.sizes import Assumptions

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "6"))


@settings(max_examples=EXAMPLES, suppress_health_check=list(HealthCheck), deadline=None)
@given(data=st.data())
def test_each_connection_has_loads_and_times(data):
    model = compositions.composition(lambda things: data.draw(st.sampled_from(things)))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "model.ros2jaus")
        path.write_text(model, encoding="utf-8")
        found = check_project([path])
    if found.has_errors:
        return
    report = report_of(system_of(found.model), Assumptions())
    for connection in (
        connection_report for owner in report.bridges for connection_report in owner.connections
    ):
        assert connection.flows
        assert connection.budgets
        assert connection.load.sent.packets + connection.load.received.packets > 0
        for flow in connection.flows:
            assert flow.size.least <= flow.size.expected
            assert flow.size.most is None or flow.size.expected <= flow.size.most
    assert max(map(len, text.render(report).splitlines())) <= text.WIDTH
    assert html.render(report).count("<details>") == sum(
        len(owner.connections) for owner in report.bridges
    )
    assert json.render(report)
