# SPDX-License-Identifier: BSD-3-Clause
"""Builds and bundles weft. In weft's source tree the package bundles library, plugins and
program, built by make (environment variables: those of the Makefile, such as BUILD and CC). Elsewhere
it uses the installed weft that pkg-config finds."""
import glob
import os
import re
import shutil
import subprocess
import sys

from setuptools import setup
from setuptools.command.build_ext import build_ext

sys.dont_write_bytecode = True  # beside the sources
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from _build import HERE, IN_TREE, INCLUDES, TREE, pkg_config  # noqa: E402


def version():
    with open(os.path.join(INCLUDES[0], "weft", "base.h"), encoding="utf-8") as header:
        return re.search(r'#define WEFT_VERSION "(.*)"', header.read())[1]


def bundle(prefix):
    """Builds weft in its tree and puts what the package needs below prefix."""
    shutil.rmtree(prefix, ignore_errors=True)  # an earlier version's
    env = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", "DESTDIR")}
    to = os.path.relpath(prefix, TREE)  # make would take a blank in the name of the tree for the end of a word
    command = [os.environ.get("MAKE", "make"), "--no-print-directory", "-C", TREE, "-j", str(os.cpu_count()),
               "bundle", "PREFIX=" + to, "LIBDIR=" + to + "/lib", "BINDIR=" + to + "/bin",
               "DOCDIR=" + to + "/share/doc/weft"]
    if subprocess.call(command, env=env) != 0:
        raise SystemExit("building weft failed; `make deps` in " + TREE + " installs the packages that it needs")


class Build(build_ext):
    def run(self):
        package = os.path.dirname(os.path.abspath(self.get_ext_fullpath("weft._weft")))
        prefix = "" if IN_TREE else pkg_config("--variable=prefix")
        for ext in self.extensions:
            if IN_TREE:
                bundle(os.path.join(package, "prefix"))
                ext.extra_objects += glob.glob(os.path.join(package, "prefix", "lib", "libweft.so.*"))
                ext.runtime_library_dirs.append("$ORIGIN/prefix/lib")
            else:
                if prefix != "/usr":  # where every linker looks
                    ext.library_dirs.append(pkg_config("--variable=libdir"))
                    ext.runtime_library_dirs.append(pkg_config("--variable=libdir"))
                ext.libraries.append("weft")
            ext.define_macros.append(("WEFTPY_PREFIX", '"%s"' % prefix))
        super().run()
        objects = self.compiler.compile([os.path.join(HERE, "own.c")], output_dir=self.build_temp, include_dirs=INCLUDES)
        self.compiler.link_shared_object(objects, os.path.join(package, "weft-own.so"))


def places():
    """In the tree, all that is built goes below build/, as what make builds."""
    if not IN_TREE:
        return {}
    base = os.path.join(TREE, os.environ.get("BUILD", "build"), "python-package")
    os.makedirs(base, exist_ok=True)
    return {"build": {"build_base": base}, "egg_info": {"egg_base": base}}


# Elsewhere the installed program is the command `weft`, perhaps in the same folder.
SCRIPTS = {"console_scripts": ["weft = weft.__main__:main"]} if IN_TREE else {}

setup(version=version(), entry_points=SCRIPTS, cffi_modules=["_build.py:ffi"], cmdclass={"build_ext": Build}, options=places())
