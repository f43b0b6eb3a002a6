"""One block on its contact under a load: the tables `[block]`, `[contact]` and `[load]`, which all rooms know."""
