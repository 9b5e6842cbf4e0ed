"""The pictures of frames, which referring expressions are about, by the frames' names."""

from __future__ import annotations

from pathlib import Path

from remqa_data.datasets.random_access import SplitReader
from remqa_data.errors import UnknownNameError
from remqa_data.storage.manifest import load_manifest


class FramePictures:
    """Encoded RGB pictures of a dataset's frames, of whatever split they are in.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    """

    def __init__(self, root: Path) -> None:
        self._readers = [SplitReader(root, "frames", split) for split in load_manifest(root).splits("frames")]
        self._places = {
            name: (number, row)
            for number, reader in enumerate(self._readers)
            for row, name in enumerate(reader.columns(["frame_id"])["frame_id"].to_pylist())
        }

    def __getitem__(self, name: str) -> memoryview:
        """The picture of a frame, a JPEG or PNG file.

        Raises
        ------
        UnknownNameError
            If the dataset has no such frame.
        """
        if name not in self._places:
            raise UnknownNameError("frame", name, self._places)
        number, row = self._places[name]
        return self._readers[number].images(row, ["rgb"])[0]
