"""Scores what was submitted, by replaying it."""
