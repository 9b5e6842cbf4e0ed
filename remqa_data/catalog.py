"""The object types of the iTHOR floor plans: what can be done with each, and the words for it.

The facts are in `templates/objects.yaml`, which also says where they come from.

>>> object_type("GarbageCan").manipulation
'Move'
>>> with_article("Apple"), plural("Shelf")
('an apple', 'shelves')
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, lru_cache
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PositiveFloat,
    PositiveInt,
    ValidationError,
    field_validator,
    model_validator,
)

from remqa_data.errors import CatalogError, ConfigError, UnknownNameError
from remqa_data.yaml_files import Word, read_keys, template_text, template_values

Flag = Literal[
    "openable",
    "pickupable",
    "moveable",
    "receptacle",
    "toggleable",
    "breakable",
    "sliceable",
    "cookable",
    "dirtyable",
    "fillable",
    "used_up",
]
Manipulation = Literal["Open", "Move", "Pickup"]
Room = Literal["kitchen", "living_room", "bedroom", "bathroom"]

SOURCE = "objects.yaml"
TRAITS_SOURCE = "traits.yaml"


class Slices(BaseModel):
    """What becomes of an object that is sliced.

    Attributes
    ----------
    type : str
        AI2-THOR's name for each piece, such as "AppleSliced". It is no type of the catalog, as no room begins with it.
    words : (str, str)
        Singular and plural.
    count : int
        How many pieces.
    thickest_m : float, optional
        A piece is no thicker, metres.
    can : frozenset of str
        What can be done with them besides picking them up.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    type: str
    words: tuple[Word, Word]
    count: PositiveInt
    thickest_m: PositiveFloat | None = None
    can: frozenset[Flag] = frozenset()


