# The one place that knows how softkin is set up, built, run and tested. `make` alone lists what there is.

SETUP ?= scripts/setup.sh
CLANG_FORMAT ?= $(or $(shell command -v clang-format-14),clang-format)
ifneq ($(shell command -v ccache),)
export CMAKE_CXX_COMPILER_LAUNCHER ?= ccache
# or it takes no file with a precompiled header
export CCACHE_SLOPPINESS ?= pch_defines,time_macros
# so that another clone finds what this one compiled
export CCACHE_BASEDIR ?= $(CURDIR)
endif
export CTEST_OUTPUT_ON_FAILURE = 1
# where tests that cannot run here write down why (tests/support/main.cpp, python/tests/conftest.py); with
# SOFTKIN_NO_SKIP=1, as in .ci/run, they fail, but for those of data that are not in the repository
export SOFTKIN_SKIPPED := $(CURDIR)/build-tests/skipped.txt
# three quarters of gcc 12's time to compile, and kernels that are faster; looked for when it has been installed
ifneq ($(filter default undefined,$(origin CXX)),)
export CXX = $(shell command -v clang++ || echo c++)
endif

cores := $(shell nproc)
sources = $(shell find src apps bench tests examples python -name '*.cpp' -o -name '*.hpp')
RUNS ?= 20000
PYTHON ?= python3
example := examples/pneumatic_finger
# without `large`, which takes long and up to 24 GiB
BENCH ?= iteration factor tracking newton
# tested under the address and undefined-behaviour sanitizers too; large modules with some files only (tests/CMakeLists.txt)
sanitized := core model io statics kinematics drive runs view
empty :=
sanitized_pattern = ^($(subst $(empty) $(empty),|,$(strip $(sanitized))))$$

.PHONY: help setup build run python docs bench paper random fuzz format format-check tidy clean
.PHONY: test begin-tests setup-tests test-release test-page test-python
.PHONY: test-deep setup-tests-deep test-release-deep test-page-deep test-sanitize test-threads test-fuzz
.PHONY: test-python-deep test-arm
# one after the other: each of them uses every core
.NOTPARALLEL:

help:
	@echo 'make run           install what is missing, build, and bend the example finger by both formulations'
	@echo 'make test          install what is missing, build, and test the release build, the page and Python: in short'
	@echo 'make test-deep     the tests that take longer: every command of the documents, sanitizers, fuzzing, notebooks, benchmarks'
	@echo 'make test-arm      build for aarch64, and run the tests of core, linear, energy and contact under qemu'
	@echo 'make build         build build/softkin'
	@echo 'make python        install what is missing, and the Python package in build-python (docs/python.md)'
	@echo 'make docs          the documentation as a site, build-docs/site/index.html, its links checked; with robots to bend'
	@echo 'make fuzz          2 million damaged inputs to every reader (hours; goes on where it was); RUNS=1000 less'
	@echo 'make bench         build and run the benchmarks (docs/benchmarks.md); BENCH="newton large" runs these alone'
	@echo 'make random        solve 20,000 random robots and check every answer; RUNS=1000 fewer of them'
	@echo 'make paper         the tables and figures of the paper beside what softkin gives, out/paper/index.html; PART="fig9 fig13"'
	@echo 'make format        format the sources; make format-check only looks'
	@echo 'make tidy          read all sources for defects and needless work (clang-tidy, .clang-tidy); a quarter of an hour'
	@echo 'make clean         remove the build folders'

setup:
	@$(SETUP)

build: setup
	cmake --preset release -DSOFTKIN_TESTS=OFF -DSOFTKIN_BENCH=OFF
	cmake --build --preset release --target softkin_cli

