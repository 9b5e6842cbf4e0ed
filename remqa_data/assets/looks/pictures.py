"""Pictures in full colour by name. Used with a white material, stretched once over a surface."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from remqa_data.assets.looks import paintings, panels, printed
from remqa_data.assets.looks.canvas import Rng
from remqa_data.geometry.types import U8

_PAINTINGS = (
    paintings.landscape,
    paintings.abstract,
    paintings.seascape,
    paintings.flowers,
    paintings.portrait,
    paintings.skyline,
    paintings.geometric,
    paintings.mountains,
)

PICTURES: dict[str, Callable[[Rng], U8]] = {
    **{f"picture_{index}": function for index, function in enumerate(_PAINTINGS)},
    **{f"poster_{index}": partial(printed.poster, index) for index in range(4)},
    **{f"book_cover_{index}": partial(printed.book_cover, index) for index in range(4)},
    **{f"label_{index}": partial(printed.label, index) for index in range(4)},
    "newsprint": printed.newsprint,
    "cereal": printed.cereal,
    "card": printed.card,
    "sky": panels.sky,
    "screen_0": panels.desktop,
    "screen_1": panels.television,
    "mirror": panels.mirror,
    "clock_face": panels.clock_face,
    "cd": panels.disc,
    "keyboard": panels.keyboard,
    "remote_buttons": panels.remote_buttons,
}
