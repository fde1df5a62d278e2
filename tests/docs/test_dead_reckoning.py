"""The settings of dead reckoning are those of the code, with unit and origin."""

import dataclasses

from palms.inertial import InertialSettings
from tests.docs.pages import DOCS, table_rows

SETTINGS = DOCS / "reference" / "settings.md"


def test_each_setting_has_its_row():
    fields = {field.name: field.default for field in dataclasses.fields(InertialSettings)}
    rows = {row[0].strip("`"): row for row in table_rows(SETTINGS) if len(row) == 4}
    found = {name: row for name, row in rows.items() if name in fields}
    assert list(found) == list(fields)
    for name, row in found.items():
        assert row[2].strip("`") == repr(fields[name])
        assert len(row[3]) > 5
        assert bool(row[1]) == isinstance(fields[name], float)


def test_the_reader_s_options_are_described():
    import inspect

    from palms.io import ODOMETRY, formats

    rows = {row[0].strip("`"): row for row in table_rows(DOCS / "reference" / "files.md")}
    for reader in formats(ODOMETRY):
        options = list(inspect.signature(reader.read).parameters)[1:]
        if reader.name == "tracking":
            continue
        told = rows[reader.name][3]
        if "those of `android`" in told:
            told += rows["android"][3]
        assert all(f"`{option}`" in told for option in options), reader.name
        assert all(f"`{suffix}`" in rows[reader.name][1] for suffix in reader.suffixes)
