"""Chapters: functions of results that return blocks; what a study could have kept is not computed here."""
