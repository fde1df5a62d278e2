"""Speech of a session: who hears it, what is understood, what a restart does not say again."""

import json

import numpy as np
import pytest

import palms
from palms.advice import View
from palms.client import Client
from palms.floorplan import Room
from palms.raster import rasterize
from palms.server import messages
from palms.server.application import Setup
from palms.server.follower import Floor, Follower, Terms
from palms.server.naming import Namer
from palms.server.running import in_background
from palms.server.speech import Speech, moment_of
from tests.server.conftest import Phone, hall, new_store, odometry, positions, scan, whole_walk

HEARS = ["estimates", "events", "speech"]


class Clock:
    """Seconds that pass when they are told to."""

    def __init__(self):
        self.now_s = 0.0

    def __call__(self):
        return self.now_s


def parsed(message):
    return messages.parse_input(json.dumps(message))


def floor(*names):
    rooms = tuple(Room(name, hall().rooms[0].polygon_m) for name in names) or hall().rooms
    plan = palms.FloorPlan(hall().segments_m, rooms=rooms, level="1")
    return Floor(rasterize(plan), Namer(plan), "1")


def follower(*names):
    return Follower(floor(*names), Terms(particles=300, seed=1))


def spoken(inputs, every_s=6.0, preferences=None):
    """What is said when inputs come that far apart."""
    clock, follows = Clock(), follower()
    speech, found = Speech(follows, clock), []
    if preferences is not None:
        found += speech.prefer(preferences)
    for each in inputs:
        clock.now_s += every_s
        message = parsed(each)
        found += speech.follow(message, follows.apply(message), follows.intake.facing_rad)
    return found, speech


def test_a_session_is_told_from_its_scan_to_its_place():
    found, _ = spoken(whole_walk())
    kinds = [say.kind for say in found]
    assert kinds[0] == "scan"
    assert "localized" in kinds or kinds[-1] in ("progress", "oriented", "place")
    assert [say.number for say in found] == list(range(1, len(found) + 1))
    for say in found:
        named = "Study" in say.text
        assert not named or say.kind in ("localized", "found", "place")


def test_a_scan_that_shows_nothing_is_said():
    (say,), _ = spoken([{"type": "scan", "seq": 1, "t_s": 0.0, "planes": []}])
    assert say.kind == "scan"
    assert say.text == "No wall seen. Turn further round."
    assert View(0, True, ()).unseen == 0


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("I am in the studdy", "Noted: Study."),
        ("the moon", 'I know no "the moon" here. Try another name or number.'),
        ("\u202e\x00" * 30, None),
    ],
)
def test_free_words_are_answered(words, text):
    found, _ = spoken([scan(), {"type": "tell", "seq": 2, "text": words}])
    hint = next(say for say in found if say.kind == "hint")
    assert hint.text == text or text is None


def test_free_words_are_the_hint_that_they_mean():
    told, hinted = follower("Study", "Lab 12"), follower("Study", "Lab 12")
    for each in (told, hinted):
        each.apply(parsed(scan()))
    outcome = told.apply(messages.Tell(seq=2, text="lab twelve"))
    expected = hinted.apply(messages.Hint(seq=2, room="Lab 12"))
    assert outcome.heard.room == "Lab 12"
    assert outcome.estimate == expected.estimate
    assert (told.localizer.belief.particles.position_m
            == hinted.localizer.belief.particles.position_m).all()  # fmt: skip


def test_what_several_rooms_fit_changes_nothing_and_is_asked_back():
    follows = follower("Lab 12", "Lab 13")
    before = follows.apply(parsed(scan())).estimate
    outcome = follows.apply(messages.Tell(seq=2, text="the lab"))
    assert [each.room for each in outcome.heard.choices] == ["Lab 12", "Lab 13"]
    assert outcome.estimate.model_copy(update={"seq": 1}) == before
    assert outcome.error is None


def test_pause_resume_and_a_new_frame_are_confirmed():
    inputs = [
        scan(), {"type": "pause", "seq": 2}, {"type": "resume", "seq": 3},
        {"type": "resume", "seq": 4, "same_frame": False},
    ]  # fmt: skip
    found, _ = spoken(inputs, every_s=0.5)
    assert [say.text for say in found if say.kind in ("pause", "resume")] == [
        "Paused.", "Going on.", "Going on. Please scan again.",
    ]  # fmt: skip