class ObjectType(BaseModel):
    """One object type.

    Attributes
    ----------
    name : str
        AI2-THOR's name, such as "GarbageCan".
    words : (str, str)
        Singular and plural, such as ("garbage can", "garbage cans").
    synonyms : tuple of str
        Other words that people use, in the singular, the most usual first.
    can : frozenset of str
        What can be done with it; also as properties, such as `openable`.
    manipulation : {"Open", "Move", "Pickup"} or None
        What a question about this type asks the agent to do; None for what is fixed and does not open.
    mass_kg : float or None
        Of what can be picked up or moved.
    materials : tuple of str
        AI2-THOR's salient materials, such as "Metal", the most usual first.
    rooms : tuple of str
        Kinds of room in which the type occurs.
    question_type : bool
        Whether it is one of the 60 types that questions use.
    traits : frozenset of str
        What else the code needs to know of it, such as "on_wall"; `templates/traits.yaml` says what each means.
    size_m : (float, float, float) or None
        Typical width, depth and height of a closed one, of a type that no iTHOR floor plan has; of the others they are
        measured (`templates/sizes.yaml`).
    hollow_m : float or None
        How deep the hollow is below one: what lies in it is covered.
    slices : Slices or None
        What becomes of one that is sliced.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    words: tuple[Word, Word]
    synonyms: tuple[str, ...] = ()
    can: frozenset[Flag]
    manipulation: Manipulation | None
    mass_kg: float | None = Field(default=None, gt=0, strict=True)
    materials: tuple[str, ...] = ()
    rooms: tuple[Room, ...] = Field(min_length=1)
    question_type: bool = Field(default=False, strict=True)
    traits: frozenset[str] = frozenset()
    size_m: tuple[PositiveFloat, PositiveFloat, PositiveFloat] | None = None
    hollow_m: PositiveFloat | None = None
    slices: Slices | None = None

    @field_validator("traits")
    @classmethod
    def _traits_are_documented(cls, names: frozenset[str]) -> frozenset[str]:
        if unknown := names - traits().keys():
            raise ValueError(f"{min(unknown)!r} is not among the traits of {TRAITS_SOURCE}")
        return names

    @model_validator(mode="after")
    def _manipulation_is_possible(self) -> ObjectType:
        needed = {"Open": self.openable, "Move": self.moveable, "Pickup": self.pickupable, None: True}
        if not needed[self.manipulation]:
            msg = f"manipulation {self.manipulation} is not among what can be done with it: {sorted(self.can)}"
            raise ValueError(msg)
        if self.question_type and self.manipulation is None:
            msg = "a question type needs a manipulation"
            raise ValueError(msg)
        return self

    @property
    def singular(self) -> str:
        """The word for one, such as "garbage can"."""
        return self.words[0]

    @property
    def plural(self) -> str:
        """The word for several, such as "garbage cans"."""
        return self.words[1]

    @property
    def openable(self) -> bool:
        """It opens and closes."""
        return "openable" in self.can

    @property
    def pickupable(self) -> bool:
        """A hand can pick it up."""
        return "pickupable" in self.can

    @property
    def moveable(self) -> bool:
        """It is too big to pick up, but not fixed: it can be pushed aside."""
        return "moveable" in self.can

    @property
    def is_loose(self) -> bool:
        """It can be picked up or pushed aside."""
        return self.pickupable or self.moveable

    @property
    def receptacle(self) -> bool:
        """Things can be on it or in it."""
        return "receptacle" in self.can

    @property
    def is_container(self) -> bool:
        """It opens, and things can be in it: what one has to open to look inside."""
        return self.openable and self.receptacle

    @property
    def has_front(self) -> bool:
        """One side is its front: not of what is round, nor of what lies about and holds nothing."""
        return "round_outline" not in self.traits and (self.receptacle or not self.pickupable)

    @property
    def toggleable(self) -> bool:
        """It can be switched on and off."""
        return "toggleable" in self.can

    @property
    def breakable(self) -> bool:
        """It can break."""
        return "breakable" in self.can

    @property
    def sliceable(self) -> bool:
        """It can be sliced."""
        return "sliceable" in self.can

    @property
    def cookable(self) -> bool:
        """It can be cooked."""
        return "cookable" in self.can

    @property
    def dirtyable(self) -> bool:
        """It can be dirty or clean."""
        return "dirtyable" in self.can

    @property
    def fillable(self) -> bool:
        """It can be filled with a liquid."""
        return "fillable" in self.can

    @property
    def used_up(self) -> bool:
        """It can be used up."""
        return "used_up" in self.can


def catalog() -> Mapping[str, ObjectType]:
    """All object types by name, sorted; read once, when first asked for.

    Raises
    ------
    CatalogError
        If the file is damaged: names the type and the field.
    """
    return _catalog()


def object_type(name: str) -> ObjectType:
    """The object type of a name; also of slices.

    Raises
    ------
    UnknownNameError
        If there is none; the error gives the nearest names.

    >>> object_type("BreadSliced").cookable, "BreadSliced" in catalog()
    (True, False)
    """
    types = catalog()
    if name not in types and name not in _slice_types():
        raise UnknownNameError("object type", name, types)
    return types[name] if name in types else _slice_types()[name]


def question_types() -> tuple[str, ...]:
    """The names of the 60 types that questions use, sorted.

    >>> len(question_types())
    60
    """
    return tuple(name for name, kind in catalog().items() if kind.question_type)


@lru_cache(maxsize=1)
def traits() -> Mapping[str, str]:
    """What each trait means, by name."""
    return MappingProxyType({str(name): str(meaning) for name, meaning in template_values(TRAITS_SOURCE).items()})


@cache
def types_with(trait: str) -> frozenset[str]:
    """The names of the types that have a trait.

    Raises
    ------
    UnknownNameError
        If there is no such trait.

    >>> sorted(types_with("in_wall"))
    ['Blinds', 'Curtains', 'Window']
    """
    if trait not in traits():
        raise UnknownNameError("trait", trait, traits())
    return frozenset(name for name, kind in catalog().items() if trait in kind.traits)


def plural(name: str) -> str:
    """The words for several objects of a type.

    >>> plural("Bread")
    'loaves of bread'
    """
    return object_type(name).plural


def with_article(name: str) -> str:
    """The words for some object of a type, with "a" or "an".

    >>> with_article("ArmChair"), with_article("CD")
    ('an armchair', 'a CD')
    """
    word = object_type(name).singular
    article = "an" if word[0] in "aeiou" else "a"  # no type's word breaks the rule, as "hour" would
    return f"{article} {word}"


@lru_cache(maxsize=1)
def _slice_types() -> Mapping[str, ObjectType]:
    """The types of what things are sliced into, each as light as its share of the whole."""
    pairs = [(kind, kind.slices) for kind in catalog().values()]
    return MappingProxyType({slices.type: _slice_type(kind, slices) for kind, slices in pairs if slices is not None})


def _slice_type(whole: ObjectType, slices: Slices) -> ObjectType:
    return ObjectType(
        name=slices.type,
        words=slices.words,
        can=slices.can | {"pickupable"},
        manipulation="Pickup",
        mass_kg=None if whole.mass_kg is None else whole.mass_kg / slices.count,
        materials=whole.materials,
        rooms=whole.rooms,
    )


def read_catalog(text: str) -> Mapping[str, ObjectType]:
    """Object types from the text of a YAML file like `templates/objects.yaml`.

    Raises
    ------
    CatalogError
        If the text is not YAML, a type or a field is there twice, a type lacks a field, has an unknown one, or one of the
        wrong type, or two types share the word for one.
    """
    try:
        rows = read_keys(text, SOURCE)
    except ConfigError as error:
        raise CatalogError(str(error)) from None
    types = {name: _read_type(name, rows[name]) for name in sorted(rows, key=str)}
    called: dict[str, str] = {}
    for name, kind in types.items():
        if (other := called.setdefault(kind.singular, name)) != name:
            raise CatalogError(
                f"{SOURCE}: {name}.words: {other} is called {kind.singular!r}, too; phrases tell by the word"
            )
    return MappingProxyType(types)


def _read_type(name: object, row: object) -> ObjectType:
    if not isinstance(row, dict):
        raise CatalogError(f"{SOURCE}: {name}: expected fields, found {row!r}")
    fields: dict[str, Any] = {str(key): value for key, value in row.items()}
    if "name" in fields:
        raise CatalogError(f"{SOURCE}: {name}.name: the name is the key, leave this field out")
    try:
        return ObjectType(name=name, **fields)  # type: ignore[arg-type]
    except ValidationError as error:
        problems = "; ".join(
            f"{'.'.join([str(name), *map(str, problem['loc'])])}: {problem['msg']}" for problem in error.errors()
        )
        raise CatalogError(f"{SOURCE}: {problems}") from error


def _known_type(name: str) -> str:
    if name not in catalog():
        raise ValueError(str(UnknownNameError("object type", name, catalog())))
    return name


TypeName = Annotated[str, AfterValidator(_known_type)]
"""The name of a type of the catalog, in a file of rules."""


@lru_cache(maxsize=1)
def _catalog() -> Mapping[str, ObjectType]:
    return read_catalog(template_text(SOURCE))
