"""Referring expressions and questions: how many a room owes, and which it gets."""
