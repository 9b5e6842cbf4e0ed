"""The version of this package, and its day."""

__version__ = "1.0.0"
RELEASED = "2026-11-22"
"""Of this version, for the files of a dataset: they are the same on every day on which they are made."""
TEMPLATES_SHA256 = "73b5e94e9d0fedfc2e3f2d0bf3f123bb147a3c38bfbe7140244df10aeebc4927"
"""Of `templates/` in this version, as `remqa_data.storage.manifest.templates_sha256` has it."""
