# SPDX-License-Identifier: BSD-3-Clause
$(if $(filter 3.% 4.0 4.0.% 4.1 4.1.% 4.2 4.2.%,$(MAKE_VERSION)),$(error weft needs GNU make 4.3 or later; this is $(MAKE_VERSION)))
# weft: the only build. Everything that is built goes under $(BUILD).
#
#   make            library, program and plugins
#   make demo       a falling cloth in numbers and as OBJ, under build/demo
#   make check      every test
#   make verify     what is measured of every method of every plugin, a table (VERIFY=gsl: of that alone)
#   make help       the other targets

BUILD  ?= build
CFLAGS ?= -O2 -g
CXXFLAGS ?= $(CFLAGS)
SAN    ?=
# In a cross build: a weft that runs on this machine, which manual pages and completions quote.
HOST_WEFT ?= $(BUILD)/weft

# Python's compiled modules would lie beside the sources of the tree.
export PYTHONDONTWRITEBYTECODE := 1

ifeq ($(origin CC),default)
CC := $(shell for c in cc gcc clang; do command -v $$c >/dev/null && echo $$c && exit; done; echo cc)
endif
TARGET := $(shell $(CC) -dumpmachine 2>/dev/null)

WARN := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wmissing-prototypes \
        -Wstrict-prototypes -Werror
# No contraction of a*b+c into one rounding: the same bits on every instruction set.
STRICT := -std=c11 -D_POSIX_C_SOURCE=200809L -ffp-contract=off -fvisibility=hidden -fPIC
INCS := -Iinclude -Isrc -I.
# `make V=1` shows the commands.
say = $(if $(V),,@echo '  $(1)  $@';)
COMPILE = $(CC) $(STRICT) $(WARN) $(INCS) $(CPPFLAGS) $(CFLAGS) $(OWN) $(SAN) -MMD -MP
OWN = # flags of some files, whatever CFLAGS are
LINK = $(CC) $(CFLAGS) $(SAN) $(LDFLAGS)
ifneq ($(findstring darwin,$(TARGET)),)
STRICT += -D_DARWIN_C_SOURCE -include xlocale.h # flock, dladdr and the like; uselocale
soname = -Wl,-install_name,@rpath/$(1)
rpath = $(foreach d,$(1),-Wl,-rpath,'@loader_path/$(d)')
else
soname = -Wl,-soname,$(1)
rpath = $(foreach d,$(1),-Wl,-rpath,'$$ORIGIN/$(d)')
endif

# Serial HDF5, of the program alone. Debian keeps it apart from the one for MPI.
ifneq ($(wildcard /usr/include/hdf5/serial/hdf5.h),)
HDF5_CFLAGS ?= -isystem /usr/include/hdf5/serial
HDF5_LIBS ?= -lhdf5_serial
else
HDF5_CFLAGS ?= $(shell pkg-config --cflags hdf5 2>/dev/null)
HDF5_LIBS ?= $(shell pkg-config --libs hdf5 2>/dev/null || echo -lhdf5)
endif

PREPROCESS = $(CC) $(CPPFLAGS) $(CFLAGS) $(MPI_INC) -E
# A variable, as make 4.3 keeps the backslash of an escaped # within a function.
hash := \#
probe = echo '$(hash)include <$(1)>' | $(PREPROCESS) $(2) -
has = $(shell $(probe) >/dev/null 2>&1 && echo yes)
ifneq ($(call has,stdio.h),yes)
$(error CC=$(CC) cannot compile: $(shell $(call probe,stdio.h) 2>&1 >/dev/null | grep -m 1 -e error -e found) (packages gcc or clang, libc6-dev: 'apt-get install gcc libc6-dev' on Debian))
endif
HAVE_HDF5 := $(call has,hdf5.h,$(HDF5_CFLAGS))
# The server of --watch, of the program alone.
HAVE_HTTP := $(call has,microhttpd.h)
# The mesher of cloth.cut, of the program alone.
HAVE_QHULL := $(call has,libqhull_r/libqhull_r.h)
# The method of weft fit.
CMINPACK_CFLAGS ?= $(or $(patsubst -I%,-isystem %,$(shell pkg-config --cflags cminpack 2>/dev/null)),-isystem /usr/include/cminpack-1)
HAVE_CMINPACK := $(call has,cminpack.h,$(CMINPACK_CFLAGS))
# The example with a window.
HAVE_SDL2 := $(call has,SDL2/SDL.h)
HAVE_GSL := $(call has,gsl/gsl_odeiv2.h)
# SUNDIALS 7 that was built with MPI includes mpi.h everywhere.
mpi = $(shell pkg-config --$(1) mpi-c 2>/dev/null || mpicc --showme:$(2) 2>/dev/null)
MPI_INC := $(if $(call has,arkode/arkode_erkstep.h),,$(patsubst -I%,-isystem %,$(call mpi,cflags,compile)))
MPI_LIBS := $(if $(MPI_INC),$(call mpi,libs,link))
HAVE_ARKODE := $(call has,arkode/arkode_erkstep.h)
# weft-mpi.so alone is linked with MPI, that of mpicc; a cross compiler links none.
MPI_CFLAGS ?= $(patsubst -I%,-isystem %,$(call mpi,cflags,compile))
MPI_LINK ?= $(call mpi,libs,link)
links = $(shell echo 'int MPI_Finalize(void); int main(void) { return MPI_Finalize(); }' | \
    $(CC) -x c - -o /dev/null $(MPI_LINK) 2>/dev/null && echo yes)
