"""CalculiX (ccx), the finite-element program, as a solver: implicit dynamics of constrained solid elements.

The block of one strain is a fully integrated C3D8 of unit thickness whose two faces move alike and whose corners keep
to an affine map (u1 - u2 + u3 - u4 = 0): its consistent mass is that of the block, and so is its stiffness. Locked
corners are SPRING2 elements. Unilateral corners are node-to-surface penalty contact of the base's nodes with a face
that moves as the base does, pressure-overclosure LINEAR with slope 2p / length and friction with a stick slope
2 p_s / length, which is the law of DDA's corners. A column is a stack of C3D8 that is guided sideways.
"""

from peers.calculix_deck import RECIPE, Stopped, refuse, run, version
from peers.programs import ExternalProgram

BLOCK, COLUMN = 3000, 1000  # increments of a run, so that it takes some ten seconds
TRIES = 3  # runs with ever halved increments before one that does not converge is given up
HANDLED = frozenset(
    [
        *("off-centre load", "own weight", "base motion", "unilateral contact", "friction", "slope", "large rotation"),
        *("column", "implicit contact", "energy-conserving contact"),  # the last two are DDA's steps, as alpha is
    ]
)
MODEL = "one C3D8 kept affine by equations, penalty contact of its nodes; a column of C3D8 on dashpots"


class CalculiX(ExternalProgram):
    """CalculiX with settings chosen for accuracy: average acceleration at small increments."""

    program = "CalculiX"
    recipe = RECIPE
    model = MODEL
    handles = HANDLED
    settings = f"average acceleration (ALPHA=0), {BLOCK} increments (columns {COLUMN}), forces to 1e-6"
    accurate = True

    def version(self):
        """Return the version of the program."""
        return version()

    def solve(self, scene):
        """Run a scene; a run that ccx gives up is made again with half the increments.

        Raises
        ------
        NotImplementedError
            CalculiX cannot express the scene, or is not installed.
        Stopped
            ccx gave the last try up.
        """
        refuse(scene.damping.present, "CalculiX has no Rayleigh damping in direct integration")
        sub = self.increments(scene)
        for attempt in range(TRIES if self.accurate else 1):
            try:
                return self._solved(scene, sub * 2**attempt)
            except Stopped as error:
                last = error
        raise last

    def increments(self, scene):
        """Return the increments of a step."""
        return max(2, (BLOCK if scene.column is None else COLUMN) // scene.time.steps)

    def _solved(self, scene, sub):
        from peers.calculix_block import block_columns, block_deck
        from peers.calculix_column import column_columns, column_deck

        if scene.column is not None:
            return column_columns(scene, run(column_deck(scene, sub), self.accurate))
        return block_columns(scene, run(block_deck(scene, sub), self.accurate)[:, :, :2])


class AsItComes(CalculiX):
    """CalculiX as it comes: HHT with alpha = -0.05, in the scene's steps."""

    settings = "HHT (ALPHA=-0.05) in the steps of the scene, convergence as it comes"
    accurate = False

    def increments(self, scene):
        """Return the increments of a step, which is one."""
        return 1
