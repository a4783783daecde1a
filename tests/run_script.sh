#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run_script.sh SCRIPT: how CTest runs a test script: on a virtual display, in
# the fresh folder $WORK, with MeshLab's settings in it.
set -euo pipefail

rm -rf "$WORK"
mkdir -p "$WORK/settings"
cd "$WORK"
export XDG_CONFIG_HOME=$WORK/settings XDG_RUNTIME_DIR=$WORK/settings LC_ALL=C.UTF-8
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$SOURCE_DIR/tests
chmod 700 "$WORK/settings"

interpreter=bash
[[ $1 == *.py ]] && interpreter=/usr/bin/python3
exec "$SOURCE_DIR/tools/headless" "$interpreter" "$1"
