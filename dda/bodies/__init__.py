"""Each body: what it is, its modes and rows of contact, and its histories; what only it has."""
