"""What a finished dataset must be: each table's checks in a module of their own."""