HAVE_MPI := $(if $(call has,mpi.h,$(MPI_CFLAGS)),$(links))
HAVE_CVODE := $(call has,cvode/cvode.h)
# SUNDIALS 7 has a library more.
HAVE_SUNDIALS_7 := $(call has,sundials/sundials_errors.h)

# What the goals need and this machine lacks, before anything is built. `make deps` installs it.
quoted = '$(subst ','\'',$(1))'
goals := $(filter-out deps,$(or $(MAKECMDGOALS),all)) $(if $(filter dist check-dist,$(MAKECMDGOALS)),$(patsubst %,dist/%,$(or $(DIST),\
    linux-x86_64 linux-aarch64 static-x86_64 static-aarch64 macos-arm64 windows-x86_64 pages))) \
    $(if $(filter bench,$(MAKECMDGOALS)),$(filter bench/peers,$(BENCH:%=bench/%)))
LACKING := $(if $(wildcard tools/needs),$(shell PREPROCESS='$(PREPROCESS) $(HDF5_CFLAGS) $(MPI_CFLAGS)' tools/needs $(foreach g,$(goals),$(call quoted,$g))))
$(if $(LACKING),$(error $(LACKING)$(if $(findstring libhdf5-dev,$(LACKING)),; the library and the plugins do without: \
    make $(BUILD)/libweft.so $(BUILD)/plugins/weft-verlet.so)))

VERSION := $(shell sed -n 's/^.define WEFT_VERSION "\(.*\)"/\1/p' include/weft/base.h)
SOVERSION := $(shell sed -n 's/^.define WEFT_INTERFACE //p' include/weft/base.h)

FAST     := $(wildcard src/forces/*/*_fast.c)
LIB_SRC  := $(filter-out $(FAST),$(wildcard $(patsubst %,src/%/*.c,base mesh forces/* cloth sim plugin stability scene)))
LIB_OBJ  := $(LIB_SRC:%.c=$(BUILD)/%.o)
# The fast forms of forces, once more for each level of instructions that src/base/isa.c chooses
# from. KERNEL=plain, or all *_fast.c deleted: none, the plain loops have the same bits.
KERNELS  := $(if $(filter plain,$(KERNEL)),,$(FAST:%.c=$(BUILD)/%))
LIB_OBJ  += $(KERNELS:=.o)
LEVELS   := $(if $(filter x86_64%,$(TARGET)),v3 v4)
LIB_OBJ  += $(foreach level,$(LEVELS),$(KERNELS:=.$(level).o))
RECORD_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(wildcard program/record/*.c program/record/*/*.c)) $(BUILD)/program/record/pages.o
# STUDY=no: without the verbs that study scenes and methods.
STUDY_SRC := $(if $(filter no,$(STUDY)),,$(wildcard study/*.c study/*/*.c))
PROG_OBJ := $(RECORD_OBJ) $(patsubst %.c,$(BUILD)/%.o,$(wildcard program/*.c) \
    $(filter-out $(patsubst %,program/%/%,cut mpi record),$(wildcard program/*/*.c)) $(STUDY_SRC))
