"""Where two solvers meet: blocks in the plane beside the bodies that have a step of their own."""
