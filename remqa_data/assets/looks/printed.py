"""Printed matter: posters, newspapers, book covers, labels, packaging and cards."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.looks.canvas import CREAM, INK, Rng, blend, gradient, halved, plain, polygon, write
from remqa_data.geometry.types import U8
from remqa_data.opencv import cv2


def poster(index: int, rng: Rng) -> U8:
    """Large type over simple shapes."""
    if index == 0:
        image = plain((232, 72, 54))
        cv2.circle(image, (256, 308), 132, (250, 206, 80), -1, cv2.LINE_AA)
        write(image, "JAZZ", (256, 92), 390, CREAM, 14)
        write(image, "NIGHT", (256, 308), 220, (232, 72, 54), 12)
        write(image, "BLUE HALL  8 PM", (256, 482), 300, CREAM, 4)
    elif index == 1:
        image = gradient((24, 40, 88), (70, 40, 110), 1.0)
        for _ in range(140):
            x, y = rng.integers(0, 512, 2)
            cv2.circle(image, (int(x), int(y)), int(rng.integers(1, 4)), (230, 230, 250), -1, cv2.LINE_AA)
        cv2.circle(image, (256, 232), 96, (226, 146, 92), -1, cv2.LINE_AA)
        cv2.ellipse(image, (256, 232), (168, 40), -18, 0, 360, (240, 214, 170), 9, cv2.LINE_AA)
        cv2.ellipse(image, (256, 232), (96, 96), -18, 180, 360, (226, 146, 92), -1, cv2.LINE_AA)
        write(image, "SPACE", (256, 400), 340, (250, 246, 236), 12)
        write(image, "THE LAST ORBIT", (256, 474), 280, (226, 196, 160), 4)
    elif index == 2:
        image = plain((40, 122, 98))
        polygon(image, [(0, 512), (0, 250), (130, 130), (256, 330), (350, 210), (512, 420), (512, 512)], (24, 84, 72))
        cv2.circle(image, (392, 116), 54, (250, 226, 130), -1, cv2.LINE_AA)
        write(image, "HIKE", (256, 388), 350, CREAM, 16)
        write(image, "MORE OFTEN", (256, 470), 300, (250, 226, 130), 5)
    else:
        image = plain(CREAM)
        for i, color in enumerate(((236, 178, 66), (222, 96, 70), (48, 104, 122), (36, 52, 74))):
            cv2.ellipse(image, (256, 330), (220 - 48 * i, 220 - 48 * i), 0, 180, 360, color, -1, cv2.LINE_AA)
        write(image, "GOOD", (256, 388), 210, INK, 9)
        write(image, "MORNING", (256, 464), 340, INK, 9)
    return halved(image)


def newsprint(rng: Rng) -> U8:
    """A headline, a photograph and three columns."""
    image = plain((232, 228, 216))
    write(image, "THE DAILY NEWS", (256, 44), 450, INK, 6)
    cv2.line(image, (24, 78), (488, 78), INK, 3)
    write(image, "RAIN AT LAST", (170, 112), 290, INK, 4)
    cv2.rectangle(image, (190, 150), (488, 300), (122, 120, 116), -1)
    polygon(image, [(190, 300), (270, 210), (330, 262), (400, 190), (488, 300)], (66, 66, 66))
    cv2.circle(image, (440, 182), 16, (206, 204, 198), -1, cv2.LINE_AA)
    for column in range(3):
        x = 24 + 160 * column
        for y in range(152 if column == 0 else 320, 496, 11):
            end = x + 144 - (int(rng.integers(10, 90)) if rng.random() < 0.18 else int(rng.integers(0, 6)))
            cv2.line(image, (x, y), (end, y), (98, 96, 92), 4)
    return halved(image)


def book_cover(index: int, rng: Rng) -> U8:
    """Title, author and a picture."""
    title, author, ground, accent = (
        ("THE SEA", "A. MOREAU", (36, 74, 112), (238, 196, 96)),
        ("GARDENS", "L. HILL", (232, 224, 200), (92, 134, 84)),
        ("NIGHT TRAIN", "J. OKADA", (40, 36, 52), (214, 72, 66)),
        ("ATLAS", "M. BERG", (196, 96, 62), (246, 230, 200)),
    )[index]
    image = plain(ground)
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
        polygon(image, [(60, 430), (452, 430), (300, 290), (280, 290)], (84, 78, 98))
        for k in range(7):
            y = 300 + k * k * 3
            cv2.line(image, (290 - (y - 288), y), (290 + (y - 288), y), accent, 4, cv2.LINE_AA)
    else:
        cv2.circle(image, (256, 316), 112, accent, 6, cv2.LINE_AA)
        for half in (38, 78):
            cv2.ellipse(image, (256, 316), (half, 112), 0, 0, 360, accent, 4, cv2.LINE_AA)
            cv2.line(image, (150 + half // 3, 316 - half), (362 - half // 3, 316 - half), accent, 4, cv2.LINE_AA)
            cv2.line(image, (150 + half // 3, 316 + half), (362 - half // 3, 316 + half), accent, 4, cv2.LINE_AA)
    write(image, title, (256, 110), 380, accent if index != 1 else INK, 8)
    write(image, author, (256, 456), 150, accent if index != 1 else INK, 3)
    return halved(image)


def label(index: int, rng: Rng) -> U8:
    """A product label."""
    del rng
    name, line, ground, band = (
        ("TOMATO", "CLASSIC SOUP", (246, 238, 222), (200, 46, 40)),
        ("OLIVA", "EXTRA VIRGIN", (236, 230, 196), (86, 112, 52)),
        ("AQUA", "FRESH SHAMPOO", (226, 242, 246), (44, 132, 176)),
        ("HONEY", "100% PURE", (250, 226, 150), (176, 106, 30)),
    )[index]
    image = plain(ground)
    cv2.rectangle(image, (0, 60), (512, 206), band, -1)
    for y in (44, 216):
        cv2.line(image, (0, y), (512, y), band, 5)
    write(image, name, (256, 132), 420, (252, 250, 244), 13)
    if index in (0, 3):
        cv2.circle(image, (256, 326), 66, (214, 60, 44) if index == 0 else (236, 166, 44), -1, cv2.LINE_AA)
        cv2.ellipse(image, (238, 302), (20, 12), -30, 0, 360, (250, 220, 200), -1, cv2.LINE_AA)
        polygon(image, [(232, 262), (256, 284), (284, 258), (262, 254)], (74, 124, 58))
    else:
        for angle in range(-60, 61, 30):
            end = (int(256 + 80 * np.sin(np.radians(angle))), int(384 - 96 * np.cos(np.radians(angle))))
            cv2.ellipse(
                image, ((256 + end[0]) // 2, (384 + end[1]) // 2), (14, 46), angle, 0, 360, band, -1, cv2.LINE_AA
            )
    write(image, line, (256, 436), 300, INK, 5)
    for x in range(376, 480, 7):
        cv2.line(image, (x, 466), (x, 502), INK, 2 + x % 3)
    return halved(image)


def cereal(rng: Rng) -> U8:
    """The front of a cereal box."""
    image = gradient((250, 190, 60), (240, 130, 40), 1.0)
    for angle in range(0, 360, 24):
        a, b = np.radians(angle), np.radians(angle + 12)
        far = [(int(256 + 420 * np.cos(t)), int(290 + 420 * np.sin(t))) for t in (a, b)]
        polygon(image, [(256, 290), *far], (252, 206, 92))
    cv2.ellipse(image, (256, 400), (168, 48), 0, 0, 360, (250, 250, 252), -1, cv2.LINE_AA)
    cv2.ellipse(image, (256, 400), (168, 110), 0, 0, 180, (60, 110, 190), -1, cv2.LINE_AA)
    for _ in range(70):
        r, t = 140 * np.sqrt(rng.random()), rng.uniform(0, 2 * np.pi)
        at = (int(256 + r * np.cos(t)), int(392 + 0.26 * r * np.sin(t)))
        cv2.circle(image, at, 15, (206, 142, 66), -1, cv2.LINE_AA)
        cv2.circle(image, at, 6, (148, 92, 40), -1, cv2.LINE_AA)
    cv2.rectangle(image, (0, 56), (512, 196), (196, 36, 44), -1)
    write(image, "CRUNCHY", (256, 98), 330, (255, 250, 240), 12)
    write(image, "HOOPS", (256, 162), 200, (255, 220, 110), 9)
    return halved(image)


def card(rng: Rng) -> U8:
    """The front of a credit card."""
    image = gradient((30, 66, 132), (58, 130, 176), 1.0)
    blend(image, lambda layer: cv2.circle(layer, (470, 520), 330, (90, 170, 206), -1, cv2.LINE_AA), 0.5)
    cv2.rectangle(image, (52, 190), (138, 290), (226, 190, 102), -1)
    for x in (80, 110):
        cv2.line(image, (x, 190), (x, 290), (166, 130, 60), 3)
    cv2.line(image, (52, 240), (138, 240), (166, 130, 60), 3)
    write(image, "BANK", (120, 92), 150, (246, 248, 252), 6)
    write(image, "4539 2718 2818 2846", (256, 356), 420, (240, 244, 250), 4)
    write(image, "A SMITH  08/29", (170, 440), 250, (226, 234, 244), 3)
    cv2.circle(image, (404, 430), 42, (224, 66, 56), -1, cv2.LINE_AA)
    blend(image, lambda layer: cv2.circle(layer, (448, 430), 42, (244, 172, 60), -1, cv2.LINE_AA), 0.85)
    del rng
    return halved(image)
