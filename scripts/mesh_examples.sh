#!/bin/sh
# Meshes every example, or the named ones, from its .geo: scripts/mesh_examples.sh [NAME ...]
set -eu
cd "$(dirname "$0")/../examples"
[ $# -gt 0 ] || set -- */
for name in "$@"; do
  name=${name%/}
  (cd "$name" && gmsh -v 2 -3 "$name.geo" -o "$name.msh")
done
