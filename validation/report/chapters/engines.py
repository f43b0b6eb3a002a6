"""The chapter of the study `engines`: who stands still, who bounces, who gains energy, and at what price."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence
from pathlib import Path

from validation.report.blocks import Blocks, Head, Heading, Paragraph, Table, TableColumn, table
from validation.report.chapters.programs import (
    NONE,
    NONE_INSTALLED,
    NOT_THIS_VERSION,
    about_rows,
    absent_of,
    cells_of,
    installed_of,
)
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, capital, short
from validation.report.figures import histories
from validation.report.figures.engines import LARGEST, LEAST, STAR, engine_figure
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.engines.best import ALIKE, FAMILIES, best_of_family, by_family, reached
from validation.studies.engines.table import EngineCell, EngineTable, Quantity, read
from validation.studies.field.programs import DEFAULT
from validation.studies.field.table import (
    FAIL,
    JUDGED,
    NOT_APPLICABLE,
    NOT_RUN,
    PARTIAL,
    PASS,
    ProblemLine,
    ProgramLine,
)

SETTINGS = {"default": "as it comes", "chosen": "chosen"}  # words for the kind of a program
OWN_CASE = "as titled"
GAIN = "gain of energy"  # in the name of a quantity
CHOSEN = ("chosen", "user")
DEFAULTS = ("default",)
QUESTIONS = (
    ("Who stands still?", ("standing", "pile", "heavy-top")),
    ("Who bounces as asked?", ("restitution",)),
    ("Who keeps the energy?", ("bouncing", "tumbling")),
    ("Who turns and slips as far as it should?", ("toppling", "shaken")),
    ("Who hits as hard as it should?", ("impact",)),
)
METHOD = (
    "Each problem has an exact answer: rigid boxes on a plane, friction by Coulomb's law, restitution by "
    "Newton's. A few numbers are measured on the positions that a program gives, each with a band that one per "
    "cent of the data explains. Each program runs twice: with settings chosen for accuracy, each with its reason, "
    "and as it comes, every setting and the step at the program's own default. What a program cannot express is "
    "not applicable, and is not forced to fit."
)
NOTE = (
    "The number is the largest error over its band: 1 is just allowed. PARTIAL: what is reported passes, and "
    "something else that is asked is withheld; n. a.: not applicable; a dash: no answer; the reasons are given "
    "below."
)
CURVES = (
    "A curve shows the largest error over its band, 1 being just allowed, over the steps of the run and over its "
    "seconds on this machine, for the problem as titled, of some over its first seconds: the program's own step, "
    "halved again and again until a run takes too long. A program has one colour everywhere, and stands before "
    "the grey lines of the other families. The star marks the best of its family: of those that pass the problem, "
    "whoever is within the band of the curve, at this step and all finer ones, in the least time. Times within a "
    f"factor of {ALIKE:g} are taken for equal, since they are of single runs."
)
CAPTION = (
    "Error over what is allowed, over steps and seconds. Hairline: just allowed. Solid: chosen settings; dashed, "
    f"hollow: the program's defaults; grey: the other families;{STAR}: best of its family. Errors are drawn from "
    f"{LEAST:g} to {LARGEST:g}."
)
INVITATION = (
    "Who chooses the settings is no neutral host: a setting that nobody here knew of looks like a weakness of the "
    "program. The adapters are therefore published, a file each, every setting with its reason beside it, and "
    "better ones are invited: change the file, run dda-validate run engines, and send the change, or a folder of "
    "answers that dda-validate judge takes. It needs no other argument than that the verdicts get better."
)
ADAPTERS = "examples/peers/peers"


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: the finding in words, the table, a section for each problem, the programs."""
    engines = read(results)
    if engines is None:
        return [*opening(manifest), Paragraph(NOT_THIS_VERSION)]
    blocks: Blocks = [
        *opening(manifest, results.verdicts(manifest["study"]), counted(engines)),
        Paragraph(METHOD),
        *_part("The finding", findings(engines)),
        *best(engines),
        *_part("Programs and problems", overview(engines)),
        *_part("What is not applicable or gave no answer", absent_of(engines, installed_programs(engines))),
    ]
    for problem in engines.problems:
        blocks += section(engines, problem, directory)
    return [*blocks, *programs(engines)]


