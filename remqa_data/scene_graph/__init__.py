"""Objects are nodes, relations between them are edges."""
