"""Arithmetic that gives the same bits on every processor.

Sums, products, quotients and roots of single numbers are rounded alike everywhere (IEEE 754). The rest is not: a matrix
library chooses order and fused operations for the processor, and so does a C library for its sine. So all that ends in
stored numbers or pixels is multiplied, turned and measured with these functions, which do every step in a fixed order.
What other libraries compute (meshes, physics) is `snapped` once, where it is taken over.

A single vector, matrix or angle goes through Python's own numbers, which are the same IEEE 754 doubles: numpy takes ten
times as long for its first number as for the next hundred.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeGuard

import numpy as np
import numpy.typing as npt

from remqa_data.geometry.types import F64

LENGTH_STEP_M = 2.0**-20
"""Lengths that others computed are snapped to a micrometre: far more than their error, far less than a pixel shows."""

FEW = 600
"""Of so few numbers, it is the number of steps that takes time."""


def product(a: F64, b: F64) -> F64:
    """(..., n, m) matrix products of (..., n, k) and (..., k, m); for a few small matrices or many."""
    parts = a[..., :, :, None] * b[..., None, :, :]
    total = parts[..., 0, :]
    for k in range(1, a.shape[-1]):
        total = total + parts[..., k, :]
    return np.asarray(total)


def turned(vectors: npt.ArrayLike, rotation: F64) -> F64:
    """(..., 3) vectors multiplied from the left by (..., 3, 3) matrices."""
    v = np.asarray(vectors)
    if v.ndim == 1 and rotation.ndim == 2:
        return np.array(_turned(v.tolist(), rotation.tolist()))
    if v.size <= FEW:
        columns = np.swapaxes(rotation, -1, -2)
        total = v[..., 0, None] * columns[..., 0, :]
        total = total + v[..., 1, None] * columns[..., 1, :]
        return np.asarray(total + v[..., 2, None] * columns[..., 2, :])
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    rows = [rotation[..., i, 0] * x + rotation[..., i, 1] * y + rotation[..., i, 2] * z for i in range(3)]
    return np.stack(rows, axis=-1)


def turned_back(vectors: npt.ArrayLike, rotation: F64) -> F64:
    """(..., 3) vectors multiplied from the left by the transposes of (..., 3, 3) matrices: for rotations, undoes `turned`."""
    return turned(vectors, np.swapaxes(rotation, -1, -2))


def moved(points: npt.ArrayLike, pose: F64) -> F64:
    """(..., 3) points mapped by (..., 4, 4) poses."""
    if pose.ndim == 2 and np.ndim(points) == 1:
        rows = pose.tolist()[:3]
        turned_point = _turned(np.asarray(points).tolist(), rows)
        return np.array([turned + row[3] for turned, row in zip(turned_point, rows, strict=True)])
    return turned(points, pose[..., :3, :3]) + pose[..., :3, 3]


def moved_back(points: npt.ArrayLike, pose: F64) -> F64:
    """(..., 3) points mapped by the inverses of (..., 4, 4) poses, which have to be rigid."""
    return turned_back(np.asarray(points) - pose[..., :3, 3], pose[..., :3, :3])


def inverse(pose: F64) -> F64:
    """Inverse of (..., 4, 4) rigid poses."""
    if pose.ndim == 2:
        *rows, _ = pose.tolist()
        *columns, shift = zip(*rows, strict=True)
        back = _turned(shift, columns)
        return np.array([*([*column, -t] for column, t in zip(columns, back, strict=True)), [0.0, 0.0, 0.0, 1.0]])
    result = np.zeros_like(pose)
    result[..., :3, :3] = np.swapaxes(pose[..., :3, :3], -1, -2)
    result[..., :3, 3] = -turned_back(pose[..., :3, 3], pose[..., :3, :3])
    result[..., 3, 3] = 1.0
    return result


def dot(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """Sums over the last axis, which is short, of the products of two arrays."""
    parts = np.asarray(a) * np.asarray(b)
    total = parts[..., 0]
    for k in range(1, parts.shape[-1]):
        total = total + parts[..., k]
    return np.asarray(total)


def cross(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """Vector products of (..., 3) vectors: numpy's, to the bit and of the same type, in a fifth of its time."""
    u, v = np.asarray(a), np.asarray(b)
    result = np.empty(np.broadcast_shapes(u.shape, v.shape), np.result_type(u, v))
    (u0, u1, u2), (v0, v1, v2) = ((w[..., 0], w[..., 1], w[..., 2]) for w in (u, v))
    result[..., 0] = u1 * v2 - u2 * v1
    result[..., 1] = u2 * v0 - u0 * v2
    result[..., 2] = u0 * v1 - u1 * v0
    return result


