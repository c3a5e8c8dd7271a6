# SPDX-License-Identifier: BSD-3-Clause
"""The command `weft` of this package, and `python -m weft`: the program weft that lies in it."""
from __future__ import annotations

import os
import sys

from weft.library import Error
from weft.runs import program


def main() -> None:
    """Becomes the program, with the arguments of the command line."""
    try:
        path = str(program())
    except Error as error:
        sys.exit("weft: error: %s" % error)
    os.execv(path, [path, *sys.argv[1:]])


if __name__ == "__main__":
    main()
