"""The study `engines`: rigid boxes on a plane, by every contact engine that is installed."""