def test_a_language_without_texts_is_said_once_and_others_are_spoken():
    found, speech = spoken([], preferences=messages.Preferences(language="tlh"))
    assert [(say.kind, say.language) for say in found] == [("settings", "en")]
    assert speech.prefer(messages.Preferences(language="de-AT")) == []
    assert speech.ask("where").text.startswith("Bitte")
    assert speech.ask("where").language == "de"


def test_who_comes_back_after_a_restart_is_not_told_again():
    clock, follows = Clock(), follower()
    for each in whole_walk():
        follows.apply(parsed(each))
    speech = Speech(follows, clock)
    last = parsed(odometry(15, positions()[-1]))
    clock.now_s = 100.0
    found = speech.follow(last, follows.apply(last), None)
    assert [say.kind for say in found if say.kind not in ("place",)] == []


def test_speech_goes_to_the_walker_who_wants_it_and_to_nobody_else(server, phones):
    phone, silent, viewer = phones(server), phones(server), phones(server)
    phone.hello(receive=HEARS)
    silent.hello()
    phone.say({"type": "share"})
    view = phone.until("link")["view"]
    viewer.say({"type": "hello", "role": "viewer", "view": view, "receive": HEARS})
    viewer.until("welcome")
    for each in (phone, silent):
        each.say(scan())
        each.say({"type": "tell", "seq": 2, "text": "study"})
    said = [phone.until("say")["kind"], phone.until("say")["kind"]]
    assert sorted(said) == ["hint", "scan"]
    for each in (silent, viewer):
        seen = []
        while not seen or seen[-1].get("seq") != 2 or seen[-1]["type"] != "estimate":
            seen.append(each.next())
        assert not [message for message in seen if message["type"] == "say"]


def test_questions_are_answered_in_words_and_are_no_inputs(server, phones):
    phone = phones(server)
    phone.hello()
    phone.say({"type": "ask"})
    answer = phone.until("say")
    assert (answer["kind"], answer["seq"], answer["t_s"]) == ("answer", 0, None)
    assert answer["text"].startswith("Please scan first")
    phone.say({"type": "preferences", "language": "de"})
    for what in ("where", "details", "repeat", "near", "options"):
        phone.say({"type": "ask", "what": what})
        assert phone.until("say")["language"] == "de"
    phone.walk([scan()])
    phone.say({"type": "end"})
    phone.until("ended")


def test_after_a_restart_words_mean_the_same(tmp_path, phones):
    folder = new_store(tmp_path / "data")
    inputs = [scan(), {"type": "tell", "seq": 2, "text": "the studdy"},
              *(odometry(seq, place) for seq, place in enumerate(positions(), 3))]  # fmt: skip
    with in_background(Setup(folder, inline_uploads=True)) as url:
        phone = Phone(url)
        welcome = phone.hello(receive=HEARS)
        before = phone.walk(inputs)
        phone.close()
    with in_background(Setup(folder, inline_uploads=True)) as url:
        phone = Phone(url)
        phone.hello(session=welcome["session"], key=welcome["key"], receive=HEARS)
        after = phone.until("estimate")
        assert after == before
        phone.close()


def test_the_client_speaks_and_listens(server):
    client = Client(server)
    with client.session("hall", seed=7, particles=400, receive=tuple(HEARS)) as session:
        session.prefer(language="de")
        session.observe(palms.Scan(np.array(scan()["planes"])))
        session.tell("study")
        answer = session.ask("options")
        assert {say.kind for say in session.said} == {"scan", "hint", "answer"}
        assert answer.language == "de"
        session._socket.close()
        assert session.ask("options").text == answer.text


def test_moments_have_what_estimates_have():
    place = messages.Place(x_m=1.0, y_m=2.0, p=0.9, drift_rad=0.1)
    estimate = messages.Estimate(
        seq=3, t_s=1.0, stage="localized", x_m=1.0, y_m=2.0, radius_95_m=1.5, facing_rad=0.3,
        drift_spread_rad=0.01, walked_m=12.0, hypotheses=(place,), p_within_2m=0.98,
    )  # fmt: skip
    moment = moment_of(estimate)
    assert moment.is_placed
    assert (moment.position_m, moment.shares, moment.p_within_2m) == ((1.0, 2.0), (0.9,), 0.98)
