"""Scores by replay, with intervals."""
