# SPDX-License-Identifier: BSD-3-Clause
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
$(BUILD)/bench/self: private LDFLAGS += \
    $(foreach f,self_list_each self_sum self_chunk_begin path_clear,-Xlinker --wrap=weft__$(f))

$(BUILD)/bench/mpi: $(MPI_SO)

# Without what debuggers want: older valgrinds cannot read what clang writes of it.
$(BUILD)/bench/guard/evaluate: $(BUILD)/bench/guard/evaluate.o $(BUILD)/libweft.a
	$(call say,LD)$(LINK) -Wl,--strip-debug -o $@ $^ $(LIB_LIBS)

# Instructions of the right-hand side, which must not become many more; files that a step calls,
# which CONTRIBUTING.md's map of the code must name.
guard: $(BUILD)/bench/guard/evaluate all
	@tools/checks/guard $(BUILD) $(CC)
	@tools/rules/reading-order $(BUILD)

# What a first reader reads, in lines.
.PHONY: core
core:
	@$(MAKE) --no-print-directory BUILD=$(BUILD)/core KERNEL=plain CFLAGS='-O1 -g -fno-inline' \
	    $(BUILD)/core/examples/scene $(BUILD)/core/plugins/weft-verlet.so $(BUILD)/core/plugins/weft-gsl.so
	@tools/rules/core $(BUILD)/core

# Where what measures writes its pages; RENEW=1: into docs/, to be committed.
PAGES := $(if $(RENEW),docs,$(BUILD)/pages)

# Those of the page: all of them measured anew write project/speed.md to PAGES. The others follow.
BENCH_PAGE := force mesh steps growth memory
bench: all $(BENCHES:%=$(BUILD)/bench/%)
	@for name in $(filter $(BENCH_PAGE),$(BENCH)); do $(BUILD)/bench/$$name || exit 1; done
	@$(if $(filter-out $(BENCH),$(BENCH_PAGE)),:,tools/pages/bench-page $(BUILD) $(PAGES))
	@for name in $(filter-out peers $(BENCH_PAGE),$(BENCH)); do $(BUILD)/bench/$$name || exit 1; done
	@$(if $(filter peers,$(BENCH)),BUILD=$(BUILD) PAGES=$(PAGES) tools/pages/bench-peers)

# Exact and published results, computed by the program; writes theory/validation.md to PAGES.
# CASE='elastica-grid capstan': of these alone.
.PHONY: validate check-validation
validate: all
	@BUILD=$(BUILD) PAGES=$(PAGES) python3 validation/validate.py $(CASE)

# The quick half, 5 minutes on two cores, or with WHOLE=1 all: docs/theory/validation.md has these numbers.
check-validation: all
	@BUILD=$(BUILD) python3 validation/validate.py --check $(if $(WHOLE),,--quick)