def _part(title: str, part: Table) -> Blocks:
    return [Heading(title, 2), part] if part.rows else []


# ---- words --------------------------------------------------------------------------------------------------------


def counted(engines: EngineTable) -> str:
    """Return how many answers pass and fail, with chosen settings and as programs come, in a sentence."""
    installed = installed_programs(engines)
    names = {program.name.removesuffix(DEFAULT) for program in installed if program.kind != "suite"}
    if not names:
        return NONE_INSTALLED
    parts = []
    for words, kinds in (("with chosen settings", CHOSEN), ("as they come", DEFAULTS)):
        verdicts = [cell.verdict for p in installed if p.kind in kinds for cell in cells_of(engines, p)]
        passed = verdicts.count(PASS) + verdicts.count(PARTIAL)
        if judged := passed + verdicts.count(FAIL):
            parts.append(f"{passed} of {judged} answers pass {words}")
    return f"{_count(len(names), 'program')}, {_count(len(engines.problems), 'problem')}: {', '.join(parts)}."


def _count(number: int, word: str) -> str:
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


def findings(engines: EngineTable) -> Table:
    """Return in words which programs answer which questions, with chosen settings and as they come."""
    rows = []
    known = {problem.name for problem in engines.problems}
    for question, names in QUESTIONS:
        names_of_question = [name for name in names if name in known]
        if names_of_question:
            title = f"{question} ({', '.join(names_of_question)})"
            rows.append((title, *(_who_passes(engines, names_of_question, kinds) for kinds in (CHOSEN, DEFAULTS))))
    if any(GAIN in quantity.name for cell in engines.cells.values() for quantity in cell.quantities):
        gains = [_who_gains(engines, kinds) for kinds in (CHOSEN, DEFAULTS)]
        rows.append(("Who gains energy?", *gains))
    heads = [TableColumn(title, "fill") for title in ("Question", "Chosen settings", "As it comes")]
    return table(heads, rows if any(row[1:] != (DASH, DASH) for row in rows) else [])


def _who_passes(engines: EngineTable, problems: Sequence[str], kinds: Collection[str]) -> str:
    """Return who passes all of some problems, who some of them and who none; of what was judged."""
    everything = []
    something = []
    nothing = []
    for program in installed_programs(engines):
        cells = [engines.cells[problem, program.name] for problem in problems]
        judged = [cell for cell in cells if cell.verdict in JUDGED]
        if program.kind not in kinds or not judged:
            continue
        passed = [cell.problem for cell in judged if cell.verdict in (PASS, PARTIAL)]
        title = plain_title(program)
        if len(passed) == len(problems):
            everything.append(title)
        elif passed:
            something.append(f"{title} ({', '.join(passed)})")
        else:
            nothing.append(title)
    parts = ((f"{_all_of(problems)}: ", everything), ("in part: ", something), ("no: ", nothing))
    sentence = ". ".join(capital(words + ", ".join(names)) for words, names in parts if names)
    return f"{sentence}." if sentence else DASH


def _all_of(problems: Sequence[str]) -> str:
    return "yes" if len(problems) == 1 else "in all"


def _who_gains(engines: EngineTable, kinds: Collection[str]) -> str:
    """Return which programs gain more energy than is allowed, and by how much at most."""
    gains = []
    is_judged = False
    for program in installed_programs(engines):
        if program.kind not in kinds:
            continue
        values = []
        for cell in cells_of(engines, program):
            measured = [
                quantity for quantity in cell.quantities if GAIN in quantity.name and quantity.value is not None
            ]
            is_judged = is_judged or bool(measured)
            values += [quantity.value for quantity in measured if quantity.value is not None and quantity.word == FAIL]
        if values:
            gains.append(f"{plain_title(program)} ({_percent(max(values))})")
    if not is_judged:
        return DASH
    return f"{', '.join(gains)}." if gains else "None."


def _percent(share: float) -> str:
    if share > 10:
        return f"{short(1 + share, 2)}\u00a0times"
    return f"{short(100 * share, 2)}\u00a0%"


