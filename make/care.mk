# SPDX-License-Identifier: BSD-3-Clause
# ---- care ------------------------------------------------------------------------

C_FILES = $(wildcard include/weft/*.h src/*/*.[ch] src/*/*/*.[ch] program/*.[ch] program/*/*.[ch] program/*/*/*.[ch] \
                     study/*.[ch] study/*/*.[ch] plugins/*/*.[ch] tests/*.[ch] \
                     tests/verify/*.[ch] tests/broken/*.c tests/promises/*.c tests/fuzz/*.[ch] tests/toy/*/*.[ch] \
                     examples/*.[ch] packaging/wasm/*.c bench/*.[ch] bench/levels/*.[ch] bench/guard/*.c)

lint: all
	@tools/rules/lint $(C_FILES)
	@tools/rules/versions
	@! { command -v python3 && git rev-parse --git-dir; } >/dev/null 2>&1 || { \
	    tools/rules/pages && tools/rules/words && tools/rules/holds && tools/checks/mutate --check && tools/places; }
	@! git rev-parse --git-dir >/dev/null 2>&1 || git apply --check tests/toy/elsewhere.patch
	@tools/rules/layers $(BUILD)

# A hook of git that checks the form of commit messages.
.PHONY: hooks
hooks:
	@tools/rules/hooks

format:
	clang-format -i $(C_FILES)

# Tables that the program prints and the pages quote.
docs: all
	@tools/pages/docs $(BUILD)

# Check's tests under AddressSanitizer and UBSan, in a build of its own, but those of a tag (ASAN_WITHOUT=, as make
# nightly: all).
# The tests of a suite run in one process, as one each takes five times as long, but where memory is limited or
# measured.
ASAN_WITHOUT ?= asan-long

asan:
	@$(if $(ASAN_WITHOUT),CK_EXCLUDE_TAGS=long) $(MAKE) --no-print-directory $(ALL_OF_THEM) \
	    BUILD=build/asan CFLAGS='-O1 -g1' \
	    TESTS='$(filter-out $(call tagged,$(ASAN_WITHOUT)),$(TESTS))' \
	    TOGETHER='$(TOGETHER) $(filter-out $(call tagged,asan-long) jacobian hostile_cost,$(TESTS))' \
	    SAN='-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer' \
	    REPLAY=build/asan/tests/replay.o check-run replay

# Lines of src/, program/, study/ and plugins/ that the tests run.
COVERAGE_LEAST ?= 90

coverage:
	@find build/coverage -name '*.gcda' -delete 2>/dev/null || :
	@CK_TIMEOUT_MULTIPLIER=4 $(MAKE) --no-print-directory $(ALL_OF_THEM) BUILD=build/coverage CFLAGS='-O1 -g1' \
	    SAN='--coverage -fprofile-update=atomic' check-run
	@tools/checks/coverage build/coverage $(COVERAGE_LEAST)

# Races between threads: of a simulation, of simulations, and of the steppers alone.
# Those of simulations in one process each: forks after threads are not for the sanitizer.
# TSAN_WITHOUT=, as make nightly: also the same with other widths, roundings and ends.
TSAN_WITHOUT ?= bands_ends
TSAN_SUITES := $(filter-out $(TSAN_WITHOUT),threads bands bands_ends)
TSAN_TESTS := $(TSAN_SUITES) embed self_time wave steppers sundials_vector
TSAN_RUN := build/tsan/tests/run

tsan:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) BUILD=build/tsan CFLAGS='-O1 -g1' SAN='-fsanitize=thread' \
	    TESTS='$(TSAN_TESTS)' PARTS='study/conformance program/record' $(TSAN_RUN)
	$(if $(TSAN_WITHOUT),CK_EXCLUDE_TAGS=long) CK_FORK=no $(TSAN_RUN) $(TSAN_SUITES)
	CK_FORK=no CK_RUN_CASE=threads $(TSAN_RUN) $(if $(TSAN_WITHOUT),,embed) self_time wave
	CK_TIMEOUT_MULTIPLIER=4 CK_RUN_CASE=threads $(TSAN_RUN) sundials_vector steppers

# Sources read by clang-tidy and cppcheck; DEEP=1: also by gcc -fanalyzer, and clang-tidy follows calls.
static:
	@tools/checks/static "$(STRICT) $(INCS) $(HDF5_CFLAGS) $(MPI_CFLAGS)" $(DEEP)

# Prints hashes of states, for builds that are compared.
$(BUILD)/hashes: $(BUILD)/tests/hashes.o $(BUILD)/libweft.a
	$(call say,LD)$(LINK) -o $@ $^ $(LIB_LIBS)

.PHONY: hashes
hashes: $(BUILD)/hashes $(PLUGIN_SO)

# The same bits from every compiler and at every level of optimization.
check-determinism: hashes
	@MAKE="$(MAKE)" tools/checks/check-determinism $(BUILD) $(WHOLE)

# The same bits whatever libm and whatever processor; wants qemu-user.
check-libm: all $(BUILD)/tests/test_libm $(PRELOADED)
	@tools/checks/check-libm $(BUILD)

# libFuzzer, a minute a target, as many at once as there are processors: `make fuzz FUZZ_SECONDS=1200 FUZZ=scene`.
# Without kernels, which take minutes to compile so: asan runs them.
FUZZ_SECONDS ?= 60
FUZZ ?= $(patsubst tests/fuzz/%.c,%,$(wildcard tests/fuzz/*.c))

$(BUILD)/fuzz/%: $(BUILD)/tests/fuzz/%.o $(REPLAY) $(BUILD)/tests/support.o $(PROGRAM) $(BUILD)/libweft.a $(PLUGIN_SO)
	@mkdir -p $(@D)
	$(call say,LD)$(LINK) $(if $(REPLAY),,-fsanitize=fuzzer) -o $@ $(filter %.o,$^) $(TEST_PLUGINS) \
	    $(filter %.a,$^) $(TEST_LIBS)

# These read in one process what the program reads in two.
FUZZ_HDF := frames vtkhdf
$(FUZZ_HDF:%=$(BUILD)/tests/fuzz/%.o): INCS += $(HDF5_CFLAGS)
$(FUZZ_HDF:%=$(BUILD)/fuzz/%): private LINK += -Wl,--wrap=fork,--wrap=waitpid

FUZZ_BUILD = BUILD=build/fuzz KERNEL=plain CC=clang CFLAGS='-O1 -g1' \
	    SAN='-Wno-pass-failed -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all' \
	    build/fuzz/weft $(PLUGINS:%=build/fuzz/plugins/weft-%.so)

fuzz:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) $(FUZZ_BUILD) $(FUZZ:%=build/fuzz/fuzz/%)
	@printf "%s\n" $(FUZZ) | xargs -P "$$(nproc)" -L 1 tools/checks/fuzz build/fuzz $(FUZZ_SECONDS)

# 300 meshes as other programs write them and 500 scenes of several files, some damaged, with the sanitizers.
.PHONY: check-files
check-files:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) $(FUZZ_BUILD)
	@tools/checks/check-files build/fuzz/weft

# The committed inputs alone, of targets that replay.c calls: asan has them.
REPLAYED := $(notdir $(wildcard tests/fuzz/corpus/*))
.PHONY: replay
replay: $(FUZZ:%=$(BUILD)/fuzz/%)
	@set -e; for target in $(REPLAYED); do $(BUILD)/fuzz/$$target tests/fuzz/corpus/$$target/*; done

# The smallest inputs that `make fuzz` has found for every branch, to be committed. Those of vtkhdf
# are too large: 35 kB each.
fuzz-corpus:
	@tools/checks/fuzz-corpus build/fuzz $(filter-out vtkhdf,$(FUZZ))

# clang's warnings, without a build. `make fuzz` builds with clang.
clang-syntax: $(BUILD)/tests/suites.h
	@printf '%s\n' \
	    $(filter-out $(if $(HAVE_MPI),,program/mpi/%) $(if $(HAVE_SDL2),,%/window.c) \
	        tests/toy/%,$(filter %.c,$(C_FILES))) | \
	    xargs -P "$$(nproc)" -L 16 clang $(STRICT) $(WARN) $(INCS) -Itests -I$(BUILD)/tests $(HDF5_CFLAGS) \
	    $(CMINPACK_CFLAGS) $(MPI_CFLAGS) $(TEST_DEFS) -fsyntax-only
