"""What AI2-THOR's Initialize sets."""

from __future__ import annotations

from dataclasses import dataclass, field

from remqa_data.errors import ActionError

MOST_PIXELS = 4096


@dataclass(frozen=True)
class Quality:
    """What a picture is drawn with; depth and masks are the same either way."""

    shadows: bool = True
    smooth_edges: bool = True


QUALITIES = {
    "Very Low": Quality(shadows=False, smooth_edges=False),
    "Low": Quality(shadows=False, smooth_edges=False),
    "Medium": Quality(smooth_edges=False),
    "MediumCloseFitShadows": Quality(smooth_edges=False),
    "High": Quality(smooth_edges=False),
    "Very High": Quality(),
    "Ultra": Quality(),
    "High WebGL": Quality(),
}
"""AI2-THOR's, with what its Unity project says of shadows and antialiasing (unity/ProjectSettings/QualitySettings.asset)."""


@dataclass(frozen=True)
class Images:
    """Which pictures come with an event."""

    color: bool = True
    depth: bool = False
    instances: bool = False
    types: bool = False

    @property
    def none(self) -> bool:
        """Whether nothing needs drawing."""
        return not (self.color or self.depth or self.colors)

    @property
    def colors(self) -> bool:
        """Whether a picture shows objects or types as colours."""
        return self.instances or self.types


@dataclass(frozen=True)
class FrameSize:
    """Pixels of every picture.

    Raises
    ------
    ActionError
        If there are none, or too many.
    """

    width: int
    height: int

    def __post_init__(self) -> None:
        if not (0 < self.width <= MOST_PIXELS and 0 < self.height <= MOST_PIXELS):
            raise ActionError(f"a resolution of {self.width} x {self.height} is not between 1 and {MOST_PIXELS} pixels")


@dataclass(frozen=True)
class Settings:
    """AI2-THOR's initialization parameters that mean something here, with its defaults; metres and degrees."""

    grid_size: float = 0.25
    visibility_distance: float = 1.5
    rotate_step_degrees: float = 90.0
    field_of_view: float = 90.0
    far_plane: float = 20.0
    agent_mode: str = "default"
    agent_count: int = 1
    shows_agents: bool = True
    look_up_deg: float = 30.0
    look_down_deg: float = 60.0
    images: Images = field(default_factory=Images)

    @property
    def has_arm(self) -> bool:
        """Whether the agent manipulates with its arm, as in ManipulaTHOR, instead of from where it sees."""
        return self.agent_mode == "arm"