def plain_title(program: ProgramLine) -> str:
    """Return what people call a program, whatever its settings."""
    return program.title.partition(", as it comes")[0]


# ---- tables -------------------------------------------------------------------------------------------------------


def installed_programs(engines: EngineTable) -> list[ProgramLine]:
    """Return the programs that are there, family by family; one that gave no answer at all is among them."""
    return installed_of(engines, itertools.chain(*by_family(engines).values()))


def overview(engines: EngineTable) -> Table:
    """Return the table of programs by problems: marks, and the largest error over its band."""
    rows: list[tuple[str, ...]] = []
    installed = installed_programs(engines)
    family = ""
    title = ""
    for program in installed:
        if program.family != family:
            family = program.family
            rows.append((FAMILIES[family],))
        name = "" if plain_title(program) == title else plain_title(program)
        title = plain_title(program)
        settings = SETTINGS.get(program.kind, "").replace(" ", "\u00a0")
        rows.append((name, settings, *map(_mark, cells_of(engines, program))))
    missing = [plain_title(p) for p in engines.programs if p not in installed and p.kind != "default"]
    notes = [NOTE, f"Not installed: {', '.join(missing)}."] if missing else [NOTE]
    columns = [TableColumn(problem.name, "outcome") for problem in engines.problems]
    heads: list[Head] = ["Program", "Settings", *columns]
    return table(heads, rows, notes=notes, dense=True)


def _mark(cell: EngineCell) -> str:
    """Return the verdict of a cell with its largest error over its band."""
    if cell.verdict in JUDGED:
        return f"{cell.verdict} {_error(cell)}".rstrip()
    return {NOT_RUN: DASH, NOT_APPLICABLE: NONE}.get(cell.verdict, cell.verdict)


def _error(cell: EngineCell) -> str:
    """Return the error over what is allowed, nothing where an answer has no number."""
    if cell.error is None:
        return ""
    if cell.error > LARGEST:
        return f"> {LARGEST:.0f}"
    return f"< {LEAST:g}" if cell.error < LEAST else short(cell.error, 2)


def outcome(cell: EngineCell) -> str:
    """Return the verdict of a cell with the number that matters."""
    return f"{cell.verdict} {cell.says}".rstrip() if cell.verdict in JUDGED else _mark(cell)


def side_by_side(engines: EngineTable, problem: ProblemLine) -> Table:
    """Return what came out of a problem, with chosen settings and as the programs come, in a line for each program."""
    answers: dict[str, dict[str, str]] = {}
    for program in installed_programs(engines):
        cell = engines.cells[problem.name, program.name]
        place = "default" if program.kind == "default" else "chosen"
        answers.setdefault(plain_title(program), {})[place] = outcome(cell)
    rows = [(title, texts.get("chosen", ""), texts.get("default", "")) for title, texts in answers.items()]
    heads = ("Program", TableColumn("Chosen settings", "outcome"), TableColumn("As it comes", "outcome"))
    return table(heads, rows, dense=True)


def best(engines: EngineTable) -> Blocks:
    """Return the table of the best of each family, and how the curves are read."""
    part = prices(engines)
    return [Heading("The best of each family", 2), Paragraph(CURVES), part] if part.rows else []


def prices(engines: EngineTable) -> Table:
    """Return of each problem with curves the best of each family: who is within the band in the least time."""
    rows = []
    for problem in engines.problems:
        if any(engines.cells[problem.name, program.name].points for program in engines.programs):
            rows.append((problem.name, *(_best(engines, problem.name, family) for family in _families(engines))))
    heads: list[Head] = ["Problem", *(TableColumn(FAMILIES[family], "fill") for family in _families(engines))]
    return table(heads, rows)


def _families(engines: EngineTable) -> list[str]:
    families = []
    for family, programs in by_family(engines).items():
        if family != "suite" and installed_of(engines, programs):
            families.append(family)
    return families


def _best(engines: EngineTable, problem: str, family: str) -> str:
    best = best_of_family(engines, problem, family)
    if best:
        return ", ".join(f"{p.title}: {seconds(point.seconds)}, {point.steps}\u00a0steps" for p, point in best)
    has_curve = any(engines.cells[problem, p.name].points for p in engines.programs if p.family == family)
    return "none" if has_curve else DASH