def length(vectors: npt.ArrayLike) -> F64:
    """Euclidean lengths of vectors along the last axis, which is short."""
    return np.asarray(np.sqrt(dot(vectors, vectors)))


def sin_cos(radians: npt.ArrayLike) -> tuple[F64, F64]:
    """Sine and cosine, to about the last digit, of angles up to a million turns."""
    if _is_number(radians):
        turns = float(round(radians * (2.0 / math.pi)))
        return _sin_cos_of(turns, ((radians - turns * _QUARTER_1) - turns * _QUARTER_2) - turns * _QUARTER_3)
    x = np.asarray(radians, dtype=np.float64)
    quarters = np.rint(x * (2.0 / math.pi))
    return _sin_cos(quarters, ((x - quarters * _QUARTER_1) - quarters * _QUARTER_2) - quarters * _QUARTER_3)


def sin_cos_deg(degrees: npt.ArrayLike) -> tuple[F64, F64]:
    """Sine and cosine of angles in degrees; exactly 0 and 1 along the axes."""
    if _is_number(degrees):
        turns = float(round(degrees / 90.0))
        return _sin_cos_of(turns, (degrees - 90.0 * turns) * (math.pi / 180.0))
    x = np.asarray(degrees, dtype=np.float64)
    quarters = np.rint(x / 90.0)
    return _sin_cos(quarters, (x - 90.0 * quarters) * (math.pi / 180.0))


def arctan2(y: npt.ArrayLike, x: npt.ArrayLike) -> F64:
    """Angle of the direction (x, y) from -pi to pi, radians; 0 for (0, 0)."""
    if _is_number(y) and _is_number(x):
        return _arctan2_of(y, x)
    up, ahead = np.asarray(y, dtype=np.float64), np.asarray(x, dtype=np.float64)
    less, more = np.minimum(np.abs(up), np.abs(ahead)), np.maximum(np.abs(up), np.abs(ahead))
    ratio = less / np.where(more == 0.0, 1.0, more)
    is_steep = ratio > _TAN_EIGHTH  # then the angle is 45 degrees less that of a smaller ratio
    ratio = np.where(is_steep, (ratio - 1.0) / (ratio + 1.0), ratio)
    angle = ratio - ratio * _polynomial(ratio * ratio, _ARCTAN)
    angle = np.where(is_steep, math.pi / 4 + angle, angle)
    angle = np.where(np.abs(up) > np.abs(ahead), math.pi / 2 - angle, angle)
    angle = np.where(ahead < 0.0, math.pi - angle, angle)
    return np.asarray(np.copysign(angle, up))


def arccos(cosine: npt.ArrayLike) -> F64:
    """Angle from 0 to pi of a cosine, radians; NaN beyond -1..1."""
    x = np.asarray(cosine, dtype=np.float64)
    return arctan2(np.sqrt((1.0 - x) * (1.0 + x)), x)


def exp(power: npt.ArrayLike) -> F64:
    """The exponential function, to about the last digit, of numbers from -700 to 700."""
    x = np.asarray(power, dtype=np.float64)
    doublings = np.rint(x / 0.6931471805599453)
    rest = (x - doublings * _LOG_2_1) - doublings * _LOG_2_2
    return np.asarray(np.ldexp(_polynomial(rest, _EXP), doublings.astype(np.int32)))


