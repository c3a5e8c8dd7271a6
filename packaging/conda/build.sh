#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs weft without GSL and the Python package that uses it below PREFIX. conda sets PREFIX, PYTHON and CPU_COUNT.
set -eu
settings="PREFIX=$PREFIX WARN=-Wall HAVE_GSL= HAVE_MPI= INSTALLED_BY=conda"
CPPFLAGS="${CPPFLAGS-} -I$PREFIX/include" LDFLAGS="${LDFLAGS-} -L$PREFIX/lib -Wl,-rpath,$PREFIX/lib"
export CPPFLAGS LDFLAGS PKG_CONFIG_PATH="$PREFIX/lib/pkgconfig"
make -j "${CPU_COUNT:-2}" all $settings
make install $settings
# A copy outside the tree, so that the package uses the installation and bundles none.
copy=$(mktemp -d)
cp -r python "$copy"
"${PYTHON:-python3}" -m pip install --no-deps --no-build-isolation -v "$copy/python"
rm -r "$copy"
