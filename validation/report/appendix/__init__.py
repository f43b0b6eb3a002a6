"""The last pages: words, gates, alarms, parameters and where the numbers come from.

What a reader looks up and does not read; rows and verdicts come in.
"""
