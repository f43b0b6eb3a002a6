"""A block that slides, in closed form: writes fall.csv, an answer to the problem `sliding`."""

import math

pull = 9.81 * (math.sin(math.radians(28.9)) - math.tan(math.radians(15.0)) * math.cos(math.radians(28.9)))
with open("fall.csv", "w") as table:
    table.write("time [ms];horizontal_displacement_mm\n")
    for n in range(1, 101):
        table.write(f"{10 * n};{1e3 * pull * (0.01 * n) ** 2 / 2}\n")
