"""What colour is each pixel? Kernels that light the triangles of a visibility buffer.

Colours are linear between reading the texture and writing the picture, with a gamma of 2 (a square root is quick).
A picture is shaded row by row, each step for the whole row at once.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, I32, U8
from remqa_data.sim.light.patches import Patches, sample_of
from remqa_data.sim.render import pixels as px
from remqa_data.sim.render.camera import View
from remqa_data.sim.render.mipmap import apply_textures
from remqa_data.sim.render.mirrors import Mirrors, reflect
from remqa_data.sim.render.raster import FAR_M, Buffers, Geometry, Placed
from remqa_data.sim.render.shadow import Shadows, find_shadows

_F = np.float32
KNEE = 0.7
"""Linear light up to this is shown as it is where light is baked."""


class Materials(NamedTuple):
    """Material of each surface."""

    albedo: F32
    """(s, 3) linear."""
    texture: I32
    """(s,) number in the atlas, see `mipmap.apply_textures`."""
    gloss: F32
    """(s,)."""
    glow: F32
    """(s,)."""
    mirror: F32
    """(s,) share of its light that a reflection is, where there is a map of it."""


class Lights(NamedTuple):
    """The light of a room, linear."""

    positions: F64
    """(k, 3) metres."""
    strength: F32
    """(k,) of a surface that faces the lamp from close by."""
    reach_m: float
    """Distance at which a lamp's light has halved."""
    ambient: float
    """Light from everywhere."""
    background: F32
    """(3,) where nothing is."""


@exact
def write_depth(buffers: Buffers, view: View, depth: F32) -> None:
    """Fill the (h, w) depth image within the scissor: metres, 0 where nothing is."""
    keys, depths, scissor = buffers.key.ravel(), depth.ravel(), view.scissor
    one, zero, far = np.float32(1.0), np.float32(0.0), np.float32(FAR_M)
    for row in range(scissor.top, scissor.bottom + 1):
        start = np.uint64(row * view.width + scissor.left)
        for i in range(np.uint64(scissor.right + 1 - scissor.left)):
            key = keys[start + i]
            depths[start + i] = (one / key if view.pinhole else far - key) if key > zero else zero


@exact
def shade(
    geometry: Geometry,
    placed: Placed,
    view: View,
    buffers: Buffers,
    materials: Materials,
    texels: I32,
    lights: Lights,
    shadows: Shadows,
    patches: Patches,
    mirrors: Mirrors,
    rgb: U8,
) -> None:
    """Write the (h, w, 3) uint8 picture within the scissor; with empty patches, light from everywhere is the same everywhere.

    The maps of mirrors hold light as pictures show it, so they are mixed in when all else is as it will be shown.
    """
    height, width = buffers.slot.shape
    scissor = view.scissor
    sheet = np.zeros(px.FLOATS, dtype=np.float32)
    fetches = np.zeros(px.INTS, dtype=np.int32)
    # Blocks begin where those of a whole picture do: a ray in a mirror starts from where the one beside it in its block ended.
    left = scissor.left - scissor.left % px.BLOCK_PX
    for y in range(scissor.top, scissor.bottom + 1):
        for start in range(left, scissor.right + 1, px.BLOCK_PX):
            count = min(px.BLOCK_PX, scissor.right + 1 - start)
            shows_mirror = _fetch(
                geometry,
                placed,
                view,
                buffers,
                materials,
                lights.background,
                patches,
                mirrors,
                y,
                start,
                count,
                sheet,
                fetches,
            )
            if len(patches.light) > 0:
                _mix_samples(patches.light.ravel(), sheet, fetches, count)
            _place(view, y + 0.5 - 0.5 * height, start + 0.5 - 0.5 * width, sheet, count)
            apply_textures(texels, sheet, fetches, count)
            find_shadows(shadows, sheet, fetches, count)
            if len(patches.light) == 0:
                _ambient(lights, sheet, count)
            _light(view, lights, sheet, count)
            if len(patches.light) > 0:
                _roll_off(sheet, count)
            if shows_mirror:
                reflect(geometry, view, buffers, materials.mirror, mirrors, y, start, sheet, count)
            _encode(sheet, fetches, count)
            for i in range(max(scissor.left - start, 0), min(count, px.BLOCK_PX)):
                for channel in range(3):
                    rgb[y, start + i, channel] = fetches[channel * px.BLOCK_PX + i]


