"""Referring expressions and questions as programs: what their words mean, and their answers."""
