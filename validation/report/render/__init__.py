"""Blocks as pages: PDF by typst, HTML by jinja, text for a terminal. Nothing else sets a block."""
