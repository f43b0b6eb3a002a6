"""Rigid bodies: adapters of what a block of any stiffness tends to, and of masses on a penalty contact.

Impacts, the sliding block, the rocking block; thin functions of plain numbers and scenes, for studies and advice.
"""
