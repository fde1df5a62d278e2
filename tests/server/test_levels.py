"""Buildings of several levels: walked, shown, recorded, simulated."""

import io
import json
import zipfile

import numpy as np
import pytest

from palms.building import Building
from palms.floorplan import FloorPlan, Room
from palms.io import open_dataset
from palms.server import messages
from palms.server.floor import ALL, Floor
from palms.server.follower import Follower, Terms
from palms.server.limits import Limits
from palms.server.plans import plan_text
from palms.server.store import MIGRATIONS, BuildingRow, SessionRow, Store
from tests.server.conftest import http, odometry
from tests.test_building import DRIFT, GROUND, HOUSE, START, STEPS, UPPER, scan_on
from tests.worlds import walk

TO_STAIRS = [*STEPS[:15], *[(0.6, 0.0)] * 10, *[(0.0, 0.6)] * 5]
N = 6000


def folder_with_house(folder):
    store = Store(folder)
    levels = tuple((plan.level, plan_text(plan)) for plan in HOUSE.levels)
    store.add_building(BuildingRow("house", "House", levels), 0.0)
    store.close()
    return folder


@pytest.fixture
def url(serve, tmp_path):
    limits = Limits(requests_per_s=1e6, request_burst=10**6)
    return serve(limits, folder=folder_with_house(tmp_path / "house"))


def scan_of(plan=GROUND, point=START, seq=1):
    seen = scan_on(plan, point)
    return {"type": "scan", "seq": seq, "t_s": 100.0, "planes": seen.walls_m.tolist()}


def inputs(steps=TO_STAIRS, plan=GROUND):
    places = walk(steps, DRIFT).position_m.tolist()
    return [scan_of(plan), *(odometry(seq, place) for seq, place in enumerate(places, 2))]


def hello(phone, **fields):
    return phone.hello(**({"building": "house", "particles": N} | fields))


def parsed(listed):
    return [messages.parse_input(json.dumps(each)) for each in listed]


def follower(level=None, **terms):
    return Follower(Floor.of(HOUSE, level), Terms(particles=N, seed=1, **terms))


def test_a_building_does_not_change_under_those_who_walk_on_all_of_it(url, phones):
    phone = phones(url)
    hello(phone)
    place = f"{url}/api/v1/buildings/house/levels"

    def add():
        file = {"file": ("a.csv", b"0,0,8,0\n8,0,8,5\n")}
        return http.post(place, files=file, data={"level": "2"})

    refused = add()
    assert refused.status_code == 422
    assert "end or delete" in refused.json()["error"]
    phone.say({"type": "end"})
    phone.until("ended")
    on_one = phones(url)
    hello(on_one, level="0", one_level=True)
    assert [each["name"] for each in add().json()["levels"]] == ["0", "1", "2"]
    assert on_one.walk(inputs()[:2])["level"] == "0"


def test_a_session_without_a_level_finds_it(url, phones):
    phone = phones(url)
    welcome = hello(phone)
    assert welcome["level"] is None
    assert [each["name"] for each in welcome["building"]["stairs"]] == ["Stairs A"]
    mirrored = [(-x, y) for x, y in STEPS]
    first = scan_of(UPPER, np.array([20 - START[0], START[1]]))
    last = phone.walk([first, *inputs(mirrored)[1:]])
    assert (last["stage"], last["level"]) == ("localized", "1")
    assert last["p_level"] > 0.95
    truth = [20 - START[0], START[1]] + np.sum(mirrored, axis=0)
    assert np.linalg.norm(np.array([last["x_m"], last["y_m"]]) - truth) < 1
    assert {each["level"] for each in last["hypotheses"]} <= {"0", "1"}


def test_a_session_that_starts_on_a_level_may_leave_it_and_one_that_is_kept_may_not(url, phones):
    on_both = phones(url)
    assert hello(on_both, level="1")["level"] is None
    first = on_both.walk([scan_of(GROUND, np.array([16.0, 9.5]))])
    assert first["level"] == "1"
    kept = phones(url)
    assert hello(kept, level="1", one_level=True)["level"] == "1"
    assert kept.walk(inputs())["level"] == "1"
    kept.say({"type": "level", "seq": 32, "change": -1})
    assert "kept to" in kept.until("error")["text"]
    kept.say({"type": "hint", "seq": 33, "level": "0"})
    assert "kept to" in kept.until("error")["text"]
    assert kept.walk([{"type": "hint", "seq": 34, "level": "1"}])["level"] == "1"
    paper = phones(url)
    assert hello(paper, method="paper")["level"] == "0"
    alone = phones(url)
    alone.say({"type": "hello", "building": "house", "level": "5"})
    assert alone.next()["code"] == "unknown"


