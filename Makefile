# Two commands on a fresh clone: `make validate` and `make test`.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
# tests and types share the cores; a benchmark or a campaign takes them alone
JOBS   ?= 2
# tests start some hundred processes: compiled sources are kept, or each of them would compile them again
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help venv validate test lint oldest faults campaign papers integrators referee dh bench docs wheel clean

help:            ## print the targets
	@grep -E '^[a-z]+: *[^#]*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*##/\t/' | expand -t 14

venv: $(STAMP)   ## the environment, with everything in it

$(STAMP): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $(STAMP)

validate: $(STAMP)   ## validate panda against Pinocchio; the report is in out/
	$(BIN)/dualpin validate panda --samples 1000 --out out

# what says within a minute whether a change broke something
QUICK  := tests/call tests/model tests/algorithms/test_identities.py tests/cli/test_cli.py \
          tests/test_dual.py tests/test_layering.py tests/test_scalars.py tests/test_shapes.py
.PHONY: quick
quick: $(STAMP) lint ## style, types and the unit tests: under a minute
	$(BIN)/python -m pytest -n $(JOBS) --dist loadfile $(QUICK)

test: $(STAMP) quick ## everything but the long campaigns
	$(BIN)/python -m pytest -n $(JOBS) --dist loadfile $(QUICK:%=--ignore=%)

lint: $(STAMP)       ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy --num-workers $(JOBS)

oldest: $(STAMP)     ## the smoke tests with the lowest versions that pyproject.toml admits
	$(BIN)/python -m tests.smoke.lowest exact integrators > .oldest.txt
	$(PYTHON) -m venv .venv-oldest
	.venv-oldest/bin/python -m pip install --quiet --editable '.[exact,integrators]' pytest --constraint .oldest.txt
	.venv-oldest/bin/python -m pytest -c tests/smoke/pytest.ini --rootdir . --confcutdir tests/smoke tests/smoke

# PyTorch brings a gigabyte, so it has an environment of its own; make torch TORCH_FROM='--index-url URL' takes another build
TORCH_FROM ?=
.PHONY: torch
torch:               ## the tests and the example that need PyTorch
	$(PYTHON) -m venv .venv-torch
	.venv-torch/bin/python -m pip install --quiet torch $(TORCH_FROM)
	.venv-torch/bin/python -m pip install --quiet --editable '.[dev,torch]'
	.venv-torch/bin/python -m pytest tests/test_torch.py tests/examples -k torch

campaign: $(STAMP)   ## the long tests, and every robot: writes validation/results
	$(BIN)/python -m pytest -m campaign --timeout 5400
	$(BIN)/python -m validation.campaign

papers: $(STAMP)     ## the papers' tables, examples and claims: writes validation/papers
	$(BIN)/python -m validation.papers

integrators: $(STAMP) ## the study of integrators: writes validation/integrators
	$(BIN)/python -m validation.integrators

referee: $(STAMP)    ## libraries judged on twenty robots: writes validation/referee
	$(BIN)/python -m validation.referee

.PHONY: mutants
mutants: $(STAMP)    ## mistakes by mutation, and whether a hypothesis predicts them: writes validation/referee
	$(BIN)/python -m validation.referee.mutants

dh: $(STAMP)         ## all chains of all robots to DH and screws: writes validation/dh
	$(BIN)/python validation/dh/campaign.py

fuzz: $(STAMP)       ## random robots, hours of them, resumable: writes out/fuzz
	$(BIN)/dualpin fuzz --robots 100000 --seed 7 --store out/fuzz.sqlite --out out/fuzz

zoo: $(STAMP)        ## any folder of URDFs, DIR=..., read and validated by both libraries: writes out/zoo
	$(BIN)/python -m validation.zoo $(DIR) --out out/zoo

faults: $(STAMP)     ## what check finds in a folder of URDFs, DIR=..., or in the robots of example-robot-data
	$(BIN)/python -m validation.check $(DIR)

bench: $(STAMP)      ## speed beside Pinocchio: writes validation/benchmarks
	$(BIN)/python -m validation.benchmarks

.PHONY: bench-frameworks
bench-frameworks: torch ## gradients in PyTorch and JAX beside adam, frax and autograd: writes validation/benchmarks
	.venv-torch/bin/python -m pip install --quiet adam-robotics frax
	.venv-torch/bin/python -m validation.benchmarks.frameworks

.PHONY: bench-peers
bench-peers: $(STAMP) ## speed beside every library whose environment is there: writes validation/benchmarks/peers
	$(BIN)/python -m validation.benchmarks.peers

.PHONY: bench-everyday
bench-everyday: $(STAMP) ## plain calls, large results, single calls, cold starts; AGAINST=a checkout to compare with
	$(BIN)/python -m validation.benchmarks.everyday $(if $(AGAINST),--against $(AGAINST))

docs: $(STAMP)       ## the documentation, into site/; a warning is an error
	$(BIN)/python docs/build.py
	@echo "open site/index.html, or serve it: python -m http.server -d site"

.PHONY: asv
asv: $(STAMP)        ## speed of this commit for the record over versions: writes benchmarks/asv/results
	$(BIN)/python -m pip install --quiet asv
	$(BIN)/python benchmarks/asv/record.py

wheel: $(STAMP)      ## build the wheel and the source distribution
	$(BIN)/python -m build

clean:               ## remove the environment and what was built
	rm -rf $(VENV) .venv-torch .venv-oldest .oldest.txt build dist out site
