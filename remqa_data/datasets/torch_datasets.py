"""The PyTorch datasets: questions, frames and referring expressions, map-style and lazily decoded.

They work with any number of DataLoader workers, forked or spawned. `remqa_data.datasets.sample_types` says what a sample holds.
"""

from __future__ import annotations

import operator
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from remqa_data.datasets.frames import Frames
from remqa_data.datasets.random_access import SplitReader
from remqa_data.datasets.sample_types import RAGGED, ExpressionSample, FrameSample, QuestionSample
from remqa_data.errors import ConfigError, DatasetError, ForgedRowError, ImageFormatError, UnknownNameError
from remqa_data.extras import require
from remqa_data.tables.images import decode_depth, decode_instances, decode_rgb
from remqa_data.tables.rows import KINDS
from remqa_data.tables.schema import table_spec

if TYPE_CHECKING:
    import torch
    from torch.utils.data import Dataset, default_collate
else:
    torch = require("torch", "torch")
    Dataset = require("torch.utils.data", "torch").Dataset
    default_collate = require("torch.utils.data", "torch").default_collate

Sample = TypeVar("Sample", QuestionSample, FrameSample, ExpressionSample)


class _TableDataset(Dataset[Sample], Generic[Sample]):
    """What the three share; `table` is the table whose rows they are, `image_table` the one with the images."""

    table: str
    image_table: str

    def __init__(
        self,
        root: str | Path,
        split: str,
        transform: Callable[[Sample], Any] | None,
        columns: Sequence[str] | None,
        images: Sequence[str] | None,
    ) -> None:
        self.root, self.split = Path(root), split
        self.transform: Callable[[Sample], Any] | None = transform
        spec, image_spec = table_spec(self.table), table_spec(self.image_table)
        plain = [name for name in spec.schema.names if name not in spec.image_columns]
        self.columns = _known("columns", columns, plain, "images", image_spec.image_columns)
        self.images = _known("images", images, image_spec.image_columns, "columns", plain)
        self._reader = SplitReader(self.root, self.table, split)
        self._rows: Sequence[int] = range(len(self._reader))
        self._loaded: dict[str, _Values] | None = None

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Sample]:
        """All samples; an IndexError of a transform ends in an error, where Python would take it for the end."""
        return (self[index] for index in range(len(self)))

    def __getitem__(self, index: int) -> Sample:
        row = self._row(index)
        if self._loaded is None:
            arrays = self._reader.columns(self.columns)
            self._loaded = {k: v for name in self.columns for k, v in _all_values(name, arrays[name]).items()}
        sample = JoinedByCollate({name: values(row) for name, values in self._loaded.items()})
        if self.images:
            reader, image_row = self._image_place(row)
            for name, data in zip(self.images, reader.images(image_row, self.images), strict=True):
                try:
                    sample[name] = _image(name, data)
                except ImageFormatError as error:
                    raise ForgedRowError(*reader.where(image_row), name, str(error)) from None
        typed = cast("Sample", sample)
        return typed if self.transform is None else cast("Sample", self.transform(typed))

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_loaded": None}  # a worker reads its own, which is faster than to send them

    def _image_place(self, row: int) -> tuple[SplitReader, int]:
        """Where the images of a row are."""
        return self._reader, row

    def _row(self, index: int) -> int:
        try:
            return self._rows[operator.index(index)]
        except TypeError:
            name = type(self).__name__
            msg = f"{name}[{index!r}]: give one whole number; torch.utils.data.Subset takes several"
            raise TypeError(msg) from None
        except IndexError:
            raise IndexError(f"sample {index} of {len(self)}") from None


class RemqaDataset(_TableDataset[QuestionSample]):
    """Questions, with the views before and after the manipulation.

    Parameters
    ----------
    root : path
        Folder of a finished dataset.
    split : str
        "train" or "test".
    kind : str, optional
        Only "EXISTENCE", "COUNTING" or "SPATIAL".
    transform : callable, optional
        Gets each sample and returns what is to be yielded instead. With spawned workers it must be picklable.
    columns : sequence of str, optional
        Columns to yield besides the images; all by default. They are held in memory.
    images : sequence of str, optional
        Images to decode, such as ("start_rgb", "end_rgb"); all six by default, () for none.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, or has no such split.
    DamagedShardError
        When what is read is not as it was written: names the file, row group and column.
    ForgedRowError
        When a value that is read is none, not finite, or beyond `remqa_data.limits`: names the file, row and field.
    UnknownNameError
        For a kind, column or image that does not exist.
    ConfigError
        For a column or image that is named twice.
    TypeError
        If what should be a list of names is one text.
    """

    table = image_table = "questions"

    def __init__(
        self,
        root: str | Path,
        split: str,
        kind: str | None = None,
        transform: Callable[[QuestionSample], Any] | None = None,
        *,
        columns: Sequence[str] | None = None,
        images: Sequence[str] | None = None,
    ) -> None:
        super().__init__(root, split, transform, columns, images)
        if kind is not None:
            if kind not in KINDS:
                raise UnknownNameError("kind", kind, KINDS)
            kinds = self._reader.columns(["kind"])["kind"].to_pylist()
            self._rows = [row for row, of_row in enumerate(kinds) if of_row == kind]


