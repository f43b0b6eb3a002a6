"""The register of claims of the literature on schemes, contacts and boundaries, each put to a test of ours."""
