"""Chapters: functions of results that return blocks.

Nothing is computed that a study could have kept.
"""