PROG_OBJ := $(filter-out $(if $(HAVE_HTTP),,%/watch_server.o),$(PROG_OBJ))
PROG_OBJ += $(if $(HAVE_QHULL),$(patsubst %.c,$(BUILD)/%.o,$(wildcard program/cut/*.c)))
PROG_LIBS := $(HDF5_LIBS) $(if $(HAVE_HTTP),-lmicrohttpd) $(if $(HAVE_QHULL),-lqhull_r) $(if $(HAVE_CMINPACK),-lcminpack)
# libweft has them for scenes, and does not export them.
PROG_OBJ += $(BUILD)/src/base/suggest.o $(BUILD)/src/base/file.o
LIB_LIBS := -lyaml -ldl -lm -pthread $(LDLIBS)

PLUGINS := verlet stiff $(if $(HAVE_GSL),gsl) $(if $(HAVE_ARKODE),arkode) $(if $(HAVE_CVODE),cvode)
PLUGIN_SO := $(PLUGINS:%=$(BUILD)/plugins/weft-%.so)
# Found as plugins are, but none.
MPI_SO := $(if $(HAVE_MPI),$(BUILD)/plugins/weft-mpi.so)
LIBS_gsl := -lgsl -lgslcblas -lm
LIBS_verlet := -lm
LIBS_stiff := -lm
LIBS_sundials := -lsundials_nvecserial $(if $(HAVE_SUNDIALS_7),-lsundials_core) $(MPI_LIBS) -lm
LIBS_arkode := -lsundials_arkode $(LIBS_sundials)
LIBS_cvode := -lsundials_cvode $(LIBS_sundials)
# Folders whose sources are also part of a plugin.
PARTS_stiff := linear stabilised
PARTS_arkode := sundials linear stabilised
PARTS_cvode := sundials linear

# The suites, each of tests/test_NAME.c: `make check TESTS='cloth scene'`. Those that take longest
# begin first, so that all processors end together.
LONGEST := verification hostile surroundings record_ends compare cli_resume steppers cli_batch interrupt \
           checkpoint record_damage quadratures sundials_vector libm embed stiffness papers cli_stability
# Many short tests, most of the same code with one method after another, for which a process each costs more.
TOGETHER := steppers quadratures arkode embed ledger_order sim stepper_accuracy stability verification gsl pins \
            limit_sheet checkpoint contact_time
KERNEL_TESTS := kernel seek membrane
# What `make check` leaves to `make check-slow`: suites that compute for long, run the program hundreds of times or wait for clocks.
SLOW := embed verification hostile surroundings record_ends compare cli_resume steppers cli_batch interrupt record_damage sundials_vector cli_stability \
        skin skin_time scenes sensitivity self_time bands bands_ends bands_self conformance view untangle membrane cut bodies kernel batch_ends bands_meshes hostile_cost \
        libm stiffness bounds mesh_orders ledger_order self_random linear no_memory stability wave cli_output fit shapes_record \
        contact_time quadratures papers converge tools
TESTS := $(LONGEST) $(filter-out $(LONGEST) $(if $(KERNELS),,$(KERNEL_TESTS)),$(patsubst tests/test_%.c,%,$(wildcard tests/test_*.c)))
# Programs of their own, as they replace functions of libc: malloc and its like, and pow.
ALONE := no_memory libm
SUITES = $(filter-out $(ALONE),$(TESTS))
TEST_BIN = $(BUILD)/tests/run $(patsubst %,$(BUILD)/tests/test_%,$(filter $(ALONE),$(TESTS)))
BROKEN := $(patsubst tests/broken/%.c,$(BUILD)/tests/broken/weft-%.so,$(wildcard tests/broken/*.c))
# What these suites load, and no other.
PROMISES := $(if $(filter conformance cli_output interrupt,$(TESTS)),$(patsubst \
    tests/promises/%.c,$(BUILD)/tests/promises/weft-%.so,$(wildcard tests/promises/*.c)))
HAVE_CXX := $(shell command -v $(CXX) >/dev/null && echo yes)
# examples/weft-ID.c are plugins.
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/examples/%,$(filter-out examples/weft-% examples/window.c,$(wildcard examples/*.c))) \
            $(if $(HAVE_CXX),$(BUILD)/examples/sail) \
            $(patsubst examples/%.c,$(BUILD)/examples/%.so,$(wildcard examples/weft-*.c))

.PHONY: all check check-run check-slow check-reuse check-view check-python check-notebooks check-fit viewer pictures verify bench demo demo-run deps docs lint format asan tsan guard \
        fuzz fuzz-corpus coverage static check-determinism check-libm clang-syntax check-self check-steppers check-sundials7 check-aarch64 check-compilers check-elsewhere nightly \
        valgrind symbols clean help
.DELETE_ON_ERROR:
.SECONDARY:

all: $(BUILD)/libweft.so $(BUILD)/libweft.a $(BUILD)/weft $(PLUGIN_SO) $(MPI_SO) skipped

.PHONY: skipped
skipped:
	@$(if $(HAVE_HTTP),:,echo "--watch skipped: microhttpd.h not found (package libmicrohttpd-dev: make deps)")
	@$(if $(HAVE_CMINPACK),:,echo "weft fit skipped: cminpack.h not found (package libcminpack-dev: make deps)")
	@$(if $(HAVE_QHULL),:,echo "cloth.cut skipped: libqhull_r/libqhull_r.h not found (package libqhull-dev: make deps)")
	@$(if $(HAVE_GSL),:,echo "plugin gsl skipped: gsl/gsl_odeiv2.h not found (package libgsl-dev: make deps)")
	@$(if $(HAVE_ARKODE),:,echo "plugin arkode skipped: arkode/arkode_erkstep.h not found (package libsundials-dev: make deps)")
	@$(if $(HAVE_MPI),:,echo "weft-mpi.so skipped (weft run --bands): mpicc not found (package libopenmpi-dev: WITH_MPI=1 make deps)")
	@$(if $(HAVE_CVODE),:,echo "plugin cvode skipped: cvode/cvode.h not found (package libsundials-dev: make deps)")

# ---- library and program ---------------------------------------------------------

$(BUILD)/libweft.so: $(LIB_OBJ)
	$(call say,LD)$(LINK) -shared $(call soname,libweft.so.$(SOVERSION)) -o $@ $^ $(LIB_LIBS)
	@ln -sf libweft.so $@.$(SOVERSION)

$(BUILD)/libweft.a: $(LIB_OBJ)
	$(call say,AR)rm -f $@ && ar rcs $@ $^

$(BUILD)/weft: $(PROG_OBJ) $(BUILD)/libweft.so
	$(call say,LD)$(LINK) -o $@ $^ $(call rpath,. ../lib) $(PROG_LIBS) $(LIB_LIBS)

$(BUILD)/program/record/%.o: INCS += $(HDF5_CFLAGS)
$(BUILD)/program/main.o: OWN += $(if $(STUDY_SRC),-DWEFT_STUDY)
$(BUILD)/study/fit/fit.o: OWN += $(if $(HAVE_CMINPACK),-DWEFT_CMINPACK $(CMINPACK_CFLAGS))
# How an error says that a plugin is installed: source, pip, debian or spack.
INSTALLED_BY ?= source
$(BUILD)/src/plugin/loading.o: OWN += '-DWEFT__INSTALLED_BY="$(INSTALLED_BY)"'
$(BUILD)/program/open.o: OWN += $(if $(HAVE_QHULL),-DWEFT_QHULL)
$(BUILD)/program/watch/%.o: OWN += $(if $(HAVE_HTTP),-DWEFT_HTTP)

$(LIB_OBJ): OWN += $(if $(KERNELS),,-DWEFT_PLAIN)
# Sums of whole states, which gcc takes several at a time.
$(BUILD)/src/sim/adjoint.o $(BUILD)/src/sim/between.o $(BUILD)/src/sim/wave.o $(BUILD)/src/cloth/slope.o: OWN += $(if $(SAN),,-O3)
# Lines for debuggers, but not the places of variables: those of inlined loops take a third of the compiler's time.
KERNEL_FLAGS := $(if $(SAN),,-O2 $(if $(filter -g,$(CFLAGS)),-g1)) -fno-math-errno -fno-trapping-math
# clang 11 has no names of levels.
NAMED := $(if $(LEVELS),$(shell $(CC) -march=x86-64-v4 -E -x c /dev/null >/dev/null 2>&1 && echo yes))
V3 := $(if $(NAMED),-march=x86-64-v3,-mavx2 -mfma -mbmi -mbmi2)
V4 := $(if $(NAMED),-march=x86-64-v4,$(V3) -mavx512f -mavx512bw -mavx512cd -mavx512dq -mavx512vl)
$(BUILD)/%.v3.o: OWN += $(V3) -DLEVEL=v3 -DLANES=4
$(BUILD)/%.v4.o: OWN += $(V4) -mprefer-vector-width=512 -DLEVEL=v4 -DLANES=8
$(BUILD)/src/forces/self/self_fast.o $(LEVELS:%=$(BUILD)/src/forces/self/self_fast.%.o): OWN += -funroll-loops
$(KERNELS:=.o) $(foreach level,$(LEVELS),$(KERNELS:=.$(level).o)): OWN += $(KERNEL_FLAGS)
# They are not asked for undefined behaviour, which takes seven times as long to compile: the plain forms are.
# gcc's checks of addresses as calls, beyond some of them in a function: half the time to compile.
CALLS := $(if $(findstring address,$(SAN)),$(if $(findstring clang,$(CC)),,--param asan-instrumentation-with-call-threshold=100))
$(KERNELS:=.o) $(foreach level,$(LEVELS),$(KERNELS:=.$(level).o)): override SAN := $(strip $(SAN:%,undefined=%) $(CALLS))
HARDER := seek/boxes_fast seek/seek_fast contact/contact_fast membrane/membrane_fast membrane/membrane_arc_fast
$(foreach f,$(HARDER),$(BUILD)/src/forces/$f.o $(LEVELS:%=$(BUILD)/src/forces/$f.%.o)): OWN += $(if $(SAN),,-O3)
$(foreach level,$(LEVELS),$(KERNELS:=.$(level).o)): $(BUILD)/src/forces/%.o:
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -c -o $@ src/forces/$(basename $*).c

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -c -o $@ $<

# The pages, built from viewer/ by `make viewer` and committed, and the scene of `weft new`, as strings: program/record/page.h.
$(BUILD)/program/record/pages.c: viewer/dist/player.html viewer/dist/compare.html scenes/hammock.yaml
	@mkdir -p $(@D)
	$(call say,GEN)for page in $^; do \
	    name=$${page##*/} && echo "const char weft__$${name%.*}_page[] =" && \
	    LC_ALL=C sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' "$$page" && echo ';'; done >$@

$(BUILD)/program/record/pages.o: $(BUILD)/program/record/pages.c
	$(call say,CC)$(CC) $(STRICT) $(CPPFLAGS) $(CFLAGS) $(SAN) -c -o $@ $<

ifneq ($(HAVE_HDF5),yes)
$(filter-out %/pages.o,$(RECORD_OBJ)):
	@echo "weft, the program, needs hdf5.h, which CC with HDF5_CFLAGS='$(HDF5_CFLAGS)' does not find (package libhdf5-dev: make deps);" >&2
	@echo "the library and the plugins do without: make $(BUILD)/libweft.so $(PLUGIN_SO)" >&2
	@exit 1
endif

# ---- plugins: each sees weft/stepper.h and weft/elementary.h, nothing else of weft -

define PLUGIN_RULE
PLUGIN_OBJ_$(1) := $$(patsubst %.c,$(BUILD)/%.o,$$(wildcard $$(patsubst %,plugins/%/*.c,$(1) $$(PARTS_$(1)))))
$(BUILD)/plugins/weft-$(1).so: $$(PLUGIN_OBJ_$(1))
	@mkdir -p $$(@D)
	$$(call say,LD)$$(LINK) -shared $$(call soname,weft-$(1).so) -o $$@ $$^ $$(LIBS_$(1)) $$(LDLIBS)
endef
$(foreach p,$(PLUGINS),$(eval $(call PLUGIN_RULE,$(p))))

# The program with its plugins linked in, but GSL's, for systems whose libraries are not known.
BUILT_IN := $(filter-out gsl,$(PLUGINS))
$(BUILD)/weft-static: private OWN += '-DWEFT_BUILT_IN=$(foreach p,$(BUILT_IN),X($p))'
$(BUILD)/weft-static: wasm/built_in.c $(sort $(PROG_OBJ) $(filter-out %/loading.o,$(LIB_OBJ)) $(foreach p,$(BUILT_IN),$(PLUGIN_OBJ_$(p))))
	$(call say,LD)$(COMPILE) -static -o $@ $^ $(LDFLAGS) $(foreach p,$(BUILT_IN),$(LIBS_$(p))) $(PROG_LIBS) $(LIB_LIBS)

$(BUILD)/program/mpi/comm_mpi.o: INCS += $(MPI_CFLAGS)
$(BUILD)/plugins/weft-mpi.so: $(BUILD)/program/mpi/comm_mpi.o
	@mkdir -p $(@D)
	$(call say,LD)$(LINK) -shared $(call soname,weft-mpi.so) -o $@ $^ $(MPI_LINK) $(LDLIBS)

# Loops over whole states, which gcc does not vectorise at -O2.
$(BUILD)/plugins/sundials/sundials_arithmetic.o $(BUILD)/plugins/gsl/gsl_control.o $(BUILD)/plugins/verlet/verlet.o \
$(patsubst %.c,$(BUILD)/%.o,plugins/stiff/arithmetic.c $(wildcard plugins/linear/*.c)): OWN += $(if $(SAN),,-O3)

# All that include SUNDIALS.
$(BUILD)/plugins/arkode/%.o $(BUILD)/plugins/cvode/%.o $(BUILD)/plugins/sundials/%.o $(BUILD)/tests/test_sundials_vector.o $(BUILD)/bench/vectors.o: INCS += $(MPI_INC)

# ---- tests and examples ----------------------------------------------------------

TEST_DEFS = -DBUILD_DIR='"$(BUILD)"' $(if $(HAVE_CXX),-DHAVE_CXX) $(if $(HAVE_HTTP),-DWEFT_HTTP) $(if $(HAVE_QHULL),-DWEFT_QHULL) $(if $(HAVE_CMINPACK),-DWEFT_CMINPACK) $(if $(HAVE_GSL),-DHAVE_GSL) $(if $(HAVE_ARKODE),-DHAVE_ARKODE) $(if $(HAVE_CVODE),-DHAVE_CVODE)
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
COMPUTING := $(addprefix test_,elementary sundials_vector quadratures crossing kernel self_random self_time libm)
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

$(BUILD)/tests/run: $(if $(filter $(KERNEL_TESTS),$(TESTS)),$(KERNELS:$(BUILD)/src/forces/%=$(BUILD)/tests/wide/%.o))

$(BUILD)/tests/test_no_memory: \
    private LINK += $(if $(findstring address,$(SAN)),$(foreach f,malloc calloc realloc aligned_alloc free,-Wl,--wrap=$(f)))

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
PRELOADED := $(BUILD)/tests/wrong_libm.so $(BUILD)/tests/stalled_file.so $(BUILD)/tests/failing_fork.so $(BUILD)/tests/failing_write.so
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
	@$(if $(HAVE_SDL2),tools/check-window $(BUILD))

$(BUILD)/examples/%.so: examples/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -shared -o $@ $< -lm

# ---- benchmarks: one program each; they measure and assert nothing ----------------

BENCHES := $(patsubst bench/%.c,%,$(wildcard bench/*.c))
BENCH ?= $(BENCHES)

$(BUILD)/bench/%.o: bench/%.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) $(TEST_DEFS) -c -o $@ $<

# The spring list of a lecture and the bound, with the flags of the kernels.
BENCH_LEVELS := $(addprefix $(BUILD)/bench/levels/level,.o $(LEVELS:%=.%.o))
$(BENCH_LEVELS): OWN += $(KERNEL_FLAGS)
$(BENCH_LEVELS): bench/levels/level.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -c -o $@ $<

$(BUILD)/bench/force $(BUILD)/bench/mesh: $(BENCH_LEVELS)
$(BUILD)/bench/%: $(BUILD)/bench/%.o $(BUILD)/libweft.a $(PLUGIN_SO)
	$(call say,LD)$(LINK) -o $@ $(filter %.o,$^) $(TEST_PLUGINS) $(BUILD)/libweft.a \
	    $(LIB_LIBS) $(foreach p,$(PLUGINS),$(LIBS_$(p))) -pthread

# Where the time goes: these are called through the bench.
$(BUILD)/bench/self: private LDFLAGS += $(foreach f,self_list_each self_sum self_chunk_begin path_clear,-Xlinker --wrap=weft__$(f))

$(BUILD)/bench/mpi: $(MPI_SO)

# Without what debuggers want: older valgrinds cannot read what clang writes of it.
$(BUILD)/bench/guard/evaluate: $(BUILD)/bench/guard/evaluate.o $(BUILD)/libweft.a
	$(call say,LD)$(LINK) -Wl,--strip-debug -o $@ $^ $(LIB_LIBS)

# Instructions of the right-hand side, which must not become many more; files that a step calls,
# which CONTRIBUTING.md's map of the code must name.
guard: $(BUILD)/bench/guard/evaluate all
	@tools/guard $(BUILD) $(CC)
	@tools/reading-order $(BUILD)

# What a first reader reads, in lines.
.PHONY: core
core:
	@$(MAKE) --no-print-directory BUILD=$(BUILD)/core KERNEL=plain CFLAGS='-O1 -g -fno-inline' \
	    $(BUILD)/core/examples/scene $(BUILD)/core/plugins/weft-verlet.so $(BUILD)/core/plugins/weft-gsl.so
	@tools/core $(BUILD)/core

# Where what measures writes its pages; RENEW=1: into docs/, to be committed.
PAGES := $(if $(RENEW),docs,$(BUILD)/pages)

# Those of the page: all of them measured anew write project/speed.md to PAGES. The others follow.
BENCH_PAGE := force mesh steps growth memory
bench: all $(BENCHES:%=$(BUILD)/bench/%)
	@for name in $(filter $(BENCH_PAGE),$(BENCH)); do $(BUILD)/bench/$$name || exit 1; done
	@$(if $(filter-out $(BENCH),$(BENCH_PAGE)),:,tools/bench-page $(BUILD) $(PAGES))
	@for name in $(filter-out peers $(BENCH_PAGE),$(BENCH)); do $(BUILD)/bench/$$name || exit 1; done
	@$(if $(filter peers,$(BENCH)),BUILD=$(BUILD) PAGES=$(PAGES) tools/bench-peers)

# Exact and published results, computed by the program; writes theory/validation.md to PAGES. CASE='elastica-grid capstan': of these alone.
.PHONY: validate check-validation
validate: all
	@BUILD=$(BUILD) PAGES=$(PAGES) python3 validation/validate.py $(CASE)

# The quick half, 5 minutes on two cores, or with WHOLE=1 all: docs/theory/validation.md has these numbers.
check-validation: all
	@BUILD=$(BUILD) python3 validation/validate.py --check $(if $(WHOLE),,--quick)

# Packages first, then a second make: what the first one knew of them is out of date.
# On all processors, if no -j says otherwise.
ALL_OF_THEM = $(if $(findstring -j,$(MAKEFLAGS)),,-j $(shell getconf _NPROCESSORS_ONLN))

check: deps
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) $(if $(filter file,$(origin TESTS)),TESTS='$(filter-out $(SLOW),$(TESTS))') check-run

check-slow:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) TESTS='$(filter-out $(SLOW_WITHOUT),$(SLOW))' check-run

check-run: all $(TEST_BIN) $(BROKEN) $(PROMISES) $(PRELOADED) $(EXAMPLES) lint
	@TEST_TOGETHER='$(TOGETHER)' tools/run-tests $(BUILD) $(foreach t,$(TESTS),$(if $(filter $t,$(ALONE)),test_$t,'run $t'))

# Cloths in bands over MPI, on 1 to 4 ranks, and every file compared with a serial run.
.PHONY: check-mpi
check-mpi:
	@WITH_MPI=1 $(MAKE) --no-print-directory deps
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) all
	@tools/check-mpi $(BUILD)

# What is written, read by the programs it is meant for; what is not there is skipped. WHOLE=1: also of pages for many runs.
check-view: all
	@WHOLE=$(WHOLE) tools/check-view $(BUILD)

# The Python package in an environment of its own, built from this tree.
check-python: all
	@tools/check-python $(BUILD)

# The notebooks alone, which check-python runs too.
check-notebooks: all
	@tools/check-python $(BUILD) tests/test_notebooks.py

# How often weft fit finds the truth: 120 fits with noise, a quarter of an hour of a processor.
check-fit: all
	@TEST_LONG=1 tools/check-python $(BUILD) tests/test_fit.py

# The page that weft view fills: needs node and npm, and its result is committed.
viewer:
	@tools/viewer-packages
	node viewer/build.mjs

# docs/pictures, drawn by the player.
pictures: all
	@tools/pictures $(BUILD)

demo: deps
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) demo-run

demo-run: all
	@tools/demo $(BUILD)

# The one target that installs packages (tools/needs.txt): with WITH_MPI=1, WITH_CHECKS=1 (what .ci/run and `make nightly`
# call), WITH_PICTURES=1, WITH_WINDOW=1 or WITH_DIST=1, those too. Debian's place of HDF5, though it may be there only once
# the package is installed.
GROUPS = MPI CHECKS PICTURES WINDOW DIST
deps:
	@PREPROCESS='$(PREPROCESS) $(HDF5_CFLAGS) -isystem /usr/include/hdf5/serial $(MPI_CFLAGS)' \
	    tools/deps $(foreach g,$(GROUPS),$(if $(WITH_$g),$g))

include install.mk
include wasm/build.mk

# ---- care ------------------------------------------------------------------------

C_FILES = $(wildcard include/weft/*.h src/*/*.[ch] src/*/*/*.[ch] program/*.[ch] program/*/*.[ch] program/*/*/*.[ch] \
                     study/*.[ch] study/*/*.[ch] plugins/*/*.[ch] tests/*.[ch] \
                     tests/verify/*.[ch] tests/broken/*.c tests/promises/*.c tests/fuzz/*.[ch] examples/*.[ch] wasm/*.c bench/*.[ch] bench/levels/*.[ch] bench/guard/*.c)

lint: all
	@tools/lint $(C_FILES)
	@tools/versions
	@! { command -v python3 && git rev-parse --git-dir; } >/dev/null 2>&1 || { tools/pages && tools/words && tools/holds; }
	@tools/layers $(BUILD)

# A hook of git that checks the form of commit messages.
.PHONY: hooks
hooks:
	@tools/hooks

format:
	clang-format -i $(C_FILES)

# Tables that the program prints and the pages quote.
docs: all
	@tools/docs $(BUILD)

# Check's tests under AddressSanitizer and UBSan, in a build of its own, but those that compute for long what others run
# as well, run the program hundreds of times, or whose wide kernels
# compile for minutes, or cost much for the lines that no other runs (ASAN_WITHOUT=, as make nightly: all).
# The tests of a suite run in one process, as one each takes five times as long, but where memory is limited or measured.
ASAN_LONG := $(KERNEL_TESTS) verification agree papers libm bounds closed_forms ledger_order mesh_orders quadratures scenes \
             self_random self_time skin skin_time sensitivity compare stability stepper_accuracy stiffness \
             hostile surroundings record_ends record_damage cli_resume cli_batch cli_stability sundials_vector bands bands_ends bands_meshes bands_self steppers threads \
             cvode contact_time hostile_cost wind cloth_grids plate pins turn limit_sheet fit stiff untangle shapes_record \
             embed examples cli_output converge progress batch_ends contact_laws bending scene_fuzz crossing watch
ASAN_WITHOUT ?= $(ASAN_LONG)

asan:
	@$(if $(ASAN_WITHOUT),CK_EXCLUDE_TAGS=long) $(MAKE) --no-print-directory $(ALL_OF_THEM) BUILD=build/asan CFLAGS='-O1 -g1' \
	    TESTS='$(filter-out $(ASAN_WITHOUT),$(TESTS))' \
	    TOGETHER='$(TOGETHER) $(filter-out $(ASAN_LONG) jacobian hostile_cost,$(TESTS))' \
	    SAN='-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer' \
	    REPLAY=build/asan/tests/replay.o check-run replay

# Lines of src/, program/, study/ and plugins/ that the tests run.
COVERAGE_LEAST ?= 90

coverage:
	@find build/coverage -name '*.gcda' -delete 2>/dev/null || :
	@CK_TIMEOUT_MULTIPLIER=4 $(MAKE) --no-print-directory $(ALL_OF_THEM) BUILD=build/coverage CFLAGS='-O1 -g1' \
	    SAN='--coverage -fprofile-update=atomic' check-run
	@tools/coverage build/coverage $(COVERAGE_LEAST)

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
	@tools/static "$(STRICT) $(INCS) $(HDF5_CFLAGS) $(MPI_CFLAGS)" $(DEEP)

# Prints hashes of states, for builds that are compared.
$(BUILD)/hashes: $(BUILD)/tests/hashes.o $(BUILD)/libweft.a
	$(call say,LD)$(LINK) -o $@ $^ $(LIB_LIBS)

.PHONY: hashes
hashes: $(BUILD)/hashes $(PLUGIN_SO)

# The same bits from every compiler and at every level of optimization.
check-determinism: hashes
	@MAKE="$(MAKE)" tools/check-determinism $(BUILD) $(WHOLE)

# The same bits whatever libm and whatever processor; wants qemu-user.
check-libm: all $(BUILD)/tests/test_libm $(PRELOADED)
	@tools/check-libm $(BUILD)

# libFuzzer, a minute a target, as many at once as there are processors: `make fuzz FUZZ_SECONDS=1200 FUZZ=scene`.
# Without kernels, which take minutes to compile so: asan runs them.
FUZZ_SECONDS ?= 60
FUZZ ?= $(patsubst tests/fuzz/%.c,%,$(wildcard tests/fuzz/*.c))

$(BUILD)/fuzz/%: $(BUILD)/tests/fuzz/%.o $(REPLAY) $(BUILD)/tests/support.o $(PROGRAM) $(BUILD)/libweft.a $(PLUGIN_SO)
	@mkdir -p $(@D)
	$(call say,LD)$(LINK) $(if $(REPLAY),,-fsanitize=fuzzer) -o $@ $(filter %.o,$^) $(TEST_PLUGINS) $(filter %.a,$^) $(TEST_LIBS)

# These read in one process what the program reads in two.
FUZZ_HDF := frames vtkhdf
$(FUZZ_HDF:%=$(BUILD)/tests/fuzz/%.o): INCS += $(HDF5_CFLAGS)
$(FUZZ_HDF:%=$(BUILD)/fuzz/%): private LINK += -Wl,--wrap=fork,--wrap=waitpid

FUZZ_BUILD = BUILD=build/fuzz KERNEL=plain CC=clang CFLAGS='-O1 -g1' \
	    SAN='-Wno-pass-failed -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all' \
	    build/fuzz/weft $(PLUGINS:%=build/fuzz/plugins/weft-%.so)

fuzz:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) $(FUZZ_BUILD) $(FUZZ:%=build/fuzz/fuzz/%)
	@printf "%s\n" $(FUZZ) | xargs -P "$$(nproc)" -L 1 tools/fuzz build/fuzz $(FUZZ_SECONDS)

# 300 meshes as other programs write them and 500 scenes of several files, some damaged, with the sanitizers.
.PHONY: check-files
check-files:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) $(FUZZ_BUILD)
	@tools/check-files build/fuzz/weft

# The committed inputs alone, of targets that replay.c calls: asan has them.
REPLAYED := $(notdir $(wildcard tests/fuzz/corpus/*))
.PHONY: replay
replay: $(FUZZ:%=$(BUILD)/fuzz/%)
	@set -e; for target in $(REPLAYED); do $(BUILD)/fuzz/$$target tests/fuzz/corpus/$$target/*; done

# The smallest inputs that `make fuzz` has found for every branch, to be committed. Those of vtkhdf
# are too large: 35 kB each.
fuzz-corpus:
	@tools/fuzz-corpus build/fuzz $(filter-out vtkhdf,$(FUZZ))

# clang's warnings, without a build. `make fuzz` builds with clang.
clang-syntax: $(BUILD)/tests/suites.h
	@printf '%s\n' $(filter-out $(if $(HAVE_MPI),,program/mpi/%) $(if $(HAVE_SDL2),,%/window.c),$(filter %.c,$(C_FILES))) | xargs -P "$$(nproc)" -L 16 clang $(STRICT) $(WARN) \
	    $(INCS) -Itests -I$(BUILD)/tests $(HDF5_CFLAGS) $(CMINPACK_CFLAGS) $(MPI_CFLAGS) $(TEST_DEFS) -fsyntax-only

# Packages of Debian 13, built, installed, tested and removed in clean systems; needs root and debootstrap.
.PHONY: check-deb sbom tag
check-deb:
	@tools/check-deb $(BUILD)

# A bill of materials beside the artefacts.
sbom:
	@tools/sbom $(BUILD)/dist

# The tree is a release: checks that, and makes its tag.
tag: all $(BUILD)/tests/run
	@tools/tag $(BUILD)

# A licence and a copyright for every file; a bill of materials that is valid.
check-reuse:
	@tools/check-reuse $(BUILD)

valgrind: all
	@tools/valgrind $(BUILD)

# Tests of the steppers that differ with SUNDIALS's release, with no more built than they need.
STEPPER_TESTS := agree arkode cvode sundials_vector controllers methods
check-steppers:
	@$(MAKE) --no-print-directory TESTS='$(STEPPER_TESTS)' $(BUILD)/tests/run $(BUILD)/weft $(PLUGIN_SO) $(BROKEN)
	@tools/run-tests $(BUILD) $(STEPPER_TESTS:%='run %')

# Tests of the steppers against Debian 13's SUNDIALS 7, in a system of its own; root,
# debootstrap. WHOLE=1: every test, and the verification.
check-sundials7:
	@tools/check-sundials7 $(BUILD) $(WHOLE)

# Random cloths that are thrown at themselves, for so long, and then large scenes, which take a
# quarter of an hour: none passes through itself.
SECONDS ?= 600
check-self:
	@$(MAKE) --no-print-directory $(ALL_OF_THEM) TESTS='self_random self_time' $(BUILD)/tests/run
	SELF_SECONDS=$(SECONDS) CK_RUN_CASE=self $(BUILD)/tests/run self_random self_time

# What .ci/run leaves out because it is slow.
nightly: all
	@tools/tree $(BUILD)/tree remember
	$(MAKE) check-slow
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
	@tools/tree $(BUILD)/tree end nightly

# Built for 64-bit ARM and run by qemu-user: which methods have the same bits there.
check-aarch64: all
	@MAKE="$(MAKE)" tools/check-aarch64 $(BUILD)

# gcc 10 and clang 11 in a system of Debian 11: root, debootstrap.
check-compilers: all hashes
	@tools/check-compilers $(BUILD)

# Built where libraries, compilers or HDF5 are elsewhere or missing.
check-elsewhere: all hashes $(BUILD)/examples/minimal
	@tools/check-elsewhere $(BUILD)

symbols: $(BUILD)/libweft.so $(BUILD)/libweft.a $(PLUGIN_SO) $(MPI_SO)
	@tools/symbols $^

clean:
	rm -rf $(BUILD)

help:
	@sed -n '3,10s/^# \{0,1\}//p' Makefile
	@echo "make bench [BENCH=name] [RENEW=1] | check-slow | core | validate [CASE=] [RENEW=1] | check-validation | check-view | check-python | check-notebooks | check-fit | check-reuse | check-deb | sbom | tag | check-mpi | viewer | pictures | lint | hooks | format | docs | asan | fuzz | fuzz-corpus | check-files | coverage | static | check-determinism | check-libm | tsan | guard | clang-syntax | check-sundials7 | check-aarch64 | check-compilers | check-self [SECONDS=] | window | check-window | check-elsewhere | wasm | check-wasm | nightly | valgrind | symbols | clean"
	@echo "make install PREFIX= DESTDIR= | uninstall | check-install | check-docs | site | check-site | dist | check-dist | check-abi | renew-abi | doxygen"

-include $(shell find $(addprefix $(BUILD)/,src program study plugins tests examples bench) -name '*.d' 2>/dev/null)
