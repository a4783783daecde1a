#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Prints the folder that holds MeshLab's headers (src/common, vcglib), which
# Debian's meshlab package leaves out. They are downloaded once from Debian's
# source package of the same version, through the machine's own apt sources,
# without touching its apt lists: no root needed. With --fetched nothing is
# downloaded: it fails where they are not there yet. With --version 2025.07 they
# are those of that MeshLab, from whichever Debian has it, as PyMeshLab needs.
set -euo pipefail

fail() { echo "$*" >&2; exit 1; }
say() { echo "$*" >&2; }

wanted=
if [[ ${1:-} == --version ]]; then
  wanted=$2 version=$2
else
  version=$(dpkg-query -W -f '${source:Version}' meshlab 2>/dev/null) ||
    fail "MeshLab is not installed; run './run setup' first."
fi
cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/meshlab-headers
headers=$cache/$version
# Plugins say which version they are for; Debian's is made of it and a suffix.
note_version() { echo "${version%%[+~-]*}" >"$1/ML_VERSION"; }
if [[ -d $headers/src/common && -d $headers/vcglib/vcg ]]; then
  [[ -f $headers/ML_VERSION ]] || note_version "$headers"
  echo "$headers"
  exit 0
fi

[[ ${1:-} != --fetched ]] ||
  fail "MeshLab's headers for version $version are not there yet; './run setup' fetches them, or give a folder by -DMESHLAB_HEADERS=FOLDER."

mkdir -p "$cache" 2>/dev/null || fail "The folder $cache cannot be written; set XDG_CACHE_HOME to one that can."
free=$(df --output=avail -m "$cache" | tail -1)
((free >= 300)) ||
  fail "Only $((free)) MB are free on the disk of $cache, and MeshLab's source package needs 300 MB; free some and try again."
work=$(mktemp -d "$cache/fetch.XXXXXX")  # beside the target, so that the last step is one rename
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{sources.d,lists/partial,archives/partial,download}

# The machine's own sources, asked for source packages instead of binary ones:
# mirrors, keyrings and options stay as their owner set them.
eval "$(apt-config shell list Dir::Etc::sourcelist/f parts Dir::Etc::sourceparts/d)"
for file in "$list" "$parts"*.list "$parts"*.sources; do
  [[ -f $file ]] || continue
  sed -E 's/^deb([[:space:]])/deb-src\1/; s/^Types:.*/Types: deb-src/' "$file" >"$work/sources.d/${file##*/}"
done

if [[ $wanted ]]; then  # other Debians, from the same mirror
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' | head -1)
  rm -f "$work"/sources.d/*
  printf 'deb-src [check-valid-until=no] %s %s main\n' "$mirror" unstable "$mirror" testing "$mirror" stable \
    >"$work/sources.d/others.list"
fi

private_apt=(-qq -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$work/sources.d"
  -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work" -o Acquire::Languages=none -o Acquire::Retries=2)
[[ $(id -u) -eq 0 ]] && private_apt+=(-o APT::Sandbox::User=root)

say "Fetching MeshLab's headers from Debian's source package meshlab $version (once, about a minute) ..."
apt-get "${private_apt[@]}" update >"$work/log" 2>&1 || true  # a vendor's list may fail, Debian's counts
if [[ $wanted ]]; then
  version=$(apt-cache "${private_apt[@]}" showsrc meshlab | sed -nE "s/^Version: ($wanted[~+-].*)/\1/p" | head -1)
  [[ $version ]] || fail "No Debian on this mirror has MeshLab $wanted; give a folder with its headers by -DMESHLAB_HEADERS=FOLDER."
fi
# The upstream archive is enough: Debian's patches leave the headers as they are.
(cd "$work/download" && apt-get "${private_apt[@]}" source --download-only --tar-only "meshlab=$version") >>"$work/log" 2>&1 || {
  grep -E '^(E|W|Err):?' "$work/log" | head -5 >&2
  fail "MeshLab's source package could not be downloaded; check the network, the free disk space and that apt's sources are Debian's, and try again."
}
mkdir "$work/meshlab"
tar -C "$work/meshlab" --strip-components=1 -xf "$work"/download/meshlab_*.orig.tar.* >>"$work/log" 2>&1 ||
  fail "MeshLab's source package could not be unpacked in $cache; check the free disk space and try again."

mkdir "$work/headers" "$work/headers/src"
mv "$work/meshlab/src/common" "$work/headers/src/"
for vcglib in "$work/meshlab/vcglib" "$work/meshlab/src/vcglib"; do  # 2020.09, later
  [[ ! -d $vcglib/vcg ]] || mv "$vcglib" "$work/headers/"
done
[[ -d $work/headers/vcglib ]] || fail "MeshLab's source package $version has no vcglib; this host is not known."
note_version "$work/headers"
rm -rf "$headers"
mv "$work/headers" "$headers"
echo "$headers"
