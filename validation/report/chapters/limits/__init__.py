"""Chapters of how far steps and springs can be taken: growth of unstable steps, digits lost, stiff contact.

A chapter here reads rows and the data of its study; no solver is called.
"""
