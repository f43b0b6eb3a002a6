"""A scene before anything runs: drawing, steps and the numbers that follow, for `show`, the report and the site."""
