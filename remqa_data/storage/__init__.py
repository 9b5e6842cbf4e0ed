"""Where datasets lie: shards, manifest, dataset card, parts of unfinished ones, locks."""
