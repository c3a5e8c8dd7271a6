# SPDX-License-Identifier: BSD-3-Clause
# VTK itself reads what weft writes: the oldest that knows temporal VTKHDF, which is the
# strictest, and with WHOLE=1 the newest. Wheels go into environments of their own below build/view.
set -u
build=$1
failed=0
for version in ==9.3.1 ${WHOLE:+'>9.3.1'}; do
    home=$build/view/vtk$version
    if ! "$home/bin/python" -c 'import vtk' 2>/dev/null; then
        { python3 -m venv "$home" && "$home/bin/pip" install -q "vtk$version"; } >"$home.log" 2>&1
    fi
    if "$home/bin/python" -c 'import vtk' 2>/dev/null; then
        "$home/bin/python" tests/view/vtk_read.py "$build" || failed=1
    else
        echo "view: vtk$version skipped: the wheel cannot be installed ($home.log)"
    fi
done
exit $failed
