"""The PDF report, built from a results directory; no solver is called from here."""
