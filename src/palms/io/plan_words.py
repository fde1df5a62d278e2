"""Words that drawings use for walls, doors, openings, glass and rooms."""

from __future__ import annotations

import re
from collections.abc import Mapping
from enum import Enum

from palms.errors import InputError
from palms.floorplan import SegmentClass

__all__ = ["Role", "parse_classes", "role_of"]


class Role(Enum):
    """What a feature of a drawing is to a floor plan."""

    WALL = "wall"
    DOOR = "door"
    OPENING = "opening"
    GLASS = "glass"
    ROOM = "room"
    OPEN_AREA = "corridor"
    OUTLINE = "outline"
    NOTHING = "nothing"

    @property
    def segment_class(self) -> SegmentClass | None:
        """The class of its segments; None when it has none."""
        return SegmentClass[self.name] if self.name in SegmentClass.__members__ else None


_WORDS = {
    Role.DOOR: "door doors entrance exit gate tuer tür porte puerta porta",
    Role.OPENING: "opening openings gap passage archway opening_in_wall",
    Role.GLASS: "window windows glass glazing glaz curtain_wall fenster fenetre fenêtre ventana",
    Role.WALL: "wall walls partition column columns pillar shaft inaccessible_space void solid "
    "mur wand muro parete concrete brick drywall",
    Role.OUTLINE: "building_outline outline footprint building floor floorplate level exterior",
    Role.OPEN_AREA: "corridor hallway hall area walkway lobby open unenclosedarea platform "
    "concourse",
    Role.ROOM: "room rooms unit space office classroom stairs elevator bathroom toilet restroom",
    Role.NOTHING: "furniture text label annotation dimension route path poi anchor fixture detail "
    "nothing ignore none",
}
_ROLES = {word: role for role, words in _WORDS.items() for word in words.split()}


def role_of(word: str | None, mapping: Mapping[str, Role] | None = None) -> Role | None:
    """Return what a word of a file stands for; None when it is not known.

    Parameters
    ----------
    word : str or None
    mapping : mapping, optional
        Words of the user, which come first.

    Examples
    --------
    >>> role_of("Window"), role_of("yucca")
    (<Role.GLASS: 'glass'>, None)
    """
    if word is None:
        return None
    key = re.sub(r"[\s-]+", "_", word.strip().lower())
    return (mapping or {}).get(key) or _ROLES.get(key)


def parse_classes(text: str | None) -> dict[str, Role]:
    """Return the words of an option ``muro:wall,vidrio:glass``.

    Raises
    ------
    InputError
        When it is not of that form.

    Examples
    --------
    >>> parse_classes("vidrio:glass")
    {'vidrio': <Role.GLASS: 'glass'>}
    """
    found = {}
    for pair in (part for part in (text or "").split(",") if part.strip()):
        word, colon, role = pair.rpartition(":")
        known = [each.value for each in Role]
        if not colon or role.strip() not in known:
            raise InputError(
                "classes", expected=f"word:class with a class of {', '.join(known)}", got=pair
            )
        found[re.sub(r"[\s-]+", "_", word.strip().lower())] = Role(role.strip())
    return found
