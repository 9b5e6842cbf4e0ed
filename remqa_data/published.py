"""Figures of the published REMQA dataset, for tables beside one's own.

The paper's agents saw other pictures of these rooms, AI2-THOR's; so their scores are no yardstick for agents here
without care, and stand only in the tables of `remqa-agent`.
"""

from __future__ import annotations

from collections.abc import Mapping

SOURCE = "Sima, Tan and Liu, 2022, arXiv:2210.02709"
BIBTEX = """\
@article{sima2022remqa,
  title = {Embodied Referring Expression for Manipulation Question Answering in Interactive Environment},
  author = {Sima, Qie and Tan, Sinan and Liu, Huaping},
  journal = {arXiv preprint arXiv:2210.02709},
  year = {2022}
}"""
"""How to cite the benchmark."""
QUESTIONS: Mapping[str, Mapping[str, int]] = {
    "train": {"EXISTENCE": 1653, "COUNTING": 647, "SPATIAL": 1083},
    "test": {"EXISTENCE": 324, "COUNTING": 143, "SPATIAL": 222},
}
"""By split and kind."""
MEAN_WORDS: Mapping[str, float] = {"EXISTENCE": 9.5, "COUNTING": 11.8, "SPATIAL": 7.1}
"""Of a question, by kind."""
