"""Where one is, in words: a room, two that it may be, or a part of the building."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from palms.voice.catalogue import Catalogue, read_catalogue
from palms.voice.measures import accuracy_m, ahead, direction, length, rounded_up
from palms.voice.moments import Moment
from palms.voice.preferences import Preferences
from palms.voice.surroundings import Area, Nearby, Surroundings

__all__ = ["Placed", "Voice", "sentence"]

WIDE_M = 6.0  # ours: less accurate than that, and no direction or neighbour is told
SURE = 0.5  # ours: in a room is who is inside by so much of the 95 % radius
NEAR_M = 6.0  # ours: farther rooms are not near
FAR_M = 40.0  # ours: how far off what names a part of the building may be
AROUND = 3  # ours: as many as one remembers
MOST = 12  # ours: neighbours that are looked at


class Placed(NamedTuple):
    """A place in words.

    Attributes
    ----------
    text : str
        Without a capital and a full stop.
    details : str or None
        Sentences.
    key : tuple of str
        Of what it names: the same key is not said again.
    """

    text: str
    details: str | None
    key: tuple[str, ...]


@dataclass(frozen=True)
class Voice:
    """Says where one is.

    Parameters
    ----------
    surroundings : Surroundings
    preferences : Preferences

    Examples
    --------
    >>> from palms.floorplan import FloorPlan, Room
    >>> hall = Room("Hall", [[0, 0], [9, 0], [9, 6], [0, 6]])
    >>> voice = Voice(Surroundings.of(FloorPlan([[[0, 0], [9, 0]]], rooms=(hall,))))
    >>> voice.placed(Moment("localized", 30.0, (4.0, 3.0), 0.8))
    Placed(text='Hall', details='Accurate to 2 metres.', key=('', 'Hall'))
    """

    surroundings: Surroundings
    preferences: Preferences = field(default_factory=Preferences)

    @property
    def texts(self) -> Catalogue:
        """The texts of its language."""
        return read_catalogue(self.preferences.language)

    def placed(self, moment: Moment, is_sure: bool = True) -> Placed:
        """Return the place of a moment that has one (`Moment.is_placed`)."""
        assert moment.position_m is not None
        told_m = rounded_up(accuracy_m(moment), self.preferences)
        wide = told_m > WIDE_M
        text, key, near = self._part(moment, told_m) if wide else self._room(moment)
        if not is_sure:
            text, key = self.texts.say("place.probably", place=text), (*key, "probably")
        level = self.level_name(moment.level)
        if level is not None:
            text = self.texts.say("place.level", level=level, place=text)
        toward = [] if near is None or wide else [self._toward(moment, near)]
        details = " ".join([*toward, self.accuracy(moment)])
        return Placed(text, details, (moment.level or "", *key))

    def accuracy(self, moment: Moment) -> str:
        """Say how accurate a place is."""
        told = length(accuracy_m(moment), self.preferences, self.texts, up=True)
        return self.texts.say("accuracy", distance=told)

    def around(self, moment: Moment, is_sure: bool = True) -> str:
        """Say what is around, the nearest first."""
        assert moment.position_m is not None
        if rounded_up(accuracy_m(moment), self.preferences) > WIDE_M:
            return f"{sentence(self.placed(moment, is_sure).text)} {self.accuracy(moment)}"
        near = self.surroundings.nearest(moment.level, moment.position_m, 2 * NEAR_M, AROUND)
        told = [self._toward(moment, each) for each in near]
        if told and not is_sure:
            told[0] = sentence(self.texts.say("place.probably", place=told[0]))
        return " ".join([*(told or [self.texts.say("around.nothing")]), self.accuracy(moment)])

    def name(self, name: str) -> str:
        """Return what to call a room: one that is only a number gets a word before it."""
        return self.texts.say("room", number=name) if name.isdigit() else name

    def level_name(self, level: str | None) -> str | None:
        """Return what to call a level; None where there is only one, or it has no name."""
        if not level or len(self.surroundings.levels) < 2:
            return None
        return self.texts.say("level", level=level) if len(level) <= 3 else level

    def _room(self, moment: Moment) -> tuple[str, tuple[str, ...], Nearby | None]:
        """Say a room or corridor, and a neighbour where that helps."""
        import shapely

        assert moment.position_m is not None
        assert moment.radius_95_m is not None
        x, y = moment.position_m
        home = self.surroundings.home(moment.level, x, y)
        near = self._landmark(moment)
        if home is None:
            return self._beside(near)
        margin = SURE * moment.radius_95_m
        if home.polygon.boundary.distance(shapely.Point(x, y)) < margin:
            others = [
                area for area in self.surroundings.touching(moment.level, x, y, margin)
                if area.name != home.name
            ]  # fmt: skip
            return self._either(home, others[0] if others else None)
        if near is None or not home.is_roomy:
            return self.name(home.name), (home.name,), None
        names = {"area": self.name(home.name), "other": self.name(near.area.name)}
        return self.texts.say("place.in_near", **names), (home.name, near.area.name), near

    def _landmark(self, moment: Moment) -> Nearby | None:
        """Return the nearest neighbour that a direction can be told of, else the nearest."""
        assert moment.position_m is not None
        near = self.surroundings.nearest(moment.level, moment.position_m, NEAR_M, MOST)
        ways = (each for each in near if ahead(moment, each.bearing_rad, each.away_m) is not None)
        return next(ways, near[0] if near else None)

    def _beside(self, near: Nearby | None) -> tuple[str, tuple[str, ...], Nearby | None]:
        if near is None:
            return self.texts.say("place.unnamed"), (), None
        name = self.name(near.area.name)
        return self.texts.say("place.near", other=name), (near.area.name,), near

    def _either(self, home: Area, other: Area | None) -> tuple[str, tuple[str, ...], Nearby | None]:
        if other is None:
            return self.texts.say("place.near", other=self.name(home.name)), (home.name,), None
        first, second = sorted((home.name, other.name))
        text = self.texts.say("place.either", area=self.name(first), other=self.name(second))
        return text, (first, second), None

    def _part(self, moment: Moment, told_m: float) -> tuple[str, tuple[str, ...], Nearby | None]:
        """Say a part of the building that holds a wide disc."""
        assert moment.position_m is not None
        assert moment.radius_95_m is not None
        x, y = moment.position_m
        touched = self.surroundings.touching(moment.level, x, y, moment.radius_95_m)
        inside = bool(touched) and touched[0].away_m(x, y) == 0
        if inside and len(touched) == 1:
            name = touched[0].name
            return self.texts.say("place.somewhere", area=self.name(name)), (name, "wide"), None
        if inside and len(touched) == 2:
            return self._either(*touched)
        nearest = touched[:1] or [
            each.area for each in self.surroundings.nearest(moment.level, (x, y), FAR_M)
        ]
        if not nearest:
            return self.texts.say("place.unnamed"), (), None
        reach = told_m + nearest[0].away_m(x, y)
        distance = length(reach, self.preferences, self.texts, up=True)
        text = self.texts.say("place.part", distance=distance, other=self.name(nearest[0].name))
        return text, (nearest[0].name, "part"), None

    def _toward(self, moment: Moment, near: Nearby) -> str:
        """Say how far a room is, and in which direction where that is known."""
        name = self.name(near.area.name)
        away = length(near.away_m, self.preferences, self.texts)
        if away is None:
            return sentence(self.texts.say("details.here", area=name))
        left = ahead(moment, near.bearing_rad, near.away_m)
        if left is None:
            return sentence(self.texts.say("details.away", area=name, distance=away))
        way = direction(left, self.preferences, self.texts)
        return sentence(self.texts.say("details.towards", area=name, distance=away, direction=way))


def sentence(text: str) -> str:
    """Return a text with a capital, and a full stop where it has none.

    Examples
    --------
    >>> sentence("near Room 215")
    'Near Room 215.'
    """
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "!", "?")) else f"{text}."
