"""The PDF report, built from a results directory.

No solver is called from here.
"""
