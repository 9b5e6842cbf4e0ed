"""Lets tests import the helpers of this folder, such as `dataset_rows`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
