#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prints the newest usable Python >= 3.11 on the PATH; PYTHON=/path/to/python chooses one.
set -u

probe='
import sys
release = sys.version_info
if release < (3, 11):
    sys.exit("older than 3.11")
if release.releaselevel != "final":
    sys.exit("a pre-release")
try:
    import ensurepip, venv
except ImportError:
    sys.exit("without the venv module: install python3-venv (Debian, Ubuntu)")
import os, sysconfig
if not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")):
    sys.exit("without its C headers: install python3-dev (Debian, Ubuntu) or python3-devel (Fedora)")
print("%03d%03d%03d" % release[:3])
'

if [ -n "${PYTHON:-}" ]; then
  if reason=$("$PYTHON" -I -c "$probe" 2>&1 >/dev/null); then
    command -v "$PYTHON"
    exit 0
  fi
  echo "error: PYTHON=$PYTHON cannot be used: ${reason##*
}" >&2
  exit 2
fi

best=
newest=0
refused=
old_ifs=$IFS
IFS=:
for folder in $PATH; do
  IFS=$old_ifs
  for candidate in "$folder"/python3.[0-9] "$folder"/python3.[0-9][0-9] "$folder"/python3 "$folder"/python; do
    [ -x "$candidate" ] || continue
    if version=$("$candidate" -I -c "$probe" 2>/dev/null); then
      if [ "$version" -gt "$newest" ] 2>/dev/null; then
        newest=$version
        best=$candidate
      fi
    else
      reason=$("$candidate" -I -c "$probe" 2>&1 >/dev/null | tail -n 1)
      refused="$refused
  $candidate: $reason"
    fi
  done
done
IFS=$old_ifs

if [ -z "$best" ]; then
  echo "error: no usable Python >= 3.11 on the PATH; install one, or name it: make PYTHON=/path/to/python3$refused" >&2
  exit 2
fi
printf '%s\n' "$best"
