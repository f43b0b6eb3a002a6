"""The error of bad input, apart from the scenes, so that the command line starts without reading one."""


class SceneError(ValueError):
    """A scene, an option or a file that cannot be used; the text names file, field, rule and value."""
