# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# Sourced: says what happens, and how long is left of what takes long.

say() { printf '%s\n' "$@"; }
fail() { printf '%s\n' "$*" >&2; exit 1; }

clock() { printf '%d:%02d' $(($1 / 60)) $(($1 % 60)); }

# progress_begin; progress <percent> <what> ...; progress_end
# One line that changes on a terminal, one line each five seconds elsewhere.
progress_begin() { progress_started=$SECONDS progress_shown=$SECONDS; }
progress() {
  local percent=$1 what=$2 spent=$((SECONDS - progress_started)) left=
  if ((percent > 2 && spent > 2)); then
    left=", about $(clock $((spent * (100 - percent) / percent))) left"
  fi
  if [[ -t 1 ]]; then
    printf '\r\e[K  %3d %%  %s (%s%s)' "$percent" "${what:0:60}" "$(clock $spent)" "$left"
  elif ((SECONDS - progress_shown >= 5)); then
    printf '  %3d %%  %s (%s%s)\n' "$percent" "$what" "$(clock $spent)" "$left"
    progress_shown=$SECONDS
  fi
}
progress_end() { if [[ -t 1 ]]; then printf '\r\e[K'; fi; }

# run_ninja <build folder> <ninja argument>...
run_ninja() {
  local line status=0
  progress_begin
  NINJA_STATUS='@%f/%t@ ' ninja -C "$1" "${@:2}" 2>&1 | while IFS= read -r line; do
    if [[ $line =~ ^@([0-9]+)/([0-9]+)@\ (.*) ]]; then
      progress $((100 * BASH_REMATCH[1] / BASH_REMATCH[2])) "${BASH_REMATCH[3]##*/}"
    elif [[ $line != "ninja: "@("Entering directory"*|"no work to do.") && $line != "-- "* ]]; then
      progress_end
      say "$line"
    fi
  done || status=$?
  progress_end
  return $status
}
