# SPDX-License-Identifier: BSD-3-Clause
from spack.package import *


class Weft(MakefilePackage):
    """Simulates cloth as springs or as triangles of measured fabric under solvers that you choose."""

    manual_download = True  # until the source archive has an address; then url, and sha256 below

    license("BSD-3-Clause", when="~gsl")
    license("BSD-3-Clause AND GPL-3.0-or-later", when="+gsl")

    version("0.2.0")

    variant("gsl", default=True, description="The plugin of GSL, which is under the GPL")
    variant("sundials", default=True, description="The plugins of ARKODE and CVODE")
    variant("mpi", default=False, description="One cloth over many machines (weft run --bands)")
    variant("watch", default=False, description="Runs in the browser while they run (weft run --watch)")
    variant("cut", default=True, description="Meshes of outlines (cloth.cut)")
    variant("fit", default=True, description="Numbers from measured tracks (weft fit)")

    depends_on("c", type="build")
    depends_on("gmake@4.3:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("libyaml")
    depends_on("hdf5~mpi")
    depends_on("gsl", when="+gsl")
    depends_on("sundials@6.4:7+arkode+cvode~mpi", when="+sundials")
    depends_on("mpi", when="+mpi")
    depends_on("libmicrohttpd", when="+watch")
    depends_on("qhull", when="+cut")
    depends_on("cminpack+shared", when="+fit")

    @property
    def settings(self):
        """What the Makefile would find elsewhere on the machine is not there for it."""
        found = {"HAVE_GSL": "+gsl", "HAVE_ARKODE": "+sundials", "HAVE_CVODE": "+sundials", "HAVE_MPI": "+mpi",
                 "HAVE_HTTP": "+watch", "HAVE_QHULL": "+cut", "HAVE_CMINPACK": "+fit"}
        words = [name + "=" for name, variant in found.items() if variant not in self.spec]
        hdf5 = self.spec["hdf5"]
        return words + ["INSTALLED_BY=spack", "WARN=-Wall", "HDF5_CFLAGS=-I" + hdf5.prefix.include, "HDF5_LIBS=" + hdf5.libs.ld_flags,
                        "PREFIX=" + self.prefix]

    def build(self, spec, prefix):
        make("all", *self.settings)

    def install(self, spec, prefix):
        make("install", *self.settings)
