"""The PyTorch datasets."""
