"""Rigid bodies: what a block of any stiffness tends to, and masses on a penalty contact, for studies and advice."""
