from __future__ import annotations

import json
import os
import stat

import pytest

from palms.errors import FormatError, InputError, OutputError
from palms.io import files
from palms.io.files import read_json, read_text, remove_stale, sniff, write_json, write_text


def test_missing_file(tmp_path, says):
    with pytest.raises(InputError) as caught:
        read_text(tmp_path / "none.csv")
    says(caught.value, "none.csv", "nothing there")


def test_folder_instead_of_file(tmp_path, says):
    with pytest.raises(InputError) as caught:
        read_json(tmp_path)
    says(caught.value, "a folder")


@pytest.mark.parametrize("content", [b"", b" \n\r\n", b"\xef\xbb\xbf", "\u2003".encode()])
def test_empty_file(put, says, content):
    with pytest.raises(FormatError) as caught:
        read_text(put("a.csv", content))
    says(caught.value, "an empty file")


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (b"\x89PNG\r\n\x1a\n\x00", "a PNG image"),
        (b"PK\x03\x04\xff", "a zip archive"),
        (b"\xff\xfe1\x00", "UTF-16"),
        (b"1,2\x00,3", "binary data"),
        (b"1,2,caf\xe9", "not UTF-8"),
    ],
)
def test_binary_file(put, says, content, kind):
    with pytest.raises(FormatError) as caught:
        read_text(put("a.csv", content))
    says(caught.value, kind)


def test_too_large(put, says, monkeypatch):
    monkeypatch.setattr(files, "MAX_BYTES", 10)
    with pytest.raises(InputError) as caught:
        read_text(put("a.csv", "1,2,3,4,5,6"))
    says(caught.value, "MB")


def test_name_that_no_file_can_have(says):
    with pytest.raises(InputError) as caught:
        read_text("a\x00b")
    says(caught.value)


def test_byte_order_mark_is_dropped(put):
    assert read_text(put("a.txt", b"\xef\xbb\xbf1")) == "1"


def test_truncated_json_names_the_line(put, says):
    with pytest.raises(FormatError) as caught:
        read_json(put("a.json", '{"a":\n [1, 2'))
    says(caught.value, "a.json line 2", "cut off")


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a": ' * 50_000])
def test_too_deep_json(put, says, text):
    with pytest.raises(FormatError) as caught:
        read_json(put("a.json", text))
    says(caught.value)


def test_huge_integers_are_floats(put):
    assert read_json(put("a.json", "[1" + "0" * 400 + "]")) == [float("inf")]


@pytest.mark.parametrize("value", [float("nan"), [float("inf")], {"a": object()}])
def test_json_never_holds_what_is_no_json(tmp_path, says, value):
    path = tmp_path / "a.json"
    with pytest.raises(OutputError) as caught:
        write_json(path, value)
    says(caught.value)
    assert not path.exists()


def test_unwritable_parent_is_a_file(unwritable, says):
    with pytest.raises(OutputError) as caught:
        write_text(unwritable / "a.txt", "text")
    says(caught.value, "no folder")


def test_unwritable_parent_is_missing(tmp_path, says):
    with pytest.raises(OutputError) as caught:
        write_text(tmp_path / "none" / "a.txt", "text")
    says(caught.value, "create it first")


def test_a_folder_is_not_replaced(tmp_path, says):
    (tmp_path / "a").mkdir()
    with pytest.raises(OutputError) as caught:
        write_text(tmp_path / "a", "text")
    says(caught.value)
    assert os.listdir(tmp_path) == ["a"]


def test_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    write_text(tmp_path / "a", "old")

    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "replace", full_disk)
    with pytest.raises(OutputError, match="No space left"):
        write_text(tmp_path / "a", "new")
    assert os.listdir(tmp_path) == ["a"]
    assert (tmp_path / "a").read_text() == "old"


def test_written_file_has_the_usual_rights(tmp_path):
    write_text(tmp_path / "a", "text")
    (tmp_path / "b").write_text("text")
    rights = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in "ab"]
    assert rights[0] == rights[1]


def test_json_round_trip(tmp_path):
    value = {"a": [1, 2.5, None, "ü", 0.1 + 0.2], "b": True}
    write_json(tmp_path / "a.json", value)
    assert read_json(tmp_path / "a.json") == value
    assert json.loads((tmp_path / "a.json").read_text(encoding="utf-8")) == value


def test_sniff():
    assert sniff(b"<?xml") == "XML or HTML"
    assert sniff(b"\xef\xbb\xbf [1]") == "JSON"


def test_remove_stale_says_when_it_cannot(tmp_path, says):
    with pytest.raises(OutputError) as caught:
        remove_stale(tmp_path)
    says(caught.value)
