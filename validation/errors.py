"""The error of bad input, apart from everything else, so that the command line starts without reading a scene."""


class InputError(ValueError):
    """A scene, an option or a file that cannot be used; the text names file, field, rule and value."""


SceneError = InputError  # its name in version 0.1
