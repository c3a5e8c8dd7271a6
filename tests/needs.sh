#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# tests/needs.sh FOLDER: tools/machine/needs.txt against the makefiles. Prints each target that has no line there, each line of no
# target, and each program of the table that a target's recipe, or a script of tools/ that it calls, names although the line
# does not; then, with a PATH that lacks these programs, each target that does not name what it lacks and how to install it.
set -u
tmp=$1
table=tools/machine/needs.txt
rm -rf "$tmp" && mkdir -p "$tmp/bin"
cat Makefile make/*.mk >"$tmp/makefiles"
grep -oE '^[a-z][A-Za-z0-9 -]*:( |$)' "$tmp/makefiles" | tr -d : | tr ' ' '\n' | sed '/^always$/d; /^$/d' | sort -u >"$tmp/targets"
sed -n 's,^target \([^ ]*\).*,\1,p' $table | grep -v / | sort >"$tmp/lines"
comm -23 "$tmp/targets" "$tmp/lines" | sed 's/$/: no line in tools\/needs.txt/'
comm -13 "$tmp/targets" "$tmp/lines" | sed 's/$/: no target of the makefiles/'

packages() { # TARGET -> PACKAGE or PACKAGE?, one a line
    for word in $(sed -n "s,^target $1\(/[^ ]*\)*  *[^ ]* *,,p" $table); do
        case $word in *:) packages "${word%:}" ;; *) echo "$word" ;; esac
    done | sort -u
}
text() { # FILE, and the scripts that it calls, without comments
    sed 's/^ *#.*//; s/ # .*//' "$1"
    for script in $(grep -o 'tools/[a-z0-9-]*' "$1" | sort -u); do
        case " $seen " in *" $script "*) continue ;; esac
        seen="$seen $script"
        [ ! -f "$script" ] || text "$script"
    done
}
# PROGRAM PACKAGE; every system that builds weft has a compiler
sed -n 's/^package \([^ ]*\)  *\([a-zA-Z$][^ ]*\)$/\2 \1/p' $table | sed 's/^[$].*-chromium}/chromium/; /^gcc /d' >"$tmp/programs"
any=$(cut -d ' ' -f 1 "$tmp/programs" | sed 's/+/[+]/g' | paste -sd '|')
while read -r target; do
    awk -v target="$target" '
        /^[a-z][A-Za-z0-9 -]*:( |$)/ { n = split(substr($0, 1, index($0, ":") - 1), name, " "); on = 0
                                       for (i = 1; i <= n; ++i) on = on || name[i] == target; next }
        /^\t/ { if (on) print; next }
        { on = 0 }' "$tmp/makefiles" >"$tmp/recipe"
    packages "$target" >"$tmp/has"
    seen=
    text "$tmp/recipe" | grep -oE "(^|[^a-zA-Z0-9_./-])($any)( |\$|\")" | grep -oE "[a-z0-9][a-z0-9_+-]*" | sort -u >"$tmp/named"
    while read -r program; do
        package=$(sed -n "s/^$program //p" "$tmp/programs")
        case $target:$program in help:* | guard:clang | check-docs:mpirun) continue ;; esac # printed, compared, imitated
        grep -qxF -e "$package" -e "$package?" "$tmp/has" || echo "$target: calls $program; its line has no $package"
    done <"$tmp/named"
done <"$tmp/targets"

# All programs but those of the table.
for directory in $(echo "$PATH" | tr : ' '); do
    case $directory in *ccache*) continue ;; esac # which looks for the compiler in PATH again
    ln -s "$directory"/* "$tmp/bin" 2>/dev/null
done
cut -d ' ' -f 1 "$tmp/programs" | (cd "$tmp/bin" && xargs rm -f)
rm -f "$tmp"/bin/python3*
while read -r target; do
    lacks=
    for package in $(packages "$target" | grep -v '?'); do
        ! grep -q " $package\$" "$tmp/programs" || lacks="$lacks $package"
    done
    parts=$(sed -n "s,^target \(${target#check-}/[^ ]*\) .*,\1,p" $table)
    said=$(PATH="$tmp/bin" CHROMIUM= tools/machine/needs "$target" $parts 2>/dev/null)
    for package in $lacks; do
        case $said in *" $package"*"make deps' installs that"*) ;; *) echo "$target: does not say that it needs $package: $said" ;; esac
    done
done <"$tmp/targets"

# The same from make itself, which builds nothing first.
for target in site dist wasm format validate viewer clang-syntax; do
    ! PATH="$tmp/bin" make -s --no-print-directory BUILD="$tmp/build" $target >"$tmp/said" 2>&1 || echo "make $target: succeeds"
    grep -q "[*][*][*] make $target needs .*: '.*make deps' installs that" "$tmp/said" && [ ! -e "$tmp/build" ] || {
        echo "make $target: says"
        cat "$tmp/said"
    }
done
exit 0
