# SPDX-License-Identifier: BSD-3-Clause
# What is on this machine: libraries, MPI, and what the goals need.

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
$(error CC=$(CC) cannot compile: $(shell $(call probe,stdio.h) 2>&1 >/dev/null | grep -m 1 -e error -e found) \
    (packages gcc or clang, libc6-dev: 'apt-get install gcc libc6-dev' on Debian))
endif
HAVE_HDF5 := $(call has,hdf5.h,$(HDF5_CFLAGS))
# The server of --watch, of the program alone.
HAVE_HTTP := $(call has,microhttpd.h)
# The mesher of cloth.cut, of the program alone.
HAVE_QHULL := $(call has,libqhull_r/libqhull_r.h)
# The method of weft fit.
CMINPACK_CFLAGS ?= $(or \
    $(patsubst -I%,-isystem %,$(shell pkg-config --cflags cminpack 2>/dev/null)),-isystem /usr/include/cminpack-1)
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
goals := $(filter-out deps,$(or $(MAKECMDGOALS),all)) \
    $(if $(filter dist check-dist,$(MAKECMDGOALS)),$(patsubst %,dist/%,$(or $(DIST),\
    linux-x86_64 linux-aarch64 static-x86_64 static-aarch64 macos-arm64 windows-x86_64 pages))) \
    $(if $(filter bench,$(MAKECMDGOALS)),$(filter bench/peers,$(BENCH:%=bench/%)))
LACKING := $(if $(wildcard tools/machine/needs),$(shell \
    PREPROCESS='$(PREPROCESS) $(HDF5_CFLAGS) $(MPI_CFLAGS)' \
    tools/machine/needs $(foreach g,$(goals),$(call quoted,$g))))
$(if $(LACKING),$(error $(LACKING)$(if $(findstring libhdf5-dev,$(LACKING)),; the library and the plugins do without: \
    make $(BUILD)/libweft.so $(BUILD)/plugins/weft-verlet.so)))
