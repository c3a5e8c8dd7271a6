# SPDX-License-Identifier: BSD-3-Clause
# ---- releases, and what is slow ----------------------------------------------------

# Packages of Debian 13, built, installed, tested and removed in clean systems; needs root and debootstrap.
.PHONY: check-deb sbom tag
check-deb:
	@tools/checks/check-deb $(BUILD)

# A bill of materials beside the artefacts.
sbom:
	@tools/release/sbom $(BUILD)/dist

# The tree is a release: checks that, and makes its tag.
tag: all $(BUILD)/tests/run
	@tools/release/tag $(BUILD)

# A licence and a copyright for every file; a bill of materials that is valid.
check-reuse:
	@tools/checks/check-reuse $(BUILD)

valgrind: all
	@tools/checks/valgrind $(BUILD)

# Tests of the steppers that differ with SUNDIALS's release, with no more built than they need.
STEPPER_TESTS := agree arkode cvode sundials_vector controllers methods
check-steppers:
	@$(MAKE) --no-print-directory TESTS='$(STEPPER_TESTS)' $(BUILD)/tests/run $(BUILD)/weft $(PLUGIN_SO) $(BROKEN)
	@tools/checks/run-tests $(BUILD) $(STEPPER_TESTS:%='run %')

# Tests of the steppers against Debian 13's SUNDIALS 7, in a system of its own; root,
# debootstrap. WHOLE=1: every test, and the verification.
check-sundials7:
	@tools/checks/check-sundials7 $(BUILD) $(WHOLE)

# Random cloths that are thrown at themselves, for so long, and then large scenes, which take a
# quarter of an hour: none passes through itself.
SECONDS ?= 600
check-self:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) TESTS='self_random self_time' $(BUILD)/tests/run
	SELF_SECONDS=$(SECONDS) CK_RUN_CASE=self $(BUILD)/tests/run self_random self_time

# Each fault of tests/mutations.txt, made in a copy of the tree, fails a test; an hour of a processor.
.PHONY: mutations
mutations: all
	tools/checks/mutate $(BUILD)

# What .ci/run leaves out because it is slow.
nightly: all
	@tools/rules/tree $(BUILD)/tree remember
	$(MAKE) check-slow
	$(MAKE) mutations
	$(MAKE) check-elsewhere
	$(MAKE) check-site
	$(MAKE) check-install WHOLE=1
	$(MAKE) static DEEP=1
	TEST_LONG=1 $(MAKE) coverage
	$(MAKE) asan ASAN_WITHOUT=
	$(MAKE) tsan TSAN_WITHOUT=
	$(MAKE) verify
	$(MAKE) check-determinism WHOLE=1
	$(MAKE) check-validation WHOLE=1
	TEST_LONG=1 $(MAKE) check-python
	$(MAKE) check-docs WHOLE=1
	$(MAKE) check-view WHOLE=1
	$(MAKE) fuzz FUZZ_SECONDS=300
	$(MAKE) check-files
	$(MAKE) check-self SECONDS=3600
	TEST_LONG=1 $(MAKE) check-libm
	$(MAKE) check-aarch64
	$(MAKE) check-sundials7 WHOLE=1
	$(MAKE) check-compilers
	$(MAKE) check-deb
	$(MAKE) check-dist
	@tools/rules/tree $(BUILD)/tree end nightly

# Built for 64-bit ARM and run by qemu-user: which methods have the same bits there.
check-aarch64: all
	@MAKE="$(MAKE)" tools/checks/check-aarch64 $(BUILD)

# gcc 10 and clang 11 in a system of Debian 11: root, debootstrap.
check-compilers: all hashes
	@tools/checks/check-compilers $(BUILD)

# Built where libraries, compilers or HDF5 are elsewhere or missing.
check-elsewhere: all hashes $(BUILD)/examples/minimal
	@tools/checks/check-elsewhere $(BUILD)

# A force added to a copy, by its folder and ten lines elsewhere.
check-toy:
	@tools/checks/check-toy $(BUILD)

symbols: $(BUILD)/libweft.so $(BUILD)/libweft.a $(PLUGIN_SO) $(MPI_SO)
	@tools/checks/symbols $^
