"""Which triangle does each pixel show? Kernels that fill a visibility buffer.

Triangles are rasterised in homogeneous coordinates (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
Coordinates", 1997), so those that cross the near plane need no clipping. Edge functions are computed without rounding
differences between the two triangles that share an edge: no pixel falls between them.

Every pixel keeps a key that grows as depth shrinks and is linear over the image: 1 / depth for a pinhole camera,
`FAR_M` - depth for a parallel projection.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, I32, Flags
from remqa_data.sim.render.camera import NEAR_M, Scissor, View
from remqa_data.sim.render.outline import face_bounds, rows_of_side, side

FAR_M = 128.0
"""Greatest depth that a parallel projection shows."""
_SLACK_PX = 1e-3
"""Bounding boxes are this much wider than their float32 corners say, so that rounding loses no pixel."""
_SMALL_PX = 24
"""Bounding boxes up to this many pixels are tested pixel by pixel; larger ones row by row."""


class Geometry(NamedTuple):
    """All parts of a scene in flat arrays. Parts own ranges of vertices and surfaces, surfaces own ranges of faces."""

    vertices: F32
    """(3, n) in the frame of the part."""
    normals: F32
    """(n, 3) in the frame of the part."""
    uv: F32
    """(n, 2) in repeats."""
    faces: I32
    """(m, 3)."""
    face_surface: I32
    """(m,)."""
    face_of_solid: Flags
    """(m,) whether the back of the face cannot be seen from outside the part."""
    surface_start: I32
    """(s + 1,) first face of each surface."""
    part_vertex_start: I32
    """(p + 1,)."""
    part_surface_start: I32
    """(p + 1,)."""
    part_corners: F64
    """(p, 8, 3) corners of the bounding box in the frame of the part."""


class Placed(NamedTuple):
    """The same vertices in the world frame, as the poses put them."""

    vertices: F32
    """(3, n) metres."""
    normals: F32
    """(n, 3)."""
    corners: F64
    """(p, 8, 3) metres."""
    visible: Flags
    """(p,)."""


class Buffers(NamedTuple):
    """What rasterising writes."""

    key: F32
    """(h, w) greater is nearer, 0 where nothing is."""
    slot: I32
    """(h, w) row of `records` that the pixel shows, -1 where nothing is."""
    records: F32
    """(m, 9) of each triangle that won a pixel: x, y and constant coefficient of barycentric coordinate 0 over w, of
    coordinate 1 over w, and of the key; x and y in pixels from the image centre."""
    record_face: I32
    """(m,) face of each record."""
    drawn: I32
    """(p + 1, 2) parts in the order drawn and whether their back faces were skipped; ends with -1."""
    candidates: I32
    """(m,) scratch: the faces of a part that may show."""
    image: F32
    """(5, n) scratch: homogeneous x, y, w, then x / w, y / w of each vertex."""


@exact
def place_part(geometry: Geometry, placed: Placed, part: int, pose: F64) -> None:
    """Move one part: write its world vertices, normals and box corners."""
    local, world = geometry.vertices, placed.vertices
    start, stop = geometry.part_vertex_start[part], geometry.part_vertex_start[part + 1]
    for row in range(3):
        x, y, z, t = pose[row, 0], pose[row, 1], pose[row, 2], pose[row, 3]
        for i in range(start, stop):
            world[row, i] = x * local[0, i] + y * local[1, i] + z * local[2, i] + t
            normal = geometry.normals[i]
            placed.normals[i, row] = x * normal[0] + y * normal[1] + z * normal[2]
        for i in range(8):
            corner = geometry.part_corners[part, i]
            placed.corners[part, i, row] = x * corner[0] + y * corner[1] + z * corner[2] + t


@exact
def rasterise(geometry: Geometry, placed: Placed, view: View, buffers: Buffers) -> int:
    """Fill the visibility buffer, within the scissor, with every visible part; returns the number of records written.

    Parts are drawn near to far, and a part whose box is hidden by what is already drawn is skipped.
    """
    scissor = view.scissor
    for row in range(scissor.top, scissor.bottom + 1):
        buffers.key[row, scissor.left : scissor.right + 1] = 0.0
        buffers.slot[row, scissor.left : scissor.right + 1] = -1
    near_key = nearest_key(view.pinhole)
    parts = placed.corners.shape[0]
    extents = np.empty((parts, 7))
    for part in range(parts):
        box_on_screen(placed.corners[part], view, extents[part])
    count, drawn = int(np.int64(0)), 0  # else `_draw_faces` is compiled for the constant, too
    for part in np.argsort(-extents[:, 5]):
        x_low, x_high, y_low, y_high = extents[part, 0], extents[part, 1], extents[part, 2], extents[part, 3]
        if not placed.visible[part] or x_low > x_high or y_low > y_high:
            continue
        part_key = extents[part, 5]
        crosses_near = part_key >= near_key
        if not crosses_near and _is_hidden(buffers.key, part_key, int(x_low), int(x_high), int(y_low), int(y_high)):
            continue
        start, stop = geometry.part_vertex_start[part], geometry.part_vertex_start[part + 1]
        _project_vertices(placed.vertices, start, stop, view, buffers.image)
        first, last = part_faces(geometry, part)
        # From inside a solid, or where the near plane cuts it open, back faces do show.
        cull = not crosses_near
        candidates = find_candidates(geometry, first, last, cull, buffers, scissor, 1.0)
        count = _draw_faces(geometry, candidates, cull, view.pinhole, scissor, near_key, buffers, count)
        buffers.drawn[drawn, 0], buffers.drawn[drawn, 1] = part, cull
        drawn += 1
    buffers.drawn[drawn, 0] = -1
    return count


@exact
def nearest_key(pinhole: bool) -> float:
    """Key of the near plane; what has a greater one is cut off."""
    return 1.0 / NEAR_M if pinhole else FAR_M - NEAR_M


@exact
def part_faces(geometry: Geometry, part: int) -> tuple[int, int]:
    """Where the faces of a part start and stop."""
    surfaces = geometry.part_surface_start
    return geometry.surface_start[surfaces[part]], geometry.surface_start[surfaces[part + 1]]


@exact
def box_on_screen(corners: F64, view: View, extent: F64) -> None:
    """Write x low, x high, y low, y high (pixels in the scissor), depth low, nearest key and depth high of a box.

    The pixels are none, with a first one after the last, where the box is out of the picture.
    """
    width, height, scissor = view.width, view.height, view.scissor
    x_low, x_high, y_low, y_high = 1e30, -1e30, 1e30, -1e30
    depth_low, depth_high = 1e30, -1e30
    axes, eye = view.axes, view.eye
    left = right = above = below = 0
    for i in range(8):
        dx, dy, dz = corners[i, 0] - eye[0], corners[i, 1] - eye[1], corners[i, 2] - eye[2]
        x = axes[0, 0] * dx + axes[0, 1] * dy + axes[0, 2] * dz
        y = axes[1, 0] * dx + axes[1, 1] * dy + axes[1, 2] * dz
        depth = axes[2, 0] * dx + axes[2, 1] * dy + axes[2, 2] * dz
        w = depth if view.pinhole else 1.0
        left += x < -0.5 * width * w
        right += x > 0.5 * width * w
        above += y < -0.5 * height * w
        below += y > 0.5 * height * w
        depth_low, depth_high = min(depth_low, depth), max(depth_high, depth)
        if w > 0.0:
            x_low, x_high = min(x_low, x / w), max(x_high, x / w)
            y_low, y_high = min(y_low, y / w), max(y_high, y / w)
    if depth_high < NEAR_M or left == 8 or right == 8 or above == 8 or below == 8:
        extent[0], extent[1] = 1.0, 0.0
    elif view.pinhole and depth_low < NEAR_M:
        extent[0], extent[1], extent[2], extent[3] = scissor.left, scissor.right, scissor.top, scissor.bottom
    else:
        extent[0] = max(float(scissor.left), math.ceil(x_low + 0.5 * width - 0.5 - _SLACK_PX))
        extent[1] = min(float(scissor.right), math.floor(x_high + 0.5 * width - 0.5 + _SLACK_PX))
        extent[2] = max(float(scissor.top), math.ceil(y_low + 0.5 * height - 0.5 - _SLACK_PX))
        extent[3] = min(float(scissor.bottom), math.floor(y_high + 0.5 * height - 0.5 + _SLACK_PX))
    extent[4] = depth_low
    extent[5] = 1.0 / max(depth_low, 1e-6) if view.pinhole else FAR_M - depth_low
    extent[6] = depth_high


@exact
def _is_hidden(key: F32, nearest: float, x_low: int, x_high: int, y_low: int, y_high: int) -> bool:
    """Whether everything drawn in a rectangle is nearer than a key."""
    limit = np.float32(nearest * (1.0 + 1e-6))
    for y in range(y_low, y_high + 1):
        for x in range(x_low, x_high + 1):
            if key[y, x] < limit:
                return False
    return True


@exact
def _project_vertices(vertices: F32, start: int, stop: int, view: View, image: F32) -> None:
    """Write homogeneous and divided image coordinates of a range of world vertices."""
    axes, eye = view.axes, view.eye
    for i in range(start, stop):
        dx, dy, dz = vertices[0, i] - eye[0], vertices[1, i] - eye[1], vertices[2, i] - eye[2]
        x = axes[0, 0] * dx + axes[0, 1] * dy + axes[0, 2] * dz
        y = axes[1, 0] * dx + axes[1, 1] * dy + axes[1, 2] * dz
        depth = axes[2, 0] * dx + axes[2, 1] * dy + axes[2, 2] * dz
        inverse = 1.0 / depth if view.pinhole else 1.0
        image[0, i] = x
        image[1, i] = y
        image[2, i] = depth
        image[3, i] = x * inverse
        image[4, i] = y * inverse


@exact
def find_candidates(
    geometry: Geometry, start: int, stop: int, cull: bool, buffers: Buffers, scissor: Scissor, per_pixel: float
) -> int:
    """Write which of a range of faces may show within the scissor; returns how many.

    That is those that turn to the viewer and are not between the columns, or the rows, of the points where the image is
    sampled, of which there are as many to a pixel as given. Most faces of a room fail, and which do is hard to foretell:
    a loop without branches is several times as quick as one that decides face by face.
    """
    faces, solid, image, candidates = geometry.faces, geometry.face_of_solid, buffers.image, buffers.candidates
    height, width = buffers.key.shape
    scale = np.float32(per_pixel)
    last_x, last_y = np.float32(per_pixel * width - 1), np.float32(per_pixel * height - 1)
    # Wider than what is tested when faces are drawn, as this is rounded more coarsely.
    slack = scale * np.float32(2 * _SLACK_PX + 1e-6 * (width + height))
    start_x, stop_x = np.float32(0.5) * last_x - slack, np.float32(0.5) * last_x + slack
    start_y, stop_y = np.float32(0.5) * last_y - slack, np.float32(0.5) * last_y + slack
    left, right = np.float32(per_pixel * scissor.left), np.float32(per_pixel * (scissor.right + 1) - 1)
    top, bottom = np.float32(per_pixel * scissor.top), np.float32(per_pixel * (scissor.bottom + 1) - 1)
    count = 0
    for face in range(start, stop):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        xa, ya, xb, yb, xc, yc = image[3, a], image[4, a], image[3, b], image[4, b], image[3, c], image[4, c]
        turned_away = solid[face] & ((xb - xa) * (yc - ya) - (xc - xa) * (yb - ya) >= np.float32(0.0))
        x_low, x_high = min(xa, min(xb, xc)) * scale + start_x, max(xa, max(xb, xc)) * scale + stop_x
        y_low, y_high = min(ya, min(yb, yc)) * scale + start_y, max(ya, max(yb, yc)) * scale + stop_y
        inside = (x_high >= left) & (x_low <= right) & (y_high >= top) & (y_low <= bottom)
        covers = (np.floor(x_high) >= x_low) & (np.floor(y_high) >= y_low)
        candidates[count] = face
        # Without culling the part may cross the near plane, where divided coordinates mean nothing.
        count += (inside & covers & (not turned_away)) | (not cull)
    return count


@exact
def _draw_faces(
    geometry: Geometry,
    candidates: int,
    cull: bool,
    pinhole: bool,
    scissor: Scissor,
    near_key: float,
    buffers: Buffers,
    count: int,
) -> int:
    """Draw the candidates; returns the number of records so far."""
    faces, key, slot, image = geometry.faces, buffers.key, buffers.slot, buffers.image
    height, width = key.shape
    half_width, half_height = 0.5 * width, 0.5 * height
    flat_key, flat_slot, centres = key.ravel(), slot.ravel(), np.arange(width) + 0.5 - half_width
    nearest = np.float32(near_key)
    if nearest > near_key:
        nearest = np.nextafter(nearest, np.float32(0.0))
    for face in buffers.candidates[:candidates]:
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        skip_back = cull and geometry.face_of_solid[face]
        x_least, x_most, y_least, y_most = face_bounds(image, a, b, c, skip_back, pinhole, half_width, half_height)
        x_low = math.ceil(x_least + half_width - 0.5 - _SLACK_PX)
        x_high = math.floor(x_most + half_width - 0.5 + _SLACK_PX)
        y_low = math.ceil(y_least + half_height - 0.5 - _SLACK_PX)
        y_high = math.floor(y_most + half_height - 0.5 + _SLACK_PX)
        if x_low > x_high or y_low > y_high:
            continue
        x_low, x_high, y_low, y_high = max(x_low, 0), min(x_high, width - 1), max(y_low, 0), min(y_high, height - 1)
        scale, ax, ay, ac, bx, by, bc, cx, cy, cc, kx, ky, kc = edge_functions(image, a, b, c, pinhole)
        if scale == 0.0:
            continue
        won, number = False, np.int32(count)
        is_small = (x_high - x_low + 1) * (y_high - y_low + 1) <= _SMALL_PX
        x_low, x_high = max(x_low, scissor.left), min(x_high, scissor.right)
        y_low, y_high = max(y_low, scissor.top), min(y_high, scissor.bottom)
        if x_low > x_high:
            continue
        if is_small:
            for row in range(y_low, y_high + 1):
                y = row + 0.5 - half_height
                ra, rb, rc, rk = ay * y + ac, by * y + bc, cy * y + cc, ky * y + kc
                for column in range(x_low, x_high + 1):
                    x = column + 0.5 - half_width
                    if ax * x + ra >= 0.0 and bx * x + rb >= 0.0 and cx * x + rc >= 0.0:
                        value = np.float32(kx * x + rk)
                        if value > key[row, column] and value <= near_key:
                            key[row, column] = value
                            slot[row, column] = count
                            won = True
        else:
            low_a, low_a_slope, high_a, high_a_slope = side(ax, ay, ac)
            low_b, low_b_slope, high_b, high_b_slope = side(bx, by, bc)
            low_c, low_c_slope, high_c, high_c_slope = side(cx, cy, cc)
            # Sides that are exactly horizontal limit the rows; matters where the box is the whole image.
            least_a, most_a = rows_of_side(ax, ay, ac)
            least_b, most_b = rows_of_side(bx, by, bc)
            least_c, most_c = rows_of_side(cx, cy, cc)
            y_least, y_most = max(least_a, max(least_b, least_c)), min(most_a, min(most_b, most_c))
            x_start, x_stop = x_low + 0.5 - half_width, x_high + 0.5 - half_width
            for row in range(y_low, y_high + 1):
                y = row + 0.5 - half_height
                if y < y_least or y > y_most:
                    continue
                low = max(max(x_start, low_a + low_a_slope * y), max(low_b + low_b_slope * y, low_c + low_c_slope * y))
                high = min(
                    min(x_stop, high_a + high_a_slope * y), min(high_b + high_b_slope * y, high_c + high_c_slope * y)
                )
                rk = ky * y + kc
                first = math.ceil(low + half_width - 0.5)
                last = math.floor(high + half_width - 0.5)
                if first > last:
                    continue
                # Indices that cannot be negative, numbers of one width, and no branches, let the compiler vectorise.
                start, left, run = np.uint64(row * width + first), np.uint64(first), np.uint64(last - first + 1)
                for i in range(run):
                    value = np.float32(kx * centres[left + i] + rk)
                    wins = (value > flat_key[start + i]) & (value <= nearest)
                    flat_key[start + i] = value if wins else flat_key[start + i]
                    flat_slot[start + i] = number if wins else flat_slot[start + i]
                    won |= wins
        if won:
            record = buffers.records[count]
            record[0], record[1], record[2] = ax * scale, ay * scale, ac * scale
            record[3], record[4], record[5] = bx * scale, by * scale, bc * scale
            record[6], record[7], record[8] = kx, ky, kc
            buffers.record_face[count] = face
            count += 1
    return count


@exact
def edge_functions(
    image: F32, a: int, b: int, c: int, pinhole: bool
) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float, float]:
    """Scale, then x, y and constant coefficients of the edge functions opposite a, b and c, and of the key.

    A point is inside where all three are positive; times the scale they are its barycentric coordinates over w. The
    scale is 0 for a face seen edge-on.
    """
    # Products of two float32 are exact in float64: a shared edge gets exactly opposite functions in its two faces.
    xa, ya = np.float64(image[0, a]), np.float64(image[1, a])
    xb, yb = np.float64(image[0, b]), np.float64(image[1, b])
    xc, yc = np.float64(image[0, c]), np.float64(image[1, c])
    depth_a, depth_b, depth_c = np.float64(image[2, a]), np.float64(image[2, b]), np.float64(image[2, c])
    wa, wb, wc = (depth_a, depth_b, depth_c) if pinhole else (1.0, 1.0, 1.0)
    ax, ay, ac = yb * wc - yc * wb, xc * wb - xb * wc, xb * yc - xc * yb
    bx, by, bc = yc * wa - ya * wc, xa * wc - xc * wa, xc * ya - xa * yc
    cx, cy, cc = ya * wb - yb * wa, xb * wa - xa * wb, xa * yb - xb * ya
    determinant = xa * ax + ya * ay + wa * ac
    if determinant == 0.0:
        return 0.0, ax, ay, ac, bx, by, bc, cx, cy, cc, 0.0, 0.0, 0.0
    if determinant < 0.0:
        ax, ay, ac, bx, by, bc, cx, cy, cc = -ax, -ay, -ac, -bx, -by, -bc, -cx, -cy, -cc
        determinant = -determinant
    scale = 1.0 / determinant
    if pinhole:
        kx, ky, kc = (ax + bx + cx) * scale, (ay + by + cy) * scale, (ac + bc + cc) * scale
    else:
        qa, qb, qc = FAR_M - depth_a, FAR_M - depth_b, FAR_M - depth_c
        kx = (ax * qa + bx * qb + cx * qc) * scale
        ky = (ay * qa + by * qb + cy * qc) * scale
        kc = (ac * qa + bc * qb + cc * qc) * scale
    return scale, ax, ay, ac, bx, by, bc, cx, cy, cc, kx, ky, kc
