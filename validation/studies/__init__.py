"""The studies, a folder each; a folder with a ``study.toml`` is one, see `validation.suite.folders`.

A folder is imported by nothing outside of it. What two studies share is in `validation.suite` or further below.
"""
