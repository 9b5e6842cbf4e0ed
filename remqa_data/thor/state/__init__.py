"""What AI2-THOR's actions act on and what they answer with: simulator, agent, cameras, metadata, events."""
