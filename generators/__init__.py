"""Makes the data: rooms, configurations, walks, questions and shards."""