def test_a_building_too_large_to_search_whole_wants_a_level(serve, phones, tmp_path):
    url = serve(Limits(building_cells=10_000), folder=folder_with_house(tmp_path / "house"))
    refused = hello(phones(url))
    assert (refused["code"], refused["fatal"]) == ("full", True)
    assert "one_level" in refused["text"]
    assert hello(phones(url), level="0", one_level=True)["type"] == "welcome"


def test_somebody_whose_phone_counts_levels_is_followed_by_stairs():
    live = follower()
    for message in parsed(inputs()):
        before = live.apply(message)
    assert before.estimate.level == "0"
    told = parsed([{"type": "level", "seq": 32, "t_s": 116.0, "change": 1}])[0]
    after = live.apply(told)
    assert after.error is None
    assert (after.estimate.level, after.hint.level) == ("1", "1")
    assert after.estimate.p_level > 0.9
    again = live.apply(told.model_copy(update={"seq": 33}))
    assert "+1 from 1" in again.error
    down = live.apply(parsed([{"type": "level", "seq": 34, "change": -1}])[0])
    assert down.estimate.level == "0"
    named = live.apply(parsed([{"type": "level", "seq": 35, "level": "1"}])[0])
    assert named.estimate.level == "1"
    assert "'9'" in live.apply(parsed([{"type": "level", "seq": 36, "level": "9"}])[0]).error


def test_a_change_before_any_level_is_known_says_so():
    outcome = follower().apply(parsed([{"type": "level", "seq": 1, "change": 1}])[0])
    assert "none yet" in outcome.error
    assert not outcome.is_defect


@pytest.mark.parametrize("cut", [1, 20, 33])
def test_a_journal_replayed_in_a_building_of_several_levels_gives_the_same_state(cut):
    listed = parsed([*inputs(), {"type": "level", "seq": 32, "change": 1},
                     {"type": "resume", "seq": 33, "same_frame": False},
                     scan_of(UPPER, np.array([10.0, 9.5]), 34) | {"t_s": 140.0}])  # fmt: skip
    live, replayed = follower(start_level="0"), follower(start_level="0")
    for message in listed[:cut]:
        live.apply(message)
    for text in [message.model_dump_json() for message in listed[:cut]]:
        replayed.apply(messages.parse_input(text))
    for message in listed[cut:]:
        one, two = live.apply(message), replayed.apply(message)
    assert one.error is None
    assert one.estimate == two.estimate
    for name in ("position_m", "drift_rad", "weight"):
        first, second = (
            getattr(each.localizer.belief.particles, name).tobytes() for each in (live, replayed)
        )
        assert first == second


def test_viewers_get_particles_and_maps_with_their_level(url, phones):
    phone = phones(url)
    hello(phone, receive=["estimates", "particles", "heatmaps"], max_particles=500)
    last = phone.walk([scan_of(UPPER, np.array([20 - START[0], START[1]]))])
    while len({type(frame) for frame in phone.frames}) < 2 or len(phone.frames) < 9:
        phone.next()
    shown = next(each for each in phone.frames if isinstance(each, messages.ParticlesFrame))
    assert shown.n_levels == 2
    assert np.mean(shown.level == 1) == pytest.approx(last["p_level"], abs=0.06)
    low, high = shown.position_m.min(axis=0), shown.position_m.max(axis=0)
    assert (low > -2.5).all()
    assert (high < [22.5, 14.5]).all()
    maps = [each for each in phone.frames if isinstance(each, messages.HeatmapFrame)]
    assert {(each.number, each.level) for each in maps} == {
        (k, j) for k in range(4) for j in (0, 1)
    }
    from PIL import Image

    best = {each.level: each for each in maps if each.number == 0}
    brightest = {k: np.array(Image.open(io.BytesIO(each.png))).max() for k, each in best.items()}
    assert brightest[1] > brightest[0]
    picture = np.array(Image.open(io.BytesIO(best[1].png)))[::-1]
    row, column = np.unravel_index(picture.argmax(), picture.shape)
    place = np.array(best[1].origin_m) + best[1].cell_size_m * (np.array([column, row]) + 0.5)
    assert np.linalg.norm(place - [20 - START[0], START[1]]) < 0.5


def test_who_comes_later_is_told_the_levels_of_the_path(url, phones):
    phone = phones(url)
    welcome = hello(phone)
    phone.walk(inputs(STEPS[:3]))
    viewer = phones(url)
    viewer.say({"type": "hello", "role": "viewer", "session": welcome["session"]})
    path = viewer.until("path")
    assert len(path["level"]) == len(path["x_m"]) == 4
    assert set(path["level"]) <= {"0", "1"}
    (listed,) = http.get(url + "/api/v1/sessions").json()["sessions"]
    assert listed["level"] is None


