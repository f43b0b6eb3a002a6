"""Columns as wave guides, joints, transmitting bases, a site."""
