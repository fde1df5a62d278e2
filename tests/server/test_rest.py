"""REST: buildings, tracks, recordings, pushes."""

import io
import json
import zipfile

import httpx
import numpy as np
import pytest

import palms
from palms import Odometry, Scan, Settings
from palms.belief import whole_m
from palms.geometry import distance_to_segments, rotate
from palms.io import RecordedWalk, open_dataset, write_scan_json, write_tracking
from palms.io.track_json import track_document
from palms.server import messages
from palms.server.limits import Limits
from tests.server.conftest import hall, http, positions, scan_walls, whole_walk

HALL = b"0,0,8,0\n8,0,8,5\n8,5,0,5\n0,5,0,0\n"
GEOJSON = json.dumps({
    "type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"name": "Hall"}, "geometry": {
            "type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 6], [0, 6], [0, 0]]]}}]
}).encode()  # fmt: skip


def upload(rest, file, content, **data):
    return rest.post("/api/v1/buildings", files={"file": (file, content)}, data=data)


def test_buildings_come_are_shown_and_go(rest):
    made = upload(rest, "hall.csv", HALL, name="Town Hall", level="G")
    assert made.status_code == 201
    building = made.json()
    assert building["id"].startswith("town-hall-")
    assert [level["name"] for level in building["levels"]] == ["G"]
    place = f"/api/v1/buildings/{building['id']}"
    assert rest.get(place).json() == building
    assert building in rest.get("/api/v1/buildings").json()["buildings"]
    plan = rest.get(f"{place}/plan").json()
    assert plan["schema"] == "palms-plan/1"
    assert plan["segments_m"][0] == [[0.0, 0.0], [8.0, 0.0]]
    assert plan["classes"] == ["wall"] * 4
    more = rest.post(
        f"{place}/levels", files={"file": ("up.geojson", GEOJSON)}, data={"level": "1"}
    )
    assert [level["name"] for level in more.json()["levels"]] == ["G", "1"]
    assert rest.get(f"{place}/rooms", params={"level": "1"}).json()[0]["name"] == "Hall"
    assert rest.get(f"{place}/plan", params={"level": "9"}).status_code == 404
    assert rest.delete(place).status_code == 204
    assert rest.get(place).status_code == 404
    assert rest.delete(place).status_code == 404


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("hall.csv", b"0,0,8,x\n", "4 finite numbers"),
        ("hall.csv", b"", "empty"),
        ("hall.dwg", b"\x00\x01\x02", "floor plan"),
        ("hall.csv", b"0,0,99999,0\n0,0,0,99999\n", "metres"),
        ("hall.csv", b"0,0,4000,0\n0,0,0,4000\n", "square metres"),
    ],
)
def test_a_plan_that_cannot_be_used_is_refused_in_one_line(rest, name, content, said):
    answer = upload(rest, name, content)
    assert answer.status_code == 422
    text = answer.json()["error"]
    assert said in text
    assert "\n" not in text
    assert "/tmp" not in text


@pytest.mark.parametrize(
    "name", ["../../../etc/evil.csv", "/etc/passwd", "a\\..\\b.csv", "x" * 5000]
)
def test_names_of_files_reach_no_file_system(rest, name, tmp_path):
    answer = upload(rest, name, HALL, format="csv")
    if len(name) > 1000:
        assert 400 <= answer.status_code < 500
        return
    assert answer.status_code == 201
    assert ".." not in answer.json()["id"]
    assert "/" not in answer.json()["id"]
    rest.delete(f"/api/v1/buildings/{answer.json()['id']}")


@pytest.mark.parametrize(
    "path", ["/../context.py", "/%2e%2e/context.py", "/..%2fcontext.py", "//etc/passwd", "/.git"]
)
def test_no_path_leads_out_of_the_pages(rest, path):
    assert rest.get(path).status_code == 404
    assert rest.get(f"/api/v1/buildings{path}/plan").status_code == 404


def test_sizes_rates_and_numbers_have_limits(serve):
    url = serve(Limits(upload_bytes=2000, buildings=2, requests_per_s=0.001, request_burst=8))
    with httpx.Client(base_url=url, timeout=60) as rest:
        assert upload(rest, "hall.csv", HALL).status_code == 201
        full = upload(rest, "hall.csv", HALL)
        assert full.status_code == 422
        assert "at most 2" in full.json()["error"]
        assert upload(rest, "hall.csv", HALL * 200).status_code == 413
        chunks = rest.post(
            "/api/v1/buildings", content=(HALL for _ in range(200)),
            headers={"content-type": "multipart/form-data; boundary=x"},
        )  # fmt: skip
        assert 400 <= chunks.status_code < 500
        found = [rest.get("/health").status_code for _ in range(8)]
        assert found[0] == 200
        assert found[-1] == 429


