"""The last pages, to look things up: words, gates, alarms, parameters and where the numbers come from."""
