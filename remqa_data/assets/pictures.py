"""Pictures in full colour: art prints, posters, book covers, screens, labels. Used with a white material, drawn once.

They are drawn twice as large as needed and halved, which smooths their edges.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import cv2
import numpy as np

from remqa_data.assets.noise import F64, SIZE_PX, U8, X, Y, fractal, grey, smoothstep

Rng = np.random.Generator
Color = tuple[int, int, int]

_BIG = 2 * SIZE_PX
_FONT = cv2.FONT_HERSHEY_DUPLEX
_INK: Color = (36, 36, 42)
_CREAM: Color = (244, 238, 224)


def landscape(rng: Rng) -> U8:
    """Green hills under a warm evening sky, a path and a few trees."""
    image = _gradient((246, 206, 150), (250, 236, 206), 0.55)
    cv2.circle(image, (370, 170), 44, (255, 246, 214), -1, cv2.LINE_AA)
    for level, color in enumerate(((150, 172, 176), (122, 158, 130), (98, 140, 92), (76, 118, 66))):
        _fill(image, _ridge(rng, 215 + 62 * level, 26 - 3 * level, 2.2), color)
    _polygon(image, [(236, 512), (330, 512), (282, 420), (300, 368), (288, 366), (262, 420)], (214, 190, 140))
    for x, y, r in ((96, 372, 34), (140, 388, 26), (420, 404, 40), (470, 388, 24)):
        cv2.line(image, (x, y), (x, y + r + 14), (88, 64, 44), 7, cv2.LINE_AA)
        cv2.circle(image, (x, y), r, (52, 92, 54), -1, cv2.LINE_AA)
        cv2.circle(image, (x - r // 4, y - r // 4), r * 2 // 3, (74, 118, 66), -1, cv2.LINE_AA)
    return _framed(_painted(image, rng))


def abstract(rng: Rng) -> U8:
    """Overlapping discs and bars in a few colours."""
    image = _plain((240, 232, 216))
    cv2.circle(image, (196, 208), 128, (214, 92, 62), -1, cv2.LINE_AA)
    _blend(image, lambda layer: cv2.circle(layer, (318, 300), 116, (40, 92, 130), -1, cv2.LINE_AA), 0.88)
    _blend(image, lambda layer: cv2.rectangle(layer, (84, 300), (300, 352), (236, 178, 66), -1), 0.95)
    _blend(image, lambda layer: cv2.ellipse(layer, (360, 150), (66, 66), 0, 180, 360, _INK, -1, cv2.LINE_AA), 0.95)
    for x in range(350, 452, 17):
        cv2.line(image, (x, 392), (x, 462), _INK, 6, cv2.LINE_AA)
    cv2.line(image, (60, 452), (292, 404), _INK, 5, cv2.LINE_AA)
    return _framed(_painted(image, rng))


def seascape(rng: Rng) -> U8:
    """A sailing boat on a blue sea."""
    image = _gradient((120, 176, 214), (226, 236, 236), 0.5)
    water = _gradient((44, 112, 150), (20, 70, 108), 1.0)
    image[256:] = water[:256]
    for _ in range(150):
        y = int(rng.integers(262, 505))
        x, half = int(rng.integers(0, 512)), int((y - 240) * rng.uniform(0.05, 0.18))
        cv2.line(image, (x - half, y), (x + half, y), (120, 176, 196), 2, cv2.LINE_AA)
    _polygon(image, [(176, 318), (348, 318), (318, 352), (202, 352)], (142, 72, 50))
    cv2.line(image, (262, 128), (262, 318), (92, 66, 48), 6, cv2.LINE_AA)
    _polygon(image, [(270, 134), (270, 304), (362, 300)], (250, 246, 236))
    _polygon(image, [(254, 154), (254, 304), (182, 300)], (232, 222, 204))
    for x, y in ((96, 92), (132, 74), (420, 110)):
        cv2.ellipse(image, (x - 12, y), (13, 8), 0, 200, 350, (70, 80, 92), 3, cv2.LINE_AA)
        cv2.ellipse(image, (x + 12, y), (13, 8), 0, 190, 340, (70, 80, 92), 3, cv2.LINE_AA)
    return _framed(_painted(image, rng))


def flowers(rng: Rng) -> U8:
    """A bunch of flowers in a blue vase."""
    image = _gradient((226, 214, 196), (206, 188, 166), 1.0)
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
    _polygon(image, [(200, 330), (312, 330), (332, 420), (300, 458), (212, 458), (180, 420)], (58, 96, 146))
    _polygon(image, [(212, 336), (232, 336), (216, 440), (200, 416)], (96, 136, 182))
    return _framed(_painted(image, rng))


def portrait(rng: Rng) -> U8:
    """A woman with dark hair before a teal ground, in flat shapes."""
    image = _gradient((62, 116, 118), (34, 78, 84), 1.0)
    cv2.ellipse(image, (256, 232), (116, 148), 0, 0, 360, (48, 34, 32), -1, cv2.LINE_AA)
    cv2.rectangle(image, (142, 232), (370, 384), (48, 34, 32), -1)
    _polygon(image, [(96, 512), (128, 420), (218, 376), (294, 376), (384, 420), (416, 512)], (190, 74, 60))
    _polygon(image, [(222, 318), (290, 318), (304, 392), (256, 424), (208, 392)], (212, 160, 126))
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
    return _framed(_painted(image, rng))


def skyline(rng: Rng) -> U8:
    """A city at dusk with lit windows, mirrored in a river."""
    image = _gradient((52, 44, 92), (246, 158, 106), 0.78)
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
    return _framed(_painted(image, rng, 0.4))


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
    image = _plain(_CREAM)
    cell = _BIG // 4
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
                _polygon(part, [(0, 0), (cell, 0), (0, cell)], palette[figure])
            image[y : y + cell, x : x + cell] = part
    return _framed(_painted(image, rng, 0.4))


def mountains(rng: Rng) -> U8:
    """Layered blue mountains with snow and a lake."""
    image = _gradient((150, 184, 216), (248, 230, 214), 0.6)
    peaks = [(-20, 330), (70, 200), (120, 250), (230, 96), (330, 230), (390, 168), (540, 340)]
    _polygon(image, [*peaks, (540, 420), (-20, 420)], (92, 112, 146))
    _polygon(
        image, [(230, 96), (266, 144), (246, 150), (232, 176), (214, 150), (196, 160), (188, 155)], (250, 250, 252)
    )
    _polygon(image, [(390, 168), (424, 206), (404, 204), (390, 222), (374, 204), (356, 204)], (240, 244, 250))
    _polygon(image, [(230, 96), (330, 230), (360, 200), (400, 420), (230, 420), (262, 250)], (74, 94, 130))
    _fill(image, _ridge(rng, 330, 22, 1.6), (62, 92, 98))
    _fill(image, _ridge(rng, 372, 12, 1.4), (42, 72, 66))
    image[400:] = _gradient((120, 158, 190), (70, 108, 142), 1.0)[:112]
    for x in range(10, 512, 26):
        h = int(rng.integers(28, 70))
        _polygon(image, [(x - h // 4, 404), (x + h // 4, 404), (x, 404 - h)], (28, 54, 50))
    return _framed(_painted(image, rng))


def poster(index: int, rng: Rng) -> U8:
    """Large type over simple shapes."""
    if index == 0:
        image = _plain((232, 72, 54))
        cv2.circle(image, (256, 308), 132, (250, 206, 80), -1, cv2.LINE_AA)
        _words(image, "JAZZ", (256, 92), 390, _CREAM, 14)
        _words(image, "NIGHT", (256, 308), 220, (232, 72, 54), 12)
        _words(image, "BLUE HALL  8 PM", (256, 482), 300, _CREAM, 4)
    elif index == 1:
        image = _gradient((24, 40, 88), (70, 40, 110), 1.0)
        for _ in range(140):
            x, y = rng.integers(0, 512, 2)
            cv2.circle(image, (int(x), int(y)), int(rng.integers(1, 4)), (230, 230, 250), -1, cv2.LINE_AA)
        cv2.circle(image, (256, 232), 96, (226, 146, 92), -1, cv2.LINE_AA)
        cv2.ellipse(image, (256, 232), (168, 40), -18, 0, 360, (240, 214, 170), 9, cv2.LINE_AA)
        cv2.ellipse(image, (256, 232), (96, 96), -18, 180, 360, (226, 146, 92), -1, cv2.LINE_AA)
        _words(image, "SPACE", (256, 400), 340, (250, 246, 236), 12)
        _words(image, "THE LAST ORBIT", (256, 474), 280, (226, 196, 160), 4)
    elif index == 2:
        image = _plain((40, 122, 98))
        _polygon(image, [(0, 512), (0, 250), (130, 130), (256, 330), (350, 210), (512, 420), (512, 512)], (24, 84, 72))
        cv2.circle(image, (392, 116), 54, (250, 226, 130), -1, cv2.LINE_AA)
        _words(image, "HIKE", (256, 388), 350, _CREAM, 16)
        _words(image, "MORE OFTEN", (256, 470), 300, (250, 226, 130), 5)
    else:
        image = _plain(_CREAM)
        for i, color in enumerate(((236, 178, 66), (222, 96, 70), (48, 104, 122), (36, 52, 74))):
            cv2.ellipse(image, (256, 330), (220 - 48 * i, 220 - 48 * i), 0, 180, 360, color, -1, cv2.LINE_AA)
        _words(image, "GOOD", (256, 388), 210, _INK, 9)
        _words(image, "MORNING", (256, 464), 340, _INK, 9)
    return _small(image)


def sky(rng: Rng) -> U8:
    """The view from a window: soft clouds over a green horizon."""
    y = Y[..., None]
    blue = np.array([112, 168, 224]) * (1 - y * 1.25) + np.array([226, 238, 246]) * y * 1.25
    cloud = smoothstep(0.25, 1.7, fractal(rng, 1.75, (0.8, 1.7)))[..., None] * smoothstep(0.02, 0.3, Y)[..., None]
    image = blue * (1 - 0.85 * cloud) + np.array([252, 252, 252]) * 0.85 * cloud
    for level, color in ((0.74, (148, 178, 166)), (0.8, (116, 156, 106)), (0.88, (92, 138, 78))):
        line = (
            level
            + 0.025 * np.cumsum(rng.standard_normal(SIZE_PX)) / np.sqrt(SIZE_PX)
            + 0.008 * np.sin(X[0] * 19 + level * 40)
        )
        ground = smoothstep(-0.004, 0.004, Y - line[None, :])[..., None]
        texture = 1 + 0.04 * fractal(rng, 0.9)[..., None]
        image = image * (1 - ground) + np.array(color) * texture * ground
    return _bytes(image)


def newsprint(rng: Rng) -> U8:
    """A headline, a photograph and three columns."""
    image = _plain((232, 228, 216))
    _words(image, "THE DAILY NEWS", (256, 44), 450, _INK, 6)
    cv2.line(image, (24, 78), (488, 78), _INK, 3)
    _words(image, "RAIN AT LAST", (170, 112), 290, _INK, 4)
    cv2.rectangle(image, (190, 150), (488, 300), (122, 120, 116), -1)
    _polygon(image, [(190, 300), (270, 210), (330, 262), (400, 190), (488, 300)], (66, 66, 66))
    cv2.circle(image, (440, 182), 16, (206, 204, 198), -1, cv2.LINE_AA)
    for column in range(3):
        x = 24 + 160 * column
        for y in range(152 if column == 0 else 320, 496, 11):
            end = x + 144 - (int(rng.integers(10, 90)) if rng.random() < 0.18 else int(rng.integers(0, 6)))
            cv2.line(image, (x, y), (end, y), (98, 96, 92), 4)
    return _small(image)


def book_cover(index: int, rng: Rng) -> U8:
    """Title, author and a picture."""
    title, author, ground, accent = (
        ("THE SEA", "A. MOREAU", (36, 74, 112), (238, 196, 96)),
        ("GARDENS", "L. HILL", (232, 224, 200), (92, 134, 84)),
        ("NIGHT TRAIN", "J. OKADA", (40, 36, 52), (214, 72, 66)),
        ("ATLAS", "M. BERG", (196, 96, 62), (246, 230, 200)),
    )[index]
    image = _plain(ground)
    cv2.rectangle(image, (22, 22), (490, 490), accent, 5)
    if index == 0:
        for k in range(6):
            xs = np.arange(60, 453, 4)
            ys = 300 + 26 * k + 12 * np.sin(xs / 30 + k)
            cv2.polylines(image, [np.stack([xs, ys], axis=1).astype(np.int32)], False, accent, 6, cv2.LINE_AA)
    elif index == 1:
        for angle in range(0, 360, 30):
            dx, dy = 74 * np.cos(np.radians(angle)), 74 * np.sin(np.radians(angle))
            cv2.ellipse(image, (int(256 + dx), int(320 + dy)), (56, 19), angle, 0, 360, accent, -1, cv2.LINE_AA)
        cv2.circle(image, (256, 316), 28, (214, 150, 60), -1, cv2.LINE_AA)
    elif index == 2:
        cv2.circle(image, (362, 236), 46, (240, 232, 210), -1, cv2.LINE_AA)
        _polygon(image, [(60, 430), (452, 430), (300, 290), (280, 290)], (84, 78, 98))
        for k in range(7):
            y = 300 + k * k * 3
            cv2.line(image, (290 - (y - 288), y), (290 + (y - 288), y), accent, 4, cv2.LINE_AA)
    else:
        cv2.circle(image, (256, 316), 112, accent, 6, cv2.LINE_AA)
        for half in (38, 78):
            cv2.ellipse(image, (256, 316), (half, 112), 0, 0, 360, accent, 4, cv2.LINE_AA)
            cv2.line(image, (150 + half // 3, 316 - half), (362 - half // 3, 316 - half), accent, 4, cv2.LINE_AA)
            cv2.line(image, (150 + half // 3, 316 + half), (362 - half // 3, 316 + half), accent, 4, cv2.LINE_AA)
    _words(image, title, (256, 110), 380, accent if index != 1 else _INK, 8)
    _words(image, author, (256, 456), 150, accent if index != 1 else _INK, 3)
    return _small(image)


def desktop(rng: Rng) -> U8:
    """A computer screen with two windows and a task bar."""
    image = _gradient((36, 96, 152), (104, 72, 150), 1.0)
    for y in range(36, 300, 66):
        cv2.rectangle(image, (26, y), (62, y + 36), (236, 240, 246), -1)
        cv2.line(image, (22, y + 48), (66, y + 48), (226, 230, 240), 3)
    for x0, y0, x1, y1, bar in ((110, 60, 400, 330, (70, 74, 86)), (230, 170, 486, 420, (216, 220, 226))):
        cv2.rectangle(image, (x0, y0), (x1, y1), (248, 249, 251), -1)
        cv2.rectangle(image, (x0, y0), (x1, y0 + 28), bar, -1)
        for k, color in enumerate(((232, 92, 82), (240, 190, 76), (96, 190, 98))):
            cv2.circle(image, (x0 + 18 + 22 * k, y0 + 14), 7, color, -1, cv2.LINE_AA)
        for y in range(y0 + 50, y1 - 16, 18):
            color = ((90, 96, 110), (60, 130, 180), (170, 90, 120))[int(rng.integers(3))]
            cv2.line(image, (x0 + 20, y), (x0 + 20 + int(rng.integers(60, x1 - x0 - 50)), y), color, 5)
    cv2.rectangle(image, (0, 470), (512, 512), (28, 32, 44), -1)
    for k in range(8):
        color = tuple(int(c) for c in rng.integers(110, 250, 3))
        cv2.rectangle(image, (136 + 32 * k, 480), (158 + 32 * k, 502), color, -1)
    return _small(image)


def television(rng: Rng) -> U8:
    """A football match."""
    image = _gradient((60, 66, 82), (44, 50, 66), 1.0)
    for _ in range(900):
        x, y = int(rng.integers(0, 512)), int(rng.integers(0, 150))
        cv2.circle(image, (x, y), 3, tuple(int(c) for c in rng.integers(70, 220, 3)), -1)
    for stripe in range(9):
        left, right = -240 + stripe * 112, -240 + (stripe + 1) * 112
        color = (70, 150, 66) if stripe % 2 else (84, 166, 76)
        _polygon(image, [(left, 512), (right, 512), (140 + right // 2, 150), (140 + left // 2, 150)], color)
    cv2.ellipse(image, (256, 300), (120, 50), 0, 0, 360, (236, 244, 236), 3, cv2.LINE_AA)
    cv2.line(image, (256, 150), (256, 512), (236, 244, 236), 3)
    for k in range(11):
        x, y = int(rng.integers(40, 470)), int(rng.integers(190, 450))
        size = 6 + y // 40
        color = (214, 48, 52) if k % 2 else (40, 70, 170)
        cv2.ellipse(image, (x, y + size * 3), (size * 2, size // 2), 0, 0, 360, (52, 112, 52), -1, cv2.LINE_AA)
        cv2.rectangle(image, (x - size // 2, y + size), (x + size // 2, y + size * 3), (240, 240, 240), -1)
        cv2.rectangle(image, (x - size * 3 // 4, y - size // 2), (x + size * 3 // 4, y + size * 3 // 2), color, -1)
        cv2.circle(image, (x, y - size), size * 2 // 3, (226, 178, 142), -1, cv2.LINE_AA)
    cv2.circle(image, (300, 372), 8, (252, 252, 252), -1, cv2.LINE_AA)
    cv2.rectangle(image, (24, 22), (216, 62), (20, 26, 44), -1)
    _words(image, "RED 2 - 1 BLU", (120, 42), 172, (246, 246, 246), 3)
    return _small(image)


def mirror(rng: Rng) -> U8:
    """Grey-blue with slanted bands of light."""
    slant = X + Y
    value = 0.76 + 0.09 * np.sin(slant * 2.2 + 0.4) + 0.002 * fractal(rng, 0.4)
    for centre, width, gain in ((0.62, 0.07, 0.11), (0.82, 0.025, 0.09), (1.32, 0.1, 0.07)):
        value += gain * smoothstep(width + 0.012, width, np.abs(slant - centre))
    return _bytes(255 * np.stack([value * 0.93, value * 0.99, value * 1.04], axis=2))


def clock_face(rng: Rng) -> U8:
    """Twelve hours; ten past ten."""
    del rng
    image = _plain((250, 248, 242))
    cv2.circle(image, (256, 256), 250, (52, 54, 60), 8, cv2.LINE_AA)
    for minute in range(60):
        angle = np.radians(minute * 6)
        long, thick = (34, 9) if minute % 5 == 0 else (14, 3)
        ends = [(int(256 + r * np.sin(angle)), int(256 - r * np.cos(angle))) for r in (234 - long, 234)]
        cv2.line(image, ends[0], ends[1], _INK, thick, cv2.LINE_AA)
    for hour in (12, 3, 6, 9):
        angle = np.radians(hour * 30)
        at = (int(256 + 166 * np.sin(angle)), int(256 - 166 * np.cos(angle)))
        _words(image, str(hour), at, 30 * len(str(hour)), _INK, 6)
    for degrees, length, thick in ((305, 108, 15), (60, 160, 10)):
        end = (int(256 + length * np.sin(np.radians(degrees))), int(256 - length * np.cos(np.radians(degrees))))
        cv2.line(image, (256, 256), end, _INK, thick, cv2.LINE_AA)
    cv2.line(image, (256, 286), (256, 92), (206, 58, 48), 4, cv2.LINE_AA)
    cv2.circle(image, (256, 256), 14, (206, 58, 48), -1, cv2.LINE_AA)
    return _small(image)


def label(index: int, rng: Rng) -> U8:
    """A product label."""
    del rng
    name, line, ground, band = (
        ("TOMATO", "CLASSIC SOUP", (246, 238, 222), (200, 46, 40)),
        ("OLIVA", "EXTRA VIRGIN", (236, 230, 196), (86, 112, 52)),
        ("AQUA", "FRESH SHAMPOO", (226, 242, 246), (44, 132, 176)),
        ("HONEY", "100% PURE", (250, 226, 150), (176, 106, 30)),
    )[index]
    image = _plain(ground)
    cv2.rectangle(image, (0, 60), (512, 206), band, -1)
    for y in (44, 216):
        cv2.line(image, (0, y), (512, y), band, 5)
    _words(image, name, (256, 132), 420, (252, 250, 244), 13)
    if index in (0, 3):
        cv2.circle(image, (256, 326), 66, (214, 60, 44) if index == 0 else (236, 166, 44), -1, cv2.LINE_AA)
        cv2.ellipse(image, (238, 302), (20, 12), -30, 0, 360, (250, 220, 200), -1, cv2.LINE_AA)
        _polygon(image, [(232, 262), (256, 284), (284, 258), (262, 254)], (74, 124, 58))
    else:
        for angle in range(-60, 61, 30):
            end = (int(256 + 80 * np.sin(np.radians(angle))), int(384 - 96 * np.cos(np.radians(angle))))
            cv2.ellipse(
                image, ((256 + end[0]) // 2, (384 + end[1]) // 2), (14, 46), angle, 0, 360, band, -1, cv2.LINE_AA
            )
    _words(image, line, (256, 436), 300, _INK, 5)
    for x in range(376, 480, 7):
        cv2.line(image, (x, 466), (x, 502), _INK, 2 + x % 3)
    return _small(image)


def cereal(rng: Rng) -> U8:
    """The front of a cereal box."""
    image = _gradient((250, 190, 60), (240, 130, 40), 1.0)
    for angle in range(0, 360, 24):
        a, b = np.radians(angle), np.radians(angle + 12)
        far = [(int(256 + 420 * np.cos(t)), int(290 + 420 * np.sin(t))) for t in (a, b)]
        _polygon(image, [(256, 290), *far], (252, 206, 92))
    cv2.ellipse(image, (256, 400), (168, 48), 0, 0, 360, (250, 250, 252), -1, cv2.LINE_AA)
    cv2.ellipse(image, (256, 400), (168, 110), 0, 0, 180, (60, 110, 190), -1, cv2.LINE_AA)
    for _ in range(70):
        r, t = 140 * np.sqrt(rng.random()), rng.uniform(0, 2 * np.pi)
        at = (int(256 + r * np.cos(t)), int(392 + 0.26 * r * np.sin(t)))
        cv2.circle(image, at, 15, (206, 142, 66), -1, cv2.LINE_AA)
        cv2.circle(image, at, 6, (148, 92, 40), -1, cv2.LINE_AA)
    cv2.rectangle(image, (0, 56), (512, 196), (196, 36, 44), -1)
    _words(image, "CRUNCHY", (256, 98), 330, (255, 250, 240), 12)
    _words(image, "HOOPS", (256, 162), 200, (255, 220, 110), 9)
    return _small(image)


def card(rng: Rng) -> U8:
    """The front of a credit card."""
    image = _gradient((30, 66, 132), (58, 130, 176), 1.0)
    _blend(image, lambda layer: cv2.circle(layer, (470, 520), 330, (90, 170, 206), -1, cv2.LINE_AA), 0.5)
    cv2.rectangle(image, (52, 190), (138, 290), (226, 190, 102), -1)
    for x in (80, 110):
        cv2.line(image, (x, 190), (x, 290), (166, 130, 60), 3)
    cv2.line(image, (52, 240), (138, 240), (166, 130, 60), 3)
    _words(image, "BANK", (120, 92), 150, (246, 248, 252), 6)
    _words(image, "4539 2718 2818 2846", (256, 356), 420, (240, 244, 250), 4)
    _words(image, "A SMITH  08/29", (170, 440), 250, (226, 234, 244), 3)
    cv2.circle(image, (404, 430), 42, (224, 66, 56), -1, cv2.LINE_AA)
    _blend(image, lambda layer: cv2.circle(layer, (448, 430), 42, (244, 172, 60), -1, cv2.LINE_AA), 0.85)
    del rng
    return _small(image)


def disc(rng: Rng) -> U8:
    """A compact disc: rings that shine in all colours."""
    del rng
    x, y = X - 0.5, Y - 0.5
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    hue = 4 * angle + 9 * radius
    rainbow = np.stack([np.cos(hue), np.cos(hue - 2.1), np.cos(hue + 2.1)], axis=2)
    sheen = np.abs(np.cos(angle * 2 - 0.6))[..., None] ** 3
    silver = 0.74 + 0.05 * np.sin(radius * 420)[..., None] * np.ones(3)
    image = silver + 0.2 * sheen * rainbow + 0.1 * sheen
    image = np.where((radius < 0.17)[..., None], 0.85, image)
    image = np.where((radius < 0.065)[..., None], 0.25, image)
    return _bytes(255 * np.where((np.abs(radius - 0.17) < 0.008)[..., None], 0.6, image))


def keyboard(rng: Rng) -> U8:
    """Rows of keys."""
    rows = 6
    row = np.floor(Y * rows).astype(np.int64)
    x = X * 14 + np.array([0.0, 0.0, 0.5, 0.75, 0.25, 0.0])[row]
    y = Y * rows % 1.0
    bar = (row == 5) & (X > 0.26) & (X < 0.68)
    u = np.where(bar, (X - 0.26) / 0.42 * 5.9, x % 1.0)
    width = np.where(bar, 5.9, 1.0)
    edge = np.minimum(np.minimum(u, width - u) * SIZE_PX / 14, np.minimum(y, 1 - y) * SIZE_PX / rows)
    key = smoothstep(1.0, 2.6, edge)
    sign = (np.abs(u - 0.32) < 0.1) & (np.abs(y - 0.36) < 0.12) & ~bar
    letter = sign & (rng.random((rows, 20))[row, np.floor(x).astype(np.int64)] > 0.1)
    return grey((0.35 + 0.65 * key * (1.05 - 0.1 * y)) * (1 - 0.55 * letter), 0.8)


def remote_buttons(rng: Rng) -> U8:
    """Round rubber buttons, 3 x 6, the top left one red."""
    u, v = X * 3, Y * 6
    ex, ey = (u % 1.0 - 0.5) * SIZE_PX / 3, (v % 1.0 - 0.5) * SIZE_PX / 6
    round_button = 1 - smoothstep(11.0, 14.0, np.hypot(ex * 0.55, ey))
    names = np.floor(v).astype(np.int64) * 3 + np.floor(u).astype(np.int64)
    colors = np.full((18, 3), 0.92)
    colors[0], colors[15], colors[16], colors[17] = (
        (0.85, 0.25, 0.22),
        (0.3, 0.62, 0.35),
        (0.9, 0.75, 0.3),
        (0.3, 0.45, 0.8),
    )
    ground = np.full((SIZE_PX, SIZE_PX, 3), 0.26) + 0.004 * fractal(rng, 0.5)[..., None]
    shade = (1.0 - 0.3 * (ey / 24 + 0.5))[..., None]
    image = ground * (1 - round_button[..., None]) + colors[names] * shade * round_button[..., None]
    return grey(image, float(image.mean()))


def _plain(color: Color) -> U8:
    return np.full((_BIG, _BIG, 3), color, dtype=np.uint8)


def _gradient(top: Color, bottom: Color, until: float) -> U8:
    """From one colour to another on the way down; the second is reached at a share of the height."""
    t = np.clip(np.arange(_BIG) / (_BIG * until), 0, 1)[:, None, None]
    column = np.array(top) * (1 - t) + np.array(bottom) * t
    return np.ascontiguousarray(np.broadcast_to(column, (_BIG, _BIG, 3))).astype(np.uint8)


def _polygon(image: U8, points: Sequence[tuple[int, int]], color: Color) -> None:
    cv2.fillPoly(image, [np.array(points, dtype=np.int32)], color, cv2.LINE_AA)


def _blend(image: U8, draw: Callable[[U8], object], opacity: float) -> None:
    """Draw onto a copy and mix it in."""
    layer = image.copy()
    draw(layer)
    image[:] = (image * (1 - opacity) + layer * opacity).astype(np.uint8)


def _ridge(rng: Rng, height: int, swing: float, fall: float) -> list[tuple[int, int]]:
    """A line of hills across the picture."""
    line = height + swing * fractal(rng, fall, size=128)[0]
    return [(x * _BIG // 127, int(y)) for x, y in enumerate(line)]


def _fill(image: U8, ridge: list[tuple[int, int]], color: Color) -> None:
    """Fill everything below a line of hills."""
    _polygon(image, [*ridge, (_BIG, _BIG), (0, _BIG)], color)


def _words(image: U8, text: str, centre: tuple[int, int], width: int, color: Color, thickness: int) -> None:
    """Write text of a width in pixels around a point."""
    (unit, _), _ = cv2.getTextSize(text, _FONT, 1.0, thickness)
    scale = width / max(unit, 1)
    (w, h), _ = cv2.getTextSize(text, _FONT, scale, thickness)
    cv2.putText(image, text, (centre[0] - w // 2, centre[1] + h // 2), _FONT, scale, color, thickness, cv2.LINE_AA)


def _painted(image: U8, rng: Rng, strength: float = 1.0) -> U8:
    """Ragged edges and uneven colour, as from a brush."""
    ragged = 1.8 * strength
    y, x = np.mgrid[0:_BIG, 0:_BIG].astype(np.float32)
    dx, dy = (fractal(rng, 1.0, size=_BIG) * ragged for _ in range(2))
    moved = cv2.remap(
        image, (x + dx).astype(np.float32), (y + dy).astype(np.float32), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT
    )
    tone = 1 + strength * (0.025 * fractal(rng, 1.2, size=_BIG) + 0.03 * fractal(rng, 0.8, (1, 7), size=_BIG))
    return _clip(moved * tone[..., None])


def _framed(image: U8) -> U8:
    """A print with a white margin."""
    margin = _BIG // 16
    inner = cv2.resize(image, (_BIG - 2 * margin, _BIG - 2 * margin), interpolation=cv2.INTER_AREA)
    sheet = _plain((250, 248, 243))
    sheet[margin:-margin, margin:-margin] = inner
    return _small(sheet)


def _small(image: U8) -> U8:
    return _bytes(image.reshape(SIZE_PX, 2, SIZE_PX, 2, 3).mean(axis=(1, 3)))


def _bytes(image: F64) -> U8:
    return np.clip(image + 0.5, 0, 255).astype(np.uint8)


def _clip(image: F64) -> U8:
    return np.clip(image, 0, 255).astype(np.uint8)


_PRINTS = (landscape, abstract, seascape, flowers, portrait, skyline, geometric, mountains)

PICTURES: dict[str, Callable[[Rng], U8]] = {
    **{f"picture_{index}": function for index, function in enumerate(_PRINTS)},
    **{f"poster_{index}": partial(poster, index) for index in range(4)},
    **{f"book_cover_{index}": partial(book_cover, index) for index in range(4)},
    **{f"label_{index}": partial(label, index) for index in range(4)},
    "sky": sky,
    "newsprint": newsprint,
    "screen_0": desktop,
    "screen_1": television,
    "mirror": mirror,
    "clock_face": clock_face,
    "cereal": cereal,
    "card": card,
    "cd": disc,
    "keyboard": keyboard,
    "remote_buttons": remote_buttons,
}
