"""Error against run time and work: methods refined on three blocks, rivals, orders."""
