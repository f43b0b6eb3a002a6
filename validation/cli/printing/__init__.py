"""What commands print: the answer of a run, tables, lists, a scene's page; and the stream that takes it.

What it says was computed by the rooms below. A command's own few lines stay with the command.
"""
