"""The gallery: a results directory as one static site that works from a file, with calculators.

Templates and figures come in, the results too; no solver is called and no network is asked.
"""
