"""Art prints: eight pictures for the frames on the walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.assets.looks.canvas import (
    CANVAS_PX,
    CREAM,
    INK,
    Color,
    Rng,
    blend,
    fill_below,
    framed,
    gradient,
    painted,
    plain,
    polygon,
    ridge,
)
from remqa_data.geometry.types import U8
from remqa_data.opencv import cv2


def landscape(rng: Rng) -> U8:
    """Green hills under a warm evening sky, a path and a few trees."""
    image = gradient((246, 206, 150), (250, 236, 206), 0.55)
    cv2.circle(image, (370, 170), 44, (255, 246, 214), -1, cv2.LINE_AA)
    for level, color in enumerate(((150, 172, 176), (122, 158, 130), (98, 140, 92), (76, 118, 66))):
        fill_below(image, ridge(rng, 215 + 62 * level, 26 - 3 * level, 2.2), color)
    polygon(image, [(236, 512), (330, 512), (282, 420), (300, 368), (288, 366), (262, 420)], (214, 190, 140))
    for x, y, r in ((96, 372, 34), (140, 388, 26), (420, 404, 40), (470, 388, 24)):
        cv2.line(image, (x, y), (x, y + r + 14), (88, 64, 44), 7, cv2.LINE_AA)
        cv2.circle(image, (x, y), r, (52, 92, 54), -1, cv2.LINE_AA)
        cv2.circle(image, (x - r // 4, y - r // 4), r * 2 // 3, (74, 118, 66), -1, cv2.LINE_AA)
    return framed(painted(image, rng))


def abstract(rng: Rng) -> U8:
    """Overlapping discs and bars in a few colours."""
    image = plain((240, 232, 216))
    cv2.circle(image, (196, 208), 128, (214, 92, 62), -1, cv2.LINE_AA)
    blend(image, lambda layer: cv2.circle(layer, (318, 300), 116, (40, 92, 130), -1, cv2.LINE_AA), 0.88)
    blend(image, lambda layer: cv2.rectangle(layer, (84, 300), (300, 352), (236, 178, 66), -1), 0.95)
    blend(image, lambda layer: cv2.ellipse(layer, (360, 150), (66, 66), 0, 180, 360, INK, -1, cv2.LINE_AA), 0.95)
    for x in range(350, 452, 17):
        cv2.line(image, (x, 392), (x, 462), INK, 6, cv2.LINE_AA)
    cv2.line(image, (60, 452), (292, 404), INK, 5, cv2.LINE_AA)
    return framed(painted(image, rng))


def seascape(rng: Rng) -> U8:
    """A sailing boat on a blue sea."""
    image = gradient((120, 176, 214), (226, 236, 236), 0.5)
    water = gradient((44, 112, 150), (20, 70, 108), 1.0)
    image[256:] = water[:256]
    for _ in range(150):
        y = int(rng.integers(262, 505))
        x, half = int(rng.integers(0, 512)), int((y - 240) * rng.uniform(0.05, 0.18))
        cv2.line(image, (x - half, y), (x + half, y), (120, 176, 196), 2, cv2.LINE_AA)
    polygon(image, [(176, 318), (348, 318), (318, 352), (202, 352)], (142, 72, 50))
    cv2.line(image, (262, 128), (262, 318), (92, 66, 48), 6, cv2.LINE_AA)
    polygon(image, [(270, 134), (270, 304), (362, 300)], (250, 246, 236))
    polygon(image, [(254, 154), (254, 304), (182, 300)], (232, 222, 204))
    for x, y in ((96, 92), (132, 74), (420, 110)):
        cv2.ellipse(image, (x - 12, y), (13, 8), 0, 200, 350, (70, 80, 92), 3, cv2.LINE_AA)
        cv2.ellipse(image, (x + 12, y), (13, 8), 0, 190, 340, (70, 80, 92), 3, cv2.LINE_AA)
    return framed(painted(image, rng))


def flowers(rng: Rng) -> U8:
    """A bunch of flowers in a blue vase."""
    image = gradient((226, 214, 196), (206, 188, 166), 1.0)
    cv2.rectangle(image, (0, 404), (512, 512), (166, 126, 92), -1)
    heads = ((170, 152), (256, 96), (340, 150), (212, 214), (304, 222), (134, 232), (384, 236))
    for x, y in heads:
        cv2.line(image, (x, y), (256, 344), (78, 116, 66), 6, cv2.LINE_AA)
    for x, y in ((196, 276), (318, 282), (150, 298), (364, 304)):
        cv2.ellipse(image, (x, y), (40, 14), 40 if x < 256 else -40, 0, 360, (92, 134, 76), -1, cv2.LINE_AA)
    colors = (
        (206, 70, 66),
        (236, 168, 70),
        (222, 122, 146),
        (246, 236, 222),
        (186, 86, 130),
        (240, 196, 92),
        (214, 96, 74),
    )
    for (x, y), color in zip(heads, colors, strict=True):
        for angle in range(0, 360, 45):
            dx, dy = 27 * np.cos(np.radians(angle)), 27 * np.sin(np.radians(angle))
            shade = tuple(int(c * (0.86 if angle % 90 else 1.0)) for c in color)
            cv2.ellipse(image, (int(x + dx), int(y + dy)), (24, 14), angle, 0, 360, shade, -1, cv2.LINE_AA)
        cv2.circle(image, (x, y), 14, (122, 82, 46), -1, cv2.LINE_AA)
    polygon(image, [(200, 330), (312, 330), (332, 420), (300, 458), (212, 458), (180, 420)], (58, 96, 146))
    polygon(image, [(212, 336), (232, 336), (216, 440), (200, 416)], (96, 136, 182))
    return framed(painted(image, rng))


def portrait(rng: Rng) -> U8:
    """A woman with dark hair before a teal ground, in flat shapes."""
    image = gradient((62, 116, 118), (34, 78, 84), 1.0)
    cv2.ellipse(image, (256, 232), (116, 148), 0, 0, 360, (48, 34, 32), -1, cv2.LINE_AA)
    cv2.rectangle(image, (142, 232), (370, 384), (48, 34, 32), -1)
    polygon(image, [(96, 512), (128, 420), (218, 376), (294, 376), (384, 420), (416, 512)], (190, 74, 60))
    polygon(image, [(222, 318), (290, 318), (304, 392), (256, 424), (208, 392)], (212, 160, 126))
    cv2.ellipse(image, (256, 236), (76, 104), 0, 0, 360, (232, 184, 148), -1, cv2.LINE_AA)
    cv2.ellipse(image, (238, 152), (96, 58), -16, 150, 360, (48, 34, 32), -1, cv2.LINE_AA)
    for x in (226, 286):
        cv2.ellipse(image, (x, 228), (15, 7), 0, 0, 360, (250, 244, 236), -1, cv2.LINE_AA)
        cv2.circle(image, (x, 228), 6, (44, 40, 46), -1, cv2.LINE_AA)
        cv2.ellipse(image, (x, 214), (22, 9), 0, 200, 340, (48, 34, 32), 4, cv2.LINE_AA)
    cv2.polylines(image, [np.array([(256, 228), (248, 268), (262, 272)])], False, (188, 134, 104), 4, cv2.LINE_AA)
    cv2.ellipse(image, (256, 298), (24, 8), 0, 0, 360, (186, 66, 66), -1, cv2.LINE_AA)
    cv2.circle(image, (178, 286), 9, (238, 200, 96), -1, cv2.LINE_AA)
    cv2.circle(image, (334, 286), 9, (238, 200, 96), -1, cv2.LINE_AA)
    return framed(painted(image, rng))


def skyline(rng: Rng) -> U8:
    """A city at dusk with lit windows, mirrored in a river."""
    image = gradient((52, 44, 92), (246, 158, 106), 0.78)
    cv2.circle(image, (142, 118), 30, (250, 240, 214), -1, cv2.LINE_AA)
    for depth, color in ((0, (112, 84, 118)), (1, (44, 40, 70))):
        x = -10
        while x < 512:
            width, height = int(rng.integers(34, 66)), int(rng.integers(90, 210) + 60 * (1 - depth))
            top = 400 - height
            cv2.rectangle(image, (x, top), (x + width, 400), color, -1)
            if depth and rng.random() < 0.4:
                cv2.line(image, (x + width // 2, top - 34), (x + width // 2, top), color, 4, cv2.LINE_AA)
            for wy in range(top + 10, 392, 16) if depth else ():
                for wx in range(x + 7, x + width - 8, 13):
                    if rng.random() < 0.45:
                        cv2.rectangle(image, (wx, wy), (wx + 5, wy + 7), (250, 212, 126), -1)
            x += width + (2 if depth else -8)
    mirrored = image[400 - 112 : 400][::-1].astype(np.float64)
    image[400:512] = np.clip(mirrored * 0.6 + np.array([16, 18, 38]), 0, 255).astype(np.uint8)
    return framed(painted(image, rng, 0.4))


def geometric(rng: Rng) -> U8:
    """Quarter circles in a grid of four by four."""
    palette: Sequence[Color] = (
        (222, 96, 70),
        (242, 188, 82),
        (48, 104, 122),
        (238, 228, 206),
        (36, 52, 74),
        (142, 178, 166),
    )
    image = plain(CREAM)
    cell = CANVAS_PX // 4
    for row in range(4):
        for column in range(4):
            ground, figure = rng.permutation(len(palette))[:2]
            x, y = column * cell, row * cell
            part = np.full((cell, cell, 3), palette[ground], dtype=np.uint8)
            kind = int(rng.integers(4))
            corner = ((0, 0), (cell, 0), (0, cell), (cell, cell))[int(rng.integers(4))]
            if kind < 2:
                cv2.circle(part, corner, cell, palette[figure], -1, cv2.LINE_AA)
                cv2.circle(part, corner, cell // 2, palette[ground], -1, cv2.LINE_AA)
            elif kind == 2:
                cv2.circle(part, (cell // 2, cell // 2), cell * 2 // 5, palette[figure], -1, cv2.LINE_AA)
            else:
                polygon(part, [(0, 0), (cell, 0), (0, cell)], palette[figure])
            image[y : y + cell, x : x + cell] = part
    return framed(painted(image, rng, 0.4))


def mountains(rng: Rng) -> U8:
    """Layered blue mountains with snow and a lake."""
    image = gradient((150, 184, 216), (248, 230, 214), 0.6)
    peaks = [(-20, 330), (70, 200), (120, 250), (230, 96), (330, 230), (390, 168), (540, 340)]
    polygon(image, [*peaks, (540, 420), (-20, 420)], (92, 112, 146))
    polygon(image, [(230, 96), (266, 144), (246, 150), (232, 176), (214, 150), (196, 160), (188, 155)], (250, 250, 252))
    polygon(image, [(390, 168), (424, 206), (404, 204), (390, 222), (374, 204), (356, 204)], (240, 244, 250))
    polygon(image, [(230, 96), (330, 230), (360, 200), (400, 420), (230, 420), (262, 250)], (74, 94, 130))
    fill_below(image, ridge(rng, 330, 22, 1.6), (62, 92, 98))
    fill_below(image, ridge(rng, 372, 12, 1.4), (42, 72, 66))
    image[400:] = gradient((120, 158, 190), (70, 108, 142), 1.0)[:112]
    for x in range(10, 512, 26):
        h = int(rng.integers(28, 70))
        polygon(image, [(x - h // 4, 404), (x + h // 4, 404), (x, 404 - h)], (28, 54, 50))
    return framed(painted(image, rng))