class FrameDataset(_TableDataset[FrameSample]):
    """Frames of the walks, with the visible objects; see `RemqaDataset` for parameters and errors.

    The column "objects" becomes the keys object_ids, object_types, boxes_2d, boxes_3d, pixels, distances_m and
    openness.
    """

    table = image_table = "frames"

    def __init__(
        self,
        root: str | Path,
        split: str,
        transform: Callable[[FrameSample], Any] | None = None,
        *,
        columns: Sequence[str] | None = None,
        images: Sequence[str] | None = None,
    ) -> None:
        super().__init__(root, split, transform, columns, images)


class ExpressionDataset(_TableDataset[ExpressionSample]):
    """Referring expressions with the image of their frame; see `RemqaDataset` for parameters and errors.

    Splits are "train", "val" and "test". Only "rgb" is decoded by default; "depth" and "instances" can be asked for.
    """

    table, image_table = "expressions", "frames"

    def __init__(
        self,
        root: str | Path,
        split: str,
        transform: Callable[[ExpressionSample], Any] | None = None,
        *,
        columns: Sequence[str] | None = None,
        images: Sequence[str] | None = ("rgb",),
    ) -> None:
        super().__init__(root, split, transform, columns, images)
        self._places: list[tuple[SplitReader, int]] = []
        if self.images:
            frames = Frames(self.root)
            self._places = [frames[name] for name in self._reader.columns(["frame_id"])["frame_id"].to_pylist()]

    def _image_place(self, row: int) -> tuple[SplitReader, int]:
        return self._places[row]


