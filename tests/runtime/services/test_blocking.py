"""Handlers that keep the loop: the log tells which one, and how long."""

import logging
import re
import time

from jausml.runtime.messages import SetTime


def test_a_handler_that_blocks_is_named_once(world, caplog):
    component = world.component("1.1.1")

    def dawdle(*_):
        time.sleep(0.6)

    component.on_message(SetTime, dawdle)
    component.start()
    probe = world.probe("1.1.2")
    with caplog.at_level(logging.WARNING, "jausml"):
        for _ in range(3):
            probe.tell(component.address, SetTime())
    assert world.counters.snapshot()["component.handler_blocked"] == 3
    (line,) = [record.getMessage() for record in caplog.records]
    assert "component.handler_blocked (1 times): " in line
    assert re.search(r"dawdle took \d+\.\d s; nothing was received meanwhile", line)
