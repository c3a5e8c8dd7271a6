# SPDX-License-Identifier: BSD-3-Clause
# ---- checks, and what they need -----------------------------------------------------

# Packages first, then a second make: what the first one knew of them is out of date.
# On all processors, if no -j says otherwise.
ALL_OF_THEM = $(if $(findstring -j,$(MAKEFLAGS)),,-j $(shell getconf _NPROCESSORS_ONLN))

check: deps
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) \
	    $(if $(filter file,$(origin TESTS)),TESTS='$(filter-out $(call tagged,slow),$(TESTS))') check-run

# WITHOUT=nightly: without those of that tag.
check-slow:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) \
	    TESTS='$(filter-out $(call tagged,$(WITHOUT)),$(call tagged,slow))' check-run

check-run: all $(TEST_BIN) $(BROKEN) $(PROMISES) $(PRELOADED) $(EXAMPLES) lint
	@TEST_TOGETHER='$(TOGETHER)' tools/checks/run-tests $(BUILD) \
	    $(foreach t,$(TESTS),$(if $(filter $t,$(ALONE)),test_$t,'run $t'))

# Cloths in bands over MPI, on 1 to 4 ranks, and every file compared with a serial run.
.PHONY: check-mpi
check-mpi:
	@WITH_MPI=1 $(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) all
	@tools/checks/check-mpi $(BUILD)

# What is written, read by the programs it is meant for; what is not there is skipped.
# WHOLE=1: also of pages for many runs.
check-view: all
	@WHOLE=$(WHOLE) tools/checks/check-view $(BUILD)

# The Python package in an environment of its own, built from this tree.
check-python: all
	@tools/checks/check-python $(BUILD)

# The notebooks alone, which check-python runs too.
check-notebooks: all
	@tools/checks/check-python $(BUILD) tests/test_notebooks.py

# How often weft fit finds the truth: 120 fits with noise, a quarter of an hour of a processor.
check-fit: all
	@TEST_LONG=1 tools/checks/check-python $(BUILD) tests/test_fit.py

# The page that weft view fills: needs node and npm, and its result is committed.
viewer:
	@tools/pages/viewer-packages
	node viewer/build.mjs

# docs/pictures, drawn by the player.
pictures: all
	@tools/pages/pictures $(BUILD)

demo: deps
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) demo-run

demo-run: all
	@tools/pages/demo $(BUILD)

# The one target that installs packages (tools/machine/needs.txt): with WITH_MPI=1, WITH_CHECKS=1 (what .ci/run and
# `make nightly` call), WITH_PICTURES=1, WITH_WINDOW=1 or WITH_DIST=1, those too. Debian's place of HDF5, though it may
# be there only once the package is installed.
GROUPS = MPI CHECKS PICTURES WINDOW DIST
deps:
	@PREPROCESS='$(PREPROCESS) $(HDF5_CFLAGS) -isystem /usr/include/hdf5/serial $(MPI_CFLAGS)' \
	    tools/machine/deps $(foreach g,$(GROUPS),$(if $(WITH_$g),$g))
