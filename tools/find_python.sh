#!/usr/bin/env bash
# Print the path of a Python that can run the project: 3.11 or newer, with venv. Says what is missing otherwise.
set -u
found_old=""
for name in ${WONDERFUL_TEAM_PYTHON:-} python3 python3.13 python3.12 python3.11 python3.14; do
    path=$(command -v "$name" 2>/dev/null) || continue
    # Some tools put stand-ins on the path that only say that a version is not installed: run it to find out.
    version=$("$path" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) || continue
    if ! "$path" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
        found_old="$found_old $name=$version"
        continue
    fi
    if ! "$path" -c 'import venv, ensurepip' 2>/dev/null; then
        echo "$name is Python $version but has no venv module (on Debian and Ubuntu: the package python$version-venv)" >&2
        continue
    fi
    echo "$path"
    exit 0
done
echo "No usable Python: 3.11 or newer with venv is needed; found:${found_old:- none}. Set WONDERFUL_TEAM_PYTHON to name one." >&2
exit 1
