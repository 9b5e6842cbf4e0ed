"""Materials, textures and pictures."""
