"""Pictures of rooms and samples."""
