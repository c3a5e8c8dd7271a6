# SPDX-License-Identifier: BSD-3-Clause
# h5dump shows the times of a run, digit by digit, and every dataset.
set -eu
build=$1
out=$build/view/h5dump
command -v h5dump >/dev/null || { echo "view: h5dump skipped: not found (package hdf5-tools)"; exit 0; }
rm -rf "$out"
"$build/weft" run scenes/curtain.yaml --out "$out" --quiet --set run.duration=0.2
h5dump "$out/run.vtkhdf" >"$out/all.txt"
h5dump -d /VTKHDF/Steps/Values -m %.17g -y -w 1 "$out/run.vtkhdf" |
    sed -n '/DATA {/,/}/s/^ *\([0-9][^ ,]*\),* *$/\1/p' >"$out/times.txt"
tail -n +2 "$out/series.csv" | cut -d, -f2 | cmp - "$out/times.txt"
echo "view: h5dump ok, $(wc -l <"$out/times.txt") times"