def test_a_reader_that_takes_too_long_or_too_much_is_stopped(serve):
    plan = b"".join(b"%d,0,%d,5\n" % (i, i) for i in range(30_000))
    slow = serve(Limits(upload_s=0.05), inline_uploads=False)
    answer = upload(httpx.Client(base_url=slow, timeout=60), "hall.csv", plan)
    assert answer.status_code == 422
    assert "longer" in answer.json()["error"]


def test_a_reader_that_takes_too_much_memory_is_stopped(serve):
    small = serve(Limits(upload_memory_bytes=60_000_000), inline_uploads=False)
    answer = upload(httpx.Client(base_url=small, timeout=60), "hall.csv", HALL)
    assert answer.status_code == 422
    assert "file" in answer.json()["error"]


def test_files_are_read_in_a_process_of_their_own(serve):
    url = serve(inline_uploads=False)
    made = upload(httpx.Client(base_url=url, timeout=60), "hall.geojson", GEOJSON)
    assert made.status_code == 201, made.text


def test_a_recorded_walk_is_tracked_as_the_command_does_it(rest, tmp_path):
    odometry = Odometry(0.5 * np.arange(1, 14), positions())
    write_tracking(RecordedWalk.of(odometry), tmp_path / "walk.json")
    write_scan_json(Scan(scan_walls()), tmp_path / "scan.json")
    files = {name: (f"{name}.json", (tmp_path / f"{name}.json").read_bytes())
             for name in ("scan", "walk")}  # fmt: skip
    form = {"building": "hall", "method": "paper", "seed": "3"}
    answer = rest.post("/api/v1/tracks", files=files, data=form)
    assert answer.status_code == 200, answer.text
    seen = palms.read_scan(tmp_path / "scan.json")
    mine = palms.track(hall(), seen, odometry, Settings.paper(), 3)
    expected = track_document([mine], hall(), Settings.paper())["trials"][0]["steps"]
    assert answer.json()["trials"][0]["steps"] == expected
    assert rest.post("/api/v1/tracks", files=files, data={"building": "x"}).status_code == 404
    files["walk"] = ("walk.json", b"{}")
    assert rest.post("/api/v1/tracks", files=files, data=form).status_code == 422


def scan_file(tmp_path):
    write_scan_json(Scan(scan_walls()), tmp_path / "scan.json")
    return {"scan": ("scan.json", (tmp_path / "scan.json").read_bytes())}


def test_a_scans_file_becomes_a_message(rest, tmp_path):
    files = scan_file(tmp_path)
    answer = rest.post("/api/v1/scans", files=files, data={"building": "hall"})
    assert answer.status_code == 200, answer.text
    message = messages.parse_message(answer.text)
    assert np.allclose(message.planes, scan_walls())
    assert message.position_m == (0.0, 0.0)
    assert rest.post("/api/v1/scans", files=files, data={"building": "x"}).status_code == 404
    files["scan"] = ("scan.json", b"[]")
    assert rest.post("/api/v1/scans", files=files, data={"building": "hall"}).status_code == 422


def test_a_sessions_key_lets_its_files_be_read_and_nobody_elses(serve, phones, tmp_path):
    token = "a token of some length"
    url = serve(token=token)
    phone = phones(url, additional_headers={"Authorization": f"Bearer {token}"})
    key = phone.hello()["key"]
    files = scan_file(tmp_path)

    def status(bearer, building="hall"):
        headers = {"Authorization": f"Bearer {bearer}"}
        asked = {"files": files, "data": {"building": building}, "headers": headers}
        return httpx.post(f"{url}/api/v1/scans", timeout=60, **asked).status_code

    assert [status(key), status(token), status("guess"), status(key, "other")] == [
        200, 200, 401, 401,
    ]  # fmt: skip


def recorded(server, phones, additional_headers=None, **fields):
    phone = phones(server, additional_headers=additional_headers)
    phone.hello(**({"record": True} | fields))
    last = phone.walk([*whole_walk(), {"type": "hint", "seq": 15, "room": "Study"}])
    phone.say({"type": "end"})
    return phone.until("ended")["recording"], last


