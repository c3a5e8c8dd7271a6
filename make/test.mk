# SPDX-License-Identifier: BSD-3-Clause
# ---- tests and examples ----------------------------------------------------------

# The suites, each of tests/test_NAME.c: `make check TESTS='cloth scene'`. The second line of some has tags:
#   first      takes long: begins before others, so that all processors end together
#   slow       make check leaves it to make check-slow: it computes for long, runs the program often or waits
#   nightly    .ci/run leaves it to make nightly
#   together   many short tests of the same code: all in one process
#   alone      a program of its own, as it replaces functions of libc: malloc and its like, and pow
#   kernels    of the fast forms of forces
#   asan-long  make asan leaves it to make nightly: what it costs there, others run as well
#   computes   compares millions of numbers itself: optimised
# In reverse order, as verification takes longest.
TAGS := $(shell awk 'FNR == 2 && $$2 == "tags:" { sub(/.*test_/, "", FILENAME); sub(/[.]c$$/, "", FILENAME); \
    for (i = 3; i < NF; ++i) print $$i "/" FILENAME }' $$(ls -r tests/test_*.c))
tagged = $(foreach t,$(1),$(patsubst $t/%,%,$(filter $t/%,$(TAGS))))
FIRST := $(call tagged,first)
ALONE := $(call tagged,alone)
TESTS := $(FIRST) $(filter-out $(FIRST) $(if $(KERNELS),,$(call tagged,kernels)),\
    $(patsubst tests/test_%.c,%,$(wildcard tests/test_*.c)))