@exact
def _fetch(
    geometry: Geometry,
    placed: Placed,
    view: View,
    buffers: Buffers,
    materials: Materials,
    background: F32,
    patches: Patches,
    mirrors: Mirrors,
    y: int,
    start: int,
    count: int,
    sheet: F32,
    fetches: I32,
) -> bool:
    """Write material, texture coordinates, normal, depth and baked light, one run of the same triangle at a time.

    Of faces with many samples of that, where a pixel lies among them, how many there are along a side, and the first one.
    Returns whether any pixel shows a mirror that there is a map of.
    """
    height, width = buffers.slot.shape
    one = np.float32(1.0)
    line = np.float32(y + 0.5 - 0.5 * height)
    left = np.float32(start + 0.5 - 0.5 * width)
    stop, shows_mirror = 0, False
    while stop < count:
        first = stop
        slot = buffers.slot[y, start + first]
        stop = first + 1
        while stop < count and buffers.slot[y, start + stop] == slot:
            stop += 1
        if slot < 0:
            for i in range(first, stop):
                sheet[px.TEXTURE + i] = 0.0
                sheet[px.RED + i], sheet[px.GREEN + i], sheet[px.BLUE + i] = background[0], background[1], background[2]
                sheet[px.GLOSS + i], sheet[px.GLOW + i] = 0.0, one
                sheet[px.NORMAL_X + i], sheet[px.NORMAL_Y + i], sheet[px.NORMAL_Z + i] = 0.0, 0.0, one
                sheet[px.DEPTH + i] = one
                sheet[px.LIGHT_RED + i], sheet[px.LIGHT_GREEN + i], sheet[px.LIGHT_BLUE + i] = 0.0, 0.0, 0.0
                sheet[px.STEPS + i] = one
                fetches[px.ADDRESS + i] = 0
            continue
        record = buffers.records[slot]
        ax, ay, ac, bx, by, bc = record[0], record[1], record[2], record[3], record[4], record[5]
        kx, ky, kc = record[6], record[7], record[8]
        face = buffers.record_face[slot]
        a, b, c = geometry.faces[face, 0], geometry.faces[face, 1], geometry.faces[face, 2]
        surface = geometry.face_surface[face]
        shows_mirror |= mirrors.of_surface[surface] >= 0
        texture = np.float32(materials.texture[surface])
        albedo = materials.albedo[surface]
        red, green, blue = albedo[0], albedo[1], albedo[2]
        gloss, glow = materials.gloss[surface], materials.glow[surface]
        a_line, b_line = ay * line + ac, by * line + bc
        # Of u, v and the normal: the value at corner c, and how much more it is at the corners a and b.
        uv_a, uv_b, uv_c = geometry.uv[a], geometry.uv[b], geometry.uv[c]
        uc, vc = uv_c[0], uv_c[1]
        ua, va, ub, vb = uv_a[0] - uc, uv_a[1] - vc, uv_b[0] - uc, uv_b[1] - vc
        ux, uy = ua * ax + ub * bx, ua * ay + ub * by
        vx, vy = va * ax + vb * bx, va * ay + vb * by
        wx, wy = (kx, ky) if view.pinhole else (np.float32(0.0), np.float32(0.0))
        normal_a, normal_b, normal_c = placed.normals[a], placed.normals[b], placed.normals[c]
        nxc, nyc, nzc = normal_c[0], normal_c[1], normal_c[2]
        nxa, nya, nza = normal_a[0] - nxc, normal_a[1] - nyc, normal_a[2] - nzc
        nxb, nyb, nzb = normal_b[0] - nxc, normal_b[1] - nyc, normal_b[2] - nzc
        key_line = ky * line + kc
        lrc, lgc, lbc, lra, lga, lba, lrb, lgb, lbb = _corner_light(patches, face)
        # A view that starts at the run lets the compiler see that no index is negative, and vectorise.
        run, run_left = sheet[first:], left + np.float32(first)
        for i in range(stop - first):
            column = np.float32(i) + run_left
            key = kx * column + key_line
            depth = one / key if view.pinhole else np.float32(FAR_M) - key
            w = depth if view.pinhole else one
            at_a, at_b = (ax * column + a_line) * w, (bx * column + b_line) * w
            u, v = ua * at_a + ub * at_b, va * at_a + vb * at_b
            dux, duy = (ux - u * wx) * w, (uy - u * wy) * w
            dvx, dvy = (vx - v * wx) * w, (vy - v * wy) * w
            run[px.TEXTURE + i] = texture
            run[px.U + i], run[px.V + i] = u + uc, v + vc
            run[px.STRETCH + i] = max(dux * dux + dvx * dvx, duy * duy + dvy * dvy)
            run[px.RED + i], run[px.GREEN + i], run[px.BLUE + i] = red, green, blue
            run[px.GLOSS + i], run[px.GLOW + i] = gloss, glow
            run[px.NORMAL_X + i] = nxc + nxa * at_a + nxb * at_b
            run[px.NORMAL_Y + i] = nyc + nya * at_a + nyb * at_b
            run[px.NORMAL_Z + i] = nzc + nza * at_a + nzb * at_b
            run[px.DEPTH + i] = depth
            run[px.LIGHT_RED + i] = lrc + lra * at_a + lrb * at_b
            run[px.LIGHT_GREEN + i] = lgc + lga * at_a + lgb * at_b
            run[px.LIGHT_BLUE + i] = lbc + lba * at_a + lbb * at_b
        if len(patches.light) > 0:
            steps, base = np.float32(patches.steps[face]), patches.start[face]
            for i in range(first, stop):
                sheet[px.STEPS + i] = steps
                fetches[px.ADDRESS + i] = base
    return shows_mirror


