"""Training of networks: data, one trainer for all, weights."""
