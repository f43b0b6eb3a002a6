"""A base that carries no tension: its points on the elements, and the contact forces of one step.

No history comes in.
"""