def test_only_what_its_walker_wants_is_recorded(server, phones, rest):
    name, last = recorded(server, phones)
    listed = {
        each["recording"]: each for each in rest.get("/api/v1/recordings").json()["recordings"]
    }
    assert listed[name]["n_inputs"] == 15
    document = rest.get(f"/api/v1/recordings/{name}").json()
    assert document["schema"] == "palms-recording/1"
    assert document["inputs"][0]["message"]["type"] == "scan"
    track = rest.get(f"/api/v1/recordings/{name}/track").json()
    assert track["estimates"][-1] == json.loads(json.dumps(last)) | {
        "hypotheses": last["hypotheses"]
    }
    assert rest.delete(f"/api/v1/recordings/{name}").status_code == 204
    assert rest.get(f"/api/v1/recordings/{name}").status_code == 404
    assert recorded(server, phones, record=False)[0] is None


def test_a_walker_may_discard_and_a_server_may_forbid(serve, phones):
    url = serve(may_record=False)
    assert recorded(url, phones)[0] is None
    assert http.get(url + "/api/v1/recordings").json() == {"recordings": []}


def test_a_recording_is_exported_as_a_data_set(server, phones, rest, tmp_path):
    name, last = recorded(server, phones)
    answer = rest.get(f"/api/v1/recordings/{name}/dataset")
    assert answer.headers["content-type"] == "application/zip"
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        archive.extractall(tmp_path)
    (case,) = open_dataset(tmp_path).cases
    assert case.scene == "hall"
    assert np.allclose(case.scan().walls_m, scan_walls())
    odometry = case.walk().odometry()
    assert len(odometry) == 13
    assert odometry.walked_m[-1] == pytest.approx(last["walked_m"])
    assert case.plan().room_at((1, 1)) == "Study"
    (event,) = json.loads((case.folder / "events.json").read_text())
    assert event["room"] == "Study"
    rest.delete(f"/api/v1/recordings/{name}")


def test_a_link_shows_a_recording_s_track_and_nothing_else(serve, phones):
    token = "a token that is long enough"
    url = serve(token=token)
    operator = {"Authorization": f"Bearer {token}"}
    name, _ = recorded(url, phones, additional_headers=operator)
    place = f"{url}/api/v1/recordings/{name}"
    view = http.post(f"{place}/links", json={"ttl_s": 60}, headers=operator).json()["view"]
    linked = {"Authorization": f"Bearer {view}"}
    track = http.get(f"{place}/track", headers=linked)
    assert track.status_code == 200
    assert track.json()["plan"]["schema"] == "palms-plan/1"
    assert http.get(f"{place}/frames", headers=linked).status_code == 200
    for other in (f"{place}/dataset", place, f"{url}/api/v1/recordings", f"{url}/api/v1/backup"):
        assert http.get(other, headers=linked).status_code == 401
    assert http.get(f"{place}/track").status_code == 401
    assert http.delete(place, headers=operator).status_code == 204
    assert http.get(f"{place}/track", headers=linked).status_code == 401


def test_a_drawn_walk_is_simulated_in_one_frame(rest, server, phones):
    sent = {"building": "hall", "path_m": [[2.0, 2.0], [2.0, 4.3], [5.0, 4.3]], "seed": 2}
    answer = rest.post("/api/v1/simulations", json=sent)
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert not found["is_cut"]
    phone = phones(server)
    phone.hello()
    inputs = [found["scan"], *({"type": "odometry", "seq": seq, "samples": [sample]}
                               for seq, sample in enumerate(found["samples"], 2))]  # fmt: skip
    assert phone.walk(inputs)["walked_m"] == pytest.approx(5.3, abs=0.7)
    truth = np.array(found["truth_m"])
    places = np.array([[0.0, 0.0], *(sample["position_m"] for sample in found["samples"])])
    along, moved = truth[-1] - truth[0], places[-1] - places[0]
    drift = np.arctan2(along[1], along[0]) - np.arctan2(moved[1], moved[0])
    seen = rotate(np.array(found["scan"]["planes"]), drift).reshape(-1, 2) + truth[0]
    away = [distance_to_segments(point, hall().segments_m).min() for point in seen]
    assert np.median(away) < 0.2
    again = rest.post("/api/v1/simulations", json=sent).json()
    assert again == found
    through = rest.post("/api/v1/simulations", json=sent | {"path_m": [[2.0, 2.0], [2.0, 11.0]]})
    assert through.json()["is_cut"]
    assert max(y for _, y in through.json()["truth_m"]) < 5.0
    alone = rest.post("/api/v1/simulations", json=sent | {"path_m": [[2.0, 2.0]]}).json()
    assert alone["scan"]["planes"]
    assert alone["samples"] == []
    for path in ([[-50.0, 0.0]], [[2.0, 2.0], [9e4, 0.0]], []):
        refused = rest.post("/api/v1/simulations", json=sent | {"path_m": path})
        assert refused.status_code == 422
    assert rest.post("/api/v1/simulations", json=sent | {"building": "x"}).status_code == 404