run: build
	@mkdir -p out
	build/softkin fk $(example)/pneumatic_finger.yaml --path $(example)/path.csv -o out/pneumatic_finger.pvd \
	  --image out/pneumatic_finger.png --report out/pneumatic_finger.json
	build/softkin fk $(example)/pneumatic_finger.yaml --path $(example)/path.csv --formulation target-shape \
	  -o out/target_shape.pvd --image out/target_shape.png --report out/target_shape.json
	build/softkin fk $(example)/pneumatic_finger.yaml --path $(example)/path.csv --formulation target-shape \
	  --solver local-global --report out/local_global.json
	@echo
	build/softkin compare out/pneumatic_finger.json out/target_shape.json out/local_global.json \
	  --turn tip end --poses 90 180 240
	@echo
	@echo "A kinematic map of the finger, for a page on which it can be bent by hand:"
	build/softkin map $(example)/pneumatic_finger.yaml -o out/pneumatic_finger.skmap --check 10
	build/softkin fk $(example)/pneumatic_finger.yaml --path $(example)/path.csv --map out/pneumatic_finger.skmap --polish \
	  --html out/pneumatic_finger.html
	@echo
	@echo "Turn is the bend of the finger's tip. Open next:"
	@echo "  out/pneumatic_finger.html                          bend the finger in a browser (a page of one file, offline)"
	@echo "  out/pneumatic_finger.png, out/target_shape.png     the finger in its last pose, by both formulations"
	@echo "  out/pneumatic_finger.pvd, out/target_shape.pvd     every pose, in ParaView"
	@echo "  out/pneumatic_finger.json, out/target_shape.json   markers, pressures, iterations, times"
	@echo "  README.md, docs/formulations.md                    the five-minute tour; why the two differ"

# a build takes minutes: pip passes on what CMake and Ninja say, [n/m] a file
shows_build = --verbose --disable-pip-version-check

python:
	@PYTHON=$(PYTHON) $(SETUP) --python
	$(PYTHON) -m venv build-python
	build-python/bin/pip install $(shows_build) .
	@echo "softkin is in build-python: build-python/bin/python examples/python/first_bend.py"

# Each test is in one of these two.
test: begin-tests setup-tests format-check test-release test-page test-python
	$(list_skipped)

test-deep: begin-tests setup-tests-deep test-release-deep test-page-deep test-sanitize test-threads test-fuzz test-python-deep
	$(list_skipped)

begin-tests:
	@mkdir -p $(dir $(SOFTKIN_SKIPPED))
	@: >$(SOFTKIN_SKIPPED)

define list_skipped
@sort -u $(SOFTKIN_SKIPPED) | awk '{ line[NR] = $$0 } \
  END { print "skipped tests: " (NR ? NR : "none"); for (i = 1; i <= NR; ++i) print "  " line[i] }'
endef

setup-tests:
	@$(SETUP) --tests

setup-tests-deep:
	@$(SETUP) --tests-deep

test-release:
	cmake --preset release -DSOFTKIN_TESTS=ON -DSOFTKIN_BENCH=OFF
	cmake --build --preset release
	ctest --test-dir build --parallel $(cores) --no-tests=error --label-exclude '^deep$$'

test-release-deep:
	cmake --preset release -DSOFTKIN_TESTS=ON -DSOFTKIN_BENCH=ON
	cmake --build --preset release
	ctest --test-dir build --parallel $(cores) --no-tests=error --label-regex '^deep$$'

test-page:
	scripts/test_page.sh build/softkin build/page-tests

test-page-deep:
	scripts/test_page.sh build/softkin build/page-tests live

# programs that are made for one instruction set, whatever is asked of others
any_target := env -u SOFTKIN_TARGET

test-sanitize:
	cmake --preset sanitize
	cmake --build --preset sanitize --target $(sanitized:%=test_%)
	$(any_target) ctest --test-dir build-sanitize --parallel $(cores) --no-tests=error --label-regex '$(sanitized_pattern)'

test-threads:
	cmake --preset sanitize-threads
	cmake --build --preset sanitize-threads --target test_threads
	$(any_target) ctest --test-dir build-threads --no-tests=error --label-regex '^threads$$'

test-fuzz:
	cmake --preset sanitize
	cmake --build --preset sanitize --target softkin_fuzz
	$(any_target) scripts/fuzz.sh build-sanitize/tests/softkin_fuzz quick

test-arm:
	@$(SETUP) --arm
	scripts/arm_sysroot.sh
	cmake -S . -B build-arm/build -G Ninja --toolchain cmake/aarch64.cmake -DSOFTKIN_OPENCV=OFF -DSOFTKIN_BENCH=OFF -DSOFTKIN_TESTS=ON
	cmake --build build-arm/build --target test_core test_linear test_energy test_contact
	$(any_target) ctest --test-dir build-arm/build --parallel $(cores) --no-tests=error --label-regex '^(core|(linear|energy|contact)_neon)$$'