def collate(samples: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Join samples into a batch; a `DataLoader` does it of itself, unless a transform returns something else.

    Tensors and arrays are stacked, numbers become a tensor, and PyTorch's `default_collate` joins dicts and tuples; texts,
    lists and tensors of variable length (`remqa_data.datasets.sample_types.RAGGED`) become a list with one entry for each
    sample.

    Raises
    ------
    ValueError
        If there are no samples.
    """
    if not samples:
        msg = "collate() needs one sample at least"
        raise ValueError(msg)
    return {key: _collated(key, [sample[key] for sample in samples]) for key in samples[0]}


class JoinedByCollate(dict[str, Any]):
    """A sample; PyTorch's `default_collate` joins such samples with `collate`, and what transforms copy and add to, too."""

    def copy(self) -> JoinedByCollate:
        """The same sample."""
        return JoinedByCollate(self)

    def __or__(self, other: dict[str, Any]) -> JoinedByCollate:  # type: ignore[override]
        return JoinedByCollate({**self, **other})

    def __ror__(self, other: dict[str, Any]) -> JoinedByCollate:  # type: ignore[override]
        return JoinedByCollate({**other, **self})


def _join(samples: Sequence[JoinedByCollate], *, collate_fn_map: Any = None) -> dict[str, Any]:
    return collate(samples)


# The way to extend `default_collate` that its documentation names.
require("torch.utils.data._utils.collate", "torch").default_collate_fn_map[JoinedByCollate] = _join


_Values = Callable[[int], Any]


def _known(
    parameter: str, names: Sequence[str] | None, known: Sequence[str], other: str, known_there: Sequence[str]
) -> tuple[str, ...]:
    """The names that a parameter was given, all by default; `other` is the parameter for those `known_there`."""
    if isinstance(names, str):
        raise TypeError(f"{parameter}={names!r}: give a list, [{names!r}]")
    chosen = tuple(known if names is None else names)
    for name in chosen:
        if name in known_there and name not in known:
            raise ConfigError(f"{parameter}: {name!r} is one of {other}: name it there, {other}=[{name!r}]")
        if name not in known:
            raise UnknownNameError(f"name in {parameter}", name, known)
        if chosen.count(name) > 1:
            raise ConfigError(f"{parameter}: {name!r} is named {chosen.count(name)} times")
    return chosen


def _collated(key: str, values: list[Any]) -> Any:
    if key in RAGGED or any(value is None or isinstance(value, str) for value in values):
        return values
    if isinstance(values[0], np.ndarray | np.generic):
        values = [torch.as_tensor(value) for value in values]
    if isinstance(values[0], torch.Tensor):
        if len(shapes := {tuple(value.shape) for value in values}) > 1:
            raise DatasetError(f"{key}: samples of several shapes cannot be one batch: {sorted(shapes)}")
        return torch.stack(values)
    return default_collate(values) if isinstance(values[0], Mapping | tuple | int | float) else values


def _image(name: str, data: memoryview) -> torch.Tensor:
    if name.endswith("rgb"):
        return torch.from_numpy(decode_rgb(data)).permute(2, 0, 1)
    if name.endswith("depth"):
        return torch.from_numpy(decode_depth(data))
    return torch.from_numpy(decode_instances(data).astype(np.int32))


def _all_values(name: str, column: pa.ChunkedArray) -> dict[str, _Values]:
    """For each key that a column becomes, what gives its value for a row."""
    pieces = [_values(name, chunk) for chunk in column.chunks]
    starts = list(accumulate((len(chunk) for chunk in column.chunks[:-1]), initial=0))

    def of(key: str) -> _Values:
        def value(row: int) -> Any:
            piece = bisect_right(starts, row) - 1
            return pieces[piece][key](row - starts[piece])

        return value

    return {key: of(key) for key in pieces[0]}


def _values(name: str, array: pa.Array) -> dict[str, _Values]:
    """The same for rows of one array."""
    if name in ("agent", "initial_pose"):
        return {name: _tensors(_poses(array))}
    if name == "goal_poses":
        return {name: _ragged_tensors(_poses(array.flatten()), array)}
    if name in ("box_2d", "start_target_box_2d"):
        boxes = np.full((len(array), 4), -1, dtype=np.int64)
        boxes[array.is_valid().to_numpy(zero_copy_only=False)] = _matrix(array, np.int64)
        return {name: _tensors(boxes)}
    if name == "objects":
        flat = array.flatten()
        return {
            "object_ids": _ragged_texts(flat.field("id"), array),
            "object_types": _ragged_texts(flat.field("type"), array),
            "boxes_2d": _ragged_tensors(_matrix(flat.field("box_2d"), np.int64), array),
            "boxes_3d": _ragged_tensors(_matrix(flat.field("box"), np.float32, 6), array),
            "pixels": _ragged_tensors(_vector(flat.field("pixels"), np.int64), array),
            "distances_m": _ragged_tensors(_vector(flat.field("distance_m"), np.float32), array),
            "openness": _ragged_tensors(_vector(flat.field("openness"), np.float32), array),
        }
    return {name: lambda row: array[row].as_py()}


def _poses(array: pa.StructArray) -> npt.NDArray[Any]:
    """(n, 5) float32: x, y, z, yaw_deg, horizon_deg."""
    angles = [_vector(array.field(name), np.float32)[:, None] for name in ("yaw_deg", "horizon_deg")]
    return np.hstack([_matrix(array.field("position"), np.float32, 3), *angles])


def _matrix(array: pa.ListArray, dtype: Any, width: int = 4) -> npt.NDArray[Any]:
    return _vector(array.flatten(), dtype).reshape(-1, width)


def _vector(array: pa.Array, dtype: Any) -> npt.NDArray[Any]:
    return np.asarray(array.to_numpy(zero_copy_only=False), dtype=dtype)


def _tensors(rows: npt.NDArray[Any]) -> _Values:
    return lambda row: torch.from_numpy(rows[row].copy())


def _ragged_tensors(items: npt.NDArray[Any], lists: pa.ListArray) -> _Values:
    ends = _ends(lists)
    return lambda row: torch.from_numpy(items[ends[row] : ends[row + 1]].copy())


def _ragged_texts(items: pa.Array, lists: pa.ListArray) -> _Values:
    ends = _ends(lists)
    return lambda row: items[ends[row] : ends[row + 1]].to_pylist()


def _ends(lists: pa.ListArray) -> list[int]:
    return list(np.cumsum([0, *lists.value_lengths().to_pylist()]).tolist())
