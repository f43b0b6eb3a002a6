"""What the adapters of other programs have in common: what is run, in words."""

from peers.packages import version_of
from validation.scenes import features


class ExternalProgram:
    """Another program as a solver; as it stands here, one of rigid boxes that is a package of Python."""

    handles = frozenset({features.PLANE, features.MOVING_BLOCKS})
    program = ""
    package = ""  # of Python
    recipe = ""  # by which it is installed
    model = ""  # how a scene is expressed in it
    settings = ""

    def version(self):
        """Return its version, or that it is not installed."""
        return version_of(self.package)

    @property
    def about(self):
        """What is run, in words."""
        return {
            "program": self.program,
            "version": self.version(),
            "recipe": self.recipe,
            "model": self.model,
            "settings": self.settings,
        }
