# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# Sourced after progress.sh: the Debian packages of each task, and their
# installation. Nothing is asked of apt when nothing is missing.

build_packages=(
  g++ cmake ninja-build dpkg-dev
  meshlab qtbase5-dev libqt5opengl5-dev libglew-dev libglu1-mesa-dev
  libeigen3-dev libtbb-dev libnanoflann-dev libmaxflow-dev libpugixml-dev nlohmann-json3-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev
  libgtest-dev)
run_packages=(xvfb libgl1-mesa-dri python3 python3-numpy python3-pil libcgal-demo)
bench_packages=(libcgal-dev libflann-dev liblz4-dev libembree-dev)
format_packages=(clang-format-14)
tidy_packages=(clang-tidy-14)
coverage_packages=(gcovr)
reference_packages=(doxygen)
fuzz_packages=(clang-14 libclang-rt-14-dev)
picture_packages=(imagemagick)
package_packages=(file)
root_packages=(debootstrap)
python_packages=(python3-venv)

# need_packages <package>...   installs those that are missing
need_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0
  say "Installing ${#missing[@]} Debian packages and what they need (a few minutes on a fresh machine):"
  say "  ${missing[*]}"
  local as_root=()
  if (($(id -u))); then
    command -v sudo >/dev/null || fail "Installing packages needs root; run this once as root: apt-get install ${missing[*]}"
    as_root=(sudo)
  fi
  apt_log=$(mktemp)
  say "Asking apt for its newest lists ..."
  "${as_root[@]}" apt-get update </dev/null >"$apt_log" 2>&1 || true  # what counts is whether the install works
  if ! install_packages "${missing[@]}"; then
    grep -E '^(E|W|dpkg): ' "$apt_log" | tail -4 >&2 || true
    local cause
    cause=$(apt_failure "$apt_log")
    rm -f "$apt_log"
    fail "$cause"
  fi
  rm -f "$apt_log"
}

missing_packages() {
  local installed package
  installed=" $(dpkg-query -W -f '${db:Status-Status}:${Package} ' "$@" 2>/dev/null || true)"
  for package in "$@"; do
    [[ $installed == *" installed:$package "* ]] || echo "$package"
  done
}

# Uses as_root and apt_log of need_packages. apt reports its progress on
# descriptor 3, which only the shell inside sudo may open.
install_packages() {
  local line stage="" status=0
  progress_begin
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C bash -c 'exec apt-get "$@" 3>&1 1>&2' apt-get \
    install -y --no-install-recommends -o APT::Status-Fd=3 -o Dpkg::Use-Pty=0 -o Acquire::Retries=2 "$@" \
    </dev/null 2>>"$apt_log" |
    while IFS= read -r line; do
      [[ $line =~ ^(dl|pm)status:.*:([0-9]+)\.[0-9]+:(.*) ]] || continue
      [[ $stage == "${BASH_REMATCH[1]}" ]] || progress_begin
      stage=${BASH_REMATCH[1]}
      progress "${BASH_REMATCH[2]}" "$([[ $stage == dl ]] && echo Downloading || echo "${BASH_REMATCH[3]}")"
    done || status=$?
  progress_end
  return $status
}

# One sentence for the user from apt's log.
apt_failure() {
  case $(cat "$1") in
    *"enough free space"* | *"No space left"*) echo "The disk is full; free some space and try again." ;;
    *"Could not get lock"*) echo "Another program is installing packages; wait until it has finished and try again." ;;
    *"dpkg was interrupted"*)
      echo "An earlier installation was interrupted; run 'dpkg --configure -a' as root and try again." ;;
    *"resolving"* | *"Could not connect"* | *"Failed to fetch"* | *"Connection "*)
      echo "Debian's packages could not be downloaded; check the network (and apt's sources) and try again." ;;
    *"Unable to locate package"* | *"no installation candidate"*)
      echo "A package is in none of apt's sources; this project needs those of Debian 12 (main)." ;;
    *"a password is required"* | *"a terminal is required"*)
      echo "Installing packages needs root; run './run setup' once where sudo can ask for the password." ;;
    *) echo "apt could not install the packages; the lines above say why." ;;
  esac
}
