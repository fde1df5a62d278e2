"""The reference says what the extraction's settings are."""

import dataclasses

from palms.extraction import ExtractionSettings
from tests.docs.pages import DOCS, table_rows


def test_each_setting_of_the_extraction_has_its_row():
    rows = {row[0].strip("`"): row for row in table_rows(DOCS / "reference" / "settings.md")}
    for field in dataclasses.fields(ExtractionSettings):
        _, unit, value, meaning = rows[field.name]
        assert value == f"`{field.default!r}`"
        assert unit == {"m": "m", "rad": "rad"}.get(field.name.rpartition("_")[2], "")
        assert "ours" in meaning or "maker" in meaning