def snapped(values: npt.ArrayLike, step: float = LENGTH_STEP_M) -> F64:
    """The nearest multiples of a step, which is a power of two; never a negative zero.

    Values that differ by rounding come out equal, unless a boundary between two steps lies right between them; decimal
    sizes never lie on one.
    """
    return np.asarray(np.rint(np.asarray(values, dtype=np.float64) / step) * step + 0.0)


# The constants are those of Sun's fdlibm (1993): pi / 2 in three parts, and minimax polynomials.
_QUARTER_1, _QUARTER_2, _QUARTER_3 = 1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21
_SIN = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
_COS = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
_ARCTAN = (
    0.0,
    3.33333333333329318027e-01,
    -1.99999999998764832476e-01,
    1.42857142725034663711e-01,
    -1.11111104054623557880e-01,
    9.09088713343650656196e-02,
    -7.69187620504482999495e-02,
    6.66107313738753120669e-02,
    -5.83357013379057348645e-02,
    4.97687799461593236017e-02,
    -3.65315727442169155270e-02,
    1.62858201153657823623e-02,
)
_LOG_2_1, _LOG_2_2 = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_EXP = tuple(1.0 / math.factorial(n) for n in range(15))
_TAN_EIGHTH = math.sqrt(2.0) - 1.0


_Numbers = Sequence[float]


def _is_number(angle: npt.ArrayLike) -> TypeGuard[float]:
    return isinstance(angle, float | int) and math.isfinite(angle)


def _turned(vector: _Numbers, rows: Sequence[_Numbers]) -> list[float]:
    """A vector multiplied from the left by the first three columns of a matrix."""
    x, y, z = vector
    return [row[0] * x + row[1] * y + row[2] * z for row in rows]


def _sin_cos_of(quarters: float, rest: float) -> tuple[F64, F64]:
    """The same as `_sin_cos`, of single numbers."""
    square = rest * rest
    sine = rest + rest * square * _polynomial_of(square, _SIN)
    half = 0.5 * square
    near = 1.0 - half
    cosine = near + (((1.0 - near) - half) + square * square * _polynomial_of(square, _COS))
    if quarters % 2.0 != 0.0:
        sine, cosine = cosine, sine
    if quarters % 4.0 >= 2.0:
        sine = -sine
    if (quarters + 1.0) % 4.0 >= 2.0:
        cosine = -cosine
    return np.asarray(sine + 0.0), np.asarray(cosine + 0.0)


def _arctan2_of(up: float, ahead: float) -> F64:
    """The same as `arctan2`, of single numbers."""
    less, more = sorted((abs(up), abs(ahead)))
    ratio = less / (more or 1.0)
    is_steep = ratio > _TAN_EIGHTH
    if is_steep:
        ratio = (ratio - 1.0) / (ratio + 1.0)
    angle = ratio - ratio * _polynomial_of(ratio * ratio, _ARCTAN)
    if is_steep:
        angle = math.pi / 4 + angle
    if abs(up) > abs(ahead):
        angle = math.pi / 2 - angle
    if ahead < 0.0:
        angle = math.pi - angle
    return np.asarray(math.copysign(angle, up))


def _sin_cos(quarters: F64, rest: F64) -> tuple[F64, F64]:
    """Sine and cosine of a number of quarter turns and a rest of at most an eighth, radians."""
    square = rest * rest
    sine = rest + rest * square * _polynomial(square, _SIN)
    half = 0.5 * square
    near = 1.0 - half
    cosine = near + (((1.0 - near) - half) + square * square * _polynomial(square, _COS))
    is_odd = quarters % 2.0 != 0.0
    sine, cosine = np.where(is_odd, cosine, sine), np.where(is_odd, sine, cosine)
    sine = np.where(quarters % 4.0 >= 2.0, -sine, sine)
    cosine = np.where((quarters + 1.0) % 4.0 >= 2.0, -cosine, cosine)
    return sine + 0.0, cosine + 0.0


def _polynomial(x: F64, coefficients: tuple[float, ...]) -> F64:
    """coefficients[0] + coefficients[1] x + ..."""
    total = np.full_like(x, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        total = total * x + coefficient
    return total


def _polynomial_of(x: float, coefficients: tuple[float, ...]) -> float:
    total = coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        total = total * x + coefficient
    return total
