# SPDX-License-Identifier: BSD-3-Clause
# libweft for WebAssembly, with the plugins arkode, stiff and verlet linked in, and libyaml and
# SUNDIALS from Debian's source packages: `make wasm`. docs/start/playground.md

WASM := $(BUILD)/wasm
WASM_CC ?= clang-14
WASM_YAML := $(WASM)/sources/libyaml
WASM_SUNDIALS := $(WASM)/sources/sundials
WASM_COMPILE = $(WASM_CC) --target=wasm32-wasi -O2 -msimd128 -fno-math-errno -ffp-contract=off \
    -fvisibility=hidden -ffile-prefix-map=$(WASM)/= -Ipackaging/wasm -I$(WASM_YAML)/include \
    -I$(WASM_SUNDIALS)/include -MMD -MP
# One thread, packaging/wasm/platform.c, and nothing is loaded, packaging/wasm/built_in.c.
WASM_SRC := $(filter-out src/base/thread_pool.c src/plugin/loading.c,$(LIB_SRC)) $(if $(KERNELS),$(FAST)) \
    $(wildcard $(patsubst %,plugins/%/*.c,verlet stiff arkode sundials linear stabilised)) \
    packaging/wasm/platform.c packaging/wasm/built_in.c
WASM_YAML_SRC := $(addprefix src/,api reader scanner parser loader writer emitter dumper)
WASM_SUNDIALS_SRC := $(addprefix src/,$(addprefix arkode/arkode,$(addprefix _,adapt arkstep arkstep_io \
    arkstep_nls butcher butcher_dirk butcher_erk erkstep erkstep_io interp io ls mri_tables mristep mristep_io \
    mristep_nls root)) arkode/arkode $(addprefix sundials/sundials_,band context dense direct futils iterative \
    linearsolver logger math matrix memory nonlinearsolver nvector nvector_senswrapper version) \
    nvector/serial/nvector_serial sunlinsol/spgmr/sunlinsol_spgmr sunnonlinsol/newton/sunnonlinsol_newton \
    sunmatrix/band/sunmatrix_band sunmatrix/dense/sunmatrix_dense)
WASM_OBJ := $(patsubst %.c,$(WASM)/%.o,$(WASM_SRC)) $(WASM_YAML_SRC:%=$(WASM)/yaml/%.o) \
    $(WASM_SUNDIALS_SRC:%=$(WASM)/sundials/%.o)
WASM_FETCHED := $(WASM)/sources/.fetched

.PHONY: wasm check-wasm playground
wasm: $(WASM)/libweft.a $(WASM)/hashes.wasm $(WASM)/page.wasm

$(WASM_FETCHED): tools/machine/sources
	@echo 'int main(void) { return 0; }' | $(WASM_CC) --target=wasm32-wasi -x c - -o /dev/null 2>/dev/null || { \
	    echo "$(WASM_CC) compiles nothing for wasm32-wasi (Debian's packages clang-14 lld-14 wasi-libc" \
	    "libclang-rt-14-dev-wasm32): 'WITH_CHECKS=1 make deps' installs them" >&2; exit 1; }
	$(call say,GET)tools/machine/sources $(@D) libyaml sundials && touch $@
$(WASM)/sources/%: $(WASM_FETCHED) ;

$(WASM)/%.o: %.c $(WASM_FETCHED)
	@mkdir -p $(@D)
	$(call say,CC)$(WASM_COMPILE) -std=c11 -D_POSIX_C_SOURCE=200809L $(WARN) -Wno-pass-failed $(INCS) \
	    $(if $(KERNELS),,-DWEFT_PLAIN) -c -o $@ $<

$(WASM_YAML_SRC:%=$(WASM)/yaml/%.o): $(WASM)/yaml/%.o: $(WASM_FETCHED)
	@mkdir -p $(@D)
	$(call say,CC)$(WASM_COMPILE) -w -DYAML_VERSION_MAJOR=0 -DYAML_VERSION_MINOR=2 -DYAML_VERSION_PATCH=5 \
	    -DYAML_VERSION_STRING='"0.2.5"' -c -o $@ $(WASM_YAML)/$*.c

$(WASM_SUNDIALS_SRC:%=$(WASM)/sundials/%.o): $(WASM)/sundials/%.o: $(WASM_FETCHED)
	@mkdir -p $(@D)
	$(call say,CC)$(WASM_COMPILE) -w -I$(WASM_SUNDIALS)/src/sundials -I$(WASM_SUNDIALS)/src/arkode \
	    -c -o $@ $(WASM_SUNDIALS)/$*.c

$(WASM)/libweft.a: $(WASM_OBJ)
	$(call say,AR)rm -f $@ && llvm-ar-14 rcs $@ $^

# 1 MB of stack below the data: beyond its end is no memory.
$(WASM)/%.wasm: $(WASM)/libweft.a
	$(call say,LD)$(WASM_CC) --target=wasm32-wasi -O2 $(WASM_LINK) -Wl,--stack-first -Wl,-z,stack-size=1048576 \
	    -Wl,--strip-debug -o $@ $(filter %.o,$^) $(filter %.a,$^) -lm

$(WASM)/hashes.wasm: $(WASM)/tests/hashes.o
$(WASM)/page.wasm: $(WASM)/packaging/wasm/page.o
$(WASM)/page.wasm: WASM_LINK = -mexec-model=reactor

# The same bits as those of this machine, also in the playground in a browser.
check-wasm: wasm hashes playground
	@node packaging/wasm/check.mjs $(BUILD)
	@WEFT_BUILD=$(BUILD) node --test viewer/test/playground.mjs

# One page, which fetches nothing when it is shown.
playground: $(BUILD)/playground.html
$(BUILD)/playground.html: $(WASM)/page.wasm $(wildcard viewer/src/* viewer/*.mjs viewer/*.json scenes/*)
	@tools/pages/viewer-packages
	$(call say,GEN)node viewer/playground.mjs $(WASM) $@

-include $(shell find $(WASM) -name '*.d' 2>/dev/null)
