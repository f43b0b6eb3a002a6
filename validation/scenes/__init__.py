"""What is simulated: scene files, their tables and what they may state."""
