# Two commands: `make lab` to learn, `make test` to check. `make` alone says what else there is.

PYTHON ?= python3
.DEFAULT_GOAL := help
.PHONY: help lab test test-all test-fast pythons demo doctor corpus mistakes release hub lock clean notebooks pictures figures

# Nothing of this make is for the programs it starts: a student's own `make` in a notebook is not below it.
unexport MAKEFLAGS MFLAGS MAKELEVEL PORT PYTHON
# Without compiled modules everything starts five times slower.
unexport PYTHONDONTWRITEBYTECODE

# A Python that was asked for by name is used or refused; otherwise the bootstrap may find a better one.
only := $(if $(filter file,$(origin PYTHON)),,--this-python)

# $(call install,group): brings .venv to what the group needs; a tenth of a second if it has it.
install = @$(call bootstrap,$(1))
define bootstrap
if command -v '$(PYTHON)' >/dev/null; then '$(PYTHON)' tools/bootstrap.py $(1) $(only); else \
	echo 'There is no $(PYTHON) here: install Python 3.10 to 3.14 (Debian: `sudo apt install python3-venv`).' >&2; \
	exit 1; fi
endef

help: ## say what there is
	@echo 'make lab [PORT=8888] [PYTHON=python3.12], or:'
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 20

lab: ## open the course in JupyterLab
	$(call install,student)
	@.venv/bin/ros2lab lab $(if $(PORT),--port '$(PORT)')

# Debian's packages come beside Python's, and mypy works beside the tests: each has one core. In a new clone, one
# process compiles the tests before eight would do the same at once.
test: ## run the tests, unit to browser
	@tools/system_commands chromium zsh bwrap=bubblewrap mmdebstrap & debian=$$!; \
	($(call bootstrap,development)); installed=$$?; \
	wait $$debian && exit $$installed
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/lint-imports --no-cache --no-logo
	.venv/bin/codespell README.md CHANGELOG.md CONTRIBUTING.md docs/*.md deploy/*/README.md src/*/README.md robot_*/README.md notebooks/*.ipynb
	.venv/bin/mypy & mypy=$$!; \
	test -e tests/terminal/__pycache__ || .venv/bin/python -m pytest --collect-only -qq >/dev/null; \
	.venv/bin/python -m pytest --numprocesses 8 --dist worksteal $(thorough); tests=$$?; \
	wait $$mypy && exit $$tests

test-all: thorough := --thorough
test-all: test ## run every case of every test

test-fast: ## run the unit tests, which need neither ROS nor a browser
	$(call install,development)
	.venv/bin/python -m pytest tests/unit --numprocesses auto -p no:nbval

pythons: ## try the last commit on every Python from 3.10 to 3.14 that is to be had [ONLY="trixie 3.10"]
	$(call install,development)
	@tools/system_commands bwrap=bubblewrap mmdebstrap
	@.venv/bin/python tools/pythons.py $(ONLY)

demo: ## drive the robot without a browser
	$(call install,student)
	@.venv/bin/ros2lab demo

# When something is broken the doctor is wanted all the more: it runs if it is there at all.
doctor: ## say what is right and wrong with this machine
	-$(call install,student)
	@test -x .venv/bin/ros2lab && .venv/bin/ros2lab doctor

release: ## write the course for nbgrader into nbgrader-course
	$(call install,instructor)
	@.venv/bin/ros2lab course release

# Students cannot write compiled modules here, and without them everything starts five times slower.
hub: ## install JupyterHub for a class on this server; deploy/jupyterhub says how it goes on
	$(call install,hub)
	PATH="$(CURDIR)/.venv/bin:$$PATH" npm ci --prefix deploy/jupyterhub --no-audit --no-fund
	.venv/bin/python -m compileall -q -j 0 .venv/lib src

lock: ## choose the newest packages and write locks/ anew
	$(call install,student)
	@tools/lock

clean: ## remove what was installed and built, never work/
	rm -rf .venv .mypy_cache .ruff_cache .pytest_cache dist
	cd robot_project_ws && rm -rf build install log

notebooks: ## run the worked notebooks and store their outputs
	$(call install,development)
	.venv/bin/python tools/notebooks.py

pictures: ## film the drive that README shows, and photograph the report on a class
	$(call install,development)
	@tools/system_commands chromium
	PICTURES='$(CURDIR)/docs/pictures' .venv/bin/python -m pytest tests/browser/test_drive.py tests/browser/test_class_page.py

corpus: ## grade every submission of the corpus: what it must get, what it got [CASES="form/ hostile/"]
	$(call install,development)
	@tools/system_commands bwrap=bubblewrap
	@PYTHONPATH=tests/grading .venv/bin/python -m corpus $(CASES)

mistakes: ## make beginners' mistakes and judge what diagnose says first [CASES="A05 C52" OF=../other]
	$(call install,development)
	@.venv/bin/python tests/diagnose/more_mistakes.py $(CASES) $(addprefix --of ,$(OF))

figures: ## measure the figures that README quotes
	$(call install,development)
	@tools/system_commands chromium bwrap=bubblewrap
	.venv/bin/python benchmarks/figures.py
