"""The version of this package, and its day."""

__version__ = "1.0.0"
RELEASED = "2026-11-22"
"""Of this version, for the files of a dataset: they are the same on every day on which they are made."""
TEMPLATES_SHA256 = "69448f88695e6c8642e2916cb98db3fcf53476ebd5d4ca784dbaf1af10f1943e"
"""Of `templates/` in this version, as `remqa_data.storage.manifest.templates_sha256` has it."""