def test_a_recording_is_a_data_set_of_all_levels(url, phones, tmp_path):
    phone = phones(url)
    hello(phone, level="0", record=True)
    phone.walk([*inputs(), {"type": "level", "seq": 32, "change": 1}])
    last = phone.walk([{"type": "resume", "seq": 33, "same_frame": False}, odometry(34, [9, 9])])
    assert last["level"] == "1"
    phone.say({"type": "end"})
    name = phone.until("ended")["recording"]
    track = http.get(f"{url}/api/v1/recordings/{name}/track").json()
    assert [plan["level"] for plan in track["plans"]] == ["0", "1"]
    assert track["estimates"][-1] == last
    answer = http.get(f"{url}/api/v1/recordings/{name}/dataset")
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        archive.extractall(tmp_path / "set")
    (case,) = open_dataset(tmp_path / "set").cases
    building = case.building()
    assert building.names == ("0", "1")
    assert [each.name for each in building.stairs] == ["Stairs A"]
    told = case.happenings(case.walk().odometry(), building)
    assert [each.what.level for each in told[1:]] == ["0", "1"]
    assert told[1].time_s <= case.walk().odometry().time_s[0] < told[2].time_s
    assert len(case.walk().odometry()) == len(TO_STAIRS)


def test_a_walk_is_tracked_on_all_levels(url, tmp_path):
    from palms.io import RecordedWalk, write_scan_json, write_tracking

    write_tracking(RecordedWalk.of(walk(STEPS, DRIFT)), tmp_path / "walk.json")
    write_scan_json(scan_on(GROUND), tmp_path / "scan.json")
    files = {name: (f"{name}.json", (tmp_path / f"{name}.json").read_bytes())
             for name in ("scan", "walk")}  # fmt: skip

    def steps(**form):
        answer = http.post(f"{url}/api/v1/tracks", files=files, data={"building": "house"} | form)
        assert answer.status_code == 200, answer.text
        return answer.json()["trials"][0]["steps"]

    assert steps()["level"][-1] == "0"
    assert "level" not in steps(level="1")


def test_a_walk_over_the_stairs_is_simulated(url, phones):
    path = [[5.0, 3.9], [3.5, 3.9], [3.5, 6.0], [6.5, 6.0], [6.5, 9.0], [7.0, 9.0]]
    wanted = {"building": "house", "seed": 3}
    place = f"{url}/api/v1/simulations"
    way = [[10.5, 8.5], [10.0, 10.5], [10.5, 8.5]]
    found = http.post(place, json=wanted | {"path_m": way, "levels": ["0", "0", "1"]}).json()
    assert not found["is_cut"]
    assert set(found["truth_level"]) == {"0", "1"}
    (change,) = found["changes"]
    assert change["change"] == 1
    at = found["truth_level"].index("1")
    assert found["samples"][at - 1]["t_s"] == change["t_s"]
    elsewhere = http.post(place, json=wanted | {"path_m": path, "levels": ["0"] * 5 + ["1"]})
    assert elsewhere.status_code == 422
    assert "stairs" in elsewhere.json()["error"]
    short = http.post(place, json=wanted | {"path_m": path, "levels": ["0"]})
    assert short.status_code == 422
    plain = http.post(place, json=wanted | {"path_m": path[:4], "level": "0"}).json()
    assert set(plain["truth_level"]) == {"0"}
    assert plain["changes"] == []
    other = http.post(place, json=wanted | {"path_m": path, "level": "9"})
    assert other.status_code == 404


def test_an_older_store_is_read_and_its_sessions_stay_on_their_level(tmp_path, serve, phones):
    folder = tmp_path / "old"
    old = Store(folder, MIGRATIONS[:1])
    levels = tuple((plan.level, plan_text(plan)) for plan in HOUSE.levels)
    old.add_building(BuildingRow("house", "House", levels), 0.0)
    from palms.server.gate import hashed

    row = SessionRow("s", hashed("key"), "house", "1", Terms(particles=N), False, 9e9, 9e9)
    old.add_session(row)
    terms = '{"method": "palms", "particles": 300, "seed": 5, "source": "vio", "frame": "scan"}'
    with old._transaction() as write:
        write.execute("UPDATE sessions SET terms = ?", (terms,))
    old.append([("s", 1, 0.0, json.dumps(scan_of()))])
    assert old.version == 1
    old.close()
    phone = phones(serve(folder=folder))
    phone.say({"type": "hello", "session": "s", "key": "key"})
    welcome = phone.next()
    assert (welcome["level"], welcome["next_seq"], welcome["resumed"]) == ("1", 2, True)
    assert phone.until("estimate")["level"] == "1"
    assert hello(phones(serve(folder=folder_with_house(tmp_path / "new"))))["level"] is None


def test_a_building_of_one_level_is_as_it_was():
    alone = Building((GROUND,))
    one, two = Follower(Floor.of(alone, "0"), Terms(particles=300)), follower("0")
    assert two.floor.level == "0"
    assert one.localizer.atlas is None
    assert Floor.of(HOUSE).level is None
    assert ALL == ""
    assert isinstance(one.floor.ground.plan, FloorPlan)
    assert isinstance(GROUND.rooms[0], Room)
