"""How a room looks: what is painted otherwise than it was built, what is marked, what alone is shown, how it is lit.

Nothing here is known to the world: physics, metadata, depth and masks are the same whatever things look like, but for what
is hidden, and where something is emphasised, as all else is out of the pictures then.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from remqa_data.assets.core.model import Material
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import Flags, Vec3
from remqa_data.sim.render.view import Body, Shapes, WorldView

MARK = Material("plastic", "pink", (1.0, 0.0, 1.0), glow=1.0)
"""What is masked or emphasised: every pixel of it is (255, 0, 255), whatever the light."""
TINT = 0.5
"""Share of the light in a room that takes on the colour of its lamps; the rest comes from elsewhere."""


@dataclass(frozen=True)
class Lighting:
    """How much brighter each lamp is than it was built, and which colour it has, 0 to 1 for red, green and blue."""

    brightness: tuple[float, ...]
    colors: tuple[Vec3, ...]


@dataclass(frozen=True)
class Look:
    """What was changed of a room's look.

    Attributes
    ----------
    materials : mapping of Material to Material
        What surfaces are made of instead of what they were built of.
    colors : mapping of Material to tuple of float
        Which colour, sRGB in 0..1, surfaces have that were built of a material.
    masked : frozenset of str
        Objects that are marked.
    hidden : frozenset of str
        Objects that are not drawn.
    emphasized : str or None
        The object that is marked and alone shown.
    lighting : Lighting or None
        None for the lamps as they were built.
    """

    materials: Mapping[Material, Material] = field(default_factory=dict)
    colors: Mapping[Material, Vec3] = field(default_factory=dict)
    masked: frozenset[str] = frozenset()
    hidden: frozenset[str] = frozenset()
    emphasized: str | None = None
    lighting: Lighting | None = None


class Looks:
    """The look of a room, and who makes its renderer show it.

    Parameters
    ----------
    view : WorldView
        Draws the room.

    Attributes
    ----------
    look : Look
        What was changed; set it with `change`.
    built_of : tuple of Material
        What there is in the room, in the order of its surfaces, each once.
    only : (parts,) array of bool, or None
        What alone is shown; None for everything.
    """

    def __init__(self, view: WorldView) -> None:
        self._view = view
        self._read_parts()
        self.built_of = tuple(dict.fromkeys(self._own))
        self.lamps = len(view.renderer.lights.positions)
        self.look = Look()
        self.only: Flags | None = None

    def change(self, look: Look) -> None:
        """Show the room so from now on."""
        before, self.look = self.look, look
        if look.lighting != before.lighting:
            self._view.set_brightness([1.0] * self.lamps if look.lighting is None else look.lighting.brightness)
        if look != before:
            self._view.set_materials(self._materials())
        self._choose_parts()

    def reshape(self, shapes: Shapes | None = None, bodies: Sequence[Body] | None = None) -> None:
        """Draw some objects in other shapes, or agents, too, and all else as it looks; see `WorldView.rebuild`."""
        self._view.rebuild(shapes, bodies)
        self._read_parts()
        self._view.set_materials(self._materials())
        self._choose_parts()

    def _choose_parts(self) -> None:
        """Note which of the renderer's parts are shown alone: of what is emphasised, or of all, what is not hidden."""
        look = self.look
        self.only = None if look.emphasized is None else self._view.parts_of([look.emphasized])
        if look.hidden:
            shown = ~self._view.parts_of(look.hidden)
            self.only = shown if self.only is None else shown & self.only

    def _read_parts(self) -> None:
        """Note what the renderer's surfaces are made of."""
        self._own = [surface.material for part in self._view.renderer.parts for surface in part.surfaces]
        self._surfaces = [len(part.surfaces) for part in self._view.renderer.parts]

    def _materials(self) -> Sequence[Material]:
        """What each surface is shown as."""
        look, tint = self.look, self._tint()
        shown = {}
        for own in dict.fromkeys(self._own):
            material = look.materials.get(own, own)
            rgb = look.colors.get(own, material.rgb)
            r, g, b = (value * share for value, share in zip(rgb, tint, strict=True))
            shown[own] = replace(material, rgb=rgb if own.glow else (r, g, b))
        names = look.masked if look.emphasized is None else {*look.masked, look.emphasized}
        is_marked = np.repeat(self._view.parts_of(names), self._surfaces).tolist()
        return [MARK if marked else shown[own] for own, marked in zip(self._own, is_marked, strict=True)]

    def _tint(self) -> list[float]:
        """What sRGB colours are multiplied by so that they look as in coloured light."""
        if self.look.lighting is None:
            return [1.0] * 3
        shares = self._view.lamp_shares * np.array(self.look.lighting.brightness)
        mean = (shares[:, None] * np.array(self.look.lighting.colors)).sum(axis=0) / max(float(shares.sum()), 1e-9)
        return [math.sqrt(value) for value in arithmetic.snapped(1.0 - TINT + TINT * mean).tolist()]
