"""Arrangements of a room: where evidence can be hidden, and what goes there."""
