"""Object types, relations and question templates: words and facts, no code."""
