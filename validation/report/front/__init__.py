"""The pages that are read first: what was tested, the answer, and a practitioner's three decisions.

Rows of results and the closed forms of the gates come in; no solver is called.
"""
