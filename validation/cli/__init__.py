"""The command line ``dda-validate``, one module a group of commands.

Heavy modules are imported by the command that needs them, so that a help page starts at once.
"""

from validation.cli.entry import main as main
