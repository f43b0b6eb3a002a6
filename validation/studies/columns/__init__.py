"""Columns whose contacts open or slip."""
