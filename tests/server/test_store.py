"""The store: versions, deletion, one owner."""

import sqlite3

import pytest

from palms.errors import InputError, OutputError
from palms.server.follower import Terms
from palms.server.store import FILE, MIGRATIONS, BuildingRow, SessionRow, Store

SECRET = "an input nobody should find again"


@pytest.fixture
def store(tmp_path):
    opened = Store(tmp_path / "data")
    opened.add_building(BuildingRow("hall", "Hall", (("1", "{}"), ("2", "{}"))), 1.0)
    yield opened
    opened.close()


def row(name="s1", **changes):
    fields = {"is_recording": False, "created_s": 5.0, "seen_s": 6.0} | changes
    return SessionRow(name, b"hash", "hall", "1", Terms("paper", 7, 3, "inertial", "own"), **fields)


def test_what_is_stored_comes_back(store):
    store.add_session(row())
    texts = ['{"a": 1}', '{"b": "' + "x" * 5000 + '"}', "{}"]
    store.append([("s1", seq, 10.0 + seq, text) for seq, text in enumerate(texts, 1)])
    assert store.session("s1") == row()
    assert store.sessions() == [row()]
    assert store.inputs("s1") == [(i, 10.0 + i, text) for i, text in enumerate(texts, 1)]
    assert store.n_inputs("s1") == 3
    assert store.buildings()[0].levels == (("1", "{}"), ("2", "{}"))


def test_a_group_of_inputs_is_stored_whole_or_not_at_all(store):
    store.add_session(row())
    store.append([("s1", 1, 0.0, "{}")])
    with pytest.raises(sqlite3.IntegrityError):
        store.append([("s1", 2, 0.0, "{}"), ("s1", 1, 0.0, "{}")])
    assert store.n_inputs("s1") == 1


def test_what_is_deleted_is_nowhere_in_the_folder(store):
    store.add_session(row())
    store.append([("s1", seq, 0.0, SECRET) for seq in range(1, 400)])
    files = list(store.folder.iterdir())
    assert any(SECRET.encode() in file.read_bytes() for file in files)
    store.delete_sessions(["s1"])
    assert not any(SECRET.encode() in file.read_bytes() for file in store.folder.iterdir())
    assert store.session("s1") is None
    assert store.inputs("s1") == []


def test_levels_are_replaced_whole_and_not_under_those_who_walk_on_all(store):
    three = (("0", "{}"), ("1", "{}"), ("2", "{}"))
    store.add_session(row())
    assert store.set_levels("hall", three)
    assert store.buildings()[0].levels == three
    store.add_session(SessionRow("all", b"h", "hall", "", Terms(start_level="1"), True, 5.0, 6.0))
    assert store.session("all").terms.start_level == "1"
    assert not store.set_levels("hall", three[:1])
    store.end_session("all", 9.0)  # a recording needs them, too
    assert not store.set_levels("hall", three[:1])
    assert store.buildings()[0].levels == three
    store.delete_sessions(["all"])
    assert store.set_levels("hall", three[:1])


def test_a_building_stays_while_a_session_needs_it(store):
    store.add_session(row())
    assert not store.delete_building("hall")
    assert len(store.buildings()) == 1
    store.delete_sessions(["s1"])
    assert store.delete_building("hall")
    assert store.buildings() == []


def test_a_recording_is_no_session_any_more(store):
    store.add_session(row(is_recording=True))
    store.end_session("s1", 9.0)
    assert store.sessions() == []
    assert [each.ended_s for each in store.sessions(ended=True)] == [9.0]


def test_a_newer_version_reads_an_older_store(tmp_path):
    old = Store(tmp_path)
    old.add_building(BuildingRow("hall", "Hall", (("1", "{}"),)), 1.0)
    old.add_session(row())
    old.append([("s1", 1, 0.0, "{}")])
    old.close()
    step = "ALTER TABLE sessions ADD COLUMN mood TEXT NOT NULL DEFAULT 'calm';"
    new = Store(tmp_path, (*MIGRATIONS, step))
    assert new.version == len(MIGRATIONS) + 1
    assert new.inputs("s1") == [(1, 0.0, "{}")]
    assert [each.name for each in new.buildings()] == ["Hall"]
    new.close()


def test_a_migration_that_fails_changes_nothing(tmp_path):
    Store(tmp_path).close()
    with pytest.raises(InputError):
        Store(tmp_path, (*MIGRATIONS, "CREATE TABLE half (x); NO SUCH STATEMENT;"))
    again = Store(tmp_path)
    assert again.version == len(MIGRATIONS)
    again.close()
    with sqlite3.connect(tmp_path / FILE) as file:
        assert not file.execute("SELECT 1 FROM sqlite_master WHERE name = 'half'").fetchall()
    file.close()


def test_a_newer_store_another_program_and_rubbish_are_refused(tmp_path):
    newer = Store(tmp_path / "newer", (*MIGRATIONS, "SELECT 1;"))
    newer.close()
    with pytest.raises(InputError, match="version"):
        Store(tmp_path / "newer")
    (tmp_path / "other").mkdir()
    with sqlite3.connect(tmp_path / "other" / FILE) as file:
        file.execute("CREATE TABLE theirs (x)")
    file.close()
    with pytest.raises(InputError, match="another program"):
        Store(tmp_path / "other")
    (tmp_path / "rubbish").mkdir()
    (tmp_path / "rubbish" / FILE).write_bytes(b"rubbish" * 1000)
    with pytest.raises(InputError, match="store of palms"):
        Store(tmp_path / "rubbish")
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        Store(tmp_path / "file")


def test_two_servers_do_not_share_a_folder(store):
    with pytest.raises(InputError, match="another server"):
        Store(store.folder)


def test_the_folder_is_for_its_owner_alone(store):
    assert store.folder.stat().st_mode & 0o077 == 0


def test_a_copy_made_while_it_is_in_use_is_whole(store, tmp_path):
    store.add_session(row())
    store.append([("s1", seq, 0.0, "{}") for seq in range(1, 50)])
    (tmp_path / "copy").mkdir()
    store.backup(tmp_path / "copy" / FILE)
    copy = Store(tmp_path / "copy")
    assert copy.n_inputs("s1") == 49
    copy.close()
