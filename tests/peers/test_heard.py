"""What a tool has heard, and the answers that somebody awaits."""

from jausml.live.peers.heard import Heard
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.messages import ReportStatus

ANSWER = ReportStatus(status=1, reserved=0).encode()


def test_an_awaited_answer_arrives_however_many_others_were_heard():
    heard = Heard(None, None, Counters())
    for subsystem in range(1, 2001):
        heard.note(ANSWER, JausAddress(subsystem, 1, 1))
    assert len(heard.sources()) == 1024
    late = JausAddress(3000, 1, 1)
    with heard.awaiting(late, (ReportStatus.CODE,)) as queue:
        heard.note(b"?", late)
        heard.note(ANSWER, late)
        assert queue.get_nowait() == ANSWER
    assert heard.of(late)
