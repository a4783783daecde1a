# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# For the scripts demo/NAME, which './run demo NAME' starts in the empty folder
# $OUT with ROOT (the checkout), BUILD, STAGE (the stage tree) and SCRIPTS (the .mlx
# templates) set. A demo starts with
#   # demo: what it makes, in a line
#   source "$ROOT/demo/lib.sh"
set -euo pipefail
source "$ROOT/tools/progress.sh"

# cgal_mesh man.off   prints the path of a mesh of Debian's libcgal-demo
cgal_mesh() { "$ROOT/tools/cgal-mesh" "$@"; }

# meshlabserver ARG...   the staged one, on a virtual display, or meshlab-script
# where the host has none; its chatter goes to meshlabserver.log, and the log's
# end is shown when it fails
meshlabserver() {
  local status=0 program=$STAGE/bin/meshlabserver
  [[ -x $program ]] || program=$STAGE/bin/meshlab-script
  "$ROOT/tools/headless" "$program" "$@" >meshlabserver.log 2>&1 || status=$?
  if ((status)); then
    tail -15 meshlabserver.log >&2
    fail "meshlabserver failed (exit $status); its whole output is in $PWD/meshlabserver.log."
  fi
}

# need_output FILE...   fails unless each was written and is not empty
need_output() {
  local file
  for file; do [[ -s $file ]] || fail "The demo should have written $file, and did not."; done
}

# finish MESH PICTURE...   checks the results and names them
finish() {
  need_output "$@"
  say "" "Result:"
  local file
  for file; do say "  $(realpath "$file")"; done
}

# mlx STEP NAME=VALUE... + STEP ... >script.mlx   see tools/mlx
mlx() { "$ROOT/tools/mlx" "$@"; }

# place IN OUT X Y Z   the mesh IN with new coordinates, formulas in x, y and z
place() {
  mlx "Per Vertex Geometric Function" "RichString:x=$3" "RichString:y=$4" "RichString:z=$5" \
    RichBool:onselected=false >place.mlx
  meshlabserver -i "$1" -s place.mlx -o "$2"
}

# picture OUT MESH...   see tools/picture.cpp
picture() { "$BUILD/tools/picture" "$@"; }
