"""What screens, windows, mirrors, dials, discs and keys show."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.looks.canvas import INK, Rng, gradient, halved, plain, polygon, to_bytes, write
from remqa_data.assets.looks.noise import SIZE_PX, X, Y, fractal, grey, smoothstep
from remqa_data.geometry.types import U8
from remqa_data.opencv import cv2


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
    return to_bytes(image)


def desktop(rng: Rng) -> U8:
    """A computer screen with two windows and a task bar."""
    image = gradient((36, 96, 152), (104, 72, 150), 1.0)
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
        red, green, blue = (int(c) for c in rng.integers(110, 250, 3))
        color = (red, green, blue)
        cv2.rectangle(image, (136 + 32 * k, 480), (158 + 32 * k, 502), color, -1)
    return halved(image)


def television(rng: Rng) -> U8:
    """A football match."""
    image = gradient((60, 66, 82), (44, 50, 66), 1.0)
    for _ in range(900):
        x, y = int(rng.integers(0, 512)), int(rng.integers(0, 150))
        cv2.circle(image, (x, y), 3, tuple(int(c) for c in rng.integers(70, 220, 3)), -1)
    for stripe in range(9):
        left, right = -240 + stripe * 112, -240 + (stripe + 1) * 112
        color = (70, 150, 66) if stripe % 2 else (84, 166, 76)
        polygon(image, [(left, 512), (right, 512), (140 + right // 2, 150), (140 + left // 2, 150)], color)
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
    write(image, "RED 2 - 1 BLU", (120, 42), 172, (246, 246, 246), 3)
    return halved(image)


def mirror(rng: Rng) -> U8:
    """Grey-blue with slanted bands of light."""
    slant = X + Y
    value = 0.76 + 0.09 * np.sin(slant * 2.2 + 0.4) + 0.002 * fractal(rng, 0.4)
    for centre, width, gain in ((0.62, 0.07, 0.11), (0.82, 0.025, 0.09), (1.32, 0.1, 0.07)):
        value += gain * smoothstep(width + 0.012, width, np.abs(slant - centre))
    return to_bytes(255 * np.stack([value * 0.93, value * 0.99, value * 1.04], axis=2))


def clock_face(rng: Rng) -> U8:
    """Twelve hours; ten past ten."""
    del rng
    image = plain((250, 248, 242))
    cv2.circle(image, (256, 256), 250, (52, 54, 60), 8, cv2.LINE_AA)
    for minute in range(60):
        angle = np.radians(minute * 6)
        long, thick = (34, 9) if minute % 5 == 0 else (14, 3)
        ends = [(int(256 + r * np.sin(angle)), int(256 - r * np.cos(angle))) for r in (234 - long, 234)]
        cv2.line(image, ends[0], ends[1], INK, thick, cv2.LINE_AA)
    for hour in (12, 3, 6, 9):
        angle = np.radians(hour * 30)
        at = (int(256 + 166 * np.sin(angle)), int(256 - 166 * np.cos(angle)))
        write(image, str(hour), at, 30 * len(str(hour)), INK, 6)
    for degrees, length, thick in ((305, 108, 15), (60, 160, 10)):
        end = (int(256 + length * np.sin(np.radians(degrees))), int(256 - length * np.cos(np.radians(degrees))))
        cv2.line(image, (256, 256), end, INK, thick, cv2.LINE_AA)
    cv2.line(image, (256, 286), (256, 92), (206, 58, 48), 4, cv2.LINE_AA)
    cv2.circle(image, (256, 256), 14, (206, 58, 48), -1, cv2.LINE_AA)
    return halved(image)


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
    return to_bytes(255 * np.where((np.abs(radius - 0.17) < 0.008)[..., None], 0.6, image))


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
