"""Frames by name: expressions are about frames of whatever split."""

from __future__ import annotations

from pathlib import Path

from remqa_data.datasets.random_access import SplitReader
from remqa_data.errors import UnknownNameError
from remqa_data.storage.manifest import load_manifest


class Frames:
    """Where the frames of a dataset are, in all splits: that of an expression in "val" is in another one.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    """

    def __init__(self, root: Path) -> None:
        readers = [SplitReader(root, "frames", split) for split in load_manifest(root).splits("frames")]
        self._places = {
            name: (reader, row)
            for reader in readers
            for row, name in enumerate(reader.columns(["frame_id"])["frame_id"].to_pylist())
        }

    def __getitem__(self, name: str) -> tuple[SplitReader, int]:
        """The reader that has a frame, and its row there.

        Raises
        ------
        UnknownNameError
            If the dataset has no such frame.
        """
        if name not in self._places:
            raise UnknownNameError("frame", name, self._places)
        return self._places[name]

    def picture(self, name: str) -> memoryview:
        """The picture of a frame, a JPEG or PNG file; errors as above."""
        reader, row = self[name]
        return reader.images(row, ["rgb"])[0]
