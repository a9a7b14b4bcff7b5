#!/usr/bin/env bash
# Print the path of a Python that can run the project, with venv. WONDERFUL_TEAM_PYTHON names one. Says what was looked for otherwise.
set -u
OLDEST=11 # as in pyproject.toml: Python 3.11 ...
NEWEST=14 # ... to 3.14, the newest that every locked package has a wheel for
PROBE="import sys; a, b = sys.version_info[:2]; print('%d.%d' % (a, b)); sys.exit((a, b) < (3, $OLDEST) or (a, b) > (3, $NEWEST))"

rejected=""
if [ -n "${WONDERFUL_TEAM_PYTHON:-}" ]; then
    names=("$WONDERFUL_TEAM_PYTHON")
else
    names=(python3)
    for minor in 13 12 11 14; do names+=("python3.$minor"); done
fi
for name in "${names[@]}"; do
    path=$(command -v "$name" 2>/dev/null) || { rejected="${rejected:+$rejected, }$name (not on the PATH)"; continue; }
    # Some tools put stand-ins on the path that only say that a version is not installed: run it to find out.
    version=$("$path" -c "$PROBE" 2>/dev/null) && usable=yes || usable=no
    if [ -z "$version" ]; then
        rejected="${rejected:+$rejected, }$name (does not run)"
    elif [ $usable = no ]; then
        rejected="${rejected:+$rejected, }$name ($version)"
    elif ! "$path" -c 'import venv, ensurepip' 2>/dev/null; then
        rejected="${rejected:+$rejected, }$name ($version without venv; on Debian and Ubuntu: the package python$version-venv)"
    else
        echo "$path"
        exit 0
    fi
done
echo "No usable Python: 3.$OLDEST to 3.$NEWEST with venv is needed. Looked for: $rejected. WONDERFUL_TEAM_PYTHON=/path/to/python names one." >&2
exit 1
