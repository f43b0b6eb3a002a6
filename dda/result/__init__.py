"""What a history is returned in, and what every request must hold to."""