@exact
def _corner_light(patches: Patches, face: int) -> tuple[_F, _F, _F, _F, _F, _F, _F, _F, _F]:
    """Baked red, green and blue of a face at its third corner, and how much more they are at the first and the second.

    Of a face with more samples it is where a pixel lies among them, in steps towards the first and the second corner.
    """
    zero = np.float32(0.0)
    if len(patches.light) == 0:
        return zero, zero, zero, zero, zero, zero, zero, zero, zero
    if patches.steps[face] > 1:
        steps = np.float32(patches.steps[face])
        return zero, zero, zero, steps, zero, zero, zero, steps, zero
    base = patches.start[face]
    c, b, a = patches.light[base], patches.light[base + 1], patches.light[base + 2]
    return c[0], c[1], c[2], a[0] - c[0], a[1] - c[1], a[2] - c[2], b[0] - c[0], b[1] - c[1], b[2] - c[2]


@exact
def _mix_samples(light: F32, sheet: F32, fetches: I32, count: int) -> None:
    """Write the baked light of pixels of faces with many samples: of the three around each pixel."""
    one, zero = np.float32(1.0), np.float32(0.0)
    for i in range(min(count, px.BLOCK_PX)):
        steps = sheet[px.STEPS + i]
        most = steps - np.float32(1e-3)
        s = min(max(sheet[px.LIGHT_RED + i], zero), most)
        t = min(max(sheet[px.LIGHT_GREEN + i], zero), most - s)
        row, step = np.int32(s), np.int32(t)
        u, v = s - np.float32(row), t - np.float32(step)
        first = np.int32(fetches[px.ADDRESS + i] + sample_of(np.int32(steps), row, step))
        across = np.int32(np.int32(first + np.int32(np.int32(steps) + np.int32(1))) - row)
        is_upper = u + v > one
        wa = one - v if is_upper else u
        wb = one - u if is_upper else v
        corner = np.int32(across + np.int32(1)) if is_upper else first
        fetches[px.ADDRESS + i] = np.int32(np.int32(corner) * np.int32(3))
        fetches[px.ADDRESS + px.BLOCK_PX + i] = np.int32(across * np.int32(3))
        fetches[px.ADDRESS + 2 * px.BLOCK_PX + i] = np.int32(np.int32(first + np.int32(1)) * np.int32(3))
        sheet[px.WEIGHT_CORNER + i], sheet[px.WEIGHT_ACROSS + i], sheet[px.WEIGHT_ALONG + i] = one - wa - wb, wa, wb
    for i in range(min(count, px.BLOCK_PX)):
        if sheet[px.STEPS + i] > one:
            wc, wa, wb = sheet[px.WEIGHT_CORNER + i], sheet[px.WEIGHT_ACROSS + i], sheet[px.WEIGHT_ALONG + i]
            c = np.uint32(fetches[px.ADDRESS + i])
            a = np.uint32(fetches[px.ADDRESS + px.BLOCK_PX + i])
            b = np.uint32(fetches[px.ADDRESS + 2 * px.BLOCK_PX + i])
            sheet[px.LIGHT_RED + i] = wc * light[c] + wa * light[a] + wb * light[b]
            sheet[px.LIGHT_GREEN + i] = wc * light[c + 1] + wa * light[a + 1] + wb * light[b + 1]
            sheet[px.LIGHT_BLUE + i] = wc * light[c + 2] + wa * light[a + 2] + wb * light[b + 2]


