# SPDX-License-Identifier: BSD-3-Clause
$(if $(filter 3.% 4.0 4.0.% 4.1 4.1.% 4.2 4.2.%,$(MAKE_VERSION)),\
    $(error weft needs GNU make 4.3 or later; this is $(MAKE_VERSION)))
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

include make/find.mk
include make/build.mk
include make/test.mk
include make/bench.mk
include make/check.mk

.DEFAULT_GOAL := all
.PHONY: all clean help check check-run check-slow check-reuse check-view check-python check-notebooks check-fit \
        viewer pictures verify bench demo demo-run deps docs lint format asan tsan guard fuzz fuzz-corpus coverage \
        static check-determinism check-libm clang-syntax check-self check-steppers check-sundials7 check-aarch64 \
        check-compilers check-elsewhere nightly valgrind symbols
.DELETE_ON_ERROR:
.SECONDARY:

all: $(BUILD)/libweft.so $(BUILD)/libweft.a $(BUILD)/weft $(PLUGIN_SO) $(MPI_SO) skipped

.PHONY: skipped
skipped:
	@$(if $(HAVE_HTTP),:,echo "--watch skipped: microhttpd.h not found (package libmicrohttpd-dev: make deps)")
	@$(if $(HAVE_CMINPACK),:,echo "weft fit skipped: cminpack.h not found (package libcminpack-dev: make deps)")
	@$(if $(HAVE_QHULL),:,echo "cloth.cut skipped: libqhull_r/libqhull_r.h not found (package libqhull-dev: make deps)")
	@$(if $(HAVE_GSL),:,echo "plugin gsl skipped: gsl/gsl_odeiv2.h not found (package libgsl-dev: make deps)")
	@$(if $(HAVE_ARKODE),:,echo "plugin arkode skipped: arkode/arkode_erkstep.h not found" \
	    "(package libsundials-dev: make deps)")
	@$(if $(HAVE_MPI),:,echo "weft-mpi.so skipped (weft run --bands): mpicc not found" \
	    "(package libopenmpi-dev: WITH_MPI=1 make deps)")
	@$(if $(HAVE_CVODE),:,echo "plugin cvode skipped: cvode/cvode.h not found (package libsundials-dev: make deps)")

include make/install.mk
include make/wasm.mk
include make/care.mk
include make/nightly.mk

clean:
	rm -rf $(BUILD)

help:
	@sed -n '4,11s/^# \{0,1\}//p' Makefile
	@printf 'make %s\n' \
	    'install PREFIX= DESTDIR= | uninstall | bundle PREFIX=' \
	    'check-slow | check-python | check-notebooks | check-view | check-docs | check-mpi | check-install' \
	    'check-validation | check-determinism | check-libm | check-reuse | check-wasm | check-window | check-abi' \
	    'check-files | check-fit | check-self [SECONDS=] | check-elsewhere | check-compilers | check-sundials7' \
	    'check-aarch64 | check-deb | check-dist | check-site | mutations | nightly' \
	    'asan | tsan | valgrind | static | clang-syntax | fuzz | fuzz-corpus | coverage | guard | core' \
	    'lint | hooks | format | docs | doxygen | site | viewer | pictures | wasm | window | playground' \
	    'bench [BENCH=name] [RENEW=1] | validate [CASE=] [RENEW=1]' \
	    'dist | sbom | tag | symbols | renew-abi | clean'

-include $(shell find $(addprefix $(BUILD)/,src program study plugins tests examples bench) -name '*.d' 2>/dev/null)
