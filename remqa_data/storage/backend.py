"""Where a dataset lies: a folder, or a prefix in a bucket, such as s3://bucket/prefix.

Both keep the same promise: a file appears under its name when it is whole. In a folder it is renamed, in a bucket an
object appears when its upload is complete. Nothing appears together with something else, so what makes a group of files
valid, such as the manifest, is written after them.
"""

from __future__ import annotations

import os
from pathlib import Path

from remqa_data.errors import DatasetError
from remqa_data.files import is_remote, uri_of
from remqa_data.storage.bucket import Bucket
from remqa_data.storage.folder import Folder
from remqa_data.storage.protocol import Storage


def storage_at(root: str | os.PathLike[str]) -> Storage:
    """Where a dataset lies, by its root: a folder, or a URI that pyarrow knows, such as s3://bucket/prefix.

    A Path of a URI will do as well. Credentials, region and endpoint of a bucket come from where pyarrow looks for
    them, for S3 from variables such as AWS_ACCESS_KEY_ID and AWS_ENDPOINT_URL, and from ~/.aws.

    Raises
    ------
    DatasetError
        For a folder that is given as a URI.
    """
    uri = uri_of(root)
    if uri.startswith("file:///"):
        path = uri.removeprefix("file:///").removeprefix("localhost/")
        raise DatasetError(f"{uri}: give the folder by its path, /{path}")
    return Bucket(uri) if is_remote(root) else Folder(Path(root))
