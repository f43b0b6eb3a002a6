"""What starts first: the command and the pytest plug-in.

An install holds this folder twice: as `validation.entry`, and as the top-level package `dda_validation`, which
`dda-validate` and pytest load. That name is nobody else's, so that this code runs, and says what is wrong, where a
folder of the user's with a name as common as `validation` comes first on Python's path.
"""
