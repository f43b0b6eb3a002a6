"""What comes out of a solver: histories, outcomes, modes, and the results directory that keeps them."""
