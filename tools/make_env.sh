#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Creates the virtual environment FOLDER unless a working one made for this very place is there.
set -eu

venv=$1
here=$(pwd -P)
mark=$venv/.made-for # scripts of an environment hold absolute paths: it must not survive a move of the repository

works() {
  "$venv/bin/python" -I -c 'import sys, pip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null
}

if [ -f "$mark" ]; then
  if [ "$(cat "$mark")" = "$here" ] && works; then
    exit 0
  fi
  echo "the environment '$venv' was made for another place, or its Python is gone: making it again"
  rm -rf "$venv" build
elif [ -e "$venv" ]; then
  if ! works; then
    echo "error: '$venv' is there already, but has no pip or no Python >= 3.11; move it away, or choose" \
      "another folder: make VENV=.venv-slipwise ..." >&2
    exit 2
  fi
  echo "using the environment '$venv' that is there already"
  printf '%s\n' "$here" >"$mark"
  exit 0
fi

compiler=${CXX:-}
for candidate in c++ g++ clang++; do
  [ -n "$compiler" ] || ! command -v "$candidate" >/dev/null || compiler=$candidate
done
if [ -z "$compiler" ]; then
  echo "error: no C++ compiler found; install g++ >= 12 or clang >= 15, or name one: make CXX=/path/to/compiler" >&2
  exit 2
fi

python=$(sh tools/find_python.sh)
echo "creating '$venv' with $("$python" --version) ($python)"
mkdir -p "$venv"
printf '%s\n' "$here" >"$mark"
"$python" -m venv "$venv"
echo '*' >"$venv/.gitignore"
