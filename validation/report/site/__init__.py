"""Results, and judged answers, as static sites that work from their files; no solver is called, no network asked."""