TOGETHER := $(call tagged,together)
SUITES = $(filter-out $(ALONE),$(TESTS))
TEST_BIN = $(BUILD)/tests/run $(patsubst %,$(BUILD)/tests/test_%,$(filter $(ALONE),$(TESTS)))
BROKEN := $(patsubst tests/broken/%.c,$(BUILD)/tests/broken/weft-%.so,$(wildcard tests/broken/*.c))
# What these suites load, and no other.
PROMISES := $(if $(filter conformance cli_output interrupt,$(TESTS)),$(patsubst \
    tests/promises/%.c,$(BUILD)/tests/promises/weft-%.so,$(wildcard tests/promises/*.c)))
HAVE_CXX := $(shell command -v $(CXX) >/dev/null && echo yes)
# examples/weft-ID.c are plugins.
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/examples/%,\
                $(filter-out examples/weft-% examples/window.c,$(wildcard examples/*.c))) \
            $(if $(HAVE_CXX),$(BUILD)/examples/sail) \
            $(patsubst examples/%.c,$(BUILD)/examples/%.so,$(wildcard examples/weft-*.c))

TEST_DEFS = -DBUILD_DIR='"$(BUILD)"' $(if $(HAVE_CXX),-DHAVE_CXX) $(if $(HAVE_HTTP),-DWEFT_HTTP) \
    $(if $(HAVE_QHULL),-DWEFT_QHULL) $(if $(HAVE_CMINPACK),-DWEFT_CMINPACK) \
    $(if $(HAVE_GSL),-DHAVE_GSL) $(if $(HAVE_ARKODE),-DHAVE_ARKODE) $(if $(HAVE_CVODE),-DHAVE_CVODE)
TEST_PLUGINS = $(sort $(foreach p,$(PLUGINS),$(PLUGIN_OBJ_$(p))))
# libutil has forkpty where glibc is older than 2.34.
TEST_LIBS = -lcheck -lsubunit -lrt -lutil $(PROG_LIBS) $(LIB_LIBS) $(foreach p,$(PLUGINS),$(LIBS_$(p))) -pthread

# All of the program but main, for tests of its parts; PARTS='program/record': of these folders alone.
PROGRAM := $(BUILD)/program.a
$(PROGRAM): $(filter-out %/main.o,$(if $(PARTS),$(filter $(PARTS:%=$(BUILD)/%/%),$(PROG_OBJ)),$(PROG_OBJ)))
	$(call say,AR)rm -f $@ && ar rcs $@ $^

$(BUILD)/tests/%.o: tests/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) $(TEST_DEFS) -c -o $@ $<

# Quick to compile: the time of most tests is what they call. With SAN, CFLAGS decide, and -O1 there
# finds what the compiler warns of only when it optimizes. Some compare millions of numbers themselves.
COMPUTING := $(addprefix test_,$(call tagged,computes))
$(BUILD)/tests/test_%.o $(BROKEN) $(PROMISES): \
    OWN += $(if $(SAN),,-O$(if $(filter $(COMPUTING),$*),1,0) -U_FORTIFY_SOURCE)

# One program of all suites but those ALONE; run.c includes the list of them.
$(BUILD)/tests/run: $(SUITES:%=$(BUILD)/tests/test_%.o) $(BUILD)/tests/run.o
$(BUILD)/tests/run.o: INCS += -I$(BUILD)/tests
$(BUILD)/tests/run.o: $(BUILD)/tests/suites.h
SUITE_LIST = $(foreach name,$(SUITES),SUITE($(name)))
$(BUILD)/tests/suites.h: always
	@mkdir -p $(@D)
	@echo '$(SUITE_LIST)' | cmp -s - $@ || echo '$(SUITE_LIST)' >$@

.PHONY: always
always:

$(ALONE:%=$(BUILD)/tests/test_%): $(BUILD)/tests/%: $(BUILD)/tests/%.o
$(BUILD)/tests/run $(ALONE:%=$(BUILD)/tests/test_%): $(BUILD)/tests/support.o $(PROGRAM) $(BUILD)/libweft.a $(PLUGIN_SO)
	$(call say,LD)$(LINK) -o $@ $(filter %.o,$^) $(TEST_PLUGINS) $(filter %.a,$^) $(TEST_LIBS)

# The kernels 8 lanes wide on whatever machine: the compiler takes the vectors apart, which takes
# four times as long where all is inlined, or at -O2 with debugging information.
$(BUILD)/tests/wide/%.o: src/forces/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) $(KERNEL_FLAGS) $(if $(SAN),,-O1 -g0) -Wno-psabi -Wno-missing-prototypes \
	    -DINLINE='static inline' -DLEVEL=wide -DLANES=8 -c -o $@ $<

$(BUILD)/tests/run: $(if $(filter $(call tagged,kernels),$(TESTS)),\
    $(KERNELS:$(BUILD)/src/forces/%=$(BUILD)/tests/wide/%.o))

$(BUILD)/tests/test_no_memory: \
    private LINK += $(if $(findstring address,$(SAN)),\
        $(foreach f,malloc calloc realloc aligned_alloc free,-Wl,--wrap=$(f)))

# What is verified, for the test and for the program; scenes run as in `weft run`.
VERIFY_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(filter-out %/main.c,$(wildcard tests/verify/*.c)))
$(BUILD)/tests/%.o: INCS += -Itests
$(BUILD)/tests/run: $(if $(filter verification mesh_orders,$(TESTS)),$(VERIFY_OBJ))

$(BUILD)/weft-verify: $(BUILD)/tests/verify/main.o $(VERIFY_OBJ) $(PROGRAM) $(BUILD)/libweft.a
	$(call say,LD)$(LINK) -o $@ $^ $(LIB_LIBS) $(PROG_LIBS)

verify: all $(BUILD)/weft-verify
	@$(BUILD)/weft-verify $(VERIFY)

# These look into files as the program writes them.
$(patsubst tests/%.c,$(BUILD)/tests/%.o,$(wildcard tests/test_record*.c tests/test_export.c \
    tests/test_checkpoint.c tests/test_cli_resume.c tests/test_interrupt.c)): INCS += $(HDF5_CFLAGS)

$(BUILD)/tests/broken/weft-%.so: tests/broken/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -shared -o $@ $<

$(BUILD)/tests/promises/weft-%.so: tests/promises/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -shared -o $@ $< -lm

# Libraries that tests preload: a wrong libm, a file that never delivers, a fork that
# often fails.
PRELOADED := $(patsubst %,$(BUILD)/tests/%.so,wrong_libm stalled_file failing_fork failing_write)
$(PRELOADED): $(BUILD)/tests/%.so: tests/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(CC) $(STRICT) $(WARN) -O1 -fno-builtin -shared -o $@ $< -ldl -lm

$(BUILD)/examples/%: examples/%.c $(BUILD)/libweft.so $(BUILD)/plugins/weft-verlet.so
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) $(LDFLAGS) -o $@ $^ $(call rpath,.. ../plugins) -lm -pthread $(LDLIBS)

$(BUILD)/examples/%: examples/%.cpp include/weft/weft.hpp $(BUILD)/libweft.so $(BUILD)/plugins/weft-verlet.so
	@mkdir -p $(@D)
	$(call say,CXX)$(CXX) -std=c++17 -Wall -Wextra -Wpedantic -Werror -Iinclude $(CPPFLAGS) $(CXXFLAGS) $(SAN) $(LDFLAGS) \
	    -o $@ $(filter-out %.hpp,$^) $(call rpath,.. ../plugins) -lm -pthread $(LDLIBS)

# A cloth to be dragged with the mouse; check-window runs it without a screen.
$(BUILD)/examples/window: LDLIBS += -lSDL2
.PHONY: window check-window
window: $(if $(HAVE_SDL2),$(BUILD)/examples/window)
	@$(if $(HAVE_SDL2),echo $<,echo "window skipped: SDL2/SDL.h not found (package libsdl2-dev: WITH_WINDOW=1 make deps)")

check-window: window
	@$(if $(HAVE_SDL2),tools/checks/check-window $(BUILD))

$(BUILD)/examples/%.so: examples/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -shared -o $@ $< -lm