# What builds the package stays in the folder of its own, as pip's isolated builds lie in another place each time, and
# the module would be compiled anew.
build_requires = $(shell sed -n '/^requires = /s/.*\[\(.*\)\].*/\1/p' pyproject.toml | tr -d ,)

# the package with its $(extras), in a folder of its own: built where test-release built all but the extension module
define install_package
	@PYTHON=$(PYTHON) $(SETUP) --python
	rm -rf build-wheel/test
	$(PYTHON) -m venv build-wheel/venv
	build-wheel/venv/bin/pip install --quiet $(build_requires)
	build-wheel/venv/bin/pip wheel $(shows_build) --no-deps --no-build-isolation --wheel-dir build-wheel/test \
	  --config-settings=build-dir=build --config-settings=cmake.define.SOFTKIN_TESTS=ON .
	cmake --preset release
	build-wheel/venv/bin/pip install --quiet --force-reinstall --no-deps build-wheel/test/*.whl
	build-wheel/venv/bin/pip install --quiet "$$(ls build-wheel/test/*.whl)[$(extras)]"
endef

test-python: extras = test
test-python:
	$(install_package)
	build-wheel/venv/bin/mypy --strict --no-error-summary python/softkin
	build-wheel/venv/bin/pytest -q -n $(cores) -m 'not deep' python/tests

test-python-deep: extras = all,docs,test
test-python-deep:
	$(install_package)
	build-wheel/venv/bin/mypy --strict --no-error-summary examples/python scripts/notebooks.py scripts/site.py
	build-wheel/venv/bin/pytest -q -n $(cores) -m deep python/tests

docs: build
	@PYTHON=$(PYTHON) $(SETUP) --python
	[ -x build-docs/venv/bin/pip ] || $(PYTHON) -m venv build-docs/venv
	build-docs/venv/bin/pip install $(shows_build) ".[docs]"
	build-docs/venv/bin/python scripts/site.py build-docs/pages
	build-docs/venv/bin/mkdocs build --quiet --strict
	@echo "the site: build-docs/site/index.html"

fuzz:
	@$(SETUP) --tests
	cmake --preset fuzz
	cmake --build --preset fuzz --target softkin_fuzz softkin_fuzz_journals
	scripts/fuzz.sh build-fuzz/tests/softkin_fuzz full $(TARGETS)
	$(if $(TARGETS),,scripts/fuzz.sh build-fuzz/tests/softkin_fuzz_journals full)

random:
	@$(SETUP) --tests
	cmake --preset release -DSOFTKIN_TESTS=ON
	cmake --build --preset release --target softkin_random
	build/tests/softkin_random --count $(RUNS) --threads $(cores) --out out/random
	build/tests/softkin_random --paths --count $(RUNS) --threads $(cores)

bench: setup
	cmake --preset release -DSOFTKIN_TESTS=OFF -DSOFTKIN_BENCH=ON
	cmake --build --preset release --target $(BENCH:%=bench_%)
	@for name in $(BENCH); do \
	  echo; echo "bench_$$name $(BENCH_OPTIONS)"; build/bench/bench_$$name $(BENCH_OPTIONS) || exit 1; \
	done

paper: setup
	cmake --preset release -DSOFTKIN_TESTS=OFF -DSOFTKIN_BENCH=ON
	cmake --build --preset release --target softkin_cli bench_iteration bench_newton
	python3 scripts/paper.py $(PART) $(if $(PART),,--table docs/paper_results.md --check)

format:
	@$(CLANG_FORMAT) -i $(sources)

format-check:
	@echo 'format-check: $(words $(sources)) files'
	@$(CLANG_FORMAT) --dry-run --Werror $(sources)

# many files at once, as they are compiled: what they include is read once
tidy:
	@$(SETUP) --tidy
	cmake --preset tidy
	run-clang-tidy-14 -quiet -p build-tidy -j $(cores) '^(?!.*/page/)'

clean:
	rm -rf build build-arm build-debug build-docs build-fuzz build-sanitize build-tests build-threads build-tidy