@exact
def _place(view: View, line: float, left: float, sheet: F32, count: int) -> None:
    """Write the world position of each pixel; make its normal a unit vector on the camera's side."""
    one, zero = np.float32(1.0), np.float32(0.0)
    ex, ey, ez = np.float32(view.eye[0]), np.float32(view.eye[1]), np.float32(view.eye[2])
    ray = view.inverse.astype(np.float32)
    rx, ry, rz = ray[0, 0], ray[1, 0], ray[2, 0]
    lx, ly, lz = ray[0, 1] * np.float32(line), ray[1, 1] * np.float32(line), ray[2, 1] * np.float32(line)
    fx, fy, fz = ray[0, 2], ray[1, 2], ray[2, 2]
    spread = one if view.pinhole else zero
    for i in range(min(count, px.BLOCK_PX)):
        column = np.float32(i) + np.float32(left)
        sx, sy, sz = rx * column + lx, ry * column + ly, rz * column + lz
        depth = sheet[px.DEPTH + i]
        w = spread * depth + (one - spread)
        sheet[px.X + i] = ex + sx * w + fx * depth
        sheet[px.Y + i] = ey + sy * w + fy * depth
        sheet[px.Z + i] = ez + sz * w + fz * depth
        nx, ny, nz = sheet[px.NORMAL_X + i], sheet[px.NORMAL_Y + i], sheet[px.NORMAL_Z + i]
        away = nx * (fx + spread * sx) + ny * (fy + spread * sy) + nz * (fz + spread * sz)
        scale = one / math.sqrt(nx * nx + ny * ny + nz * nz + np.float32(1e-20))
        scale = -scale if away > zero else scale
        sheet[px.NORMAL_X + i] = nx * scale
        sheet[px.NORMAL_Y + i] = ny * scale
        sheet[px.NORMAL_Z + i] = nz * scale


@exact
def _ambient(lights: Lights, sheet: F32, count: int) -> None:
    """Write the light that comes from everywhere where none is baked."""
    one, ambient = np.float32(1.0), np.float32(lights.ambient)
    for i in range(min(count, px.BLOCK_PX)):
        nx, ny, nz = sheet[px.NORMAL_X + i], sheet[px.NORMAL_Y + i], sheet[px.NORMAL_Z + i]
        # Brighter from above, and from below by what the floor throws back; the slight slope in x and y tells the sides
        # of a box apart where no lamp shines.
        slope = np.float32(0.07) * nx + np.float32(0.04) * ny + np.float32(0.15) * nz + np.float32(0.15) * nz * nz
        level = ambient * (one + slope)
        sheet[px.LIGHT_RED + i], sheet[px.LIGHT_GREEN + i], sheet[px.LIGHT_BLUE + i] = level, level, level


