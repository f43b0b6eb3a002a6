"""The block in sixty-digit arithmetic, which shares no step with the solvers that it judges."""
