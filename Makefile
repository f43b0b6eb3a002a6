# Two commands are the set-up: `make report` and `make test`; both make .venv first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
REPORT := $(VENV)/.report
READY := $(VENV)/.ready
DOCS := $(VENV)/.docs
PEERS := $(VENV)/.peers
MUTANTS := $(VENV)/.mutants
RELEASE := $(VENV)/.release
FIELD_PROBLEMS := locked opening rebound sliding creep rocking column
export OMP_NUM_THREADS ?= 1
# Compiled files are kept: to compile the tests and the packages in every process takes longer than most tests.
PYTEST := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -q

.PHONY: report report-all field gallery test test-all gates lint portable docs bench mutants dist clean

report: $(REPORT)  ## the core study, error against run time, and their PDF, written also when gates fail
	@$(BIN)/dda-validate run core stiff-contact limits stability-small cost; status=$$?; $(BIN)/dda-validate report --out reports/report.pdf && exit $$status

report-all: $(REPORT)  ## every study and one PDF
	@$(BIN)/dda-validate run all; status=$$?; $(BIN)/dda-validate report --out reports/report.pdf && exit $$status

gallery: $(REPORT)  ## the results as a static site with calculators, in reports/gallery; runs the core study if there are none
	@test -d reports/results/studies || $(BIN)/dda-validate run core
	@$(BIN)/dda-validate report --site reports/gallery

# Status 1 is that some answer does not pass, which is a finding.
field: $(PEERS)  ## other people's programs on the problems of blocks, as a PDF; minutes. FIELD='--require yade' insists on one
	@$(BIN)/dda-validate judge installed $(FIELD_PROBLEMS) --beside dda --out reports/field.pdf $(FIELD) || [ $$? -eq 1 ]

test: $(READY)  ## the tests without the long ones, the accuracy gates on first cases among them
	$(PYTEST) -n 2 --dist loadfile -m "not long" tests

test-all: test  ## these, then the long ones: all accuracy gates, all seeded faults, random histories
	$(PYTEST) -n 2 --dist loadfile -m long

gates: $(READY)  ## the accuracy gates alone
	$(PYTEST) -m validation

lint: $(READY)  ## style and types
	$(BIN)/ruff check .
	$(BIN)/lint-imports
	$(BIN)/mypy

portable: $(READY)  ## the tests under other kernels, versions and Pythons, and an installed wheel; says which is red
	$(BIN)/python .ci/portable

docs: $(DOCS)  ## the documentation site, in site/, with the gallery of the results that are there
	$(BIN)/python .ci/site_pages.py
	@if [ -f reports/results/verdicts.json ]; then $(BIN)/dda-validate report --site site/gallery --docs ..; \
	else echo "no results for the gallery: make report, then make docs again"; fi
	@echo site/index.html

bench: $(READY)  ## speed, as ratios in one run against named rivals
	$(BIN)/python reports/bench.py

mutants: $(MUTANTS)  ## a seeded sample of changed code against the short tests of its room; minutes. SAMPLE='--rooms dda' says which
	$(BIN)/python .ci/mutants $(SAMPLE)

dist: $(RELEASE)  ## the archives of a release in dist/, built and checked from the last commit; nothing is published
	$(BIN)/python .ci/dist

clean:
	rm -rf $(VENV) site build dist *.egg-info examples/peers/*.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis reports/results reports/gallery reports/submissions reports/*.pdf

$(REPORT): pyproject.toml constraints.txt
	@$(PYTHON) -c "import ensurepip" 2>/dev/null || { echo "needs the venv module of Python: apt-get install python3-venv"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable '.[report,exact,mesh]' --constraint constraints.txt
	@touch $@

$(READY): $(REPORT)
	$(BIN)/python -m pip install --quiet --editable '.[dev]' --constraint constraints.txt
	@touch $@

$(DOCS): $(READY)
	$(BIN)/python -m pip install --quiet --editable '.[docs]' --constraint constraints.txt
	@touch $@

$(PEERS): $(READY) examples/peers/pyproject.toml
	$(BIN)/python -m pip install --quiet --editable 'examples/peers[pip]' --constraint constraints.txt
	@touch $@

$(MUTANTS): $(READY)
	$(BIN)/python -m pip install --quiet --editable '.[mutants]' --constraint constraints.txt
	@touch $@

$(RELEASE): $(READY)
	$(BIN)/python -m pip install --quiet --editable '.[release]' --constraint constraints.txt
	@touch $@