@exact
def _light(view: View, lights: Lights, sheet: F32, count: int) -> None:
    """Write the linear light that each pixel sends to the camera, from what comes from everywhere and from the lamps."""
    one, zero, tiny = np.float32(1.0), np.float32(0.0), np.float32(1e-12)
    ex, ey, ez = np.float32(view.eye[0]), np.float32(view.eye[1]), np.float32(view.eye[2])
    for i in range(min(count, px.BLOCK_PX)):
        sheet[px.LIGHT_RED + i] *= sheet[px.RED + i]
        sheet[px.LIGHT_GREEN + i] *= sheet[px.GREEN + i]
        sheet[px.LIGHT_BLUE + i] *= sheet[px.BLUE + i]
    fade = np.float32(1.0 / (lights.reach_m * lights.reach_m))
    for lamp in range(len(lights.positions)):
        positions = lights.positions
        at_x, at_y, at_z = (
            np.float32(positions[lamp, 0]),
            np.float32(positions[lamp, 1]),
            np.float32(positions[lamp, 2]),
        )
        strength = lights.strength[lamp]
        shadowed = one if lamp == 0 else zero
        for i in range(min(count, px.BLOCK_PX)):
            nx, ny, nz = sheet[px.NORMAL_X + i], sheet[px.NORMAL_Y + i], sheet[px.NORMAL_Z + i]
            x, y, z = sheet[px.X + i], sheet[px.Y + i], sheet[px.Z + i]
            lx, ly, lz = at_x - x, at_y - y, at_z - z
            square = lx * lx + ly * ly + lz * lz + tiny
            distance = math.sqrt(square)
            lit = one + shadowed * (sheet[px.LIT + i] - one)
            share = strength * lit / (distance * (one + square * fade))
            diffuse = max(nx * lx + ny * ly + nz * lz, zero) * share
            vx, vy, vz = ex - x, ey - y, ez - z
            view_distance = math.sqrt(vx * vx + vy * vy + vz * vz + tiny)
            # Blinn's highlight: the normal against the direction half way between lamp and camera, which has any length
            # here. Square roots and quotients are what takes time.
            hx, hy, hz = (
                lx * view_distance + vx * distance,
                ly * view_distance + vy * distance,
                lz * view_distance + vz * distance,
            )
            shine = max(nx * hx + ny * hy + nz * hz, zero)
            shine = shine * shine / (hx * hx + hy * hy + hz * hz + tiny)
            shine = shine * shine
            shine = shine * shine
            shine = shine * shine
            shine = shine * shine * np.float32(0.6) * sheet[px.GLOSS + i] * share * distance
            sheet[px.LIGHT_RED + i] += diffuse * sheet[px.RED + i] + shine
            sheet[px.LIGHT_GREEN + i] += diffuse * sheet[px.GREEN + i] + shine
            sheet[px.LIGHT_BLUE + i] += diffuse * sheet[px.BLUE + i] + shine


@exact
def _roll_off(sheet: F32, count: int) -> None:
    """Bring what is brighter than `KNEE` below white, ever more slowly, so that what is lit strongly keeps its shape."""
    knee, span = np.float32(KNEE), np.float32(1.0 - KNEE)
    zero = np.float32(0.0)
    for i in range(min(count, px.BLOCK_PX)):
        for channel in range(3):
            light = sheet[px.LIGHT_RED + channel * px.BLOCK_PX + i]
            over = max(light - knee, zero)
            sheet[px.LIGHT_RED + channel * px.BLOCK_PX + i] = light - over + over * span / (over + span)


@exact
def _encode(sheet: F32, fetches: I32, count: int) -> None:
    """Let glowing pixels show their own colour, and write all as whole numbers 0..255."""
    one = np.float32(1.0)
    for i in range(min(count, px.BLOCK_PX)):
        glow = sheet[px.GLOW + i]
        for channel in range(3):
            row = channel * px.BLOCK_PX + i
            light = sheet[px.LIGHT_RED + row] + glow * (sheet[px.RED + row] - sheet[px.LIGHT_RED + row])
            fetches[row] = np.int32(math.sqrt(min(light, one)) * np.float32(255.0) + np.float32(0.5))