def seconds(value: float | None) -> str:
    """Return seconds to two digits."""
    return DASH if value is None else f"{short(float(f'{value:.2g}'), 2)}\u00a0s"


# ---- problems -----------------------------------------------------------------------------------------------------


def section(engines: EngineTable, problem: ProblemLine, directory: Path) -> Blocks:
    """Return the section of a problem: what it asks, the curves, what they show, the numbers and their bands."""
    blocks: Blocks = [Heading(f"{capital(problem.name)}: {problem.title}", 2), Paragraph(problem.asks)]
    figure = engine_figure(engines, problem.name)
    if figure is not None:
        blocks.append(histories.saved(figure, directory, f"engines-{problem.name}.svg", CAPTION))
    parts = (side_by_side(engines, problem), curve_findings(engines, problem), bands(engines, problem))
    return [*blocks, *(part for part in parts if part.rows)]


def curve_findings(engines: EngineTable, problem: ProblemLine) -> Table:
    """Return what the curves show, the programs of one finding in a line, with the price of the band."""
    programs_by_finding: dict[str, list[str]] = {}
    for program in installed_programs(engines):
        cell = engines.cells[problem.name, program.name]
        if cell.finding:
            point = reached(cell.points)
            price = "" if point is None else f" ({seconds(point.seconds)})"
            programs_by_finding.setdefault(cell.finding, []).append(program.title + price)
    rows = [(capital(finding), "; ".join(names)) for finding, names in programs_by_finding.items()]
    note = "In brackets: the least time within what is allowed."
    notes = (note,) if any("(" in names for _, names in rows) else ()
    return table((TableColumn("What the curve shows", "fill"), TableColumn("Programs", "fill")), rows, notes=notes)


def bands(engines: EngineTable, problem: ProblemLine) -> Table:
    """Return the numbers that are asked, their exact values and what is allowed, with its reason."""
    cases_by_line: dict[tuple[str, str, str, str], list[str]] = {}
    for program in engines.programs:
        for quantity in engines.cells[problem.name, program.name].quantities:
            name = f"{quantity.name} [{quantity.unit}]" if quantity.unit not in ("", "1") else quantity.name
            line = (capital(name), short(quantity.exact), _allowed(quantity), quantity.reason)
            cases = cases_by_line.setdefault(line, [])
            if quantity.case not in cases:
                cases.append(quantity.case)
    rows = []
    for (name, exact, allowed, reason), cases in cases_by_line.items():
        # A number of one case without words is of the problem itself, or of all its cases together, as a threshold is.
        words = "; ".join(case or OWN_CASE for case in cases) if cases != [""] else ""
        rows.append((name, words, exact, allowed, reason))
    why = TableColumn("Why", "fill")
    if not any(row[1] for row in rows):
        return table(("Asked", "Exact", "Allowed", why), [(row[0], *row[2:]) for row in rows], dense=True)
    return table(("Asked", TableColumn("Case", "fill"), "Exact", "Allowed", why), rows, dense=True)


def _allowed(quantity: Quantity) -> str:
    low, high = quantity.band
    return short(low) if low == high else f"{short(low)} to {short(high)}"


# ---- programs -----------------------------------------------------------------------------------------------------


def programs(engines: EngineTable) -> Blocks:
    """Return what each program says of itself, where its adapter is, and the invitation to do better."""
    rows = []
    for program, is_same, row in about_rows(installed_programs(engines)):
        has_adapter = program.kind in SETTINGS and not is_same
        rows.append((*row, adapter(program.name) if has_adapter else ""))
    if not rows:
        return []
    heads = (
        "Program",
        "Version",
        TableColumn("Model", "fill"),
        TableColumn("Settings", "fill"),
        "Adapter",
    )
    note = f"The adapters are in {ADAPTERS} of this suite's repository."
    return [
        Heading("The programs, and how to better them", 2),
        Paragraph(INVITATION),
        table(heads, rows, notes=(note,)),
    ]


def adapter(name: str) -> str:
    """Return the file of the adapter of a program, in `ADAPTERS`: ``newton.py`` of newton-xpbd-default."""
    return f"{name.partition('-')[0]}.py"
