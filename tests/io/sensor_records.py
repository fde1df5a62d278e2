"""The archives of Sensor Logger of our own making, as the app's other forms have them."""

import csv
import zipfile
from pathlib import Path

DATA = Path(__file__).parent / "data" / "walks"


def records(system: str) -> list[dict]:
    """What is in an archive, as the JSON export has it: all values are texts."""
    found = []
    with zipfile.ZipFile(DATA / f"sensor-logger-{system}.zip") as archive:
        for name in archive.namelist():
            for row in csv.DictReader(archive.read(name).decode().splitlines()):
                found.append({"sensor": Path(name).stem, **row})
    return found


def pushed(system: str) -> list[dict]:
    """The same as messages of 50 records each, as the app pushes them."""
    rows = [
        {
            "name": row["sensor"].lower(),
            "time": int(row["time"]),
            "values": {key: float(row[key]) for key in row.keys() - {"sensor", "time"}},
        }
        for row in sorted(records(system)[1:], key=lambda row: int(row["time"]))
    ]
    for row in rows:
        del row["values"]["seconds_elapsed"]
    return [
        {"messageId": k, "sessionId": "a", "deviceId": "b", "payload": rows[50 * k : 50 * (k + 1)]}
        for k in range(-(-len(rows) // 50))
    ]
