"""The studies, a folder each (`validation.suite.folders`), which nothing outside imports.

What two studies share is in `validation.suite` or further below.
"""
