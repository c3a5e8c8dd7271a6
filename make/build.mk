# SPDX-License-Identifier: BSD-3-Clause
VERSION := $(shell sed -n 's/^.define WEFT_VERSION "\(.*\)"/\1/p' include/weft/base.h)
SOVERSION := $(shell sed -n 's/^.define WEFT_INTERFACE //p' include/weft/base.h)

FAST     := $(wildcard src/forces/*/*_fast.c src/forces/*/*/*_fast.c)
LIB_SRC  := $(filter-out $(FAST),\
    $(wildcard $(patsubst %,src/%/*.c,\
        base mesh forces/* forces/*/* cloth cloth/* sim sim/* plugin stability scene scene/*)))
LIB_OBJ  := $(LIB_SRC:%.c=$(BUILD)/%.o)
# The fast forms of forces, once more for each level of instructions that src/base/isa.c chooses
# from. KERNEL=plain, or all *_fast.c deleted: none, the plain loops have the same bits.
KERNELS  := $(if $(filter plain,$(KERNEL)),,$(FAST:%.c=$(BUILD)/%))
LIB_OBJ  += $(KERNELS:=.o)
LEVELS   := $(if $(filter x86_64%,$(TARGET)),v3 v4)
LIB_OBJ  += $(foreach level,$(LEVELS),$(KERNELS:=.$(level).o))
RECORD_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(wildcard program/record/*.c program/record/*/*.c)) \
    $(BUILD)/program/record/pages.o
# STUDY=no: without the verbs that study scenes and methods.
STUDY_SRC := $(if $(filter no,$(STUDY)),,$(wildcard study/*.c study/*/*.c))
PROG_OBJ := $(RECORD_OBJ) $(patsubst %.c,$(BUILD)/%.o,$(wildcard program/*.c) \
    $(filter-out $(patsubst %,program/%/%,cut mpi record),$(wildcard program/*/*.c)) $(STUDY_SRC))
