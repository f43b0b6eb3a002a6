"""A user's solver that does what the title of its scene names, so that one process does many things in a row."""

import importlib


class Named:
    """Solve as ``module:attribute`` of the title, which stands for what it reports as well."""

    handles = frozenset({"unilateral contact", "base motion"})

    def _found(self, scene):
        module, _, attribute = scene.title.partition(":")
        found = getattr(importlib.import_module(module), attribute)
        return found() if isinstance(found, type) else found

    def _part(self, name, scene):
        part = getattr(self._found(scene), name, None)
        if part is None:
            raise NotImplementedError
        return part(scene)

    def solve(self, scene):
        found = self._found(scene)
        return getattr(found, "solve", found)(scene)

    def static(self, scene):
        return self._part("static", scene)

    def modes(self, scene):
        return self._part("modes", scene)
