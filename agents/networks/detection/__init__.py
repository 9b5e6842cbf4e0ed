"""Finding objects in pictures: what all networks that look at views are built upon."""
