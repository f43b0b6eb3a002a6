"""What a linear body answers at rest, by its modes and under a steady vibration, whatever body it is."""