PROG_OBJ := $(filter-out $(if $(HAVE_HTTP),,%/watch_server.o),$(PROG_OBJ))
PROG_OBJ += $(if $(HAVE_QHULL),$(patsubst %.c,$(BUILD)/%.o,$(wildcard program/cut/*.c)))
PROG_LIBS := $(HDF5_LIBS) $(if $(HAVE_HTTP),-lmicrohttpd) \
    $(if $(HAVE_QHULL),-lqhull_r) $(if $(HAVE_CMINPACK),-lcminpack)
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
$(addprefix $(BUILD)/src/,sim/adjoint.o sim/between.o sim/wave.o cloth/parameter_derivative.o): OWN += $(if $(SAN),,-O3)
# Lines for debuggers, but not the places of variables: those of inlined loops take a third of the compiler's time.
KERNEL_FLAGS := $(if $(SAN),,-O2 $(if $(filter -g,$(CFLAGS)),-g1)) -fno-math-errno -fno-trapping-math
# clang 11 has no names of levels.
NAMED := $(if $(LEVELS),$(shell $(CC) -march=x86-64-v4 -E -x c /dev/null >/dev/null 2>&1 && echo yes))
V3 := $(if $(NAMED),-march=x86-64-v3,-mavx2 -mfma -mbmi -mbmi2)
V4 := $(if $(NAMED),-march=x86-64-v4,$(V3) -mavx512f -mavx512bw -mavx512cd -mavx512dq -mavx512vl)
$(BUILD)/%.v3.o: OWN += $(V3) -DLEVEL=v3 -DLANES=4
$(BUILD)/%.v4.o: OWN += $(V4) -mprefer-vector-width=512 -DLEVEL=v4 -DLANES=8
SELF_FAST := $(BUILD)/src/forces/contact/self/self_fast
$(SELF_FAST).o $(LEVELS:%=$(SELF_FAST).%.o): OWN += -funroll-loops
$(KERNELS:=.o) $(foreach level,$(LEVELS),$(KERNELS:=.$(level).o)): OWN += $(KERNEL_FLAGS)
# They are not asked for undefined behaviour, which takes seven times as long to compile: the plain forms are.
# gcc's checks of addresses as calls, beyond some of them in a function: half the time to compile.
CALLS := $(if $(findstring address,$(SAN)),$(if $(findstring clang,$(CC)),,\
    --param asan-instrumentation-with-call-threshold=100))
$(KERNELS:=.o) $(foreach level,$(LEVELS),$(KERNELS:=.$(level).o)): \
    override SAN := $(strip $(SAN:%,undefined=%) $(CALLS))
HARDER := seek/boxes_fast seek/seek_fast contact/contact_fast membrane/membrane_fast membrane/membrane_arc_fast
$(foreach f,$(HARDER),$(BUILD)/src/forces/$f.o $(LEVELS:%=$(BUILD)/src/forces/$f.%.o)): OWN += $(if $(SAN),,-O3)
$(foreach level,$(LEVELS),$(KERNELS:=.$(level).o)): $(BUILD)/src/forces/%.o:
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -c -o $@ src/forces/$(basename $*).c

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(call say,CC)$(COMPILE) -c -o $@ $<

# The pages, built from viewer/ by `make viewer` and committed, and the scene of `weft new`, as strings:
# program/record/page.h.
$(BUILD)/program/record/pages.c: viewer/dist/player.html viewer/dist/compare.html scenes/hammock.yaml
	@mkdir -p $(@D)
	$(call say,GEN)for page in $^; do \
	    name=$${page##*/} && echo "const char weft__$${name%.*}_page[] =" && \
	    LC_ALL=C sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' "$$page" && echo ';'; done >$@

$(BUILD)/program/record/pages.o: $(BUILD)/program/record/pages.c
	$(call say,CC)$(CC) $(STRICT) $(CPPFLAGS) $(CFLAGS) $(SAN) -c -o $@ $<

ifneq ($(HAVE_HDF5),yes)
$(filter-out %/pages.o,$(RECORD_OBJ)):
	@echo "weft, the program, needs hdf5.h, which CC with HDF5_CFLAGS='$(HDF5_CFLAGS)' does not find" \
	    "(package libhdf5-dev: make deps);" >&2
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
$(BUILD)/weft-static: packaging/wasm/built_in.c $(sort $(PROG_OBJ) \
    $(filter-out %/loading.o,$(LIB_OBJ)) $(foreach p,$(BUILT_IN),$(PLUGIN_OBJ_$(p))))
	$(call say,LD)$(COMPILE) -static -o $@ $^ $(LDFLAGS) $(foreach p,$(BUILT_IN),$(LIBS_$(p))) $(PROG_LIBS) $(LIB_LIBS)

$(BUILD)/program/mpi/comm_mpi.o: INCS += $(MPI_CFLAGS)
$(BUILD)/plugins/weft-mpi.so: $(BUILD)/program/mpi/comm_mpi.o
	@mkdir -p $(@D)
	$(call say,LD)$(LINK) -shared $(call soname,weft-mpi.so) -o $@ $^ $(MPI_LINK) $(LDLIBS)

# Loops over whole states, which gcc does not vectorise at -O2.
$(BUILD)/plugins/sundials/sundials_arithmetic.o $(BUILD)/plugins/gsl/gsl_control.o $(BUILD)/plugins/verlet/verlet.o \
$(patsubst %.c,$(BUILD)/%.o,plugins/stiff/arithmetic.c $(wildcard plugins/linear/*.c)): OWN += $(if $(SAN),,-O3)

# All that include SUNDIALS.
$(patsubst %,$(BUILD)/plugins/%/%.o,arkode cvode sundials) $(BUILD)/tests/test_sundials_vector.o \
$(BUILD)/bench/vectors.o: INCS += $(MPI_INC)
