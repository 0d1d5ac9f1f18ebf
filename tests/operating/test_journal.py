"""Alarms say who is lost, that it is back, and take one reason for several."""

from jausml.live.operating.journal import Journal


def test_alarms_come_newest_first_and_say_when_their_subject_is_back():
    journal = Journal(lambda *_: None)
    journal.alarm("gps (1.1.2)", "lost: silent")
    journal.alarm("gps (1.1.2)", "no source", "connection bridge.fix")
    journal.alarm("gps (1.1.2)", "lost: silent")  # it sounds already
    subjects = [alarm["subject"] for alarm in journal.alarms]
    assert subjects == ["connection bridge.fix", "gps (1.1.2)"]
    journal.returned("gps (1.1.2)")
    assert [bool(alarm["back"]) for alarm in journal.alarms] == [False, True]
    journal.alarm("gps (1.1.2)", "lost: silent")  # again
    assert len(journal.alarms) == 3


def test_one_reason_silences_several():
    journal = Journal(lambda *_: None)
    for number in range(3):
        journal.alarm(f"component {number}", "lost")
    assert journal.silence([1, 3, 9], "anna", "a restart")
    assert [alarm["number"] for alarm in journal.alarms] == [2]
    assert not journal.silence([1, 3], "anna", "a restart")
    texts = [entry["text"] for entry in journal.entries]
    assert sum("because 'a restart'" in text for text in texts) == 2


def test_what_was_silenced_does_not_push_out_what_sounds():
    journal = Journal(lambda *_: None)
    journal.alarm("arm", "lost")
    for number in range(2, 300):
        journal.alarm("gps", f"{number}")
        journal.silence([number], "anna", "known")
    assert [alarm["subject"] for alarm in journal.alarms] == ["arm"]
