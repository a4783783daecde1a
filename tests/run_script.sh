#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run_script.sh SCRIPT: how CTest runs a test script: on a virtual display, in
# the empty folder $WORK, with MeshLab's settings beside it.
set -euo pipefail

settings=$WORK.settings
rm -rf "$WORK" "$settings"
mkdir -p "$WORK" "$settings"
chmod 700 "$settings"
cd "$WORK"
export XDG_CONFIG_HOME=$settings XDG_RUNTIME_DIR=$settings LC_ALL=C.UTF-8
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$SOURCE_DIR/tests

interpreter=bash
[[ $1 == *.py ]] && interpreter=/usr/bin/python3
exec "$SOURCE_DIR/tools/headless" "$interpreter" "$1"
