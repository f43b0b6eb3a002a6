"""A box that slides on a floor, its contacts stated and found: the example of docs/plane-step.md."""

from dda import ContactSprings, CornerOnEdge, PlaneBlock, PlaneModel, Scheme, solve_plane

floor = PlaneBlock([(-5, -1), (9, -1), (9, 0), (-5, 0)], 2700.0, fixed=True)
box = PlaneBlock([(0, 0.01), (2, 0.01), (2, 1.01), (0, 1.01)], 2700.0, velocity=(3.0, 0.0))
springs = ContactSprings(1e8, shear=4e7, friction=0.4)
scheme = Scheme(0.5, 1.0, 1.0, 1e-3, "consistent")

stated = [CornerOnEdge(1, corner, 0, 2, springs) for corner in (0, 1)]
result = solve_plane(PlaneModel([floor, box], stated, gravity=(0.0, -9.81)), scheme, 300)
assert result.outcome == "completed" and result.velocity[-1, 1, 0] < 2.0

found = solve_plane(PlaneModel([floor, box], gravity=(0.0, -9.81), found=springs), scheme, 300)
assert abs(found.displacement - result.displacement).max() < 1e-9
assert abs(found.energy["balance"]).max() < 1e-9 * found.energy["kinetic"][0]