def test_a_walk_is_chosen_where_none_is_drawn(rest):
    sent = {"building": "hall", "length_m": 6.0, "seed": 3}
    found = rest.post("/api/v1/simulations", json=sent).json()
    truth = np.array(found["truth_m"])
    walked = np.linalg.norm(np.diff(truth, axis=0), axis=1).sum()
    assert 5 < walked <= 6
    assert not found["is_cut"]
    assert len(found["samples"]) == len(truth) - 1
    assert rest.post("/api/v1/simulations", json=sent).json() == found
    other = rest.post("/api/v1/simulations", json=sent | {"seed": 4}).json()
    assert other["truth_m"][0] != found["truth_m"][0]
    assert rest.post("/api/v1/simulations", json=sent | {"length_m": 1e6}).status_code == 422


def frames_of(content):
    """The binary frames of a stream in which each follows its length."""
    at = 0
    while at < len(content):
        n = int.from_bytes(content[at : at + 4], "little")
        yield messages.unpack_frame(content[at + 4 : at + 4 + n])
        at += 4 + n


def test_a_recording_s_frames_are_those_that_a_viewer_got(server, phones, rest):
    name, last = recorded(server, phones, particles=800)
    answer = rest.get(f"/api/v1/recordings/{name}/frames")
    assert answer.headers["content-type"] == "application/octet-stream"
    found = list(frames_of(answer.content))
    maps = [each for each in found if isinstance(each, messages.HeatmapFrame)]
    assert [each.number for each in maps] == list(range(len(maps)))
    assert all(each.label < each.n_labels for each in maps)
    clouds = [each for each in found if isinstance(each, messages.ParticlesFrame)]
    assert [each.seq for each in clouds] == list(range(1, 16))
    away = np.linalg.norm(clouds[-1].position_m - [last["x_m"], last["y_m"]], axis=1)
    radius_m = whole_m(last["radius_95_m"], Settings().answer.local_spread)
    assert np.mean(away <= radius_m) == pytest.approx(0.95, abs=0.06)


def test_an_address_is_drawn_as_a_code(rest):
    answer = rest.post("/api/v1/codes", json={"text": "https://palms.local:8000/phone/"})
    assert answer.headers["content-type"] == "image/svg+xml"
    assert answer.text.startswith("<svg ")
    assert "script" not in answer.text
    assert rest.post("/api/v1/codes", json={"text": ""}).status_code == 422


def test_a_recording_without_a_walk_is_no_data_set(server, phones, rest):
    phone = phones(server)
    phone.hello(record=True)
    phone.walk(whole_walk()[:1])
    phone.say({"type": "end"})
    name = phone.until("ended")["recording"]
    answer = rest.get(f"/api/v1/recordings/{name}/dataset")
    assert answer.status_code == 422
    assert "moves" in answer.json()["error"]


def test_sessions_are_listed_without_places_and_can_be_deleted(server, phones, rest):
    phone = phones(server)
    welcome = phone.hello(record=True)
    phone.walk(whole_walk())
    (found,) = [
        each for each in rest.get("/api/v1/sessions").json()["sessions"]
        if each["session"] == welcome["session"]
    ]  # fmt: skip
    assert found["is_connected"]
    assert found["n_inputs"] == 14
    assert not {"x_m", "y_m", "room"} & set(found)
    assert rest.delete("/api/v1/buildings/hall").status_code == 409
    assert rest.delete(f"/api/v1/sessions/{welcome['session']}").status_code == 204
    assert phone.rest()[0][-1]["reason"] == "deleted"
    assert rest.delete(f"/api/v1/sessions/{welcome['session']}").status_code == 404


def test_the_server_says_how_it_is(rest):
    assert rest.get("/health").json()["status"] == "ok"
    text = rest.get("/metrics").text
    for name in ("palms_inputs_total", "palms_walkers", 'palms_step_seconds_bucket{le="0.1"}'):
        assert name in text
    copy = rest.get("/api/v1/backup").content
    assert copy.startswith(b"SQLite format 3")
    assert rest.get("/api/v1/buildings").headers["cache-control"] == "no-store"
    page = rest.get("/")
    assert page.status_code == 200
    assert "default-src 'self'" in page.headers["content-security-policy"]
    assert page.headers["x-content-type-options"] == "nosniff"
