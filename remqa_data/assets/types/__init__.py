"""One function for each object type, by where things of the type are found."""
