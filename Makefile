# Every target needs cargo alone. `make` without a target prints the list.
.DEFAULT_GOAL := help
.PHONY: help run test lint bench gate baseline sabotage sabotage-check ci clean-reports

CARGO ?= cargo
SWEEP := $(CARGO) run --release --bin sweep --

help: ## print this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

run: ## the main job: all scenes at gate size, verdict table, report in reports/latest/
	$(CARGO) run --release --bin sweep

test: ## unit, integration and documentation tests
	$(CARGO) test --workspace

lint: ## formatting, clippy and rustdoc, every warning an error
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS=-Dwarnings $(CARGO) doc --workspace --no-deps

bench: ## all benchmarks (see benches/README.md); BENCH=... goes to criterion
	$(CARGO) bench --bench '*' -- $(BENCH)

gate: ## all scenes, verdicts only, JUnit in reports/latest/junit.xml
	$(SWEEP) gate --junit reports/latest/junit.xml

baseline: ## record errors and work of all scenes in reports/baseline.json; prints what changes
	$(SWEEP) baseline

sabotage: ## every seeded defect against every gate, about two minutes; writes docs/SABOTAGE.md
	SABOTAGE_WRITE=1 $(CARGO) test --release --test sabotage -- --ignored --nocapture --test-threads 1

sabotage-check: ## the same, and a failure if a gate catches something else than docs/SABOTAGE.md says
	$(CARGO) test --release --test sabotage -- --ignored --test-threads 1

# One recipe, so that -j cannot reorder it and a failure stops what follows.
ci: ## what has to be green before a merge: lint, test, gate, sabotage, each benchmark once
	$(MAKE) lint
	$(MAKE) test
	$(MAKE) gate
	$(MAKE) sabotage-check
	$(MAKE) bench BENCH=--test

clean-reports: ## remove reports/latest/
	rm -rf reports/latest
