"""Kept for what dataset cards say; the datasets live in `remqa_data.datasets.torch_datasets`."""

from remqa_data.datasets.torch_datasets import ExpressionDataset, FrameDataset, RemqaDataset, collate

__all__ = ["ExpressionDataset", "FrameDataset", "RemqaDataset", "collate"]
